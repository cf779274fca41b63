"""A capture from a model: the torque that the rig would measure on a commanded motion."""

from __future__ import annotations

import math
import os
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from .. import _core
from ..base.door import checked, described, is_number
from ..capture import Capture
from ..capture.motions import MotionTrack, checked_track
from ..capture.motions import motion as make_motion
from ..errors import InputError
from .model import Model

if TYPE_CHECKING:
    from ..base.arrays import BoolArray, FloatArray


_FARTHEST = 1e3
"""Times the torque on a rigid shaft beyond which a knob behind a joint has run away: no resonance does."""
_FINER = 2, 4, 8, 16, 32, 64
_MOST_SAMPLES = 400_000  # of a motion that is tried at finer steps


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

    @property
    def torque_noise(self) -> float:
        """Standard deviation of all that the torque sensor adds, its steps included."""
        return math.sqrt(self.tau_sd**2 + (self.tau_step**2 + self.tau_uniform**2) / 12.0)

    def reaching(self, torque: float) -> SensorNoise:
        """Return the same with a torque sensor that reaches so far.

        A sensor of twice the range is twice as stiff, and by that twice as noisy and twice as coarse.
        """
        sensors = self
        while sensors.tau_limit < torque < math.inf:
            tau_sd, tau_step, limit = (2.0 * x for x in (sensors.tau_sd, sensors.tau_step, sensors.tau_limit))
            sensors = sensors._replace(tau_sd=tau_sd, tau_step=tau_step, tau_limit=limit)
        return sensors


# Resolutions of Table 1 and standard deviations of Table 4 of the haptic-camera paper; the torque sensor
# saturates at 180 mN m (its Table 8). Two entries are not taken over: Table 4's 3.2 mrad for theta is the
# motor's tracking error (the encoder resolves 9.8 urad), and Table 1's 2.8 rad/s^2 for alpha is coarser than
# the scatter of 0.41 rad/s^2 that Table 4 measured.
RIG = SensorNoise(0.0244, 0.4148, 0.0018, 9.8e-6, 2.0e-4, 1.8e-4, 0.180)
# Equation 6: uniform noise of +-2 N m on the torque alone.
PAPER = SensorNoise(tau_uniform=4.0)
NOISES = {"ranged": RIG, "rig": RIG, "paper": PAPER, "none": SensorNoise()}


@checked
def simulate(
    model: Model | str | os.PathLike[str],
    motion: str | MotionTrack = "sweep",
    *,
    noise: str | SensorNoise = "ranged",
    seed: int = 0,
    duration_s: float = 6.0,
    rate_hz: float = 5000.0,
) -> Capture:
    """Return the capture of a model (or its file or name) on a motion, with the noise of the rig's sensors.

    `motion` is a name (sweep, multisine, turns, hand, micro) or a track; `noise` is `ranged` (the
    sensors of the rig, that of the torque of a range in which the knob stays), `rig` (Tables 1 and 4 of the
    paper: its torque sensor ends at 180 mN m), `paper` (Equation 6), `none`, or a SensorNoise. The same seed
    gives the same capture. With the motion `push` a hand pushes the knob through a spring, and it sticks and
    slips (`karnopp`).

    Raises InputError for a knob behind a joint that runs away: by what drives it, or in steps too long.
    """
    _known(noise)
    if seed < 0:
        raise InputError(f"seed={seed}: give a whole number from 0")
    if not isinstance(model, Model):
        model = Model.load(model)
    track, tau = _made(model, motion, duration_s, rate_hz)
    if model.joint is not None and (since := _runs_away(model, track, tau)) is not None:
        raise InputError(_no_motion(model, motion, float(track.t[-1]), track.rate_hz, since))
    n = len(track.t)
    rig = sensors(noise, float(np.max(np.abs(tau))))
    rng = np.random.default_rng(seed)

    def measured(values: np.ndarray, sd: float, step: float) -> np.ndarray:
        noisy = values + sd * rng.standard_normal(n) if sd > 0.0 else values
        return np.round(noisy / step) * step if step > 0.0 else noisy

    tau = measured(tau, rig.tau_sd, rig.tau_step)
    tau = tau + rig.tau_uniform * (rng.random(n) - 0.5)
    return Capture.from_arrays(
        t=track.t,
        theta=measured(track.theta, 0.0, rig.theta_step),
        omega=measured(track.omega, rig.omega_sd, rig.omega_step),
        alpha=measured(track.alpha, rig.alpha_sd, 0.0),
        tau=np.clip(tau, -rig.tau_limit, rig.tau_limit),
        coordinate=model.coordinate,
        torque_unit=model.torque_unit,
        meta={
            "source": f"simulated {model.name}".strip(),
            "motion": motion if isinstance(motion, str) else "given",
            "noise": {name: value if value < np.inf else None for name, value in rig._asdict().items()},
            "seed": seed,
            "model": model.text(),
        },
    )


