"""What a recorder loses: in minutes at 5 kHz beside a thread that holds the GIL, and when it is killed.

`python benches/study_capture.py` takes 12 minutes and writes benches/results/capture.json.
"""

import argparse
import json
import random
import subprocess
import sys
import tempfile
import threading
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import knobcam as kc
from knobcam.rig.emulator import EmulatedRig

RESULT = Path(__file__).with_name("results") / "capture.json"
RATE_HZ = 5000.0
LONGEST_FRAME = 1030
NUMBERS = 1_000_000
"""Random numbers that are sorted in one call, which holds the GIL for half a second or so."""


def recorder_seconds() -> float:
    """Processor time of the recorder's thread so far, s."""
    tasks = Path("/proc/self/task").iterdir()
    ours = [task for task in tasks if (task / "comm").read_text().startswith("knobcam-record")]
    return 1e-9 * sum(int((task / "schedstat").read_text().split()[0]) for task in ours)


def soak(minutes: float, folder: Path) -> dict[str, Any]:
    """Record at 5 kHz in real time through pyserial and a pseudo-terminal, while the GIL is held."""
    numbers, stop, held = [random.random() for _ in range(NUMBERS)], threading.Event(), []
    used = [0.0]

    def hog() -> None:
        while not stop.is_set():
            start = time.perf_counter()
            sorted(numbers)
            held.append(time.perf_counter() - start)

    def watch(figures: object) -> None:
        used[0] = recorder_seconds()

    thread = threading.Thread(target=hog)
    with EmulatedRig(noise=False) as rig, kc.Link(rig.port) as link:
        thread.start()
        start = time.perf_counter()
        try:
            capture = kc.record(
                link, "hand", duration_s=60.0 * minutes, output=folder / "soak.kcwire", progress=watch
            )
        finally:
            seconds = time.perf_counter() - start
            stop.set()
            thread.join()
    account = capture.meta["account"]
    return {
        "minutes": minutes,
        "rate_hz": RATE_HZ,
        "samples": account["produced"],
        "lost_on_the_way": account["lost_on_the_way"],
        "dropped_on_device": account["dropped_on_device"],
        "share_of_a_core": round(used[0] / seconds, 5),
        "longest_call_that_held_the_gil_s": round(max(held), 3),
        "calls_that_held_the_gil": len(held),
    }


def killed(rig: EmulatedRig, log: Path, moment_s: float) -> dict[str, Any]:
    """Kill a recorder so long after its log has appeared, and say what is in it."""
    words = [sys.executable, "-m", "knobcam", "capture", "--port", rig.port, "--motion", "hand"]
    with subprocess.Popen(
        [*words, "--duration", "600", "-o", str(log)], stderr=subprocess.DEVNULL
    ) as recorder:
        while not log.exists() and recorder.poll() is None:
            time.sleep(0.001)
        time.sleep(moment_s)
        recorder.kill()
    read = kc.WireLog.load(log)
    exports = [log.with_suffix(f".{name}.npz") for name in "ab"]
    alike = True
    if read.samples > 1:
        for path in exports:
            kc.load(log).save(path)
        alike = exports[0].read_bytes() == exports[1].read_bytes()
    return {
        "moment_s": round(moment_s, 4),
        "samples": read.samples,
        "missing": sum(run["account"]["missing"] for run in read.runs),
        "corrupt_frames": read.counts["corrupt"],
        "bytes_of_a_cut_frame": read.counts["pending"],
        "exports_alike": alike,
    }


def kills(count: int, folder: Path) -> dict[str, Any]:
    """Kill recorders at random moments."""
    rng = random.Random(1)
    with EmulatedRig() as rig:
        rows = [killed(rig, folder / f"{at}.kcwire", rng.uniform(0.0, 1.0)) for at in range(count)]
    return {
        "kills": count,
        "logs_opened": len(rows),
        "with_samples": sum(row["samples"] > 0 for row in rows),
        "most_frames_lost": max(row["corrupt_frames"] + (row["bytes_of_a_cut_frame"] > 0) for row in rows),
        "samples_missing_before_the_cut": sum(row["missing"] for row in rows),
        "exports_alike": all(row["exports_alike"] for row in rows),
        "moments_s": [row["moment_s"] for row in rows],
        "samples": [row["samples"] for row in rows],
    }


def report(result: dict[str, Any]) -> Iterator[str]:
    """What came out, in lines."""
    soak, kills = result["soak"], result["kills"]
    yield (
        f"{soak['minutes']:g} minutes at {soak['rate_hz']:.0f} Hz: {soak['samples']} samples, "
        f"{soak['lost_on_the_way']} lost on the way, {soak['dropped_on_device']} dropped on the device"
    )
    yield (
        f"recorder's thread: {100 * soak['share_of_a_core']:.2f} % of a core, beside "
        f"{soak['calls_that_held_the_gil']} calls that held the GIL for up to "
        f"{soak['longest_call_that_held_the_gil_s']:.2f} s"
    )
    yield (
        f"{kills['kills']} recorders killed: {kills['logs_opened']} logs open, {kills['with_samples']} with "
        f"samples, at most {kills['most_frames_lost']} frame lost, "
        f"{kills['samples_missing_before_the_cut']} samples missing before it, exports "
        + ("byte-identical" if kills["exports_alike"] else "DIFFERENT")
    )


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--minutes", type=float, default=10.0)
    parser.add_argument("--kills", type=int, default=100)
    args = parser.parse_args()
    with tempfile.TemporaryDirectory(prefix="knobcam-soak-") as folder:
        result = {"soak": soak(args.minutes, Path(folder)), "kills": kills(args.kills, Path(folder))}
    lines = list(report(result))
    RESULT.write_text(json.dumps({"report": lines, **result}) + "\n")
    print(*lines, sep="\n")


if __name__ == "__main__":
    main()
