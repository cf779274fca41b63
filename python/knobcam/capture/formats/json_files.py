"""JSON: lines of one object a row, a list of rows, named arrays, and the logs of BAM and of moteus' tview."""

from __future__ import annotations

import json
import re
from array import array
from collections.abc import Iterable, Iterator, Mapping
from typing import IO, Any

import numpy as np

from ...base.arrays import FloatArray
from ...errors import InputError
from .inflate import Budget, survey
from .magic import no_capture
from .table import MOST_COLUMNS, Table, add_array, check_joint, choose

_DEEPEST = 16
_PLAIN, _SAFE = (float, int), 2**53
_BLOCK = 2**18  # bytes that are parsed at once
_LARGEST = 24_000_000  # bytes of one document or line, whose objects can take forty times that
_TVIEW = {"controller", "timestamp", "channel", "data"}
_SERVO = "servo_stats"  # the channel of tview that has the motion
_WIDEST = 64  # numbers that a row has under one name: so many joints; a list of more is a column of a run
_OWN = "knobcam."  # begins the schema of what its commands print
_XL330_PWM = 885.0  # counts at a duty of 1: ROBOTIS e-Manual of the XL330-M288, PWM Limit


def read_json(stream: IO[bytes], budget: Budget, joint: str | None = None) -> Table:
    """Return the table in a text; `joint` chooses one of several controllers in a log of tview, or a run.

    Nested objects become dotted names, lists `name.c0`, `name.c1`; true is 1, null NaN, and a number beside
    the rows a scalar. Raises InputError for what is no JSON or has no rows.
    """
    source = budget.source
    survey(stream, budget.held())
    raw = stream.read().removeprefix(b"\xef\xbb\xbf")
    first_line, _, others = raw.lstrip().partition(b"\n")
    if re.fullmatch(rb"\{.*\}\s*", first_line) and others[:4096].strip():
        rows = _lines(source, raw)
        if set(next(_lines(source, raw))) >= _TVIEW:
            return _tview(source, rows, joint)
        check_joint(source, joint)
        return _rows(source, "JSON lines", rows)
    if len(raw) > _LARGEST:
        raise InputError(f"{source}: {len(raw)} bytes in one JSON document; write it as lines, or as CSV")
    try:
        document = json.loads(raw)
    except (ValueError, RecursionError) as error:
        raise InputError(f"{source}: damaged JSON ({error}); export it again") from error
    schema = document.get("schema") if isinstance(document, dict) else None
    if isinstance(schema, str) and schema.startswith(_OWN):
        raise InputError(f"{source}: {no_capture(schema)}")
    runs = _runs(document)
    if runs is None:
        check_joint(source, joint)
        return _whole(source, document)
    return _whole(source, runs[_run(source, len(runs), joint)])


def _lines(source: str, raw: bytes) -> Iterator[Mapping[str, Any]]:
    """Parse the lines, many at a time where each of them is whole."""
    row, start = 0, 0
    while start < len(raw):
        end = raw.find(b"\n", start + _BLOCK)
        end = len(raw) if end < 0 else end
        lines = [line for line in raw[start:end].split(b"\n") if line.strip()]
        start = end + 1
        try:
            found = (
                json.loads(b"[%s]" % b",".join(lines)) if max(map(len, lines), default=0) < _LARGEST else []
            )
        except (ValueError, RecursionError):
            found = []
        if len(found) != len(lines):
            found = (_line(source, index, line) for index, line in enumerate(lines, start=row + 1))
        for one in found:
            row += 1
            yield _object(source, row, one)


def _line(source: str, row: int, line: bytes) -> Any:
    if len(line) > _LARGEST:
        raise InputError(f"{source}: row {row} has {len(line)} bytes; write one sample an object")
    try:
        return json.loads(line)
    except (ValueError, RecursionError) as error:
        raise InputError(
            f"{source}: row {row} is damaged JSON ({error}); complete or delete the line"
        ) from error


