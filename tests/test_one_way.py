"""A motion that goes one way cannot tell friction along the way from a torque along it, and that is said."""

from __future__ import annotations

import numpy as np
import pytest

import knobcam as kc
from knobcam.fit.one_way import one_way


def _turned(*, back: bool, torque_Nm: float = 0.0, share: float = 0.0) -> kc.Capture:
    """A knob turned forward, or backward too, with 12 and 36 waves a turn of torque or of friction."""
    rate, seconds = 1000.0, 12.0
    t = np.arange(0.0, seconds, 1.0 / rate)
    omega = 5.0 + 3.0 * np.sin(1.3 * t) * np.sin(0.41 * t + 0.3)
    if back:
        omega = omega * np.tanh(8.0 * np.sin(2.0 * np.pi * t / 6.0))
    theta = np.cumsum(omega) / rate
    alpha = np.gradient(omega, t)
    waves = np.sin(12.0 * theta + 0.4) + 0.5 * np.sin(36.0 * theta + 1.0)
    friction = 0.02 * (1.0 + share * waves) * np.sign(omega)
    tau = 2e-4 * alpha + 1e-3 * omega + friction + torque_Nm * waves
    tau += np.random.default_rng(12).normal(0.0, 1e-3, t.size)
    return kc.Capture.from_arrays(t=t, theta=theta, omega=omega, alpha=alpha, tau=tau)


TORQUE, FRICTION = {"torque_Nm": 0.005}, {"share": 0.25}
ALONG = {"cogging", "detent_harmonics"}


def test_which_way_a_capture_goes_is_known_and_that_it_goes_both() -> None:
    assert one_way(kc.fit(_turned(back=False, **TORQUE)).prepared) == "forward"
    assert one_way(kc.fit(_turned(back=True, **TORQUE)).prepared) is None


@pytest.mark.parametrize("wave", [TORQUE, FRICTION], ids=["torque", "friction"])
def test_forward_alone_neither_is_named_without_the_other(wave: dict[str, float]) -> None:
    story = kc.learn(_turned(back=False, **wave))
    step = story.ladder[1]
    either = {step.added, *step.equivalent}
    assert "position_friction" in either and ALONG & either, story
    assert step.weights["position_friction"] < 0.95 and "one_direction" in {
        one.kind for one in story.limitations
    }


@pytest.mark.parametrize("wave", [TORQUE, FRICTION], ids=["torque", "friction"])
def test_both_ways_each_is_named_for_itself(wave: dict[str, float]) -> None:
    step = kc.learn(_turned(back=True, **wave)).ladder[1]
    assert (step.added == "position_friction") == (wave is FRICTION)
    assert "position_friction" not in step.equivalent and (wave is TORQUE or not step.equivalent)
