"""The motion that shows more of what no effect explains: what belongs to its axis differs from all else.

It is what `to_record` says in words, made within limits: the whole way and slowly where there is time for it,
else faster, and a part of the way only where that is not enough.
"""

from __future__ import annotations

import math
import time
from collections.abc import Callable
from dataclasses import replace
from itertools import product
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from ..capture.by_hand import by_hand as steps_by_hand
from ..capture.by_hand import hand_can, on_beats
from ..capture.motion_plan import MotionPlan, Move, Rest
from .contenders import untold
from .experiment import Experiment, NoMotion
from .limits import LONGEST_S, Limits
from .telling import Rival, Telling
from .to_record import axis_of_motion

if TYPE_CHECKING:
    from ..capture.motion_plan import Part
    from .learning import LearningResult

_LONGEST_S = 120.0
"""As long as such a motion takes at most where nobody gave a time: slow passes over the whole way."""
_SLOW, _QUICK = 0.1, 0.3  # of the fastest
_HURRIES = 1.0, 1.5, 2.0, 3.0, 4.5, 6.5, 10.0
_WAYS = 1.0, 0.7, 0.5, 0.35, 0.25, 0.15, 0.1
_EASES = 1.0, 0.25  # of the largest acceleration
_TURN = 0.03  # of the way, in which a pass is about at its speed: the largest acceleration may be a jerk
_CHECKED_HZ = 500.0
_ROUNDED = 1.01  # of a torque that is asked for
_SPEEDS = 6
_EACH_S = 3.0  # of a pass at one of many speeds
_STROKES = 0.3, 3.0, 30.0  # of the distance at which it fails
_TIMES, _MANY = 3, 12
_STILL_S = 5.0
_THERE = 1e-3  # of the way, within which an end is no place to go to first
_REST_S = 1.0


class _Room(NamedTuple):
    """Between where it moves, how fast and how hard; where after a reversal it fails, 0: nowhere."""

    low: float
    high: float
    speed: float
    slow: float
    quick: float
    hard: float
    fails_at: float
    unit: str

    @property
    def way(self) -> float:
        """From end to end."""
        return self.high - self.low

    def stroke(self, way: float, speed: float, times: int, hard: float | None = None) -> list[Part]:
        """So far to and fro about the middle, so many times; gently, where it is not said how hard."""
        middle = 0.5 * (self.low + self.high)
        ends = middle - 0.5 * way, middle + 0.5 * way
        given = hard or min(self.hard, speed**2 / (_TURN * way))
        gone: list[Part] = [Move(ends[0], self.quick, min(self.hard, self.quick**2 / (_TURN * self.way)))]
        return gone + [Move(ends[1 - at % 2], speed, given) for at in range(2 * times)]

    def far(self, way: float) -> str:
        """A distance in words."""
        return f"{way:.3g} {self.unit}"

    def fast(self, speed: float) -> str:
        """A speed in words."""
        return f"{speed:.3g} {self.unit}/s"


_Made = tuple[list["Part"], str]


def _position(room: _Room) -> _Made:
    parts = room.stroke(room.way, room.slow, 1) + room.stroke(room.way, room.quick, 2)
    return parts, _passes(room)


def _passes(room: _Room) -> str:
    speeds = f"once at {room.fast(room.slow)} and twice at {room.fast(room.quick)}"
    return f"to and fro over {room.far(room.way)}, {speeds}"


def _velocity(room: _Room) -> _Made:
    speeds = np.geomspace(0.2 * room.slow, room.speed, _SPEEDS).tolist()
    parts: list[Part] = []
    for speed in speeds:
        parts += room.stroke(min(room.way, _EACH_S * speed), speed, 1)
    said = f"to and fro at {len(speeds)} speeds, {room.fast(speeds[0])} to {room.fast(speeds[-1])}"
    return parts, said


def _acceleration(room: _Room) -> _Made:
    gentle = 0.1 * room.hard
    parts = [part for hard in (gentle, room.hard) for part in room.stroke(room.way, room.quick, _TIMES, hard)]
    hard = f"{gentle:.3g} and {_TIMES} times with {room.hard:.3g} {room.unit}/s^2"
    way = f"to and fro over {room.far(room.way)} at {room.fast(room.quick)}"
    return parts, f"{way}, {_TIMES} times reversed with {hard}"


