"""A model in another form: its torque along a motion beside the model's, and what is between them."""

from __future__ import annotations

from typing import TYPE_CHECKING

from .style import FITTED, GREY, ORANGE, Picture, legend_above, number, styled, torque_scale
from .thin import envelope

if TYPE_CHECKING:
    from ...render.convert import Conversion


@styled
def converted(found: Conversion) -> Picture:
    """Draw both torques over time, and below them their difference, with the error that was foretold."""
    told, scale = found.measured, torque_scale(found.model.torque_unit, found.measured.torque)
    name = found.model.name or "The model"
    error = found.measured_error
    after = "not measured" if error is None else f"{number(scale.factor * error)} {scale.unit} RMS measured"
    foretold = f"{number(scale.factor * found.predicted_error)} {scale.unit} foretold"
    picture = Picture(9.0, 5.4, f"{name} for {found.target}: {after}, {foretold}")
    above, below = picture.subplots(2, 1, sharex=True, height_ratios=(2, 1))
    t = told.motion.t
    above.plot(*envelope(t, scale.factor * told.exact), color=GREY, lw=1.6, label="the model")
    if told.found is not None:
        above.plot(*envelope(t, scale.factor * told.found), color=FITTED, lw=0.9, label=found.target)
        apart = (told.found - told.exact)[told.moves]
        below.plot(*envelope(t[told.moves], scale.factor * apart), color=ORANGE, lw=0.9, label="difference")
    for side in (-1.0, 1.0):
        label = "RMS as foretold" if side > 0.0 else None
        below.axhline(side * scale.factor * found.predicted_error, color=GREY, lw=0.8, ls="--", label=label)
    gone = [fate.effect for fate in found.fates if fate.left_out]
    if gone:
        above.set_title(f"without {', '.join(gone)}", pad=22.0)
    above.set_ylabel(f"torque ({scale.unit})")
    below.set_ylabel(f"difference ({scale.unit})")
    below.set_xlabel("time (s)")
    for axes in (above, below):
        legend_above(axes)
    return picture
