"""The text that TwinCAT's scope exports: below titles a block of keys, then channels beside times in ms."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field
from typing import TextIO

import numpy as np
from numpy.typing import NDArray

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
_ONE = 1e-3  # of the shortest sample time, below which two channels were read at once


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
    """Return the channels, each with a row for all times at which any was read, blank where it was not.

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

    same = all(_together(matrix, groups[0], other) for other in groups)
    if same:
        rows = [np.arange(len(_ended(matrix[:, group.time]))) for group in groups]
        t = min((_ended(matrix[:, group.time]) for group in groups), key=len)
    else:
        t, rows = _all_times([_ended(matrix[:, group.time]) for group in groups])
        budget.numbers(len(t) * len(names))
    columns: dict[str, FloatArray] = {}
    stated: dict[str, str] = {}
    readings = [(at, group, own) for group, own in zip(groups, rows, strict=True) for at in group.channels]
    labels = ["t", *(names[at] for at, _, _ in readings)]
    if len(set(labels)) < len(labels):  # of two axes each channel is called alike, and its variable is not
        labels[1:] = [keys.get(_SYMBOL, names)[at] or names[at] for at, _, _ in readings]
    for name, (at, _, own) in zip(called(labels)[1:], readings, strict=True):
        columns[name] = np.full(max(len(t), own[-1] + 1), np.nan)
        columns[name][own] = matrix[: len(own), at]
        if unit := spelled_out(keys.get(_UNIT, names)[at].partition(" (")[0]):
            stated[name] = unit
    many = min(len(_ended(column)) for column in (t, *columns.values())) if same else len(t)
    cut = {name: column[:many] for name, column in columns.items()}
    return Table(source, "CSV", {"t": t[:many]} | cut, units={"t": "ms"} | stated)


def _all_times(times: list[FloatArray]) -> tuple[FloatArray, list[NDArray[np.intp]]]:
    """Return all of several clocks' times, and of each clock the rows in which its own are."""
    steps = [abs(float(own[-1] - own[0])) / (len(own) - 1) for own in times if len(own) > 1]
    tick = _ONE * min((step for step in steps if step), default=1.0)
    numbered = np.round(np.concatenate(times) / tick)
    _, first, rows = np.unique(numbered, return_index=True, return_inverse=True)
    return np.concatenate(times)[first], np.split(rows, np.cumsum([len(own) for own in times])[:-1])


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
