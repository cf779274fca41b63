"""A joint of shaft and knob against what else it could be, and against what may hide one."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from .. import _core
from ..fit.absent import absent
from ..fit.diagnose import LEAST_P, Candidate, Diagnosis, diagnose
from ..fit.plausible import implausible
from ..fit.refit import converged, cores, gain
from ..fit.rule import RULE
from ..fit.verdict import judged
from ..model.effects import effects

if TYPE_CHECKING:
    from collections.abc import Callable, Collection

    from ..fit import Fit

_SEEN = 1.0 / 3.0
"""Of what the torque's filter lets pass, up to where a joint is known by the frequency that it swings at."""

_TRIES = 1e4  # more than a joint has starts


def joints(coordinate: str) -> list[str]:
    """Return the effects that join shaft and knob."""
    return [one.id for one in effects(coordinate).values() if one.place == "coupling"]


def in_place(fit: Fit, other: str, progress: Callable[[float], object] | None = None) -> Fit | None:
    """Return the fit with another joint in the place of its own, from where that one ended.

    It is followed to its end where it comes near; None for a fit without a joint, or where no such model can
    be followed. What `progress` raises ends the work.
    """
    core = _core.in_place(cores(fit), fit.core.model, other, progress)
    if core is None:
        return None
    found = replace(fit, core=core, before=None)
    return converged(found) if found.rmse < RULE.converged * fit.rmse else found


def overlooked(
    diagnosis: Diagnosis, without: Collection[str], progress: Callable[[float], object]
) -> Diagnosis:
    """Return a diagnosis with the joints weighed that were not, where one may hide behind what is named.

    Joints take long, and are not looked at where another effect explains what is left. Where that one is not
    possible by its values, and all that are leave more, they are; and where what is named looks like one, and
    explains so little that they may not be told apart, or where a joint that gave way as far as friction
    takes to build up would hardly show otherwise.
    """
    fit, best = diagnosis.fit, diagnosis.best
    could = [one for one in joints(fit.model.coordinate) if one in absent(fit, without)[0]]
    known = {*(one.effect for one in diagnosis.candidates), *diagnosis.left_out}
    if best is None or not could or not known.isdisjoint(could):
        return diagnosis
    rows = effects(fit.model.coordinate)
    alike = any(best.effect in rows[one].confused for one in could)
    hidden = alike and RULE.relative * best.gain <= RULE.alike
    hidden |= any(one.score >= best.score - RULE.alike and _swift(one.fit) for one in diagnosis.candidates)
    if not hidden and any(_explains(one.rmse, fit) for one in diagnosis.could_be):
        return diagnosis
    more = diagnose(fit, only=could, progress=progress)
    found = [replace(one, p_value=chance(one.gain, diagnosis, one.count)) for one in more.candidates]
    left_out = {**diagnosis.left_out, **{one: why for one, why in more.left_out.items() if one in could}}
    candidates = judged(diagnosis.comparison, [*diagnosis.candidates, *found])
    return replace(diagnosis, candidates=candidates, left_out=left_out)


def _swift(fit: Fit) -> bool:
    """Whether a joint that gives way as far as friction builds up over swings too fast to be seen by that."""
    model = fit.core.model
    inertia, friction, _, _ = model.at_rest()
    over = model.builds_up_over
    if over is None or not min(over, inertia, *friction) > 0.0:
        return False
    edge_hz = min(one.core.edge_hz or 0.5 * one.capture.rate_hz for one in fit.prepared)
    return math.sqrt(float(np.mean(friction)) / over / inertia) > _SEEN * 2.0 * math.pi * edge_hz


def _explains(rmse: float, fit: Fit) -> bool:
    """Whether an error that is left of a fit's makes it needless to look at joints."""
    floor, before, left = fit.noise_floor**2, fit.rmse**2, rmse**2
    excess = before - floor
    better = excess <= RULE.slight * floor or left - floor <= RULE.better * excess
    return (left <= RULE.explained * floor and better) or before - left >= RULE.enough * excess


def followed_to(
    diagnosis: Diagnosis, best: Candidate, also: Callable[[Fit], Fit] = lambda fit: fit
) -> tuple[Candidate, Fit]:
    """Return what is added and its end: the best, or if that is a joint which cannot be there, the next.

    Candidates are sketched, and a joint's way on from there may lead to values that cannot be its own, as may
    what comes in with it, which is `also` done. The next is the first that is possible of those that explain
    as much.
    """
    fit, first = diagnosis.fit, also(converged(best.fit))
    if best.place != "coupling" or not implausible(replace(best, fit=first), fit):
        return best, first
    others = [one for one in diagnosis.candidates if one.could_be and one is not best]
    enough = [one for one in others if one.effect in best.equivalent or _explains(one.rmse, fit)]
    ends = ((one, also(converged(one.fit))) for one in enough)
    return next((pair for pair in ends if not implausible(replace(pair[0], fit=pair[1]), fit)), (best, first))


def beside_others(
    diagnosis: Diagnosis,
    joint: str,
    own: Fit,
    before: Fit,
    without: Collection[str],
    progress: Callable[[float], object],
) -> Diagnosis:
    """Return what is said of a joint that was followed to its end after all, and of the others in its place.

    `own` is that end, `before` the fit without the joint, and `diagnosis` what was weighed beside the first
    model: where that is `before`, its other candidates are judged with them.
    """
    could = [one for one in joints(before.model.coordinate) if one in absent(before, without)[0]]
    ends = {one: own if one == joint else in_place(own, one, progress) for one in could}
    kept = [one for one in diagnosis.candidates if before is diagnosis.fit and one.effect not in ends]
    found = []
    for one, end in ends.items():
        if end is None:
            continue
        took, count = gain(before, end, before), len(effects(before.model.coordinate)[one].params)
        candidate = Candidate(one, replace(end, before=before), chance(took, diagnosis, count), took, count)
        found.append(replace(candidate, implausible=implausible(candidate, before)))
    left_out = diagnosis.left_out if kept else {}
    return Diagnosis(before, judged(before.compare(), [*kept, *found]), left_out)


def chance(took: float, diagnosis: Diagnosis, count: int | None = None) -> float:
    """Return how often chance would take off as much.

    No oftener than what takes off less; nor, of something with so many parameters, than the best of many
    tries of as many independent numbers (Chernoff 1952), of half of it for what is not known of the noise.
    """
    less = min((one.p_value for one in diagnosis.candidates if one.gain <= took), default=1.0)
    if count is None:
        return less
    each = max(0.5 * took / count, 1.0)
    tail = math.pow(each * math.exp(1.0 - each), 0.5 * count)
    return min(less, max(_TRIES * tail, LEAST_P))
