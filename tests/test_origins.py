"""Several captures of one knob, each with an angle that is counted from where it was switched on."""

from __future__ import annotations

import numpy as np
import pytest

import knobcam as kc

RATE_HZ = 1000.0
TRUE = {"inertia.M": 6e-5, "viscous.neg": 4e-4, "viscous.pos": 4e-4}
KNOBS = {
    "detents": {11.4: 0.006},
    "motor": {7.0: 0.003, 12.0: 0.004, 24.0: 0.0015},
    "pendulum": {1.0: 0.006},
    "smooth": {},
}
STARTS = (0.0, 0.41, -1.37)


def run(knob: str, start: float, seed: int, reach: float = 9.0, noise: float = 6e-4) -> kc.Capture:
    """One run, made without the simulator; its counter reads `start` less than the angle of the knob."""
    random = np.random.default_rng(seed)
    t = np.arange(10_000) / RATE_HZ
    theta, omega, alpha = np.zeros((3, len(t)))
    for share, hz in ((0.38, 0.17), (0.1, 0.43), (0.02, 1.9)):
        rate = 2.0 * np.pi * hz * random.uniform(0.85, 1.15)
        phase = random.uniform(0.0, 2.0 * np.pi)
        theta += share * reach * np.sin(rate * t + phase)
        omega += share * reach * rate * np.cos(rate * t + phase)
        alpha -= share * reach * rate**2 * np.sin(rate * t + phase)
    tau = TRUE["inertia.M"] * alpha + 0.003 * np.sign(omega) + TRUE["viscous.pos"] * omega
    for order, size in KNOBS[knob].items():
        tau += size * np.sin(order * theta + order)
    tau += noise * random.standard_normal(len(t))
    return kc.Capture.from_arrays(t=t, theta=theta - start + 2e-5 * random.standard_normal(len(t)), tau=tau)


def moved(fit: kc.Fit, captures: list[kc.Capture]) -> list[float]:
    """By how much each capture's angle was moved, rad."""
    return [
        float(now.capture.theta[0] - was.theta[0]) for now, was in zip(fit.prepared, captures, strict=True)
    ]


@pytest.mark.parametrize(
    ("knob", "found"), [("detents", ()), ("motor", ("cogging",)), ("pendulum", ("unbalance",))]
)
def test_runs_that_count_from_elsewhere_are_one_knob(knob: str, found: tuple[str, ...]):
    captures = [run(knob, start, seed) for seed, start in enumerate(STARTS)]
    story = kc.learn(captures)
    assert story.found == found
    assert story.verdict == ("missing" if found else "complete")
    for name, true in TRUE.items():
        assert abs(story.fit.params[name].value - true) < 4.0 * story.fit.params[name].se, name
    turn = 2.0 * np.pi / min(KNOBS[knob]) if len(KNOBS[knob]) == 1 else np.inf
    for by, start in zip(moved(story.fit, captures), STARTS, strict=True):
        # One series of waves alone returns with each.
        off = (by - start + 0.5 * turn) % turn - 0.5 * turn if np.isfinite(turn) else by - start
        assert abs(off) < 0.02, (by, start)
    kinds = [[one.kind for one in signals.findings] for signals in story.fit.prepared]
    assert ["origin" in one for one in kinds] == [False, True, True]


@pytest.mark.parametrize("knob", KNOBS)
@pytest.mark.parametrize("seed", range(3))
def test_runs_that_count_from_the_same_place_are_left_as_they_are(knob: str, seed: int):
    captures = [run(knob, 0.0, 10 * seed + at, reach) for at, reach in enumerate((9.0, 6.0, 2.5))]
    assert moved(kc.fit(captures), captures) == [0.0, 0.0, 0.0]


def test_a_knob_without_a_place_of_its_own_keeps_its_angles():
    captures = [run("smooth", start, seed) for seed, start in enumerate(STARTS)]
    assert moved(kc.fit(captures), captures) == [0.0, 0.0, 0.0]


def test_two_knobs_are_not_shifted_onto_each_other():
    captures = [run("motor", 0.0, 1), run("detents", 0.3, 2)]
    assert moved(kc.fit(captures), captures) == [0.0, 0.0]


def test_a_model_knows_a_capture_again_whose_angle_was_moved():
    captures = [run("motor", start, seed) for seed, start in enumerate(STARTS[:2])]
    model = kc.fit(captures).model
    again = kc.fit(captures, model.frozen())
    assert "origin" in [one["kind"] for one in again.document()["findings"]]
    assert again.rmse == pytest.approx(kc.fit(captures).rmse, rel=1e-6)
