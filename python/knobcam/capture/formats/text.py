"""CSV and its relatives: the fast reader first, the patient one when a cell needs an explanation."""

from __future__ import annotations

import csv
import io
import json
import re
from array import array
from collections.abc import Callable, Iterable, Mapping
from datetime import UTC, date, datetime
from itertools import chain, islice
from typing import IO, Any, TextIO

import numpy as np

from ...base.arrays import FloatArray
from ...errors import InputError
from .inflate import Budget, peek, survey
from .loggers import TABS
from .quoted import left_open, records
from .scope import read_scope, separator
from .table import Table, called, check_width
from .units import spelled_out

_DOCUMENT = "# knobcam:"
_LONGEST = 2**22  # bytes of a row
_CHUNK = 2000  # lines
_MOST_COMMENTS = 10_000  # above the first row
_TITLES = 100  # lines within which a table begins
_ROWS = 3  # of numbers, below which it is none
_SIDEWAYS = 10  # times as many columns as rows, from which on a table lies on its side
_HEAD = 4096
_UTF16 = (b"\xff\xfe", b"\xfe\xff")
_NAME = re.compile(r"[A-Za-z_]\w*:")
_DATE = r"(\d{1,2})([./])(\d{1,2})\2(\d{4})[ T]+"
_CLOCK = re.compile(rf"(?:{_DATE})?(\d{{1,2}}):(\d{{2}}):(\d{{2}}(?:\.\d+)?)(?: ?([AP])M)?", re.IGNORECASE)
_YEAR_1970 = date(1970, 1, 1).toordinal()


def read_text(kind: str, stream: IO[bytes], budget: Budget) -> Table:
    """Return the table in a text: delimiter , ; tab or blanks, with or without a header, # or % comments.

    Titles may stand above it, in lines of other widths; units in a line below the header, names at each
    number; dates and times of the day become s.
    A blank cell is NaN; blank cells down to the last row, and nowhere else, end the column early. Row numbers
    in messages count the rows of data, from 1. The text is read twice, and never held.
    """
    source = budget.source
    head = peek(stream, _HEAD, budget)
    if b"\0" in head and head[:2] not in _UTF16:
        raise InputError(
            f"{source}: neither text nor a format knobcam knows; give CSV (.gz), JSON, .mat, .npy, .npz, "
            f"HDF5, Parquet, a wire log or a ROS 2 bag"
        )
    seen = survey(stream, budget)
    if seen.longest > _LONGEST:
        raise InputError(f"{source}: a line of {seen.longest} characters is no row of samples")
    # Loggers write a header with a micro sign in it; digits are safe.
    encoding = "utf-16" if head[:2] in _UTF16 else "utf-8-sig" if seen.utf8 else "latin-1"
    mark = separator(head.decode(encoding, "replace"))
    lines = io.TextIOWrapper(stream, encoding=encoding)
    try:
        if mark is not None:
            return read_scope(lines, seen.lines, mark, budget)
        return _read_lines(kind, lines, seen.lines, budget)
    finally:
        lines.detach()  # whoever opened the stream closes it


