"""Whether the values that an effect was fitted with can be its own, or it stands in for another."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import TYPE_CHECKING

import numpy as np

from ..capture.prepare import travel
from ..model.effects import effect as catalogued
from ..model.effects import effects

if TYPE_CHECKING:
    from .diagnose import Candidate
    from .fitting import Fit

_NEVER_NEGATIVE = ("inertia.M", "coulomb.neg", "coulomb.pos")
_SURE = 2.0  # standard errors
_DETENTS = 1.5  # that a motion must cross for a change of them to be told from a map of position
_IN_STOPS = 0.6  # of the samples: stops that hold more are a spring
_CYCLES = 0.8  # of friction along the way that a motion must cross
_LEAST_CYCLES, _WAVES = 0.5, 1.6  # or this part, if it holds so many of the strongest waves
_LARGEST = 2.0  # times the dry friction: what its series may add up to
_FAR = 0.2  # of the range: presliding is over by then
_NEAR = 1.0  # sample at the usual speed
_LOCKED = 0.01  # two periods this close to a ratio of small numbers belong together


def unphysical(candidate: Candidate, before: Fit) -> tuple[str, ...]:
    """Return what is odd about the values of a candidate, a sentence each."""
    said = [*_out_of_range(candidate), *_below_zero(candidate, before)]
    implausible = candidate.fit.core.model.implausible(candidate.effect)
    said += [implausible] if implausible else []
    if effects(candidate.fit.model.axis)[candidate.effect].needs == "detent":
        said += _too_few_detents(candidate)
    if candidate.effect == "saturation" and before.before is not None:
        said += _unclipped(candidate)
    if candidate.effect in _ODD:
        said += _ODD[candidate.effect](candidate)
    return tuple(said)


def _out_of_range(candidate: Candidate) -> list[str]:
    said = []
    for row in catalogued(candidate.effect, candidate.fit.model.axis).params:
        name = f"{candidate.effect}.{row.name}"
        estimate = candidate.fit.params[name]
        low, high = row.plausible
        margin = _SURE * estimate.se if estimate.determined else 0.0
        if estimate.value + margin < low or estimate.value - margin > high:
            limits = f"at least {low:g}" if math.isinf(high) else f"{low:g} to {high:g}"
            said.append(f"{name} = {estimate.value:.3g} is unphysical: it should be {limits}")
    return said


def _below_zero(candidate: Candidate, before: Fit) -> list[str]:
    """Return what it bends below zero that was not before."""
    said = []
    for name in _NEVER_NEGATIVE:
        now, then = candidate.fit.params.get(name), before.params.get(name)
        if now is None or then is None or not (now.determined and then.determined):
            continue
        if now.value + _SURE * now.se < min(0.0, then.value - _SURE * then.se):
            said.append(f"beside it {name} = {now.value:.3g}, which no knob has")
    return said


def _too_few_detents(candidate: Candidate) -> list[str]:
    """A change of one detent alone is any map of position."""
    detents = travel(candidate.fit.prepared) / (2.0 * math.pi * candidate.fit.params["detent.P"].value)
    return [f"only {detents:.1f} detents were crossed"] if detents < _DETENTS else []


def _stops(candidate: Candidate) -> list[str]:
    """Stops are where the way ends."""
    theta, p = _theta(candidate), candidate.fit.params
    above = (theta > p["end_stop.hi"].value) if p["end_stop.k_hi"].value > 0.0 else np.zeros(len(theta), bool)
    below = (theta < p["end_stop.lo"].value) if p["end_stop.k_lo"].value > 0.0 else np.zeros(len(theta), bool)
    inside = float(np.mean(above | below))
    return (
        [f"{100 * inside:.0f} % of the samples lie in its stops: it is a spring"]
        if inside > _IN_STOPS
        else []
    )


def _waves(candidate: Candidate) -> list[str]:
    """Friction that varies along the way stays friction, and goes through a period of its own."""
    p = candidate.fit.params
    cycles = travel(candidate.fit.prepared) / (2.0 * math.pi * p["position_friction.P"].value)
    sizes = [
        math.hypot(p[f"position_friction.a{n}"].value, p[f"position_friction.b{n}"].value)
        for n in range(1, 5)
    ]
    # A series whose higher waves are its strongest goes up and down within a part of its period.
    strongest = sum(n * size**2 for n, size in enumerate(sizes, 1)) / max(sum(s**2 for s in sizes), 1e-300)
    if cycles < _CYCLES and not (cycles >= _LEAST_CYCLES and cycles * strongest >= _WAVES):
        return [f"only {cycles:.1f} of its periods were crossed: it is a trend"]
    size = sum(sizes)
    return [f"it varies by {size:.1f} times the friction there is"] if size > _LARGEST else _locked(candidate)


def _distance(candidate: Candidate) -> list[str]:
    """Presliding ends within a small part of the way, and takes longer than the sensors' step."""
    p = candidate.fit.params
    shares = [p[f"presliding.w{i}"].value for i in range(1, 7)]
    reach = [p["presliding.s"].value / 2.0**i for i in range(6)]
    mean = sum(w * s for w, s in zip(shares, reach, strict=True)) / max(sum(shares), 1e-12)
    signals = candidate.fit.prepared[0]
    speed = float(np.sqrt(np.mean(np.square(signals.omega[signals.used]))))
    if mean > _FAR * travel(candidate.fit.prepared):
        return [f"it takes {mean:.2g} to slip, a good part of the way: it is a spring"]
    if mean < _NEAR * speed / signals.capture.rate_hz:
        return [f"it slips within {mean:.2g}, less than a sample: a lag of the torque does the same"]
    return []


def _locked(candidate: Candidate) -> list[str]:
    """Friction that repeats with the detents belongs to them."""
    p = candidate.fit.params
    if "detent.P" not in p:
        return []
    ratio = p["position_friction.P"].value / p["detent.P"].value
    for times in (1.0, 2.0, 3.0, 4.0, 0.5):
        if abs(ratio / times - 1.0) < _LOCKED:
            return ["it repeats with the detents: load_friction or directional_detent would, by nature"]
    return []


def _unclipped(candidate: Candidate) -> list[str]:
    """Beside another effect a limit can hide that one's misfit; readings that repeat at it are the proof."""
    findings = [finding for one in candidate.fit.prepared for finding in one.capture.findings]
    clipped = any(finding.kind == "clipped" for finding in findings)
    return [] if clipped else ["no reading repeats at such a limit"]


def _no_gap(candidate: Candidate) -> list[str]:
    """Backlash without play is compliance."""
    p = candidate.fit.params
    gap, stiffness = p["backlash.gap"], p["backlash.k"].value
    # What the spring winds up by under the torque of the noise is no play.
    least = max(_SURE * gap.se if gap.determined else 0.0, candidate.fit.noise_floor / stiffness)
    return ["its gap is nothing: it is compliance"] if gap.value <= least else []


_ODD: dict[str, Callable[[Candidate], list[str]]] = {
    "end_stop": _stops,
    "position_friction": _waves,
    "presliding": _distance,
    "backlash": _no_gap,
}


def _theta(candidate: Candidate) -> np.ndarray[tuple[int, ...], np.dtype[np.float64]]:
    """Positions of the samples that count, rad."""
    return np.concatenate([one.theta[one.used] for one in candidate.fit.prepared])
