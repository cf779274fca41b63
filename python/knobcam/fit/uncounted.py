"""Whether a log tells nothing of what is missing: what it shows does not count, or is of time alone."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from ..base.remembered import remembered

if TYPE_CHECKING:
    from collections.abc import Sequence

    from ..capture.prepare import Prepared

_MOVING = 0.02  # of the fastest: what is slower is at rest
_HARDLY = 0.02  # of the rows
_FEWEST = 3  # rows, of which two are on any line
_STRAIGHT = 1e-3  # of its range, that a torque keeps to a straight line over time: of a motion none does
_MOST = 0.9  # of the squared torque: a servo that creeps for most of a run has 0.8


def at_rest(prepared: Sequence[Prepared]) -> str | None:
    """Return that hardly a row counts, though nothing is wrong with them; None where it is not so."""
    known = sum(int(one.capture.mask[one.rows].sum()) for one in prepared)
    counted = sum(int(one.used.sum()) for one in prepared)
    if not 0 < counted <= _HARDLY * known:  # where none does the core says so
        return None
    return (
        f"in {known - counted} of {known} rows nobody knows which way it goes, as of what is held or stands "
        "still; record a motion"
    )


def tells_nothing(prepared: Sequence[Prepared]) -> str | None:
    """Return why nothing that is missing can be told of captures, whatever their noise; None where it can."""
    return uncounted(prepared) or ramped(prepared)


def ramped(prepared: Sequence[Prepared]) -> str | None:
    """Return that the torque is a straight line over time in all captures; None where it is not.

    Then it is no answer to the motion, and whatever changes as time goes on draws it without any knob.
    """
    if not prepared:
        return None
    for one in prepared:
        t, tau = one.capture.t[one.rows][one.used], one.capture.tau[one.rows][one.used]
        if len(t) < _FEWEST:
            return None
        line = np.polynomial.Polynomial.fit(t, tau, 1)
        if np.max(np.abs(tau - line(t))) > _STRAIGHT * np.ptp(tau):
            return None
    return (
        "the torque is a straight line over time, as one that was commanded: whatever changes with time "
        "draws it, a drift or friction that grows, without any knob; let it rise and fall several times, or "
        "record one that was measured"
    )


def uncounted(prepared: Sequence[Prepared]) -> str | None:
    """Return that most of the torque of a motion is in rows that do not count; None where it is not.

    Where nobody knows which way a knob at rest is about to go, neither does a model within the reach of the
    filter: starts that are shorter than that are lost, and with them what tells of inertia.
    """
    counted = whole = 0.0
    for one in prepared:
        more, all_of_it = _squares(one)
        counted, whole = counted + more, whole + all_of_it
    if whole == 0.0 or counted > (1.0 - _MOST) * whole:
        return None
    share = 100.0 * (1.0 - counted / whole)
    return (
        f"{share:.0f} % of the torque of the motion, by its squares, is in rows that do not count, as starts "
        "from rest, where its direction is not known within the reach of the filter: what they tell is not "
        "in the values; turn slowly between them, or prepare it with --prepare paper"
    )


@remembered  # every headline asks, and a page says one at each change
def _squares(one: Prepared) -> tuple[float, float]:
    """Return the squares of the torque of the motion: of the rows that count, and of all."""
    omega, tau = one.omega, one.tau
    known = one.capture.mask[one.rows] & np.isfinite(tau) & np.isfinite(omega)
    moves = known & (np.abs(omega) > _MOVING * np.max(np.abs(omega[known]), initial=0.0))
    squares = np.square(tau - (np.mean(tau[moves]) if moves.any() else 0.0))
    return float(np.sum(squares[moves & one.used])), float(np.sum(squares[moves]))
