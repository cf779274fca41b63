"""Rows as the table has them: what only all of them together, or limits, can say of each."""

from __future__ import annotations

from collections import Counter
from collections.abc import Collection, Sequence

from .causes import Usual, cause
from .limits import Limits
from .outliers import group, groups, outliers
from .row import DUPLICATE, GONE, Row

_MIXED = "mixed"
_ASKED_OF_ALL = (DUPLICATE, GONE, _MIXED)


def judged(
    rows: Sequence[Row], limits: Limits | None, gone: Collection[str] = (), among: Sequence[Row] = ()
) -> list[Row]:
    """Return rows with verdicts by limits, causes, and what is unlike their lots; sorted by capture.

    A capture whose content is that of one before is a `duplicate`, one whose axis or unit is another than
    most of its lot have is `mixed`, and those of which only rows are left are `gone`: nothing else is held
    against them. What is usual in a lot is told by all rows, or by those that they are `among`.
    """
    ordered = sorted(rows, key=lambda row: str(row["capture"]))
    here = [row for row in ordered if row["capture"] not in gone]
    usual = {lot: max(sorted(some), key=some.__getitem__) for lot, some in _kinds(here).items()}
    unlike = outliers(here, lambda _: False)
    lots = {kind: Usual.of(some, limits) for kind, some in groups(among or here).items()}
    nothing = Usual.of((), None)
    seen: set[str] = set()
    told = []
    for row in ordered:
        more = []
        kind = (row["coordinate"], row["unit"])
        if row["capture"] in gone:
            more += [GONE]
        elif row["sha256"] is not None:
            more += [DUPLICATE] if row["sha256"] in seen else []
            seen.add(row["sha256"])
        if row["error"] is None and kind != usual.get(row["lot"] or "", kind):
            more += [_MIXED]
        own = [one for one in row["findings"] if one not in _ASKED_OF_ALL]
        failed = [] if limits is None else limits.failed(row)
        of_lot = nothing if row["capture"] in gone else lots.get(group(row), nothing)
        why = unlike.get(row["capture"], [])
        told.append(
            {
                **row,
                "findings": sorted({*own, *more}),
                "ok": None if limits is None or row["error"] is not None else not failed,
                "failed_limits": [one.limit for one in failed],
                "failed_why": [one.why for one in failed],
                "outlier": why,
                "cause": cause(row, failed, why, limits, of_lot),
            }
        )
    return told


def mixed(rows: Sequence[Row]) -> list[str]:
    """Return which lots hold several kinds of axis or unit, a sentence each."""
    said = []
    for lot, some in sorted(_kinds(rows).items()):
        if len(some) > 1:
            each = ", ".join(f"{count} {axis} in {unit}" for (axis, unit), count in sorted(some.items()))
            name = f"lot {lot}" if lot else "the captures without a lot"
            said.append(f"{name}: several kinds of axis or unit ({each}); they are not compared")
    return said


def _kinds(rows: Sequence[Row]) -> dict[str, Counter[tuple[str, str]]]:
    """Return how many captures of each kind of axis and unit each lot has."""
    kinds: dict[str, Counter[tuple[str, str]]] = {}
    for row in rows:
        if row["error"] is None:
            kinds.setdefault(row["lot"] or "", Counter())[(row["coordinate"], row["unit"])] += 1
    return kinds