def sensors(noise: str | SensorNoise, torque: float) -> SensorNoise:
    """Return the sensors of such a noise, on a knob that asks for so much torque.

    The paper's own saturates at 180 mN m, which its knob 5 exceeds at any speed: its detent has 202 mN m.
    """
    _known(noise)
    if not isinstance(noise, str):
        return noise
    return RIG.reaching(torque) if noise == "ranged" else NOISES[noise]


def _known(noise: str | SensorNoise) -> None:
    if isinstance(noise, str) and noise not in NOISES:
        raise InputError(f"noise={noise!r} is unknown; choose {', '.join(NOISES)}")
    if isinstance(noise, SensorNoise):
        for name, value in noise._asdict().items():
            if not is_number(value) or value < 0.0:
                raise InputError(f"noise.{name}: is {described(value)}; give a number from 0")


def exact(
    coordinate: str,
    track: MotionTrack,
    options: dict[str, float] | None = None,
    torque: FloatArray | None = None,
    counts: BoolArray | None = None,
) -> _core.Signals:
    """Return the signals of a motion that is known exactly; options as the core's.

    Without torque unless one is given; every sample counts unless it is said which.
    """
    n = len(track.t)
    if n < 2:
        raise InputError("motion: a track of fewer than two samples is no motion")
    gaps = np.zeros(n, dtype=bool)
    torque = np.zeros(n) if torque is None else torque
    counts = ~gaps if counts is None else counts
    return _core.prepare(coordinate, track.rate_hz, *track, torque, gaps, counts, "exact", options or {})


def _made(
    model: Model, motion: str | MotionTrack, duration_s: float, rate_hz: float
) -> tuple[MotionTrack, FloatArray]:
    """Return a motion and the torque that makes it, N m."""
    if motion == "push":
        return _pushed(model, duration_s, rate_hz)
    track = make_motion(motion, duration_s, rate_hz) if isinstance(motion, str) else checked_track(motion)
    return track, _torque(model, track)


def _runs_away(model: Model, track: MotionTrack, tau: FloatArray) -> float | None:
    """Return when the knob behind a joint has run away, s: by far more torque than on a rigid shaft."""
    rigid = Model(model.core.only([one for one in model.effects if one != model.joint]))
    lost = ~np.isfinite(track.theta)
    if not lost.any():
        most = _FARTHEST * float(np.max(np.abs(_torque(rigid, track))))
        lost = ~(np.abs(tau) <= most) if math.isfinite(most) else ~np.isfinite(tau)
    return float(track.t[np.argmax(lost)]) if lost.any() else None


def _no_motion(
    model: Model, motion: str | MotionTrack, duration_s: float, rate_hz: float, since: float
) -> str:
    """Return what is said of a knob that has run away: at which rate it does not, where that is known."""
    joint = model.joint
    for finer in _FINER:
        # What is pushed goes in short steps at any rate.
        known = isinstance(motion, str) and motion != "push"
        if not known or finer * rate_hz * duration_s > _MOST_SAMPLES:
            break
        if _runs_away(model, *_made(model, motion, duration_s, finer * rate_hz)) is None:
            return (
                f"model: the knob behind its {joint} runs away by {since:.3g} s, as steps at {rate_hz:.6g} "
                f"Hz are too long for what brakes it; give a rate of {finer * rate_hz:.6g} Hz or more"
            )
    return (
        f"model: the knob behind its {joint} runs away by {since:.3g} s; give a model whose friction opposes "
        f"motion, a heavier knob or a stiffer joint, or far more samples a second than {rate_hz:.6g}"
    )


def _torque(model: Model, track: MotionTrack) -> FloatArray:
    """The torque that moves the knob so: inverse dynamics, N m."""
    return model.core.torque(exact(model.coordinate, track), filtered=False)


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
