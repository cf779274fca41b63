"""A knob on its rig: contact, loads, sensor and whatever else disturbs the torque."""

from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np

from .bodies import Contact, one_body, two_bodies
from .impacts import Gap, gapped
from .loads import Loads
from .motions import Floats, Track
from .sensors import Sensor


class Chain(NamedTuple):
    """Everything that makes the torque out of the shaft's motion; `strange` is a torque over the samples.

    `shaft` are loads that differ from those of the knob by what rubs and pulls at the shaft, before the
    contact.
    """

    loads: Loads
    contact: Contact | Gap | None = None
    sensor: Sensor = Sensor()
    strange: Floats = np.zeros(1)
    shaft: Loads | None = None

    def torque(self, track: Track, substeps: int = 40) -> tuple[Floats, float]:
        """The torque that the channel shows without noise, and the limit that it is clipped at, N m."""
        if self.contact is None:
            tau = one_body(track, self.loads)
        else:
            joined = gapped if isinstance(self.contact, Gap) else two_bodies
            tau = joined(track, self.loads, self.contact, substeps)
            if self.shaft is not None:
                tau = tau + one_body(track, self.shaft) - one_body(track, self.loads)
        tau = self.sensor.late(track.t, tau + self.strange)
        limit = self.sensor.share * float(np.abs(tau).max())
        return np.clip(tau, -limit, limit), limit

    def truth(self, plain: Loads) -> dict[str, Any]:
        """The values that make this chain differ from a plain knob; not those that are a value per sample."""
        values: dict[str, Any] = {}
        for part, bare in (
            (self.shaft or self.loads, plain),
            (self.sensor, Sensor()),
            (self.contact or (), ()),
        ):
            own = part._asdict() if part else {}
            values |= _flat({name: v for name, v in own.items() if v is not getattr(bare, name, None)})
        return {name: np.asarray(v).tolist() for name, v in values.items() if np.size(v) < 100}


def _flat(values: dict[str, Any]) -> dict[str, Any]:
    """The values, those of a tuple with names under its own names."""
    flat: dict[str, Any] = {}
    for name, value in values.items():
        flat |= value._asdict() if hasattr(value, "_asdict") else {name: value}
    return flat


class Scene(NamedTuple):
    """What an effect is fitted into: a motion and a plain knob."""

    track: Track
    knob: Loads


Grow = Callable[[Chain, float], Chain]


class Kind(NamedTuple):
    """An effect: how it is drawn, and the least and the most of the size that scales it.

    Two effects of one `group` are not hidden together. `order` is that of the chain: coupling, loads, sensor.
    """

    group: str
    draw: Callable[[np.random.Generator, Scene], Grow]
    sizes: tuple[float, float]
    order: int = 1
    detents: bool = False


def log_uniform(rng: np.random.Generator, low: float, high: float, size: int | None = None) -> Any:
    return np.exp(rng.uniform(np.log(low), np.log(high), size))


def plain_knob(rng: np.random.Generator, detents: bool) -> Loads:
    """A knob of the size of those that the haptic-camera paper measured."""
    friction, viscous = log_uniform(rng, 2e-3, 35e-3), log_uniform(rng, 1.5e-4, 2e-3)
    return Loads(
        inertia=log_uniform(rng, 3e-5, 2.2e-4),
        coulomb_neg=friction * rng.uniform(0.87, 1.15),
        coulomb_pos=friction * rng.uniform(0.87, 1.15),
        viscous_neg=viscous * rng.uniform(0.8, 1.25),
        viscous_pos=viscous * rng.uniform(0.8, 1.25),
        detent=log_uniform(rng, 2e-3, 25e-3) if detents else 0.0,
        period=log_uniform(rng, 0.03, 0.16),
        phase=rng.uniform(-np.pi, np.pi),
    )
