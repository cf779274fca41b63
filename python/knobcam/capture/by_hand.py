"""A motion in words for a person without a motor: steps in degrees, seconds and beats of a metronome.

What follows one another and is alike becomes one step: passes between the same ends, stairs with rests. A
motion that is made for a hand keeps to one metronome, of 60 to 120 beats a minute; of any other each step has
its own: a turning of the hand is a beat, a quick there and back one together, a longer pass has several.
"""

from __future__ import annotations

import math
from dataclasses import replace
from typing import TYPE_CHECKING, NamedTuple

from .motion_plan import MotionPlan, Move, Rest, Waves

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from .formats.units import Coordinate
    from .motion_plan import Part

FASTEST = 120.0
"""Beats a minute: faster ones no hand keeps to."""
QUICKEST_S = 0.15
"""A pass that takes less is too quick for a hand, whatever rest follows; as is, to and fro, half a beat."""
TEMPI = (60.0, 72.0, 84.0, 96.0, 108.0, FASTEST)
"""Beats a minute of the metronomes that a motion is made for."""
FINEST_RAD, FINEST_M = math.radians(1.0), 4e-4
"""What is smaller no hand does on purpose: at the rim of a knob a third of a millimetre."""
MOST_STEPS = 12
"""More that differ no hand keeps in mind, led or not."""
_STRETCHED = 1.15  # of its time, by which a motion may be slowed for a slower metronome
_ALIKE = 0.04  # of the seconds or of the way of two passes that are one step
_BEAT_LEAST_S = 60.0 / FASTEST
_BEAT_S = 1.0  # about so long is a beat of a slow pass
_OFF = 0.01  # of a beat: what keeps to a metronome
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
    runs = _runs(plan)
    tempo = _common(runs)
    for run in runs:
        if isinstance(run, Waves):
            cannot = "waves are for a motor"
            steps.append(HandStep(f"a mixture of waves for {run.s:.2g} s", run.s, 0.0, cannot))
        else:
            steps += _folded(run, coordinate, tempo)
    return steps


def on_beats(plan: MotionPlan, longest_s: float) -> MotionPlan:
    """Return a motion slowed so that every move and rest keeps to a metronome, and cut to be at most so long.

    What takes less than half a beat takes half a one, all else whole ones. Nothing becomes faster.
    """
    made = [_slowed(plan, 60.0 / tempo) for tempo in TEMPI]
    soon = [one for one in made if one.seconds <= _STRETCHED * plan.seconds]
    chosen = (soon or made[-1:])[0]
    parts: list[Part] = []
    at, left = chosen.start, longest_s
    for part in chosen.parts:
        left -= part.seconds(at)
        if left < 0.0:
            break
        parts.append(part)
        at = part.end(at)
    parts = parts or list(chosen.parts)
    return replace(chosen, parts=tuple(parts), about=f"{plan.about}, slowed to a metronome")


def hand_can(steps: Sequence[HandStep]) -> bool:
    """Whether a hand can do all of it, led by one metronome."""
    return len(steps) <= MOST_STEPS and len(_tempi(steps)) <= 1 and not any(one.cannot for one in steps)


def _tempi(steps: Sequence[HandStep]) -> set[float]:
    """The metronomes that steps ask for, beats a minute; what is done once, at once, asks for none."""
    return {one.beats_per_minute for one in steps if one.beats_per_minute}


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
    tempi = _tempi(steps)
    led = f", at {min(tempi):.0f} beats a minute" if len(tempi) == 1 else ""
    head = (
        "More steps or tempi than a hand keeps to (--by-hand asks for a motion that is led by one metronome):"
    )
    if hand_can(steps):
        head = f"By hand, without a motor{led}:"
    elif any(one.cannot for one in steps):
        head = "No hand can do all of this:"
    return "\n".join([head, *lines])


def _slowed(plan: MotionPlan, beat: float) -> MotionPlan:
    """Return a motion whose moves and rests take beats of so many seconds."""
    parts: list[Part] = []
    at, halves = plan.start, 0
    for part in plan.parts:
        takes = part.seconds(at)
        half = isinstance(part, Move) and 0.0 < takes <= 0.5 * beat
        if halves % 2 and not half:  # what comes next begins on a beat
            parts.append(Rest(0.5 * beat))
            halves = 0
        if isinstance(part, Rest):
            parts += [Rest(beat * round(takes / beat))] if round(takes / beat) else []
        elif isinstance(part, Move) and takes > 0.0:
            parts.append(_lasting(part, at, 0.5 * beat if half else beat * math.ceil(takes / beat - 1e-9)))
            halves += half
        elif isinstance(part, Waves):
            parts.append(part)
        at = part.end(at)
    return replace(plan, parts=tuple(parts) or plan.parts)


