"""Arrays by their types: samples in SI, and which of them count."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..errors import InputError

FloatArray = NDArray[np.float64]
BoolArray = NDArray[np.bool_]
IntArray = NDArray[np.intp]

_KINDS = {"b": "truths", "c": "complex numbers", "U": "text", "S": "text", "M": "dates", "m": "time spans"}


def vector(name: str, values: ArrayLike) -> FloatArray:
    """Return one value a sample, shape (samples,); InputError names what is no such array."""
    try:
        given = np.asarray(values)
    except (TypeError, ValueError, OverflowError, RecursionError) as error:
        raise InputError(f"{name}: not an array of numbers ({error})") from error
    if given.dtype.kind not in "iuf":
        raise InputError(
            f"{name}: holds {_KINDS.get(given.dtype.kind, 'objects')}; give an array of real numbers"
        )
    array = given.astype(np.float64)
    # What a mask hides is no reading. (To ask numpy.ma whether it is one would cost every process 5 ms.)
    if (hidden := getattr(values, "mask", None)) is not None:
        array[np.broadcast_to(hidden, array.shape)] = np.nan
    if array.ndim != 1:
        raise InputError(f"{name}: has shape {array.shape}; give one value a sample")
    return array


def truths(name: str, values: ArrayLike) -> BoolArray:
    """Return which samples are meant, shape (samples,); InputError for what holds anything else."""
    try:
        array = np.asarray(values)
    except (TypeError, ValueError) as error:
        raise InputError(f"{name}: not an array of truths ({error})") from error
    if array.dtype.kind != "b":
        raise InputError(f"{name}: holds no truths; give True or False for each sample")
    return array


def runs(flags: BoolArray) -> tuple[IntArray, IntArray]:
    """Return where each run of truths begins, and the index behind its last one."""
    edges = np.flatnonzero(np.diff(np.concatenate(([False], flags, [False]))))
    return edges[::2], edges[1::2]


def groups(indices: IntArray, within: int) -> list[IntArray]:
    """Return ascending indices in groups, whose neighbours are not further than `within` from each other."""
    if not indices.size:
        return []
    return np.split(indices, np.flatnonzero(np.diff(indices) > within) + 1)


def chosen(values: FloatArray, rows: IntArray | BoolArray) -> FloatArray:
    """Return values at rows (ascending indices, each once, or truths); all of them are not copied."""
    every = rows.all() if rows.dtype == np.bool_ else len(rows) == len(values)
    return values if every else values[rows]
