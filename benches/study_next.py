"""Does the next experiment tell what it says it would? `python benches/study_next.py [--knobs N]`.

Knobs of the examination's own simulator with a weak effect, of all kinds in turn, recorded for 6 s on the
four ordinary motions in turn. Where `learn` names it from 6 s, it is asked again of the first 4, 2.7, 1.8,
1.2 and 0.8 s, until it leaves the effect tied with others, by its own words, or names it no more: few ties
are left by 6 s. Then up to two motions of 10 s are designed and recorded on the same knob, the second where
the first left something tied; beside it standard motions, as large as the rig's limits let them be. Settled
is what `learn` then names, of all captures together, without another that it could be. Realised D of a pair
is what the wrong rival leaves more of the first of them than the right one, refitted to both captures, in
variances of the noise.

With `--beside JOINT` each knob has that joint too, and each of both is 0.7 to 3 times the noise floor.

`--twins` takes the same ties and asks within what their captures reached, and within a third of that:
does it say rightly where no motion tells rivals apart? That it is so is what the simulator says of the
designed motion and the standard ones, as large as those limits let them be: after none of them `learn` names
the right one, and it alone. A recording is a draw, and one of five may tell by luck: each that told where
most did not is made four times more, and it is said of how many a motion tells in most of its recordings.
Beside it, as it was asked before: none leaves a realised D of 10.8. That is a kinder judge of the program:
where the plainer of two is right the price of the other's parameters tells them, at any D.
"""

import argparse
import math
import tempfile
import time
from collections import Counter
from collections.abc import Iterator, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any, NamedTuple

import hidden
import numpy as np
from hidden.motions import Track
from resumed import resumed, version

import knobcam as kc
from knobcam.learn.contenders import contenders
from knobcam.learn.designing import STANDARD, design
from knobcam.learn.motion_space import standard
from knobcam.learn.telling import TOLD, Rival, Telling

HERE = Path(__file__).parent
RESULTS = HERE / "results" / "next.jsonl"
TRUTHS = (
    *("presliding", "stribeck", "quadratic_drag", "load_friction", "friction_drift", "position_friction"),
    *("return_spring", "unbalance", "position_polynomial", "backlash", "compliance", "torque_lag"),
    *("directional_detent", "detent_harmonics", "cogging"),
)
WEAK = (0.1, 0.5)
JOINTS = ("backlash", "compliance")
BESIDE = (0.7, 3.0)
SIZED = 1.3
SMALLER = 0.1
SIZINGS = 8
SECONDS = 6.0
SHORTER = 1.5
STEPS = 6
# What the rig can do, wider than what a capture happened to reach.
RIG = kc.Limits(0.15, 12.0, 400.0, -3.0, 3.0)
CAP_S = 400.0
MOTIONS = 2
DRAWS = 5
SIZES = (1.0, 1.0 / 3.0)
ARMS = {"designed": "designed", "standard": "standard, as large as the limits"}


class Hiding(NamedTuple):
    """A knob with an effect in it, and with a joint where one is named."""

    truth: str
    seed: int
    twins: bool = False
    joint: str = ""

    def __str__(self) -> str:
        return f"{'+'.join(self.effects)}:{self.seed}{':twins' if self.twins else ''}"

    @property
    def effects(self) -> tuple[str, ...]:
        """All that is in it."""
        return (self.truth, self.joint) if self.joint else (self.truth,)

    def made(self) -> hidden.Hidden | None:
        """The knob, as weak as is drawn to within a third, or as its kind is at least; None where none is.

        Sizes go to a tenth of what the examination draws from: presliding over 1e-7 rad, which shows as
        little as is drawn, is over between two samples on any motion, and no knob has it.
        """
        motion = list(hidden.MOTIONS)[self.seed % len(hidden.MOTIONS)]
        if self.joint:
            try:
                return hidden.make(self.seed, self.effects, motion, BESIDE, duration_s=SECONDS)
            except ValueError:
                return None
        wanted = math.exp(np.random.default_rng([self.seed, TRUTHS.index(self.truth)]).uniform(*np.log(WEAK)))
        known: list[tuple[float, float]] = []
        least = SMALLER * hidden.KINDS[self.truth].sizes[0]
        size = math.sqrt(math.prod(hidden.KINDS[self.truth].sizes))
        for _ in range(SIZINGS):
            try:
                knob = hidden.make(self.seed, [self.truth], motion, size=size, duration_s=SECONDS)
            except ValueError:
                return None
            if 1.0 / SIZED < knob.strength / wanted < SIZED or (size == least and knob.strength > wanted):
                return knob
            known.append((math.log(size), math.log(knob.strength)))
            steep = 1.0
            if len(known) > 1:
                (a, u), (b, v) = known[-2:]
                steep = (v - u) / (b - a) if abs(b - a) > 1e-9 and abs(v - u) > 1e-3 else 1.0
            step = (math.log(wanted) - known[-1][1]) / steep
            size = max(size * math.exp(min(max(step, -2.0), 2.0)), least)
        return None


