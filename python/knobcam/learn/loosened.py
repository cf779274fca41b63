"""Shapes that stay at what textbooks say: freed where the data pay, and what they leave unknown where not."""

from __future__ import annotations

import math
from dataclasses import replace
from functools import lru_cache
from typing import TYPE_CHECKING

from .. import _core
from ..fit.estimate import Z95
from ..fit.plausible import out_of_range
from ..fit.refit import cores, gain
from ..fit.rule import RULE

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping

    from ..fit import Estimate, Fit
    from ..fit.diagnose import Diagnosis
    from ..model.effects import ParameterInfo


def loosened(diagnosis: Diagnosis, beyond: float) -> Fit | None:
    """Return the fit of a diagnosis with a shape of one of its effects free, where that explains most.

    It has to pay more than the best candidate, which takes off `beyond` less its price: what a law that is a
    little off leaves is drawn by many effects, by each in part. Where no more than chance is left it may pay
    still: it bends what is beside it. None where no shape is held, and where it ends at a value that no such
    effect has.
    """
    fit = diagnosis.fit
    if not fit.noise_floor > 0.0:
        return None
    best, least = None, max(beyond, 0.0)
    for name, row in _held(fit):
        freer = _freed(fit, name)
        paid = gain(fit, freer, fit) - RULE.price
        enough = fit.rmse**2 - freer.rmse**2 >= RULE.share * fit.excess
        if enough and paid > least and out_of_range(freer.params[name], row.plausible) is None:
            best, least = freer, paid
    return best


def with_shapes(params: Mapping[str, Estimate], fit: Fit) -> Mapping[str, Estimate]:
    """Return parameters of a fit with intervals that carry what is not known of the shapes it holds.

    To first order: how far each would go with a shape, by how far that may be from where it is held, which is
    known from what real ones have and from what the data say of it.
    """
    wider = dict(params)
    for name, row in _held(fit):
        freer = _freed(fit, name)
        shape, spread = freer.params[name], row.where_paid
        if spread is None or not (shape.determined and shape.se > 0.0):
            continue
        # The mean square of how far it is off: that of a normal distribution before and after the data.
        trust = spread**2 / (spread**2 + shape.se**2)
        off = trust * shape.se**2 + (trust * (shape.value - fit.params[name].value)) ** 2
        for other, estimate in wider.items():
            there = freer.params[other]
            if other == name or not (estimate.determined and estimate.se and there.determined):
                continue
            slope = freer.correlation[other][name] * there.se / shape.se
            error = math.sqrt(estimate.se**2 + slope**2 * off)
            interval = (estimate.value - Z95 * error, estimate.value + Z95 * error)
            wider[other] = estimate._replace(ci95=interval, se=error)
    return wider


@lru_cache(maxsize=1)  # what a search looked at last is what its intervals ask for
def _freed(fit: Fit, name: str) -> Fit:
    """Return the fit with one of its shapes free."""
    return replace(fit, core=_core.refine(cores(fit), fit.core.model.with_fixed(name, False), True))


def _held(fit: Fit) -> Iterator[tuple[str, ParameterInfo]]:
    """Yield the shapes that are held and may be freed: of effects that are fitted."""
    catalogue = fit.model.catalogue()
    for effect in fit.model.effects:
        own = {name: one.role for name, one in fit.model.params.items() if name.startswith(f"{effect}.")}
        for row in catalogue[effect].params if "free" in own.values() else ():
            name = f"{effect}.{row.name}"
            if row.where_paid is not None and own.get(name) == "fixed":
                yield name, row
