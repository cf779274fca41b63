"""What a person says of a capture: which findings are overruled, and which stretches of it are left out."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from ..base.said import said
from ..errors import InputError
from .finding import MAX_ROWS, Finding, spans
from .quality.ruled import Ruled, awaited, check_overruled

if TYPE_CHECKING:
    from collections.abc import Collection, Sequence

    from .capture import Capture

LEFT_OUT = "left_out:t"
"""The key of the finding that names what a person left out."""


def as_told(
    capture: Capture, source: str, overrule: Collection[str], leave_out: Sequence[Sequence[float]] = ()
) -> Capture:
    """Return it without the stretches (s) that are left out, with notes of what is overruled later.

    Raises InputError for what cannot be overruled, and for a stretch that holds no sample.
    """
    capture = without(capture, source, leave_out, overrule)
    check_overruled(source, overrule, capture.findings)
    later = awaited(overrule, capture.findings)
    return replace(capture, findings=(*capture.findings, *later)) if later else capture


def without(
    capture: Capture, source: str, leave_out: Sequence[Sequence[float]], overrule: Collection[str] = ()
) -> Capture:
    """Return it with the samples of stretches masked, from and to which time (s); a finding says so."""
    if not leave_out:
        return capture
    out = np.zeros(capture.samples, dtype=np.bool_)
    for one in leave_out:
        if len(one) != 2 or not all(map(math.isfinite, one)) or not one[0] <= one[1]:
            raise InputError(f"leave_out: {list(one)} is no stretch; give two times in s, as (3.2, 4.1)")
        first, last = one
        inside = (capture.t >= first) & (capture.t <= last)
        if not inside.any():
            t = capture.t[capture.mask]
            raise InputError(
                f"{source}: no sample lies from {first:g} to {last:g} s, to be left out; the capture "
                f"runs from {t.min():.6g} to {t.max():.6g} s"
            )
        out |= inside
    rows = np.flatnonzero(out) + int(capture.meta.get("first_row", 1))
    digits = max(0, math.ceil(math.log10(capture.rate_hz)))  # as fine as the samples are apart
    shown = [f"{first:.{digits}f} to {last:.{digits}f} s" for first, last in leave_out[:MAX_ROWS]]
    shown += [f"{len(leave_out) - MAX_ROWS} more"] if len(leave_out) > MAX_ROWS else []
    told = said(
        "{count} samples are left out because a person said so: {stretches}",
        count=len(rows),
        stretches=", ".join(shown),
    )
    kind, column = LEFT_OUT.split(":")
    ruled = Ruled(overrule)
    stays = ruled.lets([Finding(kind, column, len(rows), spans(rows), told, "masked")])
    mask = capture.mask & ~out if stays else capture.mask
    if mask.sum() < 2:
        raise InputError(f"{source}: leaves fewer than 2 usable samples of {capture.samples}; leave out less")
    return replace(capture, mask=mask, findings=(*capture.findings, *ruled.findings))
