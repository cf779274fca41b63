"""Which effect could be missing: every absent one fitted, ranked, with its evidence and its confusions."""

from __future__ import annotations

import math
from contextlib import suppress
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, Any

from .effects import effect as catalogued
from .effects import effects
from .errors import InputError
from .refit import add, describe, percent
from .tables import html_table, text_table

if TYPE_CHECKING:
    from collections.abc import Collection, Mapping

    from matplotlib.figure import Figure

    from .compare import Comparison
    from .fit import Estimate, Fit
    from .refit import Moved

CHANCE = 0.05
"""A p-value above it is no more than chance."""


@dataclass(frozen=True, eq=False)
class Candidate:
    """An effect that could be missing; immutable.

    `fit` is the whole model fitted anew with it, `p_value` how often chance alone would do as well in the
    whole catalogue, `equivalent` the effects that this capture cannot tell it from, `unphysical` what is
    odd about its values, a sentence each.
    """

    effect: str
    fit: Fit
    p_value: float
    equivalent: tuple[str, ...] = ()
    unphysical: tuple[str, ...] = ()
    note: str = ""

    @property
    def place(self) -> str:
        """Where in the chain it acts: coupling, load or sensor."""
        return catalogued(self.effect, self.fit.model.axis).place

    @property
    def error_fall(self) -> float:
        """The part of the RMS error that goes with it."""
        return self.fit.error_fall

    @property
    def rmse(self) -> float:
        """RMS error with it, N m."""
        return self.fit.rmse

    @property
    def rmse_heldout(self) -> float:
        """The same on blocks that the fit did not see, N m."""
        return self.fit.rmse_heldout

    @property
    def moved(self) -> Mapping[str, Moved]:
        """How far each parameter of the model went when it came in."""
        return self.fit.moved

    @property
    def parameters(self) -> Mapping[str, Estimate]:
        """Its own parameters, as fitted."""
        mine = f"{self.effect}."
        return {name: e for name, e in self.fit.params.items() if name.startswith(mine)}

    @property
    def beyond_chance(self) -> bool:
        """Whether chance would hardly do as well."""
        return self.p_value <= CHANCE

    @property
    def remarks(self) -> str:
        """What else there is to say about it, in one line."""
        same = f"cannot be told from {', '.join(self.equivalent)}" if self.equivalent else ""
        return "; ".join(part for part in (same, *self.unphysical, self.note) if part)

    def document(self) -> dict[str, Any]:
        """Return it as the diagnosis's document has it."""
        params = self.fit.document()["params"]
        return {
            "effect": self.effect,
            "place": self.place,
            "beyond_chance": self.beyond_chance,
            "p_value": self.p_value,
            "error_fall": self.error_fall,
            "rmse": self.rmse,
            "rmse_heldout": self.rmse_heldout,
            "params": {name: params[name] for name in self.parameters},
            "moved": describe(self.moved),
            "equivalent": list(self.equivalent),
            "unphysical": list(self.unphysical),
            "note": self.note,
        }


