"""Parquet files of many captures: rows of samples with a column `capture`, or a row each with lists."""

from __future__ import annotations

from collections.abc import Iterator
from functools import lru_cache
from typing import TYPE_CHECKING, Any

import numpy as np

from ..base.optional import require
from ..capture.formats.table import Table
from ..errors import InputError
from . import places

if TYPE_CHECKING:
    from .sources import Source

KEY = "capture"
Inside = tuple[str, tuple[int, int], dict[str, str]]
"""Key of a capture, its first row and their number, and what it belongs to."""


@lru_cache(maxsize=4096)  # a station asks again and again
def captures_in(place: str, stamp: str) -> tuple[Inside, ...] | None:
    """Return the captures in a Parquet file that has a column `capture`; None for any other file.

    `stamp` tells another content of it. A damaged file is a capture that cannot be read, which is said when
    it is.
    """
    parquet = require("pyarrow.parquet", "a Parquet file", "fleet")
    with places.opened(place) as stream:
        try:
            file = parquet.ParquetFile(stream)
            if KEY not in file.schema_arrow.names:
                return None
        except Exception:  # whatever a damaged file makes of it
            return None
        return tuple(_listed(place, file))


def _listed(place: str, file: Any) -> Iterator[Inside]:
    from .sources import LABELS

    names = [one for one in (KEY, *LABELS) if one in file.schema_arrow.names]
    seen: set[str] = set()
    lists = _has_lists(file)
    start, row, last = 0, 0, None
    for batch in file.iter_batches(columns=names):
        columns = {name: batch.column(name).cast("string").to_pylist() for name in names}
        for each in zip(*(columns[name] for name in names), strict=True):
            # Of lists every row is a capture; of samples all that follow one another with one key.
            if last is not None and (each[0] != last[0] or lists):
                yield _one(place, seen, names, last, (start, row - start))
                start = row
            row, last = row + 1, each
    if last is not None:
        yield _one(place, seen, names, last, (start, row - start))


def _has_lists(file: Any) -> bool:
    return any(str(field.type).startswith(("list", "large_list")) for field in file.schema_arrow)


def _one(place: str, seen: set[str], names: list[str], values: Any, rows: tuple[int, int]) -> Inside:
    key, *own = values
    if key is None:
        raise InputError(f"{place}: row {rows[0] + 1} has no {KEY}; fill the column, or leave such rows out")
    if key in seen:
        raise InputError(f"{place}: {KEY} {key!r} is in several places; sort the rows by {KEY}")
    seen.add(key)
    return key, rows, {name: value for name, value in zip(names[1:], own, strict=True) if value is not None}


def table_of(source: Source, first: int, count: int) -> Table:
    """Return the columns of one capture of such a file, which are `count` rows from the row `first` on."""
    parts, names = [], None
    for group, start, rows in _groups(source.place, source.stamp):
        if start < first + count and first < start + rows:
            content = _read_group(source.place, source.stamp, group)
            end = min(first + count, start + rows)
            parts.append(content.slice(max(first - start, 0), end - max(first, start)))
            names = names or content.column_names
    whole = require("pyarrow", "a Parquet file", "fleet").concat_tables(parts)
    columns = {name: _numbers(whole.column(name)) for name in names or ()}
    return Table(source.name, "Parquet", {name: at for name, at in columns.items() if at is not None})


def _numbers(column: Any) -> np.ndarray[Any, np.dtype[np.float64]] | None:
    """Return a column as numbers, a null as NaN; None for one that holds none."""
    types = require("pyarrow.types", "a Parquet file", "fleet")
    if types.is_list(column.type) or types.is_large_list(column.type):
        column = column.combine_chunks().flatten()
    if not (types.is_integer(column.type) or types.is_floating(column.type)):
        return None
    return np.asarray(column.cast("float64"), dtype=np.float64)


@lru_cache(maxsize=8)
def _groups(place: str, stamp: str) -> tuple[tuple[int, int, int], ...]:
    """Return number, first row and rows of each row group."""
    parquet = require("pyarrow.parquet", "a Parquet file", "fleet")
    with places.opened(place) as stream:
        about = parquet.ParquetFile(stream).metadata
        rows = [about.row_group(at).num_rows for at in range(about.num_row_groups)]
    starts = np.cumsum([0, *rows[:-1]]).tolist()
    return tuple(zip(range(len(rows)), starts, rows, strict=True))


@lru_cache(maxsize=2)  # captures that follow one another lie in one group, or in two
def _read_group(place: str, stamp: str, group: int) -> Any:
    parquet = require("pyarrow.parquet", "a Parquet file", "fleet")
    with places.opened(place) as stream:
        file = parquet.ParquetFile(stream)
        columns = [name for name in file.schema_arrow.names if name != KEY]
        return file.read_row_group(group, columns=columns)
