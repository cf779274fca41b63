"""Fewer points where a picture cannot show them all, without losing what shows."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from ...base.arrays import BoolArray, FloatArray

_DOTS = 20_000
_BLOCKS = 4_000  # more than the pixels of a wide picture


def some(inside: BoolArray) -> np.ndarray[tuple[int], np.dtype[np.intp]]:
    """Return indices of the true entries, at most 20 000 of them, drawn at random with a fixed seed.

    At random, because every n-th sample of a periodic motion can miss the same places each time.
    """
    rows = np.flatnonzero(inside)
    if len(rows) > _DOTS:
        rows = np.sort(np.random.default_rng(0).choice(rows, _DOTS, replace=False))
    return rows


def envelope(x: FloatArray, y: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return a line over time by the lowest and highest point of each short block, shape (<= 8000,) each.

    On paper it is the same line; NaN leaves a gap.
    """
    size = -(-len(x) // _BLOCKS)
    if size <= 4:
        return x, y
    starts = np.arange(0, len(x) - size + 1, size)
    blocks = y[: len(starts) * size].reshape(-1, size)
    low = starts + np.argmin(np.where(np.isnan(blocks), np.inf, blocks), axis=1)
    high = starts + np.argmax(np.where(np.isnan(blocks), -np.inf, blocks), axis=1)
    rows = np.sort(np.concatenate([low, high, np.arange(len(starts) * size, len(x))]))
    return x[rows], y[rows]
