"""The catalogue of physical effects."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache, lru_cache
from typing import TYPE_CHECKING, Any, Literal, NamedTuple

from .. import _core
from ..base import showing
from ..base.door import checked
from ..base.meant import meant
from ..base.renamed import renamed
from ..base.tables import TextTable, text_table
from ..errors import InputError
from .plugins import load_plugins
from .sliding import sliding

if TYPE_CHECKING:
    from collections.abc import Iterable

    from ..base import pages, pages_said
    from ..base.showing import Figure


class ParameterInfo(NamedTuple):
    """A parameter as the catalogue has it; bounds and neutral value in SI.

    One with `where_paid` stays at its neutral value until the data pay for another: real ones differ from
    that by so much, a standard deviation. A `phase` is an angle of which zero is a value like any other.
    """

    name: str
    unit: str
    lower: float
    upper: float
    neutral: float
    plausible: tuple[float, float]
    where_paid: float | None
    meaning: str
    phase: bool = False


Over = Literal["position", "velocity", "acceleration", "time", "torque", "reversal", "several"]
"""The one quantity that an effect's torque follows, or `several`."""


class TakenUp(NamedTuple):
    """Parameters of others that do the same while all of them are free, and why."""

    by: tuple[str, ...]
    why: str


@dataclass(frozen=True, repr=False)
class Effect(showing.Tabled):
    """An effect: where in the chain it acts, its law, its source, where it shows, and what looks like it.

    `title` is what it is called in a list, `name` what a person would say is there, `about` one sentence of
    what it is, `causes` and `remedies` what usually brings it about and takes it away, `latex` its law for
    typesetting. `over` is what its torque follows, `section` the machine part that it is drawn
    as, a `map` a torque of position alone, what is `along` of position but for the sign of the motion, `base`
    its part in the base model ("always", "where it shows");
    `unsearched` says why no motion can show that it is missing; one that `clips` predicts what a sensor at
    its limit reads; `taken_up` names what others do as well; `given` says why no voltage of a motor has it.
    """

    id: str
    place: str
    law: str
    source: str
    shows: str
    params: tuple[ParameterInfo, ...]
    confused: tuple[str, ...]
    needs: str | None
    describes: bool
    title: str
    name: str
    about: str
    causes: tuple[str, ...]
    remedies: tuple[str, ...]
    latex: str
    over: Over
    section: str | None
    friction: bool
    map: bool
    along: bool
    base: str | None
    unsearched: str | None
    clips: bool
    taken_up: TakenUp | None
    given: str | None

    _HEAD = ("parameter", "unit", "bounds", "neutral", "meaning")

    def _rows(self) -> list[tuple[str, ...]]:
        return [
            (f"{self.id}.{p.name}", p.unit, f"{p.lower:g} to {p.upper:g}", f"{p.neutral:g}", p.meaning)
            for p in self.params
        ]

    def parameter(self, name: str) -> ParameterInfo:
        """Return the parameter of this name, without the effect's own and without a capture's."""
        return next(row for row in self.params if row.name == name.partition("@")[0])

    def letters(self) -> list[pages_said.Letters]:
        """Return what the letters of its law mean, those together that mean the same."""
        alike: dict[tuple[str, str], list[str]] = {}
        for row in self.params:
            if row.meaning != row.name:  # as of a law of one's own
                alike.setdefault((row.meaning, row.unit), []).append(row.name)
        return [
            {"names": names, "meaning": meaning, "unit": unit} for (meaning, unit), names in alike.items()
        ]

    def plot(self) -> Figure:
        """Its signature: the torque that it adds to a small knob, over time and where it shows."""
        return showing.plot(self)

    def document(self) -> pages.Effect:
        """Return what the pages tell of it."""
        return {
            "effect": self.id,
            "place": self.place,
            "law": self.law,
            "source": self.source,
            "shows": self.shows,
            "confused": list(self.confused),
            "title": self.title,
            "name": self.name,
            "about": self.about,
            "causes": list(self.causes),
            "remedies": list(self.remedies),
            "latex": self.latex,
            "letters": self.letters(),
            "over": self.over,
            "section": self.section,
            "friction": self.friction,
        }

    def __repr__(self) -> str:
        head = f"{self.id} ({self.place}): {self.name}\n  {self.about}\n"
        head += f"  law     {self.law}\n  shows   {self.shows}\n  source  {self.source}\n"
        if self.confused:
            head += f"  easily confused with {', '.join(self.confused)}\n"
        for title, phrases in (("usual causes", self.causes), ("what helps", self.remedies)):
            head += "".join([f"  {title}\n", *(f"    - {one}\n" for one in phrases)]) if phrases else ""
        return head + text_table(self._HEAD, self._rows())

    def tables(self) -> tuple[TextTable, ...]:
        """What it says of itself, as text."""
        caption = f"{self.id}: {self.law}. Shows {self.shows}. {self.source}"
        return (TextTable(caption, self._HEAD, self._rows()),)


@renamed(axis="coordinate")
@checked
def effects(coordinate: str = "rotary") -> dict[str, Effect]:
    """Return the catalogue by id, units for a rotary or a linear axis; with effects of one's own."""
    load_plugins()
    return dict(_effects(coordinate, _core.catalogue_version()))


@lru_cache(maxsize=2)  # one for each kind of axis, as the catalogue stands
def _effects(coordinate: str, _version: int) -> dict[str, Effect]:
    rows = _core.catalogue(coordinate)
    return of_rows(rows if coordinate == "rotary" else map(sliding, rows))


def titles(coordinate: str) -> dict[str, str]:
    """Return what each effect of the catalogue is called in a list, by its id."""
    return {one.id: one.title for one in effects(coordinate).values()}


def of_rows(rows: Iterable[dict[str, Any]]) -> dict[str, Effect]:
    """Return the effects of rows of a catalogue by id."""
    return {
        row["id"]: Effect(
            **{name: tuple(value) if isinstance(value, list) else value for name, value in row.items()}
            | {
                "params": tuple(ParameterInfo(**param) for param in row["params"]),
                "taken_up": row["taken_up"] and TakenUp(tuple(row["taken_up"][0]), row["taken_up"][1]),
            }
        )
        for row in rows
    }


def descriptions(coordinate: str) -> set[str]:
    """Return the effects that only describe a torque: they name no cause, so no search names them."""
    return {name for name, one in effects(coordinate).items() if one.describes}


@cache  # effects of one's own are never part of it
def base_effects(coordinate: str) -> tuple[str, ...]:
    """Return the effects of the base model, but for those that are part of it only where they show."""
    return tuple(name for name, one in effects(coordinate).items() if one.base == "always")


@cache
def base_effects_shown(coordinate: str) -> tuple[str, ...]:
    """Return the effects that are part of the base model where a capture shows them: its detents."""
    return tuple(name for name, one in effects(coordinate).items() if one.base == "where it shows")


def clipping(coordinate: str) -> set[str]:
    """Return the effects beside which readings of a sensor at its limit count."""
    return {name for name, one in effects(coordinate).items() if one.clips}


@checked
def effect(name: str, coordinate: str = "rotary") -> Effect:
    """Return one effect by id, units for a rotary or a linear axis.

    Raises InputError for an unknown id, with those that exist.
    """
    catalogue = effects(coordinate)
    if name not in catalogue:
        near = meant(name, catalogue)
        has = f"{near}; `knobcam effects` lists all" if near else f"it has {', '.join(catalogue)}"
        raise InputError(f"effect '{name}' is not in the catalogue; {has}")
    return catalogue[name]
