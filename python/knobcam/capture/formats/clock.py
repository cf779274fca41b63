"""The times of a table's samples: its own, or by a rate; and a part of them."""

from __future__ import annotations

import math

import numpy as np

from ...base.arrays import BoolArray, FloatArray
from ...errors import InputError

SLOWEST_HZ, FASTEST_HZ = 1e-9, 1e12
"""Between these a rate and its period are numbers."""

NO_CLOCK = "no column of times; map t=COLUMN, or give the sampling rate in Hz (--rate)"


def between(
    source: str,
    columns: dict[str, FloatArray],
    rate_hz: float | None,
    start: float | None,
    end: float | None,
) -> slice | BoolArray:
    """Return which samples lie from `start` to `end`; a file without times is numbered first."""
    if rate_hz is not None and not SLOWEST_HZ <= rate_hz <= FASTEST_HZ:
        raise InputError(f"a rate of {rate_hz} Hz is no sampling rate; give samples a second")
    if "t" not in columns:
        if rate_hz is None:
            raise InputError(f"{source}: {NO_CLOCK}")
        columns["t"] = np.arange(len(columns["theta"])) / rate_hz
    if start is None and end is None:
        return slice(None)
    t = columns["t"]
    first = -math.inf if start is None else start
    last = math.inf if end is None else end
    keep = (t >= first) & (t <= last)
    if not keep.any():
        raise InputError(
            f"{source}: no sample lies {_asked(start, end)}; the file runs from "
            f"{np.nanmin(t, initial=math.inf):.6g} to {np.nanmax(t, initial=-math.inf):.6g} s"
        )
    return keep


def _asked(start: float | None, end: float | None) -> str:
    """A stretch in words, of which one end at least is given."""
    ends = ["" if start is None else f"from {start:g} s on", "" if end is None else f"up to {end:g} s"]
    return f"from {start:g} to {end:g} s" if all(ends) else "".join(ends)
