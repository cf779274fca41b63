"""A torque that stands in the log before the motion that it makes, as a command does, or after it."""

from __future__ import annotations

from dataclasses import replace
from functools import cache
from typing import TYPE_CHECKING

from .. import _core
from ..base.said import OfEffect, said
from ..capture.finding import Finding
from ..model.effects import effect as catalogued
from . import refit
from .rule import RULE

if TYPE_CHECKING:
    from .fitting import Fit

_AHEAD, _BEHIND = _BOTH = "actuation_delay", "torque_lag"
_NOTICED = 1.02  # times the noise floor, below which a delay is not looked for: it takes its time
_ROWS = 0.6  # below which nobody can tell a delay from how a derivative is taken


def delayed(fit: Fit) -> _core.Fit | None:
    """Return the sketch of a fit with the delay beside it, where that is beyond doubt; None where it is not.

    Only where the delay explains all that the model leaves beyond noise, and enough of the error to be named:
    what else is missing may look like one, and is for the diagnosis to tell. Nor beside a joint, nor where
    it was looked for already.
    """
    floor = fit.noise_floor
    known = any(name in fit.model.params for one in _BOTH for name in _times(one))
    # Not where a floor is unknown either.
    if fit.before or known or fit.model.joint is not None or not fit.rmse > _NOTICED * floor:
        return None
    sketched = {row[0]: row for row in _core.diagnose(refit.cores(fit), fit.model.core, _BOTH, None, True)}
    ahead, behind = (_beyond_doubt(fit, sketched[one]) for one in _BOTH)
    if ahead is not None:
        return ahead
    # Much else leaves a torque behind its motion: what explains as much is for the diagnosis to tell.
    best = fit.diagnose().best if behind is not None else None
    return behind if best is not None and best.effect == _BEHIND and not best.equivalent else None


def _beyond_doubt(
    fit: Fit, sketched: tuple[str, _core.Fit | None, float, int, float, str]
) -> _core.Fit | None:
    """Return the sketch of a delay beside a fit; None where it is in doubt."""
    effect, core, gain, _, p_value, _ = sketched
    if core is None or p_value > RULE.rare or gain < RULE.price or not _sure(fit, core, effect):
        return None
    return core


def mended(fit: Fit) -> Fit:
    """Return the fit with the delay fitted beside it where that is beyond doubt; else as it is.

    What moves with the delay has an interval that holds what the captures leave open of it.
    """
    if overruled(fit):
        return fit
    return fit if fit.delayed is None else refit.converged(replace(fit, core=fit.delayed, before=fit))


def ahead(fit: Fit) -> Finding | None:
    """Return the finding that the torque of a fit is ahead of its motion or behind it; else None.

    It is mended where the delay is fitted with the rest, and a note where a person has overruled it.
    """
    found = _found(fit)
    return found.over() if found and overruled(fit) else found


def overruled(fit: Fit) -> bool:
    """Whether a person has overruled it, of any capture."""
    return any(one.capture.overrules("late_column", "tau") for one in fit.prepared)


def _found(fit: Fit) -> Finding | None:
    effect = next((one for one in _BOTH if _fitted(fit.core, one) and _sure(fit, fit.core, one)), None)
    core = fit.core if effect else fit.delayed
    if core is None:
        return None
    here = effect is not None
    effect = effect or next(one for one in _BOTH if _fitted(core, one))
    samples = sum(one.capture.samples for one in fit.prepared)
    after = "before the motion that it makes, as a command does"
    found = said(
        "{tau}: stands {ms:.3g} ms {where}",
        ms=1e3 * _delay(core, effect),
        where=after if effect == _AHEAD else "after the motion that it makes",
    )
    named = OfEffect(effect)
    if here:
        found = said("{found}: {effect} is fitted with the rest", found=found, effect=named)
        return Finding("late_column", "tau", samples, (), found, "mended")
    found = said(
        "{found}; that takes {fall:.2g} % off the error and moves what was fitted: add {effect}",
        found=found,
        fall=100.0 * (1.0 - core.rmse / fit.rmse),
        effect=named,
    )
    return Finding("late_column", "tau", samples, (), found, "warning")


@cache
def _times(effect: str) -> tuple[str, ...]:
    """Return the parameters of an effect that are times."""
    return tuple(f"{effect}.{one.name}" for one in catalogued(effect).params if one.unit == "s")


def _fitted(core: _core.Fit, effect: str) -> bool:
    return any(name in core.free for name in _times(effect))


def _sure(fit: Fit, core: _core.Fit, effect: str) -> bool:
    """Whether a fit with a delay leaves nothing but noise, and has one that can be told from none."""
    told = _delay(core, effect) * min(one.capture.rate_hz for one in fit.prepared) >= _ROWS
    return told and core.rmse <= RULE.at_floor * fit.noise_floor


def _delay(core: _core.Fit, effect: str) -> float:
    """Return by how much a torque is off, s: a lag moves it by its time constant."""
    return sum(value for name, value, *_ in core.model.rows() if name in _times(effect))
