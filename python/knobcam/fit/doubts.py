"""What makes the values of a fit doubtful, though it converged."""

from __future__ import annotations

import math
import re
from typing import TYPE_CHECKING

import numpy as np

from .. import _core
from ..base.said import OfParam, Said, said
from ..capture.formats.units import VOLTAGES
from ..model.effects import base_effects
from .plausible import REVERSED, per_speed, torque_of
from .uncounted import tells_nothing

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from ..capture.prepare import Prepared
    from ..model.effects import Effect
    from .estimate import Estimate
    from .fitting import Fit


_SHARE = {0.0, 1.0}
"""Bounds of a share, none and all of it, which are as likely as any other."""


_PLACE = re.compile("phase|rest angle|rest position|stop begins|border|end of the range")


def unsettled(effect: Effect, estimates: Mapping[str, Estimate]) -> str:
    """Return which values of an effect its captures do not determine, where that is most of them.

    That is a value whose interval holds zero: as much as nothing of it.
    """
    own = {name.partition(".")[2]: one for name, one in estimates.items() if not one.held}
    sizes = [name for name in own if _is_size(effect, name)]
    unknown = [name for name in sizes if not own[name].determined or may_be_nothing(effect, name, own[name])]
    if not unknown or 2 * len(unknown) <= len(sizes):
        return ""
    if len(unknown) == len(sizes):
        return "none of its values is determined: each may be nothing as well"
    are = "is" if len(unknown) == 1 else "are"
    return f"{len(unknown)} of its {len(sizes)} values {are} not determined, and may be nothing as well"


def may_be_nothing(effect: Effect, name: str, estimate: Estimate) -> bool:
    """Whether the interval of an effect's parameter holds zero, as much as nothing of it."""
    known = estimate.determined and not estimate.held
    return known and _is_size(effect, name) and estimate.ci95[0] <= 0.0 <= estimate.ci95[1]


def _is_size(effect: Effect, name: str) -> bool:
    """Of a phase or a place zero is a value like any other."""
    return not _PLACE.search(effect.parameter(name).meaning)


def at_floor(fit: Fit) -> bool:
    """Whether an error is no different from what noise alone would leave; false where that is not known."""
    return fit.noise_floor > 0.0 and fit.rmse <= _core.at_floor(fit.white_squares) * fit.noise_floor


def doubts(fit: Fit) -> tuple[str, ...]:
    """Return what makes the values of a fit doubtful, a sentence each."""
    negative = below_zero(fit)
    found: list[str]
    if fit.log_fault == REVERSED:
        found = [REVERSED]
    else:
        words = "{name} is negative, which no real knob has: {why}"
        found = [said(words, name=OfParam(name), why=_in_place_of(fit, name)) for name in negative]
    alike = [signals for signals in fit.prepared if _moves_like_a_spring(signals)]
    if alike and len(alike) == len(fit.prepared) and fit.model.core.at_rest()[0] != 0.0:
        found.append(
            "position and acceleration move together, so inertia cannot be told from a stiffness over "
            "position: record a motion of more than one frequency"
        )
    lost = tells_nothing(fit.prepared)
    found += [lost] if lost is not None else []
    found += [fit.ahead.message] if fit.ahead and fit.ahead.severity == "warning" else []
    if astray(fit):
        found.append("detent.P came out at less than one detent a turn, which is none: start without detents")
    return (*found, *_at_bounds(fit), *_back_emf(fit))


def said_once(warnings: Sequence[str]) -> list[str]:
    """Return warnings of which those that say the same of another parameter name that alone."""
    told: list[str] = []
    known: set[str] = set()
    for warning in warnings:
        first, *rest = warning.parts if isinstance(warning, Said) else (warning,)
        same = "".join(map(str, rest))
        alike = isinstance(first, OfParam) and same in known
        told.append(said("so is {param}", param=first) if alike else warning)
        known.add(same)
    return told


