"""MATLAB .mat version 5. Structs become dotted names, those of an array with `s1`, `s2`, ... in them.

The reader follows "MAT-File Format" (MathWorks 2024), chapter 1, section and table names as there. It is
written here because scipy.io.loadmat ends the process on some damaged files, which an importer may not.
"""

from __future__ import annotations

import json
import math
import struct
import zlib
from collections.abc import Iterator, Mapping
from itertools import islice
from pathlib import Path
from typing import IO, Any, NamedTuple

import numpy as np

from ...base.arrays import FloatArray
from ...base.optional import require
from ...errors import InputError
from . import magic
from .inflate import Budget, unpack
from .table import Table, add_array, of_a_class

_DOCUMENT = "knobcam"
_TEXT = 116  # bytes of text at the start of a file
_INT32, _UINT32, _MATRIX, _COMPRESSED = 5, 6, 14, 15  # data types, Table 1-1
_CELL, _STRUCT, _OBJECT, _CHAR, _SPARSE = range(1, 6)  # array types, Table 1-3; numbers are 6 to 15
_NUMBERS = {1: "i1", 2: "u1", 3: "i2", 4: "u2", 5: "i4", 6: "u4", 7: "f4", 9: "f8", 12: "i8", 13: "u8"}
_TEXTS = {4: "utf-16", 17: "utf-16", 18: "utf-32"}  # data types of characters; the others hold bytes
_MOST_STRUCTS = 1000  # of an array: runs or joints of a log are fewer
_OPAQUE = 17  # an object of a class; its name, that of what keeps it and the class's
_UNNAMED = "(unnamed)"
_KINDS = {_CHAR: "text", _CELL: "cells", _SPARSE: "a sparse matrix"}


class Element(NamedTuple):
    """A tag's data type and the bytes behind it."""

    kind: int
    data: memoryview


class _Reader:
    def __init__(self, source: str, order: str, budget: Budget) -> None:
        self.source = source
        self.order = order
        self.budget = budget
        self.columns: dict[str, FloatArray] = {}
        self.broken: dict[str, str] = {}
        self.objects: list[str] = []
        self.document: Mapping[str, Any] | None = None

    def read(self, data: memoryview) -> None:
        """Read every variable in `data`, which follows the header."""
        for element in self.elements(data):
            if element.kind == _COMPRESSED:
                self.read(memoryview(self.inflate(element.data)))
            elif element.kind == _MATRIX:
                self.matrix(element.data, "")

    def inflate(self, data: memoryview) -> bytes:
        content, _ = unpack(zlib.decompressobj(), data, 0, self.budget)
        return content

    def elements(self, data: memoryview) -> Iterator[Element]:
        """Split `data` at its tags (Data Element Format), refusing a tag that claims more than there is."""
        while len(data) >= 8:
            kind, size = struct.unpack(f"{self.order}II", data[:8])
            if kind >> 16:  # Small Data Element Format: size and type share the first word
                kind, size, start, end = kind & 0xFFFF, kind >> 16, 4, 8
            else:
                start, end = 8, 8 + size
                end += 0 if kind == _COMPRESSED else -size % 8
            if size > len(data) - start:
                raise InputError(
                    f"{self.source}: an array claims {size} bytes, the file holds {len(data) - start}; "
                    f"it is cut short, copy it again"
                )
            yield Element(kind, data[start : start + size])
            data = data[end:]

    def matrix(self, data: memoryview, parent: str) -> None:
        """Read one array (miMATRIX): flags, dimensions, name, then what its type says."""
        parts = self.elements(data)
        flags = int(self.numbers(next(parts))[0])
        kind, is_complex = flags & 0xFF, bool(flags & 0x0800)
        label = parent
        if kind == _OPAQUE:
            name, _, what = (bytes(part.data).decode("utf-8", "replace") for part in islice(parts, 3))
            label = parent or name or _UNNAMED
            self.objects.append(label)
            self.broken[label] = of_a_class(label, what)
            return
        dimensions = next(parts)
        if dimensions.kind not in (_INT32, _UINT32):  # some writers take the unsigned
            self.refuse(label or _UNNAMED, "an object")
            return
        shape = [int(n) for n in self.numbers(dimensions)]
        label = label or bytes(next(parts).data).decode("utf-8", "replace")
        if parent:
            next(parts)
        elif not label:
            return  # what objects keep for themselves
        count = math.prod(shape)
        if kind == _STRUCT and 0 < count <= _MOST_STRUCTS:
            width = max(1, int(self.numbers(next(parts))[0]))
            names = bytes(next(parts).data)
            starts = range(0, len(names), width)
            fields = [names[at : at + width].partition(b"\0")[0].decode("utf-8", "replace") for at in starts]
            for number in range(1, count + 1):  # MATLAB counts from 1
                one = label if count == 1 else f"{label}.s{number}"
                for field in fields:
                    self.matrix(next(parts).data, f"{one}.{field}")
        elif kind == _CELL and count == 1:  # how some exporters wrap a signal
            self.matrix(next(parts).data, label)
        elif kind == _CHAR and label == _DOCUMENT:
            self.document = self.description(next(parts))
        elif kind > _SPARSE and kind < 16 and not is_complex:
            values = self.numbers(next(parts))
            self.budget.numbers(count)
            add_array(self.columns, self.broken, label, values.reshape(shape, order="F"))
        elif kind == _STRUCT:
            self.refuse(label, f"an array of {count} structs")
        else:
            self.refuse(label, "complex numbers" if is_complex else _KINDS.get(kind, "an object"))

    def numbers(self, element: Element) -> np.ndarray[Any, np.dtype[Any]]:
        dtype = np.dtype(_NUMBERS[element.kind]).newbyteorder(self.order)  # type: ignore[arg-type]
        return np.frombuffer(element.data, dtype=dtype)

    def description(self, element: Element) -> Mapping[str, Any] | None:
        suffix = {"<": "-le", ">": "-be"}[self.order]
        encoding = _TEXTS[element.kind] + suffix if element.kind in _TEXTS else "utf-8"
        document = json.loads(bytes(element.data).decode(encoding))
        return document if isinstance(document, dict) else None

    def refuse(self, label: str, what: str) -> None:
        self.broken[label] = f"column {label} holds {what}, not an array of numbers; map another column"


def read_mat5(path: Path, max_bytes: int) -> Table:
    """Return the table of a version 5 .mat; nested structs are addressable as `data.qm`."""
    raw = memoryview(path.read_bytes())
    order = {b"IM": "<", b"MI": ">"}.get(bytes(raw[126:128]))
    if order is None:
        raise InputError(f"{path}: the MATLAB header is cut short; copy the file again")
    reader = _Reader(str(path), order, Budget(str(path), len(raw), max_bytes).held())
    reader.read(raw[128:])
    if reader.objects and not reader.columns and reader.document is None:
        raise InputError(f"{path}: {reader.broken[reader.objects[0]]}")
    return Table(str(path), "MATLAB 5 .mat", reader.columns, reader.broken, reader.document)


def write_mat5(file: IO[bytes], columns: Mapping[str, FloatArray], document: Mapping[str, Any]) -> None:
    """Write `columns` as column vectors of a version 5 .mat, the document beside them as text."""
    content: dict[str, Any] = {name: values[:, np.newaxis] for name, values in columns.items()}
    content[_DOCUMENT] = json.dumps(document)
    require("scipy.io", "writing a MATLAB file").savemat(file, content)
    # In place of the hour and the computer: equal captures are equal files.
    file.seek(len(magic.MATLAB))
    file.write(b", written by knobcam".ljust(_TEXT - len(magic.MATLAB)))
