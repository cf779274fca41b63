"""Measured and modelled torque over position and over velocity, whole and with one part isolated."""

from __future__ import annotations

from typing import TYPE_CHECKING, Literal, NamedTuple

import numpy as np

from ...errors import InputError
from .components import SHORT, Samples, curve, curve_band, effects_of
from .style import (
    BAND,
    BLACK,
    FITTED,
    RAW,
    VERMILLION,
    Picture,
    legend_above,
    motion_units,
    source_of,
    styled,
    torque_scale,
    torque_symbol,
    torque_word,
)
from .thin import envelope, some

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from ...base.arrays import FloatArray
    from ...fit import Fit

Coordinate = Literal["position", "velocity"]
Window = tuple[float, float]
_GRID = 3000


@styled
def position(fit: Fit, *, zoom: Window | None = None, zoom_y: Window | None = None) -> Picture:
    """Torque over position, whole (top) and its position part isolated (bottom), with the 95 % band.

    Figures 14, 17, 20 and 21 of the paper. `zoom` in rad (m), `zoom_y` in the unit of the picture.
    """
    return _two_rows(fit, "position", zoom, zoom_y)


@styled
def velocity(fit: Fit, *, zoom: Window | None = None, zoom_y: Window | None = None) -> Picture:
    """Torque over velocity, whole (top) and its velocity part isolated (bottom), with the 95 % band.

    Figures 11, 12, 15, 18 and 22 of the paper. `zoom` in rad/s (m/s), `zoom_y` in the unit of the picture.
    """
    return _two_rows(fit, "velocity", zoom, zoom_y)


@styled
def fit(fit: Fit) -> Picture:
    """Torque over position and over velocity, whole and isolated, and the residual over time."""
    figure = Picture(11.0, 8.2, headline(fit))
    grid = figure.add_gridspec(3, 2, height_ratios=[1.0, 1.0, 0.5])
    for column, over in enumerate(_COORDINATES):
        view = _View.of(fit, over)
        _whole(figure.add_subplot(grid[0, column]), view)
        _isolated(figure.add_subplot(grid[1, column]), view)
    residual_over_time(figure.add_subplot(grid[2, :]), fit)
    return figure


@styled
def zoom(fit: Fit, *, position: Window | None = None, velocity: Window | None = None) -> Picture:
    """Close views of the isolated parts over position and velocity (Figures 8, 13, 16, 19 and 23).

    Windows in rad and rad/s (m and m/s); by default two detents, and the reversal with its step of friction.
    A part that the model does not have is left out unless its window is given.
    """
    windows: dict[Coordinate, Window | None] = {"position": position, "velocity": velocity}
    shown = [over for over in _COORDINATES if windows[over] or effects_of(fit.model, over)]
    shown = shown or list(_COORDINATES)
    figure = Picture(8.5, 0.8 + 3.1 * len(shown), headline(fit))
    for i, over in enumerate(shown):
        view = _View.of(fit, over, windows[over] or _busiest(fit, over))
        _isolated(figure.add_subplot(len(shown), 1, i + 1), view)
    return figure


_COORDINATES: tuple[Coordinate, ...] = ("position", "velocity")


def headline(fit: Fit) -> str:
    """Return what was fitted and how well, for the top of a picture."""
    first = fit.prepared[0].capture
    scale = torque_scale(fit.model.torque_unit, _peak(fit))
    more = f" and {len(fit.prepared) - 1} more" if len(fit.prepared) > 1 else ""
    rmse, floor = fit.rmse * scale.factor, fit.noise_floor * scale.factor
    noise = "unknown" if np.isnan(floor) else f"alone {floor:.3g} {scale.unit}"
    return f"{source_of(first)}{more}\nRMS error {rmse:.3g} {scale.unit}, sensor noise {noise}"


def residual_over_time(axes: Axes, fit: Fit) -> None:
    """Draw the residual of every capture over time, beside twice the noise floor."""
    scale = torque_scale(fit.model.torque_unit, _peak(fit))
    start = 0.0
    for signals, rest in zip(fit.prepared, fit.residuals, strict=True):
        t = np.full(len(rest), np.nan)
        t[signals.rows] = signals.t + start
        kept = signals.rows
        axes.plot(*envelope(t[kept], rest[kept] * scale.factor), color=RAW, lw=0.5, rasterized=True)
        start += float(signals.t[-1]) if len(signals.t) else 0.0
    if np.isfinite(fit.noise_floor):
        two = 2.0 * fit.noise_floor * scale.factor
        axes.axhspan(-two, two, color=BAND, alpha=0.35, lw=0, zorder=0.5, label="±2 × sensor noise")
    axes.axhline(0.0, color=BLACK, lw=0.6)
    axes.set_title("Residual")
    axes.set_xlabel("time (s)")
    axes.set_ylabel(f"measured − fit ({scale.unit})")
    legend_above(axes)


class _View(NamedTuple):
    """What one column of pictures shows: the samples, their coordinate, and the window on it."""

    samples: Samples
    over: Coordinate
    x: FloatArray
    window: Window
    y: Window | None
    close: bool

    @classmethod
    def of(cls, fit: Fit, over: Coordinate, window: Window | None = None, y: Window | None = None) -> _View:
        for name, limits in (("zoom", window), ("zoom_y", y)):
            if limits is not None and not limits[0] < limits[1]:
                raise InputError(f"{name}={limits} is no window; give (low, high)")
        samples = Samples(fit)
        x = samples.theta if over == "position" else samples.omega
        # A speed that never changes still has a width that ticks can be written along.
        pad = max(0.01 * float(np.ptp(x)), 0.01 * float(np.max(np.abs(x))), 1e-9)
        whole = (float(x.min()) - pad, float(x.max()) + pad)
        return cls(samples, over, x, window or whole, y, window is not None)


