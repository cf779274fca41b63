"""Rows in which a motor that a voltage drives was let go: open, it has no back-EMF, which elsewhere it has.

Volts are torque and back-EMF together, R tau / kt + ke omega. Where the driver lets go both are gone at
once, so that rows of either kind are no one model's: between them they bend friction, even below zero.
"""

from __future__ import annotations

import numpy as np

from ...base.arrays import BoolArray, FloatArray
from ...base.said import said
from ..finding import Finding, Rows, rows_in_words, spans
from .dead import agrees, rigid_windows, stands

_SURE = 4.0  # standard errors by which the back-EMF must be told, and must be gone
_GONE = 0.5  # of what is in proportion to the speed elsewhere: friction of that kind may stay


def check_let_go(
    columns: dict[str, FloatArray], usable: BoolArray, rows: Rows
) -> tuple[BoolArray, list[Finding]]:
    """Return the rows at which a voltage is zero while the knob moves without back-EMF, and the finding.

    A driver that commands zero shorts the motor: its back-EMF brakes it there as elsewhere; those rows count.
    """
    off = np.zeros(len(rows), dtype=np.bool_)
    index = np.flatnonzero(usable)
    zero = [
        (first, end) for first, end in stands(columns["tau"][index]) if columns["tau"][index[first]] == 0.0
    ]
    if not zero or sum(end - first for first, end in zero) >= len(index):
        return off, []
    windows = rigid_windows(columns, index, zero)
    if windows is None or not _without(*windows):
        return off, []
    for first, end in zero:
        off[index[first:end]] = True
    found = rows[off]
    what = said(
        "{tau}: is zero in {count} rows ({rows}) while the knob moves without the back-EMF that the other "
        "rows have: the motor was off, and its voltage says nothing there",
        count=len(found),
        rows=rows_in_words(found),
    )
    return off, [Finding("let_go", "tau", len(found), spans(found), what, "masked")]


def _without(signatures: FloatArray, torque: FloatArray, standing: BoolArray) -> bool:
    """Return whether what goes with the speed, the second signature, is gone where a torque stands."""
    columns = np.column_stack([signatures, signatures[:, 1] * standing])
    free = len(torque) - columns.shape[1]
    if free < 1:
        return False
    inverse = np.linalg.pinv(columns.T @ columns, rcond=1e-12)
    factors = inverse @ (columns.T @ torque)
    rest = torque - columns @ factors
    se = np.sqrt(np.diag(inverse) * float(rest @ rest) / free)
    elsewhere, change = factors[1], factors[-1]
    told = elsewhere > _SURE * se[1] and change < -max(_SURE * se[-1], _GONE * elsewhere)
    # A voltage that was only not logged takes inertia and weight with it.
    return bool(told and agrees(columns, torque, standing))
