"""The torque-angle curve of a capture, as testers at the end of a line draw it: one for each direction."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from ..base.arrays import BoolArray, FloatArray
    from ..fit import Fit

BINS = 96
"""Along the angle: a detent of a coarse knob has some ten of them, and a row stays small."""
_MOVES = 0.05  # of the largest speed: below it a direction is about to turn
_FEWEST = 3  # samples, for a mean

Curve = dict[str, list[float | None]]
"""`theta`, rad (m), and the torque `forward` and `backward` there, N m (N); nothing where no sample is."""


def curve(fitted: Fit) -> Curve:
    """Return the measured torque over the angle less what accelerates the inertia, its mean in each bin."""
    signals = fitted.signals
    used = signals.used
    catalogue = fitted.model.catalogue()
    inertial = [one for one in fitted.model.effects if catalogue[one].over == "acceleration"]
    tau = signals.tau.copy()
    if inertial:
        tau -= fitted.model.core.only(inertial).torque(signals.core)
    theta, omega, tau = signals.theta[used], signals.omega[used], tau[used]
    edges = np.linspace(float(theta.min()), float(theta.max()), BINS + 1)
    at = np.clip(np.searchsorted(edges, theta, side="right") - 1, 0, BINS - 1)
    moves = np.abs(omega) > _MOVES * float(np.max(np.abs(omega)))
    return {
        "theta": (0.5 * (edges[:-1] + edges[1:])).tolist(),
        "forward": _means(at, tau, moves & (omega > 0.0)),
        "backward": _means(at, tau, moves & (omega < 0.0)),
    }


def _means(
    at: np.ndarray[tuple[int], np.dtype[np.int64]], tau: FloatArray, some: BoolArray
) -> list[float | None]:
    count = np.bincount(at[some], minlength=BINS)
    total = np.bincount(at[some], weights=tau[some], minlength=BINS)
    return [float(t / n) if n >= _FEWEST else None for t, n in zip(total, count, strict=True)]
