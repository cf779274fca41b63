"""The loop to a verdict: fit, ask what is missing, add it, until the rest is chance or unexplained."""

from __future__ import annotations

import math
import os
import warnings
from collections.abc import Callable, Collection, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, Any, Literal

from ..base import showing
from ..base.door import checked
from ..base.said import OfEffect, Said, Stretch, joined, said
from ..base.tables import TextTable, text_table
from ..capture import Capture
from ..fit import Fit
from ..fit.diagnose import Candidate, Diagnosis, check_effects, diagnose, p_in_words
from ..fit.fitting import as_logged
from ..fit.refit import percent
from ..fit.rule import RULE
from ..fit.runs import in_words
from ..model import Model
from ..model.effects import base_effects_shown
from .agreement import Disagreement, disagreements
from .cut import Cut, Deadline, Interrupted
from .headline import headline
from .ladder import LearningStep, Unexplained, first_weighed
from .limitations import Limitation, limitations
from .loosened import with_shapes
from .proposals import Proposals
from .proposing import accepted, propose
from .rivals import in_percent, with_choice
from .search import Search
from .selection import concluded
from .to_record import to_record

if TYPE_CHECKING:
    from pathlib import Path

    from ..base.showing import Figure, Look
    from ..fit import Estimate
    from ..fit.compare import Comparison

Verdict = Literal["complete", "missing", "unexplained"]
_BAR = 24  # characters of the longest


