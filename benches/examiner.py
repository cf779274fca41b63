"""One examination: a capture with something hidden goes into a file, and the program gets that alone."""

import tempfile
import time
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any, NamedTuple

import hidden
import numpy as np
from hidden.sensors import RATE_HZ
from strata import Stratum

import knobcam as kc

# One sample of delay at the rig's rate, s.
SAMPLE_S = 2e-4
# What depends on all that came before, and how much of that no log has, s.
REMEMBERING = ("backlash", "compliance", "presliding")
LEAD_S = 1.0
# A constant torque is told from a difference of the two Coulomb levels by nothing but convention: under these
# effects, which bring one, the levels themselves are not examined.
WITH_A_CONSTANT = {"position_polynomial", "return_spring", "unbalance", "torque_drift"}

# The marks of who has said nothing.
SILENT: dict[str, Any] = {
    "verdict": "no answer",
    "found": [],
    "axis": None,
    "first": False,
    "exact": False,
    "wrong": False,
    "error": None,
    "floor": None,
    "p_value": None,
    "covered": {},
}


class Case(NamedTuple):
    """A capture to be examined; `single/stribeck:7` is seed 7 of the knobs with a Stribeck effect alone."""

    sitting: str
    topic: str
    seed: int

    def __str__(self) -> str:
        return f"{self.kind}:{self.seed}"

    @property
    def kind(self) -> str:
        """The sitting and its topic."""
        return f"{self.sitting}/{self.topic}"

    @staticmethod
    def parse(text: str) -> "Case":
        """The case of a name."""
        kind, seed = text.split(":")
        return Case(*kind.split("/"), int(seed))

    @property
    def without(self) -> tuple[str, ...]:
        """What is taken out of the catalogue: the hidden effect, and those that are as right."""
        return tuple(hidden.ACCEPTED[self.topic]) if self.sitting == "left-out" else ()

    def make(self) -> hidden.Hidden:
        """The capture and what is behind it."""
        match self.sitting:
            case "faultless":
                return hidden.make(self.seed)
            case "several":
                return hidden.make(self.seed, several(self.seed))
            case "shaft":
                return hidden.make(self.seed, [self.topic, beside(self.seed)], at_shaft=True)
            case "lag":
                return hidden.make(self.seed, ["torque_lag"], size=SAMPLE_S)
            case "moving":
                return in_motion(hidden.make(self.seed, [self.topic]))
            case _:
                return hidden.make(self.seed, [self.topic])


def cases(seeds: int, first: int) -> list[Case]:
    """The whole examination with this many seeds per effect."""

    def some(sitting: str, topic: str, times: int = 1) -> list[Case]:
        return [Case(sitting, topic, seed) for seed in range(first, first + times * seeds)]

    every = [case for name in hidden.NAMED for case in some("single", name)]
    every += some("several", "effects", 5) + some("faultless", "knob", 10)
    every += some("shaft", "backlash", 3) + some("shaft", "compliance", 3)
    every += [case for name in hidden.STRANGE for case in some("strange", name)]
    every += [case for name in hidden.NAMED for case in some("left-out", name)]
    every += [case for name in REMEMBERING for case in some("moving", name, 2)]
    return every + some("lag", "sample", 2)


def in_motion(knob: hidden.Hidden) -> hidden.Hidden:
    """The capture without its beginning: no simulation knows where the knob was when the log begins."""
    rows = round(LEAD_S * RATE_HZ)
    kept = {name: column[rows:] for name, column in knob.capture.items()}
    return replace(knob, capture=kept | {"t_s": kept["t_s"] - kept["t_s"][0]})


def several(seed: int) -> list[str]:
    """Two or three effects of different groups."""
    rng = np.random.default_rng([seed, 2])
    by_group: dict[str, str] = {}
    for name in rng.permutation(list(hidden.NAMED)):
        by_group.setdefault(hidden.NAMED[name].group, str(name))
    return [str(name) for name in rng.permutation(list(by_group.values()))[: 2 + seed % 2]]


def beside(seed: int) -> str:
    """An effect that loads a shaft."""
    loads = [name for name, kind in hidden.NAMED.items() if kind.order == 1 and name not in hidden.BUILDS_UP]
    return str(np.random.default_rng([seed, 3]).choice(loads))


