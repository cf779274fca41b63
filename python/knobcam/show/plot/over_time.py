"""Motion and torque over time: as recorded, as prepared, and as commanded beside measured."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from ...capture.formats.units import GIVEN
from ...errors import InputError
from .style import (
    BLUE,
    PALE,
    Picture,
    legend_above,
    motion_units,
    shade,
    source_of,
    styled,
    torque_scale,
    torque_symbol,
    torque_word,
)
from .thin import envelope

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from ...base.arrays import BoolArray, FloatArray
    from ...capture import Capture
    from ...capture.motions import MotionTrack
    from ...capture.prepare import Prepared

_NAMES = {"theta": "position θ", "omega": "velocity ω", "alpha": "acceleration α", "tau": "torque τ"}
_LINEAR = {"theta": "position x", "omega": "velocity v", "alpha": "acceleration a", "tau": "force F"}


@styled
def capture(capture: Capture) -> Picture:
    """Motion and torque of a capture over time (Figures 4 and 5 of the paper); masked samples stand out."""
    columns = [name for name in _NAMES if name in capture.columns]
    figure, rows = _stack(capture, columns, source_of(capture))
    t = times(capture)
    for name, axes in zip(columns, rows, strict=True):
        values = capture.columns[name] * _factor(capture, name)
        line(axes, t, np.where(capture.mask, values, np.nan), color=BLUE, lw=0.9)
        _limits(axes, values[capture.mask])
        _mark(axes, t, ~capture.mask)
    legend_above(rows[0])
    return figure


@styled
def prepared(prepared: Prepared) -> Picture:
    """A capture as recorded (wide, grey) and as prepared (thin, blue) over time."""
    capture = prepared.capture
    figure, rows = _stack(capture, list(_NAMES), f"{source_of(capture)}, prepared by '{prepared.method}'")
    t = times(capture)
    for name, axes in zip(_NAMES, rows, strict=True):
        factor = _factor(capture, name)
        if name in capture.columns:
            values = np.where(capture.mask, capture.columns[name] * factor, np.nan)
            line(axes, t, values, color=PALE, lw=3.0, label="as recorded")
        smooth = prepared.on_capture(getattr(prepared, name)) * factor
        line(axes, t, smooth, color=BLUE, lw=0.9, label="as prepared")
        _limits(axes, smooth[np.isfinite(smooth)])
        _mark(axes, t, ~capture.mask)
        if name not in capture.columns:
            axes.set_title("not recorded: derived from the position", fontsize="small")
    legend_above(rows[0])
    return figure


@styled
def overlay(commanded: MotionTrack, capture: Capture, torque: FloatArray | None = None) -> Picture:
    """A commanded motion (wide, grey) and what was measured (thin, blue) over time (Figure 9 of the paper).

    `torque`, shape as `commanded.t`, N m (N), is what theory expects of the torque sensor (Figure 10).

    Raises InputError for a torque of another shape.
    """
    expected = {"theta": commanded.theta, "omega": commanded.omega, "alpha": commanded.alpha}
    if torque is not None:
        if np.shape(torque) != np.shape(commanded.t):
            raise InputError(
                f"torque has shape {np.shape(torque)}, the commanded motion {np.shape(commanded.t)}; "
                "give one value per time"
            )
        expected["tau"] = torque
    columns = [name for name in expected if name in capture.columns]
    figure, rows = _stack(capture, columns, f"{source_of(capture)}, commanded and measured")
    t = times(capture)
    start = float(commanded.t[0])
    for name, axes in zip(columns, rows, strict=True):
        factor = _factor(capture, name)
        line(axes, commanded.t - start, expected[name] * factor, color=PALE, lw=4.5, label="commanded")
        measured = np.where(capture.mask, capture.columns[name] * factor, np.nan)
        line(axes, t, measured, color=BLUE, lw=0.8, label="measured")
        _limits(axes, np.append(measured[np.isfinite(measured)], expected[name] * factor))
        _mark(axes, t, ~capture.mask)
    legend_above(rows[0])
    return figure


def _factor(capture: Capture, name: str) -> float:
    return torque_scale(capture.torque_unit, _peak(capture)).factor if name == "tau" else 1.0


def _peak(capture: Capture) -> float:
    return float(np.max(np.abs(capture.tau[capture.mask]), initial=0.0))


def _stack(capture: Capture, columns: list[str], title: str) -> tuple[Picture, list[Axes]]:
    """Return a figure with one row per column, sharing time, labelled with units."""
    figure = Picture(8.5, 1.1 + 1.55 * len(columns), title)
    units = motion_units(capture.coordinate) | {"tau": torque_scale(capture.torque_unit, _peak(capture)).unit}
    names = _LINEAR if capture.coordinate == "linear" else _NAMES
    if (given := capture.torque_unit) in GIVEN:
        names = names | {"tau": f"{torque_word(given)} ${torque_symbol(given)}$"}
    rows: list[Axes] = []
    for i, name in enumerate(columns):
        axes = figure.add_subplot(len(columns), 1, i + 1, sharex=rows[0] if rows else None)
        axes.set_ylabel(f"{names[name]}\n({units[name]})")
        axes.tick_params(labelbottom=i == len(columns) - 1)
        rows.append(axes)
    rows[-1].set_xlabel("time (s)")
    figure.align_ylabels(rows)
    return figure, rows


def times(capture: Capture) -> FloatArray:
    """Return time since the start; a masked sample, whose stamp may be wrong, lies between its neighbours."""
    if not capture.mask.any():
        return np.arange(capture.samples) / capture.rate_hz
    rows = np.flatnonzero(capture.mask)
    t: FloatArray = np.interp(np.arange(capture.samples), rows, capture.t[rows])
    since: FloatArray = t - t[0]
    return since


def line(axes: Axes, t: FloatArray, values: FloatArray, **options: object) -> None:
    """Draw a line over time, of no more points than show."""
    axes.plot(*envelope(t, values), solid_joinstyle="round", **options)  # type: ignore[arg-type]


def _limits(axes: Axes, good: FloatArray) -> None:
    """Fit the axis to the samples that are good: a masked spike must not flatten them."""
    if good.size:
        low, high = float(good.min()), float(good.max())
        margin = 0.06 * (high - low) or 0.1 * abs(high) or 1.0
        axes.set_ylim(low - margin, high + margin)


def _mark(axes: Axes, t: FloatArray, masked: BoolArray) -> None:
    """Shade the runs of masked samples."""
    if not masked.any():
        return
    edges = np.flatnonzero(np.diff(np.concatenate([[False], masked, [False]]).astype(np.int8)))
    runs = [(float(t[a]), float(t[b - 1] - t[a])) for a, b in zip(edges[::2], edges[1::2], strict=True)]
    shade(axes, runs, f"masked ({int(masked.sum())} of {len(masked)} samples)")
