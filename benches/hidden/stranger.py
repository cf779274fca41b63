"""Effects that have a name in the catalogue, by physics that has none of its formulas.

Bristles that are bent one by one, a gap with restitution, contacts that age.
"""

import numpy as np

from .chain import Chain, Grow, Kind, Scene, log_uniform
from .impacts import Gap
from .rubbing import Ageing, Bristles

Rng = np.random.Generator

BRISTLES = 1000


def bristles(rng: Rng, scene: Scene) -> Grow:
    stiffness = rng.lognormal(0.0, 0.5, BRISTLES)
    spread, anew = rng.uniform(0.1, 0.6), rng.uniform(0.0, 0.5)

    def grow(chain: Chain, size: float) -> Chain:
        field = Bristles.spread(stiffness, size, spread, anew)
        return chain._replace(loads=chain.loads._replace(bristles=field))

    return grow


def rate_and_state(rng: Rng, scene: Scene) -> Grow:
    """Ageing over a way that is short beside that of the motion between two reversals."""
    direct, cutoff = rng.uniform(0.004, 0.01), log_uniform(rng, 0.1, 2.0)
    speed = float(np.median(np.abs(scene.track.omega)))
    way = log_uniform(rng, 2e-5, 3e-4)
    return lambda chain, size: chain._replace(
        loads=chain.loads._replace(ageing=Ageing(direct, size, speed, cutoff, way))
    )


def impact_gap(rng: Rng, scene: Scene) -> Grow:
    share, restitution = rng.uniform(0.5, 0.85), rng.uniform(0.05, 0.5)
    lasts_s = rng.uniform(0.0006, 0.0015)
    return lambda chain, size: chain._replace(contact=Gap(size, restitution, lasts_s, share))


STRANGER: dict[str, Kind] = {
    "bristles": Kind("speed", bristles, (3e-4, 0.2)),
    "rate_and_state": Kind("speed", rate_and_state, (1e-3, 1.0)),
    "impact_gap": Kind("coupling", impact_gap, (2.5e-4, 0.05), order=0),
}