def _history(room: _Room) -> _Made:
    at = room.fails_at or 0.01 * room.way
    sizes = sorted({min(share * at, room.way) for share in _STROKES})
    parts: list[Part] = []
    for size in sizes:
        parts += [*room.stroke(size, min(room.slow, size / _REST_S), _TIMES), Rest(_REST_S)]
    lengths = ", ".join(room.far(one) for one in sizes)
    rests = f"with {_REST_S:g} s of rest after each length"
    return parts, f"slow strokes of {lengths}, {_TIMES} times each, {rests}"


def _time(room: _Room) -> _Made:
    way = 0.25 * room.way
    parts = [*room.stroke(way, room.quick, _MANY), Rest(_STILL_S)]
    stroke = f"the same stroke of {room.far(way)} at {room.fast(room.quick)} {_MANY} times"
    return parts, f"{stroke}, then {_STILL_S:g} s standing still with the drive on"


def _frequency(room: _Room) -> _Made:
    still: list[Part] = [Rest(_STILL_S)]
    parts = still + room.stroke(room.way, room.slow, 1) + room.stroke(room.way, room.quick, 2)
    return parts, f"{_STILL_S:g} s standing still with the drive on, then {_passes(room)}"


_KINDS: dict[str, Callable[[_Room], _Made]] = {
    "position": _position,
    "velocity": _velocity,
    "acceleration": _acceleration,
    "history": _history,
    "time": _time,
    "frequency": _frequency,
}


def along(story: LearningResult) -> str | None:
    """Return the axis of which a motion shows more; None where none does, or causes are to be told first.

    What came in and is named as no cause is not worth a motion of its own before what is left has a name.
    """
    axis = axis_of_motion(story)
    tied = any(added in story.found for added, _ in untold(story.ladder))
    return axis if axis in _KINDS and not tied else None


def longest_s(axis: str | None) -> float:
    """Return how long a motion takes at most where nobody gave a time."""
    return LONGEST_S if axis is None else _LONGEST_S


def show_more(story: LearningResult, axis: str, limits: Limits, *, by_hand: bool = False) -> Experiment:
    """Return the motion that shows more of what is left along an axis.

    Raises NoMotion where none is within the limits.
    """
    begun = time.monotonic()
    alone = (Rival(story.found, story.fit),)
    telling = Telling(alone)
    fails = [one.end for one in story.after["history"].regions[:1]]
    rate, least = limits.sample_rate_hz, dict.fromkeys(_WAYS, math.inf)
    for way, hurry, ease in product(_WAYS, _HURRIES, _EASES):
        plan = _plan(axis, _room(limits, way, hurry, ease, fails[0] if fails else 0.0))
        if by_hand:
            plan = on_beats(plan, limits.duration_s)
            if not hand_can(steps_by_hand(plan, limits.coordinate)):
                continue
        if plan.seconds > limits.duration_s - 2.0 / rate or not limits.hold(
            plan.track(min(rate, _CHECKED_HZ))
        ):
            continue
        track = plan.track(rate)
        torque = telling.peak(track, draws=False)
        if torque > limits.torque_Nm:
            least[way] = min(least[way], torque)
            continue
        omega, alpha = (float(np.max(np.abs(one))) for one in (track.omega, track.alpha))
        made = Experiment(alone, limits, plan, track, (), (torque, omega, alpha), shows=axis)
        return replace(made, took_s=time.monotonic() - begun)
    # Over as much of the way as there is time for.
    needed = next((torque for torque in least.values() if torque < math.inf), None)
    if needed is not None:
        takes = f"is too little for such a motion, which may take {needed:.3g}"
        few = f"limits, torque_Nm: {limits.torque_Nm:.4g} {takes}; give more"
        raise NoMotion(few, ("torque_Nm", _ROUNDED * needed))
    few = f"limits, duration_s: {limits.duration_s:.4g} is too short for such a motion; give more"
    raise NoMotion(few, None)


def _room(limits: Limits, way: float, hurry: float, ease: float, fails_at: float) -> _Room:
    speed = limits.omega_rad_s
    slow, quick = (min(1.0, share * hurry) * speed for share in (_SLOW, _QUICK))
    reach, hard = way * limits.half, ease * limits.alpha_rad_s2
    low, high = limits.middle - reach, limits.middle + reach
    return _Room(low, high, speed, slow, quick, hard, fails_at, limits.unit)


def _plan(axis: str, room: _Room) -> MotionPlan:
    parts, said = _KINDS[axis](room)
    start = min(max(0.0, room.low), room.high)
    end = min((room.low, room.high), key=lambda end: abs(end - start))
    start = end if abs(end - start) < _THERE * room.way else start
    return MotionPlan(tuple(parts), start, said)
