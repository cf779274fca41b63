"""What a model leaves, before it has a formula: as a curve, as a map, and of which variables it is."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from .around import Around

if TYPE_CHECKING:
    from collections.abc import Mapping

    from ..base.arrays import BoolArray, FloatArray
    from ..fit import Fit

_SURE = 4.0  # times the usual half-width of the band


class Curve(NamedTuple):
    """What is left as a smooth function of `over` times `times`, with half the width of its 95 % band.

    `laws` has the curves of the first laws by their formulas: what the parameters of the model can absorb is
    taken off all of them alike.
    """

    over: str
    times: str
    x: FloatArray
    value: FloatArray
    band: FloatArray
    laws: Mapping[str, FloatArray]

    @property
    def known(self) -> BoolArray:
        """Where the motion went often enough for the curve to be looked at."""
        known: BoolArray = self.band < _SURE * np.nanmedian(self.band)
        return known


class Map(NamedTuple):
    """What is left over the plane of the two variables `over`, by `times`: its mean around each place.

    `value` and `band`, half the width of the 95 % band of a smooth surface through it, have a row for each
    place of the second variable. They are no numbers where the motion did not go, or too seldom.
    """

    over: tuple[str, str]
    times: str
    x: FloatArray
    y: FloatArray
    value: FloatArray
    band: FloatArray


class Need(NamedTuple):
    """Variables of a curve or a surface without a formula.

    `heldout` is what remains on blocks that it did not see, as a share of the error without it, `p_value` how
    often the best of all takes off as much where nothing is missing.
    """

    variables: tuple[str, ...]
    heldout: float
    p_value: float


def drawn(curve: Mapping[str, Any], laws: list[str]) -> Curve:
    """Return the curve of the core, with these laws on it."""
    return Curve(
        curve["over"],
        curve["times"],
        np.asarray(curve["x"]),
        np.asarray(curve["value"]),
        np.asarray(curve["band"]),
        {law: np.asarray(one) for law, one in zip(laws, curve["laws"], strict=False)},
    )


def mapped(surface: Mapping[str, Any], beside: Fit) -> Map:
    """Return the map of what a fit leaves, where the core's surface is known."""
    x, y = np.asarray(surface["x"]), np.asarray(surface["y"])
    value, band = (np.asarray(surface[one]).reshape(len(x), len(y)).T for one in ("value", "band"))
    x_name, y_name = surface["over"]
    hidden = np.where(np.isfinite(value), band, np.nan)
    smooth = Map((x_name, y_name), surface["times"], x, y, value, hidden)
    measured = Around(beside.prepared, smooth).mean(beside.residual)
    return smooth._replace(value=measured, band=np.where(np.isfinite(measured), hidden, np.nan))
