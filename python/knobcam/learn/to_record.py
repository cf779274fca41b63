"""What to record next where something is left that no effect explains: the motion that shows more of it."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from ..fit.beyond import incoherent

if TYPE_CHECKING:
    from .ladder import Unexplained
    from .learning import LearningResult

_ALONG = {
    "position": "slow passes over the whole way, forth and back, at two or three steady speeds",
    "velocity": "several steady speeds, from very slow to the fastest, both ways and each for some seconds",
    "acceleration": "the same way at the same speeds, with gentle and with quick reversals",
    "load": "the same motion with less and with more load on the axis",
    "history": "slow strokes of several lengths, from far shorter than the distance at which it fails to far "
    "longer, with a rest before some of the reversals",
    "time": "the same short motion again and again, from cold until nothing changes any more, and for some "
    "seconds standing still with the drive on",
    "frequency": "some seconds standing still with the drive on, and two steady speeds, logged faster",
}
"""By the axis that the rest lies along: a motion in which what belongs to that axis differs from all else."""
TELLS = {
    "position": "what stays at its place belongs to the position, what grows with the speed does not",
    "acceleration": "what changes belongs to the acceleration, as of a mass, an elastic joint or a late log",
    "load": "what grows with it is friction or elasticity under load",
    "frequency": "a line that stays is of the electronics, one that moves with the speed is of the mechanism",
}
"""What such a motion then tells, where that has to be said."""
_SENSORS = (
    "the same motion with a finer or faster sensor of the position: until its errors are smaller, what is "
    "left may be theirs"
)
_SLOWER = "the same way more slowly, or logged faster, so that its waves pass the torque filter"


def to_record(story: LearningResult) -> str | None:
    """Return the motion that would show more of what no effect explains; None where nothing is left so.

    Nor is there one where the log is to be mended first, or what is missing is not known for other reasons.
    """
    what, fit = story.unexplained, story.fit
    if what is None or _unknown(story, what):
        return None
    if incoherent(fit):
        return _SENSORS
    if _too_fast(story, what):
        return _SLOWER
    axis = _axis(story, what)
    return ": ".join([_ALONG[axis], *([TELLS[axis]] if axis in TELLS else [])])


def axis_of_motion(story: LearningResult) -> str | None:
    """Return the axis of what is left where a motion shows more of it; None where it takes something else.

    A finer sensor, say, or another load.
    """
    what = story.unexplained
    if what is None or _unknown(story, what) or incoherent(story.fit) or _too_fast(story, what):
        return None
    return _axis(story, what)


def _unknown(story: LearningResult, what: Unexplained) -> bool:
    """Whether it is not known that something is left; without a noise floor a limitation says what to do."""
    fit = story.fit
    wrong = story.cut is not None or fit.log_fault is not None or what.hint == fit.impossible
    return wrong or math.isnan(fit.noise_floor)


def _too_fast(story: LearningResult, what: Unexplained) -> bool:
    return story.fit.beyond is not None and what.hint == story.fit.beyond.words


def _axis(story: LearningResult, what: Unexplained) -> str:
    # A line is told as something in time.
    worst = story.after.worst
    line = what.axis == "time" and worst is not None and worst.axis == "frequency"
    return "frequency" if line else what.axis
