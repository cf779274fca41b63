"""Lots in which every part has a little of an effect, too little for one capture: what all of them tell.

`python benches/study_lots.py` makes, with the second simulator, an old lot of plain parts (alike within 2 %),
a second one like it, and a new one of parts that have an effect, at a share of the strength at which a
capture of this very knob shows it: how often the new lot is said to have something, whether it is that
effect, and what is said of equal lots. All parts of a round are turned alike. A round is a line in
`--output`, and is not done again. `--cost` says what the hints of a capture take of a processor.
"""

import argparse
import json
import tempfile
import time
from pathlib import Path
from typing import Any

import numpy as np
from hidden.base import Base
from hidden.chain import Chain, Scene, plain_knob
from hidden.loads import Loads
from hidden.make import ACCEPTED, KINDS, solved
from hidden.motions import MOTIONS
from hidden.sensors import FLOOR, RANGE, RATE_HZ, measured
from study_fleet import write

import knobcam as kc
from knobcam.fit.hints import hints
from knobcam.fleet.judged import judged
from knobcam.fleet.row import Row, row_of
from knobcam.fleet.settings import Settings
from knobcam.fleet.sources import sources
from knobcam.fleet.study import Study

SAMPLES = 30_000
SPREAD = 0.02  # of a parameter from part to part, relative
EFFECTS = ("stribeck", "quadratic_drag", "return_spring", "position_polynomial", "friction_drift")
EFFECTS += ("torque_drift", "torque_lag", "position_friction", "load_friction", "detent_harmonics")
SHARES = (0.2, 0.4)
STEPS = 0.1 * np.sqrt(2.0) ** np.arange(9)  # strengths that are tried, over the noise floor
OF_THE_KNOB = ("inertia", "coulomb_neg", "coulomb_pos", "viscous_neg", "viscous_pos", "detent")


class Round:
    """A design, how its parts are turned, and an effect that grows."""

    def __init__(self, seed: int) -> None:
        self.rng = np.random.default_rng([seed, 1919])
        self.effect = EFFECTS[seed % len(EFFECTS)]
        kind = KINDS[self.effect]
        motions = list(MOTIONS)
        t = np.arange(SAMPLES) / RATE_HZ
        while True:
            self.motion = motions[int(self.rng.integers(len(motions)))]
            self.track = MOTIONS[self.motion](self.rng, t)
            self.design = plain_knob(self.rng, kind.detents or bool(self.rng.random() < 0.7))
            self.grow = kind.draw(self.rng, Scene(self.track, self.design))
            self.base = Base(self.track, self.design)
            if self.size(STEPS[-1]) is not None and self.size(STEPS[0] * SHARES[0]) is not None:
                break

    def size(self, strength: float) -> float | None:
        """The size of the effect of which the base model leaves so much, over the noise floor."""

        def left(at: float) -> float:
            return self.base.left(self.grow(Chain(self.design), at).torque(self.track, 8)[0]) / FLOOR

        low, high = KINDS[self.effect].sizes
        size = solved(left, 1e-3 * low, high, strength)
        torque = np.abs(self.grow(Chain(self.design), size or 0.0).torque(self.track, 8)[0]).max()
        return size if torque < RANGE else None

    def capture(self, knob: Loads, size: float | None) -> dict[str, Any]:
        """The columns of one capture."""
        chain = Chain(knob) if size is None else self.grow(Chain(knob), size)
        return measured(self.rng, self.track, *chain.torque(self.track))

    def shown(self) -> float | None:
        """The least strength at which a capture shows something; None beyond those that are tried."""
        low, high = 0, len(STEPS)
        while low < high:
            middle = (low + high) // 2
            columns = self.capture(self.design, self.size(float(STEPS[middle])))
            low, high = (low, middle) if shows(columns) else (middle + 1, high)
        return float(STEPS[low]) if low < len(STEPS) else None

    def lot(self, name: str, count: int, size: float | None) -> list[Row]:
        """The rows of a lot of parts."""
        parts = {}
        for at in range(count):
            spread = {name: getattr(self.design, name) * self.rng.normal(1.0, SPREAD) for name in OF_THE_KNOB}
            parts[f"{name}{at:02d}"] = self.capture(self.design._replace(**spread), size)
        with tempfile.TemporaryDirectory() as folder:
            write(Path(folder, "lot.parquet"), parts, lot=[name] * count)
            rows = [row_of(one, Settings(), False, None) for one in sources([folder])]
        return [row for row in rows if row is not None]


