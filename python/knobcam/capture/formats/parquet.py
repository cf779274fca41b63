"""Parquet through pyarrow."""

from __future__ import annotations

import json
from collections.abc import Mapping
from pathlib import Path
from typing import IO, Any

import numpy as np

from ...base.arrays import FloatArray
from ...base.optional import require
from ...base.reading import open_file
from .inflate import Budget
from .parquet_pages import check_pages
from .table import Table, check_width, stated_unit

_DOCUMENT = b"knobcam"
_A_SECOND = {"s": 1.0, "ms": 1e3, "us": 1e6, "ns": 1e9}
_MOST_PARTS = 100_000  # of a list in the file's description, such as columns times row groups


def read_parquet(path: Path, max_bytes: int) -> Table:
    """Return the numeric columns of a Parquet file; a null is NaN, a time stamp or span is in s."""
    parquet = require("pyarrow.parquet", "a Parquet file")
    types = require("pyarrow.types", "a Parquet file")
    columns: dict[str, FloatArray] = {}
    broken: dict[str, str] = {}
    units: dict[str, str] = {}
    per_second: dict[str, float] = {}
    with parquet.ParquetFile(path, thrift_container_size_limit=_MOST_PARTS) as file:
        wanted: list[str] = []
        check_width(str(path), len(file.schema_arrow))
        for field in file.schema_arrow:
            timed = types.is_timestamp(field.type) or types.is_duration(field.type)
            if timed:
                per_second[field.name] = _A_SECOND[field.type.unit]
                units[field.name] = "s"
            elif (unit := stated_unit(field.metadata or {})) is not None:
                units[field.name] = unit
            if timed or types.is_integer(field.type) or types.is_floating(field.type):
                wanted.append(field.name)
            else:
                broken[field.name] = (
                    f"column {field.name} holds {field.type}, not numbers; map another column"
                )
        # Runs of one value take no room in the file.
        budget = Budget(str(path), path.stat().st_size, max_bytes)
        budget.take(8 * file.metadata.num_rows * len(wanted))
        budget.numbers(file.metadata.num_rows * len(wanted))
        with open_file(path) as pages:
            check_pages(str(path), pages, wanted, file.metadata.num_rows)
        table = file.read(columns=wanted)
    for name in wanted:
        column = table.column(name)
        if name in per_second:  # from the first on: of a date in ns a float has 200 ns left
            whole = column.cast("int64").to_numpy(zero_copy_only=False)
            known = whole[np.isfinite(whole)]
            columns[name] = (whole - (known[0] if len(known) else 0)) / per_second[name]
            continue
        columns[name] = column.cast("float64").to_numpy().astype(np.float64, copy=False)
    text = (table.schema.metadata or {}).get(_DOCUMENT)
    document = None if text is None else json.loads(text)
    return Table(str(path), "Parquet", columns, broken, document, units=units)


def write_parquet(file: IO[bytes], columns: Mapping[str, FloatArray], document: Mapping[str, Any]) -> None:
    """Write `columns` with the document in the schema's metadata."""
    arrow = require("pyarrow", "a Parquet file")
    table = arrow.table({name: arrow.array(values) for name, values in columns.items()})
    table = table.replace_schema_metadata({_DOCUMENT: json.dumps(document).encode()})
    require("pyarrow.parquet", "a Parquet file").write_table(table, file)
