"""Text that is packed, and what is known and not read: each is told what to do."""

from __future__ import annotations

import bz2
import gzip
import io
import json
import lzma
import pickle
import zipfile
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pyarrow as pa
import pyarrow.feather
import pytest
from test_formats_names import OMEGA, TAU, THETA, T, assert_taken, log

import knobcam as kc
from knobcam.errors import InputError


def zipped(content: bytes, *names: str) -> bytes:
    made = io.BytesIO()
    with zipfile.ZipFile(made, "w", zipfile.ZIP_DEFLATED) as archive:
        for name in names or ("logs/run.csv",):
            archive.writestr(name, content)
    return made.getvalue()


PACKERS: dict[str, Callable[[bytes], bytes]] = {
    "gz": gzip.compress,
    "xz": lzma.compress,
    "bz2": bz2.compress,
    "zip": zipped,
}


@pytest.mark.parametrize("kind", PACKERS)
def test_a_log_is_the_same_however_it_is_packed(tmp_path: Path, kind: str) -> None:
    content = log(tmp_path, "time,position,velocity,torque", T, THETA, OMEGA, TAU).read_bytes()
    path = tmp_path / f"run.csv.{kind}"
    path.write_bytes(PACKERS[kind](content))
    assert_taken(path)
    assert kc.load(path).meta["format"] == {"bz2": "CSV bzip2", "gz": "CSV gzip"}.get(kind, f"CSV {kind}")
    rows = [{"time": t, "position": q, "torque": u} for t, q, u in zip(T, THETA, TAU, strict=True)]
    path.write_bytes(PACKERS[kind](json.dumps(rows).encode()))
    assert_taken(path)


@pytest.mark.parametrize("kind", PACKERS)
def test_what_is_packed_and_cut_short_or_damaged_is_refused(tmp_path: Path, kind: str) -> None:
    content = log(tmp_path, "time,position,torque", T, THETA, TAU).read_bytes()
    packed = PACKERS[kind](content)
    path = tmp_path / f"run.csv.{kind}"
    for spoiled in (packed[: len(packed) // 2], packed[:200] + bytes(60) + packed[260:]):
        path.write_bytes(spoiled)
        with pytest.raises(InputError, match=r"copy|export it again|not a number"):
            kc.load(path)


def test_a_zip_that_inflates_without_end_is_refused(tmp_path: Path) -> None:
    (tmp_path / "run.zip").write_bytes(zipped(bytes(100_000_000)))
    with pytest.raises(InputError, match=r"inflate|neither text"):
        kc.load(tmp_path / "run.zip")


def test_of_several_files_in_a_zip_one_is_asked_for(tmp_path: Path) -> None:
    (tmp_path / "run.zip").write_bytes(zipped(b"t,q\n", "a.csv", "b.csv"))
    with pytest.raises(InputError, match=r"a zip of 2 files \(a.csv, b.csv\); unpack it and give one"):
        kc.load(tmp_path / "run.zip")


def feather() -> bytes:
    made = io.BytesIO()
    pyarrow.feather.write_feather(pa.table({"t": T}), made)
    return made.getvalue()


@pytest.mark.parametrize(
    ("content", "said"),
    [
        (pickle.dumps({"t": T}), "a pickle, which is never read; save its numbers as .npz or CSV"),
        (feather(), "save it as Parquet"),
        (b"TDSm" + bytes(60), "export it as CSV"),
        (b"MDF     4.10    " + bytes(60), "asammdf"),
        (bytes.fromhex("d0cf11e0a1b11ae1") + bytes(60), "save its sheet as CSV"),
        (b"7z\xbc\xaf\x27\x1c" + bytes(60), "unpack it"),
    ],
    ids=lambda one: None if isinstance(one, bytes) else one[:20],
)
def test_what_is_known_and_not_read_is_told_the_way_out(tmp_path: Path, content: bytes, said: str) -> None:
    path = tmp_path / "run.bin"
    path.write_bytes(content)
    with pytest.raises(InputError) as refusal:
        kc.load(path)
    assert said in str(refusal.value) and "\n" not in str(refusal.value)


def test_numbers_that_are_no_matrix_of_matlab_are_not_called_one(tmp_path: Path) -> None:
    np.zeros(100).tofile(tmp_path / "run.bin")
    with pytest.raises(InputError, match="neither text nor a format"):
        kc.load(tmp_path / "run.bin")
