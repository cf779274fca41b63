"""Are p-values uniform where nothing is missing? `python benches/study_chance.py`.

Faultless short knobs (1.6 s at 5 kHz) under white and under AR(1) 0.9 noise of the torque; of each the
smallest p-value of the catalogue, which is that of the whole search, held against the uniform distribution
(Kolmogorov 1933, Smirnov 1948), with all effects and without `saturation`, and whether anything was named.
Rows are kept in `benches/results/chance.jsonl`, so that a run goes on where the last one stopped.
"""

import argparse
import dataclasses
import json
import time
from pathlib import Path
from typing import Any

import numpy as np
from resumed import kept, version
from scipy.signal import lfilter
from scipy.stats import kstest

import knobcam as kc

HERE = Path(__file__).parent
KEPT = HERE / "results" / "chance.jsonl"
TABLE = KEPT.with_suffix(".json")
MOTIONS = ("sweep", "multisine", "turns", "hand")
KEEP = {"white": 0.0, "ar1": 0.9}
SECONDS = 1.6
FIRST = 7000  # seed


def faultless(at: int, noise: str) -> kc.Capture:
    """One of the paper's knobs, with nothing hidden in it."""
    knob, motion = f"knob{1 + at % 5}", MOTIONS[at % len(MOTIONS)]
    capture = kc.simulate(knob, motion, seed=FIRST + at, duration_s=SECONDS)
    if not KEEP[noise]:
        return capture
    silent = kc.simulate(knob, motion, seed=FIRST + at, duration_s=SECONDS, noise="none")
    keep, sd = KEEP[noise], float(np.std(capture.tau - silent.tau))
    white = np.random.default_rng(FIRST + at).normal(0.0, sd, len(capture.tau) + 500)
    coloured = lfilter([np.sqrt(1.0 - keep**2)], [1.0, -keep], white)[500:]
    return dataclasses.replace(capture, tau=silent.tau + coloured)


def weighed(at: int, noise: str) -> dict[str, Any]:
    """What is said of a knob."""
    fit = kc.fit(faultless(at, noise))
    diagnosis = fit.diagnose()
    return {
        "case": f"{noise}:{at}",
        "noise": noise,
        "p": {one.effect: one.p_value for one in diagnosis.candidates},
        "named": diagnosis.best.effect if diagnosis.best else None,
    }


def report(rows: list[dict[str, Any]]) -> list[str]:
    """A line for each noise, with and without the effect that reads its limit off the noise."""
    lines = []
    for noise in KEEP:
        some = [row for row in rows if row["noise"] == noise]
        if not some:
            continue
        named = [row["named"] for row in some if row["named"]]
        lines.append(f"{noise}: {len(some)} knobs, {len(named)} accused {' '.join(sorted(named))}")
        for left_out in ((), ("saturation",)):
            p = np.array([min(v for k, v in row["p"].items() if k not in left_out) for row in some])
            test = kstest(p, "uniform")
            without = f" without {' '.join(left_out)}" if left_out else ""
            lines.append(
                f"  smallest p{without}: KS distance {test.statistic:.2f} (p {test.pvalue:.1g}), "
                f"{100 * np.mean(p <= 0.05):.0f} % below 0.05, {100 * np.mean(p <= 0.5):.0f} % below 0.5"
            )
    return lines


def main() -> None:
    parser = argparse.ArgumentParser(description="P-values where nothing is missing.")
    parser.add_argument("--knobs", type=int, default=100, help="of each noise")
    options = parser.parse_args()
    about = {"version": version(HERE.parent / "python" / "knobcam")}
    known = {row["case"] for row in kept(KEPT, about)}
    with KEPT.open("a", encoding="utf-8") as file:
        for at in range(options.knobs):
            for noise in KEEP:
                if f"{noise}:{at}" not in known:
                    file.write(json.dumps(about | weighed(at, noise)) + "\n")
                    file.flush()
    rows = kept(KEPT, about)
    today = time.strftime("%Y-%m-%d", time.gmtime())
    lines = [f"{today}: python benches/study_chance.py, program {about['version']}", *report(rows)]
    TABLE.write_text(json.dumps(lines, indent=0) + "\n", "utf-8")
    print(*lines, sep="\n")


if __name__ == "__main__":
    main()
