"""A log that was rounded has no less than its digits, and no effect is looked for below them."""

from __future__ import annotations

import numpy as np
import pytest

import knobcam as kc

RATE_HZ = 500.0


def turned(step_Nm: float, noise_Nm: float = 0.0, spring_Nm: float = 0.0) -> kc.Capture:
    """Dry and viscous friction and inertia, whose torque is logged in steps of so much."""
    t = np.arange(5000) / RATE_HZ
    theta = 1.2 * np.sin(np.pi * t) + 0.3 * np.sin(9.7 * t)
    omega = 1.2 * np.pi * np.cos(np.pi * t) + 2.91 * np.cos(9.7 * t)
    alpha = -1.2 * np.pi**2 * np.sin(np.pi * t) - 28.2 * np.sin(9.7 * t)
    tau = 0.02 * np.sign(omega) + 0.003 * omega + 1e-4 * alpha + spring_Nm * theta
    tau += noise_Nm * np.random.default_rng(3).standard_normal(len(t))
    return kc.Capture.from_arrays(
        t=t, theta=np.round(theta, 5), omega=omega, tau=step_Nm * np.round(tau / step_Nm)
    )


@pytest.mark.parametrize("step_Nm", [1e-5, 1e-4])
def test_of_a_rounded_torque_nothing_is_missing_below_its_digits(step_Nm: float) -> None:
    story = kc.learn(turned(step_Nm))
    assert story.verdict == "complete" and story.found == (), story.headline


def test_a_spring_that_the_digits_hold_is_found_in_them() -> None:
    assert kc.learn(turned(1e-5, spring_Nm=1e-3)).found == ("return_spring",)


def test_noise_of_its_own_tells_more_than_a_single_step() -> None:
    """A spring of a fifth of a step, below what rounding alone would leave."""
    capture = turned(1e-4, noise_Nm=1e-4, spring_Nm=2e-5)
    assert kc.learn(capture).verdict == "missing"
