"""MATLAB .mat version 4, which Simulink's blocks and `save -v4` still write: matrices, one after the other.

After "MAT-File Format" (MathWorks 2024), chapter 2. A matrix has no more names than its own: a log whose
first row is the time is `data.c0`, `data.c1`, ...
"""

from __future__ import annotations

from pathlib import Path

import numpy as np

from ...base.arrays import FloatArray
from ...errors import InputError
from . import magic
from .inflate import Budget
from .table import Table, add_array

_TEXT, _SPARSE = 1, 2
_NOT_READ = {_TEXT: "text", _SPARSE: "a sparse matrix"}


def read_mat4(path: Path, max_bytes: int) -> Table:
    """Return the table of a version 4 .mat."""
    raw = memoryview(path.read_bytes())
    budget = Budget(str(path), len(raw), max_bytes).held()
    columns: dict[str, FloatArray] = {}
    broken: dict[str, str] = {}
    while len(raw) > 0:
        head = magic.mat4(bytes(raw[: magic.MAT4_BYTES]))
        if head is None:
            raise InputError(f"{path}: {len(raw)} bytes behind its last matrix are none; copy the file again")
        dtype = np.dtype(head.dtype)
        count = head.rows * head.columns
        size = count * dtype.itemsize * (2 if head.imaginary else 1)
        if size > len(raw) - head.start:
            raise InputError(
                f"{path}: {head.name} claims {size} bytes, the file holds {len(raw) - head.start}; "
                "it is cut short, copy it again"
            )
        data, raw = raw[head.start : head.start + size], raw[head.start + size :]
        if head.what in _NOT_READ or head.imaginary:
            holds = _NOT_READ.get(head.what, "complex numbers")
            broken[head.name] = (
                f"column {head.name} holds {holds}, not an array of numbers; map another column"
            )
            continue
        budget.numbers(count)
        values = np.frombuffer(data, dtype=dtype).reshape((head.rows, head.columns), order="F")
        add_array(columns, broken, head.name, values)
    return Table(str(path), "MATLAB 4 .mat", columns, broken)
