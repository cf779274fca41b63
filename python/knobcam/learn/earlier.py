"""What came in before, tested anew beside what came in last."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

from ..fit.refit import converged, drop, needed, needless
from ..fit.rule import RULE

if TYPE_CHECKING:
    from collections.abc import Collection

    from ..fit import Fit
    from ..fit.diagnose import Candidate


def without_help(richer: Fit, candidate: Candidate, fit: Fit) -> Fit | None:
    """Return the fit without a candidate that only helped a joint to a better end; None where it did more.

    The error of a joint is rough: whatever is added to one moves it, and any move may end lower.
    """
    if candidate.place == "coupling" or fit.model.joint is None:
        return None
    if needed(richer, candidate.effect):
        return None
    bare = drop(richer, candidate.effect)
    if needed(richer, candidate.effect, bare):
        return None
    bare = converged(bare)
    helped = bare.rmse < (1.0 - RULE.helped) * fit.rmse
    return replace(bare, before=fit.before) if helped and needless(richer, bare) else None


def retested(fit: Fit, tested: Collection[str]) -> tuple[Fit, tuple[str, ...]]:
    """Return the fit without those of the tested effects that it no longer needs, and which they were."""
    dropped: list[str] = []
    for effect in tested:
        if effect not in fit.model.effects or needed(fit, effect):
            continue  # it went before, or with another that it changed; or it is worth far too much to go
        # What an effect did, a joint has to be fitted anew to do.
        bare = drop(fit, effect)
        if not needed(fit, effect, bare) and needless(fit, bare := converged(bare)):
            fit = bare
            dropped.append(effect)
    return fit, tuple(dropped)
