"""What documents say of the captures of a fit, and of what was found in them."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

import numpy as np

from ..capture.finding import Finding
from .plausible import MINUS, OTHER_SIGN, REVERSED
from .unheard import unheard

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from ..capture.prepare import Prepared
    from .estimate import Estimate
    from .fitting import Fit


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


def found(fit: Fit) -> list[dict[str, Any]]:
    """What was found in the captures of a fit, by themselves and by what the model cannot be."""
    return said(fit.prepared) + [one.document() for one in by_model(fit)]


def by_model(fit: Fit) -> list[Finding]:
    """Return what was found by what the model cannot be."""
    every = sum(one.capture.samples for one in fit.prepared)
    reversed_ = Finding("sign", "tau", every, ((1, every),), OTHER_SIGN, "warning", MINUS)
    return [one for one in (reversed_ if fit.log_fault == REVERSED else None, fit.ahead) if one]


def summary(fit: Fit) -> str:
    """Return in words what a fit leaves, beside what noise would."""
    unit = fit.torque_unit
    noise = f"{fit.noise_floor:.4g} {unit} by sensor noise alone"
    if math.isnan(fit.noise_floor):
        noise = unheard(fit).why
    return f"RMS error {fit.rmse:.4g} {unit} ({fit.rmse_heldout:.4g} {unit} on unseen blocks, {noise})"


def names(prepared: Sequence[Prepared]) -> list[str]:
    """Return what to call each of several captures."""
    sources = [str(one.capture.meta.get("source", "")) for one in prepared]
    return [source or f"capture {number}" for number, source in enumerate(sources, 1)]