def shows(columns: dict[str, Any]) -> bool:
    """Whether one capture by itself shows that something is missing, whatever."""
    names = {"theta_rad": "theta", "omega_rad_s": "omega", "alpha_rad_s2": "alpha", "tau_Nm": "tau"}
    given = {name: columns[column] for column, name in names.items()}
    story = kc.learn(kc.Capture.from_arrays(t=columns["t_s"], **given))
    return story.verdict != "complete" or bool(story.found)


def played(seed: int, count: int) -> dict[str, Any]:
    """What is said of the lots of a round."""
    one = Round(seed)
    told: dict[str, Any] = {"seed": seed, "count": count, "effect": one.effect, "motion": one.motion}
    told["shown"] = shown = one.shown()
    old, again = one.lot("A", count, None), one.lot("B", count, None)
    told["equal"] = [str(two) for two in Study.of(judged(old + again, None), None).pooled]
    told["planted"] = {}
    for share in SHARES if shown is not None else ():
        new = one.lot("B", count, one.size(share * shown))
        study = Study.of(judged(old + new, None), None)
        told["planted"][str(share)] = {
            "found": [[two.lot, two.effect, list(two.alike)] for two in study.pooled],
            "verdicts": sum(row["verdict"] == "complete" for row in new),
            "said": study.said,
        }
    return told


def print_all(path: Path) -> None:
    """Print what all rounds of a file came to."""
    rounds = [json.loads(line) for line in path.read_text().splitlines()]
    for count in sorted({one["count"] for one in rounds}):
        some = [one for one in rounds if one["count"] == count]
        false = sum(bool(one["equal"]) for one in some)
        print(f"lots of {count}, {len(some)} rounds: of equal lots something is said in {false}")
        for share in map(str, SHARES):
            lots = [(one["effect"], one["planted"][share]) for one in some if share in one["planted"]]
            of_new = [(effect, [two for two in lot["found"] if two[0] == "B"]) for effect, lot in lots]
            found = sum(bool(told) for _, told in of_new)
            named = sum(any(two[1] in ACCEPTED[effect] for two in told) for effect, told in of_new)
            among = sum(
                any({two[1], *two[2]} & {*ACCEPTED[effect]} for two in told) for effect, told in of_new
            )
            print(
                f"  at {share} of what a capture shows: found in {found} of {len(lots)}, "
                f"named rightly in {named}, among the likes in {among}"
            )


def cost() -> None:
    """Print what the hints of a capture take of a processor, beside its fit."""
    one = Round(0)
    names = {"theta_rad": "theta", "omega_rad_s": "omega", "alpha_rad_s2": "alpha", "tau_Nm": "tau"}
    spent: dict[str, list[float]] = {"fit": [], "hints": []}
    for _ in range(12):
        columns = one.capture(one.design, None)
        given = {name: columns[column] for column, name in names.items()}
        capture = kc.Capture.from_arrays(t=columns["t_s"], **given)
        begun = time.process_time()
        fit = kc.fit(capture)
        between = time.process_time()
        hints(fit)
        spent["fit"].append(between - begun)
        spent["hints"].append(time.process_time() - between)
    for name, seconds in spent.items():
        print(f"{name}: {1e3 * float(np.median(seconds[2:])):.1f} ms of processor time a capture")


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--cost", action="store_true")
    parser.add_argument("--first", type=int, default=0, help="seed of the first round")
    parser.add_argument("--rounds", type=int, default=20)
    parser.add_argument("--size", type=int, default=20, help="parts of a lot")
    parser.add_argument("-o", "--output", type=Path, default=Path("lots.jsonl"))
    args = parser.parse_args()
    if args.cost:
        cost()
    else:
        known = args.output.read_text().splitlines() if args.output.exists() else []
        done = {(one["seed"], one["count"]) for one in map(json.loads, known)}
        for seed in range(args.first, args.first + args.rounds):
            if (seed, args.size) not in done:
                with args.output.open("a") as file:
                    file.write(json.dumps(played(seed, args.size)) + "\n")
        print_all(args.output)
