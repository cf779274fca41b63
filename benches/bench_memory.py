"""Time and peak memory of a fit over the length of the capture: both must grow linearly.

`python benches/bench_memory.py`. Each length runs in a process of its own, under repeated sweeps of the
paper's Equation 3; the peak is counted from before the fit, the capture itself not included.
"""

import json
import os
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path
from time import perf_counter
from typing import NamedTuple

import numpy as np
from knobs import PAPER_KNOB, model_of

import knobcam as kc

SAMPLES = (300_000, 3_000_000, 10_000_000)
METHODS = ("none", "smooth")
# What making the capture has freed must not serve the fit unseen: large blocks go back to the system (glibc).
RETURNING = os.environ | {"MALLOC_MMAP_THRESHOLD_": "100000"}


class Growth(NamedTuple):
    """A fit of `samples` samples: seconds, and bytes that it held at its peak beside the capture."""

    method: str
    samples: int
    seconds: float
    peak_bytes: int

    @property
    def cells(self) -> tuple[str, ...]:
        """What a table shows of it, in the order of HEAD."""
        return (
            self.method,
            f"{self.samples:,}",
            f"{self.seconds:.2f} s",
            f"{1e9 * self.seconds / self.samples:.0f} ns",
            f"{self.peak_bytes / 2**20:.0f} MB",
            f"{self.peak_bytes / self.samples:.0f} bytes",
        )


HEAD = ("prepare", "samples", "time", "time a sample", "peak beside the capture", "a sample")


def capture_of(samples: int) -> kc.Capture:
    """Table 2 of the paper, its motion repeated."""
    model = model_of(PAPER_KNOB)
    sweep = kc.motion("sweep")
    repeats = -(-samples // len(sweep.t))
    columns = [np.tile(column, repeats)[:samples] for column in sweep[1:]]
    track = kc.MotionTrack(np.arange(1, samples + 1) / 5000.0, *columns)
    return kc.simulate(model, track, noise="paper", seed=1)


def peak_bytes() -> int:
    """Peak resident memory since it was last cleared; `getrusage` would keep what the parent had."""
    status = Path("/proc/self/status").read_text("ascii")
    return 1024 * int(status.split("VmHWM:")[1].split()[0])


def child(method: str, samples: int) -> None:
    """Measure one fit in this process and print it."""
    capture = capture_of(samples)
    Path("/proc/self/clear_refs").write_text("5")  # Linux: peak memory counts from now
    before = peak_bytes()
    start = perf_counter()
    fit = kc.fit(capture, prepare=method)
    seconds = perf_counter() - start
    peak = peak_bytes() - before
    assert abs(fit.params["detent.P"].value - PAPER_KNOB["detent.P"]) < 5 * fit.params["detent.P"].se
    print(json.dumps([method, samples, seconds, peak]))


def growth() -> Iterator[Growth]:
    """All lengths by all methods, each in its own process."""
    for method in METHODS:
        for samples in SAMPLES:
            words = [sys.executable, __file__, method, str(samples)]
            printed = subprocess.run(words, check=True, capture_output=True, text=True, env=RETURNING).stdout
            yield Growth(*json.loads(printed))


if __name__ == "__main__":
    if sys.argv[1:]:
        child(sys.argv[1], int(sys.argv[2]))
    else:
        for g in growth():
            print(*g.cells, sep="  ", flush=True)
