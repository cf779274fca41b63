"""The rig's sensors: the torque's lag, drift and limit, and the noise of all of them."""

from typing import NamedTuple

import numpy as np
from scipy import signal

from .motions import Floats, Track

RATE_HZ = 5000.0
TAU_SD, OMEGA_SD, ALPHA_SD = 1.8e-3, 5e-3, 0.41
TAU_STEP, OMEGA_STEP, ALPHA_STEP, THETA_STEP = 1.8e-4, 2e-4, 0.028, 9.8e-6
RANGE = 0.18  # N m, where the rig's torque sensor ends
EDGE = 200  # samples at either end that no figure counts: the filter's transients
SOS = signal.cheby2(3, 20.0, 500.0, fs=RATE_HZ, output="sos")
# What the filter, passed twice, leaves of the torque's noise and rounding, N m.
_GAIN = np.abs(signal.sosfreqz(SOS, 4096)[1]) ** 2
FLOOR = float(np.sqrt(np.mean(_GAIN**2) * (TAU_SD**2 + TAU_STEP**2 / 12.0)))


def filtered(torque: Floats) -> Floats:
    """The paper's measurement filter, forward and backward."""
    return signal.sosfiltfilt(SOS, torque, axis=0)


class Sensor(NamedTuple):
    """What the torque channel does to the torque: late by `delay_s` and by a lag, drifting, clipped.

    `share` is the limit relative to the largest torque.
    """

    delay_s: float = 0.0
    lag_s: float = 0.0
    drift: Floats = np.zeros(1)
    share: float = np.inf

    def late(self, t: Floats, tau: Floats) -> Floats:
        """The torque that the channel shows, before its noise and its limit."""
        if self.delay_s > 0.0:
            tau = np.interp(t - self.delay_s, t, tau)
        if self.lag_s > 0.0:
            keep = np.exp(-(t[1] - t[0]) / self.lag_s)
            tau = signal.lfilter([1.0 - keep], [1.0, -keep], tau, zi=[keep * tau[0]])[0]
        return tau + self.drift


def rounded(values: Floats, step: float) -> Floats:
    return np.round(values / step) * step


def measured(
    rng: np.random.Generator, track: Track, tau: Floats, limit: float, keep: float = 0.0
) -> dict[str, Floats]:
    """The capture's columns; `keep` is what the torque's noise keeps of itself from row to row: AR(1)."""
    n = len(track.t)
    noise = signal.lfilter([np.sqrt(1.0 - keep**2)], [1.0, -keep], rng.standard_normal(n))
    torque = rounded(tau + TAU_SD * noise, TAU_STEP)
    omega = track.omega + OMEGA_SD * rng.standard_normal(n)
    alpha = track.alpha + ALPHA_SD * rng.standard_normal(n)
    return {
        "t_s": track.t,
        "theta_rad": rounded(track.theta, THETA_STEP),
        "omega_rad_s": rounded(omega, OMEGA_STEP),
        "alpha_rad_s2": rounded(alpha, ALPHA_STEP),
        "tau_Nm": np.clip(torque, -limit, limit),
    }
