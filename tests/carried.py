"""What a page of linked plots carries, as its reader would unpack it."""

from __future__ import annotations

import base64
import json
import re
import zlib
from typing import Any

import numpy as np

from knobcam.base.arrays import FloatArray


def carried(page: str) -> dict[str, Any]:
    """The document in a page; its samples are packed."""
    found: dict[str, Any] = json.loads(re.findall(r'id="look-samples">(.*?)</script>', page, re.DOTALL)[0])
    return found


def unpacked(column: dict[str, Any]) -> FloatArray:
    """A column of a page, not a number where it has none."""
    planes = np.frombuffer(zlib.decompress(base64.b64decode(column["deflated"])), np.uint8)
    folded = planes.reshape(4, -1).T.copy().view("<u4").ravel()
    steps = np.cumsum((folded >> 1).astype(np.int64) ^ -(folded & 1).astype(np.int64))
    return np.where(steps == 0, np.nan, column["low"] + column["step"] * (steps - 1.0))
