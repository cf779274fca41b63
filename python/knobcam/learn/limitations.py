"""What a capture cannot tell whatever the model: the motion that is missing, and what to record instead."""

from __future__ import annotations

import math
import re
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from ..base.said import OfParam, number, said
from ..capture.formats.units import SI
from ..capture.prepare import travel
from ..fit.doubts import astray, at_floor
from ..fit.one_way import goes, one_way
from ..fit.unheard import unheard
from ..model.effects import base_effects

if TYPE_CHECKING:
    from ..base.arrays import FloatArray
    from ..fit import Fit

_SHORT_S = 1.0
_SLOW = 0.1  # slow beside the fastest, at which friction that depends on speed shows
_SLOW_TIME = 0.002  # even a brisk turn at each end spends this part of the time below that
_MOVING = 0.02  # beside the fastest: below it the sign of the velocity means nothing
_EVEN = 1.2  # the 95th over the 5th percentile: speeds that say no more than one speed
_SEEN = 3.0  # standard deviations
_TOGETHER = 0.95  # correlation of parameters of which one can take what the other gives
_HARDLY = 0.25  # standard error of its value: hardly known alone
_PULLS = "return_spring.k", "unbalance.a", "position_polynomial.p1"
_SMALL_TURN_RAD = 0.5  # about the widest detent of the haptic-camera paper's knobs (knob 4: 0.478 rad)


class Limitation(NamedTuple):
    """Something that captures do not show: its `kind`, what follows from it, and what to `record`.

    `sharpen` is the parameter, if it is one, that a motion for it alone would tell: of an inertia and what
    pulls that is the latter, by slow moves, and with it the other.
    """

    kind: str
    message: str
    record: str
    sharpen: str | None = None


def limitations(fit: Fit) -> tuple[Limitation, ...]:
    """Return what the captures of a fit cannot tell, all of them together."""
    omega = np.concatenate([one.omega[one.used] for one in fit.prepared])
    found = [
        _length(fit),
        *_directions(fit, omega),
        _slowness(fit, omega),
        _excitation(fit, omega),
        width(fit),
        _one_rate(fit),
        _noise(fit),
    ]
    return tuple(one for one in found if one is not None)


def _length(fit: Fit) -> Limitation | None:
    seconds = sum(one.core.used / one.core.rate_hz for one in fit.prepared)
    if seconds >= _SHORT_S:
        return None
    return Limitation(
        "too_short",
        f"only {seconds:.2g} s count: chance and effect cannot be told apart",
        "record at least 5 s, with several turns back and forth",
    )


def _directions(fit: Fit, omega: FloatArray) -> list[Limitation | None]:
    only = None
    if seen := one_way(fit.prepared):
        missing = "backward" if seen == "forward" else "forward"
        motion, record = "the motion", "turn through the same range forward and backward"
        if goes(np.concatenate([one.omega[np.isfinite(one.omega)] for one in fit.prepared])) is None:
            # At a rate that is low for it, between lost rows, or always about to turn.
            motion = "what counts of the motion"
            record = "turn back less often, or record faster: near a turn nothing counts"
        only = Limitation(
            "one_direction",
            f"{motion} is {seen} only: friction {missing}, and whatever differs with the direction, is not "
            "seen, and dry friction cannot be told from a constant torque",
            record,
        )
    turned = sum(_reversals(one.omega, _MOVING * float(np.max(np.abs(omega)))) for one in fit.prepared)
    no_reversal = None
    if turned == 0:
        no_reversal = Limitation(
            "no_reversal",
            "the motion never turns back: presliding, backlash and other effects of a reversal cannot show",
            "reverse the motion several times, at different places",
        )
    return [no_reversal, only]


def _reversals(omega: FloatArray, moving: float) -> int:
    """Count the changes of direction between samples that surely move."""
    signs = np.sign(omega[np.abs(omega) > moving])
    return int(np.sum(signs[1:] != signs[:-1]))


def _slowness(fit: Fit, omega: FloatArray) -> Limitation | None:
    speed, unit = np.abs(omega), SI[fit.model.coordinate]["omega"]
    top = float(np.max(speed))
    if float(np.mean(speed < _SLOW * top)) >= _SLOW_TIME:
        return None
    return Limitation(
        "no_slow_motion",
        said(
            "the speed never falls below {slow}: what friction does near standstill cannot show",
            slow=number(max(float(np.min(speed)), _SLOW * top), unit, ".3g"),
        ),
        "record slow turning and gentle reversals as well",
    )


