"""MATLAB .mat version 7.3, which is HDF5, through h5py. Structs (groups) become dotted names."""

from __future__ import annotations

import io
import json
import mmap
from collections.abc import Mapping
from pathlib import Path
from typing import IO, Any

import numpy as np

from ...base.arrays import FloatArray
from ...base.optional import require
from ...base.reading import open_file
from ...errors import InputError
from .inflate import Budget
from .table import Table, add_array, check_width, of_a_class, stated_unit

_DOCUMENT = "knobcam"

_MAX_DEFLATE = 1032  # zlib cannot shrink by more, so a larger claim is false (Deutsch & Gailly, RFC 1951)


_HEAP = b"GCOL\1\0\0\0"
"""How a global heap begins, which holds texts (HDF5 File Format Specification 3.0, III.E)."""
_HEAP_HEAD = _OBJECT_HEAD = 16


def read_hdf5(path: Path, max_bytes: int) -> Table:
    """Return the table of a version 7.3 .mat, or of any HDF5 file with arrays at its root or in groups."""
    h5py = require("h5py", "a MATLAB 7.3 file")
    columns: dict[str, FloatArray] = {}
    broken: dict[str, str] = {}
    units: dict[str, str] = {}
    objects: list[str] = []
    budget = Budget(str(path), path.stat().st_size, max_bytes)

    def visit(name: str, item: Any) -> None:
        if not isinstance(item, h5py.Dataset) or name.startswith("#"):
            return
        label = name.replace("/", ".")
        check_width(str(path), len(columns) + len(broken))
        if item.external or item.is_virtual:
            broken[label] = f"column {label} stands in another file; copy it into this one"
            return
        if item.dtype.hasobject:  # of any length, and the same one as often as it likes
            broken[label] = f"column {label} holds objects, not numbers; map another column"
            return
        held = item.id.get_storage_size()
        if item.nbytes > held * (_MAX_DEFLATE if item.chunks else 1) and item.nbytes > 1 << 16:
            raise InputError(
                f"{path}: {label} claims {item.nbytes} bytes and holds {held}; it is cut short, copy it again"
            )
        budget.take(item.nbytes)
        budget.numbers(item.size, item.dtype.itemsize)
        kind = item.attrs.get("MATLAB_class", b"double")
        if "MATLAB_object_decode" in item.attrs:
            objects.append(label)
            broken[label] = of_a_class(label, bytes(kind).decode("utf-8", "replace"))
        elif kind in (b"char", b"cell"):
            broken[label] = f"column {label} holds text or cells, not numbers; map another column"
        else:
            there = set(columns)
            add_array(columns, broken, label, np.asarray(item[()]))
            if (unit := stated_unit(item.attrs)) is not None:
                units.update(dict.fromkeys(set(columns) - there, unit))

    _check_heaps(path)
    with h5py.File(path, "r") as file:
        file.visititems(visit)
        text = file.attrs.get(_DOCUMENT)
    if objects and not columns:
        raise InputError(f"{path}: {broken[objects[0]]}")
    document = json.loads(text) if isinstance(text, str) else None
    kind = "HDF5" if document else "MATLAB 7.3 .mat"
    document = document if isinstance(document, dict) else None
    return Table(str(path), kind, columns, broken, document, units=units)


def _check_heaps(path: Path) -> None:
    """Refuse heaps whose objects do not fit: the library may go round in one for ever."""
    with open_file(path) as file, mmap.mmap(file.fileno(), 0, access=mmap.ACCESS_READ) as raw:
        start = raw.find(_HEAP)
        while start >= 0:
            at = start + _HEAP_HEAD
            end = start + int.from_bytes(raw[start + 8 : at], "little")
            while at + _OBJECT_HEAD <= end:
                is_free = raw[at : at + 2] == b"\0\0"
                size = int.from_bytes(raw[at + 8 : at + _OBJECT_HEAD], "little")
                needed = size if is_free else _OBJECT_HEAD + -(-size // 8) * 8
                if needed == 0 or at + needed > min(end, len(raw)):
                    raise InputError(
                        f"{path}: a heap of texts in it is damaged; copy or export the file again"
                    )
                at += needed
            start = raw.find(_HEAP, start + 1)


def write_hdf5(file: IO[bytes], columns: Mapping[str, FloatArray], document: Mapping[str, Any]) -> None:
    """Write `columns` as datasets at the root, the document as an attribute of the root; no time stamps.

    The file is made in memory: the library does not survive a disk that is full.
    """
    h5py = require("h5py", "an HDF5 file")
    whole = io.BytesIO()
    with h5py.File(whole, "w", track_order=True) as held:
        held.attrs[_DOCUMENT] = json.dumps(document)
        for name, values in columns.items():
            held.create_dataset(name, data=values, track_times=False)
    file.write(whole.getvalue())
