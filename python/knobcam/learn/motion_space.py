"""The motions that an experiment is chosen from, each by a few numbers between 0 and 1.

Passes at one speed, passes at many, small loops around reversals, moves with rests, bounded Fourier series,
and sequences of these: what presliding, gaps, soft joints, friction that depends on speed, and maps of
position each need to show.
"""

from __future__ import annotations

import math
from dataclasses import replace
from itertools import zip_longest
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from ..capture.motion_plan import MotionPlan, Move, Rest, Waves
from ..capture.motions import MotionTrack
from ..capture.motions import motion as make_motion

if TYPE_CHECKING:
    from collections.abc import Callable

    from ..capture.motion_plan import Part
    from .limits import Limits

Numbers = tuple[float, ...]
COUNT = 5
"""Numbers of a piece of a motion."""
_SLOWEST = 3e-3  # of the fastest speed
_SMALLEST = 2e-3  # of the range of angles
_GENTLEST = 3e-2  # of the largest acceleration
_HARMONICS = 24
_HIGHEST_HZ = 12.0
_LEAST_S = 0.25
_BRIEFEST_S = 0.06  # of a move: what reverses faster no rig follows, and no sensor knows which way it goes
_MOST_MOVES = 4000
_NOTHING = "nothing"


class Piece(NamedTuple):
    """A part of a motion: its kind, its numbers, and its share of the time."""

    kind: str
    numbers: Numbers
    share: float


def plan(pieces: tuple[Piece, ...], limits: Limits, eased: float = 1.0) -> MotionPlan:
    """Return the motion of some pieces within limits, its speeds and accelerations eased by a factor."""
    start = min(max(0.0, limits.theta_min_rad), limits.theta_max_rad)
    # The last sample is at rest.
    left = limits.duration_s - 2.0 / limits.sample_rate_hz
    total = sum(piece.share for piece in pieces)
    parts: list[Part] = []
    words = []
    at = start
    for piece in pieces:
        seconds = left * piece.share / total
        made, said = _KINDS[piece.kind](piece.numbers, limits, eased, seconds, at)
        for part in made:
            parts.append(part)
            at = part.end(at)
        words.append(said)
    if not parts:
        parts = [Rest(_LEAST_S)]
    told = [one for one in words if one != _NOTHING] or [_NOTHING]
    return MotionPlan(tuple(parts), start, "; then ".join(told))


def standard(name: str, limits: Limits, rate_hz: float, eased: float = 1.0) -> MotionTrack:
    """Return a standard motion, made as large as limits let it be, or smaller by a factor."""
    track = make_motion(name, limits.duration_s, rate_hz)
    theta = track.theta - 0.5 * (float(np.min(track.theta)) + float(np.max(track.theta)))
    size = eased * min(
        limits.half / float(np.max(np.abs(theta))),
        limits.omega_rad_s / float(np.max(np.abs(track.omega))),
        limits.alpha_rad_s2 / float(np.max(np.abs(track.alpha))),
    )
    return MotionTrack(track.t, limits.middle + size * theta, size * track.omega, size * track.alpha)


def bank() -> list[tuple[Piece, ...]]:
    """Return motions of every kind to begin with, of each kind one in turn: who stops early has seen all."""
    kinds: list[list[tuple[Piece, ...]]] = [
        [
            (Piece(kind, (a, b, 0.5, c, 0.3), 1.0),)
            for a in ((0.2, 0.8) if kind == "loops" else (0.2, 0.8, 1.0))
            for b, c in _PAIRS[kind]
        ]
        for kind in _KINDS
    ]
    slow = Piece("loops", (0.3, 0.5, 0.5, 0.5, 0.3), 0.5)
    both = [(slow, Piece(kind, (0.9, 0.9, 0.5, 0.9, 0.3), 0.5)) for kind in ("waves", "passes", "speeds")]
    return [one for turn in zip_longest(*kinds, both) for one in turn if one is not None]