def _excitation(fit: Fit, omega: FloatArray) -> Limitation | None:
    """Speeds and accelerations must vary; where the model is right, by more than noise hides.

    A model that is wrong says nothing of the motion: what it lacks drowns both torques on any.
    """
    alpha = np.concatenate([one.alpha[one.used] for one in fit.prepared])
    speed = np.abs(omega)
    moving = speed[speed >= _SLOW * float(np.max(speed))]
    low, high = (float(np.quantile(moving, q)) for q in (0.05, 0.95))
    even = _too_even(fit, high / low if low > 0.0 else 1.0, alpha)
    if not (even or (at_floor(fit) and not _stands_out(fit))):
        return None
    units, rms = SI[fit.model.coordinate], math.sqrt(float(np.mean(alpha**2)))
    return Limitation(
        "too_slow",
        said(
            "the motion is too slow or too even, with speeds of {low} to {high} and accelerations of {rms} "
            "(RMS): neither viscous friction nor inertia stands out",
            low=f"{low:.3g}",
            high=number(high, units["omega"], ".3g"),
            rms=number(rms, units["alpha"], ".3g"),
        ),
        "turn faster and change speed more, as a sweep does",
    )


def _too_even(fit: Fit, spread: float, alpha: FloatArray) -> bool:
    """Whether the speed keeps to one value, and the acceleration to what the noise of its sensors makes."""
    sd = [one.sd("alpha") for one in fit.prepared]
    if spread > _EVEN or any(one is None for one in sd):
        return False
    known = [one[signals.used] for one, signals in zip(sd, fit.prepared, strict=True) if one is not None]
    return float(np.mean(alpha**2)) <= (_SEEN * float(np.median(np.concatenate(known)))) ** 2


def _stands_out(fit: Fit) -> bool:
    """Whether a torque of the base model that needs motion is more than chance; true where there is none."""
    base = base_effects(fit.model.coordinate)
    # A torque that needs motion has a time in its unit.
    swift = [
        e for name, e in fit.params.items() if name.split(".", 1)[0] in base and re.search(r"\bs\b", e.unit)
    ]
    return not swift or any(e.determined and abs(e.value) > _SEEN * e.se for e in swift)


def width(fit: Fit) -> Limitation | None:
    """Return what a motion within less than one detent cannot tell."""
    wide = travel(fit.prepared)
    period = fit.model.period
    rotary = fit.model.coordinate == "rotary"
    unit = "rad" if rotary else "m"
    if period is not None and not astray(fit):
        needed = 2.0 * math.pi * abs(period)
    else:
        needed = _SMALL_TURN_RAD if rotary else 0.0
    if wide >= needed:
        return None
    return Limitation(
        "less_than_one_detent",
        f"only {wide:.3g} {unit} are turned through, less than one detent of {needed:.3g} {unit}: what "
        "depends on position cannot be told apart",
        f"turn through at least {2.0 * needed:.2g} {unit}",
    )


def _one_rate(fit: Fit) -> Limitation | None:
    """Return what swings at one rate cannot tell: an inertia does what a spring does, times its square."""
    params, inertia = fit.params, "inertia.M"
    for pull in _PULLS:
        if not all(name in params and params[name].determined for name in (inertia, pull)):
            continue
        known = max(params[name].se / max(abs(params[name].value), 1e-300) for name in (inertia, pull))
        if abs(fit.correlation[inertia][pull]) > _TOGETHER and known > _HARDLY:
            return Limitation(
                "one_rate",
                said(
                    "{inertia} and {pull} are known together, and hardly alone (to {known}): the motion "
                    "swings at one rate, at which either does what the other does",
                    inertia=OfParam(inertia),
                    pull=OfParam(pull),
                    known=number(100.0 * known, "%", ".0f"),
                ),
                "record slow moves over the same way, in which the inertia has no part, or swings at another "
                "rate",
                pull,
            )
    return None


def _noise(fit: Fit) -> Limitation | None:
    if not math.isnan(fit.noise_floor):
        return None
    why, record = unheard(fit)
    return Limitation("no_noise_floor", f"{why}: nothing can be called beyond chance", record)
