"""Does the next experiment tell what it says it would? `python benches/study_next.py [--seeds N]`.

Knobs of the examination's own simulator with an effect that 6 s of an ordinary motion show, and leave tied
with a rival: evidence and prices differ by less than what tells (`RULE.alike`). Up to two motions of 10 s are
designed for the two and recorded on the same knob, the second where the first left them tied; beside it two
standard motions, at the size that they have and as large as the rig's limits let them be. Realised D is what
the wrong rival leaves more of the first of them than the right one, refitted to both captures, in variances
of the noise. Expected D is that of the rival that is right.
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
from knobcam.fit.rule import RULE
from knobcam.learn.contenders import contenders
from knobcam.learn.designing import STANDARD, design
from knobcam.learn.motion_space import standard
from knobcam.learn.telling import TOLD, Rival, Telling

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
    ("load_friction", "position_friction"),
)
STRENGTHS = (0.07, 0.25)
# What the rig can do, wider than what a capture happened to reach.
RIG = kc.Limits(0.15, 12.0, 400.0, -3.0, 3.0)
CAP_S = 400.0
MOTIONS = 2
ARMS = {
    "designed": "designed",
    "wide": "standard, as large as the limits",
    "standard": "standard, as they are",
}


class Tie(NamedTuple):
    """A knob with an effect in it, and what that is taken for."""

    truth: str
    rival: str
    seed: int

    def __str__(self) -> str:
        return f"{self.truth}/{self.rival}:{self.seed}"


def examine(tie: Tie) -> Iterator[dict[str, Any]]:
    """What is expected of motions and what comes of them; a row without marks where there is no tie."""
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
            rivals = contenders(story, [tie.truth, tie.rival])
        except kc.InputError as error:
            yield {"tied": False, "why": str(error)}
            return
        base = story.ladder[0].fit
        before = lead(*rivals)
        if not (abs(before) < RULE.alike and lead(rivals[0], Rival((), base)) > 0.0):
            yield {"tied": False, "before": before, "seen": lead(rivals[0], Rival((), base))}
            return
        row: dict[str, Any] = {"tied": True, "before": before}
        usual = [STANDARD[(tie.seed + number) % len(STANDARD)] for number in range(MOTIONS)]
        for arm in ARMS:
            captures, now = [first], rivals
            for number in range(MOTIONS):
                if arm == "designed":
                    designed = design(now, RIG)
                    track = designed.track
                    row |= {"took_s": max(row.get("took_s", 0.0), designed.took_s)}
                    row.setdefault("separable", designed.separable)
                    row.setdefault("twins", not designed.separable and designed.change is None)
                    torque = knob.chain.torque(track_of(track))[0] if knob.chain else np.zeros(1)
                    row["beyond"] = row.get("beyond", False) or float(np.abs(torque).max()) > RIG.torque_Nm
                elif arm == "wide":
                    track = standard(usual[number], RIG, RIG.sample_rate_hz)
                else:
                    track = kc.motion(usual[number], RIG.duration_s, RIG.sample_rate_hz)
                captures.append(read(folder, f"{arm}{number}", knob.again(track_of(track), 1 + number)))
                # Looked for anew: a period that one capture hardly told may have been a wrong one.
                both = kc.fit(captures, base.model)
                then = tuple(Rival((one,), both.add(one)) for one in (tie.truth, tie.rival))
                if number == 0 and arm != "standard":
                    row[f"expected_{arm}"] = float(Telling(rivals).evidence(track)[0, 1])
                    row[f"realised_{arm}"] = apart(*then) - apart(*rivals)
                now = then
                row[f"lead_{arm}"], row[f"motions_{arm}"] = lead(*now), number + 1
                if abs(lead(*now)) >= RULE.alike:
                    break
            if arm == "designed":
                row["learned"] = list(kc.learn(captures, budget_s=60.0).found)
        yield row


def apart(right: Rival, wrong: Rival) -> float:
    """What the wrong one leaves more than the right one, in variances of the raw noise."""
    fit = right.fit
    white = fit.noise_floor**2 * sum(one.core.used for one in fit.prepared) / fit.white_squares
    return (squares(wrong.fit) - squares(fit)) / white


def lead(right: Rival, wrong: Rival) -> float:
    """How far the right one is ahead, each with the price of its parameters."""
    return apart(right, wrong) - RULE.price * (len(right.fit.core.free) - len(wrong.fit.core.free))


def squares(fit: kc.Fit) -> float:
    """Sum of squares that a fit leaves, (N m)^2."""
    return fit.rmse**2 * sum(one.core.used for one in fit.prepared)


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
    ties = [row for row in rows if row.get("tied") and "learned" in row]
    kinds = {row["case"].split(":")[0] for row in ties}
    lines = [
        f"{time.strftime('%Y-%m-%d')}: python benches/study_next.py: {len(ties)} ties of {len(kinds)} kinds, "
        f"of {len(rows)} knobs",
        "                                               | right % | wrong % | tied % ",
    ]
    for arm, words in ARMS.items():
        for motions in range(1, MOTIONS + 1):
            ends = [row[f"lead_{arm}"] if row[f"motions_{arm}"] <= motions else 0.0 for row in ties]
            lines.append(f"{motions} x 10 s, {words:37} | " + shares(ends))
    told = [row["lead_designed"] for row in ties if row["separable"]]
    lines.append(f"  {f'of {len(told)} that a motion should tell':45} | {shares(told)}")
    right = np.mean([row["learned"] == [row["case"].split("/")[0]] for row in ties])
    lines.append(f"named so by learn, of the designed motions' captures: {100.0 * right:.0f} %")
    for arm in ("designed", "wide"):
        pairs = np.array([(row[f"expected_{arm}"], row[f"realised_{arm}"]) for row in ties]).reshape(-1, 2)
        pairs = pairs[(pairs[:, 0] > TOLD) & (pairs[:, 1] > 0.0)]
        if len(pairs) > 2:
            ratio = np.log(pairs[:, 1] / pairs[:, 0])
            slope = np.polyfit(np.log(pairs[:, 0]), np.log(pairs[:, 1]), 1)[0]
            middle = ", ".join(f"{math.exp(float(np.quantile(ratio, q))):.2f}" for q in (0.25, 0.5, 0.75))
            lines.append(
                f"realised over expected D, {arm}: quartiles {middle}, slope of logarithms {slope:.2f}"
            )
    alike = [row for row in ties if all(abs(row[f"lead_{arm}"]) < RULE.alike for arm in ARMS)]
    others = [row for row in ties if row not in alike]
    twins = [f"{sum(row['twins'] for row in some)} of {len(some)}" for some in (alike, others)]
    lines.append(f"declared the same: {twins[0]} that no motion told, {twins[1]} others")
    beyond = sum(row["beyond"] for row in ties)
    took = (
        [float(np.quantile([row["took_s"] for row in ties], q)) for q in (0.5, 1.0)] if ties else [0.0, 0.0]
    )
    lines.append(
        f"torque of the true knob beyond the limit: {beyond} of {len(ties)}; "
        f"{took[0]:.1f} s a design, {took[1]:.1f} at most"
    )
    return "\n".join(lines)


def shares(leads: list[float]) -> str:
    """How many are settled rightly, wrongly, and not, in per cent."""
    ends = np.array(leads)
    tied = np.abs(ends) < RULE.alike
    counts = (
        [np.mean((ends > 0.0) & ~tied), np.mean((ends < 0.0) & ~tied), np.mean(tied)]
        if len(ends)
        else [0.0] * 3
    )
    return " | ".join(f"{100.0 * share:7.0f}" for share in counts)


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
