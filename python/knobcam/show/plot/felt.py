"""What a hand felt of a rendered model: its torque over angle and over time beside the model's own."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from .style import FITTED, ORANGE, Picture, legend_above, number, styled
from .thin import envelope

if TYPE_CHECKING:
    from ...model import Model
    from ...render import Device
    from ...render.loop_report import LoopReport

_MILLI = 1e3
_SHOWN_S = 0.25  # long enough for some detents, short enough to tell them apart


@styled
def felt(report: LoopReport, model: Model, device: Device) -> Picture:
    """Draw the torque on the hand in the last second of a loop beside the model's along the same motion.

    The torque on the hand is that of the motor and of the handle's own inertia and damping.
    """
    from ...render import Renderer

    last = report.last
    on_hand = last.tau + device.inertia_kg_m2 * last.alpha + device.damping_Nms_rad * last.omega
    alone = Renderer(model, report.rate_hz)
    modelled = alone.along(last.theta, last.omega, last.alpha) if len(last.t) else last.tau
    apart = np.sqrt(np.mean((on_hand - modelled) ** 2)) if len(last.t) else 0.0
    headline = f"{model.name or 'The model'} on a handle: {number(_MILLI * apart)} mN m RMS from the model"
    figure = Picture(10.0, 4.6, headline)
    left, right = figure.subplots(1, 2)
    left.plot(last.theta, _MILLI * on_hand, color=ORANGE, lw=1.0, label="felt by the hand")
    left.plot(last.theta, _MILLI * modelled, color=FITTED, lw=0.9, label="the model along this motion")
    left.set_xlabel("angle (rad)")
    left.set_title("Over angle, last second", pad=22.0)
    shown = last.t >= (last.t[-1] - _SHOWN_S if len(last.t) else 0.0)
    for torque, colour, label in (
        (on_hand, ORANGE, "felt by the hand"),
        (modelled, FITTED, "the model along this motion"),
    ):
        right.plot(*envelope(last.t[shown], _MILLI * torque[shown]), color=colour, lw=1.0, label=label)
    right.set_xlabel("time since the start (s)")
    right.set_title(f"Over time, last {_SHOWN_S:g} s", pad=22.0)
    for axes in (left, right):
        axes.set_ylabel("torque (mN m)")
        legend_above(axes)
    return figure
