"""The same work by each instruction set of this machine: `python benches/study_sets.py`.

A process of its own for each, since the environment (KNOBCAM_ISA) is read once; the least time of its thread
over many rounds.
"""

import json
import os
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path
from time import thread_time

RESULTS = Path(__file__).parent / "results" / "sets.json"
SETS = ("sse2", "avx2", "avx512")
ROUNDS = 60


def works() -> dict[str, Callable[[], object]]:
    """What is timed, by its name in the table of speed."""
    import bench_filter
    import bench_fit
    import bench_render

    channels = bench_filter.channels(25_000)
    found: dict[str, Callable[[], object]] = {
        "zero-phase filter, 4 x 25 000": lambda: bench_filter.ours(channels),
        "the paper's fit, 30 000 samples, no start": bench_fit.ours,
    }
    for knob, model in bench_render.knobs().items():
        found[f"render {bench_render.SAMPLES:,} samples of {knob}"] = bench_render.array_works(model)[0]
    found[f"presliding, torque and 12 derivatives, {bench_render.PRESLIDING:,}"] = (
        bench_render.presliding_works()[0]
    )
    return found


def least(work: Callable[[], object]) -> float:
    """Least time of this thread for the work, s."""
    best = float("inf")
    for _ in range(ROUNDS):
        start = thread_time()
        work()
        best = min(best, thread_time() - start)
    return best


def by_this() -> dict[str, float]:
    """Times of all work by the instruction set of this process, s."""
    return {name: least(work) for name, work in works().items()}


def report() -> list[str]:
    """A line for each work, ms by each set that this machine has."""
    times = {}
    for name in SETS:
        # One thread each, as for the speed table.
        environment = {**os.environ, "KNOBCAM_ISA": name, "OPENBLAS_NUM_THREADS": "1"}
        command = [sys.executable, __file__, "--this"]
        own = subprocess.run(command, capture_output=True, text=True, env=environment)
        if own.returncode == 0:
            times[name] = json.loads(own.stdout)
    lines = [f"{'ms':52}" + "".join(f"{name:>9}" for name in times)]
    for work in times[SETS[0]]:
        lines.append(f"{work:52}" + "".join(f"{1e3 * own[work]:9.3f}" for own in times.values()))
    return [*lines, f"load of the machine when it was measured: {os.getloadavg()[0]:.1f}"]


def main() -> None:
    if "--this" in sys.argv:
        print(json.dumps(by_this()))
        return
    lines = report()
    print("\n".join(lines))
    RESULTS.write_text(json.dumps({"report": lines}, indent=1) + "\n", "utf-8")


if __name__ == "__main__":
    main()
