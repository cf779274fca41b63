"""One log with the faults that real ones have: what the program says of the file, beside the truth."""

import tempfile
import time
import zlib
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from hidden import FAULTS, MOTIONS, NAMED, Hidden, make
from hidden.faults import Columns

import knobcam as kc

# Strengths of the hidden effects, RMS over white noise: findable under coloured noise as well, whose floor is
# three times as high.
WEAKEST, STRONGEST = 3.0, 12.0
STRIDE = 12  # through the effects, so that a few seeds have unlike ones

# What an effect of the sensor rightly makes the log be said to have.
SHOWS_AS = {"saturation": "clipped", "torque_lag": "late_column"}

Row = dict[str, Any]


class Log(NamedTuple):
    """A log to be examined: a fault, on knob `seed` with a hidden effect or without; learned or fitted."""

    fault: str
    seed: int
    hides: bool = False
    learned: bool = True
    cap_s: float = 60.0

    @property
    def effects(self) -> list[str]:
        """What is hidden: another effect with each seed."""
        return [list(NAMED)[STRIDE * self.seed % len(NAMED)]] if self.hides else []

    def make(self) -> tuple[Hidden, Columns]:
        """The knob, which is the same for all faults, and the columns of its log with the fault."""
        own = FAULTS[self.fault]
        rng = np.random.default_rng([self.seed, zlib.crc32(self.fault.encode())])
        drawn = np.random.default_rng([self.seed, 7])
        motion = list(MOTIONS)[(self.seed + self.hides) % len(MOTIONS)]
        strength = float(np.exp(drawn.uniform(np.log(WEAKEST), np.log(STRONGEST))))
        knob = self._knob(motion, strength, max(fault.keep for fault in own))
        columns = {name: values.copy() for name, values in knob.capture.items()}
        for fault in own:
            columns = fault.put(rng, columns)
        return knob, columns

    def _knob(self, motion: str, strength: float, keep: float) -> Hidden:
        """The knob; its effect is as much weaker as it takes where none shows it so strongly."""
        if not self.hides:
            return make(self.seed, [], motion, keep=keep)
        while strength > WEAKEST / 4.0:
            try:
                return make(self.seed, self.effects, motion, strength, keep=keep)
            except ValueError:
                strength /= 2.0
        return make(self.seed, self.effects, motion, strength, keep=keep)


def examine(log: Log) -> Row:
    """What is said of one log, beside the truth."""
    knob, columns = log.make()
    start = time.process_time()

    def watch(_: str) -> None:
        if time.process_time() - start > log.cap_s:
            raise TimeoutError(f"not done in {log.cap_s:g} s of the processor")

    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "log.npz"
        np.savez(path, **columns)
        capture = kc.load(path)
        try:
            told = kc.learn(capture, progress=watch) if log.learned else kc.fit(capture)
            document = told.document()
        except Exception as error:  # a program that fails has not answered, and the others go on
            findings = [finding.document() for finding in capture.findings]
            failed = {"verdict": f"{type(error).__name__}: {error}", "found": [], "ladder": []}
            document = failed | {"findings": findings, "noise_floor": None}
    about = {"fault": log.fault, "seed": log.seed, "motion": knob.motion, "hid": list(knob.effects)}
    about |= {"learned": log.learned, "seconds": round(time.process_time() - start, 1)}
    about |= judged(log.fault, knob, document)
    return about | answered(log.fault, knob, document) if log.learned else about


def judged(name: str, knob: Hidden, document: dict[str, Any]) -> Row:
    """How what was found and fitted compares with the fault `name` of a log and with its knob."""
    faults = FAULTS[name]
    kinds = [(finding["kind"], f"{finding['kind']} {finding['column']}") for finding in document["findings"]]
    wanted = frozenset().union(*(fault.said for fault in faults))
    for effect, kind in SHOWS_AS.items():
        if effect in knob.effects:
            wanted |= {kind}
    found = set(document.get("found", []))  # a fit names no effect
    sayable = [fault for fault in faults if fault.said]
    last = document["ladder"][-1:] if "ladder" in document else [document]
    estimate = last[0]["params"].get("inertia.M") if last else None
    true, floor = knob.knob["inertia.M"], document["noise_floor"]
    interval = estimate and estimate["ci95"]
    named = [
        any(fault.said & set(kind) for kind in kinds) or bool(fault.effects & found) for fault in sayable
    ]
    return {
        "said": all(named) if named else None,
        "besides": sorted({kind[1] for kind in kinds if not wanted & set(kind)}),
        "off_percent": None if estimate is None else round(100.0 * (estimate["value"] / true - 1.0), 3),
        "holds": bool(interval and interval[0] <= true <= interval[1]),
        "floor": None if not floor else round(floor / knob.noise_floor, 4),
    }


def answered(name: str, knob: Hidden, document: dict[str, Any]) -> Row:
    """How the verdict and the effects that were named compare with what is hidden in the knob."""
    found, verdict = document["found"], document["verdict"]
    accepted = set().union(*knob.accepted)
    named = [effect for effect in found if not any(effect in fault.effects for fault in FAULTS[name])]
    suspected = verdict == "unexplained" and not named and not accepted
    return {
        "verdict": verdict,
        "found": found,
        "complete": verdict == "complete",
        "first": bool(named) and named[0] in accepted,
        "exact": verdict == "missing" and len(named) == 1 and named[0] in accepted,
        "accused": bool(set(named) - accepted) or (suspected and not barred(name)),
    }


def barred(name: str) -> bool:
    """Whether a log with that fault is no longer one of the knob."""
    return any(fault.bars for fault in FAULTS[name])


def asked(fault: str, seeds: int, fits: int, first: int, cap_s: float = 60.0) -> list[Log]:
    """The logs of a fault: knobs that are learned without and with an effect, and those that are fitted."""
    learned = [
        Log(fault, seed, hides, True, cap_s)
        for seed in range(first, first + seeds)
        for hides in (False, True)
    ]
    return learned + [Log(fault, seed, False, False) for seed in range(first, first + fits)]
