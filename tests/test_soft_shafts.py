"""A knob behind a joint that the steps of a simulation cannot follow: one line, and never no number."""

from __future__ import annotations

import itertools
import re

import numpy as np
import pytest

import knobcam as kc
from knobcam.capture.motions import motion as make_motion

RATES = 500.0, 5000.0
MOTIONS = "sweep", "hand"


def behind(knob: str, lighter: float, k: float, d: float, share: float = 0.02) -> kc.Model:
    """A knob of the paper, so many times as light, behind a shaft of this stiffness and damping."""
    model = kc.Model.load(knob).with_effect("compliance")
    values = {"compliance.k": k, "compliance.d": d, "compliance.share": share}
    for name, value in (values | {"inertia.M": model.params["inertia.M"].value / lighter}).items():
        model = model.with_value(name, value)
    return model


@pytest.mark.parametrize("knob", ["knob3", "knob4", "knob5"])
def test_a_soft_light_undamped_shaft_is_followed_or_refused_and_never_gives_no_number(knob: str) -> None:
    followed = refused = 0
    grid = itertools.product((1.0, 100.0), (0.02, 1.0), (1e-9, 1e-4), RATES, MOTIONS)
    for lighter, k, d, rate_hz, motion in grid:
        model = behind(knob, lighter, k, d)
        try:
            capture = kc.simulate(model, motion, duration_s=1.0, rate_hz=rate_hz, noise="none")
        except kc.InputError as error:
            assert "runs away" in str(error) and "\n" not in str(error)
            refused += 1
            continue
        assert np.isfinite(capture.tau).all() and float(np.max(np.abs(capture.tau))) < 10.0
        followed += 1
    assert followed > 5 and refused > 5, (followed, refused)


def test_at_the_rate_that_a_refusal_names_the_knob_is_followed_and_at_half_of_it_not() -> None:
    model = behind("knob5", 1.0, 0.02, 1e-9)
    with pytest.raises(kc.InputError, match=r"too long for what brakes it; give a rate of") as refused:
        kc.simulate(model, "hand", duration_s=1.0, rate_hz=500.0)
    found = re.search(r"a rate of (\d+) Hz", str(refused.value))
    assert found is not None
    rate_hz = float(found[1])
    assert np.isfinite(kc.simulate(model, "hand", duration_s=1.0, rate_hz=rate_hz).tau).all()
    with pytest.raises(kc.InputError, match="runs away"):
        kc.simulate(model, "hand", duration_s=1.0, rate_hz=0.5 * rate_hz)


def test_friction_that_drives_is_said_to_be_at_fault_where_no_rate_helps() -> None:
    with pytest.raises(kc.InputError, match="give a model whose friction opposes motion"):
        kc.simulate(behind("knob1", 1.0, 1.0, 1e-9, 0.7), "sweep", duration_s=1.0, rate_hz=500.0)


def test_a_track_and_a_push_that_cannot_be_followed_are_refused_too() -> None:
    model = behind("knob5", 1.0, 0.02, 1e-9)
    with pytest.raises(kc.InputError, match="far more samples a second than 500"):
        kc.simulate(model, make_motion("hand", 1.0, 500.0))
    with pytest.raises(kc.InputError, match="runs away"):
        kc.simulate(behind("knob3", 1e4, 100.0, 1e-9, 0.7), "push", duration_s=1.0, rate_hz=500.0)


@pytest.mark.parametrize("inertia", [5e-5, 2e-4])
def test_a_soft_shaft_that_turns_already_when_a_log_begins_is_all_that_is_missing(inertia: float) -> None:
    """No log says how far a shaft is wound up when it begins; what rings on from there is no effect."""
    model = kc.Model.of(("inertia", "coulomb", "viscous", "compliance"), "rotary")
    values = {"inertia.M": inertia, "coulomb.neg": 0.02, "coulomb.pos": 0.022, "viscous.neg": 4e-4}
    values |= {"viscous.pos": 5e-4, "compliance.k": 60.0, "compliance.d": 2e-3, "compliance.share": 0.8}
    for name, value in values.items():
        model = model.with_value(name, value)
    whole = kc.simulate(model, "multisine", duration_s=5.0, seed=3)
    log = kc.Capture.from_arrays(**{name: column[5000:] for name, column in whole.columns.items()})
    story = kc.learn(log)
    assert (story.verdict, story.found) == ("missing", ("compliance",))
    assert story.fit.rmse < 1.02 * story.fit.noise_floor
    again = kc.fit(log, model)
    first = again.residuals[0][again.prepared[0].used][:500]
    assert np.sqrt(np.mean(np.square(first))) < 1.3 * again.noise_floor
