"""Where no name explains what is left: laws that would, each fitted like an effect and held out on blocks.

Nothing that is proposed is a cause: the verdict stays, until somebody takes a law under a name.
"""

from __future__ import annotations

import re
from dataclasses import dataclass, replace
from functools import cached_property
from typing import TYPE_CHECKING, Any

from .. import _core
from ..base import showing
from ..base.said import OfEffect, Said, joined, number, said
from ..base.tables import TextTable, text_table
from ..errors import InputError
from ..fit.beyond import incoherent
from ..fit.described import documented
from ..fit.diagnose import Diagnosis, diagnose, p_in_words
from ..fit.doubts import at_floor, below_zero
from ..fit.refit import converged, cores, gain, started
from ..fit.rule import RULE
from ..model.effects import base_effects_shown, descriptions, effects
from ..model.own import forget_effect
from ..model.own_law import free_name, own_law
from .exchanged import with_detents
from .left import Curve, Map, Need, drawn, mapped

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping

    from ..base.showing import Figure
    from ..fit import Estimate, Fit
    from .learning import LearningResult

FITTED = 5
"""Laws that are fitted with the whole model, and so end up in the front."""
_NEEDS = 4  # that are said
NAMED = 2
"""Parameters that a sum of laws has to do without before it takes the place of a name."""


@dataclass(frozen=True, eq=False)
class Proposal:
    """A law that could be what is missing: `fit` is the whole model fitted with it under the name `name`.

    `gain` is what it takes off the sum of squares in variances of the raw noise, `complexity` how long it is.
    Of a curve or surface without a formula `law` is made of splines, `complexity` how many numbers the data
    decide of it, and `unseen` its RMS error on blocks that were left out while it was drawn, N m; None for a
    formula.
    """

    law: str
    name: str
    variables: tuple[str, ...]
    fit: Fit
    gain: float
    complexity: int
    unseen: float | None = None

    @property
    def label(self) -> str:
        """The formula, or of what the curve is one, N m."""
        if self.unseen is None:
            return self.law
        times = self.law.partition("*spline((")[0].removeprefix("a").removeprefix("*")
        over = list(dict.fromkeys(re.findall(r"spline\(\((\S+) - from", self.law)))
        what = "a curve" if len(over) == 1 else "a surface"
        return f"{what} over {' and '.join(over)}" + (f", times {times}" if times else "")

    @property
    def params(self) -> Mapping[str, Estimate]:
        """Its parameters, by their names in the formula."""
        own = f"{self.name}."
        return {name.removeprefix(own): e for name, e in self.fit.params.items() if name.startswith(own)}

    @property
    def rmse(self) -> float:
        """RMS error with it, N m."""
        return self.fit.rmse

    @property
    def rmse_heldout(self) -> float:
        """The same on blocks that the fit did not see, N m."""
        return self.fit.rmse_heldout if self.unseen is None else max(self.unseen, self.fit.rmse)

    @property
    def score(self) -> float:
        """Its gain less the price of its parameters."""
        free = sum(not e.held for e in self.params.values())
        return self.gain - RULE.price * (free if self.unseen is None else self.complexity)

    @property
    def start(self) -> dict[str, float]:
        """Values to start a fit from."""
        return {name: float(f"{e.value:.5g}") for name, e in self.params.items()}

    @property
    def guess(self) -> str:
        """The same as it is typed."""
        return " ".join(f"{name}={value:g}" for name, value in self.start.items())

    @property
    def option(self) -> str:
        """What `knobcam add` is told to add it."""
        return f"--law '{self.law}' --guess {self.guess}"

    def document(self) -> dict[str, Any]:
        """Return it as `proposals` of `knobcam learn --json` has it."""
        return {
            "law": self.law if self.unseen is None else None,
            "written": self.law,
            "variables": list(self.variables),
            "params": documented(self.params),
            "rmse": self.rmse,
            "rmse_heldout": self.rmse_heldout,
            "complexity": self.complexity,
        }


