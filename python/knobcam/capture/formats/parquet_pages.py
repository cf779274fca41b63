"""What the pages of a Parquet file claim to unpack to, looked at before anybody reserves memory for it.

In front of each page stands a PageHeader, a struct of Thrift's compact protocol: parquet-format,
`src/main/thrift/parquet.thrift`, and Thrift's `doc/specs/thrift-compact-protocol.md`.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import IO, Any

from ...errors import InputError

_UNCOMPRESSED, _COMPRESSED, _DICTIONARY, _VALUES = (
    2,
    3,
    7,
    1,
)  # fields of a PageHeader, and of its dictionary's
_VALUE_BYTES = 16  # of a number with its levels, at the most
_AIR_BYTES = 2**16  # of a page beyond its numbers
_HEADER_BYTES = 2**16
_MOST_PAGES = 100_000  # of a file
_DEEPEST = 8


def check_pages(source: str, file: IO[bytes], metadata: Any, columns: Sequence[int]) -> None:
    """Refuse a file whose pages claim more than the rows of these columns could ever take."""
    pages = 0
    for group in (metadata.row_group(at) for at in range(metadata.num_row_groups)):
        most = _VALUE_BYTES * group.num_rows + _AIR_BYTES
        for chunk in map(group.column, columns):
            starts = [chunk.data_page_offset, chunk.dictionary_page_offset or chunk.data_page_offset]
            at = min(starts)
            end = at + chunk.total_compressed_size
            while at < end:
                file.seek(at)
                header, size = _struct(file.read(_HEADER_BYTES), 0, 0)
                packed, claimed = header.get(_COMPRESSED, -1), header.get(_UNCOMPRESSED, -1)
                words = header.get(_DICTIONARY, {}).get(_VALUES, 0)
                pages += 1
                if packed < 0 or not 0 <= claimed <= most or not 0 <= 4 * words <= most:
                    raise InputError(
                        f"{source}: column {chunk.path_in_schema} has a page that claims {claimed} bytes and "
                        f"{words} words for {group.num_rows} rows; the file is damaged, export it again"
                    )
                if pages > _MOST_PAGES:
                    raise InputError(f"{source}: more than {_MOST_PAGES} pages; write it with larger ones")
                at += size + packed


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
        raise ValueError("a page header is nested too deep")
    if kind in (1, 2):  # true and false, which are in the kind itself
        return kind == 1, at
    if kind == 3:
        return raw[at], at + 1
    if kind in (4, 5, 6):
        return _number(raw, at)
    if kind == 7:
        return None, at + 8
    if kind == 8:
        size, at = _varint(raw, at)
        return None, at + size
    if kind in (9, 10):
        return None, _after_list(raw, at, deep)
    if kind == 12:
        return _struct(raw, at, deep + 1)
    raise ValueError(f"a page header has a field of kind {kind}")


def _after_list(raw: bytes, at: int, deep: int) -> int:
    count, kind = raw[at] >> 4, raw[at] & 15
    at += 1
    if count == 15:
        count, at = _varint(raw, at)
    for _ in range(count):
        # In a list a truth takes a byte.
        at = at + 1 if kind in (1, 2) else _value(raw, at, kind, deep + 1)[1]
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
            raise ValueError("a page header has a number of more than 64 bits")