def _object(source: str, row: int, found: Any) -> Mapping[str, Any]:
    if not isinstance(found, dict):
        raise InputError(f"{source}: row {row} is no object of named values: {str(found)[:40]!r}")
    return found


class _Columns:
    """Columns that grow row by row; what a row does not have is NaN."""

    def __init__(self, source: str) -> None:
        self.source = source
        self.rows = 0
        self.values: dict[str, array[float]] = {}
        self.broken: dict[str, str] = {}

    def add(self, row: Mapping[str, Any]) -> None:
        """Add a row."""
        self.rows += 1
        for name, value in row.items():
            column = self.values.get(name) if type(value) in _PLAIN else None
            if column is not None and len(column) == self.rows - 1 and abs(value) < _SAFE:
                column.append(value)
            else:
                self._put(name, value, 1)

    def _put(self, name: str, value: Any, depth: int) -> None:
        if depth > _DEEPEST:
            raise InputError(f"{self.source}: row {self.rows} is nested deeper than {_DEEPEST}; flatten it")
        if isinstance(value, dict):
            for key, part in value.items():
                self._put(f"{name}.{key}" if name else key, part, depth + 1)
        elif isinstance(value, list):
            for index, part in enumerate(value):
                self._put(f"{name}.c{index}", part, depth + 1)
        elif isinstance(value, str):
            said = f"row {self.rows}, column {name}: {value[:40]!r} is not a number; map another column"
            self.broken.setdefault(name, said)
        elif value is not None:
            self._number(name, value)

    def _number(self, name: str, value: float) -> None:
        column = self.values.get(name)
        if column is None:
            if len(self.values) == MOST_COLUMNS:
                raise InputError(f"{self.source}: more than {MOST_COLUMNS} names; give one row an object")
            column = self.values[name] = array("d")
        if len(column) < self.rows - 1:
            column.extend([float("nan")] * (self.rows - 1 - len(column)))
        try:
            column.append(value)
        except OverflowError:  # a whole number beyond any float
            column.append(float("inf"))

    def columns(self) -> dict[str, FloatArray]:
        """Return the columns, each with a value for every row."""
        found: dict[str, FloatArray] = {}
        for name, values in self.values.items():
            if name not in self.broken:
                column = np.full(self.rows, np.nan)
                column[: len(values)] = values
                found[name] = column
        return found


def _rows(source: str, kind: str, rows: Iterable[Mapping[str, Any]]) -> Table:
    built = _Columns(source)
    for row in rows:
        built.add(row)
    return Table(source, kind, built.columns(), built.broken)


def _tview(source: str, rows: Iterable[Mapping[str, Any]], joint: str | None) -> Table:
    """Return what one controller said of its servo in a log of tview."""
    built: dict[str, _Columns] = {}
    for row in rows:
        if row.get("channel") == _SERVO:
            built.setdefault(str(row.get("controller")), _Columns(source)).add(
                {"timestamp": row.get("timestamp"), "data": row.get("data")}
            )
    if not built:
        raise InputError(f"{source}: a log of tview without the channel {_SERVO}; log that one too")
    name = choose(source, joint, built, "controllers")
    return Table(source, "tview JSON lines", built[name].columns(), built[name].broken)


def _runs(document: Any) -> list[Any] | None:
    """Return the runs where a document is a list of them, or has one; None for one run."""
    lists = [document, *(document.values() if isinstance(document, dict) else [])]
    return next((one for one in lists if isinstance(one, list) and _are_runs(one)), None)


def _are_runs(several: list[Any]) -> bool:
    """Whether what a list holds are runs, of which some may be short: a step beside a sweep, or an empty one.

    What a run has of one of its columns, it has as much of another.
    """
    long = [one for one in several if _is_run(one)]
    return bool(long) and (len(long) == len(several) or all(map(_is_even, several)))


