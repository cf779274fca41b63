"""Do 95 % intervals of a motor's constants hold? `python benches/study_motors.py`.

Motors on a supply that sags, simulated without the core: a duty that stands from row to row, a driver that
lets go now and then, dry friction that holds, an encoder. kt/R is told by an inertia that is known.
"""

import argparse
import math
import tempfile
from pathlib import Path
from typing import Any

import numpy as np
from pooled import pooled

import knobcam as kc

SUBSTEPS_HZ, SECONDS, VOLTS, SAG_OHM, WINDING_OHM = 32_000.0, 12.0, 12.0, 0.3, 2.0
GROSS = 5.0  # times the noise floor: such a fit says itself that something is missing
FORMULA = ["t=t", "theta=pos [rad]", "tau=kt/R*(duty*supply-ke*omega*on)"]


def log(path: Path, seed: int) -> dict[str, float]:
    """Write the log of a motor; its true constants."""
    rng = np.random.default_rng(seed)

    def drawn(low: float, high: float) -> float:
        return float(np.exp(rng.uniform(np.log(low), np.log(high))))

    true = {"inertia.M": drawn(1e-4, 5e-4), "kt/R": drawn(0.008, 0.03), "ke": drawn(0.02, 0.06)}
    drag, dry = drawn(2e-5, 1e-4), drawn(0.002, 0.006)
    rate = float(rng.choice([250.0, 500.0]))
    steps, rows, h = int(SUBSTEPS_HZ / rate), int(SECONDS * rate), 1.0 / SUBSTEPS_HZ
    t = np.arange(rows) / rate
    tones, phases = rng.uniform([0.2, 0.6, 1.1, 2.2], [0.45, 0.9, 1.8, 3.5]), rng.uniform(0.0, 2.0 * np.pi, 4)
    duty = np.clip(np.sin(2.0 * np.pi * tones * t[:, None] + phases) @ [0.3, 0.2, 0.15, 0.1], -1.0, 1.0)
    period = rng.uniform(2.0, 4.0)
    on = (t % period) < 0.7 * period
    at = speed = 0.0
    position, supply = np.empty((2, rows))
    for row in range(rows):
        for step in range(steps):
            volts = VOLTS - SAG_OHM * duty[row] * (VOLTS * duty[row] - true["ke"] * speed) / WINDING_OHM
            if step == 0:
                position[row], supply[row] = at, volts
            given = true["kt/R"] * (duty[row] * volts - true["ke"] * speed) if on[row] else 0.0
            speed += h * (given - drag * speed) / true["inertia.M"]
            stopped = h * dry / true["inertia.M"]
            speed = 0.0 if abs(speed) <= stopped else speed - math.copysign(stopped, speed)
            at += h * speed
    count = 2.0 * np.pi / float(rng.choice([4096, 16384]))
    read = (duty + rng.uniform(0.002, 0.01) * rng.standard_normal(rows)) * on
    supply += rng.uniform(0.0, 0.05) * rng.standard_normal(rows)
    columns = np.column_stack([t, np.round(position / count) * count, read, supply, on])
    np.savetxt(path, columns, delimiter=",", header="t,pos,duty,supply,on", comments="")
    return true


def examine(seed: int) -> dict[str, Any]:
    """Errors of the constants, in standard errors and as shares."""
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "motor.csv"
        true = log(path, seed)
        known = {"inertia.M": true["inertia.M"]}
        fit = kc.fit_constants(path, map=FORMULA, free=["kt", "R", "ke"], known=known, detents="no")
    assert fit.constants is not None
    found = {
        name: ((e.value - true[name]) / e.se, e.value / true[name] - 1.0)
        for name, e in fit.constants.found.items()
    }
    return {"seed": seed, "gross": not fit.rmse <= GROSS * fit.noise_floor, "found": found}


def main() -> None:
    parser = argparse.ArgumentParser(description="Intervals of a motor's constants.")
    parser.add_argument("--seeds", type=int, default=60)
    parser.add_argument("--first", type=int, default=0)
    parser.add_argument("--jobs", type=int, default=2)
    options = parser.parse_args()
    seeds = list(range(options.first, options.first + options.seeds))
    rows = pooled(examine, seeds, options.jobs, "seed")
    print("motors                             |  n | kt/R holds %  off, % | ke holds %  off, %")
    for name, own in (
        ("all", rows),
        (f"error up to {GROSS:g} times the floor", [row for row in rows if not row["gross"]]),
    ):
        cells = []
        for constant in ("kt/R", "ke"):
            errors = np.array([row["found"][constant] for row in own if constant in row["found"]])
            holds, off = 100.0 * np.mean(np.abs(errors[:, 0]) < 1.96), 100.0 * np.median(errors[:, 1])
            cells.append(f"{holds:10.0f} {off:+8.2f}")
        print(f"{name:34} | {len(own):2} | {cells[0]} | {cells[1]}")


if __name__ == "__main__":
    main()
