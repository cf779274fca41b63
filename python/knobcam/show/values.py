"""Values of a model as a report has them: what each is in words, its letter, and how well it is known."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from .words import SHORT, param_phrase, unit_word

if TYPE_CHECKING:
    from collections.abc import Collection, Iterable

    from ..fit.estimate import Estimate
    from ..learn import LearningResult

HEAD = ("parameter", "letter", "value ± 95 %", "unit")
_PLAIN = (-3, 5)  # powers of ten between which a number is written without one
_RAISED = str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹")


def rows(
    learned: LearningResult, names: Iterable[str], doubted: Collection[str]
) -> list[tuple[str, str, str, str]]:
    """Return parameters under the words of `HEAD`; those that are doubted with a mark."""
    kind, found = learned.model.coordinate, []
    runs = {one.name: one.capture for every in learned.fit.per_capture.values() for one in every}
    for name in names:
        one = learned.params[name]
        factor, unit = scaled(one.unit, learned)
        what = param_phrase(name, kind) + (f", in {runs[name]}" if name in runs else "")
        mark = " (fixed)" if one.held else " ⚠" if name in doubted else ""
        letter = name.partition(".")[2].partition("@")[0]
        found.append((what, letter, with_doubt(one, factor) + mark, unit_word(unit)))
    return found


def scaled(unit: str, learned: LearningResult) -> tuple[float, str]:
    """Return the factor and the unit in which a value is written: torques as in the pictures."""
    from .plot.style import torque_scale  # with what draws, which a page alone does not need

    torque = learned.model.torque_unit
    scale = torque_scale(
        torque, max(float(abs(one.tau[one.mask]).max(initial=0.0)) for one in learned.captures)
    )
    if unit in SHORT or not (unit == torque or unit.startswith((f"{torque} ", f"{torque}/"))):
        return 1.0, unit  # an inertia has a name of its own
    return scale.factor, unit.replace(torque, scale.unit, 1)


def with_doubt(estimate: Estimate, factor: float = 1.0) -> str:
    """Return a value with half its 95 % interval, in as many digits as that justifies: two of the interval.

    >>> from knobcam.fit.estimate import Estimate
    >>> with_doubt(Estimate(0.0123456, (0.0120, 0.0126), "N m", 1.5e-4), 1000.0)
    '12.35 ± 0.30'
    >>> with_doubt(Estimate(1.23456e-5, (1.2e-5, 1.26e-5), "N m s^2/rad", 1.5e-7))
    '(1.235 ± 0.030)·10⁻⁵'
    """
    value, half = factor * estimate.value, 0.5 * factor * (estimate.ci95[1] - estimate.ci95[0])
    if not estimate.determined:
        return "not determined"
    if not half > 0.0:
        return f"{value:.6g}".replace("-", "−")
    power = math.floor(math.log10(max(abs(value), half)))
    if _PLAIN[0] <= power < _PLAIN[1]:
        return _both(value, half)
    raised = str(power).translate(_RAISED)
    return f"({_both(value / 10.0**power, half / 10.0**power)})·10{raised}"


def _both(value: float, half: float) -> str:
    half = float(f"{half:.1e}")
    places = 1 - math.floor(math.log10(half))
    told = (f"{round(one, places):.{max(places, 0)}f}" for one in (value, half))
    return " ± ".join(told).replace("-", "−")
