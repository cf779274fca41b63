"""NumPy's .npy and .npz, and the native capture, which is an .npz. Never unpickles."""

from __future__ import annotations

import io
import json
import math
from collections.abc import Mapping
from pathlib import Path
from typing import IO, Any

import numpy as np
from numpy.typing import NDArray

from ...base.arrays import BoolArray, FloatArray
from ...errors import InputError
from .inflate import Budget
from .table import Table, add_array, check_width

_DOCUMENT = "knobcam"
_MASK = "mask"


def read_npy(path: Path, max_bytes: int) -> Table:
    """Return the table of an .npy: c0, c1... along the longer axis, or the names of a structured array."""
    columns: dict[str, FloatArray] = {}
    broken: dict[str, str] = {}
    with path.open("rb") as file:
        size = path.stat().st_size
        add_array(columns, broken, "", _read_array(file, size, Budget(str(path), size, max_bytes)))
    return Table(str(path), "NumPy .npy", columns, broken)


def read_npz(path: Path, max_bytes: int) -> Table:
    """Return the table of an .npz, or the native capture that it holds."""
    columns: dict[str, FloatArray] = {}
    broken: dict[str, str] = {}
    document: Mapping[str, Any] | None = None
    mask: BoolArray | None = None
    import zipfile

    with zipfile.ZipFile(path) as archive:
        members = [info for info in archive.infolist() if info.filename.endswith(".npy")]
        sheets = [name for name in archive.namelist() if name.startswith("xl/") or name == "content.xml"]
        if not members and sheets:
            raise InputError(f"{path}: a workbook of a spreadsheet; save its sheet as CSV and give that")
        if not members:
            raise InputError(f"{path}: a zip file without arrays; unpack it and give the file inside")
        budget = Budget(str(path), path.stat().st_size, max_bytes)
        budget.take(sum(info.file_size for info in members))
        check_width(str(path), len(members))
        for info in members:
            name = info.filename.removesuffix(".npy")
            with archive.open(info) as file:
                array = _read_array(file, info.file_size, budget, f"{path}: {name}")
            if name == _DOCUMENT and array.dtype.kind == "U" and array.ndim == 0:
                loaded = json.loads(str(array))
                document = loaded if isinstance(loaded, dict) else None
            elif name == _MASK and array.dtype == np.bool_ and array.ndim == 1:
                mask = array
            else:
                add_array(columns, broken, name, array)
    return Table(str(path), "NumPy .npz", columns, broken, document, mask)


def write_native(
    file: IO[bytes], columns: Mapping[str, FloatArray], mask: BoolArray, document: Mapping[str, Any]
) -> None:
    """Write the native capture: an .npz with the columns, the mask and the document as JSON text."""
    np.savez(file, allow_pickle=False, **columns, mask=mask, knobcam=np.array(json.dumps(document)))


def _read_array(file: IO[bytes], size: int, budget: Budget, name: str = "") -> NDArray[Any]:
    """Return the array in `file` of `size` bytes, after checking that its header does not claim more."""
    source = name or budget.source
    head = file.read(min(size, 1 << 16))
    header = io.BytesIO(head)
    version = np.lib.format.read_magic(header)
    if version == (1, 0):
        shape, _, dtype = np.lib.format.read_array_header_1_0(header)
    else:
        shape, _, dtype = np.lib.format.read_array_header_2_0(header)
    if dtype.hasobject:
        raise InputError(f"{source}: holds pickled objects, which are not read; save plain numbers")
    claimed = math.prod(shape) * dtype.itemsize
    held = size - header.tell()
    if claimed > held or min(shape, default=0) < 0:
        raise InputError(
            f"{source}: the header claims {claimed} bytes ({shape} {dtype}), the file holds {held}; "
            f"it is cut short, copy it again"
        )
    budget.numbers(math.prod(shape), dtype.itemsize)
    rest = io.BytesIO(head + file.read(max(0, header.tell() + claimed - len(head))))
    return np.asarray(np.lib.format.read_array(rest, allow_pickle=False))
