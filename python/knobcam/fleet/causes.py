"""What physically is behind a part that is not OK, with its size: against its limit, and what is usual."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Mapping, Sequence
from typing import NamedTuple

import numpy as np

from ..model.effects import Effect, effects
from .limits import UNIT, Between, Failed, Limits
from .outliers import FEWEST, deviations
from .row import Row

_UNUSUAL = 3.0
"""Robust standard deviations from its lot at which a parameter may be behind a curve beyond its band."""
_TIMES = 3.0  # from which on a value is said as so many times another
_MOST = 3  # parameters that are said of one part


class Usual(NamedTuple):
    """What is usual in a lot, by other parts of it: values of parameters, and how many fail or have what."""

    values: Mapping[str, Sequence[float]]
    have: Counter[str]
    parts: int

    @classmethod
    def of(cls, rows: Sequence[Row], limits: Limits | None) -> Usual:
        """Return what is usual in rows of one lot and of one kind of axis and unit."""
        values: dict[str, list[float]] = {}
        have: Counter[str] = Counter()
        for row in rows:
            for name, (value, *_) in row["params"].items():
                if value is not None:
                    values.setdefault(name, []).append(value)
            have.update(row["found"])
            if limits is not None:
                have.update({one.limit for one in limits.failed(row)})
        return cls(values, have, len(rows))

    def middle(self, name: str) -> float | None:
        """Return the median of a parameter; None where too few tell it."""
        some = self.values.get(name, ())
        return float(np.median(some)) if len(some) >= FEWEST else None

    def others(self, what: str) -> str:
        """Say how many others fail a limit, or have an effect, as this one does."""
        many, too = self.parts - 1, self.have[what] - 1
        return f"; {too} of {many} others of its lot too" if many > 0 else ""


def cause(
    row: Row, failed: Sequence[Failed], unlike: Sequence[str], limits: Limits | None, usual: Usual
) -> str | None:
    """Return what physically is behind a part that fails or is unlike its lot, in words; None for nothing.

    Effects that were found first; or that none explains it. Then the parameters beyond their limits, and
    where none of all that is there, those that are unlike the lot.
    """
    if row["error"] is not None:
        return None
    known = effects(row["coordinate"])
    said = [_found(row, known[name], usual) for name in row["found"] if name in known]
    if not said and row["verdict"] == "unexplained":
        said = [str(row["headline"])]
    names = [one.limit for one in failed if _effect(one.limit) in known]
    beyond = [_beyond(row, name, known[_effect(name)], limits, usual) for name in names]
    if not said and not beyond and (failed or unlike):
        own = [name for name in unlike if _effect(name) in known]
        if any(one.limit.startswith("curve.") for one in failed):
            own = own or _unusual(row, usual)
        beyond = [_unlike(row, name, known[_effect(name)], usual) for name in own]
    if len(beyond) > _MOST:
        beyond = [*beyond[:_MOST], f"and {len(beyond) - _MOST} more"]
    if said or beyond:
        return "; ".join(dict.fromkeys(said + beyond))
    # What is only unlike its lot by its error, or in another unit than its limits, is no fault with a cause.
    faulty = any(one.limit != UNIT for one in failed)
    return "not named: nothing was found missing, and no parameter is unusual" if faulty else None


def _effect(name: str) -> str:
    return name.partition(".")[0]


def _found(row: Row, effect: Effect, usual: Usual) -> str:
    """Say what was found missing: its size, and how many others of the lot have it."""
    size = ""
    if effect.params and (known := row["params"].get(f"{effect.id}.{effect.params[0].name}")):
        value, low, high = known
        name = f"{effect.id}.{effect.params[0].name}"
        ends = "" if low is None or high is None else f" ({low:.3g} to {high:.3g})"
        size = (
            f", {_meaning(name, effect)} {value:.3g} {row['units'][name]}{ends}" if value is not None else ""
        )
    return f"{effect.id}: {effect.name}{size}{usual.others(effect.id)}"


def _beyond(row: Row, name: str, effect: Effect, limits: Limits | None, usual: Usual) -> str:
    """Say by how much a parameter is beyond its limit, and what is usual."""
    what, unit = _meaning(name, effect), row["units"].get(name, "")
    value = row["params"].get(name, [None])[0]
    held = None if limits is None else limits.of(name)
    if value is None or held is None:
        return f"{effect.id}: {what} is not determined by the capture"
    edge, side, most = _edge(held, value)
    middle = usual.middle(name)
    normal = "" if middle is None else f"; usual in its lot is {middle:.4g}"
    by = _share(value, edge, side, unit)
    return (
        f"{effect.id}: {what} {by} its limit ({value:.4g} {unit}, {most} {edge:.4g}){normal}"
        f"{usual.others(name)}"
    )


def _unlike(row: Row, name: str, effect: Effect, usual: Usual) -> str:
    """Say how far a parameter is from what is usual."""
    what, unit = _meaning(name, effect), row["units"].get(name, "")
    first = row if row.get("first") is None else row["first"]  # by which lots are compared
    value, middle = first["params"].get(name, [None])[0], usual.middle(name)
    if value is None or middle is None:
        return f"{effect.id}: {effect.name}"
    by = _share(value, middle, "above" if value > middle else "below", unit)
    return f"{effect.id}: {what} {by} what is usual in its lot ({value:.4g} {unit}, usually {middle:.4g})"


def _edge(held: Between, value: float) -> tuple[float, str, str]:
    return (held.high, "above", "at most") if value > held.high else (held.low, "below", "at least")


def _share(value: float, edge: float, side: str, unit: str) -> str:
    """Say how far a value is from another, in per cent or as many times it where that says something."""
    ratio = value / edge if edge else math.nan
    if ratio >= _TIMES:
        return f"{ratio:.3g} times"
    if ratio > 0.0:
        return f"{100.0 * abs(ratio - 1.0):.3g} % {side}"
    return f"{abs(value - edge):.3g} {unit} {side}"


def _meaning(name: str, effect: Effect) -> str:
    """Return what a parameter is, in few words, and its name."""
    own = name.partition(".")[2]
    meaning = next((one.meaning for one in effect.params if one.name == own.partition("@")[0]), effect.title)
    return f"{meaning.partition(',')[0]} ({name})"


def _unusual(row: Row, usual: Usual) -> list[str]:
    """Return the parameters of a part that are far from its lot's, the farthest first."""
    known = effects(row["coordinate"])
    far = {}
    for name, (value, *_) in row["params"].items():
        some = usual.values.get(name, ())
        if value is not None and len(some) >= FEWEST and _effect(name) in known:
            all_of_them = np.array([*some, value])
            far[name] = abs(float(deviations(all_of_them, np.zeros(len(all_of_them)))[-1]))
    return [name for name in sorted(far, key=far.__getitem__, reverse=True) if far[name] > _UNUSUAL]
