"""A file's content before anyone decides what its columns mean."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...base.arrays import BoolArray, FloatArray
from ...errors import InputError
from ..finding import Finding
from .units import is_unit, spelled_out

DEFAULT_MAX_BYTES = 4 * 2**30
"""Largest file, and largest inflated content, that is read without being asked to (bytes)."""

MOST_COLUMNS = 4096
"""Columns of a file; a robot logs some hundred, a matrix that is no log has any number."""

_SHOWN = 20  # names, in a message


@dataclass(frozen=True)
class Table:
    """Named columns as they stand in a file, each float64 of shape (rows,), or () for a scalar.

    Columns may differ in length: only those that a capture uses have to agree. `broken` holds, by column,
    why it cannot be used, so that a text column nobody asks for does no harm. `units` has, by column, the
    unit that the file states beside the name, as a map would have it; `si` says that its format has all in
    SI, as messages of ROS (REP 103). `document` and `mask` are there when knobcam wrote the file. A recording
    of a rig says more of itself: where it came from (`meta`), by column of a capture the samples at a limit
    of the sensor, and what else is to be known.
    """

    source: str
    kind: str
    columns: Mapping[str, FloatArray]
    broken: Mapping[str, str] = field(default_factory=dict)
    document: Mapping[str, Any] | None = None
    mask: BoolArray | None = None
    meta: Mapping[str, Any] | None = None
    limits: Mapping[str, BoolArray] = field(default_factory=dict)
    notes: tuple[Finding, ...] = ()
    units: Mapping[str, str] = field(default_factory=dict)
    si: bool = False

    def __post_init__(self) -> None:
        check_width(self.source, len(self.columns) + len(self.broken))

    def column(self, name: str) -> FloatArray:
        """Return the column called `name`; InputError lists what there is when it is absent or unusable."""
        if name in self.columns:
            return self.columns[name]
        if name in self.broken:
            raise InputError(f"{self.source}: {self.broken[name]}")
        raise InputError(f"{self.source}: no column {name!r}; the file has {self.listing()}")

    def listing(self) -> str:
        """Return the column names for a message, in the order of the file."""
        names = [*self.columns, *self.broken]
        shown = ", ".join(name if name.isprintable() else repr(name) for name in names[:_SHOWN])
        if len(names) > _SHOWN:
            shown += f" and {len(names) - _SHOWN} more"
        return shown or "no columns"


def check_width(source: str, count: int) -> None:
    """Refuse more columns than a log has."""
    if count > MOST_COLUMNS:
        raise InputError(f"{source}: has {count} columns or more, the most is {MOST_COLUMNS}; leave some out")


def called(cells: list[str]) -> list[str]:
    """Return what columns are called: of several of one name each by its place too, so that none is meant."""
    names = [cell or f"c{index}" for index, cell in enumerate(cells)]
    while (often := Counter(names)).most_common(1)[0][1] > 1:
        names = [f"{name} #{place}" if often[name] > 1 else name for place, name in enumerate(names, 1)]
    return names


def of_a_class(label: str, what: str) -> str:
    """Say of a MATLAB object of a class how its numbers are saved."""
    way = "take its numbers out in MATLAB, as t = out.tout, and save them"
    return f"column {label} holds an object of {what}, not an array of numbers; {way}"


def add_array(columns: dict[str, FloatArray], broken: dict[str, str], name: str, array: NDArray[Any]) -> None:
    """Put an array of up to two axes into `columns`: a vector as `name`, a matrix as `name.c0`, `name.c1`...

    The longer axis of a matrix is time. What is not a real number goes to `broken`.
    """
    label = name or "the array"
    if array.dtype.names is not None:
        for part in array.dtype.names:
            add_array(columns, broken, f"{name}.{part}" if name else part, array[part])
    elif array.dtype.kind not in "biuf":
        broken[label] = f"column {label} holds {_kind_in_words(array)}, not real numbers; map another column"
    elif array.size == 1:
        columns[name or "c0"] = np.asarray(array, dtype=np.float64).reshape(())
    elif array.size == max(array.shape, default=0) or array.ndim == 1:
        columns[name or "c0"] = np.asarray(array, dtype=np.float64).ravel()
    elif array.ndim == 2:
        rows = array if array.shape[0] >= array.shape[1] else array.T
        for index in range(rows.shape[1]):
            key = f"{name}.c{index}" if name else f"c{index}"
            columns[key] = np.asarray(rows[:, index], dtype=np.float64)
    else:
        broken[label] = (
            f"{label} has {array.ndim} axes {array.shape}; save it as a matrix of samples x columns"
        )


def stated_unit(attributes: Mapping[Any, Any]) -> str | None:
    """Return the unit that a column's attributes state, as a map would have it; None where there is none."""
    for key in ("units", "unit", b"units", b"unit"):
        said = attributes.get(key)
        text = said.decode(errors="replace") if isinstance(said, bytes) else said
        if isinstance(text, str) and (unit := spelled_out(text) or (text if is_unit(text) else None)):
            return unit
    return None


def _kind_in_words(array: NDArray[Any]) -> str:
    words = {"c": "complex numbers", "U": "text", "S": "text", "M": "dates", "m": "time spans"}
    return words.get(array.dtype.kind, "objects")


def choose(source: str, asked: str | None, names: Iterable[str], what: str = "joints") -> str:
    """Return the joint that was asked for, or the only one; InputError lists them where neither is there."""
    known = sorted(names)
    if asked in known:
        return str(asked)
    shown = ", ".join(known[:_SHOWN]) + (f" and {len(known) - _SHOWN} more" if len(known) > _SHOWN else "")
    if asked is not None:
        raise InputError(f"{source}: no {what[:-1]} {asked!r}; there are {shown}")
    if len(known) > 1:
        raise InputError(
            f"{source}: {len(known)} {what}, {shown}; choose one, for example --joint {known[0]}"
        )
    return known[0]


def check_joint(source: str, asked: str | None) -> None:
    """Refuse a joint where a file has none to choose from."""
    if asked is not None:
        raise InputError(f"{source}: has no joints to choose from; leave joint={asked!r} out")
