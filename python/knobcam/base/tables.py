"""Tables: what a result says of itself, and the same as readable text."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

Rows = Sequence[Sequence[str]]


class TextTable(NamedTuple):
    """A table of text; without a head, the first cell of each row says what the others are."""

    caption: str
    head: Sequence[str]
    rows: Rows


def text_table(head: Sequence[str], rows: Rows) -> str:
    """Return columns aligned by spaces, the head on top."""
    lines = [list(head), *map(list, rows)]
    widths = [max(len(line[i]) for line in lines) for i in range(len(head))]
    return "\n".join(
        "  " + "  ".join(cell.ljust(width) for cell, width in zip(line, widths, strict=True)).rstrip()
        for line in lines
    )