def _read_lines(kind: str, lines: TextIO, count: int, budget: Budget) -> Table:
    source = budget.source
    comments: list[str] = []
    start, first = _next_line(source, lines, comments)
    if not first:
        raise InputError(f"{source}: the file is empty; a capture has columns of samples")
    start, first = _below_titles(source, lines, start, first)
    second_start, second = _next_line(source, lines, [])
    units = _units_below(first, second)
    if units:
        second_start, second = _next_line(source, lines, [])
    sample = second or first
    delimiter = _delimiter(sample)
    decimal_comma = delimiter != "," and "," in sample
    cells = _cells(first, delimiter)
    check_width(source, len(cells))
    named = _named_each(cells)
    has_header = not named and not any(
        _is_number(cell.replace(",", ".") if decimal_comma else cell) for cell in cells
    )
    if has_header and not second:
        raise InputError(f"{source}: a header and no rows; a capture has columns of samples")
    if units:
        cells = [f"{cell} [{unit}]" if unit else cell for cell, unit in zip(cells, units, strict=True)]
    told = cells if has_header else named or _names_in_comment(comments, delimiter, len(cells))
    told = told or [""] * len(cells)
    names = called(told)
    budget.numbers(count * len(names))

    def rows() -> Iterable[str]:
        lines.seek(second_start if has_header else start)
        if named:
            return (_NAME.sub("", line) for line in lines)
        return (line.replace(",", ".") for line in lines) if decimal_comma else lines

    columns, broken = _numbers(source, names, rows, delimiter)
    # Behind the last column there may be a separator, and nothing.
    if told[-1] == "" and len(told) > 1 and np.isnan(columns.get(names[-1], np.zeros(1))).all():
        del columns[names[-1]]
    if not has_header and not broken and not any(told):
        columns = _upright(columns)
    kind = TABS if kind == "CSV" and delimiter == "\t" and not has_header else kind
    return Table(source, kind, columns, broken, _document(source, comments))


def _upright(columns: dict[str, FloatArray]) -> dict[str, FloatArray]:
    """Return columns without names; of a table that lies on its side its rows."""
    samples = min(map(len, columns.values()))
    if samples < 2 or len(columns) < _SIDEWAYS * samples or len({*map(len, columns.values())}) > 1:
        return columns
    return {f"c{at}": row for at, row in enumerate(np.array([*columns.values()]).T.copy())}


def write_text(columns: Mapping[str, FloatArray], document: Mapping[str, Any]) -> str:
    """Return the CSV of `columns`: shortest digits that read back to the same float64 (17 at most)."""
    rows = zip(*(map(repr, values.tolist()) for values in columns.values()), strict=True)
    lines = [f"{_DOCUMENT} {json.dumps(document)}", ",".join(columns)]
    lines += [",".join(row) for row in rows]
    return "\n".join(lines) + "\n"


def _next_line(source: str, lines: TextIO, comments: list[str]) -> tuple[int, str]:
    """Return where the next line of the table starts, and the line; comments passed over are collected."""
    start = lines.tell()
    while line := lines.readline():
        if not _skipped(line):
            return start, _record(line, lines)
        if len(comments) == _MOST_COMMENTS:
            raise InputError(f"{source}: {_MOST_COMMENTS} lines and no row of samples; delete the comments")
        comments.append(line)
        start = lines.tell()
    return start, ""


def _record(line: str, lines: TextIO) -> str:
    """Return the row that a line begins, and go on behind it."""
    if not left_open(line):
        return line
    behind = lines.tell()
    row = next(records(chain([line], iter(lines.readline, ""))))
    if row == line:
        lines.seek(behind)
    return row


def _below_titles(source: str, lines: TextIO, start: int, first: str) -> tuple[int, str]:
    """Return where the table begins, and its first line: below lines of other widths, as exports have above.

    Of several lines of names the last one, unless it holds units. A table that begins at once stays so.
    """
    looked = [(start, first)]
    while len(looked) < _TITLES and (following := _next_line(source, lines, []))[1]:
        looked.append(following)
    delimiter = _delimiter(looked[-1][1])
    rows = [_cells(line, delimiter) for _, line in looked]
    at = len(rows)
    while at > 0 and len(rows[at - 1]) == len(rows[-1]) > 1:
        at -= 1
    # What stands above a row of another width is no title where it has rows of the table: that row is broken.
    alike = [row for row in range(at) if len(rows[row]) == len(rows[-1])]
    if any(all(map(_is_value, rows[row])) for row in alike):
        at = alike[0]
    numbers = next((row for row in range(at, len(rows)) if all(map(_is_value, rows[row]))), len(rows))
    if at > 0 and len(rows) - numbers >= _ROWS:
        above = max(at, numbers - 1)
        units = above > at and _units_below(looked[above - 1][1], looked[above][1])
        start, first = looked[above - 1 if units else above]
    lines.seek(start)
    _record(lines.readline(), lines)
    return start, first


