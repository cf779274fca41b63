"""What a fit does not weigh: the part of the torque that its filter takes off."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

from ..base.said import Said, Topic, said
from ..capture.prepare import waves

if TYPE_CHECKING:
    from .fitting import Fit


class Beyond(NamedTuple):
    """What a torque filter takes off, in words, the axis it lies along and its share of all that goes."""

    words: str
    axis: str
    share: float

    @property
    def sentence(self) -> Said:
        """It in a sentence."""
        return said("{head}: {words}.", head=Topic("Not weighed", "findings"), words=self.words)


def incoherent(fit: Fit) -> bool:
    """Return whether a capture's motion is wrong in a band: its errors may be in the rest as well."""
    return any(one.core.incoherent is not None for one in fit.prepared)


def beyond(fit: Fit) -> Beyond | None:
    """Return waves of a torque that the filter takes off and the model lacks, or a band left out."""
    for one in fit.prepared:
        if one.core.incoherent is not None:
            edge = f"{one.core.incoherent[0]:.3g} Hz"
            words = f"what is faster than {edge}, where the recorded motion cannot be trusted"
            return Beyond(words, "frequency", 1.0)
        ripple = one.core.taken_off(fit.model.core.torque(one.core, False)) if one.core.lost else None
        if ripple is not None:
            edge = f"beyond the torque filter's edge of {one.core.edge_hz:.4g} Hz"
            return Beyond(f"{waves(one.capture, ripple)}, {edge}", "position", ripple[2])
    return None
