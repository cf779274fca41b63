"""Does the next experiment tell what it says it would? `python benches/study_next.py [--seeds N]`.

Knobs of the examination's own simulator with an effect that 6 s of an ordinary motion show, and leave tied
with a rival. A motion is designed for the two, and the same knob is recorded on it, and beside it on a
standard motion of the same length, both within the rig's limits. Realised D is what the wrong rival then
leaves more than the right one, refitted to both captures, in variances of the noise; settled is a tie whose
realised D is beyond 10.8 either way. Expected D is that of the rival that is right.
"""

import argparse
import math
import tempfile
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any, NamedTuple

import hidden
import numpy as np
from hidden.motions import Track
from resumed import resumed, version

import knobcam as kc
from knobcam.learn.contenders import contenders
from knobcam.learn.experiment import STANDARD
from knobcam.learn.motion_space import standard
from knobcam.learn.telling import TOLD, Telling

HERE = Path(__file__).parent
RESULTS = HERE / "results" / "next.jsonl"
# What is hidden, and what it is taken for.
PAIRS = (
    ("presliding", "compliance"),
    ("presliding", "stribeck"),
    ("stribeck", "presliding"),
    ("stribeck", "quadratic_drag"),
    ("unbalance", "return_spring"),
    ("return_spring", "position_polynomial"),
    ("return_spring", "unbalance"),
    ("quadratic_drag", "stribeck"),
    ("backlash", "compliance"),
    ("compliance", "backlash"),
    ("position_friction", "detent_harmonics"),
    ("directional_detent", "detent_harmonics"),
    ("unbalance", "position_polynomial"),
    ("friction_drift", "torque_drift"),
    ("torque_drift", "friction_drift"),
    ("load_friction", "position_friction"),
)
STRENGTHS = (0.04, 0.4)
SEEN = 25.0  # variances of the noise that the right effect takes off the base model's error: it is there
# What the rig can do, wider than what a capture happened to reach.
RIG = kc.Limits(0.15, 12.0, 400.0, -3.0, 3.0)
CAP_S = 240.0


class Tie(NamedTuple):
    """A knob with an effect in it, and what that is taken for."""

    truth: str
    rival: str
    seed: int

    def __str__(self) -> str:
        return f"{self.truth}/{self.rival}:{self.seed}"


def examine(tie: Tie) -> Iterator[dict[str, Any]]:
    """What is expected of the motion and what comes of it; a row without marks where there is no tie."""
    motion = list(hidden.MOTIONS)[tie.seed % len(hidden.MOTIONS)]
    try:
        knob = hidden.make(tie.seed, [tie.truth], motion, STRENGTHS)
    except ValueError:
        return
    yield {"motion": motion, "strength": knob.strength}
    with tempfile.TemporaryDirectory() as folder:
        first = read(folder, "first", knob.capture)
        try:
            story = kc.learn(first, budget_s=60.0)
            right, wrong = (one.fit for one in contenders(story, [tie.truth, tie.rival]))
        except kc.InputError as error:
            yield {"tied": False, "why": str(error)}
            return
        white = right.noise_floor**2 * sum(one.core.used for one in right.prepared) / right.white_squares
        before = (squares([wrong]) - squares([right])) / white
        seen = (squares([story.ladder[0].fit]) - squares([right])) / white
        if not (abs(before) < TOLD and seen > SEEN):
            yield {"tied": False}
            return
        designed = kc.next_experiment(story, rivals=[tie.truth, tie.rival], limits=RIG)
        row = {"tied": True, "before": before, "took_s": designed.took_s, "separable": designed.separable}
        telling = Telling(designed.rivals)
        row["expected"] = float(telling.evidence(designed.track)[0, 1])
        peak = float(np.max(np.abs(knob.chain.torque(track_of(designed.track))[0]))) if knob.chain else 0.0
        row["beyond"] = peak > designed.limits.torque_Nm
        usual = standard(STANDARD[tie.seed % len(STANDARD)], RIG, RIG.sample_rate_hz)
        row["expected_standard"] = float(telling.evidence(usual)[0, 1])
        for name, track in (("", designed.track), ("_standard", usual)):
            second = read(folder, f"second{name}", knob.again(track_of(track), 1))
            # Looked for anew: a period that one capture hardly told may have been a wrong one.
            base = kc.fit([first, second], story.ladder[0].fit.model)
            both = [base.add(effect) for effect in (tie.truth, tie.rival)]
            row[f"realised{name}"] = (squares([both[1]]) - squares([both[0]])) / white - before
            row[f"total{name}"] = row[f"realised{name}"] + before
        yield row