def _lasting(move: Move, at: float, seconds: float) -> Move:
    """Return a move that takes longer, by its speed."""
    way, hard = abs(move.to - at), move.acceleration
    under = max(0.0, seconds**2 - 2.0 * math.pi * way / hard)
    return replace(move, speed=hard * (seconds - math.sqrt(under)) / math.pi)


def _common(runs: Sequence[list[_Pass] | Waves]) -> float:
    """Beats a minute of the metronome that all of a motion keeps to; 0 where it keeps to none."""
    times = [s for run in runs if not isinstance(run, Waves) for one in run for s in (one.seconds, one.rest)]
    for tempo in TEMPI:
        beats = [s * tempo / 60.0 for s in times]
        if all(abs(one - 0.5) <= _OFF or abs(one - round(one)) <= _OFF for one in beats):
            return tempo if len(times) > 2 else 0.0
    return 0.0


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


def _folded(run: Sequence[_Pass], coordinate: Coordinate, tempo: float) -> list[HandStep]:
    """Return passes as steps, each of as many as are alike."""
    steps = []
    first = 0
    while first < len(run):
        turned, climbed = _how_many(run, first, _turns_back), _how_many(run, first, _goes_on)
        many = max(turned, climbed)
        told = _to_and_fro if turned >= climbed else _stairs
        steps.append(told(run[first : first + many], coordinate, tempo))
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


def _to_and_fro(passes: Sequence[_Pass], coordinate: Coordinate, tempo: float) -> HandStep:
    one, n = passes[0], len(passes)
    if one.to == one.start:
        return HandStep(f"rest for {_lasts(one.rest, tempo)}", one.rest, tempo)
    here, there = _place(one.start, coordinate), _place(one.to, coordinate)
    unit = _unit(coordinate)
    how = _pace(one, n, tempo)
    if n == 1:
        words = f"to {there} {unit}{how if one.seconds >= QUICKEST_S or one.rest else ''}"
    elif n < 4:
        again = f" and to {there} again" if n == 3 else ""
        words = f"to {there} {unit}, back to {here}{again}, one way{how}"
    else:
        odd = f", and once more to {there}" if n % 2 else ""
        words = f"to and fro between {here} and {there} {unit}, {n // 2} times, one way{how}{odd}"
    return _step(words, passes, coordinate, tempo)


def _stairs(passes: Sequence[_Pass], coordinate: Coordinate, tempo: float) -> HandStep:
    one, n = passes[0], len(passes)
    way = _place(abs(one.to - one.start), coordinate)
    to = _place(passes[-1].to, coordinate)
    unit = _unit(coordinate)
    return _step(
        f"in {n} steps of {way} {unit} to {to}, each{_pace(one, n, tempo)}", passes, coordinate, tempo
    )


def _step(words: str, passes: Sequence[_Pass], coordinate: Coordinate, tempo: float) -> HandStep:
    one = passes[0]
    finest = FINEST_RAD if coordinate == "rotary" else FINEST_M
    cannot = ""
    alone = len(passes) == 1  # a way to a place, for which a hand may take its time
    if abs(one.to - one.start) < (0.5 * finest if alone else finest):
        cannot = "too small for a hand"
    elif not alone and (one.seconds < QUICKEST_S or _beats(one, len(passes)) == 0.0):
        cannot = "too quick for a hand"
    seconds = sum(each.seconds + each.rest for each in passes)
    return HandStep(words, seconds, 0.0 if cannot else tempo or _tempo(one, len(passes)), cannot)


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


def _pace(one: _Pass, of: int, tempo: float) -> str:
    rest = f", then {_lasts(one.rest, tempo)} of rest" if one.rest else ""
    said = f" in {_lasts(one.seconds, tempo)}{rest}"
    own = 0.0 if tempo else _tempo(one, of)
    if own == 0.0:
        return said
    beats = _beats(one, of)
    each = {0.5: "two on a beat, ", 1.0: ""}.get(beats, f"{beats:.0f} beats, ")
    return f"{said} ({each}{own:.0f} beats a minute)"


def _lasts(seconds: float, tempo: float) -> str:
    """A time in beats of a metronome, in seconds without one."""
    beats = round(2.0 * seconds * tempo / 60.0) / 2.0
    if tempo == 0.0:
        return f"{seconds:.2g} s"
    return {0.5: "half a beat", 1.0: "one beat"}.get(beats, f"{beats:g} beats")


def _place(value: float, coordinate: Coordinate) -> str:
    shown = math.degrees(value) if coordinate == "rotary" else 1e3 * value
    return f"{round(shown, 1) + 0.0:g}"


def _unit(coordinate: Coordinate) -> str:
    return "degrees" if coordinate == "rotary" else "mm"
