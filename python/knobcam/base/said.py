"""Sentences as data: text to who prints them, and to a page words and what it writes in its own way."""

from __future__ import annotations

from string import Formatter
from typing import TYPE_CHECKING, Any, NamedTuple, cast

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping

    from . import pages_said as pages

_DIRECTIONS = {1: " forward", -1: " backward", 0: ""}
_NOTHING = 1e-4  # of the width of a stretch: an end as near to zero is zero


class Quantity(NamedTuple):
    """A number with its unit, and as text has it."""

    value: float
    unit: str
    text: str

    def __str__(self) -> str:
        return f"{self.text} {self.unit}"


class Stretch(NamedTuple):
    """A stretch of an axis, moved through forward (1), backward (-1) or both (0); `words` for it, if any."""

    axis: str
    low: float
    high: float
    unit: str
    direction: int
    words: str = ""

    @property
    def ends(self) -> tuple[float, float]:
        """Where it begins and ends as that is written."""
        near = _NOTHING * (self.high - self.low)
        return (0.0 if abs(self.low) <= near else self.low, 0.0 if abs(self.high) <= near else self.high)

    def __str__(self) -> str:
        low, high = self.ends
        return self.words or f"{low:.4g} to {high:.4g} {self.unit}{_DIRECTIONS[self.direction]}"


class OfAxis(NamedTuple):
    """The axis that something lies along."""

    along: str

    def __str__(self) -> str:
        return self.along


class OfEffect(NamedTuple):
    """An effect, by its id."""

    effect: str

    def __str__(self) -> str:
        return self.effect


class OfParam(NamedTuple):
    """A parameter, by its name."""

    param: str

    def __str__(self) -> str:
        return self.param


class OfColumn(NamedTuple):
    """A column of a capture, by its name."""

    column: str

    def __str__(self) -> str:
        return self.column


class Topic(NamedTuple):
    """Words with more to know behind them: the `error` of a model, the `findings` of a capture."""

    words: str
    topic: str

    def __str__(self) -> str:
        return self.words


class Advice(NamedTuple):
    """What to do, in words of the command line and of Python, and the way of it that a page has."""

    advice: str
    way: pages.Way = ""

    def __str__(self) -> str:
        return self.advice

    def document(self) -> pages.Advice:
        """Return it as pages have it."""
        return {"advice": self.advice, "way": self.way}


Piece = str | Quantity | Stretch | OfAxis | OfEffect | OfParam | OfColumn | Topic | Advice
_KINDS = (Quantity, Stretch, OfAxis, OfEffect, OfParam, OfColumn, Topic, Advice)
_COLUMNS = {name: OfColumn(name) for name in ("t", "theta", "omega", "alpha", "tau")}


class Said(str):
    """A sentence: text wherever text is asked for, and in `parts` what it is made of."""

    parts: tuple[Piece, ...]

    def __new__(cls, *parts: Piece) -> Said:
        """Return the sentence of these parts; one of them that is a sentence brings its own."""
        flat: list[Piece] = []
        for piece in (one for part in parts for one in (part.parts if isinstance(part, Said) else (part,))):
            words = flat[-1] if flat else None
            if isinstance(piece, str) and isinstance(words, str):
                flat[-1] = words + piece
            elif piece != "":
                flat.append(piece)
        self = super().__new__(cls, "".join(map(str, flat)))
        self.parts = tuple(flat)
        return self

    def __reduce__(self) -> tuple[type[Said], tuple[Piece, ...]]:
        return Said, self.parts

    def document(self) -> list[pages.Part]:
        """Return its parts as JSON has them."""
        return [one if isinstance(one, str) else _document(one) for one in self.parts]

    @classmethod
    def of(cls, document: Iterable[str | Mapping[str, Any]]) -> Said:
        """Return the sentence whose parts JSON had; ValueError for what is none."""
        return cls(*(one if isinstance(one, str) else _piece(one) for one in document))


def _document(piece: NamedTuple) -> pages.Part:
    ends = {"ends": [*piece.ends]} if isinstance(piece, Stretch) else {}
    return cast("pages.Part", piece._asdict() | ends)


def _piece(document: Mapping[str, Any]) -> Piece:
    told = {name: one for name, one in document.items() if name != "ends"}  # which follows from the others
    for kind in _KINDS:
        if {*kind._fields} - {*kind._field_defaults} <= told.keys() <= {*kind._fields}:
            return kind(**told)
    raise ValueError(f"{dict(told)!r} is no part of a sentence")


def said(template: str, /, **parts: object) -> Said:
    """Return a sentence: where `{name}` stands comes that part, or that column of a capture."""
    known = _COLUMNS | parts
    found: list[Piece] = []
    for words, name, spec, _ in Formatter().parse(template):
        found.append(words)
        if name is not None:
            part = known[name]
            found.append(part if isinstance(part, Piece) else format(part, spec or ""))
    return Said(*found)


def number(value: float, unit: str, spec: str = ".4g") -> Quantity:
    """Return a number with its unit, written by `spec` where it is text."""
    return Quantity(value, unit, format(value, spec))


def joined(between: str, several: Iterable[Piece | None]) -> Said:
    """Return those of several that say something, in one sentence."""
    found: list[Piece] = []
    for one in several:
        if one:
            found += [between, one] if found else [one]
    return Said(*found)
