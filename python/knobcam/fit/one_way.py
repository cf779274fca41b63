"""What a motion that goes one way only cannot tell: a friction along the way from a torque along it."""

from __future__ import annotations

from typing import TYPE_CHECKING, Literal

import numpy as np

from .rule import RULE

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence

    from ..base.arrays import FloatArray
    from ..capture.prepare import Prepared
    from .diagnose import Candidate

_ONE_WAY = 0.02  # less of the way than this in one direction tells nothing of it


def one_way(prepared: Iterable[Prepared]) -> Literal["forward", "backward"] | None:
    """Return which way captures go in the rows that count, if they go no other."""
    return goes(np.concatenate([one.omega[one.used] for one in prepared]))


def goes(omega: FloatArray) -> Literal["forward", "backward"] | None:
    """Return which way a motion of these velocities goes, if it goes no other."""
    forward = float(np.sum(omega[omega > 0.0]))
    backward = -float(np.sum(omega[omega < 0.0]))
    if min(forward, backward) >= _ONE_WAY * (forward + backward):
        return None
    return "forward" if forward > backward else "backward"


def twins(candidates: Sequence[Candidate], best: Candidate | None) -> frozenset[str]:
    """Return the effects that are the best one but for the sign of a motion, which has only one.

    Each has waves that were looked for by itself, so that one may take off a little less than the other.
    """
    if best is None or not best.row.along or one_way(best.fit.prepared) is None:
        return frozenset()
    least = (1.0 - RULE.one_way) * best.gain
    alike = [one for one in candidates if one.row.along and one.gain >= least]
    return frozenset(one.effect for one in alike if one.row.friction != best.row.friction)
