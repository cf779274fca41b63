"""The rows of a batch as a frame of numbers: what statistics of lots start from."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from typing import Any

from ..base.optional import require
from .row import Row, counts


def frame(rows: Sequence[Row]) -> Any:
    """Return what was read as a frame of pandas in the order in which it was made, each capture once.

    What is gone is left out, and of several kinds of axis or unit all but the one that most have. Columns:
    capture, lot, station, part, ok, and each parameter that is determined in most of them; `ratio` is the
    error over what noise would leave.
    """
    pandas = require("pandas", "statistics of lots", "fleet")
    some = [row for row in rows if counts(row)]
    most = axis(some)
    some = [row for row in some if (row["coordinate"], row["unit"]) == most]
    some.sort(key=lambda row: (row["date"] or "", row["lot"] or "", row["time"] or "", str(row["capture"])))
    return pandas.DataFrame(
        [
            {
                "capture": row["capture"],
                **{name: row[name] or "" for name in ("lot", "station", "part")},
                "ok": row["ok"],
                "ratio": row["rmse"] / row["noise_floor"] if row["noise_floor"] else None,
                **{name: values[0] for name, values in row["params"].items()},
            }
            for row in some
        ]
    )


def axis(rows: Sequence[Row]) -> tuple[str, str] | None:
    """Return the axis and the unit of torque that most captures have that were read; None where none was."""
    kinds = Counter((row["coordinate"], row["unit"]) for row in rows if counts(row))
    return max(sorted(kinds), key=kinds.__getitem__, default=None)


def parameters(rows: Sequence[Row]) -> dict[str, str]:
    """Return the parameters that most rows have, and their units: those of the model fitted to all."""
    good = [row for row in rows if counts(row)]
    count = Counter(name for row in good for name, values in row["params"].items() if values[0] is not None)
    units = {name: unit for row in good for name, unit in row["units"].items()}
    return {name: units[name] for name in sorted(count) if count[name] > len(good) / 2}
