"""Shapes that stay at what textbooks say, freed where the data pay for it."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

from .. import _core
from ..fit.doubts import at_floor
from ..fit.plausible import out_of_range
from ..fit.refit import cores, gain
from ..fit.rule import RULE

if TYPE_CHECKING:
    from collections.abc import Iterator

    from ..fit import Fit
    from ..fit.diagnose import Diagnosis


def loosened(diagnosis: Diagnosis, beyond: float) -> Fit | None:
    """Return the fit of a diagnosis with a shape of one of its effects free, where that explains most.

    It has to pay more than the best candidate, which takes off `beyond` less its price: what a law that is a
    little off leaves is drawn by many effects, by each in part. Where no more than chance is left it may pay
    still, and bend what is beside it, less than a joint's fits are worth. None where no shape is held, and
    where it ends at a value that no such effect has.
    """
    fit = diagnosis.fit
    catalogue = fit.model.catalogue()
    joint = any(catalogue[one].place == "coupling" for one in fit.model.effects)
    if not fit.noise_floor > 0.0 or (joint and at_floor(fit)):
        return None
    best, least = None, max(beyond, 0.0)
    for name in _held(fit):
        core = _core.refine(cores(fit), fit.core.model.with_fixed(name, False), True)
        freer = replace(fit, core=core)
        effect, _, own = name.partition(".")
        plausible = catalogue[effect].parameter(own).plausible
        paid = gain(fit, freer, fit) - RULE.price
        enough = fit.rmse**2 - freer.rmse**2 >= RULE.share * fit.excess
        if enough and paid > least and out_of_range(freer.params[name], plausible) is None:
            best, least = freer, paid
    return best


def _held(fit: Fit) -> Iterator[str]:
    """Yield the shapes that are held and may be freed."""
    catalogue = fit.model.catalogue()
    for effect in fit.model.effects:
        for row in catalogue[effect].params:
            name = f"{effect}.{row.name}"
            if row.where_paid and fit.model.params[name].role == "fixed":
                yield name
