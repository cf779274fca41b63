"""What a delay allows: stiffness over delay, and where a device and a model are."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from .style import BLACK, FITTED, GREY, WRONG, Picture, styled

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from ...render import Stability

_DELAYS = range(0, 51)


@styled
def stability(found: Stability) -> Figure:
    """Draw the stiffness that the device allows over its delay, with the model's as a line."""
    from ...render import check_stability

    rows = [
        check_stability(found.model, replace(found.device, delay_samples=n), rate_hz=found.rate_hz).figures
        for n in _DELAYS
    ]

    def column(name: str) -> np.ndarray:
        return np.array([row[name] for row in rows])

    delay = 1e3 * column("delay_s")
    rings = "does not ring" if found.stable else "rings"
    picture = Picture(7.2, 4.4, f"{found.model.name or 'The model'}: {rings} on this device")
    ax = picture.subplots()
    ax.loglog(delay, column("allowed_stiffness_Nm_rad"), color=FITTED, label="allowed: phase margin 50°")
    ax.loglog(
        delay, column("passive_stiffness_Nm_rad"), color=GREY, ls="--", label="passive: any hand, no friction"
    )
    own = found.figures["stiffness_Nm_rad"]
    if own > 0.0:
        ax.axhline(own, color=WRONG, label=f"the model's stiffest place: {own:.3g} N m/rad")
    ax.axvline(
        1e3 * found.figures["delay_s"],
        color=BLACK,
        lw=0.8,
        ls=":",
        label=f"this device: {1e3 * found.figures['delay_s']:.3g} ms",
    )
    ax.set_xlabel("delay from a measurement to its torque, ms")
    ax.set_ylabel("stiffness, N m/rad")
    ax.legend(loc="upper right")
    return picture
