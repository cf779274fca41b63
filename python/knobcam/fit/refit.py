"""A fit with one effect more: what it is asked of, and what it changes."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import TYPE_CHECKING, Any, NamedTuple

from .. import _core
from ..base.door import checked
from ..base.tables import text_table
from ..capture.prepare import prepare
from ..errors import InputError
from ..model.effects import effect as catalogued
from .rule import RULE

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Mapping

    from ..base import pages
    from ..capture.prepare import Prepared
    from ..model import Model
    from .fitting import Fit


_ROUNDING = 1e-9  # of an error
_BEGINNINGS = 2  # rounds of where a knob begins and what its model is; more change next to nothing


class Moved(NamedTuple):
    """How far a parameter went: in standard errors of its new value, in percent of its old one, in its unit.

    A phase has no percent (NaN): its zero is a value like any other. It went the shorter way round.
    """

    by_se: float
    by_percent: float
    by: float

    @property
    def sizeless(self) -> bool:
        """Whether there is nothing to take percent of: a phase, or what was zero before."""
        return math.isnan(self.by_percent)

    def in_words(self, unit: str) -> str:
        """How much of its old value that is; of what has no size to compare with, how much in its unit."""
        return f"by {self.by:+.3g} {unit}" if self.sizeless else f"{self.by_percent:+.3g} %"


@checked
def add(
    fit: Fit,
    effect: str,
    progress: Callable[[float], object] | None = None,
    start: Mapping[str, float] | None = None,
) -> Fit:
    """Return the fit of the same captures with one effect more, every free parameter fitted anew.

    `start` has values of its parameters to set out from in place of those of its own search. `progress` is
    asked from time to time; what it raises ends the work. Raises InputError for an effect that the model has
    already, that the catalogue does not have, or that cannot be fitted beside this model.
    """
    check(effect, fit.model)
    fit.model.with_effect(effect)  # says why not, if it does not go with the model
    fit = with_clipped(fit) if catalogued(effect, fit.model.coordinate).clips else fit
    if start:
        return converged(begun(started(fit, effect, start)))
    (_, core, _, _, _, note), *_ = _core.diagnose(cores(fit), fit.model.core, [effect], progress)
    if core is None:
        raise InputError(f"effect '{effect}': {note}")
    return converged(begun(replace(fit, core=core, before=fit)))


def started(fit: Fit, effect: str, start: Mapping[str, float], within: float = math.inf) -> Fit:
    """Return the fit with one effect more, its parameters started from these values; not converged yet.

    Given up where an RMS error `within` that, N m, seems out of reach.
    """
    model = fit.model.with_effect(effect)
    for name, value in start.items():
        model = model.with_value(f"{effect}.{name}", value)
    return replace(fit, core=_core.refine(cores(fit), model.core, False, within), before=fit)


def cores(fit: Fit) -> list[_core.Signals]:
    """Return the prepared signals of all captures as the core has them."""
    return [one.core for one in fit.prepared]


def converged(fit: Fit) -> Fit:
    """Return a fit that was sketched, followed to its optimum."""
    core = _core.refine(cores(fit), fit.core.model, True)
    better = core.rmse <= fit.core.rmse or len(core.free) < len(fit.core.free)
    return replace(fit, core=core if better else fit.core)


@checked
def drop(fit: Fit, effect: str) -> Fit:
    """Return the fit without an effect, and without those that change it; the rest fitted anew from there.

    Raises InputError for an effect that the model does not have, or that is its only one.
    """
    if effect not in fit.model.effects:
        raise InputError(f"effect '{effect}' is not in the model, which has {', '.join(fit.model.effects)}")
    catalogue = fit.model.catalogue()
    kept = [one for one in fit.model.effects if one != effect and catalogue[one].needs != effect]
    if not kept:
        raise InputError(f"effect '{effect}' is all that the model has; add another one first")
    model = fit.core.model.only(kept)
    return replace(fit, core=_core.refine(cores(fit), model, False), before=fit)


def with_clipped(fit: Fit) -> Fit:
    """Return the fit with the samples counted at which the torque sensor was at its limit.

    They are left out of a fit as a rule, since only an effect that clips can predict them.
    """
    if not any(one.capture.clipped for one in fit.prepared):
        return fit
    return on(fit, (prepare(one.capture.with_clipped(), one.method, **one.options) for one in fit.prepared))


def on(fit: Fit, prepared: Iterable[Prepared]) -> Fit:
    """Return the fit of the same captures of which other samples count."""
    fit = replace(fit, prepared=tuple(prepared))
    return replace(fit, core=_core.refine(cores(fit), fit.core.model, True))


def begun(fit: Fit) -> Fit:
    """Return a fit whose knob begins as the first torques say: behind its joint, and which way bent.

    The same where they say nothing new, and where nothing of the model depends on it.
    """
    for _ in range(_BEGINNINGS):
        found = [fit.core.model.begun(one.core, max(fit.rmse, fit.noise_floor)) for one in fit.prepared]
        if not any(found):
            break
        parts = zip(fit.prepared, found, strict=True)
        fit = on(fit, (replace(one, core=core or one.core) for one, core in parts))
    return fit


def check(effect: str, model: Model) -> None:
    """Raise InputError for an effect that a model cannot be given."""
    catalogued(effect, model.coordinate)
    if effect in model.effects:
        raise InputError(f"effect '{effect}' is in the model already, which has {', '.join(model.effects)}")


def added(fit: Fit) -> tuple[str, ...]:
    """Return the effects that a fit has and the one before it has not."""
    before = fit.before.model.effects if fit.before else fit.model.effects
    return tuple(effect for effect in fit.model.effects if effect not in before)


def error_fall(before: Fit, after: Fit) -> float:
    """Return the part of the RMS error that is gone; negative where it grew."""
    return 1.0 - after.rmse / before.rmse if before.rmse > 0.0 else 0.0


def unpaid(fit: Fit, bare: Fit, noise: Fit | None = None) -> bool:
    """Whether a fit takes off no more than the price of the parameters that a barer one lacks.

    Held against its own noise, or against that of a third fit.
    """
    return paid(fit, bare, noise or fit) <= 0.0


def paid(fit: Fit, bare: Fit, noise: Fit) -> float:
    """Return what a fit takes off more than a barer one, less the price of the parameters that this lacks."""
    return gain(bare, fit, noise) - RULE.price * (len(fit.core.free) - len(bare.core.free))


def gain(before: Fit, after: Fit, noise: Fit) -> float:
    """Return the fall of the sum of squares in variances of the raw noise that a third fit left."""
    return (before.rmse**2 - after.rmse**2) / noise.noise_floor**2 * noise.white_squares


def needless(fit: Fit, bare: Fit) -> bool:
    """Whether a barer fit leaves no more than what the effects that it lacks have to be worth."""
    return unpaid(fit, bare) or fit.rmse**2 >= (1.0 - RULE.worth) * bare.rmse**2


def needed(fit: Fit, effect: str, bare: Fit | None = None) -> bool:
    """Whether an effect is worth so much that no fit without it has to be followed to its end.

    By first order alone, or by a sketch of the fit without it.
    """
    if not fit.noise_floor > 0.0:
        return False
    count = sum(name.startswith(f"{effect}.") for name in fit.core.free)
    share = fit.white_squares * RULE.worth / (1.0 - RULE.worth)
    worth = fit.core.worth(effect) if bare is None else gain(bare, fit, fit)
    return worth > RULE.needed * max(RULE.price * count, share)


def worse(fit: Fit) -> tuple[str, ...]:
    """Return why a fit is no better than the one that it came from, a sentence each; none where it is."""
    before = fit.before
    if before is None:
        return ()
    unit, said = fit.torque_unit, []
    was, now = before.rmse_heldout, fit.rmse_heldout
    if now > was * (1.0 + _ROUNDING):
        rise = percent(now / was - 1.0) if was > 0.0 else "from none"
        said.append(f"the error on unseen blocks rose from {was:.4g} to {now:.4g} {unit} ({rise})")
    if fit.rmse >= before.rmse * (1.0 - _ROUNDING):
        said.append("the error that it was fitted to did not fall")
        return tuple(said)
    # Held against the noise that `diagnose` holds it against: that of the fit before.
    if before.noise_floor > 0.0 and unpaid(fit, before, before):
        count = len(fit.core.free) - len(before.core.free)
        more = "another parameter" if count == 1 else f"{count} more parameters"
        said.append(f"the error fell by no more than chance takes off with {more}")
    return tuple(said)


def moved(before: Fit, after: Fit) -> dict[str, Moved]:
    """Return how far the parameters went that both fits determine."""
    both = {}
    phases = after.model.phases
    for name, new in after.params.items():
        old = before.params.get(name)
        if old is None or not (old.determined and new.determined) or new.se == 0.0:
            continue
        step = new.value - old.value
        if name in phases:
            step = math.remainder(step, 2.0 * math.pi)
        sized = old.value != 0.0 and name not in phases
        percent = 100.0 * step / abs(old.value) if sized else math.nan
        both[name] = Moved(step / new.se, percent, step)
    return both


def describe(moves: Mapping[str, Moved]) -> dict[str, pages.Movement]:
    """Return movements as a document has them."""
    return {
        name: {"by_se": move.by_se, "by_percent": move.by_percent, "by": move.by}
        for name, move in moves.items()
    }


def document(fit: Fit) -> dict[str, Any]:
    """Return the JSON document of `knobcam add --json`: the fit, and what was before it."""
    known: dict[str, Any] = {"added": list(added(fit)), "error_fall": fit.error_fall}
    if fit.before is not None:
        known["before"] = {"rmse": fit.before.rmse, "rmse_heldout": fit.before.rmse_heldout}
        why = worse(fit)
        known |= {"worse": bool(why), "why_worse": list(why)}
    return fit.document() | {"schema": "knobcam.add/1", **known, "moved": describe(fit.moved)}


def in_words(fit: Fit) -> str:
    """Return in words what adding did to the error and to the parameters that were there before."""
    if fit.before is None:
        return ""
    unit = fit.torque_unit
    change = f"{fit.before.rmse:.4g} to {fit.rmse:.4g} {unit} ({percent(-fit.error_fall)})"
    lines = [f"With {', '.join(added(fit))}: RMS error from {change}."]
    if why := worse(fit):
        lines.append(f"That made things no better: {', and '.join(why)}.")
    if fit.moved:
        rows = [(name, f"{m.by_se:+.3g}", m.in_words(fit.params[name].unit)) for name, m in fit.moved.items()]
        lines.append(text_table(("parameter", "moved by (standard errors)", "of its old value"), rows))
    return "\n".join(lines)


def percent(share: float) -> str:
    """Return a change in percent with its sign."""
    return f"{round(100.0 * share, 1) + 0.0:+.1f} %"  # adding zero takes the sign off a zero