def examine(case: Hiding) -> Iterator[dict[str, Any]]:
    """What is expected of motions and what comes of them; a row without marks where there is no tie."""
    knob = case.made()
    if knob is None:
        return
    yield {"motion": knob.motion, "strength": knob.strength}
    with tempfile.TemporaryDirectory() as folder:
        for step in range(STEPS):
            seconds = SECONDS / SHORTER**step
            some = slice(round(seconds * len(knob.capture["tau_Nm"]) / SECONDS))
            first = read(folder, "first", {name: column[some] for name, column in knob.capture.items()})
            story = kc.learn(first, budget_s=60.0)
            rivals = contenders(story, ())
            row: dict[str, Any] = {"found": story.found, "rivals": [one.effects for one in rivals]}
            row["seconds"] = seconds
            tied = any(is_right(one, case.effects) for one in row["rivals"])
            if tied or not is_right(story.found, case.effects):
                break
        if not tied:
            yield row | {"tied": False}
            return
        row["tied"] = True
        if case.twins:
            yield row | {"limits": [twins(folder, case.effects, knob, story, rivals, size) for size in SIZES]}
            return
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
                if number == 0 and arm == "designed":
                    row["pairs"] = realised(rivals, case.effects, story, captures, track)
                now = kc.learn(captures, budget_s=60.0)
                left = contenders(now, ())
                row[f"ends_{arm}"] = [*row.get(f"ends_{arm}", ()), [now.found, len(left)]]
                if not left:
                    break
        yield row


def twins(
    folder: str,
    truth: tuple[str, ...],
    knob: hidden.Hidden,
    story: kc.LearningResult,
    rivals: tuple[Rival, ...],
    size: float,
) -> dict[str, Any]:
    """Whether rivals are said to be the same within limits, and what each motion there comes to.

    That is the least D of the right one's pairs, and whether `learn` then names it alone.
    """
    limits = within(kc.Limits.reached(story.fit.prepared), size)
    try:
        designed = design(rivals, limits)
    except kc.InputError:
        return {}
    tracks = [designed.track]
    tracks += [standard(name, limits, limits.sample_rate_hz) for name in STANDARD]
    least, alone = [], []

    def told(track: Any, draw: int) -> bool:
        again = read(folder, f"twin{size:.2g}{draw}", knob.again(track_of(track), draw))
        captures = [*story.captures, again]
        least.append(min(came for _, came in realised(rivals, truth, story, captures, track)))
        now = kc.learn(captures, budget_s=60.0)
        return is_right(now.found, truth) and not contenders(now, ())

    for number, track in enumerate(tracks):
        alone.append(told(track, 1 + number))
    # Of some that told it may have been luck: how often does each of them?
    some = 0 < 2 * sum(alone) <= len(alone)
    often = [
        sum([True, *(told(track, 10 * (1 + number) + draw) for draw in range(1, DRAWS))])
        for number, track in enumerate(tracks)
        if some and alone[number]
    ]
    change = None if designed.change is None else designed.change.limit
    said = {"declared": not designed.separable, "change": change, "took_s": designed.took_s}
    expected = min(one.d for one in designed.expected)
    return said | {"came": least[: len(tracks)], "named": alone, "often": often, "expected": expected}


