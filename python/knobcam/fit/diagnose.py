"""Which effect could be missing: every absent one fitted, ranked, with its evidence and its confusions."""

from __future__ import annotations

import math
import warnings
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import TYPE_CHECKING, Any

from .. import _core
from ..base import pages, showing
from ..base.door import checked
from ..base.said import OfEffect, Said, joined, said
from ..base.tables import TextTable, text_table
from ..errors import InputError
from ..model.effects import clipping, descriptions, effects
from ..model.effects import effect as catalogued
from .absent import absent
from .described import documented
from .doubts import unsettled
from .plausible import implausible
from .price import own, spared
from .refit import begun, cores, describe, gain, percent, with_clipped
from .rule import RULE
from .verdict import CHOSEN, COULD_BE, judged, off_by_law

if TYPE_CHECKING:
    from collections.abc import Callable, Collection, Mapping

    from ..base.showing import Figure, Look
    from ..model.effects import Effect
    from .compare import Comparison
    from .estimate import Estimate
    from .fitting import Fit
    from .refit import Moved

LEAST_P = 0.001
"""The least p-value that 999 draws can tell: what chance never did in all of them."""
COULD_BE_IN_WORDS = "Could be missing"
COULD_NOT_IN_WORDS = "Too little, no more than chance, or not by their values"


@dataclass(frozen=True, eq=False)
class Candidate:
    """An effect that could be missing; immutable.

    `fit` is the whole model fitted anew with it, `p_value` how often chance does as well in the catalogue,
    `equivalent` what this capture cannot tell it from, `implausible` what is so about its values; `word` is
    what the rule says of it (`pages.Word`), `said` the same in words.
    """

    effect: str
    fit: Fit
    p_value: float
    gain: float
    count: int
    equivalent: tuple[str, ...] = ()
    implausible: tuple[Said, ...] = ()
    note: str = ""
    word: pages.Word = "untold"
    said: Said = field(default_factory=Said)

    @property
    def unphysical(self) -> tuple[Said, ...]:
        """The older name of `implausible`."""
        warnings.warn("Candidate.unphysical is now called implausible", DeprecationWarning, stacklevel=2)
        return self.implausible

    @property
    def score(self) -> float:
        """Its gain (fall of the sum of squares in variances of the raw noise) less a price per parameter."""
        return self.gain - RULE.price * self.count

    @property
    def charged(self) -> float:
        """How many parameters it is charged for where others do as well."""
        return self.count - spared(self.row, self.parameters)

    @property
    def row(self) -> Effect:
        """What the catalogue says of it."""
        return catalogued(self.effect, self.fit.model.coordinate)

    @property
    def place(self) -> str:
        """Where in the chain it acts: coupling, load or sensor."""
        return self.row.place

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
        return own(self.fit, self.effect)

    @property
    def beyond_chance(self) -> bool:
        """Whether chance would hardly do as well, and its parameters are worth their price."""
        return self.word not in ("unpaid", "chance", "untold")

    @property
    def could_be(self) -> bool:
        """Whether it could be what is missing."""
        return self.word in COULD_BE

    @property
    def remarks(self) -> Said:
        """What else there is to say about it, in one line."""
        names = joined(", ", map(OfEffect, self.equivalent))
        same = said("cannot be told from {names}", names=names) if names else None
        return joined("; ", (self.said, same, *self.implausible, self.note))

    @property
    def unsettled(self) -> str:
        """Which of its values the captures do not determine, where that is most of them; else nothing."""
        return unsettled(self.row, self.parameters)

    def evidence(self) -> pages.Candidate:
        """Return what speaks for it and against it, as the pages list it."""
        return {
            **self.row.document(),
            "word": self.word,
            "said": self.said.document(),
            "could_be": self.could_be,
            "beyond_chance": self.beyond_chance,
            "p_value": self.p_value,
            "error_fall": self.error_fall,
            "rmse_heldout": self.rmse_heldout,
            "moved": describe(self.moved),
            "equivalent": list(self.equivalent),
            "implausible": [one.document() for one in self.implausible],
            "unsettled": self.unsettled,
            "note": self.note,
        }

    def document(self) -> dict[str, Any]:
        """Return it as the diagnosis's document has it."""
        params = documented(self.fit.params)
        own = {name: params[name] for name in self.parameters}
        why = list(self.implausible)
        older = {"unphysical": why}  # its name until now, for one version
        words = {"said": self.said, "implausible": why}
        return {**self.evidence(), **older, **words, "rmse": self.rmse, "params": own}


