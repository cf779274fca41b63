"""Ripples over position beside the detents: valleys with a period of their own, and a motor's orders."""

import numpy as np

from .chain import Chain, Grow, Kind, Scene, log_uniform

Rng = np.random.Generator

LEAST_WAVES = 4.0  # of a series within the range
APART = 0.6  # waves within the range by which a series differs from every multiple of the other


def second_detent(rng: Rng, scene: Scene) -> Grow:
    """Valleys whose number has no small ratio to the detents', nor is whole where the knob turns round."""
    travel = float(np.ptp(scene.track.theta)) / (2.0 * np.pi)
    first = travel / scene.knob.period
    phase = rng.uniform(-np.pi, np.pi)
    for _ in range(100):
        waves = first * log_uniform(rng, 0.35, 2.8)
        # Of half and third numbers of the detents' waves slower detents would be the cause.
        ratios = [waves / first * q - round(waves / first * q) for q in (1, 2, 3)]
        locked = any(abs(ratio) * first / q < APART for q, ratio in enumerate(ratios, 1))
        near_first = abs(waves - first) < 2.0 * APART
        per_turn = waves / travel
        whole = travel > 0.9 and abs(per_turn - round(per_turn)) * travel < APART / 2.0
        if waves > LEAST_WAVES and not (locked or near_first or whole):
            break
    else:
        waves = 0.0  # no such series in this motion: it cannot be so strong as is wanted
    row = np.array([[waves / travel, 1.0, phase]])
    return lambda chain, size: _rippling(chain, row, size * (waves > 0.0))


def cogging(rng: Rng, scene: Scene) -> Grow:
    """Whole numbers of waves per turn, of a motor of some slots and poles, in a motion that turns round."""
    poles, slots = int(rng.integers(4, 12)), int(rng.choice([9, 12, 18, 24]))
    orders = np.array([poles, slots, 2 * poles, np.lcm(slots, poles)])[: rng.integers(2, 5)]
    orders = np.unique(orders[orders < 90])
    sizes = rng.uniform(0.3, 1.0, len(orders))
    rows = np.stack([orders, sizes, rng.uniform(-np.pi, np.pi, len(orders))], 1)
    round_the_turn = float(np.ptp(scene.track.theta)) > 2.0 * np.pi
    return lambda chain, size: _rippling(chain, rows, size * round_the_turn)


def _rippling(chain: Chain, rows: np.ndarray, size: float) -> Chain:
    return chain._replace(loads=chain.loads._replace(ripple=rows * [1.0, size, 1.0]))


SERIES: dict[str, Kind] = {
    "second_detent": Kind("detent", second_detent, (1e-5, 0.1), detents=True),
    "cogging": Kind("detent", cogging, (1e-5, 0.1)),
}