def within(limits: kc.Limits, size: float) -> kc.Limits:
    """Limits a few times as narrow, about the same angle."""
    half = size * limits.half
    return replace(
        limits,
        theta_min_rad=limits.middle - half,
        theta_max_rad=limits.middle + half,
        omega_rad_s=size * limits.omega_rad_s,
        alpha_rad_s2=size * limits.alpha_rad_s2,
    )


def realised(
    rivals: tuple[Rival, ...],
    truth: tuple[str, ...],
    story: kc.LearningResult,
    captures: list[kc.Capture],
    track: Any,
) -> list[tuple[float, float]]:
    """Of the true rival beside each other one D as expected of a motion, and as it came."""
    told = Telling(rivals).refitted(track).d
    at = next(i for i, one in enumerate(rivals) if is_right(one.effects, truth))
    base = kc.fit(captures, story.ladder[0].fit.model)
    both = [Rival(one.effects, refitted(base, captures, one)) for one in rivals]
    others = [i for i in range(len(rivals)) if i != at]
    return [(float(told[at, i]), apart(both[at], both[i]) - apart(rivals[at], rivals[i])) for i in others]


def is_right(effects: Sequence[str], truth: Sequence[str]) -> bool:
    """Whether effects are all that is in a knob."""
    return sorted(effects) == sorted(truth)


def refitted(base: kc.Fit, captures: list[kc.Capture], rival: Rival) -> kc.Fit:
    """A rival's fit to captures: from where it was, or looked for anew beside the base if that is better.

    A period that one capture hardly told may have been a wrong one; what is looked for anew may be lost.
    """
    from_there = kc.fit(captures, rival.fit.model)
    try:
        for effect in rival.effects:
            base = base.add(effect)
    except kc.InputError:  # so little is left of it there that it cannot be followed
        return from_there
    return min(from_there, base, key=lambda one: one.rmse)


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
    kinds = Counter(kind for row in ties for kind in kinds_of(row))
    named = [row for row in rows if not row.get("tied") and row.get("found")]
    wrong = sum(not is_right(row["found"], truth_of(row["case"])) and len(row["rivals"]) < 2 for row in named)
    lines = [
        f"{time.strftime('%Y-%m-%d')}: python benches/study_next.py: {len(ties)} ties of "
        f"{len(kinds)} kinds of pairs, of {len(rows)} knobs; {wrong} others named wrongly, and not as tied",
        ", ".join(f"{kind} {count}" for kind, count in kinds.most_common()),
        "                                               | right % | wrong % | tied % ",
    ]
    for arm, words in ARMS.items():
        for motions in range(1, MOTIONS + 1):
            ends = [(row["case"], row[f"ends_{arm}"][:motions][-1]) for row in ties]
            lines.append(f"{motions} x 10 s, {words:37} | " + shares(ends))
    told = [(row["case"], row["ends_designed"][-1]) for row in ties if row["separable"]]
    lines.append(f"  {f'of {len(told)} that a motion should tell':45} | {shares(told)}")
    pairs = np.array([pair for row in ties for pair in row["pairs"]]).reshape(-1, 2)
    pairs = pairs[(pairs[:, 0] > TOLD) & (pairs[:, 1] > 0.0)]
    if len(pairs) > 2:
        ratio = np.log(pairs[:, 1] / pairs[:, 0])
        slope = np.polyfit(np.log(pairs[:, 0]), np.log(pairs[:, 1]), 1)[0]
        middle = ", ".join(f"{math.exp(float(np.quantile(ratio, q))):.2f}" for q in (0.25, 0.5, 0.75))
        lines.append(f"realised / expected D, designed: quartiles {middle}, slope of logarithms {slope:.2f}")
    beyond = sum(row["beyond"] for row in ties)
    took = np.quantile([row["took_s"] for row in ties] or [0.0], [0.5, 1.0])
    lines.append(
        f"torque of the true knob beyond the limit: {beyond} of {len(ties)}; "
        f"{took[0]:.1f} s a design, {took[1]:.1f} at most"
    )
    return "\n".join(lines)


