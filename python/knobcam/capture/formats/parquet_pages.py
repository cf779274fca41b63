"""What the pages of a Parquet file claim to unpack to, looked at before anybody reserves memory for it.

At the end of the file stands its FileMetaData, in front of each page a PageHeader, structs of Thrift's
compact protocol: parquet-format, `src/main/thrift/parquet.thrift`, and Thrift's
`doc/specs/thrift-compact-protocol.md`.
"""

from __future__ import annotations

import os
from collections.abc import Collection, Mapping
from typing import IO, Any

from ...errors import InputError

_ROW_GROUPS = 4  # of FileMetaData
_CHUNKS, _ROWS = 1, 3  # of RowGroup
_META = 3  # of ColumnChunk
_PATH, _SIZE, _DATA_AT, _WORDS_AT = 3, 7, 9, 11  # of ColumnMetaData
_UNCOMPRESSED, _COMPRESSED, _DICTIONARY = 2, 3, 7  # of PageHeader
_VALUES = 1  # of DictionaryPageHeader
_VALUE_BYTES = 16  # of a number with its levels, at the most
_AIR_BYTES = 2**16  # of a page beyond its numbers
_HEADER_BYTES = 2**16
_FOOTER_BYTES = 2**24
_TAIL_BYTES = 8  # the footer's length, and the magic number
_MOST_PAGES = 100_000  # of a file
_DEEPEST = 12


def check_pages(source: str, file: IO[bytes], columns: Collection[str], most_rows: int) -> None:
    """Refuse a file whose pages claim more than the rows of these columns could ever take.

    Its footer is read here too: pyarrow ends the whole process where some of its descriptions are damaged and
    asked for.
    """
    end = file.seek(-_TAIL_BYTES, os.SEEK_END)
    length = int.from_bytes(file.read(4), "little")
    if length > _FOOTER_BYTES:
        raise InputError(f"{source}: a description of {length} bytes; write it with fewer row groups")
    file.seek(max(0, end - length))
    pages = 0
    for group in _struct(file.read(length), 0, 0)[0].get(_ROW_GROUPS, []):
        rows = min(group.get(_ROWS, 0), most_rows)
        for chunk in (one[_META] for one in group[_CHUNKS]):
            name = ".".join(part.decode() for part in chunk[_PATH])
            if name in columns:
                pages += _check_chunk(f"{source}: column {name}", file, chunk, rows)
        if pages > _MOST_PAGES:
            raise InputError(f"{source}: more than {_MOST_PAGES} pages; write it with larger ones")


def _check_chunk(what: str, file: IO[bytes], chunk: Mapping[int, Any], rows: int) -> int:
    """Check the pages of a column's part and return how many there are."""
    most, pages = _VALUE_BYTES * rows + _AIR_BYTES, 0
    at = min(chunk[_DATA_AT], chunk.get(_WORDS_AT, chunk[_DATA_AT]) or chunk[_DATA_AT])
    end = at + chunk[_SIZE]
    while at < end and pages <= _MOST_PAGES:
        file.seek(at)
        header, size = _struct(file.read(_HEADER_BYTES), 0, 0)
        packed, claimed = header.get(_COMPRESSED, -1), header.get(_UNCOMPRESSED, -1)
        words = header.get(_DICTIONARY, {}).get(_VALUES, 0)
        if packed < 0 or not 0 <= claimed <= most or not 0 <= 4 * words <= most:
            raise InputError(
                f"{what} has a page that claims {claimed} bytes and {words} words for {rows} rows; the file "
                f"is damaged, export it again"
            )
        pages += 1
        at += size + packed
    return pages


def _struct(raw: bytes, at: int, deep: int) -> tuple[dict[int, Any], int]:
    """Return the numbers and structs of a struct by their field, and where it ends."""
    found: dict[int, Any] = {}
    field = 0
    while (head := raw[at]) != 0:
        at += 1
        if head >> 4:
            field += head >> 4
        else:
            field, at = _number(raw, at)
        found[field], at = _value(raw, at, head & 15, deep)
    return found, at + 1


def _value(raw: bytes, at: int, kind: int, deep: int) -> tuple[Any, int]:
    if deep > _DEEPEST:
        raise ValueError("a description is nested too deep")
    if kind in (1, 2):  # true and false, which are in the kind itself
        return kind == 1, at
    if kind == 3:
        return raw[at], at + 1
    if kind in (4, 5, 6):
        return _number(raw, at)
    if kind == 7:
        return None, _within(raw, at + 8)
    if kind == 8:
        size, at = _varint(raw, at)
        return raw[at : at + size], _within(raw, at + size)
    if kind in (9, 10):
        return _list(raw, at, deep)
    if kind == 12:
        return _struct(raw, at, deep + 1)
    raise ValueError(f"a description has a field of kind {kind}")


def _list(raw: bytes, at: int, deep: int) -> tuple[list[Any], int]:
    count, kind = raw[at] >> 4, raw[at] & 15
    at += 1
    if count == 15:
        count, at = _varint(raw, at)
    _within(raw, at + count)  # each takes a byte at least
    found = []
    for _ in range(count):
        # In a list a truth takes a byte.
        value, at = (None, _within(raw, at + 1)) if kind in (1, 2) else _value(raw, at, kind, deep + 1)
        found.append(value)
    return found, at


def _within(raw: bytes, at: int) -> int:
    if at > len(raw):
        raise ValueError("a description ends in the middle")
    return at


def _number(raw: bytes, at: int) -> tuple[int, int]:
    value, at = _varint(raw, at)
    return (value >> 1) ^ -(value & 1), at


def _varint(raw: bytes, at: int) -> tuple[int, int]:
    value, shift = 0, 0
    while True:
        byte = raw[at]
        at += 1
        value |= (byte & 127) << shift
        if byte < 128:
            return value, at
        shift += 7
        if shift > 63:
            raise ValueError("a description has a number of more than 64 bits")