def _in_place_of(fit: Fit, name: str) -> str:
    """Return why a parameter of the base model came out negative."""
    if not at_floor(fit):
        return "an effect is probably missing"
    if fit.params[name].unit == per_speed(fit):
        what = "friction that falls with speed does"
    elif fit.model.catalogue()[name.split(".", 1)[0]].friction:
        what = "an offset does, or drag that grows faster than the speed"
    else:
        what = "the pull of a spring or a detent does"
    return f"over this motion it stands for something else, as {what}"


def astray(fit: Fit) -> bool:
    """Whether detents return less than once a turn: a term that went to where something else is."""
    period = fit.model.period
    return fit.model.coordinate == "rotary" and period is not None and abs(period) > 1.0


def below_zero(fit: Fit) -> list[str]:
    """Return the parameters of the base model that came out negative beyond doubt."""
    return [name for name, e in _of_base(fit).items() if e.determined and e.ci95[1] < 0.0]


def log_in_doubt(fit: Fit) -> str | None:
    """Return what no knob has, of more torque than is left, so that the log may be wrong; else None.

    What makes less torque than is left is bent by that, whatever it is; of one that has a value for each
    direction an offset may take one of them below zero, and friction that falls with the speed a viscous one.
    """
    own = {name: e for name, e in _of_base(fit).items() if e.unit != per_speed(fit)}

    def in_common(name: str) -> float:
        return sum(e.value for other, e in own.items() if other.split(".")[0] == name.split(".")[0])

    below = [name for name in below_zero(fit) if name in own and in_common(name) < 0.0]
    negative = [name for name in below if torque_of(fit, name) > fit.rmse]
    if not negative:
        return None
    return (
        f"{' and '.join(negative)} came out negative, which no knob has, so that the log, not an effect, "
        "may be what is wrong: look for other units or signs, columns of different times, "
        "a motor that was off"
    )


def _of_base(fit: Fit) -> dict[str, Estimate]:
    base = base_effects(fit.model.coordinate)
    return {name: e for name, e in fit.params.items() if name.split(".", 1)[0] in base}


def _back_emf(fit: Fit) -> list[str]:
    """What is said of friction in proportion to the speed where the torque is what drives the current."""
    own = _of_base(fit)
    names = [name for name, e in own.items() if e.unit == per_speed(fit)]
    if fit.torque_unit not in VOLTAGES or not names or fit.constants:
        return []
    read = "voltage" if fit.torque_unit == "V" else "duty cycle"
    what = f"hold the motor's back-EMF beside its friction, unless the {read} commands a current"
    way = (
        "kt and the resistance" if fit.torque_unit == "V" else "in V (tau=duty*SUPPLY), kt and the resistance"
    )
    return [f"{' and '.join(names)} {what}: {way} tell them apart"]


def at_bounds(fit: Fit) -> dict[str, float]:
    """Return the parameters that the search ended at a bound of; at a neutral one there is just none of it.

    At the bounds of a share there is none or all of it.
    """
    catalogue = fit.model.catalogue()
    found = {}
    for name, estimate in fit.params.items():
        effect, own = name.split(".", 1)
        row = catalogue[effect].parameter(own)
        bounds = {row.lower, row.upper}
        for bound in bounds - (_SHARE if bounds == _SHARE else {row.neutral}):
            if estimate.determined and math.isclose(estimate.value, bound, rel_tol=1e-6):
                found[name] = bound
    return found


def _at_bounds(fit: Fit) -> list[str]:
    return [
        f"{name} is at its bound, {bound:g}: it stands in for something else"
        for name, bound in at_bounds(fit).items()
    ]


def _moves_like_a_spring(signals: Prepared) -> bool:
    """Whether acceleration is proportional to position, as in an oscillation of one frequency."""
    theta, alpha = signals.theta[signals.used], signals.alpha[signals.used]
    spread = float(np.std(theta) * np.std(alpha))
    return spread > 0.0 and float(np.mean((theta - theta.mean()) * (alpha - alpha.mean()))) < -0.98 * spread


def white_variance(fit: Fit, floor: float) -> float:
    """Return the variance of white noise of the raw torque that leaves so much of it, (N m)^2."""
    used = sum(one.core.used for one in fit.prepared)
    return floor**2 * used / fit.white_squares if fit.white_squares > 0.0 else floor**2
