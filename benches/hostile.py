"""Inputs of up to 100 MB that are as bad as can be, each a function that writes one."""

from __future__ import annotations

import gzip
import io
import sqlite3
import zipfile
from collections.abc import Callable
from pathlib import Path

import h5py
import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
import scipy.io

_SIZE = 100_000_000
_HEAD = b"t_s,theta_rad,tau_Nm\n"
_LOG = b'knobcam wire log\n{"schema": "knobcam.wirelog/1"}\n'


def _repeated(head: bytes, part: bytes, tail: bytes = b"", size: int = _SIZE) -> Callable[[Path], object]:
    return lambda path: path.write_bytes(head + part * ((size - len(head) - len(tail)) // len(part)) + tail)


def _packed(path: Path) -> None:
    """Three gigabytes of text in a few megabytes."""
    with gzip.open(path, "wb", compresslevel=9) as file:
        for _ in range(120):
            file.write(b"0.000001,0.000002,0.000003\n" * 1_000_000)


def _columns(count: int) -> dict[str, np.ndarray]:
    rng = np.random.default_rng(0)
    t = np.arange(count) / 5000.0
    return {"t_s": t, "theta_rad": np.sin(t), "tau_Nm": rng.standard_normal(count)}


def _long_log(path: Path) -> None:
    """A log as it is, only long: six million rows."""
    with gzip.open(path, "wb", compresslevel=1) as file:
        file.write(_HEAD)
        columns = _columns(6_000_000)
        for start in range(0, 6_000_000, 100_000):
            rows = zip(
                *(values[start : start + 100_000].tolist() for values in columns.values()), strict=True
            )
            file.write("".join("{:.6f},{:.9f},{:.9f}\n".format(*row) for row in rows).encode())


def _wide(path: Path) -> None:
    row = ",".join(["1"] * 10**6)
    path.write_text("\n".join([",".join(f"n{index}" for index in range(10**6)), row, row]))


def _zip_of_zeros(shape: int) -> Callable[[Path], None]:
    def make(path: Path) -> None:
        header = {"descr": "<f8", "fortran_order": False, "shape": (shape,)}
        with (
            zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as archive,
            archive.open("theta.npy", "w", force_zip64=True) as file,
        ):
            np.lib.format.write_array_header_1_0(file, header)
            for _ in range(3200):
                file.write(bytes(10**6))

    return make


def _zip_of_many(path: Path) -> None:
    with io.BytesIO() as one:
        np.save(one, np.zeros(2))
        content = one.getvalue()
    with zipfile.ZipFile(path, "w") as archive:
        for index in range(200_000):
            archive.writestr(f"a{index}.npy", content)


def _mat_of_many(path: Path) -> None:
    with io.BytesIO() as one:
        scipy.io.savemat(one, {"x": np.zeros(2)})
        content = one.getvalue()
    path.write_bytes(content[:128] + content[128:] * (30_000_000 // len(content)))


def _hdf5_of_zeros(path: Path) -> None:
    with h5py.File(path, "w") as file:
        theta = file.create_dataset("theta", (10**8,), "f8", chunks=(10**6,), compression="gzip")
        theta[:] = 0.0


def _hdf5_elsewhere(path: Path) -> None:
    with h5py.File(path, "w") as file:
        file.create_dataset("theta", (1000,), "f8", external=[("/dev/zero", 0, 8000)])


def _hdf5_of_many(path: Path) -> None:
    with h5py.File(path, "w") as file:
        for index in range(30_000):
            file.create_dataset(f"d{index}", data=1.0)


def lying(raw: bytes, claimed: int = 2**31 - 1) -> bytes:
    """Return a Parquet file whose last column has a page that claims to unpack to as many bytes."""
    group = pq.ParquetFile(io.BytesIO(raw)).metadata.row_group(0)
    chunk = group.column(group.num_columns - 1)
    start = end = (chunk.dictionary_page_offset or chunk.data_page_offset) + 3  # behind the kind of page
    while raw[end] & 128:
        end += 1
    rest, number = 2 * claimed, bytearray()
    while rest > 127:
        number.append(rest & 127 | 128)
        rest >>= 7
    return raw[:start] + bytes(number) + bytes([rest]) + raw[end + 1 :]


def _lying_page(path: Path) -> None:
    with io.BytesIO() as file:
        pq.write_table(pa.table(_columns(100_000)), file, use_dictionary=False, compression="gzip")
        path.write_bytes(lying(file.getvalue()))


def _bag_that_computes(path: Path) -> None:
    base = sqlite3.connect(path)
    base.execute("CREATE TABLE topics(id, name, type, serialization_format)")
    base.execute("CREATE TABLE messages(topic_id, timestamp, data AS (zeroblob(900000000)))")
    base.execute("INSERT INTO topics VALUES (1, 'a', 'sensor_msgs/msg/JointState', 'cdr')")
    base.executemany("INSERT INTO messages VALUES (1, ?)", [(index,) for index in range(100)])
    base.commit()
    base.close()


INPUTS: dict[str, Callable[[Path], object]] = {
    "a log of six million rows.csv.gz": _long_log,
    "rows of single digits.csv": _repeated(_HEAD, b"1,2,3\n"),
    "as many rows as are read.csv": _repeated(_HEAD, b"1.5,2.5,3.25\n"),
    "decimal commas.csv": _repeated(b"t;theta;tau\n", b"1,5;2,5;3,5\n"),
    "a word in the last row.csv": _repeated(_HEAD, b"0.1,0.2,0.3\n", b"1,2,x\n"),
    "words.csv": _repeated(_HEAD, b"x,y,z\n"),
    "empty lines.csv": _repeated(b"", b"\n"),
    "comments.csv": _repeated(b"", b"#\n"),
    "one line.csv": _repeated(b"", b"1,"),
    "one line behind others.csv": _repeated(_HEAD + b"1,2,3\n", b"1,"),
    "a million columns.csv": _wide,
    "nothing but zeros.log": _repeated(b"", b"\0"),
    "gigabytes in megabytes.csv.gz": _packed,
    "small objects.jsonl": _repeated(b"", b'{"a":1}\n'),
    "objects.jsonl": _repeated(b"", b'{"t":1,"theta":2,"tau":3}\n'),
    "lists in a list.json": _repeated(b"[", b"[],", b"[]]", 23_900_000),
    "objects in a list.json": _repeated(b"[", b"{},", b"{}]", 23_900_000),
    "numbers in a list.json": _repeated(b'{"theta":[', b"1,", b"1]}", 23_900_000),
    "brackets.json": _repeated(b"", b"["),
    "bytes.npy": lambda path: np.save(path.open("wb"), np.zeros((_SIZE // 3, 3), np.int8)),
    "doubles.npz": lambda path: np.savez(path, **_columns(_SIZE // 24)),
    "zeros.npz": _zip_of_zeros(4 * 10**8),
    "zeros behind ten numbers.npz": _zip_of_zeros(10),
    "many arrays.npz": _zip_of_many,
    "bytes.mat": lambda path: scipy.io.savemat(path, {"x": np.zeros((_SIZE // 2, 1), np.int8)}),
    "zeros.mat": lambda path: scipy.io.savemat(path, {"x": np.zeros((3 * 10**7, 1))}, do_compression=True),
    "doubles.mat": lambda path: scipy.io.savemat(path, _columns(_SIZE // 24), do_compression=True),
    "many variables.mat": _mat_of_many,
    "zeros.h5": _hdf5_of_zeros,
    "numbers of another file.h5": _hdf5_elsewhere,
    "many datasets.h5": _hdf5_of_many,
    "runs.parquet": lambda path: pq.write_table(pa.table({"theta": np.zeros(10**8, np.int8)}), path),
    "doubles.parquet": lambda path: pq.write_table(
        pa.table(_columns(_SIZE // 24)), path, use_dictionary=False
    ),
    "many columns.parquet": lambda path: pq.write_table(
        pa.table({f"c{index}": [1.0] for index in range(20_000)}), path
    ),
    "a page that claims two gigabytes.parquet": _lying_page,
    "a table that computes.db3": _bag_that_computes,
    "zeros.kcwire": _repeated(_LOG, b"\0"),
    "a nested header.kcwire": lambda path: path.write_bytes(b"knobcam wire log\n" + b"[" * 100_000 + b"\n"),
}
