"""The text that TwinCAT's scope exports: below titles a block of keys, then channels beside times in ms."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field
from typing import TextIO

import numpy as np

from ...base.arrays import FloatArray
from ...errors import InputError
from .inflate import Budget
from .table import Table, called, check_width
from .units import spelled_out

_NAME, _SYMBOL, _UNIT = "Name", "SymbolName", "Unit"
_TITLE = "Starttime of export"
_MOST_LINES = 100  # above the first row
_SPARED = 0.01  # of the rows, by which the last reading of one channel may come later than another's
_SAME = 1e-6  # of a sample time, by which times differ as text


def separator(head: str) -> str | None:
    """Return what stands between the cells of a scope's export, None of any other text."""
    lines = head.replace('"', "").splitlines()[:_MOST_LINES]  # between blanks cells are quoted
    titles = (line[len(_TITLE) :] for line in lines if line.startswith(_TITLE))
    return (next(titles, "")[:1] or None) if lines and lines[0].startswith(_NAME) else None


@dataclass
class _Group:
    """Channels that stand behind one column of times."""

    time: int
    channels: list[int] = field(default_factory=list)


def read_scope(lines: TextIO, count: int, mark: str, budget: Budget) -> Table:
    """Return the channels that were read at the same times; one of other times says so where it is asked for.

    Channels follow a column of times each, or several do. A reading is as it was scaled: factors in the block
    are said there for the record. Where a channel has no more readings its cells are blank, or lack.
    """
    source = budget.source
    keys = _block(source, lines, mark)
    names = keys[_NAME]
    check_width(source, len(names))
    groups: list[_Group] = []
    for at, name in enumerate(names):
        if name == _NAME:
            groups.append(_Group(at))
        elif groups:
            groups[-1].channels.append(at)
    budget.numbers(count * len(names))
    matrix = _matrix(source, lines, mark, len(names))

    def alike(group: _Group) -> int:
        return sum(len(other.channels) for other in groups if _together(matrix, group, other))

    chosen = max(groups, key=alike)
    t = _ended(matrix[:, chosen.time])
    columns: dict[str, FloatArray] = {}
    broken: dict[str, str] = {}
    stated: dict[str, str] = {}
    readings = [(at, group) for group in groups for at in group.channels]
    labels = ["t", *(names[at] for at, _ in readings)]
    if len(set(labels)) < len(labels):  # of two axes each channel is called alike, and its variable is not
        labels[1:] = [keys.get(_SYMBOL, names)[at] or names[at] for at, _ in readings]
    for name, (at, group) in zip(called(labels)[1:], readings, strict=True):
        if not _together(matrix, chosen, group):
            broken[name] = f"column {name} was read at other times than most; export all with one sample time"
            continue
        columns[name] = matrix[:, at]
        if unit := spelled_out(keys.get(_UNIT, names)[at].partition(" (")[0]):
            stated[name] = unit
    rows = min(len(_ended(column)) for column in (t, *columns.values()))
    cut = {name: column[:rows] for name, column in columns.items()}
    return Table(source, "CSV", {"t": t[:rows]} | cut, broken, units={"t": "ms"} | stated)


def _block(source: str, lines: TextIO, mark: str) -> dict[str, list[str]]:
    """Return the rows of keys above the readings, by the key; leave `lines` behind the blank line below."""
    keys: dict[str, list[str]] = {}
    for _ in range(_MOST_LINES):
        line = lines.readline()
        cells = line.rstrip("\r\n").split(mark)
        if not line.strip() and len(keys.get(_UNIT, keys.get(_SYMBOL, ()))) > 1:
            # A line may end with a separator that no cell follows.
            width = len(keys[_NAME]) - (keys[_NAME][-1] == "")
            told = [keys[key] for key in (_NAME, _SYMBOL, _UNIT) if key in keys]
            if all(len(row) >= width and not any(row[width:]) for row in told):
                return {key: row[:width] for key, row in keys.items()}
            raise InputError(
                f"{source}: a scope's export in which names hold the separator {mark!r}; export it with "
                f"tabs or semicolons between columns"
            )
        keys[cells[0]] = cells
        if not line:
            break
    raise InputError(f"{source}: a scope's export without the lines of Name and Unit; export it as CSV again")


def _matrix(source: str, lines: TextIO, mark: str, width: int) -> FloatArray:
    rows = [*_rows(source, lines, mark, width)]
    if not rows:
        raise InputError(f"{source}: a header and no rows; a capture has columns of samples")
    return np.concatenate(rows).reshape(len(rows), width)


def _rows(source: str, lines: TextIO, mark: str, width: int) -> Iterator[FloatArray]:
    for number, line in enumerate(lines, 1):
        text = line.strip("\r\n")
        if not text.strip() or text.strip() == "EOF":
            continue
        cells = (text if mark == "," else text.replace(",", ".")).split(mark)[: width + 1]
        row = np.full(width, np.nan)
        try:
            for at, cell in enumerate(cells[:width]):
                if cell.strip():
                    row[at] = float(cell)
        except ValueError:
            raise InputError(
                f"{source}: row {number}: {cell.strip()[:40]!r} is not a number; correct the cell"
            ) from None
        yield row


def _ended(column: FloatArray) -> FloatArray:
    """Return a column up to its last reading."""
    read = np.flatnonzero(np.isfinite(column))
    return column[: read[-1] + 1 if len(read) else 0]


def _together(matrix: FloatArray, group: _Group, other: _Group) -> bool:
    """Whether the channels of two groups were read at the same times, but for the last few."""
    a, b = _ended(matrix[:, group.time]), _ended(matrix[:, other.time])
    fewer, more = sorted((len(a), len(b)))
    if fewer < 2 or more - fewer > 1 + _SPARED * more:
        return False
    step = abs(a[fewer - 1] - a[0]) / (fewer - 1)
    return bool(np.all(np.abs(a[:fewer] - b[:fewer]) <= _SAME * step))
