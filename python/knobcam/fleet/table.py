"""Rows as a Parquet table: columns that every batch has, three for each parameter, one for each hint."""

from __future__ import annotations

import json
from collections.abc import Callable, Iterable
from pathlib import Path
from typing import IO, Any

import numpy as np

from ..base.optional import require
from ..base.strict_json import plain
from ..errors import InputError
from .row import Row, compact

_TEXT = "string"
_NUMBER = "double"
_TEXTS = "list<string>"
_NUMBERS = "list<double>"
COLUMNS = {
    "capture": _TEXT,
    "place": _TEXT,
    "sha256": _TEXT,
    "lot": _TEXT,
    "station": _TEXT,
    "part": _TEXT,
    "date": _TEXT,
    "time": _TEXT,
    "verdict": _TEXT,
    "found": _TEXTS,
    "weights": _NUMBERS,
    "ok": "bool",
    "failed_limits": _TEXTS,
    "failed_why": _TEXTS,
    "cause": _TEXT,
    "outlier": _TEXTS,
    "rmse": _NUMBER,
    "rmse_heldout": _NUMBER,
    "noise_floor": _NUMBER,
    "findings": _TEXTS,
    "error": _TEXT,
    "headline": _TEXT,
    "samples": "int64",
    "masked": "int64",
    "duration_s": _NUMBER,
    "sample_rate_hz": _NUMBER,
    "coordinate": _TEXT,
    "unit": _TEXT,
    "effects": _TEXTS,
    "learned": "bool",
    "version": _TEXT,
    "settings": _TEXT,
    "curve.theta": _NUMBERS,
    "curve.forward": _NUMBERS,
    "curve.backward": _NUMBERS,
    "first": _TEXT,
}
"""Every batch has these columns; `first` is what the first model of a learned capture gave, as JSON."""
_ENDS = ("", ".lo", ".hi")
_CURVE = ("theta", "forward", "backward")
_UNIT = b"unit"
_HINT = b"hint"


def schema_of(rows: Iterable[Row]) -> Any:
    """Return the schema of a table of rows; a parameter's columns name its unit."""
    arrow = require("pyarrow", "the table of a batch", "fleet")
    units: dict[str, set[str]] = {}
    for row in rows:
        for name in row["params"]:
            units.setdefault(name, set()).update(row["units"].get(name, "").split(", "))
    lists = {_TEXTS: arrow.list_(arrow.string()), _NUMBERS: arrow.list_(arrow.float64())}
    plain = {_TEXT: arrow.string(), _NUMBER: arrow.float64(), "bool": arrow.bool_(), "int64": arrow.int64()}
    types = lists | plain
    fields = [arrow.field(name, types[kind]) for name, kind in COLUMNS.items()]
    for name in sorted(units):
        about = {_UNIT: ", ".join(sorted(units[name])).encode()}
        fields += [arrow.field(name + end, arrow.float64(), metadata=about) for end in _ENDS]
    hints = sorted({name for row in rows for name in row.get("hints") or {}})
    fields += [arrow.field(name, arrow.float64(), metadata={_HINT: b""}) for name in hints]
    return arrow.schema(fields)


def arrow_table(rows: list[Row], schema: Any) -> Any:
    """Return rows as a table of pyarrow."""
    arrow = require("pyarrow", "the table of a batch", "fleet")
    return arrow.Table.from_pylist([_flat(row) for row in rows], schema=schema)


def content(rows: list[Row], schema: Any) -> Callable[[IO[bytes]], None]:
    """Return what writes rows as a Parquet file; the same rows are the same bytes."""
    parquet = require("pyarrow.parquet", "the table of a batch", "fleet")

    def put(file: IO[bytes]) -> None:
        parquet.write_table(arrow_table(rows, schema), file, compression="zstd")

    return put


def rows_in(path: Path) -> list[Row]:
    """Return the rows of a file of a table. InputError for a damaged one."""
    parquet = require("pyarrow.parquet", "the table of a batch", "fleet")
    try:
        with path.open("rb") as file:
            found = parquet.read_table(file)
    except Exception as error:  # whatever a damaged file makes of it
        raise InputError(
            f"{path}: is damaged ({type(error).__name__}); remove it and run the batch again"
        ) from None
    units: dict[str, str] = {one.name: (one.metadata or {}).get(_UNIT, b"").decode() for one in found.schema}
    params = [name for name in found.column_names if f"{name}.lo" in units and name not in COLUMNS]
    hints = [one.name for one in found.schema if _HINT in (one.metadata or {})]
    return [_deep(flat, params, units, hints) for flat in found.to_pylist()]


def _flat(row: Row) -> Row:
    flat = {name: row.get(name) for name in COLUMNS}
    flat["first"] = None if row.get("first") is None else json.dumps(row["first"], sort_keys=True)
    if row.get("curve") is not None:
        flat |= {f"curve.{name}": plain(np.asarray(row["curve"][name]).tolist()) for name in _CURVE}
    for name, values in row["params"].items():
        flat |= {name + end: value for end, value in zip(_ENDS, values, strict=True)}
    return flat | (row.get("hints") or {})


def _deep(flat: Row, params: list[str], units: dict[str, str], hints: list[str]) -> Row:
    row: Row = {name: flat.get(name) for name in COLUMNS if not name.startswith("curve.")}
    row["first"] = None if flat.get("first") is None else json.loads(flat["first"])
    row["curve"] = None if flat["curve.theta"] is None else {one: flat[f"curve.{one}"] for one in _CURVE}
    row["params"] = {name: [flat[name + end] for end in _ENDS] for name in params if _has(flat, name)}
    row["units"] = {name: units[name] for name in row["params"]}
    row["hints"] = {name: flat[name] for name in hints if flat[name] is not None}
    return compact(row)


def _has(flat: Row, name: str) -> bool:
    """Whether the model of a row has a parameter, determined or not."""
    return flat[name] is not None or name.partition(".")[0] in (flat.get("effects") or ())