def _is_value(cell: str) -> bool:
    return not cell or _is_number(cell.replace(",", ".")) or _moment(cell) is not None


def _skipped(line: str) -> bool:
    # What follows a % at once is a name, as ROS writes it.
    return not line.strip() or line.lstrip().startswith(("#", "% ", "%%")) or line.strip() == "%"


def _delimiter(line: str) -> str | None:
    """Return the delimiter of a line of data; None stands for any blanks."""
    return next((mark for mark in (";", "\t", ",") if mark in line), None)


def _cells(line: str, delimiter: str | None) -> list[str]:
    if delimiter is None:
        return line.split()
    return [cell.strip() for cell in next(csv.reader([line], delimiter=delimiter))]


def _units_below(header: str, line: str) -> list[str] | None:
    """Return the units in a line below the header, blank for a column without; None where it holds others."""
    delimiter = _delimiter(line)
    names, cells = _cells(header, delimiter), _cells(line, delimiter)
    if len(names) != len(cells) or not any(cells) or any(map(_is_number, cells)):
        return None
    units = ["" if cell == "-" else cell.strip("()[]{} ") for cell in cells]
    told = [unit for unit in units if unit]
    strange = [unit for unit in told if not spelled_out(unit)]
    # Names are unique where units come again; what of these nobody knows is said where it is asked for.
    repeated = len(set(names)) == len(names) and len(set(told)) < len(told)
    if strange and not (repeated and 2 * len(strange) <= len(told)):
        return None
    return units


def _named_each(cells: list[str]) -> list[str] | None:
    """Return the names in a row that has them at each number, `pos:0.12`, as plotters of serial lines do."""
    parts = [cell.partition(":") for cell in cells]
    each = all(_NAME.fullmatch(name + mark) and _is_number(number) for name, mark, number in parts)
    return [name for name, _, _ in parts] if each else None


def _moment(cell: str) -> float | None:
    """Return the seconds since 1970 of a date with its time, those of a time of the day; None of others."""
    if found := _CLOCK.fullmatch(cell):
        first, sign, second, year, hours, minutes, seconds, half = found.groups()
        hour = float(hours) if half is None else float(hours) % 12.0 + (12.0 if half in "pP" else 0.0)
        clock = 3600.0 * hour + 60.0 * float(minutes) + float(seconds)
        if year is None:
            return clock
        # With dots the day stands first, with strokes the month, unless there are not so many.
        day, month = (first, second) if sign == "." or int(first) > 12 else (second, first)
        try:
            return 86400.0 * (date(int(year), int(month), int(day)).toordinal() - _YEAR_1970) + clock
        except ValueError:
            return None
    try:
        moment = datetime.fromisoformat(cell) if ":" in cell else None
    except ValueError:
        return None
    if moment is None:
        return None
    # Without a zone the clock of a machine: no summer time moves it.
    return (moment if moment.tzinfo else moment.replace(tzinfo=UTC)).timestamp()


def _is_number(cell: str) -> bool:
    try:
        float(cell)
    except ValueError:
        return False
    return "_" not in cell


def _names_in_comment(comments: list[str], delimiter: str | None, width: int) -> list[str] | None:
    """Return the names in the last comment line, where numpy.savetxt puts its header."""
    written = [line for line in comments if line.strip() and not line.startswith(_DOCUMENT)]
    if not written:
        return None
    names = _cells(written[-1].lstrip("#% \t"), delimiter)
    return names if len(names) == width and all(name.isidentifier() for name in names) else None


