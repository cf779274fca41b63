"""What sentences are made of, as JSON: words, and what every page writes in its own way.

The part of the schema in `pages.py` that results and saved captures have too, by the same rules.
"""

from typing import Literal, TypedDict

Way = Literal["", "columns", "unit", "minus", "unwrap", "parts", "drive", "command"]
"""What advice comes to where there are buttons; empty: the same, `command`: nothing that a page could do.

`columns` of a file are to be named anew, or the `unit` of one; one is to be taken with a `minus`, or through
`unwrap`; a log is to be opened in `parts`; a limit is the `drive`'s and not the sensor's.
"""


Along = Literal["position", "velocity", "acceleration", "load", "history", "time", "frequency"]
"""What torques and residuals are drawn over; every sample has a value of it, but of frequency."""


class Quantity(TypedDict):
    """A number with its unit, and as text has it."""

    value: float
    unit: str
    text: str


class Stretch(TypedDict):
    """A stretch of an axis, where the knob moves forward (1), backward (-1) or both (0); `words` for it.

    `ends` are low and high as they are written: as near to zero as nothing beside the other is zero.
    """

    axis: Along
    low: float
    high: float
    ends: tuple[float, float]
    unit: str
    direction: int
    words: str


class OfAxis(TypedDict):
    """The axis that something lies along."""

    along: str


class OfEffect(TypedDict):
    """An effect, by its id."""

    effect: str


class OfParam(TypedDict):
    """A parameter, by its name."""

    param: str


class OfColumn(TypedDict):
    """A column of a capture, by its name."""

    column: str


class Topic(TypedDict):
    """Words with more to know behind them."""

    words: str
    topic: Literal["error", "findings"]


class Advice(TypedDict):
    """What to do, in words of the command line, and the `way` of it."""

    advice: str
    way: Way


class Letters(TypedDict):
    """Parameters of a law that mean the same, and what that is."""

    names: list[str]
    meaning: str
    unit: str


Part = str | Quantity | Stretch | OfAxis | OfEffect | OfParam | OfColumn | Topic | Advice
"""A part of a sentence."""
