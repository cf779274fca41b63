"""MATLAB version 4, as Simulink's blocks write logs: it was refused, though it is a few lines to read."""

from __future__ import annotations

import io
import struct
from pathlib import Path

import numpy as np
import pytest
import scipy.io  # type: ignore[import-untyped]

from knobcam.capture.formats import read_table
from knobcam.errors import InputError

T = np.arange(50) / 500.0
LOG = np.stack([T, np.sin(T), np.cos(T)])


def mat4(**variables: object) -> bytes:
    made = io.BytesIO()
    scipy.io.savemat(made, variables, format="4")
    return made.getvalue()


def big_endian() -> bytes:
    kind, *sizes = struct.unpack("<5I", mat4(data_log=LOG)[:20])
    content = LOG.astype(">f8").tobytes(order="F")
    return struct.pack(">5I", kind + 1000, *sizes) + b"data_log\0" + content


@pytest.mark.parametrize("content", [mat4(data_log=LOG), big_endian()], ids=["little", "big"])
def test_a_matrix_of_version_4_is_read_along_its_longer_axis(tmp_path: Path, content: bytes) -> None:
    (tmp_path / "run.mat").write_bytes(content)
    columns = read_table(tmp_path / "run.mat").columns
    assert list(columns) == ["data_log.c0", "data_log.c1", "data_log.c2"]
    for column, row in zip(columns.values(), LOG, strict=True):
        np.testing.assert_array_equal(column, row)


def test_every_kind_of_number_is_read_and_what_is_none_says_so(tmp_path: Path) -> None:
    whole = (np.arange(50) % 7).astype
    kinds = {name: whole(name) for name in ("float32", "int32", "int16", "uint16", "uint8")}
    (tmp_path / "run.mat").write_bytes(mat4(note="as it was", phase=np.exp(1j * T), **kinds))
    table = read_table(tmp_path / "run.mat")
    for name in kinds:
        np.testing.assert_array_equal(table.columns[name], np.arange(50) % 7)
    assert set(table.broken) == {"note", "phase"} and "text" in table.broken["note"]


@pytest.mark.parametrize(
    ("spoiled", "said"), [(slice(None, -8), "cut short"), (None, "behind its last matrix")]
)
def test_of_version_4_what_is_damaged_is_told(tmp_path: Path, spoiled: slice | None, said: str) -> None:
    content = mat4(data=LOG)
    (tmp_path / "run.mat").write_bytes(
        content[spoiled] if spoiled else content + b"and more of it\0\0\0\0\0\0\0\0"
    )
    with pytest.raises(InputError, match=said):
        read_table(tmp_path / "run.mat")
