"""The columns of a file that could not be read as a capture, so that a person can say which is which."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING, Any

import numpy as np

from ..capture import load
from ..capture.formats import read_table
from ..capture.formats.clock import NO_CLOCK
from ..capture.formats.recognise import UNKNOWN, Unclear
from ..errors import InputError

if TYPE_CHECKING:
    from collections.abc import Mapping
    from pathlib import Path

    from ..base import pages_sources
    from ..base.arrays import FloatArray
    from ..capture.formats.columnmap import Entry

_MOST = 60  # columns; what has more was not meant to be looked at
_FEWEST = 2  # an angle, and a torque: the times may be told by a rate
_WIDE = 60  # pieces of a column's outline
_FIELDS = {
    "t": "time",
    "theta": "angle or position",
    "tau": "torque, force or current",
    "omega": "velocity",
    "alpha": "acceleration",
}
_OF_A_MAP = (
    ("^map: ", ""),
    (r"^no torque; (.+) is a current that says no unit$", r"\1 seems to be the motor's current"),
    (
        f"^{re.escape(NO_CLOCK)}",
        "no column of times; where there is none, type how many rows a second has, in rows/s",
    ),
    ("; change the unit or the coordinate$", "; change the unit, or what the axis does"),
    ("for a linear axis, but it is rotary", "for an axis that slides, but it turns"),
    ("for a rotary axis, but it is linear", "for an axis that turns, but it slides"),
    (r", as in (?:theta|tau)=.*$", ""),
    *(
        (rf"\b{name}(?:=([^\s;,]+))? (?=in \[|is |has )", rf"the {words} \1 ")
        for name, words in _FIELDS.items()
    ),
    ("  +", " "),
)
"""What a refusal of a map has, and what stands for it where the fields of a dialog do."""
_FILLED_IN = (
    "the names of its columns do not say which is which. The fields hold what they seem to be, by names and "
    "values: look whether that is right."
)


class Unmapped(InputError):
    """A file that has columns, but not those of a capture; `guess` has what the `columns` may be."""

    def __init__(
        self, said: str, columns: list[pages_sources.FileColumn], guess: dict[str, pages_sources.Guess]
    ) -> None:
        super().__init__(said)
        self.columns = columns
        self.guess = guess


def explained(
    error: InputError, path: Path, options: Mapping[str, Any], max_bytes: int, name: str = ""
) -> InputError:
    """Return the error with the columns of the file, if it was for them that it could not be taken in.

    `name` is what the file is called where it lies by another: one that a browser handed over.
    """
    name = name or path.name
    try:
        load(path, max_bytes=max_bytes, **options)
    except InputError as again:
        found = again.entries if isinstance(again, Unclear) else {}
        try:
            columns = read_table(path, max_bytes, options.get("joint")).columns
        except InputError:
            return error
        shown = [_described(*one) for one in columns.items() if one[1].ndim == 1]
        # Its folder and its columns are on the screen, and what the map of a command would be too.
        said, asked, _ = str(error).partition("; say which is which, for example --map")
        why = said.removeprefix(f"{path}: ").removeprefix(f"{name}: ").partition("; the file has ")[0]
        said = f"{name}: {_plainly(why, len(shown)) if asked else by_eye(why)}"
        if isinstance(again, Unclear) and again.by_names and {"theta", "tau"} <= set(found):
            said = f"{name}: {_FILLED_IN}"  # what it lacks by name stands in the fields already
        guess = {name: _guessed(entry) for name, entry in found.items()}
        return Unmapped(said, shown[:_MOST], guess)
    return error


def _plainly(why: str, columns: int) -> str:
    """What a file lacks and what to do, without the names that columns have in a file of one's own."""
    takes = "a capture takes an angle or position, and a torque, force or motor current"
    if columns < _FEWEST:
        return f"this file has one column of numbers alone, and {takes}; open another file."
    why = takes if why.startswith("no columns ") else by_eye(why)
    return f"{why}: say which column is which, and in what unit."


def by_eye(why: str) -> str:
    """Return what is wrong with a map in words of its fields: whoever fills them in writes none.

    >>> by_eye("map: tau=3 is a single value, not a column of samples")
    'the torque, force or current 3 is a single value, not a column of samples'
    """
    for written, said in _OF_A_MAP:
        why = re.sub(written, said, why)
    return why


def _guessed(entry: Entry) -> pages_sources.Guess:
    # What nobody knows the page asks for.
    return {"expression": entry.expression, "unit": None if entry.unit == UNKNOWN else entry.unit}


def _described(name: str, column: FloatArray) -> pages_sources.FileColumn:
    """A column's name, rows, range, and its outline: lowest and highest of each piece, from 0 to 1."""
    finite = column[np.isfinite(column)]
    if not len(finite):
        return {"name": name, "rows": len(column), "low": None, "high": None, "outline": []}
    low, high = float(finite.min()), float(finite.max())
    shares = (column - low) / (high - low or 1.0)
    pieces = [piece[np.isfinite(piece)] for piece in np.array_split(shares, min(_WIDE, len(column)))]
    outline = [(float(piece.min()), float(piece.max())) for piece in pieces if len(piece)]
    return {"name": name, "rows": len(column), "low": low, "high": high, "outline": outline}
