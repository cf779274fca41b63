"""Arrays by their types: samples in SI, and which of them count."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..errors import InputError

FloatArray = NDArray[np.float64]
BoolArray = NDArray[np.bool_]
IntArray = NDArray[np.intp]


def vector(name: str, values: ArrayLike) -> FloatArray:
    """Return one value a sample, shape (samples,); InputError names what is no such array."""
    try:
        array = np.asarray(values, dtype=np.float64)
    except (TypeError, ValueError) as error:
        raise InputError(f"{name}: not an array of numbers ({error})") from error
    if array.ndim != 1:
        raise InputError(f"{name}: has shape {array.shape}; give one value a sample")
    return array
