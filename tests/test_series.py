"""Two series of valleys in one knob: the second has its name where it is bound to nothing else."""

from __future__ import annotations

import numpy as np
import pytest
from examiner import Case, sit
from marks import answered

import knobcam as kc

RATE_HZ = 1000.0
STRENGTHS = (0.004, 0.0025)  # N m, of the first series and the second


def turned(per_turn: tuple[float, float], reach: float, seed: int = 1) -> kc.Capture:
    """A knob with two series of so many waves per turn over `reach` rad, made without the simulator."""
    random = np.random.default_rng(seed)
    t = np.arange(12_000) / RATE_HZ
    theta, omega, alpha = np.zeros((3, len(t)))
    for share, hz in ((0.42, 0.13), (0.08, 0.41)):
        rate, phase = 2.0 * np.pi * hz, random.uniform(0.0, 2.0 * np.pi)
        theta += share * reach * np.sin(rate * t + phase)
        omega += share * reach * rate * np.cos(rate * t + phase)
        alpha -= share * reach * rate**2 * np.sin(rate * t + phase)
    tau = 6e-5 * alpha + 0.004 * np.sign(omega) + 4e-4 * omega
    for order, strength in zip(per_turn, STRENGTHS, strict=True):
        tau += strength * np.sin(order * theta + random.uniform(0.0, 2.0 * np.pi))
    tau += 5e-4 * random.standard_normal(len(t))
    return kc.Capture.from_arrays(t=t, theta=theta + 2e-5 * random.standard_normal(len(t)), tau=tau)


def test_a_second_series_is_found_with_its_period_and_fitted_again_from_its_model():
    capture = turned((12.0, 17.4), 4.0)
    story = kc.learn(capture)
    assert (story.verdict, story.found) == ("missing", ("second_detent",))
    params = story.fit.params
    assert 1.0 / params["second_detent.P"].value == pytest.approx(17.4, rel=0.01)
    assert abs(params["second_detent.A"].value) == pytest.approx(STRENGTHS[1], rel=0.05)
    again = kc.fit(capture, story.model)
    assert again.rmse == pytest.approx(story.fit.rmse, rel=1e-3)


def test_series_of_whole_orders_are_the_ripple_of_a_motor_where_the_knob_turns_round():
    assert kc.learn(turned((12.0, 17.0), 14.0)).found == ("cogging",)
    assert kc.learn(turned((12.3, 17.4), 14.0)).found == ("second_detent",)


def test_a_ripple_and_detents_are_two_detents_of_which_one_is_a_whole_order():
    story = kc.learn(turned((12.0, 17.4), 14.0))
    assert story.found == ("cogging",)  # it has a parameter less
    weighed = story.ladder[1].diagnosis
    assert weighed is not None
    cogging, second = (
        next(one for one in weighed.candidates if one.effect == name) for name in ("cogging", "second_detent")
    )
    assert second.gain == pytest.approx(cogging.gain, rel=1e-3) and second.count > cogging.count


def test_a_series_of_twice_as_many_waves_is_the_shape_of_the_detents():
    assert kc.learn(turned((11.3, 22.6), 4.0)).found == ("detent_harmonics",)


def test_a_second_series_of_an_independent_simulator_is_named():
    known, marks = sit(Case.parse("single/second_detent:90001"))
    row = known | marks
    assert answered(row), row
    assert not row["wrong"]
