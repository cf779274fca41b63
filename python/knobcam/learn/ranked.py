"""Motions that were weighed, and the best of them."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

if TYPE_CHECKING:
    from collections.abc import Sequence

    from ..capture.motion_plan import MotionPlan
    from ..capture.motions import MotionTrack
    from .motion_space import Piece
    from .telling import Told

_FINALISTS = 4


class Scored(NamedTuple):
    """How good a motion is, the least D of its pairs, the most that any rival leaves, and its pieces."""

    score: float
    least: float
    most: float
    pieces: tuple[Piece, ...]


class Rated(NamedTuple):
    """A motion that is run as it is, how good it is, the least D of a pair, and all that it tells."""

    worth: float
    least: float
    motion: MotionPlan
    track: MotionTrack
    told: Told


def best_of(scored: Sequence[Scored]) -> list[tuple[Piece, ...]]:
    """Return the best motions of which none is of the same kind as another: what holds of one may of all."""
    kinds: dict[tuple[str, ...], tuple[Piece, ...]] = {}
    for one in sorted(scored, key=lambda one: -one.score):
        kinds.setdefault(tuple(piece.kind for piece in one.pieces), one.pieces)
    return [*kinds.values()][:_FINALISTS]
