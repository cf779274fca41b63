"""Which knobs an examination in strata is held on: strength, motion and coupling are dealt out, not drawn.

`one/stribeck:7` is seed 7 of the knobs with that effect alone, `pair/backlash+stribeck:7` of those with both,
`none/white:7` and `none/ar1:7` of faultless ones under white noise and under AR(1) of 0.9.
"""

from itertools import combinations
from typing import NamedTuple

from hidden import BUILDS_UP, KINDS, MOTIONS, NAMED, SERIES, STRANGER, Hidden, make

# RMS over the noise of what the base model cannot explain. The first is that of weak effects.
BANDS = ((0.3, 0.7), (0.7, 1.5), (1.5, 3.0), (3.0, 6.0), (6.0, 12.0))
NOISES = {"white": 0.0, "ar1": 0.9}
# By strangers' physics in their place: these share a formula with the core.
SHARED = {"stribeck", "presliding", "backlash"}
EFFECTS = [*NAMED, *SERIES, *STRANGER]
PAIRS = [
    (one, other)
    for one, other in combinations([name for name in EFFECTS if name not in SHARED], 2)
    if KINDS[one].group != KINDS[other].group
]


class Stratum(NamedTuple):
    """A knob to be examined."""

    sitting: str
    topic: str
    seed: int

    def __str__(self) -> str:
        return f"{self.sitting}/{self.topic}:{self.seed}"

    @staticmethod
    def parse(text: str) -> "Stratum":
        """The stratum of a name."""
        kind, _, seed = text.rpartition(":")
        sitting, _, topic = kind.partition("/")
        return Stratum(sitting, topic, int(seed))

    @property
    def effects(self) -> list[str]:
        """What is hidden."""
        return [] if self.sitting == "none" else self.topic.split("+")

    @property
    def band(self) -> tuple[float, float]:
        """Between which strengths each effect is; those of a pair are never weak.

        With the motions that makes twenty strata of one effect and sixteen of a pair, each met once in as
        many seeds.
        """
        if len(self.effects) > 1:
            return BANDS[1 + (self.seed + self.seed // 4) % 4]
        return BANDS[self.seed % 5]

    @property
    def at_shaft(self) -> bool:
        """Whether what rubs and pulls does so at the shaft, before a coupling: every second, never late."""
        coupled = [name for name in self.effects if KINDS[name].order == 0]
        late = BUILDS_UP & set(self.effects)
        return bool(coupled) and len(self.effects) > 1 and not late and (self.seed // 4 + self.seed) % 2 == 1

    def make(self, motion: str | None = None) -> Hidden:
        """The capture; under the next motion where the effects cannot be so strong under its own.

        Who knows under which `motion` they can spares the looking, which may take a minute.
        """
        every = list(MOTIONS)
        keep = NOISES[self.topic] if self.sitting == "none" else 0.0
        first = self.seed % len(every)
        for turn in [*every[first:], *every[:first]] if motion is None else [motion]:
            try:
                return make(self.seed, self.effects, turn, self.band, keep=keep, at_shaft=self.at_shaft)
            except ValueError:
                continue
        raise ValueError(f"{self}: under no motion is there such a knob")


def strata(seeds: int, first: int = 0) -> list[Stratum]:
    """All of them, seed by seed, so that a run that is cut short has met every effect and pair alike."""
    every = []
    for seed in range(first, first + seeds):
        every += [Stratum("one", name, seed) for name in EFFECTS]
        every += [Stratum("none", noise, seed) for noise in NOISES]
        every += [Stratum("pair", f"{one}+{other}", seed) for one, other in PAIRS]
    return every
