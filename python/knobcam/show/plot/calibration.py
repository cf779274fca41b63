"""The sensor tests: commanded and recorded signals (Figures 9 and 10 of the paper), and their differences."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from ...errors import InputError
from .style import BLACK, GREY, WRONG, Picture, styled

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from ...rig.calibration import Calibration, Run


_STILL = 0.05  # rad; an anchored gripper turns by less


@styled
def calibration(found: Calibration) -> Figure:
    """Draw the first spatial and the first torque test: commanded wide and grey, recorded thin, and between.

    Raises InputError for a calibration that was read from its file, which has the figures alone.
    """
    turned = {bool(np.ptp(run.recorded.theta) > _STILL): run for run in reversed(found.tests)}
    moving, still = turned.get(True), turned.get(False)
    rows = (_motion(moving, found) if moving else []) + (_torque(still, found) if still else [])
    if not rows:
        raise InputError("calibration: has no recordings to draw; plot what `calibrate` returns")
    picture = Picture(8.0, 1.9 * len(rows) + 0.6, f"Sensor tests of {found.serial}, {found.date[:10]}")
    axes = np.atleast_1d(picture.subplots(len(rows), 1, sharex=True))
    for ax, (label, t, wanted, recorded) in zip(axes, rows, strict=True):
        ax.plot(t, wanted, color=GREY, lw=3.5, alpha=0.5, label="commanded")
        ax.plot(t, recorded, color=BLACK, lw=0.7, label="recorded")
        ax.plot(t, recorded - wanted, color=WRONG, lw=0.6, label="difference")
        ax.set_ylabel(label)
    axes[0].legend(ncols=3, loc="lower right", bbox_to_anchor=(1.0, 1.0))
    axes[-1].set_xlabel("time, s")
    return picture


_Row = tuple[str, np.ndarray, np.ndarray, np.ndarray]


def _motion(run: Run, found: Calibration) -> list[_Row]:
    wanted, recorded = run.commanded, run.recorded
    n = min(len(wanted.t), recorded.samples)
    alpha = recorded.columns["alpha"][:n] / run.c_cal * (found.c_cal or run.c_cal)
    start = recorded.theta[0] - wanted.theta[0]
    return [
        ("θ, rad", wanted.t[:n], wanted.theta[:n], recorded.theta[:n] - start),
        ("ω, rad/s", wanted.t[:n], wanted.omega[:n], recorded.columns["omega"][:n]),
        ("α, rad/s²", wanted.t[:n], wanted.alpha[:n], alpha),
    ]


def _torque(run: Run, found: Calibration) -> list[_Row]:
    wanted, recorded = run.commanded, run.recorded
    n = min(len(wanted.t), recorded.samples)
    stiffness = found.anchor_Nm_rad or 0.0
    return [("τ, N m", wanted.t[:n], stiffness * wanted.theta[:n], recorded.tau[:n])]
