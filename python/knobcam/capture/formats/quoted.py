"""Rows in which a cell in quotes goes on in the next line, as spreadsheets and serial ports write them."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator

# A quote opens a cell where the cell begins, and two of them in it are one that is written.
_CELL = re.compile(r'(?:^|[,;\t])"(?:[^"]|"")*+("?)')
_MOST_LINES = 100  # of one row


def records(lines: Iterable[str]) -> Iterator[str]:
    """Yield the rows of a text, each in one line, with blanks for the line breaks in its cells.

    Where nothing closes a cell, the lines are yielded as they are.
    """
    rest = iter(lines)
    for line in rest:
        if not left_open(line):
            yield line
            continue
        parts = [line]
        for following in rest:
            parts.append(following)
            # Within a cell a line goes on as if it opened one.
            closed = not left_open(f'"{following}')
            if closed or len(parts) == _MOST_LINES:
                break
        if len(parts) > 1 and closed:
            yield " ".join(part.rstrip("\r\n") for part in parts) + "\n"
        else:
            yield from parts


def left_open(line: str) -> bool:
    """Whether a line ends within a cell in quotes."""
    return '"' in line and any(not cell[1] for cell in _CELL.finditer(line))
