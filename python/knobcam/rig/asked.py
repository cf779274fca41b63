"""The motion that a recording is asked for: a name, a file, a plan or a track."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from ..capture.motion_plan import MotionPlan
from ..capture.motions import motion as make_motion

if TYPE_CHECKING:
    from ..capture.motions import MotionTrack

BY_HAND = "hand"
"""The motion that no motor makes: a person turns the knob, and the rig records."""


@dataclass(frozen=True)
class Asked:
    """A motion at the rate of a rig, without what leads into it.

    `header` is what a recording says of it. `placed`: its angles are those of the rig's captures, as those of
    a file and of a plan are; those of all others count from where the knob stands.
    """

    name: str
    track: MotionTrack
    header: dict[str, Any]
    placed: bool = False
    by_hand: bool = False


def asked(
    motion: str | MotionTrack | MotionPlan, duration_s: float, rate_hz: float, **options: float
) -> Asked:
    """Return the motion that is asked for. Raises InputError for what is none."""
    if isinstance(motion, str):
        track = make_motion(motion, duration_s, rate_hz, **options)
        file = motion.lower().endswith(".toml")
        seconds = len(track.t) / rate_hz if file else duration_s
        header = {"name": motion, "duration_s": seconds, **options}
        return Asked(motion, track, header, placed=file, by_hand=motion == BY_HAND)
    if isinstance(motion, MotionPlan):
        track = motion.track(rate_hz)
        header = {"name": "given", "duration_s": len(track.t) / rate_hz, "about": motion.about}
        return Asked("motion", track, header, placed=True)
    header = {"name": "given", "duration_s": len(motion.t) / rate_hz}
    return Asked("motion", motion, header)