def _two_rows(fit: Fit, over: Coordinate, window: Window | None, y: Window | None) -> Picture:
    figure = Picture(8.5, 7.2, headline(fit))
    view = _View.of(fit, over, window, y)
    top = figure.add_subplot(2, 1, 1)
    _whole(top, view)
    _isolated(figure.add_subplot(2, 1, 2, sharex=top), view)
    return figure


def _whole(axes: Axes, view: _View) -> None:
    """Raw and fitted torque, every sample a dot: over one coordinate they are many-valued."""
    unit = view.samples.fit.torque_unit
    scale = torque_scale(unit, _peak(view.samples.fit))
    symbol = f"${torque_symbol(unit)}$"
    rows = some((view.x >= view.window[0]) & (view.x <= view.window[1]))
    x, size = view.x[rows], _dot(len(rows))
    fitted = view.samples.modelled[rows] * scale.factor
    band = view.samples.band[rows] * scale.factor
    _dots(axes, x, view.samples.tau[rows] * scale.factor, RAW, 1.4 * size, f"Raw {symbol}")
    _dots(axes, np.concatenate([x, x]), np.concatenate([fitted - band, fitted + band]), BAND, size, "95 % CI")
    _dots(axes, x, fitted, FITTED, size, f"Fit {symbol}")
    word = torque_word(unit)
    _finish(axes, view, f"{word.capitalize()} over {view.over}", f"{word} {symbol} ({scale.unit})")


def _isolated(axes: Axes, view: _View) -> None:
    """The raw torque without the rest of the model, and the curve of the part by itself."""
    fit, part = view.samples.fit, view.over
    scale = torque_scale(fit.model.torque_unit, _peak(fit))
    rows = some((view.x >= view.window[0]) & (view.x <= view.window[1]))
    name = f"${torque_symbol(fit.model.torque_unit)}_\\mathrm{{{SHORT[part]}}}$"
    raw = view.samples.isolated(part)[rows] * scale.factor
    _dots(axes, view.x[rows], raw, RAW, 1.4 * _dot(len(rows)), f"Raw {name}")
    at = _grid(view)
    line = curve(fit.model, part, at) * scale.factor
    band = curve_band(fit, part, at) * scale.factor
    axes.fill_between(at, line - band, line + band, color=BAND, alpha=0.55, lw=0, zorder=2.5, label="95 % CI")
    axes.plot(at, line, color=VERMILLION, lw=0.9 if view.close else 1.4, zorder=3, label=f"Fit {name}")
    title = f"{part.capitalize()} part isolated" if effects_of(fit.model, part) else f"No {part} part"
    _finish(axes, view, title, f"{name} ({scale.unit})")


def _grid(view: _View) -> FloatArray:
    """Return even points over the window; over velocity both sides of zero, where friction steps."""
    at = np.linspace(*view.window, _GRID)
    if view.over == "velocity" and view.window[0] < 0.0 < view.window[1]:
        tiny = 1e-9 * (view.window[1] - view.window[0])
        at = np.sort(np.concatenate([at[at != 0.0], [-tiny, tiny]]))
    return at


def _finish(axes: Axes, view: _View, title: str, label: str) -> None:
    unit = motion_units(view.samples.fit.model.coordinate)["theta" if view.over == "position" else "omega"]
    axes.set_xlim(*view.window)
    if view.y is not None:
        axes.set_ylim(*view.y)
    axes.set_title(title)
    axes.set_xlabel(f"{view.over} ({unit})")
    axes.set_ylabel(label)
    legend_above(axes)


def _dots(axes: Axes, x: FloatArray, y: FloatArray, color: str, size: float, label: str) -> None:
    axes.plot(x, y, ".", color=color, ms=size, mew=0, rasterized=True, label=label)
    axes.lines[-1].set_alpha(0.5)


def _dot(count: int) -> float:
    """Return a marker size, in points, that keeps dots apart as far as possible."""
    return float(np.clip(200.0 / np.sqrt(max(count, 1)), 1.8, 3.5))


def _busiest(fit: Fit, over: Coordinate) -> Window:
    """Return two detents (a tenth of the range without detents) where most samples are, or the reversal."""
    samples = Samples(fit)
    if over == "velocity":
        reach = 0.12 * float(np.max(np.abs(samples.omega)))
        return -reach, reach
    low, high = float(samples.theta.min()), float(samples.theta.max())
    width = 0.1 * (high - low)
    if fit.model.period is not None:
        width = min(4.0 * np.pi * fit.model.period, high - low)
    cells = int(np.clip((high - low) / width, 1, 1000))
    counts, edges = np.histogram(samples.theta, cells)
    at = int(np.argmax(counts))
    middle = 0.5 * float(edges[at] + edges[at + 1])
    middle = float(np.clip(middle, low + width / 2, high - width / 2))
    return middle - width / 2, middle + width / 2


def _peak(fit: Fit) -> float:
    return max(float(np.max(np.abs(s.tau[s.used]), initial=0.0)) for s in fit.prepared)
