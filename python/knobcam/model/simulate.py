"""A capture from a model: the torque that the rig would measure on a commanded motion."""

from __future__ import annotations

import os
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from .. import _core
from ..capture import Capture
from ..capture.motions import MotionTrack
from ..capture.motions import motion as make_motion
from ..errors import InputError
from .model import Model

if TYPE_CHECKING:
    from ..base.arrays import FloatArray


class SensorNoise(NamedTuple):
    """What the sensors add: standard deviations, resolutions and the torque limit, SI; 0 for none."""

    omega_sd: float = 0.0
    alpha_sd: float = 0.0
    tau_sd: float = 0.0
    theta_step: float = 0.0
    omega_step: float = 0.0
    tau_step: float = 0.0
    tau_limit: float = np.inf
    tau_uniform: float = 0.0


# Resolutions of Table 1 and standard deviations of Table 4 of the haptic-camera paper; the torque sensor
# saturates at 180 mN m (its Table 8). Two entries are not taken over: Table 4's 3.2 mrad for theta is the
# motor's tracking error (the encoder resolves 9.8 urad), and Table 1's 2.8 rad/s^2 for alpha is coarser than
# the scatter of 0.41 rad/s^2 that Table 4 measured.
RIG = SensorNoise(0.0244, 0.4148, 0.0018, 9.8e-6, 2.0e-4, 1.8e-4, 0.180)
# Equation 6: uniform noise of +-2 N m on the torque alone.
PAPER = SensorNoise(tau_uniform=4.0)
NOISES = {"rig": RIG, "paper": PAPER, "none": SensorNoise()}


def simulate(
    model: Model | str | os.PathLike[str],
    motion: str | MotionTrack = "sweep",
    *,
    noise: str | SensorNoise = "rig",
    seed: int = 0,
    duration_s: float = 6.0,
    rate_hz: float = 5000.0,
) -> Capture:
    """Return the capture of a model (or its file or name) on a motion, with the noise of the rig's sensors.

    `motion` is a name (sweep, multisine, turns, hand, micro) or a track; `noise` is `rig` (Tables 1 and 4 of
    the paper), `paper` (Equation 6), `none`, or a SensorNoise. The same seed gives the same capture. With
    the motion `push` a hand pushes the knob through a spring, and the knob sticks and slips (`karnopp`).
    """
    if isinstance(noise, str) and noise not in NOISES:
        raise InputError(f"noise={noise!r} is unknown; choose {', '.join(NOISES)}")
    if not isinstance(model, Model):
        model = Model.load(model)
    sensors = NOISES[noise] if isinstance(noise, str) else noise
    if motion == "push":
        track, tau = _pushed(model, duration_s, rate_hz)
    else:
        track = make_motion(motion, duration_s, rate_hz) if isinstance(motion, str) else motion
        tau = _torque(model, track)
    n = len(track.t)
    rng = np.random.default_rng(seed)

    def measured(values: np.ndarray, sd: float, step: float) -> np.ndarray:
        noisy = values + sd * rng.standard_normal(n) if sd > 0.0 else values
        return np.round(noisy / step) * step if step > 0.0 else noisy

    tau = measured(tau, sensors.tau_sd, sensors.tau_step)
    tau = tau + sensors.tau_uniform * (rng.random(n) - 0.5)
    return Capture.from_arrays(
        t=track.t,
        theta=measured(track.theta, 0.0, sensors.theta_step),
        omega=measured(track.omega, sensors.omega_sd, sensors.omega_step),
        alpha=measured(track.alpha, sensors.alpha_sd, 0.0),
        tau=np.clip(tau, -sensors.tau_limit, sensors.tau_limit),
        axis=model.axis,
        meta={
            "source": f"simulated {model.name}".strip(),
            "motion": motion if isinstance(motion, str) else "given",
            "noise": {name: value if value < np.inf else None for name, value in sensors._asdict().items()},
            "seed": seed,
            "model": model.text(),
        },
    )


def _torque(model: Model, track: MotionTrack) -> FloatArray:
    """The torque that moves the knob so: inverse dynamics, N m."""
    n = len(track.t)
    if n < 2:
        raise InputError("motion: a track of fewer than two samples is no motion")
    rate = (n - 1) / float(track.t[-1] - track.t[0])
    exact = _core.prepare(model.axis, rate, *track, np.zeros(n), np.zeros(n, dtype=bool), "none", {})
    return model.core.torque(exact, filtered=False)


def _pushed(model: Model, duration_s: float, rate_hz: float) -> tuple[MotionTrack, FloatArray]:
    """A hand that goes slowly forth and back, resting at each end, and the knob that follows it by jerks."""
    still = make_motion("turns", duration_s, rate_hz, speed=0.5, span=0.5, ramp_s=0.5)
    inertia, _, held, _ = model.core.at_rest()
    holds = max(held)
    # Stiff enough that the hand is a quarter of a radian ahead at breakaway, and damped like a wrist.
    stiffness = 4.0 * holds if holds > 0.0 else 1e3 * inertia
    damping = np.sqrt(stiffness * max(inertia, 0.0))
    theta, omega, alpha, tau = _core.push(model.core, still.theta, 1.0 / rate_hz, stiffness, damping)
    return MotionTrack(still.t, theta, omega, alpha), tau
