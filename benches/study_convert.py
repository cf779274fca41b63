"""Converted models: how exact the exact class is, how well errors are foretold, and what a step costs in C.

`python benches/study_convert.py [--library FILE]` prints all of it, the steps of C with the library of the
package or another, such as `target/release/libknobstep.a`.
"""

from __future__ import annotations

import argparse
import subprocess
import tempfile
from itertools import product
from pathlib import Path
from time import process_time

import numpy as np

import knobcam as kc
from knobcam.render.convert import TARGETS, convert, library

MOTIONS = ("sweep", "turns", "hand")
HIDDEN = ("backlash", "compliance", "stribeck", "quadratic_drag", "detent_harmonics", "second_detent")
HIDDEN += ("position_polynomial", "return_spring", "unbalance", "end_stop", "load_friction")
STEPS, ROUNDS = 29_000, 15

MAIN = """\
#include <stdio.h>
#include <stdlib.h>
#include <time.h>
#include "knob.h"
static double rows[%(steps)d][3];
int main(void) {
    double sum = 0.0, best = 1e9;
    struct timespec start, end;
    knobcam_knob *knob = knob_new(0, NULL, 0);
    if (knob == NULL || fread(rows, sizeof rows, 1, stdin) != 1) return 1;
    for (int round = 0; round < %(rounds)d; round++) {
        knobcam_reset(knob);
        clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &start);
        for (int i = 0; i < %(steps)d; i++) sum += knobcam_step(knob, rows[i][0], rows[i][1], rows[i][2]);
        clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &end);
        double took = (end.tv_sec - start.tv_sec) * 1e9 + (end.tv_nsec - start.tv_nsec);
        if (took < best) best = took;
    }
    printf("%%.17g %%g\\n", best / %(steps)d, sum);
    return knobcam_fault(knob);
}
"""


def models() -> dict[str, kc.Model]:
    """The five knobs, and others with something hidden in them."""
    found = {name: kc.Model.load(name) for name in kc.KNOBS}
    return found | {name: kc.hiding("knob4", name) for name in HIDDEN}


def errors() -> None:
    """Print the worst of each form: the error of what is exact, and the ratio of foretold to measured."""
    exact: dict[str, float] = {}
    foretold: dict[str, list[float]] = {}
    whole: dict[str, list[float]] = {}
    for (name, model), motion, target in product(models().items(), MOTIONS, TARGETS):
        try:
            made = convert(model, target, without=["impossible"], motion=motion, kt=0.05)
        except kc.InputError:  # nothing of it is possible there
            continue
        error = made.measured_error
        if error is None:
            raise SystemExit(f"{name} in {target} was not measured: {made.measured.why_not}")
        if any(fate.left_out and fate.error > 0.0 for fate in made.fates):
            whole.setdefault(target, []).append(made.predicted_whole_error / made.measured_whole_error)
        if any(fate.kind == "approximate" for fate in made.fates):
            foretold.setdefault(target, []).append(made.predicted_error / error)
        else:
            exact[target] = max(exact.get(target, 0.0), error / made.measured.torque)
    for target, worst in exact.items():
        print(f"{target}: what is exact is off by {100.0 * worst:.2g} % of the torque RMS at most (0.1 %)")
    for target, ratios in foretold.items():
        span = f"{min(ratios):.3f} to {max(ratios):.3f}"
        print(f"{target}: foretold / measured {span}, {len(ratios)} cases (0.9 to 1.1)")
    for target, ratios in whole.items():
        span = f"{min(ratios):.3f} to {max(ratios):.3f}"
        print(f"{target}: with what is left out {span}, {len(ratios)} cases (0.9 to 1.1)")


def steps(archive: str) -> None:
    """Print the time of a step in C beside that of `Renderer` in Python, alone and in packs."""
    track = kc.motion("sweep")
    motion = [np.ascontiguousarray(column[:STEPS]) for column in (track.theta, track.omega, track.alpha)]
    rows = np.stack(motion, axis=1)
    for name in ("knob1", "knob4"):
        with tempfile.TemporaryDirectory() as folder:
            convert(name, "c").save(Path(folder) / "knob.h")
            (Path(folder) / "main.c").write_text(MAIN % {"steps": STEPS, "rounds": ROUNDS})
            words = ["gcc", "-O2", "-D_POSIX_C_SOURCE=200809L", "main.c", archive]
            subprocess.run([*words, "-o", "main"], cwd=folder, check=True)
            ran = subprocess.run(
                [Path(folder) / "main"], input=rows.tobytes(), capture_output=True, check=True
            )
        in_c = float(ran.stdout.split()[0])
        knob = kc.Renderer(name)
        packs, single = [], []
        for _ in range(ROUNDS):
            knob.reset()
            start = process_time()
            knob.along(*motion)
            packs.append(process_time() - start)
        listed = rows.tolist()
        for _ in range(3):
            knob.reset()
            start = process_time()
            for theta, omega, alpha in listed:
                knob.step(theta, omega, alpha)
            single.append(process_time() - start)
        whole, one = (1e9 * min(times) / STEPS for times in (packs, single))
        print(
            f"{name}: a step in C {in_c:.1f} ns (50 ns), Renderer.step from Python {one:.0f} ns "
            f"({one / in_c:.1f} times), Renderer.along {whole:.1f} ns a sample, in packs"
        )


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--library", default=str(library.static() or library.shared()))
    arguments = parser.parse_args()
    steps(str(Path(arguments.library).resolve()))
    errors()
