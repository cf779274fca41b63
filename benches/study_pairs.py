"""Every effect in every knob: does the truth, once it is added, explain the capture, and is it missed before?

`python3 benches/study_pairs.py [--motions sweep,hand] [--knobs knob3] [--demo]` prints a row per pair that
`hideable` offers: the error of the base model and that of a fit started at the truth, in noise floors. With
`--demo` each pair is learned as `knobcam demo` does it, over an emulated rig, and what it ends with is told.
"""

from __future__ import annotations

import argparse
import json
import tempfile
import time
from collections.abc import Container, Iterator, Sequence
from itertools import product, zip_longest
from pathlib import Path
from typing import NamedTuple

import knobcam as kc
from knobcam import _core
from knobcam.capture.motions import MOTIONS
from knobcam.cli.demonstration import FASTER
from knobcam.fit.fitting import as_logged
from knobcam.model.hiding import hideable
from knobcam.rig.emulator import EmulatedRig
from knobcam.rig.record import record

LEAST = 1.5
AT_FLOOR = 1.05
CAP_S = 120.0
RESULTS = Path(__file__).with_name("results") / "pairs.json"
SAID = {
    "construction": "errors in noise floors, without it and fitted from the truth (x: not from 1.5 to 1.05)",
    "demo": "the same as `knobcam demo` ends (x: not with the hidden effect alone, or not at the floor)",
}


class Solved(NamedTuple):
    """A pair, and the errors before and after in noise floors."""

    knob: str
    effect: str
    motion: str
    before: float
    after: float

    @property
    def solvable(self) -> bool:
        """Whether the effect is missed without, and is all that there is with it."""
        return self.before >= LEAST and self.after <= AT_FLOOR


def solve(knob: str, effect: str, motion: str, seed: int = 5) -> Solved:
    """Simulate a pair by the rig's sensors; fit the base model, and the hidden one from the truth."""
    hidden = kc.hiding(knob, effect, motion=motion)
    capture = kc.simulate(hidden, motion, seed=seed)
    base = as_logged(capture)  # `kc.fit` mends a torque that is ahead
    true = _core.refine([signals.core for signals in base.prepared], hidden.core, True)
    return Solved(knob, effect, motion, base.rmse / base.noise_floor, true.rmse / true.noise_floor)


class Demonstrated(NamedTuple):
    """A demonstration: what it ended with, from which error to which, in noise floors."""

    knob: str
    effect: str
    found: str
    before: float
    after: float
    seconds: float

    @property
    def alone(self) -> bool:
        """Whether it ended with what was hidden and nothing else, at the floor, from well above it."""
        return self.found == self.effect and self.after <= AT_FLOOR and self.before >= LEAST


def demonstrate(knob: str, effect: str) -> Demonstrated:
    """Record a pair from an emulated rig and learn what is missing, as `knobcam demo` does."""
    start = time.monotonic()

    def watch(_: str) -> None:
        if time.monotonic() - start > CAP_S:
            raise TimeoutError

    with tempfile.TemporaryDirectory() as folder:
        with EmulatedRig(kc.hiding(knob, effect), speed=FASTER) as rig:
            capture = record(rig.port, "sweep", output=Path(folder) / "capture.npz")
        try:
            story = kc.learn(capture, progress=watch)
        except TimeoutError:
            return Demonstrated(knob, effect, f"not done in {CAP_S:.0f} s", 0.0, 0.0, CAP_S)
    floor = story.noise_floor
    found = ", ".join([*story.found, *(["?"] if story.verdict == "unexplained" else [])])
    before, after = story.ladder[0].rmse / floor, story.fit.rmse / floor
    return Demonstrated(knob, effect, found or "-", before, after, time.monotonic() - start)


def pairs(motions: Sequence[str], knobs: Sequence[str], only: Container[str], demo: bool) -> Iterator[str]:
    """A row per pair, and at the end how many hold."""
    held = count = 0
    for motion, knob in product(["sweep"] if demo else motions, knobs):
        for effect in hideable(knob, motion):
            if effect not in only:
                continue
            if demo:
                shown = demonstrate(knob, effect)
                good, row = shown.alone, f"{shown.seconds:5.0f} s  ends with {shown.found}"
                before, after = shown.before, shown.after
            else:
                solved = solve(knob, effect, motion)
                good, row, before, after = solved.solvable, motion, solved.before, solved.after
            yield f"{' ' if good else 'x'} {knob} {effect:<20} {before:7.2f} {after:7.3f}  {row}"
            held, count = held + good, count + 1
    yield f"{held} of {count} pairs hold ({100.0 * held / max(count, 1):.0f} %)"


def beside(table: Sequence[str]) -> Iterator[str]:
    """The pairs of a table in two columns, what is said of them all below."""
    rows = [line for line in table if line[1:5] == " kno"]
    half = -(-len(rows) // 2)
    width = max(map(len, rows[:half]), default=0)
    for left, right in zip_longest(rows[:half], rows[half:], fillvalue=""):
        yield f"{left:{width}} {right}".rstrip()
    yield from (line for line in table if line not in rows)


def main() -> None:
    """Print the table, and keep it where it is one of all pairs."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--motions", default=",".join(MOTIONS))
    parser.add_argument("--knobs", default=",".join(kc.KNOBS))
    parser.add_argument("--effects", default=",".join(kc.effects()), help="only these")
    parser.add_argument("--demo", action="store_true")
    args = parser.parse_args()
    lines = []
    for line in pairs(args.motions.split(","), args.knobs.split(","), args.effects.split(","), args.demo):
        print(line, flush=True)
        lines.append(line)
    whole = (args.knobs, args.effects) == (parser.get_default("knobs"), parser.get_default("effects"))
    if whole:
        document = json.loads(RESULTS.read_text("utf-8")) if RESULTS.is_file() else {}
        document["demo" if args.demo else "construction"] = lines
        parts = [(SAID[name], document[name]) for name in SAID if name in document]
        document["report"] = [line for said, table in parts for line in [said, *beside(table), ""]][:-1]
        RESULTS.write_text(json.dumps(document, indent=1) + "\n", "utf-8")


if __name__ == "__main__":
    main()