@dataclass(frozen=True, eq=False, repr=False)
class LearningResult(showing.Tabled):
    """How a model was completed, step by step, and what the captures still do not tell; immutable.

    `found` are the effects that were missing, in the order in which they came in; `weighed` is what could
    have been added on the last step, `without` what was not weighed; `cut` says so of a search that did not
    come to its end.
    """

    ladder: tuple[LearningStep, ...]
    found: tuple[str, ...]
    weighed: Diagnosis
    unexplained: Unexplained | None
    cut: Cut | None = None
    without: tuple[str, ...] = ()

    @property
    def fit(self) -> Fit:
        """The fit on the last step."""
        return self.ladder[-1].fit

    @property
    def model(self) -> Model:
        """The model on the last step."""
        return self.fit.model

    @cached_property
    def params(self) -> Mapping[str, Estimate]:
        """Parameters on the last step; their intervals carry the choice of effects and of shapes."""
        return with_shapes(with_choice(self.fit.params, self.ladder), self.fit)

    @property
    def verdict(self) -> Verdict:
        """`complete`, `missing` (then `found` says what) or `unexplained` (then `unexplained` says where)."""
        if self.unexplained is not None:
            return "unexplained"
        return "missing" if self.found else "complete"

    @property
    def noise_floor(self) -> float:
        """What the torque sensor's noise alone would leave, N m."""
        return self.fit.noise_floor

    @property
    def captures(self) -> tuple[Capture, ...]:
        """The captures that it is about."""
        return tuple(signals.capture for signals in self.fit.prepared)

    @cached_property
    def limitations(self) -> tuple[Limitation, ...]:
        """What these captures cannot tell, and what to record instead."""
        return limitations(self.fit)

    @property
    def lacks(self) -> tuple[Limitation, ...]:
        """The older name of `limitations`."""
        warnings.warn("LearningResult.lacks is now called limitations", DeprecationWarning, stacklevel=2)
        return self.limitations

    @cached_property
    def disagreements(self) -> tuple[Disagreement, ...]:
        """Parameters of the last model that the captures ask for differently."""
        return disagreements(self.fit)

    @cached_property
    def last(self) -> Diagnosis:
        """What was weighed on the last step and not added, with what the search had no need to fit."""
        return self.weighed if self.weighed.whole else diagnose(self.weighed.fit, without=self.without)

    @cached_property
    def first_diagnosis(self) -> Diagnosis:
        """What was weighed on the first step, or is now: of a session that goes on nobody knows it."""
        known = first_weighed(self.ladder) or (self.last if len(self.ladder) == 1 else None)
        return known or diagnose(self.ladder[0].fit, without=self.without)

    @property
    def before(self) -> Comparison:
        """Where the first model fails."""
        known = first_weighed(self.ladder) or (self.weighed if len(self.ladder) == 1 else None)
        return (known or self.ladder[0]).fit.compare()

    @property
    def after(self) -> Comparison:
        """Where the last model fails."""
        return self.weighed.comparison

    @property
    def not_added(self) -> Candidate | None:
        """What could be missing still and was not added, as where a person stopped; None where nothing is.

        Nor where so many came in that one more would explain nothing.
        """
        return None if self.cut is not None or self._most else self.weighed.best

    @property
    def one_more(self) -> Candidate | None:
        """What would take off more where so many came in that it explains nothing; None elsewhere."""
        return self.weighed.best if self.cut is None and self._most else None

    @property
    def _most(self) -> bool:
        return len(self.ladder) > RULE.most

    @property
    def headline(self) -> Said:
        """The verdict in one sentence, and in others what it may be wrong by and what was left out of it."""
        return headline(self)

    @property
    def left(self) -> Said:
        """How large the error is in the end, and where it shows, unless the headline says where already."""
        told = any(isinstance(part, Stretch) for part in self.headline.parts)
        return self.after.size if told else self.after.summary

    @property
    def record(self) -> str | None:
        """What to record next to see more of what no effect explains; None where nothing is left so."""
        return to_record(self)

    def propose(self, progress: Callable[[float], object] | None = None) -> Proposals:
        """Return laws for what no effect explains, the best first; none where nothing is left beyond chance.

        `progress` is told the share of the work that is done; what it raises ends the work.
        """
        return propose(self, progress)

    def accept(self, proposals: Proposals, number: int = 1, name: str | None = None) -> LearningResult:
        """Return the story with a proposed law as an effect called `name`, and what then is left.

        Raises InputError for a number that no proposal has, and for a name that is taken.
        """
        name, fit = accepted(proposals, number, name)
        # What came in badly in the law's place goes.
        kept = self.ladder if proposals.beside is self.fit else self.ladder[:1]
        step = LearningStep(fit, name, proposals.p_value)
        left = diagnose(fit, only=())
        shown = base_effects_shown(fit.model.coordinate)
        base = [*self.ladder[0].fit.model.effects, *(one for one in shown if one not in self.found)]
        selection = concluded([*kept, step], left, base)
        return LearningResult(*selection, self.without)

    def plot(self) -> Figure:
        """The ladder, the residual before and after, what moved, and what remains."""
        return showing.plot(self)

    def look(self) -> Look:
        """Return linked plots to brush in, for every step of the ladder and what was weighed on it."""
        return showing.look(self)

    @checked
    def report(self, path: str | os.PathLike[str]) -> Path:
        """Write all of it as one HTML file that needs nothing else, and return its path."""
        return showing.report(self, path)

    def document(self) -> dict[str, Any]:
        """Return the JSON document of `knobcam learn --json`."""
        fitted = self.fit.document()
        return {
            "schema": "knobcam.learn/1",
            "capture": fitted["captures"][0],
            "captures": fitted["captures"],
            "findings": fitted["findings"],
            "unit": self.fit.torque_unit,
            "noise_floor": self.noise_floor,
            "verdict": self.verdict,
            "found": list(self.found),
            "ladder": [
                *(
                    step.document(with_choice(step.params, self.ladder[: at + 1]))
                    for at, step in enumerate(self.ladder[:-1])
                ),
                self.ladder[-1].document(self.params),
            ],
            "unexplained": None if self.unexplained is None else self.unexplained._asdict(),
            "per_capture": fitted["per_capture"],
            "limitations": [one._asdict() for one in self.limitations],
            "lacks": [one._asdict() for one in self.limitations],  # its older name, for one version
            "disagreements": [one._asdict() for one in self.disagreements],
            "headline": self.headline,
            "record": self.record,
            "warnings": list(self.fit.warnings),
            "cut": None if self.cut is None else self.cut._asdict(),
        }

    @property
    def head(self) -> tuple[str, ...]:
        """What the columns of `rows` are."""
        unit = self.fit.torque_unit
        unseen = f"on unseen blocks ({unit})"
        return ("model", f"RMS error ({unit})", unseen, "error", "p-value", "weight", "cannot be told from")

    def rows(self) -> list[tuple[str, ...]]:
        """The ladder as rows of text, under the words of `head`."""
        rows = []
        for step in self.ladder:
            new = step.added is not None
            name = said("+ {added}", added=OfEffect(step.added)) if step.added is not None else "first model"
            if step.dropped:
                name = said("{name} - {dropped}", name=name, dropped=_listed(" - ", step.dropped))
            rows.append(
                (
                    name,
                    f"{step.rmse:.4g}",
                    f"{step.rmse_heldout:.4g}",
                    percent(-step.error_fall) if new else "",
                    p_in_words(step.p_value) if new else "",
                    in_percent(step.weights.get(step.added or "")) if new else "",
                    _listed(", ", step.equivalent),
                )
            )
        noise = "unknown" if math.isnan(self.noise_floor) else f"{self.noise_floor:.4g}"
        return [*rows, ("sensor noise alone", noise, "", "", "", "", "")]

    def __repr__(self) -> str:
        head = (self.head[0], "", *self.head[1:])
        rows = [(row[0], bar, *row[1:]) for row, bar in zip(self.rows(), self._bars(), strict=True)]
        lines = [self.headline, text_table(head, rows), self.left]
        lines += [*self.model.sides, *in_words(self.fit.per_capture), *self.fit.warnings]
        if self.disagreements:
            lines.append("Where the captures disagree:")
            lines += [f"  {one}." for one in self.disagreements]
        if self.limitations:
            these = "these captures" if len(self.captures) > 1 else "this capture"
            lines.append(f"What {these} cannot tell:")
            lines += [f"  {one.message}; {one.record}." for one in self.limitations]
        if self.record is not None:
            lines.append(f"To see what it is, record {self.record}.")
        return "\n".join(lines)

    def _bars(self) -> list[str]:
        """The ladder drawn in characters, one bar a step, the noise floor last and dotted."""
        errors = [*(step.rmse for step in self.ladder), self.noise_floor]
        longest = max(error for error in errors if error == error) or 1.0
        lengths = [round(_BAR * error / longest) if error == error else 0 for error in errors]
        return [*("#" * length for length in lengths[:-1]), "." * lengths[-1]]

    def tables(self) -> tuple[TextTable, ...]:
        """What it says of itself, as text."""
        return (TextTable(self.headline, self.head, self.rows()),)