def kinds_of(row: dict[str, Any]) -> set[str]:
    """The pairs of the truth and another that a knob left tied."""
    truth = truth_of(row["case"])
    others = {"+".join(other) or "none" for other in row["rivals"] if not is_right(other, truth)}
    return {"/".join(sorted(("+".join(truth), other))) for other in others}


def truth_of(case: str) -> list[str]:
    """What is in the knob of a case, by the case's name."""
    return case.split(":")[0].split("+")


def twins_table(rows: list[dict[str, Any]]) -> str:
    """How often rivals are rightly and wrongly said to be the same within limits."""
    asked = [one for row in rows for one in row.get("limits", ()) if one]
    lines = [f"{time.strftime('%Y-%m-%d')}: python benches/study_next.py --twins: {len(rows)} knobs"]
    for words, told in (
        ("learn names the right one alone", lambda one: any(one["named"])),
        ("a realised D of 10.8", lambda one: max(one["came"]) >= TOLD),
    ):
        same = [one["declared"] for one in asked if not told(one)]
        others = [one["declared"] for one in asked if told(one)]
        lines.append(
            f"said to be told by no motion: {sum(same)} of {len(same)} that none told, "
            f"{sum(others)} of {len(others)} others, where told is: {words}"
        )
    most = [one["declared"] for one in asked if 2 * sum(one["named"]) > len(one["named"])]
    lines.append(f"of {len(most)} that most motions told, by learn: {sum(most)}")
    for reliable in (False, True):
        some = [one["declared"] for one in asked if reliably(one) is reliable]
        words = "one motion told in most recordings of it" if reliable else "no motion told in most"
        lines.append(f"of {len(some)} of which {words}, by learn: {sum(some)}")
    took = max((one["took_s"] for one in asked), default=0.0)
    return "\n".join([*lines, f"{took:.1f} s a design at most"])


def reliably(asked: dict[str, Any]) -> bool:
    """Whether some motion tells in most of its recordings: of all motions most do, or one again and again."""
    most = 2 * sum(asked["named"]) > len(asked["named"])
    return most or any(2 * often > DRAWS for often in asked["often"])


def shares(ends: list[tuple[str, Any]]) -> str:
    """How many are settled rightly, wrongly, and not, as where nothing is named in the end, in per cent."""
    settled = [(is_right(found, truth_of(case)), found and left == 0) for case, (found, left) in ends]
    counts = [
        sum(bool(right and done) for right, done in settled),
        sum(bool(done and not right) for right, done in settled),
        sum(not done for _, done in settled),
    ]
    return " | ".join(f"{100.0 * count / max(len(settled), 1):7.0f}" for count in counts)


def main() -> None:
    """Examine, and print the table."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--knobs", type=int, default=900)
    parser.add_argument("--first", type=int, default=0)
    parser.add_argument("--jobs", type=int, default=2)
    parser.add_argument("--twins", action="store_true", help="the same ties, within narrow limits")
    parser.add_argument("--beside", default="", choices=JOINTS, help="a joint in each knob")
    parser.add_argument("--out", type=Path, default=RESULTS)
    args = parser.parse_args()
    each = math.ceil(args.knobs / len(TRUTHS))
    seeds = range(args.first, args.first + each)
    truths = [truth for truth in TRUTHS if not args.beside or truth not in JOINTS]
    cases = [Hiding(truth, seed, args.twins, args.beside) for seed in seeds for truth in truths]
    about = {"program": version(Path(kc.__file__).parent)}
    rows = resumed(examine, cases, args.out, about, args.jobs, CAP_S, {"tied": False, "why": "no answer"})
    print(twins_table(rows) if args.twins else table(rows))


if __name__ == "__main__":
    main()
