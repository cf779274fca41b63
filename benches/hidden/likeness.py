"""Which textbook laws are like a stranger's torque: its right names, decided from physics alone.

A law is fitted to the torque without noise, Equation 1 beside it, through the measurement filter. What it
leaves is told in RMS over the noise's: far below one, no capture of this length could show the difference.
"""

from collections.abc import Callable

import numpy as np
from scipy.optimize import least_squares, minimize, nnls

from .base import Base
from .bodies import Contact, one_body, two_bodies
from .chain import Chain, Scene
from .impacts import Gap
from .motions import Floats
from .sensors import FLOOR

ALIKE = 0.1  # what another name's law may leave to be as right, and the rest to be nothing but chance
# What the own name's law may leave, of the noise or of the effect's own strength: beyond both, another knob
# is drawn. Not of those that have their name by what they are: a gap is backlash, however it knocks.
STRANGEST, STRANGE_SHARE = 0.3, 0.15
BY_NATURE = {"bristles", "impact_gap"}
# What builds up late takes off the friction that there is at once: at a shaft whose knob has it it would
# push the shaft on.
BUILDS_UP = {"bristles", "presliding"}
EVERY = 4  # rows that a fit looks at: far below them the filter ends
Law = Callable[[Base, Scene, Chain, Floats], float]


def left_by(name: str, scene: Scene, chain: Chain, base: Base) -> float:
    """RMS over the noise's of what a name's textbook law leaves of what the chain adds to the plain knob."""
    own = chain.torque(scene.track)[0] - Chain(scene.knob).torque(scene.track)[0]
    return _LAWS[name](base, scene, chain, base.rest(own)[::EVERY])


def _rms(rest: Floats) -> float:
    return float(np.sqrt(np.mean(rest**2)) / FLOOR)


def _stribeck(base: Base, scene: Scene, chain: Chain, own: Floats) -> float:
    plain = one_body(scene.track, scene.knob)

    def left(p: Floats) -> Floats:
        knob = scene.knob._replace(rise=np.exp(p[0]), vs=np.exp(p[1]), delta=p[2])
        return (base.rest(one_body(scene.track, knob) - plain)[::EVERY] - own) / FLOOR

    starts = [(0.0, speed, delta) for speed in (-3.0, -1.0) for delta in (0.5, 1.0)]
    bounds = ([-7.0, -9.0, 0.25], [4.0, 4.0, 4.0])
    fits = [least_squares(left, start, bounds=bounds, diff_step=1e-3, max_nfev=30) for start in starts]
    return min(float(np.sqrt(np.mean(fit.fun**2))) for fit in fits)


def _presliding(base: Base, scene: Scene, chain: Chain, own: Floats) -> float:
    """Slip elements at 24 distances; shares are positive."""
    plain = one_body(scene.track, scene.knob)

    def element(distance: float) -> Floats:
        sliding = scene.knob._replace(weights=np.ones(1), distances=np.array([distance]))
        return base.rest(one_body(scene.track, sliding) - plain)[::EVERY]

    columns = [element(distance) for distance in np.geomspace(1e-4, 0.5, 24)]
    return float(nnls(np.stack(columns, 1), own)[1] / np.sqrt(len(own)) / FLOOR)


def _backlash(base: Base, scene: Scene, chain: Chain, own: Floats) -> float:
    """A spring and a damper beyond the gap, from those that ring and bounce as the stranger does."""
    assert isinstance(chain.contact, Gap)
    gap, restitution, _, share = chain.contact
    inertia = share * scene.knob.inertia
    plain = one_body(scene.track, scene.knob)

    def left(p: Floats) -> float:
        ring, lost = np.exp(p[1:3])
        contact = Contact(np.exp(p[0]), inertia * ring**2, 2.0 * lost * ring * inertia, p[3])
        torque = two_bodies(scene.track, scene.knob, contact, 16)
        return _rms(base.rest(torque - plain)[::EVERY] - own)

    # Surfaces that never pull let go early and keep more than the damped sine does.
    lost = 1.35 * -np.log(restitution) / np.hypot(np.pi, np.log(restitution))
    start = np.array([np.log(gap), 7.5, np.log(lost), share])
    simplex = np.vstack([start, start + np.diag([0.05, 0.4, 0.3, 0.05])])
    found = minimize(left, start, method="Nelder-Mead", options={"maxfev": 60, "initial_simplex": simplex})
    return float(found.fun)


_LAWS: dict[str, Law] = {"stribeck": _stribeck, "presliding": _presliding, "backlash": _backlash}
# The names that a stranger may have: its own first.
NAMES = {
    "bristles": ("presliding", "stribeck"),
    "rate_and_state": ("stribeck", "presliding"),
    "impact_gap": ("backlash",),
}