@dataclass(frozen=True, eq=False, repr=False)
class Proposals(showing.Tabled):
    """Laws for what a story leaves unexplained, the one for which most speaks first; immutable.

    `beside` is the fit that they were looked for beside, `why` says why there are none, `p_value` how often
    chance gives as much as the first. `needs` are the variables that what is left is of, by curves and
    surfaces without a formula, the best on unseen blocks first, and `map` what is left over the best pair.
    """

    beside: Fit
    laws: tuple[Proposal, ...] = ()
    p_value: float = 1.0
    curve: Curve | None = None
    why: str = ""
    needs: tuple[Need, ...] = ()
    map: Map | None = None

    def __len__(self) -> int:
        return len(self.laws)

    @property
    def headline(self) -> Said:
        """What is proposed, in one sentence."""
        if not self.laws:
            return said("No law is proposed: {why}.", why=self.why)
        first, unit = self.laws[0], self.beside.torque_unit
        return said(
            "Beside {beside}, {label} would leave {left} of {before} (noise alone {noise}); chance gives as "
            "much with p {chance}. It is proposed, not found.",
            beside=joined(", ", map(OfEffect, self.beside.model.effects)),
            label=first.label,
            left=number(first.rmse, unit),
            before=number(self.beside.rmse, unit),
            noise=number(self.beside.noise_floor, unit),
            chance=p_in_words(self.p_value),
        )

    @cached_property
    def front(self) -> tuple[Proposal, ...]:
        """Those that no shorter one is as good as, the shortest first."""
        kept: list[Proposal] = []
        for one in sorted(self.laws, key=lambda one: (one.complexity, one.rmse)):
            if all(one.rmse < other.rmse for other in kept):
                kept.append(one)
        return tuple(kept)

    @property
    def needed(self) -> str:
        """Which variables what is left needs, in one sentence; empty where that is not known."""
        shown = [one for one in self.needs if one.p_value <= RULE.chance][:_NEEDS]
        told = [f"{' and '.join(one.variables)} ({100.0 * one.heldout:.0f} %)" for one in shown]
        if not told:
            return ""
        return f"Without a formula, on unseen blocks, of the error remain over {', '.join(told)}."

    @property
    def head(self) -> tuple[str, ...]:
        """What the columns of `rows` are."""
        unit = self.beside.torque_unit
        return (
            "",
            "law",
            "of",
            "length",
            f"RMS error ({unit})",
            f"on unseen blocks ({unit})",
            "on the front",
        )

    def rows(self) -> list[tuple[str, ...]]:
        """The laws as rows of text, under the words of `head`."""
        return [
            (
                str(number),
                one.label,
                ", ".join(one.variables),
                str(one.complexity),
                f"{one.rmse:.4g}",
                f"{one.rmse_heldout:.4g}",
                "yes" if one in self.front else "",
            )
            for number, one in enumerate(self.laws, 1)
        ]

    def _parameters(self) -> list[tuple[str, str, str, str]]:
        first = self.laws[0]
        return [(name, f"{e.value:.6g}", e.interval, e.unit) for name, e in first.params.items()]

    def __repr__(self) -> str:
        if not self.laws:
            return self.headline
        parameters = text_table(("of the first", "value", "95 % interval", "unit"), self._parameters())
        keep = f"To keep one: --accept N, or knobcam add CAPTURE MODEL -o BETTER {self.laws[0].option}"
        said = [self.headline, text_table(self.head, self.rows()), parameters, self.needed, keep]
        return "\n".join(one for one in said if one)

    def tables(self) -> tuple[TextTable, ...]:
        """What it says of itself, as text."""
        return (TextTable(self.headline, self.head, self.rows()),)

    def plot(self) -> Figure:
        """The residual as a curve over what it needs, the formulas on it, and error over length."""
        return showing.plot(self)


