"""What parameters cost where others do as well without them."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from .rule import RULE

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping, Sequence

    from ..model.effects import Effect
    from .estimate import Estimate
    from .fitting import Fit


def spared(
    row: Effect, parameters: Mapping[str, Estimate], errors: Mapping[str, float] | None = None
) -> float:
    """Return how many parameters an effect is not charged for, of its own in a fit.

    A parameter costs twice the logarithm of its range over what is not known of it (Laplace's evidence, all
    of the range as likely before), and no more than its price. `errors` are standard errors in place of those
    of the fit, as after a motion that was not made yet.
    """
    rows = {f"{row.id}.{one.name}": one for one in row.params}
    not_charged = 0.0
    for name, known in parameters.items():
        if name in rows and known.determined and known.se > 0.0:
            se = known.se if errors is None else errors[name]
            choice = (rows[name].upper - rows[name].lower) / se
            not_charged += 1.0 - min(max(2.0 * math.log(choice) / RULE.price, 0.0), 1.0)
    return not_charged


def own(fit: Fit, effect: str) -> dict[str, Estimate]:
    """Return the parameters of an effect, as fitted."""
    return {name: one for name, one in fit.params.items() if name.startswith(f"{effect}.")}


def count(fit: Fit, effects: Iterable[str]) -> int:
    """Return how many parameters of some effects were fitted, determined or not."""
    return sum(not one.held for effect in effects for one in own(fit, effect).values())


def charged(fit: Fit, effects: Sequence[str], errors: Mapping[str, float] | None = None) -> float:
    """Return how many parameters of some effects in a fit are charged for; `errors` as above."""
    rows = fit.model.catalogue()
    return count(fit, effects) - sum(spared(rows[one], own(fit, one), errors) for one in effects)
