"""A torque that stands in the log before the motion that it makes, as a command does."""

from __future__ import annotations

from typing import TYPE_CHECKING

from .. import _core
from ..capture.finding import Finding
from .rule import RULE

if TYPE_CHECKING:
    from .fitting import Fit

_EFFECT = "actuation_delay"
_NOTICED = 1.02  # times the noise floor, below which a delay is not looked for: it takes its time
_ROWS = 0.6  # below which nobody can tell a delay from how a derivative is taken


def ahead(fit: Fit) -> Finding | None:
    """Return the finding that the torque of a fit is ahead of its motion; None where nothing says so.

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
    every = [one.core for one in fit.prepared]
    ((_, core, gain, _, p_value, _),) = _core.diagnose(every, fit.model.core, [_EFFECT], None)
    if core is None or p_value > RULE.rare or gain < RULE.price or core.rmse > RULE.at_floor * floor:
        return None
    delay = next(value for name, value, *_ in core.model.rows() if name.startswith(_EFFECT))
    if delay * min(one.capture.rate_hz for one in fit.prepared) < _ROWS:
        return None
    samples = sum(one.capture.samples for one in fit.prepared)
    message = (
        f"tau: stands {1e3 * delay:.3g} ms before the motion that it makes, as a command does; that takes "
        f"{100.0 * (1.0 - core.rmse / fit.rmse):.2g} % off the error and moves what was fitted: add {_EFFECT}"
    )
    return Finding("late_column", "tau", samples, (), message, "warning")