def changed(pieces: tuple[Piece, ...], rng: np.random.Generator, by: float) -> tuple[Piece, ...]:
    """Return a motion not far from another: numbers moved, and now and then a piece more, or one less."""
    if len(pieces) < 3 and rng.random() < 0.15:
        kind = str(rng.choice(list(_KINDS)))
        more = Piece(kind, tuple(rng.random(COUNT).tolist()), 0.2 + 0.6 * float(rng.random()))
        place = int(rng.integers(len(pieces) + 1))
        return (*pieces[:place], more, *pieces[place:])
    if len(pieces) > 1 and rng.random() < 0.1:
        gone = int(rng.integers(len(pieces)))
        return (*pieces[:gone], *pieces[gone + 1 :])
    moved = []
    for piece in pieces:
        numbers = np.asarray(piece.numbers) + by * rng.standard_normal(COUNT)
        share = piece.share * math.exp(by * float(rng.standard_normal()))
        moved.append(
            piece._replace(numbers=tuple(_folded(numbers).tolist()), share=min(max(share, 0.1), 1.0))
        )
    return tuple(moved)


def _folded(x: np.ndarray) -> np.ndarray:
    """Numbers between 0 and 1, thrown back at both ends."""
    x = np.mod(np.abs(x), 2.0)
    return np.where(x > 1.0, 2.0 - x, x)


def _between(low: float, high: float, u: float) -> float:
    """Return what lies between two numbers, in steps of equal ratio."""
    return float(low * (high / low) ** u)