def squares(fits: list[kc.Fit]) -> float:
    """Sum of squares that fits leave, (N m)^2."""
    return sum(fit.rmse**2 * sum(one.core.used for one in fit.prepared) for fit in fits)


def read(folder: str, name: str, columns: dict[str, Any]) -> kc.Capture:
    """Columns as the program reads them."""
    path = Path(folder) / f"{name}.npz"
    np.savez(path, **columns)
    return kc.load(path)


def track_of(track: kc.MotionTrack) -> Track:
    """A motion as the other simulator takes it."""
    return Track(track.t, track.theta, track.omega, track.alpha)


def table(rows: list[dict[str, Any]]) -> str:
    """What was expected and what came, in a few lines."""
    ties = [row for row in rows if row.get("tied") and "total" in row]
    lines = [
        f"{time.strftime('%Y-%m-%d')}: python benches/study_next.py: {len(ties)} ties of {len(rows)} knobs",
        "                                     | right % | wrong % | open % ",
    ]
    for words, name in (("the designed motion, 10 s", ""), ("a standard motion, as long", "_standard")):
        total = np.array([row[f"total{name}"] for row in ties])
        counts = [np.mean(total > TOLD), np.mean(total < -TOLD), np.mean(np.abs(total) <= TOLD)]
        lines.append(f"{words:36} | " + " | ".join(f"{100.0 * share:7.0f}" for share in counts))
    for words, name in (("designed", ""), ("standard", "_standard")):
        pairs = [(row[f"expected{name}"], row[f"realised{name}"]) for row in ties]
        told = np.array([(a, b) for a, b in pairs if a > TOLD and b > 0.0])
        if len(told) > 2:
            ratio = np.log(told[:, 1] / told[:, 0])
            slope = np.polyfit(np.log(told[:, 0]), np.log(told[:, 1]), 1)[0]
            lines.append(
                f"realised over expected D, {words}: {math.exp(float(np.median(ratio))):.2f} "
                f"(middle half {math.exp(float(np.quantile(ratio, 0.25))):.2f} to "
                f"{math.exp(float(np.quantile(ratio, 0.75))):.2f}), slope of logarithms {slope:.2f}"
            )
    beyond = sum(row["beyond"] for row in ties)
    took = np.median([row["took_s"] for row in ties]) if ties else 0.0
    lines.append(
        f"torque of the true knob beyond the limit: {beyond} of {len(ties)}; median {took:.1f} s a design"
    )
    return "\n".join(lines)


def main() -> None:
    """Examine, and print the table."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--seeds", type=int, default=8)
    parser.add_argument("--first", type=int, default=0)
    parser.add_argument("--jobs", type=int, default=2)
    parser.add_argument("--out", type=Path, default=RESULTS)
    args = parser.parse_args()
    ties = [Tie(*pair, seed) for seed in range(args.first, args.first + args.seeds) for pair in PAIRS]
    about = {"program": version(Path(kc.__file__).parent)}
    rows = resumed(examine, ties, args.out, about, args.jobs, CAP_S, {"tied": False, "why": "no answer"})
    print(table(rows))


if __name__ == "__main__":
    main()
