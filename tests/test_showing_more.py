"""What to record next where what is left has no name: a motion in which its axis differs from all else."""

from __future__ import annotations

import numpy as np
import pytest
from brake import braked_knob
from small import COUPLINGS

import knobcam as kc
from knobcam.capture.by_hand import by_hand
from knobcam.errors import InputError
from knobcam.learn.experiment import NoMotion
from knobcam.learn.limits import Limits
from knobcam.learn.showing_more import _KINDS, _plan, _room, along
from knobcam.learn.to_record import _ALONG

LIMITS = Limits(0.1, 6.0, 80.0, -1.0, 2.0, duration_s=60.0, sample_rate_hz=2000.0)


@pytest.fixture(scope="module")
def braked() -> kc.LearningResult:
    """A knob with an eddy-current brake, which no effect of the catalogue is."""
    return kc.learn(braked_knob(0.016, 1.3), without=COUPLINGS)


@pytest.mark.parametrize("axis", _KINDS)
def test_a_motion_for_what_is_left_goes_from_rest_to_rest_within_the_limits(axis: str) -> None:
    for way, hurry, ease in ((1.0, 1.0, 1.0), (0.1, 10.0, 0.1)):
        made = _plan(axis, _room(LIMITS, way, hurry, ease, 0.02))
        track = made.track(2000.0)
        assert track.omega[-1] == 0.0 and abs(track.omega[0]) < 0.1 and np.abs(track.omega).max() > 0.0
        assert LIMITS.hold(track._replace(t=np.minimum(track.t, LIMITS.duration_s))), made.about


def test_every_axis_but_the_load_which_no_motion_changes_has_a_motion_and_words() -> None:
    assert {*_KINDS} == {*_ALONG} - {"load"}


def test_slow_passes_for_what_lies_along_position_go_the_whole_way_at_two_steady_speeds() -> None:
    track = _plan("position", _room(LIMITS, 1.0, 1.0, 1.0, 0.0)).track(2000.0)
    assert (track.theta.min(), track.theta.max()) == pytest.approx((-1.0, 2.0))
    steady = np.abs(track.omega[np.abs(track.alpha) < 1e-9])
    kept = {round(float(one), 3) for one in steady[steady > 0.0]}
    assert {0.6, 1.8} <= kept <= {0.6, 1.8, 6.0}  # and the way to where they begin


def test_a_motion_that_begins_as_good_as_at_an_end_does_not_go_there_first() -> None:
    limits = Limits(100.0, 0.1, 1.0, -2e-5, 0.246, coordinate="linear")
    plan = _plan("position", _room(limits, 1.0, 1.0, 1.0, 0.0))
    assert plan.start == pytest.approx(-2e-5) and not by_hand(plan, "linear")[0].cannot


def test_where_no_effect_explains_what_is_left_the_next_motion_shows_more_of_that_and_sharpens_nothing(
    braked: kc.LearningResult,
) -> None:
    assert braked.verdict == "unexplained" and braked.record is not None
    axis = along(braked)
    designed = kc.next_experiment(braked)
    assert designed.shows == axis and not designed.sharpened and not designed.expected and designed.useful
    assert f"show more of what is left along {axis}" in designed.headline
    assert designed.rows() == [] and "standard error" not in repr(designed)
    reached = Limits.reached(braked.fit.prepared)
    assert np.abs(designed.track.omega).max() <= reached.omega_rad_s * 1.001
    assert designed.peak[0] <= reached.torque_Nm and designed.seconds <= designed.limits.duration_s
    assert kc.next_experiment(braked, sharpen="inertia.M", search_s=0.2).sharpened
    assert len(designed.plot().axes) == 3


def test_a_time_that_is_given_holds_and_one_that_is_too_short_is_said(braked: kc.LearningResult) -> None:
    reached = Limits.reached(braked.fit.prepared)
    assert kc.next_experiment(braked, limits=reached).seconds <= reached.duration_s
    with pytest.raises(InputError, match=r"duration_s: 0\.2 is too short for such a motion; give more"):
        kc.next_experiment(braked, limits=reached.with_some({"duration_s": 0.2}))


def test_where_the_torque_is_too_little_it_is_said_what_all_of_the_way_takes_and_that_is_enough(
    braked: kc.LearningResult,
) -> None:
    reached = Limits.reached(braked.fit.prepared, 60.0)
    with pytest.raises(NoMotion, match=r"torque_Nm: 1e-05 is too little for such a motion") as refused:
        kc.next_experiment(braked, limits=reached.with_some({"torque_Nm": 1e-5}))
    assert refused.value.enough is not None
    name, enough = refused.value.enough
    designed = kc.next_experiment(braked, limits=reached.with_some({name: enough}))
    assert np.ptp(designed.track.theta) == pytest.approx(2.0 * reached.half, rel=1e-3)
