"""What speaks for each absent effect to first order: too little in one capture, but a lot adds it up."""

from __future__ import annotations

from typing import TYPE_CHECKING

from .. import _core
from ..model.effects import descriptions
from .absent import absent
from .refit import cores

if TYPE_CHECKING:
    from .fitting import Fit


def hints(fit: Fit) -> dict[str, float]:
    """Return how much a fit's captures speak for each effect that it lacks, by kind and effect.

    `lean.EFFECT`, of one that draws the torque in one direction alone, is how far the residual leans that
    way, with its sign, in standard deviations of noise; `gain.EFFECT`, of one that draws in several, the root
    of what it would take off in variances of the raw noise. Couplings have none, nor have descriptions.
    """
    could, _ = absent(fit, descriptions(fit.model.coordinate))
    rows = _core.hints(cores(fit), fit.model.core, could)
    return {f"{kind}.{effect}": value for kind, effect, value in rows}
