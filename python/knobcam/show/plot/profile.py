"""Weir's haptic profile: what a hand feels, as torque coloured over position and velocity."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from ...fit import Fit
from .components import Samples
from .style import GREY, Picture, motion_units, source_of, styled, torque_scale, torque_word
from .thin import some
from .torques import headline

if TYPE_CHECKING:
    from ...base.arrays import FloatArray
    from ...capture import Capture


@styled
def haptic_profile(source: Fit | Capture) -> Picture:
    """Torque coloured over position and velocity (Weir, Peshkin, Colgate, Buttolo, Rankin & Johnston 2004).

    Of a fit: measured and modelled side by side in one scale.
    """
    if isinstance(source, Fit):
        samples = Samples(source)
        theta, omega, torque_unit = samples.theta, samples.omega, source.torque_unit
        panels = {"Measured": samples.tau, "Modelled": samples.modelled}
        title = headline(source)
    else:
        signals = source.prepare()
        used = signals.used
        theta, omega, torque_unit = signals.theta[used], signals.omega[used], source.torque_unit
        panels = {"Measured": signals.tau[used]}
        title = source_of(source)
    coordinate = source.model.coordinate if isinstance(source, Fit) else source.coordinate
    return _profile(theta, omega, panels, coordinate, torque_unit, title)


def _profile(
    theta: FloatArray,
    omega: FloatArray,
    panels: dict[str, FloatArray],
    coordinate: str,
    torque_unit: str,
    title: str,
) -> Picture:
    every = np.concatenate(list(panels.values()))
    # A few spikes must not take the colour from all the rest.
    peak = float(np.quantile(np.abs(every), 0.998)) or 1.0
    scale = torque_scale(torque_unit, peak)
    units = motion_units(coordinate)
    figure = Picture(5.6 * len(panels) + 1.0, 5.0, title)
    rows = np.random.default_rng(0).permutation(some(np.ones(len(theta), dtype=bool)))
    first = None
    for i, (name, tau) in enumerate(panels.items()):
        axes = first = figure.add_subplot(1, len(panels), i + 1, sharex=first, sharey=first)
        axes.axhline(0.0, color=GREY, lw=0.6, zorder=0.5)
        dots = axes.scatter(
            theta[rows],
            omega[rows],
            c=tau[rows] * scale.factor,
            s=5.0,
            lw=0,
            cmap="RdYlBu_r",
            vmin=-peak * scale.factor,
            vmax=peak * scale.factor,
            rasterized=True,
        )
        axes.set_facecolor("#F2F2F2")
        axes.set_title(name)
        axes.set_xlabel(f"position ({units['theta']})")
        axes.set_ylabel(f"velocity ({units['omega']})")
    figure.colorbar(
        dots, ax=figure.axes, label=f"{torque_word(torque_unit)} ({scale.unit})", extend="both", pad=0.01
    )
    return figure
