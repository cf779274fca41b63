"""The effects that the catalogue names, each drawn at random and growing with one size."""

import numpy as np

from .bodies import Contact
from .chain import Chain, Grow, Kind, Scene, log_uniform

Rng = np.random.Generator


def _loads(chain: Chain, **values: object) -> Chain:
    return chain._replace(loads=chain.loads._replace(**values))


def stribeck(rng: Rng, scene: Scene) -> Grow:
    vs, delta = log_uniform(rng, 0.05, 1.5), rng.uniform(0.5, 2.0)
    return lambda chain, size: _loads(chain, rise=size, vs=vs, delta=delta)


def presliding(rng: Rng, scene: Scene) -> Grow:
    count = int(rng.integers(8, 13))
    weights, spread = rng.dirichlet(np.full(count, 2.0)), log_uniform(rng, 0.3, 3.0, count)
    return lambda chain, size: _loads(chain, weights=weights, distances=size * spread)


def quadratic_drag(rng: Rng, scene: Scene) -> Grow:
    exponent = rng.uniform(1.85, 2.15)
    return lambda chain, size: _loads(chain, drag=size, exponent=exponent)


def detent_harmonics(rng: Rng, scene: Scene) -> Grow:
    count = int(rng.integers(2, 5))
    orders = np.arange(2.0, 2.0 + count)
    sizes = scene.knob.detent * rng.uniform(0.3, 1.0, count) / (orders - 1.0)
    phases = rng.uniform(0.0, 2.0 * np.pi, count)
    return lambda chain, size: _loads(chain, harmonics=np.stack([orders, size * sizes, phases], 1))


def directional_detent(rng: Rng, scene: Scene) -> Grow:
    angle = rng.uniform(0.0, 2.0 * np.pi)
    gain, shift = np.cos(angle), np.sin(angle)
    return lambda chain, size: _loads(chain, back_gain=size * gain, back_shift=size * shift)


def load_friction(rng: Rng, scene: Scene) -> Grow:
    return lambda chain, size: _loads(chain, mu=size)


def position_polynomial(rng: Rng, scene: Scene) -> Grow:
    # Each term of a random size at the end of the range.
    reach = float(np.abs(scene.track.theta).max())
    terms = rng.uniform(-1.0, 1.0, 3) / reach ** np.arange(1, 4)
    return lambda chain, size: _loads(chain, poly=size * terms)


def return_spring(rng: Rng, scene: Scene) -> Grow:
    reach = float(np.abs(scene.track.theta).max())
    at = rng.uniform(-0.4, 0.4) * reach
    return lambda chain, size: _loads(chain, spring=size / reach, spring_at=at)


def unbalance(rng: Rng, scene: Scene) -> Grow:
    at = rng.uniform(0.0, 2.0 * np.pi)
    return lambda chain, size: _loads(chain, unbalance=size, unbalance_at=at)


def end_stop(rng: Rng, scene: Scene) -> Grow:
    theta = scene.track.theta
    sides = [1.0, -1.0] if rng.random() < 0.4 else [rng.choice([1.0, -1.0])]
    at = [np.quantile(theta, 0.5 + side * rng.uniform(0.25, 0.45)) for side in sides]
    stiffness = rng.uniform(0.6, 1.4, len(sides))
    growth = rng.choice([0.0, rng.uniform(0.5, 3.0)])
    damping = rng.choice([0.0, log_uniform(rng, 1e-3, 1e-2)])  # seconds, of the stiffness

    def grow(chain: Chain, size: float) -> Chain:
        rows = [
            (side, angle, size * k, growth, damping * size * k)
            for side, angle, k in zip(sides, at, stiffness, strict=True)
        ]
        return _loads(chain, stops=np.array(rows))

    return grow


def position_friction(rng: Rng, scene: Scene) -> Grow:
    count = int(rng.integers(2, 5))
    # Between one and some ten waves over the range.
    frequencies = rng.uniform(1.0, 4.0) * 2.0 * np.pi / np.ptp(scene.track.theta) * np.arange(1, count + 1)
    sizes = rng.uniform(0.3, 1.0, count) / np.arange(1, count + 1)
    phases = rng.uniform(0.0, 2.0 * np.pi, count)
    return lambda chain, size: _loads(chain, rough=np.stack([frequencies, size * sizes, phases], 1))


