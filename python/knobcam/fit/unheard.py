"""Why the noise of a torque is not known, and what to record instead."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

from .. import _core

if TYPE_CHECKING:
    from .fitting import Fit


class Unheard(NamedTuple):
    """Why no noise floor was read, in words, and what to `record` so that one can be."""

    why: str
    record: str


_AGAIN = "or make the same motion several times"
_WHY = {
    "short": Unheard(
        "too few samples in a row, or too slow ones, to tell the sensor's noise",
        f"record longer without gaps, sample faster (5 kHz is usual), {_AGAIN}",
    ),
    "smoothed": Unheard(
        "the torque was smoothed before it was logged, so that the sensor's noise is not in it",
        f"record the torque without a filter, {_AGAIN}",
    ),
    "loud": Unheard(
        "more than noise is fast in the torque, as a gear's ripple is, so that it does not tell the sensor's",
        f"sample faster or turn slower, {_AGAIN}",
    ),
}


def unheard(fit: Fit) -> Unheard:
    """Return why the floor of a fit that has none is not known."""
    return _WHY[_core.unheard([one.core for one in fit.prepared], fit.model.core) or "short"]
