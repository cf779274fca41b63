"""How the files of each kind begin: apart from their readers, so that a file loads only its own."""

from __future__ import annotations

import re

GZIP = b"\x1f\x8b"
NPY = b"\x93NUMPY"
ZIP = b"PK\x03\x04"
MATLAB = b"MATLAB 5.0 MAT-file"
PARQUET = b"PAR1"
MCAP = b"\x89MCAP0\r\n"
SQLITE = b"SQLite format 3\0"
ROS1 = b"#ROSBAG V"
_HDF5 = b"\x89HDF\r\n\x1a\n"
_USER_BLOCK = 512  # bytes of text that MATLAB puts before the HDF5 content
_JSON = re.compile(rb"\s*(\{|\[\s*[\[{])")


def is_bag(head: bytes) -> bool:
    """Whether a file is one of ROS 2's two kinds of bag."""
    return head.startswith((MCAP, SQLITE))


def is_hdf5(head: bytes) -> bool:
    """Whether HDF5 begins at once or behind the text of MATLAB."""
    return _HDF5 in (head[: len(_HDF5)], head[_USER_BLOCK : _USER_BLOCK + len(_HDF5)])


def is_json(head: bytes) -> bool:
    """Whether text begins as an object, or as a list of objects or of lists."""
    return _JSON.match(head.removeprefix(b"\xef\xbb\xbf")) is not None