def _numbers(
    source: str, names: list[str], rows: Callable[[], Iterable[str]], delimiter: str | None
) -> tuple[dict[str, FloatArray], dict[str, str]]:
    try:
        matrix = np.loadtxt(rows(), delimiter=delimiter, comments=None, ndmin=2)
    except ValueError:
        return _cell_by_cell(source, names, rows(), delimiter)
    if matrix.shape[1] != len(names):
        raise _wrong_width(source, 1, matrix.shape[1], len(names))
    return {name: matrix[:, index] for index, name in enumerate(names)}, {}


def _cell_by_cell(
    source: str, names: list[str], lines: Iterable[str], delimiter: str | None
) -> tuple[dict[str, FloatArray], dict[str, str]]:
    values = array("d")
    last = [0] * len(names)
    broken: dict[str, str] = {}
    row = whole = 0
    rest = records(lines)
    while some := list(islice(rest, _CHUNK)):
        fast = _whole(some, delimiter)
        if fast is not None and fast.shape[1] == len(names):
            values.frombytes(fast.tobytes())
            row += len(fast)
            whole = row
            continue
        for line in some:
            if _skipped(line):
                continue
            row += 1
            cells = _cells(line, delimiter) if '"' in line else line.split(delimiter)
            if len(cells) != len(names):
                raise _wrong_width(source, row, len(cells), len(names), open_quote=left_open(line))
            numbers = _all_numbers(line, cells)
            if numbers is None:
                numbers = _patiently(row, names, cells, last, broken)
            else:
                whole = row
            values.extend(numbers)
    matrix = np.frombuffer(values, dtype=np.float64).reshape(row, len(names))
    columns = {}
    for index, name in enumerate(names):
        if name not in broken:
            column = matrix[: max(last[index], whole) or row, index]
            # What has blanks before its end is as long as the table, and blank there too.
            columns[name] = matrix[:, index] if np.isnan(column).any() else column
    return columns, broken


def _whole(lines: list[str], delimiter: str | None) -> FloatArray | None:
    """Return the numbers of lines that hold nothing else, as most do; None where one does."""
    if not any(map(str.strip, lines)):
        return None
    try:
        return np.loadtxt(lines, delimiter=delimiter, comments=None, ndmin=2)
    except ValueError:
        return None


def _all_numbers(line: str, cells: list[str]) -> list[float] | None:
    """Return the numbers of a row of which every cell is one, else None."""
    try:
        return None if "_" in line else [float(cell) for cell in cells]
    except ValueError:
        return None


def _patiently(
    row: int, names: list[str], cells: list[str], last: list[int], broken: dict[str, str]
) -> list[float]:
    """Return the numbers of a row, NaN for a blank; note where columns end and which cell is none."""
    numbers = []
    for index, cell in enumerate(map(str.strip, cells)):
        value = float("nan")
        if cell:
            last[index] = row
            if _is_number(cell):
                value = float(cell)
            elif (moment := _moment(cell)) is not None:
                value = moment
            else:
                broken.setdefault(
                    names[index],
                    f"row {row}, column {names[index]}: {cell[:40]!r} is not a number; "
                    f"correct the cell, or start a line that is no data with #",
                )
        numbers.append(value)
    return numbers


def _wrong_width(source: str, row: int, cells: int, names: int, *, open_quote: bool = False) -> InputError:
    why = "columns of different length or a line cut short; complete or delete the row"
    if open_quote:
        why = "a cell in it begins with a quote that nothing closes; close the quote or delete it"
    return InputError(f"{source}: row {row} has {cells} cells, the first line has {names}: {why}")


def _document(source: str, comments: list[str]) -> Mapping[str, Any] | None:
    line = next((line for line in comments if line.startswith(_DOCUMENT)), None)
    if line is None:
        return None
    try:
        document = json.loads(line.removeprefix(_DOCUMENT))
    except (ValueError, RecursionError) as error:
        raise InputError(
            f"{source}: the line '{_DOCUMENT} ...' is damaged ({error}); repair or delete it"
        ) from error
    return document if isinstance(document, dict) else None