def propose(story: LearningResult, progress: Callable[[float], object] | None = None) -> Proposals:
    """Return laws for what a story leaves unexplained, none where a name or chance explains as much.

    `progress` is told the share of the work that is done; what it raises ends the work.
    """
    last = story.fit
    if why := _needless(story):
        return Proposals(last, why=why)
    several = {fit.model.effects: fit for fit in _bases(story)}
    found = [_found(story, fit, progress) for fit in several.values()]
    # Of what came in without explaining it, nothing is needed if a law explains as much without.
    best = max(found, key=lambda one: _speaks(story, one[0], one[1], one[-1]))
    if best[1] and (detented := _detented(best[0], best[1][0])) is not None:
        found.append(_found(story, detented, progress))
        best = max(found, key=lambda one: _speaks(story, one[0], one[1], one[-1]))
    fit, laws, p_value, curve, shapes = best
    none = Proposals(fit, p_value=p_value)
    if _closed(story) and _speaks(story, fit, laws) <= _speaks(story, last, []) + RULE.alike:
        return replace(none, why="what came in explains as much, and has names")
    if not laws:
        return replace(none, why="what is left is no more than chance makes of so many laws, or too little")
    ordered = _ordered([(_fitted(fit, row), row[4]) for row in laws[:FITTED]])
    if (name := _named(story, fit, ordered[0])) is not None:
        return replace(none, why=f"{name} explains as much, and has a name")
    needs, surface, written = shapes
    if written is not None:
        row, unseen = written
        ordered = (*ordered, replace(_fitted(fit, row), unseen=unseen * fit.rmse))
    line = None if curve is None else drawn(curve, [row[0] for row in laws])
    return Proposals(
        fit,
        ordered,
        p_value,
        line,
        needs=tuple(Need(tuple(sorted(names)), left, p) for names, left, p in needs),
        map=None if surface is None else mapped(surface),
    )


def _found(story: LearningResult, fit: Fit, progress: Callable[[float], object] | None) -> tuple[Any, ...]:
    """What the core proposes beside a model, after it; no sum of which a part is what the first model has."""
    whole = {*story.ladder[0].fit.model.effects} <= {*fit.model.effects}
    return (fit, *_core.propose(cores(fit), fit.core.model, whole, progress))


def _bases(story: LearningResult) -> list[Fit]:
    """The models beside which laws are looked for: the first, without what it need not have, and the last.

    Detents of the first model may be a law's wave, and what came in may have explained it badly.
    """
    first, last = story.ladder[0].fit, story.fit
    shown = base_effects_shown(first.model.coordinate)
    bare = [first.drop(one) for one in shown if one in first.model.effects]
    return [first, *bare, *([] if _closed(story) else [last])]


def _detented(fit: Fit, row: Any) -> Fit | None:
    """The fit with the detents that only show beside a law; None where there are none."""
    if fit.model.period is not None or not base_effects_shown(fit.model.coordinate):
        return None
    law = _fitted(fit, row)
    whole = with_detents(law.fit)
    if whole.model.period is None:
        return None
    core = whole.core.model.only([one for one in whole.model.effects if one != law.name])
    return replace(fit, core=_core.refine(cores(fit), core, False))


def _closed(story: LearningResult) -> bool:
    """Whether names leave chance alone, though it may take so many that they are no explanation."""
    return story.verdict != "unexplained" or story.after.complete


def _needless(story: LearningResult) -> str:
    """Why there is nothing to propose; empty where there is."""
    if story.verdict != "unexplained" and len(story.found) < 2:
        return f"{story.found[0]} explains what is missing" if story.found else "chance explains what is left"
    if story.cut is not None:
        return "the search for names was cut short"
    fit = story.fit
    if fit.log_fault is not None:
        return "the log is to be mended first"
    if not fit.noise_floor > 0.0:
        return "how much of the error is noise is not known"
    if incoherent(fit):
        return "what is left cannot be told from errors of the recorded motion"
    if story.after.complete and len(story.ladder) == 1:
        return "what is left is chance"
    return ""


