"""Samples at which a sensor says itself that it was at its limit."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from ...base.arrays import BoolArray
from ...base.said import OfColumn, said
from ..finding import Finding, Rows, rows_in_words, spans


def check_limits(
    limits: Mapping[str, BoolArray], usable: BoolArray, rows: Rows
) -> tuple[BoolArray, list[Finding]]:
    """Return which samples are at a limit and not masked yet, and the findings; `limits` is by column."""
    clipped = np.zeros(len(rows), dtype=np.bool_)
    findings = []
    for column, limited in limits.items():
        at = limited & usable
        if not at.any():
            continue
        clipped |= at
        found = said(
            "{column}: {count} samples are at a limit of the sensor ({rows}), which is only a bound",
            column=OfColumn(column),
            count=int(at.sum()),
            rows=rows_in_words(rows[at]),
        )
        kind = "clipped" if column == "tau" else "limit"
        findings.append(Finding(kind, column, int(at.sum()), spans(rows[at]), found, "masked"))
    return clipped, findings
