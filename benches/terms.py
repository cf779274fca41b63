"""Every effect of the catalogue that can be written as columns of a regression, for one capture.

Peers get more than a user would give them: the torque through the measurement filter and every column too
(without that, a regression invents Stribeck friction), the true period of the detents, and rows so far apart
that the noise left by the filter is independent.
"""

from typing import NamedTuple

import numpy as np
from hidden import Hidden
from hidden.loads import build_up
from hidden.sensors import EDGE, filtered

Floats = np.ndarray
EVERY = 10  # rows of 5 kHz: what the filter passes ends at 250 Hz


class Terms(NamedTuple):
    """Torque, columns of Equation 1, and of every effect; rows thinned. What BAM's laws ask for besides."""

    torque: Floats
    base: Floats
    effects: dict[str, Floats]
    omega: Floats
    detent: Floats

    def rest(self, columns: Floats) -> Floats:
        """What Equation 1 leaves of some columns."""
        return columns - self.base @ np.linalg.lstsq(self.base, columns, rcond=None)[0]


def thinned(columns: Floats) -> Floats:
    """Through the measurement filter, without the edges, every tenth row."""
    return filtered(columns)[EDGE:-EDGE:EVERY]


def terms(knob: Hidden) -> Terms:
    """The regression of a capture."""
    t, theta, omega, alpha, tau = (knob.capture[name] for name in knob.capture)
    omega, alpha = filtered(omega), filtered(alpha)
    forth, sign, speed = 1.0 * (omega > 0.0), np.sign(omega), np.abs(omega)
    base = [alpha, forth, 1.0 - forth, omega * forth, omega * (1.0 - forth)]
    turned, toothed = theta / knob.knob["detent.P"], knob.knob["detent.A"] > 0.0
    if toothed:
        base += [np.sin(turned), np.cos(turned)]
    whole = np.stack(base, 1)
    torque, columns = thinned(tau), thinned(whole)
    fitted = np.linalg.lstsq(columns, torque, rcond=None)[0]
    said = whole @ fitted
    detent = whole[:, 5:] @ fitted[5:]
    left = filtered(tau - said)
    reach, length = float(np.ptp(theta)), t[-1] - t[0]
    slow, shorter = np.quantile(speed, [0.05, 0.15, 0.35]), np.array([0.1, 0.3, 0.7]) * length
    waves = 2.0 * np.pi / reach * np.arange(1, 5)
    low, high = np.quantile(theta, [0.05, 0.15, 0.25]), np.quantile(theta, [0.95, 0.85, 0.75])
    since = _since_reversal(theta, sign)
    gaps = [1.0 * (since < gap) for gap in (0.003, 0.01, 0.03)]
    effects = {
        "stribeck": [sign * np.exp(-speed / vs) for vs in slow],
        "presliding": [_slip(theta, distance) - sign for distance in (0.003, 0.01, 0.03, 0.1)],
        "quadratic_drag": [omega * speed],
        "position_polynomial": [theta, theta**2, theta**3],
        "return_spring": [theta],
        "unbalance": [np.sin(theta), np.cos(theta)],
        "end_stop": [np.maximum(at - theta, 0.0) for at in low]
        + [np.maximum(theta - at, 0.0) for at in high],
        "position_friction": [sign * wave(k * theta) for k in waves for wave in (np.sin, np.cos)],
        "friction_drift": [sign * np.exp(-t / lasts) for lasts in shorter],
        "torque_drift": [t, t**2, np.exp(-t / shorter[1])],
        "torque_lag": [np.gradient(said, t)],
        "compliance": [np.gradient(np.gradient(filtered(said), t), t)],
        "backlash": [within * other for within in gaps for other in (sign, alpha)],
        "second_detent": _lines(theta, left, np.arange(4.0, 60.0, 0.25) * 2.0 * np.pi / reach, 1),
    }
    if reach > 2.0 * np.pi:
        effects["cogging"] = _lines(theta, left, np.arange(2.0, 90.0), 3)
    if toothed:
        effects["detent_harmonics"] = [wave(n * turned) for n in (2.0, 3.0, 4.0) for wave in (np.sin, np.cos)]
        effects["directional_detent"] = [sign * np.sin(turned), sign * np.cos(turned)]
        effects["load_friction"] = [sign * np.abs(detent)]
    groups = {name: thinned(np.stack(group, 1)) for name, group in effects.items()}
    return Terms(torque, columns, groups, omega[EDGE:-EDGE:EVERY], detent[EDGE:-EDGE:EVERY])


def _since_reversal(theta: Floats, sign: Floats) -> Floats:
    """The way since the motion turned round, rad."""
    turned = np.concatenate([[True], np.diff(sign) != 0.0])
    at = np.maximum.accumulate(np.where(turned, np.arange(len(theta)), 0))
    return np.abs(theta - theta[at])


def _slip(theta: Floats, distance: float) -> Floats:
    """One elastoplastic element that slips after a distance, with a friction of one."""
    ones = np.ones(len(theta))
    return build_up(theta, ones, ones, np.ones(1), np.array([distance]), 1.0)


def _lines(theta: Floats, left: Floats, frequencies: Floats, many: int) -> list[Floats]:
    """Sine and cosine of the spatial frequencies that have most in what Equation 1 leaves."""
    thin = slice(None, None, EVERY)
    found = [abs(np.exp(-1j * frequency * theta[thin]) @ left[thin]) for frequency in frequencies]
    best = frequencies[np.argsort(found)[::-1][:many]]
    return [wave(frequency * theta) for frequency in best for wave in (np.sin, np.cos)]
