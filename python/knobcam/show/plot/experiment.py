"""The motion of the next experiment, how the rivals' torques part on it, and what it would tell."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from ...learn.telling import TOLD, Telling
from .over_time import line
from .style import (
    BLACK,
    BLUE,
    GREEN,
    GREY,
    ORANGE,
    PALE,
    VERMILLION,
    Picture,
    legend_above,
    plain,
    styled,
    torque_word,
)

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from ...learn.experiment import Experiment

_COLOURS = (BLUE, ORANGE, GREEN, VERMILLION)
_LEAST_D = 0.1  # where the axis of D begins


@styled
def experiment(experiment: Experiment) -> Picture:
    """Angle and speed within their limits, the rivals' torques, and D beside that of the standard motions."""
    tells = bool(experiment.rows())
    figure = Picture(8.5, 7.4 if tells else 5.6, plain(experiment.headline, 400))
    grid = figure.add_gridspec(1 + tells, 1, height_ratios=[3.0, 1.0][: 1 + tells])
    inner = grid[0].subgridspec(3, 1)
    axes = [figure.add_subplot(inner[0])]
    axes += [figure.add_subplot(inner[row], sharex=axes[0]) for row in (1, 2)]
    unit, force = experiment.limits.unit, experiment.rivals[0].fit.torque_unit
    limits, track = experiment.limits, experiment.track
    where = f"{'angle' if limits.coordinate == 'rotary' else 'position'} ({unit})"
    _within(axes[0], track.t, track.theta, (limits.theta_min_rad, limits.theta_max_rad), where)
    _within(axes[1], track.t, track.omega, (-limits.omega_rad_s, limits.omega_rad_s), f"speed ({unit}/s)")
    _torques(axes[2], experiment, f"{torque_word(force)} ({force})")
    for axis in axes[:2]:
        axis.tick_params(labelbottom=False)
    axes[2].set_xlabel("time (s)")
    if experiment.sharpened:
        _sharpened(figure.add_subplot(grid[1]), experiment)
    elif tells:
        _told(figure.add_subplot(grid[1]), experiment)
    return figure


def _within(axis: Axes, t: np.ndarray, values: np.ndarray, ends: tuple[float, float], label: str) -> None:
    for end in ends:
        axis.axhline(end, color=GREY, lw=0.8, ls="--")
    line(axis, t, values, color=BLACK, lw=0.9)
    axis.set_ylabel(label)


def _torques(axis: Axes, experiment: Experiment, label: str) -> None:
    telling = Telling(experiment.rivals)
    track = experiment.track
    still = telling.signals(track)
    for rival, colour in zip(experiment.rivals, _COLOURS, strict=False):
        torque = rival.fit.model.core.torque(still, filtered=False)
        line(axis, track.t, torque, color=colour, lw=0.8, label=rival.name)
    axis.set_ylabel(label)
    legend_above(axis)


def _told(axis: Axes, experiment: Experiment) -> None:
    names = [" or ".join(experiment.rivals[i].name for i in one.pair) for one in experiment.expected]
    rows = np.arange(len(names))
    designed = [max(one.d, _LEAST_D) for one in experiment.expected]
    standard = [max(one.standard_d, _LEAST_D) for one in experiment.expected]
    axis.barh(rows - 0.18, designed, 0.34, left=0.0, color=BLUE, label="this motion")
    axis.barh(rows + 0.18, standard, 0.34, left=0.0, color=PALE, label="the best standard motion")
    axis.axvline(TOLD, color=VERMILLION, lw=1.0, ls="--", label="told apart")
    axis.set_xscale("log")
    axis.set_xlim(left=_LEAST_D)
    axis.set_yticks(rows, names)
    axis.invert_yaxis()
    axis.set_xlabel("D: twice the expected logarithm of the evidence")
    legend_above(axis)


def _sharpened(axis: Axes, experiment: Experiment) -> None:
    (one,) = experiment.sharpened
    names = ["now", "after the best standard motion", "after this motion"]
    axis.barh(names, [one.before, one.after_standard, one.after], color=[GREY, PALE, BLUE])
    axis.invert_yaxis()
    unit = experiment.rivals[0].fit.params[one.param].unit
    axis.set_xlabel(f"standard error of {one.param} ({unit})")
