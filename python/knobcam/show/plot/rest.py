"""What a fit leaves: the residual over time, its distribution and spectrum; and the scan for detents."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from ...errors import InputError
from .failures import lines_shown
from .style import BAND, BLUE, GREY, RAW, VERMILLION, Picture, legend_above, styled, torque_scale
from .torques import headline, residual_over_time

if TYPE_CHECKING:
    from ...fit import Fit


@styled
def residual(fit: Fit) -> Picture:
    """The residual over time, and its histogram and spectrum beside what sensor noise alone leaves."""
    rest = fit.residual[np.isfinite(fit.residual)]
    scale = torque_scale(fit.model.torque_unit, float(np.max(np.abs(rest), initial=0.0)))
    figure = Picture(10.0, 6.4, headline(fit))
    grid = figure.add_gridspec(2, 2)
    residual_over_time(figure.add_subplot(grid[0, :]), fit)
    left, right = figure.add_subplot(grid[1, 0]), figure.add_subplot(grid[1, 1])
    reach = 1.1 * float(np.max(np.abs(rest), initial=0.0)) or 1.0
    reach = min(reach, 6.0 * fit.rmse) if fit.rmse > 0.0 else reach
    window = (-reach * scale.factor, reach * scale.factor)
    left.hist(rest * scale.factor, bins=100, range=window, color=RAW, density=True)
    if fit.noise_floor > 0.0:
        sd = fit.noise_floor * scale.factor
        x = np.linspace(-reach, reach, 400) * scale.factor
        normal = np.exp(-0.5 * (x / sd) ** 2) / (np.sqrt(2.0 * np.pi) * sd)
        left.plot(x, normal, color=BLUE, lw=1.5, label="sensor noise alone")
    left.set_xlim(*window)
    left.set_title("Distribution")
    left.set_xlabel(f"residual ({scale.unit})")
    left.set_ylabel(f"density (1/{scale.unit})" if " " not in scale.unit else f"density (1/({scale.unit}))")
    legend_above(left)
    spectrum = fit.compare()["frequency"]
    hz = 0.5 * (spectrum.low + spectrum.high)
    shown = lines_shown(spectrum)
    right.plot(hz[shown], spectrum.mean[shown] * scale.factor, color=RAW, lw=0.8, label="residual")
    if spectrum.band.any():
        noise = spectrum.band[shown] * scale.factor
        right.plot(hz[shown], noise, color=BLUE, lw=1.5, label="95 % of noise below")
    if shown.any():
        right.set(xscale="log", yscale="log")
    right.set_title("Spectrum")
    right.set_xlabel("frequency (Hz)")
    right.set_ylabel(f"RMS per bin ({scale.unit})")
    legend_above(right)
    return figure


@styled
def scan(fit: Fit) -> Picture:
    """The search for detents: the amplitude that fits best at every detent length, the chosen one marked.

    Raises InputError where the fit made no scan.
    """
    if fit.core.scan is None:
        raise InputError("this fit looked for no detents; fit with detents='auto' or 'yes'")
    inverse_period, gain = fit.core.scan
    used = sum(signals.core.used for signals in fit.prepared)
    # A sine of amplitude A takes n A^2 / 2 off the sum of squares.
    amplitude = np.sqrt(2.0 * np.maximum(gain, 0.0) / max(used, 1))
    scale = torque_scale(fit.model.torque_unit, float(np.max(amplitude, initial=0.0)))
    rotary = fit.model.coordinate == "rotary"
    x = inverse_period if rotary else inverse_period / (2.0 * np.pi)
    figure = Picture(9.0, 4.2, headline(fit))
    axes = figure.add_subplot()
    axes.fill_between(x, 0.0, amplitude * scale.factor, color=BAND, alpha=0.35, lw=0)
    axes.plot(x, amplitude * scale.factor, color=GREY, lw=0.9)
    if fit.model.period is not None:
        p = abs(fit.model.period)
        chosen = 1.0 / p if rotary else 1.0 / (2.0 * np.pi * p)
        unit = "a turn" if rotary else "per m"
        label = f"chosen: {chosen:.4g} {unit} (P = {p:.4g} {'rad' if rotary else 'm'})"
        axes.axvline(chosen, color=VERMILLION, lw=1.4, ls="--", label=label)
    axes.set(xscale="log", xlim=(float(x[0]), float(x[-1])))
    axes.set_ylim(0.0, 1.08 * float(np.max(amplitude, initial=0.0)) * scale.factor or 1.0)
    axes.xaxis.set_major_formatter(lambda value, _: f"{value:g}")
    axes.set_title("Search for detents")
    axes.set_xlabel("detents a turn" if rotary else "detents per metre")
    axes.set_ylabel(f"amplitude that fits ({scale.unit})")
    legend_above(axes)
    return figure
