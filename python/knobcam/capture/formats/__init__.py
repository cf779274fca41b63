"""Readers and writers. A file is known by its content, never by its extension; a writer by its extension."""

from __future__ import annotations

import stat
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import IO, Any

from ...base.arrays import BoolArray, FloatArray
from ...base.reading import look, open_file
from ...base.writing import RECORDING, write
from ...errors import InputError
from . import inflate, magic
from .motors import of_one
from .table import DEFAULT_MAX_BYTES, Table
from .text import read_text, write_text

_HEAD_BYTES = 1024

__all__ = ["DEFAULT_MAX_BYTES", "Table", "read_table", "runs_in", "write_table"]


def read_table(path: Path, max_bytes: int = DEFAULT_MAX_BYTES, joint: str | None = None) -> Table:
    """Return the columns of any importable file, of one joint where it has several.

    InputError says what is wrong with it.
    """
    found = look(path)
    is_folder, size = stat.S_ISDIR(found.st_mode), found.st_size
    head = b"" if is_folder or size > max_bytes else _head(path)
    if is_folder and (path / "metadata.yaml").is_file():  # as a recorder of ROS 2 makes them
        from . import rosbag

        return _guarded(path, lambda: rosbag.read_bag(str(path), rosbag.files_in(path), max_bytes, joint))
    if is_folder:
        runs = runs_in(path)
        if not runs:
            raise InputError(f"{path}: a folder, not a file; name the file inside")
        names = ", ".join(run.name for run in runs[:5]) + (" ..." if len(runs) > 5 else "")
        raise InputError(f"{path}: a folder of {len(runs)} runs ({names}); name one of them")
    if size > max_bytes:
        raise InputError(f"{path}: {size} bytes, the limit is {max_bytes}; raise max_bytes to read it")
    if size == 0:
        raise InputError(f"{path}: the file is empty; a capture has columns of samples")
    return _guarded(path, lambda: _read(path, head, max_bytes, joint))


def _guarded(path: Path, read: Callable[[], Table]) -> Table:
    try:
        return read()
    except InputError:
        raise
    except Exception as error:  # a damaged file makes the parsers of six packages raise anything at all
        raise InputError(
            f"{path}: damaged or not what its first bytes say ({type(error).__name__}: {error}); "
            f"export it again"
        ) from error


def write_table(
    path: Path, columns: Mapping[str, FloatArray], mask: BoolArray, document: Mapping[str, Any]
) -> None:
    """Write a capture's columns (float64, one length), mask and document in the format of the extension.

    .csv, .csv.gz, .parquet, .mat and .h5 or .hdf5; anything else is the native .npz. The file appears whole
    or not at all.
    """
    name = path.name.lower()
    if name.endswith(".csv"):
        write(path, lambda file: file.write(write_text(columns, document).encode()))
    elif name.endswith(".csv.gz"):
        write(path, lambda file: file.write(inflate.deflate(write_text(columns, document).encode())))
    elif name.endswith(".parquet"):
        from .parquet import write_parquet

        write(path, lambda file: write_parquet(file, columns, document))
    elif name.endswith(".mat"):
        from .matlab import write_mat5

        write(path, lambda file: write_mat5(file, columns, document))
    elif name.endswith((".h5", ".hdf5")):
        from .hdf5 import write_hdf5

        write(path, lambda file: write_hdf5(file, columns, document))
    else:
        from .numpy_files import write_native

        write(path, lambda file: write_native(file, columns, mask, document))


def _head(path: Path) -> bytes:
    with open_file(path) as file:
        return file.read(_HEAD_BYTES)


def _read(path: Path, head: bytes, max_bytes: int, joint: str | None) -> Table:
    # A file loads its own reader and no other: they are half the start of a process together.
    budget = inflate.Budget(str(path), path.stat().st_size, max_bytes)
    if head.startswith((*magic.PACKED, magic.ZIP)):
        from . import packed

        if packed.is_packed(path, head):
            with packed.unpacked(path, head) as (kind, stream):
                return _read_text(kind, stream, budget, joint)
    if magic.is_json(head):
        with open_file(path) as file:
            return _read_text("CSV", file, budget, joint)
    if magic.is_bag(head):
        from . import rosbag

        return rosbag.read_bag(str(path), [path], max_bytes, joint)
    if (other := magic.not_read(head)) is not None:
        raise InputError(f"{path}: {other}")
    if (binary := _binary(path, head, max_bytes)) is not None:
        return of_one(binary, joint)
    with open_file(path) as file:
        return of_one(read_text("CSV", file, budget), joint)


def _binary(path: Path, head: bytes, max_bytes: int) -> Table | None:
    """Read what is neither text nor a bag; None for text."""
    if head.startswith((magic.NPY, magic.ZIP)):
        from . import numpy_files

        is_array = head.startswith(magic.NPY)
        return (numpy_files.read_npy if is_array else numpy_files.read_npz)(path, max_bytes)
    if head.startswith(magic.MATLAB):
        from .matlab import read_mat5

        return read_mat5(path, max_bytes)
    if magic.mat4(head) is not None:
        from .matlab4 import read_mat4

        return read_mat4(path, max_bytes)
    if magic.is_hdf5(head):
        from .hdf5 import read_hdf5

        return read_hdf5(path, max_bytes)
    if head.startswith(magic.PARQUET):
        from .parquet import read_parquet

        return read_parquet(path, max_bytes)
    if head.startswith(RECORDING):
        from .wire import read_wire

        return read_wire(path)
    return None


def _read_text(kind: str, stream: IO[bytes], budget: inflate.Budget, joint: str | None) -> Table:
    head = inflate.peek(stream, _HEAD_BYTES, budget)
    if magic.is_json(head):
        from .json_files import read_json

        return read_json(stream, budget, joint)
    return of_one(read_text(kind, stream, budget), joint)


def runs_in(folder: Path) -> list[Path]:
    """Return the runs in a folder that holds one to a file, as BAM and others log them in JSON."""
    return sorted(path for path in folder.glob("*.json*") if path.is_file())
