"""The noise floor where a motion is made again: `python benches/study_repeats.py`.

Faultless knobs of the second simulator, the same motion several times, as short captures whose spectrum does
not tell slow noise and as one capture that repeats itself; the torque's noise is white or AR(1). The floor is
held against the very noise, and a verdict against "complete".
"""

import argparse
import time
from typing import Any

import numpy as np
from hidden import make
from hidden.motions import MOTIONS, Track
from hidden.sensors import EDGE, RATE_HZ, filtered, measured
from pooled import pooled

import knobcam as kc

# Motion, what the noise keeps from row to row, repeats and their seconds, and whether they are one capture.
CASES = (
    ("turns", 0.97, 5, 0.5, False),
    ("hand", 0.9, 6, 0.5, False),
    ("chirp", 0.0, 4, 0.5, False),
    ("periodic", 0.97, 4, 0.5, True),
    ("periodic", 0.9, 10, 1.0, True),
)
SINES = 8


def track(motion: str, seed: int, seconds: float, times: int) -> Track:
    """The motion of one capture."""
    rng = np.random.default_rng([seed, 99])
    if motion != "periodic":
        return MOTIONS[motion](rng, np.arange(round(seconds * RATE_HZ)) / RATE_HZ)
    t = np.arange(round(times * seconds * RATE_HZ)) / RATE_HZ
    orders = np.arange(1, SINES + 1)
    w, phases = 2.0 * np.pi * orders / seconds, rng.uniform(0.0, 2.0 * np.pi, SINES)
    sin, cos = (of(np.outer(t, w) + phases) / orders for of in (np.sin, np.cos))
    theta, omega, alpha = sin.sum(1), (w * cos).sum(1), -(w**2 * sin).sum(1)
    by = 0.9 / np.abs(theta).max()
    return Track(t, by * theta, by * omega, by * alpha)


def examine(job: tuple[int, int, bool]) -> dict[str, Any]:
    """Floor over truth, and what is said of a knob of which nothing is missing."""
    seed, case, learned = job
    motion, keep, times, seconds, one = CASES[case]
    knob = make(seed)
    assert knob.chain is not None
    captures, squares = [], []
    for again in range(1 if one else times):
        made = track(motion, seed, seconds, times)
        tau, limit = knob.chain.torque(made)
        columns = measured(np.random.default_rng([seed, again, 5]), made, tau, limit, keep)
        squares.append(np.mean(filtered(columns["tau_Nm"] - tau)[EDGE:-EDGE] ** 2))
        captures.append(kc.Capture.from_arrays(**{name.partition("_")[0]: x for name, x in columns.items()}))
    true = float(np.sqrt(np.mean(squares)))
    start = time.process_time()
    story = kc.learn(captures) if learned else None
    fit = story.fit if story else kc.fit(captures)
    return {
        "case": case,
        "seed": seed,
        "floor": fit.noise_floor / true,
        "verdict": story.verdict if story else "",
        "found": list(story.found) if story else [],
        "seconds": time.process_time() - start,
    }


def main() -> None:
    parser = argparse.ArgumentParser(description="Noise floors by repeats.")
    parser.add_argument("--seeds", type=int, default=20)
    parser.add_argument("--first", type=int, default=9000)
    parser.add_argument("--jobs", type=int, default=2)
    parser.add_argument("--fit", action="store_true", help="floors alone, no verdict")
    options = parser.parse_args()
    seeds = range(options.first, options.first + options.seeds)
    jobs = [(seed, case, not options.fit) for case in range(len(CASES)) for seed in seeds]
    rows = pooled(examine, jobs, options.jobs, "seed")
    head = "floor: least median  most  within 5 %  unknown | accused  unexplained"
    print(f"{'motion, AR(1), times x s':27} |  n | {head}")
    for case, (motion, keep, times, seconds, one) in enumerate(CASES):
        own = [row for row in rows if row["case"] == case]
        floors = np.array([row["floor"] for row in own])
        known = floors[np.isfinite(floors)]
        least, median, most = np.quantile(known, [0.0, 0.5, 1.0]) if len(known) else [np.nan] * 3
        near = np.sum(np.abs(known - 1.0) <= 0.05)
        accused = sum(bool(row["found"]) for row in own)
        silent = sum(row["verdict"] == "unexplained" and not row["found"] for row in own)
        name = f"{motion} {keep:g} {times} x {seconds:g}{', one' if one else ''}"
        told = f"{least:12.3f} {median:6.3f} {most:5.3f} {near:11} {len(own) - len(known):8}"
        print(f"{name:27} | {len(own):2} | {told} | {accused:7} {silent:12}")


if __name__ == "__main__":
    main()
