"""The catalogue of physical effects."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, NamedTuple

from .. import _core
from ..base import showing
from ..base.tables import TextTable, text_table
from ..errors import InputError
from .plugins import load_plugins

if TYPE_CHECKING:
    from ..base.showing import Figure


class ParameterInfo(NamedTuple):
    """A parameter as the catalogue has it; bounds and neutral value in SI."""

    name: str
    unit: str
    lower: float
    upper: float
    neutral: float
    plausible: tuple[float, float]
    meaning: str


@dataclass(frozen=True, repr=False)
class Effect(showing.Tabled):
    """An effect: where in the chain it acts, its law, its source, where it shows, and what looks like it."""

    id: str
    place: str
    law: str
    source: str
    shows: str
    params: tuple[ParameterInfo, ...]
    confused: tuple[str, ...]
    needs: str | None
    describes: bool

    _HEAD = ("parameter", "unit", "bounds", "neutral", "meaning")

    def _rows(self) -> list[tuple[str, ...]]:
        return [
            (f"{self.id}.{p.name}", p.unit, f"{p.lower:g} to {p.upper:g}", f"{p.neutral:g}", p.meaning)
            for p in self.params
        ]

    def parameter(self, name: str) -> ParameterInfo:
        """Return the parameter of this name, which is without the effect's own."""
        return next(row for row in self.params if row.name == name)

    def plot(self) -> Figure:
        """Its signature: the torque that it adds to a small knob, over time and where it shows."""
        return showing.plot(self)

    def document(self) -> dict[str, Any]:
        """Return what the pages tell of it."""
        return {
            "effect": self.id,
            "place": self.place,
            "law": self.law,
            "source": self.source,
            "shows": self.shows,
            "confused": list(self.confused),
        }

    def __repr__(self) -> str:
        head = f"{self.id} ({self.place})\n  law     {self.law}\n"
        head += f"  shows   {self.shows}\n  source  {self.source}\n"
        if self.confused:
            head += f"  easily confused with {', '.join(self.confused)}\n"
        return head + text_table(self._HEAD, self._rows())

    def tables(self) -> tuple[TextTable, ...]:
        """What it says of itself, as text."""
        caption = f"{self.id}: {self.law}. Shows {self.shows}. {self.source}"
        return (TextTable(caption, self._HEAD, self._rows()),)


def effects(axis: str = "rotary") -> dict[str, Effect]:
    """Return the catalogue by id, units for a rotary or a linear axis; with effects of one's own."""
    load_plugins()
    rows = _core.catalogue(axis)
    return {
        row["id"]: Effect(
            row["id"],
            row["place"],
            row["law"],
            row["source"],
            row["shows"],
            tuple(ParameterInfo(**param) for param in row["params"]),
            tuple(row["confused"]),
            row["needs"],
            row["describes"],
        )
        for row in rows
    }


def descriptions(axis: str) -> set[str]:
    """Return the effects that only describe a torque: they name no cause, so no search names them."""
    return {name for name, one in effects(axis).items() if one.describes}


def effect(name: str, axis: str = "rotary") -> Effect:
    """Return one effect by id, units for a rotary or a linear axis.

    Raises InputError for an unknown id, with those that exist.
    """
    catalogue = effects(axis)
    if name not in catalogue:
        raise InputError(f"effect '{name}' is not in the catalogue; it has {', '.join(catalogue)}")
    return catalogue[name]
