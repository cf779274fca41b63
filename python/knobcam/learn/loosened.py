"""Shapes that stay at what textbooks say: freed where the data pay, and what they leave unknown where not."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING
from weakref import WeakKeyDictionary

from .. import _core
from ..fit.plausible import out_of_range
from ..fit.refit import cores, paid
from ..fit.rule import RULE

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping

    from ..fit import Estimate, Fit
    from ..fit.diagnose import Diagnosis


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
    for name, plausible, _ in _held(fit):
        freer = _freed(fit, name)
        won = paid(freer, fit, fit)
        enough = fit.rmse**2 - freer.rmse**2 >= RULE.share * fit.excess
        if enough and won > least and out_of_range(freer.params[name], plausible) is None:
            best, least = freer, won
    return best


def with_shapes(params: Mapping[str, Estimate], fit: Fit) -> Mapping[str, Estimate]:
    """Return parameters of a fit with intervals that carry what is not known of the shapes it holds.

    To first order: how far each would go with a shape, by how far that may be from where it is held, which is
    known from what real ones have and from what the data say of it.
    """
    wider = dict(params)
    for name, _, spread in _held(fit):
        freer = _freed(fit, name)
        shape = freer.params[name]
        if not (shape.determined and shape.se > 0.0):
            continue
        # The mean square of how far it is off: that of a normal distribution before and after the data.
        trust = spread**2 / (spread**2 + shape.se**2)
        off = trust * shape.se**2 + (trust * (shape.value - fit.params[name].value)) ** 2
        for other, estimate in wider.items():
            # What is tied goes as what it is tied to.
            with_it = freer.correlation.get(other) or freer.correlation.get(freer.model.params[other].role)
            if other == name or with_it is None or not (estimate.determined and estimate.se):
                continue
            slope = with_it[name] * freer.params[other].se / shape.se
            wider[other] = estimate.widened(slope**2 * off)
    return wider


# What a search looked at last is what its intervals ask for.
_KNOWN: WeakKeyDictionary[Fit, dict[str, Fit]] = WeakKeyDictionary()


def _freed(fit: Fit, name: str) -> Fit:
    """Return the fit with one of its shapes free."""
    known = _KNOWN.setdefault(fit, {})
    if name not in known:
        core = _core.refine(cores(fit), fit.core.model.with_fixed(name, False), True)
        known[name] = replace(fit, core=core)
    return known[name]


def _held(fit: Fit) -> Iterator[tuple[str, tuple[float, float], float]]:
    """Yield the shapes that are held and may be freed, of effects that are fitted.

    With the values that make sense of each, and how far real ones are from where it is held.
    """
    catalogue, params = fit.model.catalogue(), fit.model.params
    for effect in fit.model.effects:
        if not any(one.role == "free" for name, one in params.items() if name.startswith(f"{effect}.")):
            continue
        for row in catalogue[effect].params:
            name = f"{effect}.{row.name}"
            if row.where_paid is not None and name in params and params[name].role == "fixed":
                yield name, row.plausible, row.where_paid