def _times(moves: int) -> str:
    """Return how often moves one way and the other go to and fro, for people."""
    n = -(-moves // 2)
    return "once" if n == 1 else f"{n} times"


def _of(n: int, what: str) -> str:
    """Return a number of things for people."""
    return f"one {what}" if n == 1 else f"{n} {what}s"


class _Filling:
    """Moves one after the other until their time is over."""

    def __init__(self, at: float, seconds: float) -> None:
        self.parts: list[Part] = []
        self.speeds: list[float] = []  # that the moves reach, on their way and with their acceleration
        self.at, self.left = at, seconds

    def put(self, part: Part) -> bool:
        """Add a part if there is time for it; a move that would be too brief is made gentler."""
        if isinstance(part, Move) and part.seconds(self.at) < _BRIEFEST_S:
            gentle = 2.0 * math.pi * abs(part.to - self.at) / _BRIEFEST_S**2
            part = replace(part, acceleration=min(part.acceleration, max(gentle, 1e-12)))
        takes = part.seconds(self.at)
        if takes > self.left or len(self.parts) >= _MOST_MOVES:
            return False
        self.left -= takes
        self.parts.append(part)
        if isinstance(part, Move):
            self.speeds.append(part.profile(self.at)[0])
        self.at = part.end(self.at)
        return True

    def fastest(self) -> float:
        """Return the largest speed of the moves after the one to where they begin; 0 where there is none."""
        return max(self.speeds[1:], default=0.0)

    def told(self, times: int, words: str, limits: Limits) -> tuple[list[Part], str]:
        """Return its parts and what they are; without time for more than the way to where it begins, that."""
        way = f"a move to {self.at:.3g} {limits.unit}" if self.parts else _NOTHING
        return self.parts, words if times else way


def _span(u: float, place: float, limits: Limits) -> tuple[float, float]:
    """Return two angles a share of the range apart, about a place in it."""
    half = limits.half * u
    middle = limits.middle + (2.0 * place - 1.0) * (limits.half - half)
    return middle - half, middle + half


def _passes(u: Numbers, limits: Limits, eased: float, seconds: float, at: float) -> tuple[list[Part], str]:
    low, high = _span(_between(0.05, 1.0, u[0]), u[2], limits)
    speed = eased * _between(_SLOWEST, 1.0, u[1]) * limits.omega_rad_s
    hard = eased * _between(_GENTLEST, 1.0, u[3]) * limits.alpha_rad_s2
    swift = eased * limits.omega_rad_s
    # So slow that one pass takes longer than there is: as far as it comes.
    reach = min(high - low, 0.45 * speed * seconds)
    middle = 0.5 * (low + high)
    low, high = middle - 0.5 * reach, middle + 0.5 * reach
    filling = _Filling(at, seconds)
    filling.put(Move(low, swift, hard))
    ends = 0
    while filling.put(Move((high, low)[ends % 2], speed, hard)):
        ends += 1
    way = f"{high - low:.3g} {limits.unit} at {filling.fastest():.3g} {limits.unit}/s"
    return filling.told(ends, f"to and fro over {way}, {_times(ends)}", limits)


def _speeds(u: Numbers, limits: Limits, eased: float, seconds: float, at: float) -> tuple[list[Part], str]:
    low, high = _span(_between(0.05, 1.0, u[0]), u[2], limits)
    slowest = eased * _between(_SLOWEST, 0.5, u[1]) * limits.omega_rad_s
    fastest = eased * limits.omega_rad_s
    hard = eased * _between(_GENTLEST, 1.0, u[3]) * limits.alpha_rad_s2
    filling = _Filling(at, seconds)
    filling.put(Move(low, fastest, hard))
    steps = 2 + round(8 * u[4])
    ends = 0
    while True:
        speed = _between(slowest, fastest, ends // 2 % steps / max(steps - 1, 1))
        # A slow pass goes no farther than its share of the time lets it.
        way = min(high - low, speed * seconds / (2.0 * steps))
        there = (low + way, low)[ends % 2]
        if not filling.put(Move(there, speed, hard)):
            break
        ends += 1
    reached = filling.speeds[1:] or [slowest]
    many = len({f"{one:.3g}" for one in reached})
    speeds = f"{min(reached):.3g} to {max(reached):.3g} {limits.unit}/s, {many} speeds"
    words = f"each time faster: {speeds}" if many > 1 else f"at {reached[0]:.3g} {limits.unit}/s"
    return filling.told(ends, f"to and fro {_times(ends)}, {words}", limits)


def _loops(u: Numbers, limits: Limits, eased: float, seconds: float, at: float) -> tuple[list[Part], str]:
    size = _between(_SMALLEST, 0.5, u[0]) * 2.0 * limits.half
    speed = eased * _between(_SLOWEST, 1.0, u[1]) * limits.omega_rad_s
    hard = eased * _between(_GENTLEST, 1.0, u[3]) * limits.alpha_rad_s2
    swift = eased * limits.omega_rad_s
    places = 1 + round(6 * u[2])
    low, high = _span(1.0 - size / (2.0 * limits.half), 0.5, limits)
    filling = _Filling(at, seconds)
    moves = reached = 0
    fastest = 0.0
    for place in range(places):
        there = low + (high - low) * (place + 0.5) / places
        until = seconds * (places - place - 1) / places
        if not filling.put(Move(there, swift, eased * limits.alpha_rad_s2)):
            break
        side, before = 1.0, moves
        while filling.left > until and filling.put(Move(there + side * 0.5 * size, speed, hard)):
            side, moves, fastest = -side, moves + 1, max(fastest, filling.speeds[-1])
        reached += moves > before
    small = f"{1e3 * size:.3g} mm" if limits.unit == "m" else f"{math.degrees(size):.3g} degrees"
    way = small if size < 1.0 else f"{size:.3g} {limits.unit}"
    times = f"{_of(moves, 'move')} at {_of(reached, 'place')}"
    words = f"slow to and fro within {way} at {fastest:.3g} {limits.unit}/s, {times}"
    return filling.told(moves, words, limits)


def _rests(u: Numbers, limits: Limits, eased: float, seconds: float, at: float) -> tuple[list[Part], str]:
    low, high = _span(_between(0.05, 1.0, u[0]), 0.5, limits)
    speed = eased * _between(_SLOWEST, 1.0, u[1]) * limits.omega_rad_s
    hard = eased * _between(_GENTLEST, 1.0, u[3]) * limits.alpha_rad_s2
    rest = _between(0.02, 0.5, u[2])
    steps = 1 + round(9 * u[4])
    filling = _Filling(at, seconds)
    filling.put(Move(low, eased * limits.omega_rad_s, hard))
    moves = 0
    while True:
        up = moves % (2 * steps)
        level = (up + 1 if up < steps else 2 * steps - up - 1) / steps
        if not (filling.put(Move(low + level * (high - low), speed, hard)) and filling.put(Rest(rest))):
            break
        moves += 1
    rests = f" with rests of {rest:.2g} s between" if moves > 1 else ""
    words = f"{_of(moves, 'move')} at {filling.fastest():.3g} {limits.unit}/s{rests}"
    return filling.told(moves, words, limits)


def _waves(u: Numbers, limits: Limits, eased: float, seconds: float, at: float) -> tuple[list[Part], str]:
    if seconds < 2.0 * _LEAST_S:
        return [], _NOTHING
    hard = eased * limits.alpha_rad_s2
    go = Move(limits.middle, eased * limits.omega_rad_s, hard)
    takes = go.seconds(at)
    parts: list[Part] = [go] if 0.0 < takes < 0.3 * seconds else []
    middle = limits.middle if parts else at
    seconds -= takes if parts else 0.0
    if seconds < 2.0 * _LEAST_S:
        return parts, _NOTHING
    rng = np.random.default_rng(int(u[2] * 1e6))
    highest = _between(0.5, _HIGHEST_HZ, u[1])
    fundamental = max(1.0 / seconds, highest / _HARMONICS)
    orders = np.arange(1, max(1, min(_HARMONICS, round(highest / fundamental))) + 1)
    phases = rng.uniform(0.0, 2.0 * math.pi, len(orders))
    sizes = orders ** -(2.0 * u[4])
    shape = Waves(
        seconds,
        min(0.3, 0.4 * seconds),
        fundamental,
        tuple((sizes * np.sin(phases)).tolist()),
        tuple((sizes * np.cos(phases)).tolist()),
    )
    t = np.linspace(0.0, seconds, 1 + round(seconds * max(200.0, 20.0 * highest)))
    theta, omega, alpha = shape.along(t, 0.0)
    room = min(limits.theta_max_rad - middle, middle - limits.theta_min_rad)
    size = 0.98 * min(
        room / float(np.max(np.abs(theta))),
        eased * limits.omega_rad_s / float(np.max(np.abs(omega))),
        hard / float(np.max(np.abs(alpha))),
    )
    size = max(size, 0.0) * (0.2 + 0.8 * u[0])
    sine, cosine = (tuple(size * x for x in part) for part in (shape.sine, shape.cosine))
    parts.append(Waves(seconds, shape.swell_s, fundamental, sine, cosine))
    return parts, f"a mixture of waves of {fundamental:.2g} to {orders[-1] * fundamental:.3g} Hz"


_KINDS: dict[str, Callable[[Numbers, Limits, float, float, float], tuple[list[Part], str]]] = {
    "passes": _passes,
    "speeds": _speeds,
    "loops": _loops,
    "rests": _rests,
    "waves": _waves,
}
# Of each kind where its second and fourth number begin: speeds (or frequencies) and accelerations.
_PAIRS: dict[str, tuple[tuple[float, float], ...]] = {
    "passes": ((0.3, 0.8), (0.65, 0.8), (1.0, 1.0)),
    "speeds": ((0.0, 0.8), (0.5, 1.0)),
    "loops": ((0.3, 0.5), (0.6, 0.8), (0.9, 1.0)),
    "rests": ((0.5, 0.8), (0.9, 1.0)),
    "waves": ((0.3, 0.5), (0.6, 0.5), (0.9, 0.5)),
}
