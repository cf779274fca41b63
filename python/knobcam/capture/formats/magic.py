"""How the files of each kind begin: apart from their readers, so that a file loads only its own."""

from __future__ import annotations

import re
import struct
from typing import NamedTuple

GZIP = b"\x1f\x8b"
XZ = b"\xfd7zXZ\x00"
PACKED = (GZIP, XZ, *(b"BZh%d1AY&SY" % level for level in range(1, 10)))  # the last of bzip2
NPY = b"\x93NUMPY"
ZIP = b"PK\x03\x04"
MATLAB = b"MATLAB 5.0 MAT-file"
PARQUET = b"PAR1"
MCAP = b"\x89MCAP0\r\n"
SQLITE = b"SQLite format 3\0"
_NOT_READ = {
    b"#ROSBAG V": "a bag of ROS 1; convert it to ROS 2, for example with rosbags-convert",
    b"TDSm": "a TDMS file of LabVIEW; export it as CSV, or save it as HDF5 or Parquet",
    b"MDF     ": "a measurement in MDF; export it as CSV or Parquet, for example with asammdf",
    b"UnFinMF ": "a measurement in MDF that was not finished; export it as CSV or Parquet with asammdf",
    b"ARROW1": "an Arrow or Feather file; save it as Parquet",
    b"\xd0\xcf\x11\xe0\xa1\xb1\x1a\xe1": "an old workbook of a spreadsheet; save its sheet as CSV",
    b"\x28\xb5\x2f\xfd": "packed by zstd; unpack it and give the file inside",
    b"7z\xbc\xaf\x27\x1c": "a 7z archive; unpack it and give the file inside",
    b"Rar!\x1a": "a rar archive; unpack it and give the file inside",
} | dict.fromkeys(
    (b"\x80\x02", b"\x80\x03", b"\x80\x04", b"\x80\x05"),
    "a pickle, which is never read; save its numbers as .npz or CSV",
)
"""What is known and not read, by how it begins: what it is, and the way out."""
_HDF5 = b"\x89HDF\r\n\x1a\n"
_USER_BLOCK = 512  # bytes of text that MATLAB puts before the HDF5 content
_MAT4 = struct.Struct("<5I")  # its kind, rows, columns, whether complex, letters of the name and a zero
_MAT4_ORDERS = ("<", ">")  # by the thousands of its kind
_MAT4_NUMBERS = ("f8", "f4", "i4", "i2", "u2", "u1")  # by its tens
_MAT4_KINDS = 3  # by its ones: numbers, text, sparse
_MAT4_NAME = 64  # letters and a zero: MATLAB's names are up to 63
MAT4_BYTES = _MAT4.size + _MAT4_NAME
"""As much as the longest beginning of a matrix of MATLAB version 4 takes."""
_JSON = re.compile(rb"\s*(\{|\[\s*[\[{])")
_OWN_TOML = re.compile(rb"(?:\s*#.*\n)*\s*schema\s*=\s*[\"'](knobcam\.[\w./-]+)")


def not_read(head: bytes) -> str | None:
    """Return what a file is that is known and not read, and the way out; None for any other."""
    if (own := _OWN_TOML.match(head)) is not None:
        return no_capture(own[1].decode())
    return next((said for begin, said in _NOT_READ.items() if head.startswith(begin)), None)


def no_capture(schema: str) -> str:
    """Return that a file calls itself another thing than a capture, and the way out."""
    return f"calls itself {schema[:40]}, which is no capture; name a file with columns of samples"


class Mat4(NamedTuple):
    """How a matrix of MATLAB version 4 begins: its numbers are `dtype`, from the byte `start` on."""

    dtype: str
    what: int
    rows: int
    columns: int
    imaginary: bool
    name: str
    start: int


def mat4(head: bytes) -> Mat4 | None:
    """Return how a matrix of MATLAB version 4 begins, five numbers and its name; None where none does."""
    if len(head) < _MAT4.size:
        return None
    for machine, order in enumerate(_MAT4_ORDERS):
        kind, rows, columns, imaginary, letters = struct.unpack(order + _MAT4.format[1:], head[: _MAT4.size])
        number, what = kind // 10 % 100, kind % 10
        known = kind // 1000 == machine and number < len(_MAT4_NUMBERS) and what < _MAT4_KINDS
        sizes = rows < 2**31 and columns < 2**31 and imaginary in (0, 1) and 1 < letters <= _MAT4_NAME
        start = _MAT4.size + letters
        name = head[_MAT4.size : start]
        if known and sizes and re.fullmatch(rb"[A-Za-z]\w*\0", name):
            dtype = order + _MAT4_NUMBERS[number]
            return Mat4(dtype, what, rows, columns, imaginary == 1, name[:-1].decode(), start)
    return None


def is_bag(head: bytes) -> bool:
    """Whether a file is one of ROS 2's two kinds of bag."""
    return head.startswith((MCAP, SQLITE))


def is_hdf5(head: bytes) -> bool:
    """Whether HDF5 begins at once or behind the text of MATLAB."""
    return _HDF5 in (head[: len(_HDF5)], head[_USER_BLOCK : _USER_BLOCK + len(_HDF5)])


def is_json(head: bytes) -> bool:
    """Whether text begins as an object, or as a list of objects or of lists."""
    return _JSON.match(head.removeprefix(b"\xef\xbb\xbf")) is not None
