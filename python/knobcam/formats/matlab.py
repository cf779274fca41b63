"""MATLAB .mat: version 5 through SciPy, version 7.3 (HDF5) through h5py. Structs become dotted names."""

from __future__ import annotations

import json
import struct
import zlib
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..errors import InputError
from .optional import require
from .table import FloatArray, Table, add_array

MAT5_MAGIC = b"MATLAB 5.0 MAT-file"
HDF5_MAGIC = b"\x89HDF\r\n\x1a\n"
MAT73_MAGIC = b"MATLAB 7.3 MAT-file"

_DOCUMENT = "knobcam"
_COMPRESSED = 15  # miCOMPRESSED, MAT-File Format (MathWorks 2024), Table 1-1
_MAX_DEFLATE = 1032  # zlib cannot shrink by more, so a larger claim is false (Deutsch & Gailly, RFC 1951)


def read_mat5(path: Path, max_bytes: int) -> Table:
    """Return the table of a version 5 .mat; nested structs are addressable as `data.qm`."""
    _check_claims(path, max_bytes)
    content = require("scipy.io", "a MATLAB file").loadmat(path, appendmat=False)
    columns: dict[str, FloatArray] = {}
    broken: dict[str, str] = {}
    document = None
    for name, value in content.items():
        if name == _DOCUMENT and isinstance(value, np.ndarray) and value.dtype.kind == "U":
            document = _document(str(value.item()))
        elif not name.startswith("__"):
            _add_mat5(columns, broken, name, value)
    return Table(str(path), "MATLAB 5 .mat", columns, broken, document)


def read_hdf5(path: Path, max_bytes: int) -> Table:
    """Return the table of a version 7.3 .mat, or of any HDF5 file with arrays at its root or in groups."""
    h5py = require("h5py", "a MATLAB 7.3 file")
    columns: dict[str, FloatArray] = {}
    broken: dict[str, str] = {}
    room = max_bytes

    def visit(name: str, item: Any) -> None:
        nonlocal room
        if not isinstance(item, h5py.Dataset) or name.startswith("#"):
            return
        label = name.replace("/", ".")
        held = item.id.get_storage_size()
        if item.nbytes > held * (_MAX_DEFLATE if item.chunks else 1) and item.nbytes > 1 << 16:
            raise InputError(
                f"{path}: {label} claims {item.nbytes} bytes and holds {held}; it is cut short, copy it again"
            )
        room -= item.nbytes
        if room < 0:
            raise InputError(f"{path}: inflates to more than {max_bytes} bytes; raise max_bytes")
        if item.attrs.get("MATLAB_class", b"double") in (b"char", b"cell"):
            broken[label] = f"column {label} holds text or cells, not numbers; map another column"
        else:
            add_array(columns, broken, label, np.asarray(item[()]))

    with h5py.File(path, "r") as file:
        file.visititems(visit)
    return Table(str(path), "MATLAB 7.3 .mat", columns, broken)


def write_mat5(path: Path, columns: Mapping[str, FloatArray], document: Mapping[str, Any]) -> None:
    """Write `columns` as column vectors of a version 5 .mat, the document beside them as text."""
    content: dict[str, Any] = {name: values[:, np.newaxis] for name, values in columns.items()}
    content[_DOCUMENT] = json.dumps(document)
    with path.open("wb") as file:
        require("scipy.io", "a MATLAB file").savemat(file, content)


def _document(text: str) -> Mapping[str, Any] | None:
    document = json.loads(text)
    return document if isinstance(document, dict) else None


def _add_mat5(columns: dict[str, FloatArray], broken: dict[str, str], name: str, value: Any) -> None:
    if not isinstance(value, np.ndarray):
        broken[name] = f"column {name} is sparse or an object, not an array; save it with full() or double()"
    elif value.dtype.names is None:
        add_array(columns, broken, name, _unwrapped(value))
    elif value.size == 1:
        record = value.reshape(-1)[0]
        for part in value.dtype.names:
            _add_mat5(columns, broken, f"{name}.{part}", record[part])
    else:
        broken[name] = f"column {name} is an array of {value.size} structs; save the one you mean on its own"


def _unwrapped(value: NDArray[Any]) -> NDArray[Any]:
    """Return the array inside a one-element cell, which is how some exporters wrap a signal."""
    inner = value.reshape(-1)[0] if value.dtype == object and value.size == 1 else value
    return inner if isinstance(inner, np.ndarray) and inner.dtype != object else value


def _check_claims(path: Path, max_bytes: int) -> None:
    """Walk the file's top-level elements and refuse sizes that the file cannot hold, before any allocation.

    Each element is a tag (type, bytes) and its data; a compressed one hides another tag inside (MAT-File
    Format, MathWorks 2024, chapter 1).
    """
    size = path.stat().st_size
    total = 0
    with path.open("rb") as file:
        order = {b"IM": "<", b"MI": ">"}.get(file.read(128)[126:128])
        if order is None:
            raise InputError(f"{path}: the MATLAB header is cut short; copy the file again")
        while len(tag := file.read(8)) == 8:
            kind, claimed = struct.unpack(f"{order}II", tag)
            start = file.tell()
            possible = size - start
            inner = claimed
            if kind == _COMPRESSED:
                opening = zlib.decompressobj().decompress(file.read(min(possible, 256)), 8)
                if len(opening) == 8:
                    inner = struct.unpack(f"{order}II", opening)[1]
            if claimed > possible or inner > claimed * (_MAX_DEFLATE if kind == _COMPRESSED else 1):
                raise InputError(
                    f"{path}: an array claims {max(claimed, inner)} bytes, the file holds {possible}; "
                    f"it is cut short, copy it again"
                )
            total += inner
            if total > max_bytes:
                raise InputError(f"{path}: inflates to more than {max_bytes} bytes; raise max_bytes")
            file.seek(start + claimed)
