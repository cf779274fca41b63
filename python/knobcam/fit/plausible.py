"""Whether the values that an effect was fitted with can be its own, or it stands in for another."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from .. import _core
from ..base.arrays import FloatArray
from ..base.said import Advice, OfColumn, OfEffect, OfParam, Quantity, Said, joined, number, said
from ..model.effects import base_effects, base_effects_shown, effects
from .knocked import of_knocks_alone
from .power import gives_back
from .refit import cores
from .rule import RULE
from .uncounted import ramped

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from ..capture.prepare import Prepared
    from .diagnose import Candidate
    from .estimate import Estimate
    from .fitting import Fit

_FAULTS = ("unit", "sign", "contradiction", "swapped")
"""Findings with which, unless they were mended, no model of a log is one of the knob."""

_ONCE = 1.5  # detents a turn, of which a whole number that is not one is two at least
_ASTRAY = 0.2  # of an angle's readings that contradict the others, from which on it is no angle of one motion
_STRAIGHT = 1e-3
"""A position this near to a straight line over time, of its range, has one velocity."""


_MANY = 10.0
"""Times the measured torque, RMS, that no term makes of which nobody knows whether it is there."""

_DRAWS = 200  # refits that tell what parameters have in common to a twentieth of its error


def implausible(candidate: Candidate, before: Fit) -> tuple[Said, ...]:
    """Return what is implausible about the values of a candidate, a sentence each."""
    fit = candidate.fit
    return (
        *_once_a_turn(candidate.effect, fit),
        *_out_of_range(candidate.effect, fit),
        *_below_zero(candidate, before),
        *_pushed_out(candidate, before),
        *_unseen(fit, before),
        *filtered_off(candidate.effect, fit),
        *of_knocks_alone(candidate, before),
        *_not_its_own(candidate.effect, fit, first=before.before is None),
    )


def stands_in(effect: str, fit: Fit) -> tuple[Said, ...]:
    """Return what is implausible about the values that an effect has beside all that came in after it."""
    return (*_out_of_range(effect, fit), *_not_its_own(effect, fit, first=True))


def _not_its_own(effect: str, fit: Fit, *, first: bool) -> list[Said]:
    """Return what an effect says of its values: `first` does not ask whether others explain it before."""
    clipped = any(finding.kind == "clipped" for one in fit.prepared for finding in one.capture.findings)
    own = _core.implausible(cores(fit), fit.core, effect, clipped, first)
    return [said(one, **{effect: OfEffect(effect) for effect in fit.model.catalogue()}) for one in own]


OTHER_SIGN = said("{tau} has the other sign: inertia and friction came out negative")
MINUS = Advice("map it with a minus", "minus")
REVERSED = joined("; ", (OTHER_SIGN, MINUS))


def reversed_torque(fit: Fit) -> bool:
    """Whether what no knob has below zero is so, all of it beyond doubt: the torque has the other sign.

    An offset or a drift may take friction from one direction to the other, and a spring inertia below zero;
    but over a whole motion no friction gives power back. Beside a spring that is far stronger neither may
    show in the model without it: there any torque of position is allowed for. Of a torque that is a line over
    time a drift takes all, and friction gives back what it has too much.
    """
    told = [fit.params[name] for name in _never_negative(fit.model.coordinate) if name in fit.params]
    if not any(estimate.value < 0.0 for estimate in told) or ramped(fit.prepared):
        return False
    sure = [estimate for estimate in told if estimate.determined]
    beyond = any(e.ci95[1] < 0.0 for e in sure) and not any(e.ci95[0] > 0.0 for e in sure)
    power, error = _friction_power(fit) if beyond else (0.0, 0.0)
    if power + RULE.surely * error < 0.0:
        return True
    return gives_back(fit.prepared)


def impossible(fit: Fit) -> str | None:
    """Return what of a model no knob has, beyond doubt, so that it is not the knob's however small its error.

    That is an inertia below zero, friction that gives power back over the whole motion, a term that another
    takes away, or an effect beside these that ended out of its range. An offset takes the friction of one
    direction below zero, and what falls with the speed a viscous term: these are left alone.
    """
    base = base_effects(fit.model.coordinate)
    beside = [one for one in fit.model.effects if one not in base]
    if outside := [why for one in beside for why in _out_of_range(one, fit)]:
        return outside[0]
    told = {name: fit.params[name] for name in _never_negative(fit.model.coordinate) if name in fit.params}
    if (name := _taken_away(told, fit)) is not None:
        return f"{name} makes many times the torque that was measured, which others take away again"
    negative = [name for name, e in told.items() if e.determined and e.value + RULE.surely * e.se < 0.0]
    rubs = _friction(fit.model.coordinate)
    # What makes less torque than is left is bent by that: a motion that hardly speeds up says nothing of it.
    stores = [name for name in negative if name.split(".")[0] not in rubs and torque_of(fit, name) > fit.rmse]
    if stores:
        return f"{' and '.join(stores)} came out negative, which no knob has"
    return friction_drives(fit)


def friction_drives(fit: Fit) -> str | None:
    """Return that friction of the base model gives power back over the whole motion, beyond doubt."""
    told = {name: e for name, e in fit.params.items() if name in _never_negative(fit.model.coordinate)}
    if not any(e.determined and e.value + RULE.surely * e.se < 0.0 for e in told.values()):
        return None
    power, error = _friction_power(fit)
    return "friction gives power back, which no knob does" if power + RULE.surely * error < 0.0 else None


def _taken_away(told: Mapping[str, Estimate], fit: Fit) -> str | None:
    """Return a parameter that is as large as may be, because others make up for it.

    Of an effect that has one for each direction, what these have in common: by how much they differ is an
    offset, which a zero that drifts as slowly as one likes may take away, and friction is told all the same.
    """
    unknown = [
        name
        for name, e in told.items()
        if e.determined and abs(e.value) < RULE.sure * e.se and not _told_in_common(name, told, fit)
    ]
    if not unknown:
        return None
    squares = np.concatenate([np.square(one.tau[one.used]) for one in fit.prepared])
    most = _MANY * float(np.sqrt(np.mean(squares)))
    return next((name for name in unknown if torque_of(fit, name) > most), None)


def _told_in_common(name: str, told: Mapping[str, Estimate], fit: Fit) -> bool:
    """Whether the mean of the parameters of an effect is known, though one of them is not."""
    known = _in_common(name, told, fit)
    return known is not None and abs(known[0]) >= RULE.sure * known[1]


def _in_common(name: str, told: Mapping[str, Estimate], fit: Fit) -> tuple[float, float] | None:
    """Return the mean of the parameters of an effect, of which a name is one, and its standard error.

    None where one of them is not determined.
    """
    names = [other for other in told if other.split(".")[0] == name.split(".")[0]]
    if not all(told[other].determined for other in names):
        return None
    if len(names) == 1:
        return told[name].value, told[name].se
    # From their covariance, where they make up for each other, nothing of it would be left but rounding.
    draws = fit.bootstrap(_DRAWS)
    mean = np.mean([draws[other] for other in names], axis=0)
    return float(np.mean([told[other].value for other in names])), float(np.std(mean))


def _friction(coordinate: str) -> list[str]:
    """Return the effects of the base model that rub."""
    return [one.id for one in effects(coordinate).values() if one.base and one.friction]


def _friction_power(fit: Fit) -> tuple[float, float]:
    """Return what friction of the base model takes, and its standard error, N m rad/s on average.

    Less what a constant torque makes of a motion that ends elsewhere: that is an offset, and no friction.
    """
    rubs = _friction(fit.model.coordinate)
    told = [(name, e) for name, e in fit.params.items() if name.split(".")[0] in rubs]
    names = [name for name, estimate in told if estimate.determined and estimate.value != 0.0]
    omega = np.concatenate([np.where(one.used, one.omega, 0.0) for one in fit.prepared])
    takes = np.array([float(np.nanmean(_without_constant(_of(fit, name), omega) * omega)) for name in names])
    se = np.array([fit.params[name].se for name in names])
    power = takes.sum()
    slopes = takes / np.array([fit.params[name].value for name in names])
    joint = np.array([[fit.correlation[a][b] for b in names] for a in names]).reshape(len(names), len(names))
    return float(power), float(np.sqrt(max((slopes * se) @ joint @ (slopes * se), 0.0)))


def _without_constant(torque: FloatArray, omega: FloatArray) -> FloatArray:
    """Return a torque less what is the same forward and backward in it, where it goes both ways."""
    known = np.isfinite(torque)  # not where a gap's edge is all that went this way
    ways = (known & (omega > 0.0), known & (omega < 0.0))
    means = [float(np.mean(torque[way])) for way in ways if way.any()]
    return torque - np.mean(means) if len(means) > 1 else torque


def log_fault(fit: Fit) -> Said | None:
    """Return what is wrong with the log, so that no model of it is one of the knob; None where nothing is."""
    return REVERSED if reversed_torque(fit) else columns_at_fault(fit.prepared)


def columns_at_fault(prepared: Sequence[Prepared]) -> Said | None:
    """Return what is wrong with the columns of a log, whatever the model; None where nothing is."""
    found = (finding for one in prepared for finding in one.capture.findings)
    wrong = next((one.message for one in found if one.kind in _FAULTS and one.severity == "warning"), None)
    return wrong or next(filter(None, map(_several, prepared)), None)


def _several(one: Prepared) -> Said | None:
    """Return that an angle is of no one motion; None where it is."""
    astray = [
        finding.count for finding in one.findings if (finding.kind, finding.column) == ("spike", "theta")
    ]
    if sum(astray) < _ASTRAY * one.capture.samples:
        return None
    return said(
        "{theta}: {count} of {all} readings are of no motion beside the others, as where a log holds several "
        "runs or joints; split it (--start, --end), or map another column",
        theta=OfColumn("theta"),
        count=sum(astray),
        all=one.capture.samples,
    )


def one_velocity(prepared: Sequence[Prepared]) -> str | None:
    """Return that a motion goes at one velocity, which tells nothing; None where it does not."""
    for one in prepared:
        capture = one.capture
        t, theta = capture.t[capture.mask], capture.theta[capture.mask]
        if len(t) < 3:
            return None
        slope, start = np.polyfit(t - t[0], theta, 1)
        if np.ptp(theta - slope * (t - t[0]) - start) <= _STRAIGHT * np.ptp(theta):
            unit = capture.units["omega"]
            return f"theta moves at one velocity, {slope:.3g} {unit}; record a motion that changes its speed"
    return None


def _unseen(fit: Fit, before: Fit) -> list[Said]:
    """Return that an effect loses on blocks that the fit did not see no less than it wins on the others."""
    if not (before.rmse > 0.0 and before.rmse_heldout > 0.0):
        return []
    won, lost = 1.0 - fit.rmse / before.rmse, fit.rmse_heldout / before.rmse_heldout - 1.0
    adds = said("on blocks that the fit did not see it adds {lost}", lost=number(100.0 * lost, "%", ".1f"))
    return [adds] if lost > max(won, 0.0) else []


def filtered_off(effect: str, fit: Fit) -> list[Said]:
    """Return that the filter takes off most of the torque that an effect makes as the position changes.

    Its waves come faster than the filter lets pass wherever the motion is not slow; of what it says of them
    there, which is most of it, nobody has seen anything.
    """
    row = fit.model.catalogue()[effect]
    if row.place != "load" or row.over not in ("position", "several"):
        return []
    bare = fit.model.core.only([one for one in fit.model.effects if one != effect])
    passed, made = 0.0, 0.0
    for one in fit.prepared:
        seen, whole = (
            fit.model.core.torque(one.core, filtered) - bare.torque(one.core, filtered)
            for filtered in (True, False)
        )
        passed += float(np.nansum(np.square(seen[one.used])))
        made += float(np.nansum(np.square(whole[one.used])))
    if passed >= (1.0 - RULE.mainly) * made:
        return []
    share = number(100.0 * (1.0 - passed / made), "%", ".0f")
    return [said("the torque filter takes off {share} of what it would make, by its squares", share=share)]


def _out_of_range(effect: str, fit: Fit) -> list[Said]:
    found = []
    for row in fit.model.catalogue()[effect].params:
        name = f"{effect}.{row.name}"
        estimate = fit.params.get(name)
        if estimate is None:
            continue  # it says nothing at present
        if any(math.isclose(estimate.value, bound, rel_tol=1e-6) for bound in (row.lower, row.upper)):
            estimate = estimate._replace(se=0.0)  # where the search was stopped there is no doubt
        why = out_of_range(estimate, row.plausible)
        found += [] if why is None else [said("{param} = {why}", param=OfParam(name), why=why)]
    return found


def out_of_range(estimate: Estimate, plausible: tuple[float, float]) -> Said | None:
    """Return what is implausible about a value, if it surely is out of its range; numbers have their unit."""
    low, high = plausible
    margin = RULE.sure * estimate.se if estimate.determined else 0.0
    if low <= estimate.value + margin and estimate.value - margin <= high:
        return None
    words = "at least {low}" if math.isinf(high) else "{low} to {high}"
    ends = {"low": _with_unit(low, estimate.unit, "g"), "high": _with_unit(high, estimate.unit, "g")}
    value = _with_unit(estimate.value, estimate.unit, ".3g")
    return said("{value} is implausible: it should be {limits}", value=value, limits=said(words, **ends))


def _with_unit(value: float, unit: str, spec: str) -> Quantity | str:
    return format(value, spec) if value == 0.0 or unit == "1" else number(value, unit, spec)


def _pushed_out(candidate: Candidate, before: Fit) -> list[Said]:
    """Return what came in before and ends out of its range beside it, where it was not."""
    base, there = base_effects(before.model.coordinate), candidate.fit.model.effects
    came = [one for one in before.model.effects if one not in base and one in there]
    fine = [one for one in came if not _out_of_range(one, before)]
    return [Said("beside it ", why) for one in fine for why in _out_of_range(one, candidate.fit)]


def _below_zero(candidate: Candidate, before: Fit) -> list[Said]:
    """Return what it bends below zero that was not before."""
    found = []
    never = _never_negative(candidate.fit.model.coordinate)
    told = {name: e for name, e in candidate.fit.params.items() if name in never}
    for name in told:
        now, then = told[name], before.params.get(name)
        if then is None or not (now.determined and then.determined):
            continue
        bent = now.value + RULE.sure * now.se < min(0.0, then.value - RULE.sure * then.se)
        # What makes less torque than remains unexplained is bent by that, one direction alone by an offset.
        if bent and torque_of(candidate.fit, name) > candidate.rmse:
            common = None if now.unit == per_speed(candidate.fit) else _in_common(name, told, candidate.fit)
            if common is not None and common[0] + RULE.sure * common[1] >= 0.0:
                continue
            what = f"{now.value:.3g}"
            found.append(
                said("beside it {param} = {what}, which no knob has", param=OfParam(name), what=what)
            )
    return found


def _once_a_turn(effect: str, fit: Fit) -> list[Said]:
    """Return that detents return once a turn or less: of whole numbers in a turn that is gravity's own."""
    period, rotary = fit.model.period, fit.model.coordinate == "rotary"
    if not rotary or period is None or effect not in base_effects_shown(fit.model.coordinate):
        return []
    times = 1.0 / abs(period)
    if times > _ONCE:
        return []
    often = f"{times:.2g} times"
    often = "once" if often == "1 times" else often
    return [said(f"it returns {often} a turn, as an unbalance does and no detents do")]


def per_speed(fit: Fit) -> str:
    """Return the unit of friction in proportion to the speed."""
    return f"{fit.torque_unit} s/{'rad' if fit.model.coordinate == 'rotary' else 'm'}"


def torque_of(fit: Fit, name: str) -> float:
    """Return the RMS torque that a parameter makes, N m."""
    return float(np.sqrt(np.nanmean(np.square(_of(fit, name)))))


def _of(fit: Fit, name: str) -> FloatArray:
    """Return the torque that a parameter makes, N m, the captures one after the other."""
    without = fit.model.with_value(name, 0.0).core
    return np.concatenate([fit.model.core.torque(one) - without.torque(one) for one in cores(fit)])


def _never_negative(coordinate: str) -> list[str]:
    """Return the parameters of the base model that no knob has below zero."""
    base = [one for one in effects(coordinate).values() if one.base is not None]
    return [f"{one.id}.{row.name}" for one in base for row in one.params if row.plausible[0] == 0.0]
