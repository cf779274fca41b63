"""What the digits of a logged torque leave out: an error below that is rounding."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from .doubts import white_variance

if TYPE_CHECKING:
    from ..base.arrays import FloatArray
    from .fitting import Fit

_SMALL = 0.01  # of the torque, RMS: a larger error is looked at whatever its digits
_ALONE = 1.2  # times what rounding makes that all noise of the torque is, if it has none of its own


def left_out_Nm(fit: Fit, torque_rms: float) -> float:
    """Return the RMS error that rounding to the logged digits makes, N m, where there is no other noise.

    Noise of its own would carry a torque over many steps, so that their mean tells more than one of them
    (B. Widrow, 1956): then it is nought, as it is where digits are many.
    """
    if not 0.0 < fit.rmse < _SMALL * torque_rms or not fit.white_squares > 0.0:
        return 0.0
    rounding = min(_step(one.capture.tau[one.capture.mask]) for one in fit.prepared) / math.sqrt(12.0)
    noise = math.sqrt(white_variance(fit, fit.noise_floor))
    return rounding if noise <= _ALONE * rounding else 0.0


def _step(torque: FloatArray) -> float:
    """Return the smallest step between readings, N m; 0 of a torque that stands still."""
    steps = np.diff(np.unique(torque[np.isfinite(torque)]))
    return float(steps.min()) if steps.size else 0.0
