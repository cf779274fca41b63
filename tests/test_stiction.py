"""Static friction from captures that stick."""

import numpy as np
import pytest

import knobcam as kc


@pytest.fixture(scope="module", params=["knob1", "knob2", "knob3", "knob4"])
def pushed(request):
    """A knob, and what a moving and a sticking capture of it say."""
    knob = kc.Model.load(request.param)
    moving = kc.simulate(knob, "sweep", seed=11)
    sticking = kc.simulate(knob, "push", duration_s=20.0, seed=12)
    return knob, kc.fit([moving, sticking]).stiction()


@pytest.mark.parametrize("side", ["neg", "pos"])
def test_breakaway_friction_lies_within_its_interval(pushed, side):
    knob, stiction = pushed
    truth = knob.params[f"karnopp.D_{side}"].value
    found = getattr(stiction, f"d_{side}")
    # 95 % intervals of a handful of slips: the exam is twice their width, and 5 % at most.
    low, high = found.ci95
    assert abs(found.value - truth) < (high - low)
    assert found.value == pytest.approx(truth, rel=0.05)


def test_the_stick_band_is_not_wider_than_the_true_one(pushed):
    """A knob that stands quite still bounds the band from above only, by the resolution of its speed."""
    knob, stiction = pushed
    assert 0.0 <= stiction.dv.ci95[0] <= stiction.dv.value < 1.2 * knob.params["karnopp.dv"].value


def test_the_model_takes_stiction_over(pushed):
    _, stiction = pushed
    assert stiction.model.params["karnopp.D_pos"].value == stiction.d_pos.value


def test_samples_in_which_the_knob_stands_still_do_not_count():
    knob = kc.Model.load("knob1")
    truth = kc.simulate(knob, "push", duration_s=6.0, noise="none")
    prepared = kc.simulate(knob, "push", duration_s=6.0).prepare()
    still = truth.omega == 0.0
    assert np.mean(prepared.used[still]) < 0.05
    assert np.mean(prepared.used[~still]) > 0.7


def test_a_knob_that_never_sticks_says_what_to_record():
    stiction = kc.fit(kc.simulate(kc.Model.load("knob4"), "turns")).stiction()
    assert not stiction.determined
    assert any("push the knob from rest" in advice for advice in stiction.missing)
    with pytest.raises(kc.InputError, match="push the knob"):
        _ = stiction.model