def friction_drift(rng: Rng, scene: Scene) -> Grow:
    sign, lasts = rng.choice([1.0, -0.5]), rng.uniform(0.1, 0.7) * scene.track.t[-1]
    return lambda chain, size: _loads(chain, warm=sign * size, warm_s=lasts)


def torque_drift(rng: Rng, scene: Scene) -> Grow:
    s = scene.track.t / scene.track.t[-1]
    power = s ** rng.choice([0.5, 1.0, 1.5, 2.0])
    relaxing = np.exp(-s / rng.uniform(0.1, 0.7))
    waves = [rng.standard_normal() / k * np.cos(np.pi * k * s) for k in (1, 2, 3)]
    shape = rng.choice([-1.0, 1.0]) * [power, relaxing, np.sum(waves, 0)][rng.integers(3)]
    return lambda chain, size: chain._replace(sensor=chain.sensor._replace(drift=size * shape))


def torque_lag(rng: Rng, scene: Scene) -> Grow:
    channel = rng.choice(["delay_s", "lag_s"])
    return lambda chain, size: chain._replace(sensor=chain.sensor._replace(**{channel: size}))


def saturation(rng: Rng, scene: Scene) -> Grow:
    return lambda chain, size: chain._replace(sensor=chain.sensor._replace(share=1.0 - size))


def backlash(rng: Rng, scene: Scene) -> Grow:
    share, damped = rng.uniform(0.5, 0.85), rng.uniform(0.2, 0.6)
    inertia = share * scene.knob.inertia
    stiffness = inertia * (2.0 * np.pi * rng.uniform(100.0, 250.0)) ** 2

    def grow(chain: Chain, size: float) -> Chain:
        # So stiff that friction winds it up by far less than the gap: the play shows, not the spring.
        stiff = max(stiffness, 10.0 * scene.knob.coulomb_pos / size)
        return chain._replace(contact=Contact(size, stiff, 2.0 * damped * np.sqrt(inertia * stiff), share))

    return grow


def compliance(rng: Rng, scene: Scene) -> Grow:
    share, damped = rng.uniform(0.5, 0.9), log_uniform(rng, 0.01, 0.1)
    inertia = share * scene.knob.inertia

    def grow(chain: Chain, size: float) -> Chain:
        stiffness = inertia / size**2  # the size is 1 / natural frequency
        return chain._replace(
            contact=Contact(0.0, stiffness, 2.0 * damped * np.sqrt(inertia * stiffness), share)
        )

    return grow


NAMED: dict[str, Kind] = {
    "stribeck": Kind("speed", stribeck, (0.02, 2.0)),
    "presliding": Kind("speed", presliding, (3e-4, 0.1)),
    "quadratic_drag": Kind("speed", quadratic_drag, (1e-7, 5e-3)),
    "detent_harmonics": Kind("detent", detent_harmonics, (1e-3, 1.0), detents=True),
    "directional_detent": Kind("detent", directional_detent, (1e-3, 0.6), detents=True),
    "load_friction": Kind("detent", load_friction, (3e-3, 0.7), detents=True),
    "position_polynomial": Kind("position", position_polynomial, (1e-5, 0.1), detents=True),
    "return_spring": Kind("position", return_spring, (1e-5, 0.1), detents=True),
    "unbalance": Kind("position", unbalance, (1e-5, 0.1), detents=True),
    "end_stop": Kind("position", end_stop, (1e-4, 5.0)),
    "position_friction": Kind("level", position_friction, (3e-3, 0.8)),
    "friction_drift": Kind("level", friction_drift, (3e-3, 1.5)),
    "torque_drift": Kind("channel", torque_drift, (1e-5, 0.1), order=2),
    "torque_lag": Kind("channel", torque_lag, (5e-5, 0.008), order=2),
    "saturation": Kind("channel", saturation, (0.01, 0.8), order=2),
    "backlash": Kind("coupling", backlash, (5e-4, 0.1), order=0),
    "compliance": Kind("coupling", compliance, (5e-4, 0.02), order=0),
}