def _is_even(value: Any) -> bool:
    """Whether a value has several columns of one length, and none is longer, or none at all."""
    if not isinstance(value, dict):
        return False
    sizes = [len(part) for part in value.values() if isinstance(part, list) and part]
    return not sizes or sizes.count(max(sizes)) > 1


def _is_run(value: Any) -> bool:
    """Whether a value has rows in it, or columns longer than any row."""
    if not isinstance(value, dict):
        return _is_rows(value)
    lists = [part for part in value.values() if isinstance(part, list)]
    return any(_is_rows(part) or len(part) > _WIDEST for part in lists)


def _run(source: str, count: int, asked: str | None) -> int:
    if asked is None and count > 1:
        raise InputError(
            f"{source}: {count} runs in one file; choose one, for example --joint 1, or write each to a "
            "file: a folder of them is fitted as one experiment"
        )
    return int(choose(source, asked, [str(at + 1) for at in range(count)], "runs")) - 1


def _whole(source: str, document: Any) -> Table:
    """Return the table of one document: rows, a matrix, or an object that has rows or arrays in it."""
    if isinstance(document, list):
        if document and isinstance(document[0], dict):
            return _rows(source, "JSON", _objects(source, document))
        document = {"": document}
    held = {name: value for name, value in document.items() if _is_rows(value)}
    if len(held) > 1:
        raise InputError(f"{source}: rows under {', '.join(held)}; keep one of them in a file")
    if not held:
        return _arrays(source, document)
    (name,) = held
    table = _rows(source, "BAM JSON" if name == "entries" else "JSON", _objects(source, held[name]))
    columns, broken = dict(table.columns), dict(table.broken)
    for key, value in document.items():
        if isinstance(value, int | float) and key not in columns:
            columns[key] = np.array(float(value))
    if str(document.get("motor", "")).startswith("xl330") and "load" in columns:
        columns["duty"] = _duty(columns["load"])
    return Table(source, table.kind, columns, broken)


def _objects(source: str, rows: list[Any]) -> Iterator[Mapping[str, Any]]:
    return (_object(source, index, row) for index, row in enumerate(rows, start=1))


def _is_rows(value: Any) -> bool:
    return isinstance(value, list) and bool(value) and isinstance(value[0], dict)


def _duty(load: FloatArray) -> FloatArray:
    """Return the duty, -1 to 1, of an XL330's PWM: logged as it is, or as the 16 bits that were read."""
    if not np.nanmax(np.abs(load), initial=0.0) > 1.0:
        return load
    signed = np.where(load > 32767.0, load - 65536.0, load)
    return np.asarray(np.clip(signed / _XL330_PWM, -1.0, 1.0), dtype=np.float64)


def _arrays(source: str, document: Mapping[str, Any]) -> Table:
    columns: dict[str, FloatArray] = {}
    broken: dict[str, str] = {}
    words = 0

    def visit(name: str, value: Any, depth: int) -> None:
        nonlocal words
        words += isinstance(value, str)
        if isinstance(value, dict) and depth < _DEEPEST:
            for key, part in value.items():
                visit(f"{name}.{key}" if name else str(key), part, depth + 1)
        elif isinstance(value, list | int | float) and len(columns) < MOST_COLUMNS:
            try:
                add_array(columns, broken, name, np.array(value, dtype=np.float64))
            except (TypeError, ValueError, OverflowError):
                broken[name] = f"{name or 'the list'} holds other things than numbers; map another column"

    visit("", document.get("", document), 0)
    longest = max((column.size for column in columns.values() if column.ndim), default=0)
    scalars = words + sum(column.ndim == 0 for column in columns.values())
    # Of settings or results some are lists too, but no longer than a row may be, and fewer than the rest.
    if longest <= min(scalars, _WIDEST):
        raise InputError(
            f"{source}: JSON without rows or arrays of numbers; a capture has columns of samples"
        )
    return Table(source, "JSON", columns, broken)
