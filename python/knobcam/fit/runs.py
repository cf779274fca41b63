"""What belongs to a run rather than to the knob: a value for each capture, where they ask for it."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, NamedTuple

from .described import names

if TYPE_CHECKING:
    from collections.abc import Mapping

    from .estimate import Estimate
    from .fitting import Fit


class OfRun(NamedTuple):
    """What a parameter is in one capture; its `name` there, as `Fit.params` has it."""

    capture: str
    name: str
    estimate: Estimate


def per_capture(fit: Fit) -> dict[str, tuple[OfRun, ...]]:
    """Return the parameters that are not the same in all captures, by `effect.parameter`: each in all.

    In the first it is the one without a capture in its name.
    """
    captures = names(fit.prepared)
    apart: dict[str, list[str]] = {}
    for name in fit.params:
        shared, _, own = name.partition("@")
        if own:
            apart.setdefault(shared, [shared]).append(name)
    return {
        shared: tuple(OfRun(*one, fit.params[one[1]]) for one in zip(captures, every, strict=True))
        for shared, every in apart.items()
    }


def document(parameters: Mapping[str, tuple[OfRun, ...]]) -> list[dict[str, Any]]:
    """Return them as documents have them."""
    return [
        {
            "param": param,
            "capture": one.capture,
            "name": one.name,
            "value": one.estimate.value,
            "ci95": list(one.estimate.ci95) if one.estimate.determined else None,
            "unit": one.estimate.unit,
        }
        for param, every in parameters.items()
        for one in every
    ]


def in_words(parameters: Mapping[str, tuple[OfRun, ...]]) -> list[str]:
    """Return what the captures do not share, a sentence for each parameter."""
    said = []
    for param, (first, *others) in parameters.items():
        values = [f"{one.estimate.value:.4g} in {one.capture}" for one in (first, *others)]
        # What nothing else could tell from the other parameters is counted from the first.
        beside = f", counted from {first.capture}" if first.estimate.se == 0.0 else ""
        unit = first.estimate.unit
        said.append(f"{param} differs between the captures ({unit}{beside}): {', '.join(values)}")
    return said
