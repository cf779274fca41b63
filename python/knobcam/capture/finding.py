"""One thing that the quality check found, in words a user can act on."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import NDArray

Severity = Literal["note", "masked", "warning"]
Rows = NDArray[np.int64]

MAX_ROWS = 5
"""Rows that a finding lists."""


@dataclass(frozen=True)
class Finding:
    """What was found: `count` samples of `column`, the first few `rows` (data rows of the file, from 1).

    `severity`: "masked" took samples out of use, "warning" should be looked at before trusting a fit,
    "note" is worth knowing.
    """

    kind: str
    column: str
    count: int
    rows: tuple[int, ...]
    message: str
    severity: Severity

    def __str__(self) -> str:
        return f"{self.severity}: {self.message}"


def first_rows(rows: Rows) -> tuple[int, ...]:
    """Return the first few of `rows`."""
    return tuple(int(row) for row in rows[:MAX_ROWS])


def rows_in_words(rows: Rows) -> str:
    """Return ascending `rows` as a message names them: `row 7`, `rows 3, 10-12 and 8 more`."""
    starts = np.concatenate(([0], np.flatnonzero(np.diff(rows) != 1) + 1))
    ends = np.concatenate((starts[1:], [len(rows)])) - 1
    spans = [(int(rows[starts[i]]), int(rows[ends[i]])) for i in range(min(MAX_ROWS, len(starts)))]
    shown = ", ".join(str(first) if first == last else f"{first}-{last}" for first, last in spans)
    left = len(rows) - sum(last - first + 1 for first, last in spans)
    return f"{'row' if len(rows) == 1 else 'rows'} {shown}" + (f" and {left} more" if left else "")
