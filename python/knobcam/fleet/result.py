"""What came of a batch, or of a station: its rows, and what is to be said of all of them."""

from __future__ import annotations

import math
import os
from collections import Counter
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any

from ..base import showing
from ..base.tables import TextTable, text_table
from ..base.writing import write
from . import aqdef
from .frame import axis, parameters
from .judged import judged, mixed
from .limits import Limits
from .row import GONE
from .store import limits_of, read
from .study import Study
from .table import arrow_table, schema_of

if TYPE_CHECKING:
    from ..base.showing import Figure

_SHOWN = 10  # captures that could not be read, in a text


@dataclass(frozen=True, eq=False, repr=False)
class BatchResult(showing.Tabled):
    """The rows of a table of results, by capture; immutable.

    `asked` are the captures of the call that made it, `fresh` how many of them were not done before
    (None: this is read), `limits` those by which they are judged. One that is `unfinished` was ended before
    its table was made, or is under way.
    """

    folder: Path
    rows: tuple[dict[str, Any], ...]
    asked: frozenset[str]
    fresh: int | None = None
    limits: Limits | None = None
    unfinished: bool = False

    @classmethod
    def read(cls, folder: str | os.PathLike[str]) -> BatchResult:
        """Return the results in a folder. InputError where there are none."""
        rows, limits = read(folder), limits_of(folder)
        gone = frozenset(str(row["capture"]) for row in rows if GONE in row["findings"])
        if unfinished := any("ok" not in row for row in rows):  # those of parts, which nothing judged yet
            rows = judged(rows, limits, gone)
        asked = frozenset(str(row["capture"]) for row in rows) - gone
        return cls(Path(folder), tuple(rows), asked, limits=limits, unfinished=unfinished)

    @cached_property
    def counted(self) -> tuple[dict[str, Any], ...]:
        """The rows but for those of captures that are not there any more."""
        return tuple(row for row in self.rows if GONE not in row["findings"])

    @property
    def failed(self) -> tuple[dict[str, Any], ...]:
        """The rows of captures that were asked for and could not be read or fitted."""
        return tuple(row for row in self.counted if row["capture"] in self.asked and row["error"] is not None)

    @property
    def drawn(self) -> Limits | None:
        """The limits, where they are of the axis and the unit that most captures have."""
        return self.limits if self.limits is not None and self.limits.axis == axis(self.counted) else None

    @cached_property
    def study(self) -> Study:
        """What lots and stations tell."""
        return Study.of(self.counted, self.limits)

    def table(self) -> Any:
        """Return the rows as a table of pyarrow, as the Parquet dataset in the folder has them."""
        return arrow_table(list(self.rows), schema_of(self.rows))

    @property
    def found(self) -> Mapping[str, int]:
        """How often each effect was found missing, most often first."""
        return dict(Counter(name for row in self.counted for name in row["found"]).most_common())

    def _counts(self) -> dict[str, int | None]:
        good = [row for row in self.counted if row["error"] is None]
        limited = any(row["ok"] is not None for row in good)
        return {
            "captures": len(self.counted),
            "gone": len(self.rows) - len(self.counted),
            "asked": len(self.asked),
            "fresh": self.fresh,
            "failed": len(self.failed),
            "complete": sum(row["verdict"] == "complete" for row in good),
            "missing": sum(row["verdict"] == "missing" for row in good),
            "unexplained": sum(row["verdict"] == "unexplained" for row in good),
            "not_weighed": sum(row["verdict"] is None for row in good),
            "ok": sum(row["ok"] is True for row in good) if limited else None,
            "not_ok": sum(row["ok"] is False for row in good) if limited else None,
            "outliers": sum(bool(row["outlier"]) for row in good),
            "duplicates": sum("duplicate" in row["findings"] for row in good),
        }

    def document(self) -> dict[str, Any]:
        """Return the JSON document of `knobcam batch --json`."""
        return {
            "schema": "knobcam.batch/1",
            "results": str(self.folder),
            **self._counts(),
            "found": dict(self.found),
            "lots": dict(sorted(Counter(row["lot"] or "" for row in self.counted).items())),
            "errors": [{"capture": row["capture"], "error": row["error"]} for row in self.failed],
            "not_ok_parts": [
                {"capture": row["capture"], "failed_limits": row["failed_limits"], "cause": row["cause"]}
                for row in self.counted
                if row["ok"] is False
            ],
            "mixed": mixed(self.counted),
        }

    HEAD = ("capture", "verdict", "found", "OK", "cause, or why not")

    def text_rows(self) -> list[tuple[str, ...]]:
        """What is to be looked at: parts that are not OK, unlike their lots, or could not be read."""
        told: list[tuple[str, ...]] = []
        for row in self.counted:
            if row["error"] is not None or row["ok"] is False or row["outlier"] or row["found"]:
                ok = {True: "OK", False: "NOK", None: ""}[row["ok"]]
                why = row["error"] or "; ".join(_why(row))
                told.append((row["capture"], row["verdict"] or "", ", ".join(row["found"]), ok, why))
        return told

    @property
    def headline(self) -> str:
        """How many captures there are, and what of them, in a sentence."""
        n = self._counts()
        now = "" if self.fresh is None else f", {self.fresh} of them fitted now"
        if (before := len(self.counted) - len(self.asked)) > 0:  # which lie elsewhere
            now += f", {before} of them of calls before"
        said = [f"{n['captures']} captures{now}", f"{n['complete']} complete"]
        said += [f"{n[name]} {name}" for name in ("missing", "unexplained") if n[name]]
        said += [f"{n['ok']} OK, {n['not_ok']} NOK"] if n["ok"] is not None else []
        said += [f"{n['failed']} could not be read or fitted"] if n["failed"] else []
        said += [f"left out are {n['gone']} whose files are not there any more"] if n["gone"] else []
        said += ["not at its end yet: the same batch or watch goes on from there"] if self.unfinished else []
        return "; ".join(said) + "."

    def __repr__(self) -> str:
        rows = self.text_rows()
        lines = [self.headline, *mixed(self.counted)]
        if rows:
            lines.append(text_table(self.HEAD, rows[:_SHOWN]))
        if len(rows) > _SHOWN:
            lines.append(f"  and {len(rows) - _SHOWN} more in {self.folder}")
        return "\n".join(lines)

    def tables(self) -> tuple[TextTable, ...]:
        """What it says of itself, as text."""
        return (TextTable(self.headline, self.HEAD, self.text_rows()),)

    def dfq(self, path: str | os.PathLike[str]) -> Path:
        """Write parameters of all parts, and their limits, for statistics programs (AQDEF); return the path.

        Parts that could not be read are left out; what a capture does not determine is marked as missing.
        """
        good = [row for row in self.counted if row["error"] is None]
        units = parameters(self.counted)
        limits = self.drawn
        held = {name: limits.of(name) if limits else None for name in units}
        every = [
            aqdef.Characteristic(
                name,
                unit,
                one.low if (one := held[name]) and math.isfinite(one.low) else None,
                one.high if one and math.isfinite(one.high) else None,
            )
            for name, unit in units.items()
        ]
        return write(path, aqdef.text(good, every, self.folder.name))

    def plot(self) -> Figure:
        """Parameters over the captures, by lot."""
        return showing.plot(self)

    def report(self, path: str | os.PathLike[str]) -> Path:
        """Write all of it as one HTML file that needs nothing else, and return its path."""
        return showing.report(self, path)


def _why(row: dict[str, Any]) -> list[str]:
    """Return what a part fails by and why; of a parameter that its cause names only the cause."""
    cause = row["cause"] or ""
    each = zip(row["failed_limits"], row["failed_why"], strict=True)
    return [why for limit, why in each if f"({limit})" not in cause] + ([cause] if cause else [])