@dataclass(frozen=True, eq=False, repr=False)
class Diagnosis:
    """The effects that could be missing from a fit, best first; those beyond chance before the others."""

    fit: Fit
    candidates: tuple[Candidate, ...]

    def __getitem__(self, effect: str) -> Candidate:
        """The candidate of an effect."""
        return {candidate.effect: candidate for candidate in self.candidates}[effect]

    @property
    def beyond_chance(self) -> tuple[Candidate, ...]:
        """Those that chance does not explain."""
        return tuple(candidate for candidate in self.candidates if candidate.beyond_chance)

    @property
    def best(self) -> Candidate | None:
        """The first of those; None where nothing is beyond chance."""
        return next(iter(self.beyond_chance), None)

    @cached_property
    def comparison(self) -> Comparison:
        """Where the fit fails."""
        return self.fit.compare()

    @cached_property
    def remaining(self) -> Comparison:
        """Where it would still fail with the best candidate."""
        return self.comparison if self.best is None else self.best.fit.compare()

    @property
    def summary(self) -> str:
        """What could be missing, and what would remain."""
        where = self.comparison.summary
        if self.best is None:
            return f"{where} No effect of the catalogue lowers this error beyond chance."
        either = " or ".join([self.best.effect, *self.best.equivalent])
        return f"{where} Missing first of all: {either} (error {percent(-self.best.error_fall)})."

    def plot(self) -> Figure:
        """Error fall of every candidate; those beyond chance solid, those that look alike linked."""
        from . import plot

        return plot.diagnosis(self)

    def document(self) -> dict[str, Any]:
        """Return the JSON document of `knobcam diagnose --json`."""
        fit = self.fit
        return {
            "schema": "knobcam.diagnose/1",
            "captures": fit.document()["captures"],
            "effects": list(fit.model.effects),
            "rmse": fit.rmse,
            "rmse_heldout": fit.rmse_heldout,
            "noise_floor": fit.noise_floor,
            "summary": self.summary,
            "candidates": [candidate.document() for candidate in self.candidates],
            "remains": {
                "complete": self.remaining.complete,
                "axis": self.remaining.worst.axis if self.remaining.worst else None,
                "share": self.remaining.worst.share if self.remaining.worst else None,
                "summary": self.remaining.summary,
            },
        }

    HEAD = ("effect", "acts on", "error", "on unseen blocks", "p-value", "remarks")

    def rows(self, candidates: Collection[Candidate]) -> list[tuple[str, ...]]:
        """Candidates as rows of text, under the words of `HEAD`."""
        unseen = self.fit.rmse_heldout
        return [
            (
                one.effect,
                one.place,
                percent(-one.error_fall),
                percent(one.rmse_heldout / unseen - 1.0 if unseen > 0.0 else math.nan),
                p_in_words(one.p_value),
                one.remarks,
            )
            for one in candidates
        ]

    def __repr__(self) -> str:
        found = self.beyond_chance
        rest = [one for one in self.candidates if not one.beyond_chance]
        lines = [self.summary]
        # One table, so that both halves have the same columns.
        head, *rows = text_table(self.HEAD, self.rows([*found, *rest])).splitlines()
        lines += ["Beyond chance:", head, *rows[: len(found)]] if found else ["Beyond chance: nothing"]
        lines += ["No more than chance:", *([] if found else [head]), *rows[len(found) :]] if rest else []
        lines += [f"With {self.best.effect}: {self.remaining.summary}"] if self.best else []
        return "\n".join(lines)

    def _repr_html_(self) -> str:
        found = self.beyond_chance
        rest = [one for one in self.candidates if not one.beyond_chance]
        return html_table(f"{self.summary} Beyond chance:", self.HEAD, self.rows(found)) + html_table(
            "No more than chance:", self.HEAD, self.rows(rest)
        )


def diagnose(fit: Fit, *, only: Collection[str] | None = None, without: Collection[str] = ()) -> Diagnosis:
    """Return which effects of the catalogue could be missing from a fit, ranked with evidence.

    `only` weighs these effects alone, `without` takes some out of the catalogue. Raises InputError for an
    effect that the catalogue does not have.
    """
    out = set(check_effects("without", without, fit.model.axis))
    if only is not None:
        out |= set(effects(fit.model.axis)) - set(check_effects("only", only, fit.model.axis))
    candidates = _candidates(fit, out)
    return Diagnosis(fit, tuple(sorted(candidates, key=lambda one: not one.beyond_chance)))


def check_effects(name: str, ids: Collection[str], axis: str) -> tuple[str, ...]:
    """Return the ids if they are in the catalogue; raise InputError that names the argument if not."""
    if isinstance(ids, str):
        raise InputError(f"{name}={ids!r} is one text; give a list of effects")
    for one in ids:
        try:
            catalogued(one, axis)
        except InputError as error:
            raise InputError(f"{name}: {error}") from None
    return tuple(ids)


def p_in_words(p_value: float) -> str:
    """Return a p-value for people."""
    return "< 0.001" if p_value < 0.001 else f"{p_value:.3f}"


def _candidates(fit: Fit, without: Collection[str]) -> list[Candidate]:
    """Return every absent effect fitted, the lowest error on unseen blocks first."""
    from scipy.special import chdtrc  # type: ignore[import-untyped]

    slow = {"backlash", "compliance", "wavelet", "regional", "karnopp"}
    absent = [one for one in effects(fit.model.axis) if one not in {*fit.model.effects, *without, *slow}]
    refits = []
    for one in absent:
        with suppress(InputError):  # it changes an effect that the model does not have
            refits.append((one, add(fit, one)))
    refits.sort(key=lambda pair: pair[1].rmse_heldout)
    # Of samples at 5 kHz behind a filter at 500 Hz about one in thirty is independent.
    independent = sum(one.core.used for one in fit.prepared) / 30.0
    found = []
    for effect, refit in refits:
        gain = 2.0 * independent * math.log(max(fit.rmse_heldout / refit.rmse_heldout, 1.0))
        count = len(refit.core.free) - len(fit.core.free)
        p_value = min(1.0, len(absent) * float(chdtrc(max(count, 1), gain))) if count > 0 else 1.0
        alike = [
            other
            for other, same in refits
            if other != effect
            and p_value <= CHANCE
            and abs(same.rmse_heldout / refit.rmse_heldout - 1.0) < 0.01
        ]
        odd = [sentence for sentence in refit.warnings if sentence not in fit.warnings]
        found.append(Candidate(effect, refit, p_value, tuple(alike), tuple(odd)))
    return found
