"""A motion in words for a person without a motor: steps in degrees, seconds and beats of a metronome.

What follows one another and is alike becomes one step: passes between the same ends, stairs with rests. The
metronome goes at 40 to 120 beats a minute, which a hand can follow: each turning of it is a beat; a quick there
and back is one together; a pass that takes longer has several, so that they come about once a second.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, NamedTuple

from .motion_plan import Move, Rest, Waves

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from .formats.units import Coordinate
    from .motion_plan import MotionPlan

FASTEST = 120.0
"""Beats a minute: faster ones no hand keeps to."""
QUICKEST_S = 0.15
"""A pass that takes less is too quick for a hand, whatever rest follows; as is, to and fro, half a beat."""
FINEST_RAD, FINEST_M = math.radians(0.5), 2e-4
"""What is smaller no hand does on purpose."""
_ALIKE = 0.04  # of the seconds or of the way of two passes that are one step
_BEAT_LEAST_S = 60.0 / FASTEST
_BEAT_S = 1.0  # about so long is a beat of a slow pass
_SLOW_S = 1.5  # a pass that takes longer has more than one


class HandStep(NamedTuple):
    """What to do, in words; how long it takes; beats a minute (0 at rest); why a hand cannot, if so."""

    words: str
    seconds: float
    beats_per_minute: float
    cannot: str = ""


class _Pass(NamedTuple):
    """A move, or a rest where it stands: where from, where to, how long, and seconds of rest behind it."""

    start: float
    to: float
    seconds: float
    rest: float = 0.0


def by_hand(plan: MotionPlan, coordinate: Coordinate = "rotary") -> list[HandStep]:
    """Return what a hand would have to do, step by step, angles in degrees (mm on a linear axis)."""
    steps: list[HandStep] = []
    for run in _runs(plan):
        if isinstance(run, Waves):
            cannot = "waves are for a motor"
            steps.append(HandStep(f"a mixture of waves for {run.s:.2g} s", run.s, 0.0, cannot))
        else:
            steps += _folded(run, coordinate)
    return steps


def hand_can(steps: Sequence[HandStep]) -> bool:
    """Whether a hand can do all of it."""
    return not any(one.cannot for one in steps)


def in_words(steps: Sequence[HandStep], most: int = 8) -> str:
    """Return steps as numbered lines, the first of them where there are many, and what no hand can do."""
    shown = steps if len(steps) <= most else steps[: most - 1]
    lines = [
        f"  {n}. {one.words}" + (f" ({one.cannot})" if one.cannot else "") for n, one in enumerate(shown, 1)
    ]
    if len(shown) < len(steps):
        seconds = sum(one.seconds for one in steps[len(shown) :])
        lines.append(
            f"  and {len(steps) - len(shown)} steps more, {seconds:.2g} s; the workbench leads a hand through"
        )
    head = "By hand, without a motor:" if hand_can(steps) else "No hand can do all of this:"
    return "\n".join([head, *lines])


def _runs(plan: MotionPlan) -> list[list[_Pass] | Waves]:
    """Return stretches of moves and rests, and the waves between them."""
    runs: list[list[_Pass] | Waves] = []
    at = plan.start
    for part in plan.parts:
        if isinstance(part, Waves):
            runs.append(part)
            continue
        if not runs or isinstance(runs[-1], Waves):
            runs.append([])
        run = runs[-1]
        assert isinstance(run, list)
        if isinstance(part, Move):
            if part.seconds(at) > 0.0:
                run.append(_Pass(at, part.to, part.seconds(at)))
            at = part.to
        elif isinstance(part, Rest) and run:
            run[-1] = run[-1]._replace(rest=run[-1].rest + part.s)
        else:
            run.append(_Pass(at, at, 0.0, part.s))
    return runs


def _folded(run: Sequence[_Pass], coordinate: Coordinate) -> list[HandStep]:
    """Return passes as steps, each of as many as are alike."""
    steps = []
    first = 0
    while first < len(run):
        turned, climbed = _how_many(run, first, _turns_back), _how_many(run, first, _goes_on)
        many = max(turned, climbed)
        told = _to_and_fro if turned >= climbed else _stairs
        steps.append(told(run[first : first + many], coordinate))
        first += many
    return steps


def _how_many(run: Sequence[_Pass], first: int, follows: Callable[[_Pass, _Pass], bool]) -> int:
    end = first + 1
    while end < len(run) and follows(run[end - 1], run[end]):
        end += 1
    return end - first


def _alike(one: float, other: float) -> bool:
    return abs(one - other) <= _ALIKE * max(abs(one), abs(other), 1e-9)


def _turns_back(before: _Pass, after: _Pass) -> bool:
    same = _alike(before.seconds, after.seconds) and _alike(before.rest, after.rest)
    return same and abs(after.to - before.start) <= _ALIKE * abs(before.to - before.start)


def _goes_on(before: _Pass, after: _Pass) -> bool:
    same = _alike(before.seconds, after.seconds) and _alike(before.rest, after.rest)
    return same and before.to != before.start and _alike(after.to - after.start, before.to - before.start)


def _to_and_fro(passes: Sequence[_Pass], coordinate: Coordinate) -> HandStep:
    one, n = passes[0], len(passes)
    if one.to == one.start:
        return HandStep(f"rest for {one.rest:.2g} s", one.rest, 0.0)
    here, there = _place(one.start, coordinate), _place(one.to, coordinate)
    unit = _unit(coordinate)
    how = _pace(one, n)
    if n == 1:
        words = f"to {there} {unit}{how if one.seconds >= QUICKEST_S or one.rest else ''}"
    elif n < 4:
        again = f" and to {there} again" if n == 3 else ""
        words = f"to {there} {unit}, back to {here}{again}, one way{how}"
    else:
        odd = f", and once more to {there}" if n % 2 else ""
        words = f"to and fro between {here} and {there} {unit}, {n // 2} times, one way{how}{odd}"
    return _step(words, passes, coordinate)


def _stairs(passes: Sequence[_Pass], coordinate: Coordinate) -> HandStep:
    one, n = passes[0], len(passes)
    way = _place(abs(one.to - one.start), coordinate)
    to = _place(passes[-1].to, coordinate)
    unit = _unit(coordinate)
    return _step(f"in {n} steps of {way} {unit} to {to}, each{_pace(one, n)}", passes, coordinate)


def _step(words: str, passes: Sequence[_Pass], coordinate: Coordinate) -> HandStep:
    one = passes[0]
    finest = FINEST_RAD if coordinate == "rotary" else FINEST_M
    cannot = ""
    alone = len(passes) == 1  # a way to a place, for which a hand may take its time
    if abs(one.to - one.start) < (0.5 * finest if alone else finest):
        cannot = "too small for a hand"
    elif not alone and (one.seconds < QUICKEST_S or _beats(one, len(passes)) == 0.0):
        cannot = "too quick for a hand"
    seconds = sum(each.seconds + each.rest for each in passes)
    return HandStep(words, seconds, 0.0 if cannot else _tempo(one, len(passes)), cannot)


def _beats(one: _Pass, of: int) -> float:
    """Beats of a pass and the rest behind it, of so many: half a one each where two are a beat; 0: none."""
    whole = one.seconds + one.rest
    if whole > _SLOW_S:
        return float(round(whole / _BEAT_S))
    if whole >= _BEAT_LEAST_S:
        return 1.0
    return 0.5 if of > 1 and whole >= 0.5 * _BEAT_LEAST_S else 0.0  # what is done once needs no tempo


def _tempo(one: _Pass, of: int) -> float:
    """Beats a minute; 0 where there are none."""
    return 60.0 * _beats(one, of) / (one.seconds + one.rest)


def _pace(one: _Pass, of: int) -> str:
    beats, tempo = _beats(one, of), _tempo(one, of)
    rest = f", then {one.rest:.2g} s of rest" if one.rest else ""
    said = f" in {one.seconds:.2g} s{rest}"
    if tempo == 0.0:
        return said
    each = {0.5: "two on a beat, ", 1.0: ""}.get(beats, f"{beats:.0f} beats, ")
    return f"{said} ({each}{tempo:.0f} beats a minute)"


def _place(value: float, coordinate: Coordinate) -> str:
    shown = math.degrees(value) if coordinate == "rotary" else 1e3 * value
    return f"{round(shown, 1) + 0.0:g}"


def _unit(coordinate: Coordinate) -> str:
    return "degrees" if coordinate == "rotary" else "mm"
