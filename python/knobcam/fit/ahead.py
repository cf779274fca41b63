"""A torque that stands in the log before the motion that it makes, as a command does."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

from .. import _core
from ..capture.finding import Finding
from . import refit
from .rule import RULE

if TYPE_CHECKING:
    from .fitting import Fit

_EFFECT, _DELAY = "actuation_delay", "actuation_delay.delay"
_NOTICED = 1.02  # times the noise floor, below which a delay is not looked for: it takes its time
_ROWS = 0.6  # below which nobody can tell a delay from how a derivative is taken


def delayed(fit: Fit) -> _core.Fit | None:
    """Return the sketch of a fit with the delay beside it, where that is beyond doubt; None where it is not.

    Only where the delay explains all that the model leaves beyond noise: what else is missing may look like
    a delay, and is for the diagnosis to tell. Nor beside a joint or a sensor's lag, where it was looked for.
    """
    catalogue, floor = fit.model.catalogue(), fit.noise_floor
    have = fit.model.effects
    late = catalogue[_EFFECT].taken_up
    known = late is not None and any(name in fit.model.params for name in late.by)
    joined = any(catalogue[one].place == "coupling" for one in have)
    # Not where a floor is unknown either.
    if fit.before or known or joined or _EFFECT in have or not fit.rmse > _NOTICED * floor:
        return None
    ((_, core, gain, _, p_value, _),) = _core.diagnose(refit.cores(fit), fit.model.core, [_EFFECT], None)
    if core is None or p_value > RULE.rare or gain < RULE.price or not _sure(fit, core):
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
    """Return the finding that the torque of a fit is ahead of its motion; None where nothing says so.

    It is mended where the delay is fitted with the rest, and a note where a person has overruled it.
    """
    found = _found(fit)
    return found.over() if found and overruled(fit) else found


def overruled(fit: Fit) -> bool:
    """Whether a person has overruled it, of any capture."""
    return any(one.capture.overrules("late_column", "tau") for one in fit.prepared)


def _found(fit: Fit) -> Finding | None:
    here = _DELAY in fit.core.free and _sure(fit, fit.core)
    core = fit.core if here else fit.delayed
    if core is None:
        return None
    samples = sum(one.capture.samples for one in fit.prepared)
    message = f"tau: stands {1e3 * _delay(core):.3g} ms before the motion that it makes, as a command does"
    if here:
        return Finding(
            "late_column", "tau", samples, (), f"{message}: {_EFFECT} is fitted with the rest", "mended"
        )
    fall = 100.0 * (1.0 - core.rmse / fit.rmse)
    message += f"; that takes {fall:.2g} % off the error and moves what was fitted: add {_EFFECT}"
    return Finding("late_column", "tau", samples, (), message, "warning")


def _sure(fit: Fit, core: _core.Fit) -> bool:
    """Whether a fit with a delay leaves nothing but noise, and has one that can be told from none."""
    told = _delay(core) * min(one.capture.rate_hz for one in fit.prepared) >= _ROWS
    return told and core.rmse <= RULE.at_floor * fit.noise_floor


def _delay(core: _core.Fit) -> float:
    return next(value for name, value, *_ in core.model.rows() if name == _DELAY)
