"""Small captures of a knob whose physics is written down here once more, for answers that are kept."""

from __future__ import annotations

from collections.abc import Callable
from typing import Literal

import numpy as np

import knobcam as kc

RATE_HZ = 1000.0
WAVES = ((0.9, 5.1), (0.3, 13.3), (0.05, 47.0))
NAMES = {"t": "t_s", "theta": "theta_rad", "omega": "omega_rad_s", "alpha": "alpha_rad_s2", "tau": "tau_Nm"}
"""What a capture calls its columns, and what a file does, of a knob that turns."""

COUPLINGS = ("backlash", "compliance")
"""Left out of a search by tests that are about something else: they take by far the longest."""

Torque = Callable[[np.ndarray, np.ndarray, np.ndarray, np.ndarray], np.ndarray]


def nothing(t: np.ndarray, *_: np.ndarray) -> np.ndarray:
    return np.zeros_like(t)


def recorded(
    seed: int,
    more: Torque = nothing,
    *,
    count: int = 2500,
    waves: tuple[tuple[float, float], ...] = WAVES,
    colour: float = 0.0,
    sensors: bool = True,
    coordinate: Literal["rotary", "linear"] = "rotary",
) -> kc.Capture:
    """A knob's capture, made without the crates: inertia, dry and viscous friction, and what is more."""
    rng = np.random.default_rng(seed)
    t = np.arange(count) / RATE_HZ
    theta = sum(a * np.sin(w * t + a) for a, w in waves)
    omega = sum(a * w * np.cos(w * t + a) for a, w in waves)
    alpha = -sum(a * w * w * np.sin(w * t + a) for a, w in waves)
    dry = np.where(omega > 0.0, 9e-3 + 5e-4 * omega, -8e-3 + 4e-4 * omega)
    noise = rng.standard_normal(count)
    for at in range(1, count if colour else 0):
        noise[at] = colour * noise[at - 1] + np.sqrt(1.0 - colour**2) * noise[at]
    tau = 1e-4 * alpha + dry + more(t, theta, omega, alpha) + 1e-3 * noise
    return kc.Capture.from_arrays(
        t=t,
        tau=tau,
        theta=theta + 2e-5 * rng.standard_normal(count),
        omega=omega + 2e-3 * rng.standard_normal(count) if sensors else None,
        alpha=alpha + 0.5 * rng.standard_normal(count) if sensors else None,
        coordinate=coordinate,
    )


def rises(t: np.ndarray, theta: np.ndarray, omega: np.ndarray, alpha: np.ndarray) -> np.ndarray:
    """Friction that rises towards standstill, and a spring."""
    return 8e-3 * np.sign(omega) * np.exp(-np.abs(omega) / 0.8) + 5e-3 * theta


def detents(t: np.ndarray, theta: np.ndarray, omega: np.ndarray, alpha: np.ndarray) -> np.ndarray:
    return 0.03 * np.sin(theta / 0.08 + 0.7) + 6e-3 * np.sin(2.0 * theta / 0.08)
