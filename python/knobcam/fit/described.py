"""What documents say of the captures of a fit, and of what was found in them."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from ..capture.finding import Finding
from .plausible import REVERSED

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from ..capture.prepare import Prepared
    from .estimate import Estimate


def documented(params: Mapping[str, Estimate]) -> dict[str, Any]:
    """Return parameters as every document has them."""
    return {
        name: {"value": e.value, "ci95": list(e.ci95) if e.determined else None, "unit": e.unit}
        for name, e in params.items()
    }


def described(signals: Prepared) -> dict[str, Any]:
    """Return what a document says of one capture."""
    capture = signals.capture
    return {
        "path": str(capture.meta.get("source", "")),
        "samples": capture.samples,
        "duration_s": capture.duration_s,
        "sample_rate_hz": capture.rate_hz,
        "masked": int(np.sum(~capture.mask)),
        "used": signals.core.used,
        "findings": [finding.document() for finding in signals.findings],
    }


def said(prepared: Sequence[Prepared]) -> list[dict[str, Any]]:
    """What was found in captures, as the JSON documents have it: of several, which one each is about."""
    every = [(one.capture, finding) for one in prepared for finding in one.findings]
    if len(prepared) == 1:
        return [finding.document() for _, finding in every]
    return [{"capture": str(capture.meta.get("source", ""))} | one.document() for capture, one in every]


def sign(prepared: Sequence[Prepared]) -> dict[str, Any]:
    """Return the finding that the torque has the other sign."""
    every = sum(one.capture.samples for one in prepared)
    return Finding("sign", "tau", every, ((1, every),), REVERSED, "warning").document()


def names(prepared: Sequence[Prepared]) -> list[str]:
    """Return what to call each of several captures."""
    sources = [str(one.capture.meta.get("source", "")) for one in prepared]
    return [source or f"capture {number}" for number, source in enumerate(sources, 1)]
