"""Laws that are in no catalogue: are they proposed? `python benches/study_propose.py [--laws 5] [--jobs 2]`.

Knobs of the examination's own simulator with a law of `hidden.lawful`, with nothing, or with one named
effect. `learn` decides, without couplings (which take by far the longest), and laws are proposed for what it
leaves unexplained. A law is right in form where it differs from the truth on the recorded motion by less than
3 % of its RMS: as it stands, and beyond what Equation 1 can absorb of either, which no capture tells. Rows
are kept, so that a run that was stopped goes on.
"""

import argparse
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any, NamedTuple

import hidden
import numpy as np
from hidden.base import Base
from hidden.lawful import NEVER_LOOKED_AT, VARIABLES
from hidden.motions import Floats, Track
from hidden.shapes import NAMED
from resumed import resumed, version

import knobcam as kc

HERE = Path(__file__).parent
RESULTS = HERE / "results" / "propose.jsonl"
COUPLINGS = ("backlash", "compliance")
STRENGTHS = (1.5, 8.0)
RIGHT = 0.03
CAP_S = 300.0
NOTHING = "nothing"
KNOWN: dict[str, Any] = {name: getattr(np, name) for name in ("sin", "cos", "exp", "tanh", "abs", "sign")}
KNOWN["pi"] = np.pi


class Case(NamedTuple):
    """A knob, and what is hidden in it."""

    kind: str
    seed: int

    def __str__(self) -> str:
        return f"{self.kind}:{self.seed}"


def torque(law: dict[str, Any], track: Track) -> Floats:
    """A proposed law on a motion."""
    params = {name: one["value"] for name, one in law["params"].items()}
    names = KNOWN | track._asdict() | {"s": since_turned(track)} | params
    value = eval(law["law"].replace("^", "**"), {"__builtins__": {}}, names)
    return np.broadcast_to(np.asarray(value, float), track.t.shape)


def lawful(kind: str) -> tuple[str, ...]:
    """The variables of a law, or of the sum of two; none of what has a name."""
    return tuple(sorted({name for one in kind.split("+") for name in VARIABLES.get(one, ())}))


def since_turned(track: Track) -> Floats:
    """Way since the velocity last changed its sign, which formulas know as `s`."""
    turned = np.flatnonzero(np.diff(np.sign(track.omega), prepend=0.0))
    last = turned[np.maximum(np.searchsorted(turned, np.arange(len(track.t)), side="right") - 1, 0)]
    return np.abs(track.theta - track.theta[last])


def examine(case: Case) -> Iterator[dict[str, Any]]:
    """What is proposed, and how right it is."""
    effects = [] if case.kind == NOTHING else case.kind.split("+")
    strength = None if case.kind in NAMED or not effects else STRENGTHS
    try:
        knob = hidden.make(case.seed, effects, strength=strength)
    except ValueError:
        return
    assert knob.chain is not None and knob.track is not None
    yield {"kind": case.kind, "motion": knob.motion, "strength": round(knob.strength, 2)}
    columns = {name.split("_")[0]: column for name, column in knob.capture.items()}
    story = kc.learn(kc.Capture.from_arrays(**columns), without=COUPLINGS)
    before = time.process_time()
    found = story.propose()
    seconds = time.process_time() - before
    laws = [one.document() for one in found.laws]
    row: dict[str, Any] = {
        "verdict": story.verdict,
        "found": list(story.found),
        "laws": [one["law"] for one in laws],
        "why": found.why,
        "seconds": round(seconds, 2),
        "needs": [one.variables for one in found.needs],
    }
    if laws and laws[0] and lawful(case.kind):
        row["variables"] = laws[0]["variables"]
        row["heldout"] = laws[0]["rmse_heldout"] / knob.noise_floor
        # None of these laws is friction under a load, whose torque takes more than the motion to tell.
        if "load" not in laws[0]["variables"]:
            track, truth = knob.track, knob.chain.strange
            base, first = Base(track, knob.chain.loads), torque(laws[0], track)
            row["off"] = rms(first - truth) / rms(truth)
            row["off_beyond"] = base.left(first - truth) / base.left(truth)
    yield row