@dataclass(frozen=True, eq=False, repr=False)
class Diagnosis(showing.Tabled):
    """The effects that could be missing from a fit, those for which most speaks first.

    `left_out` are effects that were not weighed, and why; not `whole`: some of them explain too little.
    """

    fit: Fit
    candidates: tuple[Candidate, ...]
    left_out: Mapping[str, str] = field(default_factory=dict)
    whole: bool = True

    def __getitem__(self, effect: str) -> Candidate:
        """The candidate of an effect."""
        return {candidate.effect: candidate for candidate in self.candidates}[effect]

    @property
    def beyond_chance(self) -> tuple[Candidate, ...]:
        """Those that chance does not explain; most may explain too little to be missing, see `could_be`."""
        return tuple(candidate for candidate in self.candidates if candidate.beyond_chance)

    @property
    def could_be(self) -> tuple[Candidate, ...]:
        """Those that could be missing: the best, what cannot be told from it, and what explains less."""
        return tuple(candidate for candidate in self.candidates if candidate.could_be)

    @property
    def best(self) -> Candidate | None:
        """What `learn` would add; None where nothing that could be added is missing."""
        return next((one for one in self.candidates if one.word in CHOSEN), None)

    @property
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
        what = self._nothing
        if self.best is not None:
            either = " or ".join([self.best.effect, *self.best.equivalent])
            head = "Missing first of all" if self.best.word == "missing" else "A part of what is missing"
            what = f"{head}: {either} (error {percent(-self.best.error_fall)})."
        beyond = self.fit.beyond
        return joined(" ", (self.comparison.summary, what, beyond and beyond.sentence))

    @property
    def _nothing(self) -> str:
        """Why nothing is named, in a sentence."""
        if any(one.word == "untold" for one in self.candidates):
            return "Without the noise, what is missing cannot be told from chance."
        if not self.beyond_chance:
            return "No effect of the catalogue lowers this error beyond chance."
        few = [one.effect for one in self.beyond_chance if one.word == "too_little"]
        if not few:
            return "No effect of the catalogue that could be missing lowers this error beyond chance."
        takes = "effect takes" if len(few) == 1 else "effects take"
        return f"No effect of the catalogue is the cause: {len(few)} {takes} off some of it, but too little."

    def plot(self) -> Figure:
        """Error fall of every candidate; those that could be missing solid, those that look alike linked."""
        return showing.plot(self)

    def look(self) -> Look:
        """Return linked plots to brush in, the candidates beside them."""
        return showing.look(self)

    def document(self) -> dict[str, Any]:
        """Return the JSON document of `knobcam diagnose --json`."""
        fit = self.fit
        fitted = fit.document()
        return {
            "schema": "knobcam.diagnose/1",
            "captures": fitted["captures"],
            "findings": fitted["findings"],
            "effects": list(fit.model.effects),
            "rmse": fit.rmse,
            "rmse_heldout": fit.rmse_heldout,
            "noise_floor": fit.noise_floor,
            "summary": self.summary,
            "candidates": [candidate.document() for candidate in self.candidates],
            "left_out": dict(self.left_out),
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
                Said(OfEffect(one.effect)),
                one.place,
                percent(-one.error_fall),
                percent(one.rmse_heldout / unseen - 1.0 if unseen > 0.0 else math.nan),
                p_in_words(one.p_value),
                one.remarks,
            )
            for one in candidates
        ]

    def __repr__(self) -> str:
        found = self.could_be
        rest = [one for one in self.candidates if not one.could_be]
        lines = [self.summary]
        # One table, so that both halves have the same columns.
        head, *rows = text_table(self.HEAD, self.rows([*found, *rest])).splitlines()
        could_be = f"{COULD_BE_IN_WORDS}:"
        lines += [could_be, head, *rows[: len(found)]] if found else [f"{could_be} nothing"]
        lines += [f"{COULD_NOT_IN_WORDS}:", *([] if found else [head]), *rows[len(found) :]] if rest else []
        lines += [f"Left out: {one}: {why}" for one, why in self.left_out.items()]
        lines += [f"With {self.best.effect}: {self.remaining.summary}"] if self.best else []
        return "\n".join(lines)

    def tables(self) -> tuple[TextTable, ...]:
        """What it says of itself, as text."""
        rest = [one for one in self.candidates if not one.could_be]
        could_be = f"{self.summary} {COULD_BE_IN_WORDS}:"
        return (
            TextTable(could_be, self.HEAD, self.rows(self.could_be)),
            TextTable(f"{COULD_NOT_IN_WORDS}:", self.HEAD, self.rows(rest)),
        )


