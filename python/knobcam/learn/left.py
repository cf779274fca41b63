"""What a model leaves, before it has a formula: as a curve, as a map, and of which variables it is."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

if TYPE_CHECKING:
    from collections.abc import Mapping

    from ..base.arrays import BoolArray, FloatArray

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
    """What is left as a smooth function of the two variables `over` times `times`, over their plane.

    `value` and `band`, half the width of its 95 % band, have a row for each place of the second variable.
    They are no numbers where the motion did not go, or too seldom.
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


def mapped(surface: Mapping[str, Any]) -> Map:
    """Return the map of the core."""
    x, y = np.asarray(surface["x"]), np.asarray(surface["y"])
    value, band = (np.asarray(surface[one]).reshape(len(x), len(y)).T for one in ("value", "band"))
    x_name, y_name = surface["over"]
    hidden = np.where(np.isfinite(value), band, np.nan)
    return Map((x_name, y_name), surface["times"], x, y, value, hidden)
