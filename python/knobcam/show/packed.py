"""Columns of samples in few letters, for a file that carries many: steps, their differences, deflated."""

from __future__ import annotations

import base64
import zlib
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from ..base import pages
    from ..base.arrays import FloatArray

FINE = 2**24
"""Steps over the span of a column, as many as a 32-bit float tells apart."""
USUAL = 2**16
"""Steps that no picture shows, and that change no sum of squares by more than a millionth."""


def step_of(values: FloatArray, steps: int = USUAL) -> float:
    """Return the step that divides the span of finite values into so many."""
    known = values[np.isfinite(values)]
    return float(np.ptp(known)) / steps or 1.0 if len(known) else 1.0


def packed(values: FloatArray, step: float) -> pages.Packed:
    """Return values, rounded to a step, as a page unpacks them: shape (n,), not a number allowed.

    `deflated` is base64 of the bytes of n 32-bit differences, all lowest bytes first; a difference has its
    sign in its lowest bit. Of the steps that they sum up to, 0 is "not a number" and 1 is `low`.
    """
    known = np.isfinite(values)
    low = float(values[known].min()) if known.any() else 0.0
    steps = np.zeros(len(values), np.int32)
    steps[known] = np.rint((values[known] - low) / step).astype(np.int32) + 1
    change = np.diff(steps, prepend=np.int32(0))
    folded = (change << 1) ^ (change >> 31)
    planes = folded.astype("<i4").view(np.uint8).reshape(-1, 4).T
    deflated = base64.b64encode(zlib.compress(planes.tobytes())).decode("ascii")
    return {"low": low, "step": step, "deflated": deflated}