@checked
def diagnose(
    fit: Fit,
    *,
    only: Collection[str] | None = None,
    without: Collection[str] = (),
    progress: Callable[[float], object] | None = None,
) -> Diagnosis:
    """Return which effects of the catalogue could be missing from a fit, ranked with evidence.

    `only` weighs these effects alone, `without` takes some out of the catalogue; what describes a shape
    without naming a cause is weighed only where `only` has it. `progress` is told the share of the work that
    is done, 0 to 1, from any thread; what it raises ends the work. Raises InputError for an
    effect that the catalogue does not have.
    """
    coordinate = fit.model.coordinate
    out = set(check_effects("without", without, coordinate))
    if only is None:
        out |= set(descriptions(coordinate))
    else:
        out |= set(effects(coordinate)) - set(check_effects("only", only, coordinate))
    return _weighed(fit, out, progress)


def worth_adding(
    fit: Fit, without: Collection[str], progress: Callable[[float], object] | None = None
) -> Diagnosis:
    """Return the same for who looks for what to add: where none could be named, few are fitted."""
    out = {*without, *descriptions(fit.model.coordinate)}
    if off_by_law(fit) >= fit.rmse**2 - (fit.noise_floor / RULE.at_floor) ** 2:
        # However little the noise leaves, an effect would take off less than names one.
        could, left_out = absent(fit, out)
        left_out |= dict.fromkeys(could, "less is left than the laws that came in may be off by")
        return Diagnosis(fit, (), left_out, whole=False)
    # Of several captures an effect may show in one alone.
    if len(fit.prepared) == 1 and fit.compare().complete:
        few = _weighed(fit, out, progress, worth=True)
        if few.best is None:
            return few
        if fit.model.joint is not None:
            # Beside a joint few are followed either way.
            return replace(few, whole=True)
    return _weighed(fit, out, progress)


def _begun(candidate: Candidate) -> Candidate:
    """Return a candidate whose knob begins as the first torques say; beside a joint as it was."""
    before, fit = candidate.fit.before, candidate.fit
    if before is None or before.model.joint is not None or (better := begun(fit)) is fit:
        return candidate
    return replace(candidate, fit=better, gain=gain(before, better, before))


def check_effects(name: str, ids: Collection[str], coordinate: str) -> tuple[str, ...]:
    """Return the ids if they are in the catalogue; raise InputError that names the argument if not."""
    if isinstance(ids, str):
        raise InputError(f"{name}={ids!r} is one text; give a list of effects")
    for one in ids:
        try:
            catalogued(one, coordinate)
        except InputError as error:
            raise InputError(f"{name}: {error}") from None
    return tuple(ids)


def p_in_words(p_value: float, least: float = LEAST_P) -> str:
    """Return a p-value for people: a bound where it is the least that its draws can tell."""
    return f"<= {least:g}" if p_value <= least else f"{p_value:.3f}"


def _weighed(
    fit: Fit, out: set[str], progress: Callable[[float], object] | None, *, worth: bool = False
) -> Diagnosis:
    """Return what is said of every absent effect but those that are `out`."""
    fit = with_clipped(fit) if clipping(fit.model.coordinate) - out else fit
    could, left_out = absent(fit, out)
    weighed = _core.diagnose(cores(fit), fit.model.core, could, progress, worth)
    found = [
        Candidate(one, replace(fit, core=core, before=fit), p_value, gain, count, note=note)
        for one, core, gain, count, p_value, note in weighed
        if core is not None
    ]
    left_out |= {one: note for one, core, *_, note in weighed if core is None}
    found = [replace(one, implausible=implausible(one, fit)) for one in map(_begun, found)]
    return Diagnosis(fit, judged(fit.compare(), found), left_out, not worth)
