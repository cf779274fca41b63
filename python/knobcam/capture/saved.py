"""A capture as it was saved: its mask, its findings, and what a person says of them anew."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np

from ..errors import InputError
from .finding import Rows
from .formats import document
from .quality.torque import Limit, check_clipping

if TYPE_CHECKING:
    from collections.abc import Collection, Mapping

    from ..base.arrays import BoolArray
    from .capture import Capture
    from .finding import Finding
    from .formats import Table


def limited(capture: Capture, limit: Limit, rows: Rows) -> Capture:
    """Return a capture that was saved with its torque's extremes taken for another limit."""
    usable = capture.mask | capture.at_limit
    clipped, found = check_clipping(capture.tau, capture.theta, usable, rows, limit)
    others = [one for one in capture.findings if one.column != "tau" or one.kind not in ("clipped", "limit")]
    return replace(capture, mask=usable & ~clipped, findings=(*others, *found))


def restored(
    capture: Capture, native: Mapping[str, Any], table: Table, keep: slice | BoolArray, untouched: bool
) -> Capture:
    """Return `capture` with the mask that was saved, and of a whole file also its findings."""
    whole = untouched or (table.mask is not None and len(table.mask) == capture.samples)
    length = capture.samples if isinstance(keep, slice) else len(keep)
    try:
        stored = document.stored_mask(native, table, length)[keep]
        said = document.stored_findings(native)
        dropped = tuple(finding for finding in said if finding.column not in capture.columns)
        return replace(
            capture,
            mask=stored if whole else stored & capture.mask,
            rate_hz=document.stored_rate(native) if whole else capture.rate_hz,
            findings=said if whole else dropped + capture.findings,
        )
    except (LookupError, TypeError, ValueError, AttributeError, OverflowError) as error:
        raise InputError(
            f"{table.source}: its description is damaged ({error!r}); export the capture again"
        ) from error


def ruled(capture: Capture, overruled: Collection[str]) -> Capture:
    """Return a capture that was saved with these of its findings overruled, by their keys.

    Samples that were masked count again, but for those that another finding masks. Raises InputError for what
    was mended: as it was recorded it is in the log alone.
    """
    said = []
    back, stay = (np.zeros(capture.samples, dtype=np.bool_) for _ in range(2))
    for one in capture.findings:
        if one.key not in overruled or one.stands:
            said.append(one)
            stay |= capture.named(one) & (one.severity == "masked")
            continue
        if one.severity == "mended" or (one.severity == "masked" and _cut(one)):
            source = capture.meta.get("source", "capture")
            raise InputError(
                f"{source}: {one.key} was {one.severity} before the capture was saved; import its log again "
                f"with --overrule {one.key}"
            )
        said.append(one if one.overruled else one.over())
        back |= capture.named(one)
    return replace(capture, mask=capture.mask | (back & ~stay), findings=tuple(said))


def _cut(finding: Finding) -> bool:
    """Whether it names fewer rows than it is about."""
    return sum(last - first + 1 for first, last in finding.spans) < finding.count
