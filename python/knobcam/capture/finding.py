"""One thing that the quality check found, in words a user can act on."""

from __future__ import annotations

from dataclasses import dataclass, replace
from itertools import islice
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from ..base.said import Advice, Said, joined

Severity = Literal["note", "masked", "mended", "warning"]
Rows = NDArray[np.int64]

MAX_ROWS = 5
"""Rows, or runs of rows, that a message lists."""

MAX_SPANS = 1000
"""Runs of rows that a finding keeps."""

_STANDS = {
    "non-finite": "what is no number cannot count",
    "backward": "a clock that goes back cannot be computed with",
    "duplicate": "a clock that stands cannot be computed with",
}
OVERRULED = {
    True: "overruled, so nothing was done about it: ",
    False: "overruled, so nothing is to be done about ",
}
"""How what a person overruled begins: what was found, and what was not looked for yet."""

_DONE = {"masked": "masked", "mended": "mended", "note": "none", "warning": "none"}


@dataclass(frozen=True)
class Finding:
    """What was found: `count` samples of `column`, in runs of rows from `spans[i][0]` to `spans[i][1]`.

    Rows are data rows of the file, from 1. `severity`: "masked" took samples out of use, "mended" changed
    what the evidence left no doubt about, "warning" should be looked at before trusting a fit, "note" is
    worth knowing. One that is `overruled` by a person changed nothing; it is a note.
    `found` is what was found, in words, and `advice` what could be done.
    """

    kind: str
    column: str
    count: int
    spans: tuple[tuple[int, int], ...]
    found: Said
    severity: Severity
    advice: Advice | None = None
    overruled: bool = False

    @property
    def told(self) -> Said:
        """What was found in a sentence, and that a person has overruled it."""
        return Said(OVERRULED[self.count > 0], self.found) if self.overruled else self.found

    @property
    def message(self) -> Said:
        """The same with what was done about it, and what could be."""
        if self.overruled:
            return self.told
        return joined("; ", (self.told, "masked" if self.severity == "masked" else "", self.advice))

    @property
    def key(self) -> str:
        """By what it is overruled: `wrap:theta`."""
        return f"{self.kind}:{self.column}"

    @property
    def stands(self) -> str:
        """Why nobody can overrule it; empty where one can."""
        return _STANDS.get(self.kind, "") if self.severity == "masked" else ""

    def over(self) -> Finding:
        """Return it as a person has overruled it."""
        return replace(self, severity="note", overruled=True)

    @property
    def rows(self) -> tuple[int, ...]:
        """The first few rows."""
        every = (row for first, last in self.spans for row in range(first, last + 1))
        return tuple(islice(every, MAX_ROWS))

    def document(self) -> dict[str, Any]:
        """Return it as JSON documents have it."""
        return {
            "kind": self.kind,
            "column": self.column,
            "count": self.count,
            "rows": [list(span) for span in self.spans],
            "message": self.message,
            "found": self.found.document(),
            "advice": str(self.advice or ""),
            "way": self.advice.way if self.advice else "",
            "done": _DONE[self.severity],
            "severity": self.severity,
            "overruled": self.overruled,
        }

    def __str__(self) -> str:
        return f"{self.severity}: {self.message}"


def spans(rows: Rows) -> tuple[tuple[int, int], ...]:
    """Return the runs, first and last, of ascending `rows`."""
    starts, ends = _runs(rows)
    ends = ends[:MAX_SPANS]
    return tuple((int(first), int(last)) for first, last in zip(starts[:MAX_SPANS], ends, strict=True))


def rows_in_words(rows: Rows) -> str:
    """Return ascending `rows` as a message names them: `row 7`, `rows 3, 10-12 and 8 more`."""
    runs = [(int(first), int(last)) for first, last in zip(*_runs(rows), strict=True)][:MAX_ROWS]
    shown = ", ".join(str(first) if first == last else f"{first}-{last}" for first, last in runs)
    left = len(rows) - sum(last - first + 1 for first, last in runs)
    return f"{'row' if len(rows) == 1 else 'rows'} {shown}" + (f" and {left} more" if left else "")


def _runs(rows: Rows) -> tuple[Rows, Rows]:
    """First and last row of each run."""
    breaks = np.flatnonzero(np.diff(rows) != 1)
    return rows[np.concatenate(([0], breaks + 1))], rows[np.concatenate((breaks, [len(rows) - 1]))]
