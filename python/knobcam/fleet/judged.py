"""Rows as the table has them: what only all of them together, or limits, can say of each."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence

from ..model.effects import effects
from .limits import UNIT, Failed, Limits
from .outliers import outliers
from .row import Row

_ASKED_OF_ALL = ("duplicate", "mixed")


def judged(rows: Sequence[Row], limits: Limits | None) -> list[Row]:
    """Return rows with verdicts by limits, causes, and what is unlike their lots; sorted by capture.

    A capture whose content is that of one before is a `duplicate`, one whose axis or unit is another than
    most of its lot have is `mixed`.
    """
    ordered = sorted(rows, key=lambda row: str(row["capture"]))
    usual = {lot: max(sorted(some), key=some.__getitem__) for lot, some in _kinds(ordered).items()}
    unlike = outliers(ordered, lambda _: False)
    seen: set[str] = set()
    told = []
    for row in ordered:
        more = []
        if row["sha256"] is not None:
            more += ["duplicate"] if row["sha256"] in seen else []
            seen.add(row["sha256"])
        if row["error"] is None and (row["coordinate"], row["unit"]) != usual[row["lot"] or ""]:
            more += ["mixed"]
        own = [one for one in row["findings"] if one not in _ASKED_OF_ALL]
        failed = [] if limits is None else limits.failed(row)
        why = unlike.get(row["capture"], [])
        told.append(
            {
                **row,
                "findings": sorted({*own, *more}),
                "ok": None if limits is None or row["error"] is not None else not failed,
                "failed_limits": [one.limit for one in failed],
                "failed_why": [one.why for one in failed],
                "outlier": why,
                "cause": cause(row, failed, why),
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


def cause(row: Row, failed: Sequence[Failed], unlike: Sequence[str]) -> str | None:
    """Return what physically is behind a part that fails or is unlike its lot, in words.

    None where nothing is. Named effects first; then that none explains it; else the effects whose parameters
    are beyond limits, or unlike the lot.
    """
    if row["error"] is not None:
        return None
    known = effects(row["coordinate"])
    names = [name for name in row["found"] if name in known]
    if not names and row["verdict"] == "unexplained":
        return str(row["headline"])
    if not names and (failed or unlike):
        of = [one.limit for one in failed] + list(unlike)
        names = [name.partition(".")[0] for name in of if name.partition(".")[0] in known]
    if names:
        return "; ".join(dict.fromkeys(f"{name}: {known[name].name}" for name in names))
    beyond = any(one.limit != UNIT for one in failed)
    return "not named: nothing was found missing from its model" if beyond else None
