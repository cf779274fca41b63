"""Does the next experiment tell what it says it would? `python benches/study_next.py [--knobs N]`.

Knobs of the examination's own simulator with a weak effect. Where `learn` leaves it tied with others on 6 s
of an ordinary motion, by its own words, up to two motions of 10 s are designed and recorded on the same knob,
the second where the first left something tied; beside it standard motions, as large as the rig's limits let
them be. Settled is what `learn` then names, of all captures together, without another that it could be.
Realised D of a pair is what the wrong rival leaves more of the first of them than the right one, refitted to
both captures, in variances of the noise.
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
from knobcam.learn.designing import STANDARD
from knobcam.learn.motion_space import standard
from knobcam.learn.telling import TOLD, Rival, Telling

HERE = Path(__file__).parent
RESULTS = HERE / "results" / "next.jsonl"
TRUTHS = (
    *("presliding", "stribeck", "quadratic_drag", "load_friction", "friction_drift", "position_friction"),
    *("return_spring", "unbalance", "position_polynomial", "backlash", "compliance", "torque_lag"),
    *("directional_detent", "detent_harmonics", "cogging"),
)
STRENGTHS = (0.06, 0.4)
# What the rig can do, wider than what a capture happened to reach.
RIG = kc.Limits(0.15, 12.0, 400.0, -3.0, 3.0)
CAP_S = 400.0
MOTIONS = 2
ARMS = {"designed": "designed", "standard": "standard, as large as the limits"}


class Hiding(NamedTuple):
    """A knob with an effect in it."""

    truth: str
    seed: int

    def __str__(self) -> str:
        return f"{self.truth}:{self.seed}"


def examine(case: Hiding) -> Iterator[dict[str, Any]]:
    """What is expected of motions and what comes of them; a row without marks where there is no tie."""
    motion = list(hidden.MOTIONS)[case.seed % len(hidden.MOTIONS)]
    try:
        knob = hidden.make(case.seed, [case.truth], motion, STRENGTHS)
    except ValueError:
        return
    yield {"motion": motion, "strength": knob.strength}
    with tempfile.TemporaryDirectory() as folder:
        first = read(folder, "first", knob.capture)
        story = kc.learn(first, budget_s=60.0)
        rivals = contenders(story, ())
        row: dict[str, Any] = {"found": story.found, "rivals": [one.effects for one in rivals]}
        if (case.truth,) not in row["rivals"]:
            yield row | {"tied": False}
            return
        row["tied"] = True
        for arm in ARMS:
            captures, now = [first], story
            for number in range(MOTIONS):
                if arm == "designed":
                    designed = kc.next_experiment(now, limits=RIG)
                    track = designed.track
                    row["took_s"] = max(row.get("took_s", 0.0), designed.took_s)
                    row.setdefault("separable", designed.separable)
                    torque = knob.chain.torque(track_of(track))[0] if knob.chain else np.zeros(1)
                    row["beyond"] = row.get("beyond", False) or float(np.abs(torque).max()) > RIG.torque_Nm
                else:
                    name = STANDARD[(case.seed + number) % len(STANDARD)]
                    track = standard(name, RIG, RIG.sample_rate_hz)
                captures.append(read(folder, f"{arm}{number}", knob.again(track_of(track), 1 + number)))
                if number == 0:
                    row[f"pairs_{arm}"] = realised(rivals, case.truth, story, captures, track)
                now = kc.learn(captures, budget_s=60.0)
                left = contenders(now, ())
                row[f"ends_{arm}"] = [*row.get(f"ends_{arm}", ()), [now.found, len(left)]]
                if not left:
                    break
        yield row


def realised(
    rivals: tuple[Rival, ...], truth: str, story: kc.LearningResult, captures: list[kc.Capture], track: Any
) -> list[tuple[float, float]]:
    """Of the true rival beside each other one D as expected of a motion, and as it came."""
    told = Telling(rivals).evidence(track)
    at = next(i for i, one in enumerate(rivals) if one.effects == (truth,))
    # Looked for anew: a period that one capture hardly told may have been a wrong one.
    base = kc.fit(captures, story.ladder[0].fit.model)
    both = [Rival(one.effects, with_all(base, one.effects)) for one in rivals]
    others = [i for i in range(len(rivals)) if i != at]
    return [(float(told[at, i]), apart(both[at], both[i]) - apart(rivals[at], rivals[i])) for i in others]


def with_all(fit: kc.Fit, effects: tuple[str, ...]) -> kc.Fit:
    """The fit with some effects more."""
    for effect in effects:
        fit = fit.add(effect)
    return fit


def apart(right: Rival, wrong: Rival) -> float:
    """What the wrong one leaves more than the right one, in variances of the raw noise."""
    fit = right.fit
    white = fit.noise_floor**2 * sum(one.core.used for one in fit.prepared) / fit.white_squares
    return (squares(wrong.fit) - squares(fit)) / white


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
    ties = [row for row in rows if row.get("tied") and "ends_standard" in row]
    kinds = {frozenset((row["case"].split(":")[0], *other)) for row in ties for other in row["rivals"]}
    lines = [
        f"{time.strftime('%Y-%m-%d')}: python benches/study_next.py: {len(ties)} ties of "
        f"{sum(len(kind) > 1 for kind in kinds)} kinds of pairs, of {len(rows)} knobs",
        "                                               | right % | wrong % | tied % ",
    ]
    for arm, words in ARMS.items():
        for motions in range(1, MOTIONS + 1):
            ends = [(row["case"], row[f"ends_{arm}"][:motions][-1]) for row in ties]
            lines.append(f"{motions} x 10 s, {words:37} | " + shares(ends))
    told = [(row["case"], row["ends_designed"][-1]) for row in ties if row["separable"]]
    lines.append(f"  {f'of {len(told)} that a motion should tell':45} | {shares(told)}")
    for arm in ARMS:
        pairs = np.array([pair for row in ties for pair in row[f"pairs_{arm}"]]).reshape(-1, 2)
        pairs = pairs[(pairs[:, 0] > TOLD) & (pairs[:, 1] > 0.0)]
        if len(pairs) > 2:
            ratio = np.log(pairs[:, 1] / pairs[:, 0])
            slope = np.polyfit(np.log(pairs[:, 0]), np.log(pairs[:, 1]), 1)[0]
            middle = ", ".join(f"{math.exp(float(np.quantile(ratio, q))):.2f}" for q in (0.25, 0.5, 0.75))
            lines.append(f"realised / expected D, {arm}: quartiles {middle}, slope of logarithms {slope:.2f}")
    beyond = sum(row["beyond"] for row in ties)
    took = np.quantile([row["took_s"] for row in ties] or [0.0], [0.5, 1.0])
    lines.append(
        f"torque of the true knob beyond the limit: {beyond} of {len(ties)}; "
        f"{took[0]:.1f} s a design, {took[1]:.1f} at most"
    )
    return "\n".join(lines)


def shares(ends: list[tuple[str, Any]]) -> str:
    """How many are settled rightly, wrongly, and not, in per cent."""
    settled = [(list(found) == [case.split(":")[0]], left == 0) for case, (found, left) in ends]
    counts = [
        sum(right and done for right, done in settled),
        sum(done and not right for right, done in settled),
        sum(not done for _, done in settled),
    ]
    return " | ".join(f"{100.0 * count / max(len(settled), 1):7.0f}" for count in counts)


def main() -> None:
    """Examine, and print the table."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--knobs", type=int, default=900)
    parser.add_argument("--first", type=int, default=0)
    parser.add_argument("--jobs", type=int, default=2)
    parser.add_argument("--out", type=Path, default=RESULTS)
    args = parser.parse_args()
    each = math.ceil(args.knobs / len(TRUTHS))
    cases = [Hiding(truth, seed) for seed in range(args.first, args.first + each) for truth in TRUTHS]
    about = {"program": version(Path(kc.__file__).parent)}
    rows = resumed(examine, cases, args.out, about, args.jobs, CAP_S, {"tied": False, "why": "no answer"})
    print(table(rows))


if __name__ == "__main__":
    main()
