"""What is measured between the knocks of a play, and what explains nothing there."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from ..base.said import OfEffect, Said, said
from .rule import RULE

if TYPE_CHECKING:
    from ..capture.prepare import Prepared
    from .diagnose import Candidate
    from .fitting import Fit


def between_knocks(fit: Fit) -> tuple[Prepared, ...]:
    """Return what a fit was fitted to, without the rows around the knocks of its play, if it has one."""
    quiet = ((one, fit.core.model.without_knocks(one.core, fit.noise_floor)) for one in fit.prepared)
    return tuple(one if core is None else replace(one, core=core) for one, core in quiet)


def of_knocks_alone(candidate: Candidate, before: Fit) -> list[Said]:
    """Return that a candidate explains nothing between the knocks of a play, and little of what they leave.

    How a knock goes no law of a contact tells as well as it is measured. An effect that is there takes off
    what is left at knocks, however little else it does.
    """
    joint = before.model.joint
    if joint is None:
        return []
    taken, excess = np.zeros(2), 0.0
    parts = zip(
        before.prepared, between_knocks(before), before.residuals, candidate.fit.residuals, strict=True
    )
    for one, quiet, left, then in parts:
        knock = one.rows[one.used & ~quiet.used]
        gone = np.square(left) - np.square(then)
        taken += [np.sum(gone[rows]) for rows in (quiet.rows[quiet.used], knock)]
        excess += np.sum(np.square(left[knock])) - len(knock) * before.noise_floor**2
    if not 0.0 < taken[1] < RULE.mainly * excess:
        return []
    if taken[0] / np.sum(taken) * candidate.gain > RULE.price * candidate.count:
        return []
    return [
        said(
            "it explains nothing between the knocks of {joint}, and less than half of what is left at them",
            joint=OfEffect(joint),
        )
    ]
