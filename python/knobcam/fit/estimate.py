"""What a fit found of a parameter, or of a constant that its torque was computed with."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any, NamedTuple

from ..base.said import OfParam, Said
from ..base.tables import TextTable, text_table

Z95 = 1.959963984540054
"""Two-sided 95 % quantile of the normal distribution."""


class Estimate(NamedTuple):
    """A fitted parameter in SI with its 95 % interval; NaN limits where the capture does not determine it."""

    value: float
    ci95: tuple[float, float]
    unit: str
    se: float

    @property
    def determined(self) -> bool:
        """Whether the capture says anything about it."""
        return math.isfinite(self.se)

    def widened(self, variance: float) -> Estimate:
        """Return it with so much more variance, as something else that is not known adds."""
        error = math.sqrt(self.se**2 + variance)
        return self._replace(ci95=(self.value - Z95 * error, self.value + Z95 * error), se=error)

    @property
    def held(self) -> bool:
        """Whether it was not fitted."""
        return self.se == 0.0

    @property
    def interval(self) -> str:
        """The interval in words."""
        if self.held:
            return "fixed"
        return f"{self.ci95[0]:.5g} to {self.ci95[1]:.5g}" if self.determined else "not determined"


def rows_of(params: Mapping[str, Estimate]) -> list[tuple[str, str, str, str]]:
    """Return parameters as rows of text: name, value, interval, unit; what is not determined has no value."""
    return [
        (Said(OfParam(name)), f"{e.value:.6g}" if e.determined else "-", e.interval, e.unit)
        for name, e in params.items()
    ]


class Constants(NamedTuple):
    """The constants that a torque was computed with, by name, or why one is not determined (`fit_constants`).

    `errors` are standard errors of the parameters that hold what the constants leave open. `unscaled`: what
    the whole torque is in proportion to is not determined, and the fit has 1 for it. `delay`: by how much
    later what the terms are added to acts than it is logged, s, which is fitted with them; None where the
    motion does not tell it.
    """

    found: Mapping[str, Estimate]
    undetermined: Mapping[str, str]
    errors: Mapping[str, float]
    unscaled: bool
    delay: Estimate | None = None

    def document(self) -> dict[str, Any]:
        """Return what a document has of them."""
        found = {name: {"value": e.value, "ci95": list(e.ci95)} for name, e in self.found.items()}
        without = {name: {"value": None, "ci95": None, "why": why} for name, why in self.undetermined.items()}
        late = self.delay
        delay = {} if late is None else {"delay_s": {"value": late.value, "ci95": list(late.ci95)}}
        return found | without | delay

    def table(self) -> TextTable:
        """Return them as a table of text."""
        rows = [(name, f"{e.value:.6g}", e.interval) for name, e in self.found.items()]
        rows += [(name, "-", "not determined") for name in self.undetermined]
        return TextTable("Constants of the torque", ("constant", "value", "95 % interval"), rows)

    def in_words(self) -> list[str]:
        """Return them in words: the table, and why one is not determined."""
        table = self.table()
        why = [f"{name} is not determined: {why}" for name, why in self.undetermined.items()]
        return [text_table(table.head, table.rows), *why, *self._late()]

    def _late(self) -> list[str]:
        """What the constants are added to, where it acts surely later or earlier than it is logged."""
        if self.delay is None or self.delay.ci95[0] <= 0.0 <= self.delay.ci95[1]:
            return []
        low, high = (1e3 * abs(end) for end in self.delay.ci95)
        way = "later" if self.delay.value > 0.0 else "earlier"
        return [
            f"what is commanded acts {1e3 * abs(self.delay.value):.3g} ms ({min(low, high):.3g} to "
            f"{max(low, high):.3g}) {way} than it is logged, which was fitted with the constants"
        ]