def _listed(between: str, effects: Sequence[str]) -> Said:
    return joined(between, map(OfEffect, effects))


@checked
def learn(
    captures: Capture | str | os.PathLike[str] | Sequence[Capture | str | os.PathLike[str]],
    model: Model | str | os.PathLike[str] | None = None,
    *,
    without: Collection[str] = (),
    prepare: str = "smooth",
    detents: str = "auto",
    progress: Callable[[str], None] | None = None,
    budget_s: float | None = None,
    **options: float,
) -> LearningResult:
    """Learn which effects are missing from a model (by default the base model) of one or several captures.

    `without` takes effects out of the catalogue; `progress` is told each step; the rest as in `fit`. A search
    that takes longer than `budget_s` seconds is cut short: its verdict is `unexplained`, and `cut` says what
    it did not weigh.

    Raises InputError for captures that cannot be fitted, with what to do, and for unknown effects;
    Interrupted, a KeyboardInterrupt with what was learned by then, for Ctrl-C in the search.
    """
    deadline = Deadline.of(budget_s)
    tell = progress or (lambda _: None)
    if isinstance(model, str | os.PathLike):
        model = Model.load(model)
    without = check_effects("without", without, model.coordinate if model else "rotary")
    tell("fitting the first model")
    first = as_logged(captures, model, prepare=prepare, detents=detents, **options)
    given = model is not None
    automatic = not given and detents == "auto"
    search = Search(first, without, tell, deadline, given=given, detents=automatic)
    learned = LearningResult(*search.selected(), without)
    if learned.cut is not None and learned.cut.by == "interrupt":
        raise Interrupted(learned)
    return learned