def _speaks(story: LearningResult, fit: Fit, laws: list[Any], shapes: Any = None) -> float:
    """What speaks for a model with the first of some laws, or what no formula says, beside the first step's.

    A sum of laws in place of what came in under a name has to explain it with less.
    """
    first = story.ladder[0].fit
    effects = len(fit.core.free) - len(first.core.free)
    own = _worth(laws[0]) if laws else 0.0
    if laws and laws[0][6] > 1 and story.found and fit is not story.fit:
        own -= NAMED * RULE.price
    if shapes is not None and shapes[-1] is not None:
        law = shapes[-1][0]
        own = max(own, law[3] - RULE.price * law[5])
    return float(gain(first, fit, first) - RULE.price * effects + own)


def _worth(row: Any) -> float:
    """What a law of the search takes off, less the price of its parameters."""
    return float(row[3] - RULE.price * row[7])


def _fitted(fit: Fit, row: Any) -> Proposal:
    """A law of the search, fitted with the whole model."""
    law, values, variables, _, _, complexity, *_ = row
    name = free_name(fit.model)
    own_law(name, law)
    try:
        richer = converged(started(fit, name, dict(values)))
    finally:
        forget_effect(name)
    taken = gain(fit, richer, fit)
    return Proposal(law, name, tuple(sorted(variables)), richer, float(taken), complexity)


def _ordered(proposals: list[tuple[Proposal, bool]]) -> tuple[Proposal, ...]:
    """Laws in the order of the search; of those that explain as much as the best, some later.

    Those that bend what resists below zero beyond doubt.
    """
    bent = [(not alike, len(below_zero(one.fit)) if alike else 0) for one, alike in proposals]
    return tuple(proposals[at][0] for at in sorted(range(len(proposals)), key=bent.__getitem__))


def _named(story: LearningResult, fit: Fit, law: Proposal) -> str | None:
    """The effect of the catalogue that explains as much beside the same model, if one does."""
    weighed = _weighed(story, fit)
    came = gain(weighed.fit, fit, fit)
    # A law that leaves noise alone shows what a name is off by: either may be by as much as a textbook's.
    share = (2.0 * RULE.law) ** 2 if at_floor(law.fit) else RULE.relative
    # A spring has a centre, and costs a parameter more than a law through zero.
    margin = max(RULE.alike + RULE.price, share * law.gain)
    alike = [
        one
        for one in weighed.candidates
        if one.beyond_chance and not one.implausible and one.score >= law.score + came - margin
    ]
    return max(alike, key=lambda one: one.score).effect if alike else None


def _weighed(story: LearningResult, fit: Fit) -> Diagnosis:
    """What was weighed beside a model, or is now where it was none of the story's; joints take too long."""
    if fit is story.fit:
        return story.last
    if fit is story.ladder[0].fit:
        return story.first_diagnosis
    catalogue = effects(fit.model.coordinate)
    joints = {one for one, row in catalogue.items() if row.place == "coupling"}
    return diagnose(fit, without={*story.without, *descriptions(fit.model.coordinate), *joints})


def accepted(proposals: Proposals, number: int, name: str | None = None) -> tuple[str, Fit]:
    """Register a proposed law under a name, and return the name and the fit with it.

    Raises InputError for a number that no law has.
    """
    if not 1 <= number <= len(proposals.laws):
        have = f"there are {len(proposals.laws)}" if proposals.laws else f"there are none: {proposals.why}"
        raise InputError(f"--accept {number}: no proposal has that number; {have}")
    one = proposals.laws[number - 1]
    name = name or free_name(proposals.beside.model)
    start = {param: estimate.value for param, estimate in one.params.items()}
    own_law(name, one.law)
    return name, converged(started(proposals.beside, name, start))
