"""A recording that is sound, to be spoiled by tests of what is said of it."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from knobcam.capture import Capture, Finding

RATE = 1000.0
N = 3000


def recording(**changes: object) -> Capture:
    """A noisy swing of a knob at 1 kHz with all five columns."""
    rng = np.random.default_rng(7)
    t = np.arange(N) / RATE
    phase = 2.0 * np.pi * 1.5 * t
    columns: dict[str, object] = {
        "t": t,
        "theta": np.sin(phase) + 1e-5 * rng.standard_normal(N),
        "omega": 3.0 * np.pi * np.cos(phase) + 5e-3 * rng.standard_normal(N),
        "alpha": -9.0 * np.pi**2 * np.sin(phase) + 0.4 * rng.standard_normal(N),
        "tau": 0.05 * np.cos(phase) + 1.8e-3 * rng.standard_normal(N),
    }
    return Capture.from_arrays(**(columns | changes))  # type: ignore[arg-type]


def only(capture: Capture) -> Finding:
    assert len(capture.findings) == 1, capture.findings
    return capture.findings[0]


def masked(capture: Capture) -> list[int]:
    """The masked data rows, from 1."""
    return (np.flatnonzero(~capture.mask) + 1).tolist()


def times() -> NDArray[np.float64]:
    return np.arange(N) / RATE
