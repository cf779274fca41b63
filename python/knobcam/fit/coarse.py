"""The steps in which a torque is read, where they are coarser than its noise."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from ..base.remembered import remembered

if TYPE_CHECKING:
    from ..base.arrays import FloatArray
    from ..capture.prepare import Prepared
    from .fitting import Fit

_WHOLE = 0.99  # of the changes that are whole steps
_NEARLY = 0.1  # steps by which one may be off


def step(values: FloatArray) -> float:
    """Return the step in which values are read, in their own unit; 0 where there is none to be seen."""
    changes = np.abs(np.diff(values[np.isfinite(values)]))
    changes = changes[changes > 4.0 * np.finfo(float).eps * np.max(np.abs(values), initial=0.0)]
    if not changes.size:
        return 0.0
    least = float(changes.min())
    steps = changes / least
    return least if np.mean(np.abs(steps - np.rint(steps)) < _NEARLY) >= _WHOLE else 0.0


def within_rounding(fit: Fit) -> float | None:
    """Return the steps of the torque, N m, where all that is left is within their rounding; None where not.

    Of a torque that changes slowly beside its steps the rounding has no noise that would show it: it is a
    function of the torque, uniform over a step (Widrow & Kollar 2008), and lies along all that the torque
    does.
    """
    finest = min(map(_torque_step, fit.prepared), default=0.0)
    return finest if 0.0 < fit.rmse <= finest / math.sqrt(12.0) else None


@remembered  # every headline asks, and a page says one at each change
def _torque_step(one: Prepared) -> float:
    return step(one.capture.tau[one.capture.mask])
