"""What the base model cannot explain of a torque, by plain least squares of Equation 1."""

import numpy as np

from .loads import Loads
from .motions import Floats, Track
from .sensors import EDGE, filtered


class Base:
    """Equation 1 on one motion, linear about the knob's true detent, through the measurement filter."""

    def __init__(self, track: Track, p: Loads) -> None:
        forth = track.omega > 0.0
        columns = [track.alpha, 1.0 * forth, 1.0 * ~forth, track.omega * forth, track.omega * ~forth]
        if p.detent != 0.0:
            turned = track.theta / p.period + p.phase
            # The last column is the derivative by the period.
            columns += [np.sin(turned), np.cos(turned), track.theta * np.cos(turned)]
        self._q = np.linalg.qr(_kept(np.stack(columns, 1)))[0]

    def left(self, torque: Floats, *others: Floats) -> float:
        """RMS of what neither Equation 1 nor the signatures `others` explain of a torque, N m."""
        rest = self.rest(torque)
        if others:
            known = np.stack([self.rest(other) for other in others], 1)
            rest = rest - known @ np.linalg.lstsq(known, rest, rcond=None)[0]
        return float(np.sqrt(np.mean(rest**2)))

    def rest(self, torque: Floats) -> Floats:
        """What Equation 1 leaves of a torque, through the filter and without the edges, N m."""
        kept = _kept(torque)
        return kept - self._q @ (self._q.T @ kept)


def _kept(values: Floats) -> Floats:
    return filtered(values)[EDGE:-EDGE]