def rms(values: Floats) -> float:
    return float(np.sqrt(np.mean(values**2)))


def table(rows: list[dict[str, Any]]) -> str:
    """The figures, a row a group of kinds."""
    marked = [row for row in rows if "laws" in row]
    head = (
        "right variables | right form | the same beyond Equation 1 | unseen blocks <= 1.05 / 1.1 of the floor"
        " | needs begin with them"
    )
    lines = [f"{'law':16} |  n | {head} | s"]
    groups = {kind: [row for row in marked if row["kind"] == kind] for kind in VARIABLES}
    looked = [row for row in marked if row["kind"] in VARIABLES and row["kind"] not in NEVER_LOOKED_AT]
    groups |= {
        "all looked at": looked,
        "never looked at": [row for row in marked if row["kind"] in NEVER_LOOKED_AT],
        "all": [row for row in marked if row["kind"] in VARIABLES],
        "sums of two": [row for row in marked if "+" in row["kind"]],
    }
    for name, group in groups.items():
        if not group:
            continue
        share = lambda test, group=group: f"{100.0 * sum(map(test, group)) / len(group):4.0f} %"  # noqa: E731
        lines.append(
            f"{name:16} | {len(group):2} | "
            + share(lambda row: tuple(row.get("variables", ())) == lawful(row["kind"]))
            + " | "
            + share(lambda row: row.get("off", 1.0) < RIGHT)
            + " | "
            + share(lambda row: row.get("off_beyond", 1.0) < RIGHT)
            + " | "
            + share(lambda row: row.get("heldout", 9.0) <= 1.05)
            + " / "
            + share(lambda row: row.get("heldout", 9.0) <= 1.1)
            + " | "
            + share(lambda row: tuple(next(iter(row.get("needs", ())), ())) == lawful(row["kind"]))
            + f" | {np.median([row['seconds'] for row in group]):.1f}"
        )
    for name, group in (
        ("nothing", [row for row in marked if row["kind"] == NOTHING]),
        ("a named effect", [row for row in marked if row["kind"] in NAMED]),
    ):
        proposed = [f"{row['case']} {row['laws'][0]}" for row in group if row["laws"]]
        lines.append(f"proposed where {name} is hidden: {len(proposed)} of {len(group)} {proposed or ''}")
    return "\n".join(lines)


def main() -> None:
    """Examine, and print the table."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--laws", type=int, default=5, help="knobs of each law")
    parser.add_argument("--sums", type=int, default=20, help="knobs with two laws at once")
    parser.add_argument("--faultless", type=int, default=60)
    parser.add_argument("--named", type=int, default=2, help="knobs of each named effect")
    parser.add_argument("--first", type=int, default=40_000)
    parser.add_argument("--jobs", type=int, default=2)
    parser.add_argument("--out", type=Path, default=RESULTS)
    args = parser.parse_args()
    named = [name for name in NAMED if name not in COUPLINGS]
    cases = [Case(kind, args.first + seed) for seed in range(args.laws) for kind in VARIABLES]
    pairs = np.random.default_rng(args.first)
    cases += [
        Case("+".join(pairs.choice(list(VARIABLES), 2, replace=False)), args.first + seed)
        for seed in range(args.sums)
    ]
    cases += [Case(NOTHING, args.first + seed) for seed in range(args.faultless)]
    cases += [Case(kind, args.first + seed) for seed in range(args.named) for kind in named]
    about = {"program": version(Path(kc.__file__).parent)}
    rows = resumed(examine, cases, args.out, about, args.jobs, CAP_S, {"why": "no answer"})
    print(table(rows))


if __name__ == "__main__":
    main()
