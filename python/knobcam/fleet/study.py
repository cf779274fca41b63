"""All that statistics tell of a batch: what its report draws, and a document of it."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from .frame import axis, frame, parameters
from .gauge import Gauge, gauge
from .limits import Between, Limits
from .lots import FEWEST, Capable, Chart, Gain, More, Shift, capable, chart, gains, more, shifts, usual
from .pooled import Held, Pooled, compared, pooled
from .row import Row, counts

_BEGUN = 20  # captures, where there is one lot alone


@dataclass(frozen=True, eq=False)
class Study:
    """Statistics of a batch; `table` is a frame of pandas in the order in which captures were made."""

    table: Any
    units: dict[str, str]
    charts: tuple[Chart, ...]
    capability: tuple[Capable, ...]
    shifts: tuple[Shift, ...]
    gains: tuple[Gain, ...]
    more: tuple[More, ...]
    held: tuple[Held, ...]
    pooled: tuple[Pooled, ...]
    gauges: tuple[Gauge, ...]

    @classmethod
    def of(cls, rows: Sequence[Row], limits: Limits | None) -> Study:
        """Return the statistics of rows; those for which there is too little are left out."""
        rows = [row for row in rows if counts(row)]
        units = parameters(rows)
        table = frame(rows)
        if table.empty:
            return cls(table, {}, (), (), (), (), (), (), (), ())
        names = list(units)
        every = compared(table, rows)
        moved = [one for by in ("lot", "station") for one in shifts(table, names, by)]
        lots = list(dict.fromkeys(table["lot"]))
        alike = limits is not None and limits.axis == axis(rows)  # numbers in N m say nothing of those in A
        held = [one for one in (limits.checks if limits and alike else ()) if isinstance(one, Between)]
        able = [
            capable(table.loc[table["lot"] == lot, one.name].to_numpy(dtype=float), one, lot)
            for one in held
            if one.name in units
            for lot in lots
        ]
        return cls(
            table,
            units,
            tuple(_charts(table, names, lots)),
            tuple(one for one in able if one is not None),
            tuple(moved),
            tuple(gains(table, units, moved)),
            tuple(more(rows)),
            tuple(every),
            tuple(pooled(every, rows)),
            tuple(one for name in names if (one := gauge(table, name)) is not None),
        )

    def ordinary(self, name: str) -> tuple[float, float]:
        """Return between which values a parameter usually is in its lots, or in all where those are small."""
        of = self.table["lot"]
        lots = [self.table.loc[of == lot, name].to_numpy(dtype=float) for lot in dict.fromkeys(of)]
        large = [some for some in lots if np.isfinite(some).sum() >= FEWEST]
        every = [usual(some) for some in large or [self.table[name].to_numpy(dtype=float)]]
        together = np.concatenate(every)
        return (float(together.min()), float(together.max())) if len(together) else (0.0, 1.0)

    @property
    def said(self) -> list[str]:
        """What is to be known of lots and stations, a sentence each, the gravest first."""
        by_gain = {(one.by, one.name) for one in self.gains}
        single = [one for one in self.shifts if (one.by, one.name) not in by_gain]
        known = {(one.lot, one.effect) for one in self.more}
        weak = [one for one in self.pooled if (one.lot, one.effect) not in known]
        return [f"{one}." for one in (*self.gains, *self.more, *weak, *single, *self._drifts)]

    @property
    def _drifts(self) -> list[str]:
        """What moved along the captures of one lot; of several their differences are said."""
        if len(self.table) == 0 or self.table["lot"].nunique(dropna=False) > 1:
            return []
        told = {one.parameter for one in self.shifts}
        drift = [one for one in self.charts if one.out and one.parameter not in told]
        first = [self.table["capture"].iloc[one.out[0]] for one in drift]
        said = "drifts: its running mean is beyond chance first at"
        return [f"{one.parameter} {said} {at}" for one, at in zip(drift, first, strict=True)]

    def document(self) -> dict[str, Any]:
        """Return them as documents have them."""
        return {
            "lots": list(dict.fromkeys(self.table["lot"])) if len(self.table) else [],
            "shifts": [one._asdict() for one in self.shifts],
            "gains": [one._asdict() for one in self.gains],
            "more": [one._asdict() for one in self.more],
            "pooled": [one._asdict() for one in self.pooled],
            "held": [one._asdict() for one in self.held],
            "capability": [one._asdict() for one in self.capability],
            "out_of_control": {
                one.parameter: [self.table["capture"].iloc[at] for at in one.out] for one in self.charts
            },
            "gauges": [
                {**one._asdict(), "percent": one.percent, "distinct": one.distinct} for one in self.gauges
            ],
        }


def _charts(table: Any, names: Sequence[str], lots: Sequence[str]) -> Iterator[Chart]:
    """Yield the chart of each parameter; none of one capture, which has no course."""
    for name in names if len(table) > 1 else ():
        yield chart(table[name].to_numpy(dtype=float), name, _begun(table, lots))


def _begun(table: Any, lots: Sequence[str]) -> int:
    """Return how many captures later ones are held by: those of the first lot, or half of one alone."""
    first = int((table["lot"] == lots[0]).sum())
    return first if len(lots) > 1 and first >= FEWEST else max(len(table) // 2, min(_BEGUN, len(table)))
