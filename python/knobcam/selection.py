"""Which effects come in, in which order, and when to stop."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

from .diagnose import Diagnosis, diagnose
from .ladder import Rung, Unexplained

if TYPE_CHECKING:
    from collections.abc import Callable, Collection

    from .compare import Comparison
    from .fit import Fit

_WORTH = 0.02  # a candidate that lowers the unseen error by less is left out


class Selection(NamedTuple):
    """The ladder, what was weighed on its last rung and not added, and what no effect explains."""

    ladder: tuple[Rung, ...]
    last: Diagnosis
    unexplained: Unexplained | None


def select(first: Fit, without: Collection[str], tell: Callable[[str], None]) -> Selection:
    """Add the best effect as long as the error on unseen blocks falls."""
    ladder = [Rung(first)]
    while True:
        fit = ladder[-1].fit
        tell(f"weighing what could be missing from {', '.join(fit.model.effects)}")
        diagnosis = diagnose(fit, without=without)
        best = diagnosis.best
        if best is None or best.rmse_heldout > (1.0 - _WORTH) * fit.rmse_heldout:
            return Selection(tuple(ladder), diagnosis, _unexplained(diagnosis.comparison))
        tell(f"adding {best.effect}")
        ladder.append(Rung(best.fit, best.effect, best.p_value, best.equivalent, diagnosis=diagnosis))


def _unexplained(comparison: Comparison) -> Unexplained | None:
    worst = comparison.worst
    if comparison.complete or worst is None:
        return None
    hint = f"worst at {worst.where()}"
    axis = worst.axis
    if axis == "frequency":
        # A disturbance with a rhythm of its own is an event in time.
        axis = "time"
        hint = f"a line at {0.5 * (worst.regions[0].start + worst.regions[0].end):.1f} Hz"
    return Unexplained(axis, worst.share, hint)
