"""A capture of a random knob with the effects that are asked for, each of a known strength."""

import zlib
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np

from .base import Base
from .chain import Chain, Grow, Scene, log_uniform, plain_knob
from .lawful import LAWFUL
from .likeness import ALIKE, BY_NATURE, NAMES, STRANGE_SHARE, STRANGEST, left_by
from .loads import Loads
from .motions import MOTIONS, Floats, Track
from .sensors import EDGE, FLOOR, RANGE, RATE_HZ, filtered, measured
from .series import SERIES
from .shapes import NAMED
from .strange import STRANGE
from .stranger import STRANGER

KINDS = NAMED | SERIES | STRANGER | STRANGE | LAWFUL
# Alike over less than a turn, and a polynomial is nearly what they are beyond.
POSITION = ["position_polynomial", "return_spring", "unbalance"]
ACCEPTED = {name: POSITION if name in POSITION else [name] for name in NAMED | SERIES}
# The names of the strange kinds that are torques of position alone: a free map of position is their truth.
ACCEPTED |= {name: [names[0]] for name, names in NAMES.items()}
ACCEPTED |= {name: ["regional", "wavelet"] if name in ("bump", "rough_map") else [] for name in STRANGE}
ACCEPTED |= {name: [] for name in LAWFUL}

WEAKEST, STRONGEST = 0.7, 12.0
PATIENCE = 15  # knobs that are tried before another strength and motion are drawn
TRIES = 20 * PATIENCE
COARSE = 8  # substeps while a size is searched


@dataclass(frozen=True)
class Hidden:
    """A capture and what is behind it.

    `strength` is what the base model cannot explain of the exact torque, and `strengths` what of each effect
    neither it nor the others' signatures can, RMS over the noise floor. `noise_floor` is the RMS of the very
    noise in this capture after the measurement filter, N m. `accepted`: the ids that are as right, for each.
    `misfit`: what the textbook laws of those names leave of the exact torque, over the noise floor.
    """

    seed: int
    motion: str
    effects: tuple[str, ...]
    accepted: tuple[tuple[str, ...], ...]
    capture: dict[str, Floats]
    noise_floor: float
    strength: float
    strengths: tuple[float, ...]
    knob: dict[str, float]
    truth: dict[str, Any]
    misfit: float = 0.0
    chain: Chain | None = None
    track: Track | None = None

    def again(self, track: Track, seed: int) -> dict[str, Floats]:
        """The capture of the same knob on another motion; ValueError for what is a value per sample."""
        assert self.chain is not None
        tau, limit = self.chain.torque(track)
        return measured(np.random.default_rng([self.seed, seed]), track, tau, limit)


def make(
    seed: int,
    effects: Sequence[str] = (),
    motion: str | None = None,
    strength: float | tuple[float, float] | None = None,
    size: float | None = None,
    duration_s: float = 6.0,
    keep: float = 0.0,
    at_shaft: bool = False,
) -> Hidden:
    """Make the capture of a seed. Motion and strength are drawn (0.7 to 12, or between two) where not given.

    `size` sets the one effect's own size (a delay's seconds) in place of its strength. `keep` colours the
    torque's noise, AR(1) of the same RMS. Knobs on which an
    effect cannot be so strong are drawn anew, and at last the strength. Raises ValueError if none is found.
    """
    kinds = {str(name): KINDS[name] for name in sorted(effects, key=lambda name: KINDS[name].order)}
    rng, noise = np.random.default_rng([seed, zlib.crc32(" ".join(effects).encode())]).spawn(2)
    t = np.arange(round(duration_s * RATE_HZ)) / RATE_HZ
    for attempt in range(TRIES):
        if attempt % PATIENCE == 0:
            turned = motion or str(rng.choice(list(MOTIONS)))
            wanted = [_wanted(rng, strength) for _ in kinds]
        detents = any(kind.detents for kind in kinds.values()) or bool(rng.random() < 0.7)
        scene = Scene(MOTIONS[turned](rng, t), plain_knob(rng, detents))
        found = _grown(
            scene, {name: kind.draw(rng, scene) for name, kind in kinds.items()}, wanted, size, at_shaft
        )
        if found is None:
            continue
        parts, total = found
        chain = _chain(scene, parts, at_shaft)
        tau, limit = chain.torque(scene.track)
        if np.abs(tau).max() > RANGE - 0.01:
            continue
        named = _names(scene, parts)
        if named is not None:
            break
    else:
        raise ValueError(f"no knob shows {list(effects)} at {wanted} times the noise under {turned}")
    accepted, misfit = named
    capture = measured(noise, scene.track, tau, limit, keep)
    floor = float(np.sqrt(np.mean(filtered(capture["tau_Nm"] - tau)[EDGE:-EDGE] ** 2)))
    return Hidden(
        seed=seed,
        motion=turned,
        effects=tuple(kinds),
        accepted=tuple(tuple(names) for names in accepted),
        capture=capture,
        noise_floor=floor,
        strength=float(total),
        strengths=tuple(part.strength for part in parts),
        knob={name: float(value) for name, value in _named(chain.shaft or chain.loads).items()},
        truth=chain.truth(scene.knob),
        misfit=misfit,
        chain=chain,
        track=scene.track,
    )


