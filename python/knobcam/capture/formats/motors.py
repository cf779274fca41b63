"""A log of several motors: side by side in columns, or one below the other and whose they are in a column."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from ...base.arrays import FloatArray
from .header import words_of
from .paths import of_joint
from .table import Table, check_joint, choose

_NUMBERS = frozenset({"id", "no", "nr", "number", "index"})
_MACHINES = frozenset(
    ("motor", "joint", "servo", "actuator", "axis", "node", "can", "drive", "device", "slave", "dxl")
)
_MOST = 64  # motors on one line; more values than these are counted rows
_FEWEST = 8  # rows of each


def of_one(table: Table, joint: str | None) -> Table:
    """Return the rows of one motor where a column numbers several: taken as one they leap at every row.

    InputError lists them where none was asked for.
    """
    if joint is not None and (own := of_joint(table, joint)) is not None:
        return own
    found = next(((name, ids) for name, ids in table.columns.items() if _numbers_motors(name, ids)), None)
    if found is None:
        check_joint(table.source, joint)
        return table
    name, ids = found
    rows = ids == float(choose(table.source, joint, [f"{one:g}" for one in np.unique(ids)], "motors"))
    columns = {
        other: column[rows] if column.shape == ids.shape else column
        for other, column in table.columns.items()
        if other != name
    }
    return replace(table, columns=columns)


def _numbers_motors(name: str, ids: FloatArray) -> bool:
    words = [word.lower() for word in words_of(name)]
    named = words == ["id"] or (len(words) > 1 and words[-1] in _NUMBERS and words[0] in _MACHINES)
    if not named or ids.ndim == 0 or not np.isfinite(ids).all() or (ids != np.round(ids)).any():
        return False
    several, rows = np.unique(ids, return_counts=True)
    return 1 < several.size <= _MOST and int(rows.min()) >= _FEWEST
