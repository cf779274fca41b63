"""Is a parameter known better by a motion made for it? `python benches/study_sharpen.py [--knobs N]`.

Faultless knobs of the examination's simulator, recorded for 6 s on an ordinary motion. A motion is designed
that makes its widest parameter known best (or each of them in turn), and recorded on the same knob; beside
it the standard sweep, as long, at its own size and as large as the rig's limits let it be. What a recording
adds is the information 1/se^2 after it less that before it; the interval that it leaves alone is as wide as
one over its root. Beside it the most that any motion within the limits could bring (`sharpest.py`).
"""

import argparse
import tempfile
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any, NamedTuple

import hidden
import numpy as np
from resumed import resumed, version
from sharpest import sharpest
from study_next import CAP_S, RIG, read, track_of

import knobcam as kc
from knobcam.learn.motion_space import standard

HERE = Path(__file__).parent
RESULTS = HERE / "results" / "sharpen.jsonl"


class Case(NamedTuple):
    """A knob, and whether its parameters take turns or the widest is meant."""

    seed: int
    each: bool

    def __str__(self) -> str:
        return f"{'each' if self.each else 'widest'}:{self.seed}"


def examine(case: Case) -> Iterator[dict[str, Any]]:
    """How much narrower the designed motion's interval is, expected and found."""
    knob = hidden.make(case.seed, (), list(hidden.MOTIONS)[case.seed % len(hidden.MOTIONS)])
    yield {"motion": knob.motion}
    with tempfile.TemporaryDirectory() as folder:
        captures = [read(folder, "first", knob.capture)]
        story = kc.learn(captures[0])
        free, params = story.fit.core.free, story.fit.params
        widest = max(free, key=lambda name: params[name].se / max(abs(params[name].value), 1e-300))
        param = free[case.seed // len(hidden.MOTIONS) % len(free)] if case.each else widest
        designed = kc.next_experiment(story, sharpen=param, limits=RIG)
        tracks = {
            "designed": designed.track,
            "sweep": kc.motion("sweep", RIG.duration_s, RIG.sample_rate_hz),
            "wide": standard("sweep", RIG, RIG.sample_rate_hz),
        }
        before = story.fit.params[param].se ** -2
        row = {"param": param, "seconds": designed.seconds, "took_s": designed.took_s}
        row["expected"] = designed.sharpened[0].after
        row["most"] = (sharpest(story.fit, param, RIG) ** -2 - before) ** -0.5
        for name, track in tracks.items():
            second = read(folder, name, knob.again(track_of(track), 1))
            after = kc.fit([captures[0], second], story.fit.model).params[param]
            row[name] = (after.se**-2 - before) ** -0.5 if after.se**-2 > before else float("inf")
            row[f"{name}_se"] = after.se
            row[f"{name}_off"] = (after.value - knob.knob.get(param, float("nan"))) / after.se
        yield row


def table(rows: list[dict[str, Any]]) -> str:
    """How much narrower, in a few lines."""
    rows = [row for row in rows if "designed" in row]
    lines = [f"{time.strftime('%Y-%m-%d')}: python benches/study_sharpen.py: {len(rows)} knobs"]
    for name, words in (("sweep", "the standard sweep"), ("wide", "a sweep as large as the limits")):
        times = [row[name] / row["designed"] * np.sqrt(10.0 / row["seconds"]) for row in rows]
        low, middle, high = np.quantile(times, [0.25, 0.5, 0.75])
        lines.append(
            f"interval narrower than {words}'s, a second of recording: {middle:.2f} times "
            f"(quartiles {low:.2f}, {high:.2f})"
        )
    low, middle, high = np.quantile([row["sweep"] / row["most"] for row in rows], [0.25, 0.5, 0.75])
    lines.append(f"no motion brings more than {middle:.2f} times (quartiles {low:.2f}, {high:.2f})")
    off = np.array([row["designed_off"] for row in rows])
    held = np.mean(np.abs(off[np.isfinite(off)]) < 1.96)
    ratio = np.median([row["designed_se"] / row["expected"] for row in rows])
    lines.append(f"standard error found / expected {ratio:.2f}; intervals hold in {100.0 * held:.0f} %")
    for kind in sorted({row["param"] for row in rows}):
        some = [row for row in rows if row["param"] == kind]
        times, most = (np.median([row["sweep"] / row[one] for row in some]) for one in ("designed", "most"))
        lines.append(f"  {kind}: {times:.2f} times, of at most {most:.2f} ({len(some)})")
    return "\n".join(lines)


def main() -> None:
    """Examine, and print the table."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--knobs", type=int, default=50)
    parser.add_argument("--first", type=int, default=0)
    parser.add_argument("--each", action="store_true", help="the parameters in turn, not the widest")
    parser.add_argument("--jobs", type=int, default=2)
    parser.add_argument("--out", type=Path, default=RESULTS)
    args = parser.parse_args()
    about = {"program": version(Path(kc.__file__).parent)}
    cases = [Case(seed, args.each) for seed in range(args.first, args.first + args.knobs)]
    print(table(resumed(examine, cases, args.out, about, args.jobs, CAP_S, {})))


if __name__ == "__main__":
    main()