def _wanted(rng: np.random.Generator, strength: float | tuple[float, float] | None) -> float:
    if isinstance(strength, float | int):
        return float(strength)
    return float(log_uniform(rng, *(strength or (WEAKEST, STRONGEST))))


def _names(scene: Scene, parts: Sequence["_Part"]) -> tuple[list[list[str]], float] | None:
    """The names that are right for each part, and what their laws leave; None where a name is not sure."""
    accepted, misfits = [], [0.0]
    base = Base(scene.track, scene.knob)
    for part in parts:
        names = ACCEPTED[part.name]
        if part.name in NAMES:
            alone = part.grow(Chain(scene.knob), part.size)
            left = {name: left_by(name, scene, alone, base) for name in NAMES[part.name]}
            misfits.append(left[names[0]])
            sure = part.name in BY_NATURE or misfits[-1] < max(STRANGEST, STRANGE_SHARE * part.strength)
            if not sure:
                return None
            names = names + [name for name in left if name not in names and left[name] < ALIKE]
        accepted.append(names)
    return accepted, float(np.linalg.norm(misfits))


class _Part(NamedTuple):
    """An effect at its size; strength over the noise."""

    name: str
    grow: Grow
    size: float
    strength: float


def _grown(
    scene: Scene, grows: Mapping[str, Grow], wanted: Sequence[float], size: float | None, at_shaft: bool
) -> tuple[list[_Part], float] | None:
    """Scale one effect after the other; None where one cannot be so strong on this knob and motion."""
    base = Base(scene.track, scene.knob)
    plain, _ = Chain(scene.knob).torque(scene.track)

    def signature(parts: Sequence[_Part]) -> Floats:
        return _chain(scene, parts, at_shaft).torque(scene.track, COARSE)[0] - plain

    parts: list[_Part] = []
    for (name, grow), strength in zip(grows.items(), wanted, strict=True):
        others = [signature(parts)] if parts else []
        part = _Part(name, grow, 0.0, 0.0)

        def left(
            at: float,
            part: _Part = part,
            known: Sequence[_Part] = tuple(parts),
            others: list[Floats] = others,
        ) -> float:
            return base.left(plain + signature([*known, part._replace(size=at)]), *others) / FLOOR

        fitting = size or solved(left, *KINDS[name].sizes, strength)
        if fitting is None:
            return None
        parts.append(_Part(name, grow, fitting, left(fitting)))
    if len(parts) > 1:
        whole = signature(parts)
        for i, part in enumerate(parts):
            rest = base.left(plain + whole, signature(parts[:i] + parts[i + 1 :])) / FLOOR
            parts[i] = part._replace(strength=rest)
    if len(parts) > 1 and any(part.strength < min(WEAKEST, wanted[i]) for i, part in enumerate(parts)):
        return None
    return parts, base.left(plain + signature(parts)) / FLOOR if parts else 0.0


def _chain(scene: Scene, parts: Sequence[_Part], at_shaft: bool) -> Chain:
    chain = Chain(scene.knob)
    for part in parts:
        chain = part.grow(chain, part.size)
    return chain._replace(shaft=chain.loads, loads=scene.knob) if at_shaft and chain.contact else chain


def solved(left: Callable[[float], float], low: float, high: float, strength: float) -> float | None:
    """The size for a strength, within 2 %, by bisection and false position of the logarithms."""
    below = left(low)
    if below >= strength:
        return None
    above = left(high)
    if above <= strength:
        return None
    for step in range(40):
        share = 0.5
        if step % 2:
            share = np.log(strength / below) / np.log(above / below)
        middle = float(low * (high / low) ** share)
        now = left(middle)
        if abs(now / strength - 1.0) < 0.02:
            return middle
        if now < strength:
            low, below = middle, now
        else:
            high, above = middle, now
    return None


def _named(knob: Loads) -> dict[str, float]:
    """The base parameters under the catalogue's names.

    Of detents that differ by direction the catalogue's are what both have in common, half the sum.
    """
    forth = knob.detent * np.exp(1j * knob.phase)
    both = forth * (1.0 + (1.0 + knob.back_gain) * np.exp(1j * knob.back_shift)) / 2.0
    return {
        "inertia.M": knob.inertia,
        "coulomb.neg": knob.coulomb_neg,
        "coulomb.pos": knob.coulomb_pos,
        "viscous.neg": knob.viscous_neg,
        "viscous.pos": knob.viscous_pos,
        "detent.A": np.abs(both),
        "detent.P": knob.period,
        "detent.S": np.angle(both),
    }
