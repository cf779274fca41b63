"""Where no name explains what is left: laws that would, each fitted like an effect and held out on blocks.

Nothing that is proposed is a cause: the verdict stays, until somebody takes a law under a name.
"""

from __future__ import annotations

import re
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, Any

from ..base import showing
from ..base.said import OfEffect, Said, joined, number, said
from ..base.tables import TextTable, text_table
from ..fit.described import documented
from ..fit.diagnose import p_in_words
from ..fit.rule import RULE
from .left import Curve, Map, Need

if TYPE_CHECKING:
    from collections.abc import Mapping

    from ..base.showing import Figure
    from ..fit import Estimate, Fit

_LEAST_P = 0.005  # which is all that the 199 draws of a proposal can tell
_NEEDS = 4  # that are said


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
            chance=p_in_words(self.p_value, _LEAST_P),
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
        return [
            (
                name,
                f"{e.value:.6g}" if e.determined else "",
                e.interval,
                e.unit,
            )  # what is not known has no number
            for name, e in first.params.items()
        ]

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