def ask(knob: hidden.Hidden, without: tuple[str, ...]) -> dict[str, Any]:
    """What the program says of the capture file: the document of `knobcam learn`."""
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "capture.npz"
        np.savez(path, **knob.capture)
        return kc.learn(kc.load(path), without=without).document()


def sit(case: Case | Stratum) -> Iterator[dict[str, Any]]:
    """The row of a capture: what is known of the knob, then the marks."""
    knob = case.make()
    yield known(case, knob)
    yield marked(knob, case.without if isinstance(case, Case) else ())


def known(case: Case | Stratum, knob: hidden.Hidden) -> dict[str, Any]:
    """What a row says of its case, whatever the answer."""
    return {
        "sitting": case.sitting,
        "topic": case.topic,
        "motion": knob.motion,
        "effects": knob.effects,
        "accepted": knob.accepted,
        "strength": round(knob.strength, 2),
        "strengths": [round(strength, 2) for strength in knob.strengths],
        "misfit": round(knob.misfit, 3),
    }


def marked(knob: hidden.Hidden, without: tuple[str, ...] = ()) -> dict[str, Any]:
    """Ask, and judge the answer."""
    start = time.perf_counter()
    try:
        document = ask(knob, without)
    except Exception as error:  # a program that fails has not answered, and the others go on
        document = {
            "verdict": f"{type(error).__name__}: {error}",
            "found": [],
            "ladder": [],
            "noise_floor": np.nan,
        }
    return {"seconds": round(time.perf_counter() - start, 2), **judged(knob, document, bool(without))}


def judged(knob: hidden.Hidden, document: dict[str, Any], left_out: bool) -> dict[str, Any]:
    """How the document compares with what was hidden; `left_out`: the hidden effect cannot be named.

    Where the textbook laws of the right names leave more than chance of a stranger's torque, "unexplained"
    beside these names is as exact as "missing".
    """
    accepted = [] if left_out else [set(names) for names in knob.accepted if names]
    nameless = left_out or any(not names for names in knob.accepted)
    verdict, found, ladder = document["verdict"], document["found"], document["ladder"]
    right = set().union(*accepted)
    exact = not nameless and len(found) == len(accepted) and all(set(found) & names for names in accepted)
    verdicts = {"missing" if accepted else "complete"}
    exact = exact and verdict in verdicts | ({"unexplained"} if knob.misfit > hidden.ALIKE else set())
    last = ladder[-1] if ladder else {"rmse": np.nan, "params": {}}
    unexplained = document.get("unexplained") or {}
    return {
        "verdict": verdict,
        "found": found,
        "axis": unexplained.get("axis"),
        "first": bool(found) and found[0] in right,
        "exact": exact,
        "wrong": verdict == "missing" and not set(found) <= right,
        "error": round(last["rmse"] / knob.noise_floor, 4),
        "floor": round(document["noise_floor"] / knob.noise_floor, 4),
        "p_value": ladder[1].get("p_value") if len(ladder) > 1 else None,
        "covered": covered(knob, last["params"]),
    }


def covered(knob: hidden.Hidden, params: dict[str, Any]) -> dict[str, bool]:
    """Which 95 % intervals of the base parameters hold the truth; either of two detents may be the first."""
    hold = {}
    if (second := params.get("second_detent.P")) and (first := params.get("detent.P")):
        off = {at: abs(one["value"] - knob.knob["detent.P"]) for at, one in enumerate((first, second))}
        if off[1] < off[0]:
            params = {
                name.replace("second_", ""): one for name, one in params.items() if name[:6] != "detent"
            }
    for name, true in knob.knob.items():
        effect = name.split(".")[0]
        if effect == "coulomb" and WITH_A_CONSTANT & set(knob.effects):
            continue
        interval = params.get(name, {}).get("ci95")
        if interval is None or (effect == "detent" and knob.knob["detent.A"] == 0.0):
            continue
        low, high = interval
        off = true - (low + high) / 2.0
        if name == "detent.S":
            off = (off + np.pi) % (2.0 * np.pi) - np.pi
        hold[name] = bool(abs(off) <= (high - low) / 2.0)
    return hold
