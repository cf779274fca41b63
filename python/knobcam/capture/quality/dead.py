"""Columns that stand still while others say that the knob moves: a sensor that was off."""

from __future__ import annotations

import numpy as np

from ...base.arrays import BoolArray, FloatArray
from ..finding import Finding, Rows, rows_in_words, spans

_FEWEST = 100  # rows in a row, below which a value that stands is no fault
_TIMES = 10  # as long as the longest stand but for the dead ones
_PART = 0.02  # of all the way that the knob goes: what it must go meanwhile
_OFTEN = 2  # stands: what stands still again and again is a motor that is off, or dry friction
_EVEN = 1e-6  # steps that differ by less are those of a motion without noise, as simulations have


def check_dead(
    columns: dict[str, FloatArray], usable: BoolArray, rows: Rows
) -> tuple[BoolArray, list[Finding]]:
    """Return the rows at which torque or angle stand still while the knob moves, and the findings.

    What moves the knob changes from row to row, if only by noise; and where a velocity is measured the angle
    follows it.
    """
    dead = np.zeros(len(rows), dtype=np.bool_)
    findings = []
    index = np.flatnonzero(usable)
    theta = columns["theta"][index]
    moved = {"tau": np.abs(np.diff(theta, prepend=theta[0]))}
    if "omega" in columns:
        moved["theta"] = np.abs(columns["omega"][index])
    for name, way in moved.items():
        at = np.zeros(len(index), dtype=np.bool_)
        stands = _stands(columns[name][index])
        for first, end in stands if len(stands) <= _OFTEN else ():
            part = way[first + 1 : end]
            if part.sum() >= _PART * way.sum() and np.ptp(part) > _EVEN * part.max():
                at[first:end] = True
        if not at.any():
            continue
        dead[index[at]] = True
        found = rows[index[at]]
        message = (
            f"{name}: stands still in {len(found)} rows ({rows_in_words(found)}) while the knob moves, "
            "as if its sensor was off; masked"
        )
        findings.append(Finding("dead", name, len(found), spans(found), message, "masked"))
    return dead, findings


def _stands(values: FloatArray) -> list[tuple[int, int]]:
    """Return the runs of one value, first and end, that are far longer than all others."""
    edges = np.concatenate(([0], np.flatnonzero(np.diff(values) != 0.0) + 1, [len(values)]))
    lengths = np.diff(edges)
    long = lengths >= _FEWEST
    ordinary = int(lengths[~long].max(initial=1))
    long &= (lengths >= _TIMES * ordinary) & (lengths < len(values))  # a column that never changes is stuck
    return [
        (int(first), int(first + length))
        for first, length in zip(edges[:-1][long], lengths[long], strict=True)
    ]
