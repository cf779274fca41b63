"""What is done to files and calls, what must hold, and how often it did: one table.

    python benches/study_faults.py [--moments 50] [--sequences 200] [--stalls 5000] [--seed N] [--only NAME]

Writers killed at random moments, disks that fill at random sizes, commands that are ended, inputs of up to
100 MB that are as bad as can be, wrong values for every parameter, random commands to the page, sessions
that are cut, connections that stall, clocks that jump, at the page and at a rig. Writes
benches/results/faults.json, which has the seeds; what was counted before is kept where `--only` leaves it out
(`page`: all that is done to the page). Without `--only` it runs `study_mutated.py` and `study_safety.py` too,
which count the spoiled files and the limits of the rig; they stand in the same table.
"""

from __future__ import annotations

import argparse
import hashlib
import json
import os
import random
import resource
import signal
import subprocess
import sys
import tempfile
import time
from collections import Counter
from collections.abc import Callable
from pathlib import Path
from typing import Any

import faults_page
import faults_rig
import hostile
import wrong_calls

import knobcam as kc
from knobcam.base.writing import together, write
from knobcam.rig.calibration import Calibration
from knobcam.workbench import kept
from knobcam.workbench.journal import Journal, Record
from knobcam.workbench.tree import Start

RESULTS = Path(__file__).parent / "results" / "faults.json"
CAPTURES = ("a.npz", "a.csv", "a.csv.gz", "a.parquet", "a.mat", "a.h5")
WRITERS = (*CAPTURES, "model.toml", "calibration.toml", "picture.png", "page.html", "pair", "journal")
_LONGEST_S, _MOST_MB = 30.0, 1000
_COMMANDS = 100
_PAGE = {
    "commands to the page": "a document, or one line, within 30 s; never 500",
    "clocks that jump": "the same, by up to ten years either way",
    "sessions that go on": "the same to the last bit, or without the last action",
    "connections that stall": "gone within 30 s, others answered meanwhile",
}
_SIGNALS = {signal.SIGINT: 130, signal.SIGTERM: 143, signal.SIGHUP: 129}


def saver(name: str, folder: Path) -> Callable[[int], None]:
    """Return what writes one of two contents, 0 or 1, to `name` in a folder."""
    path = folder / name
    if name in CAPTURES:
        captures = [kc.simulate("knob3", duration_s=1.0, seed=seed) for seed in (0, 1)]
        return lambda which: captures[which].save(path) and None
    if name == "model.toml":
        models = [kc.Model.load("knob3"), kc.Model.load("knob4")]
        return lambda which: models[which].save(path) and None
    if name == "calibration.toml":
        tested = [Calibration("KNOB-1", f"2026-11-2{day}", c_cal_runs=(100.0 + day,) * 500) for day in (3, 4)]
        return lambda which: tested[which].save(path) and None
    if name == "journal":
        lines = [[kept.begun(Start(None, f"{which}" * 100_000))] for which in (0, 1)]
        return lambda which: rewritten(folder, lines[which])
    if name == "picture.png":
        effects = [kc.effects()[one] for one in ("coulomb", "detent")]
        return lambda which: effects[which].plot().savefig(path)
    pages = ["old " * 500_000, "new " * 700_000]
    if name == "page.html":
        return lambda which: write(path, pages[which]) and None

    def pair(which: int) -> None:
        with together():
            write(folder / "pair", pages[which])
            write(folder / "pair-2", pages[which])

    return pair


def rewritten(folder: Path, lines: list[Record]) -> None:
    """Write the journal of a session anew."""
    with Journal.taken(folder) as journal:
        journal.rewrite(lines)


def forked(work: Callable[[], object]) -> int:
    """Run something in a copy of this process and return the copy's id."""
    pid = os.fork()
    if pid == 0:
        try:
            work()
            os._exit(0)
        except kc.InputError:
            os._exit(2)
        except BaseException:
            os._exit(1)
    return pid


def ended(pid: int) -> int:
    """Wait for the end of a copy and return its exit code."""
    return os.waitstatus_to_exitcode(os.waitpid(pid, 0)[1])


def digest(path: Path) -> str:
    return hashlib.sha256(path.read_bytes()).hexdigest()


def prepared(name: str, folder: Path) -> tuple[Callable[[int], None], list[str], float]:
    """Return the writer, the digests of its two files, and how long it takes; the first of them is there."""
    save = saver(name, folder)
    known = []
    for which in (1, 0):
        began = time.monotonic()
        assert ended(forked(lambda: save(which))) == 0, name  # noqa: B023 - it is done before the next
        taken = time.monotonic() - began
        known.append(digest(folder / name))
    return save, known, taken


def killed(name: str, moments: int, seed: int, folder: Path) -> dict[str, int]:
    """Kill a writer at random moments; return how often the old file or the new was there, whole."""
    rng, found = random.Random(f"{seed} {name}"), Counter[str]()
    save, known, taken = prepared(name, folder)

    def work() -> None:
        for turn in range(10**9):
            save(turn % 2)

    for _ in range(moments):
        pid = forked(work)
        time.sleep(rng.uniform(0.0, 3.0 * taken))
        os.kill(pid, signal.SIGKILL)
        ended(pid)
        found["old or new" if digest(folder / name) in known else "damaged"] += 1
        for part in folder.glob(".knobcam-*.part"):  # nobody can tidy up after SIGKILL
            part.unlink()
    return dict(found)


def filled(name: str, moments: int, seed: int, folder: Path) -> dict[str, int]:
    """Let the disk fill at random sizes: the old file stays, one line says why, nothing is left."""
    rng, found = random.Random(f"{seed} {name}"), Counter[str]()
    save, _, _ = prepared(name, folder)
    before, size = digest(folder / name), (folder / name).stat().st_size
    there = sorted(folder.iterdir())

    def work(limit: int) -> None:
        resource.setrlimit(resource.RLIMIT_FSIZE, (limit, limit))
        save(1)

    for _ in range(moments):
        limit = rng.randrange(int(0.9 * size))
        code = ended(forked(lambda: work(limit)))  # noqa: B023 - it is done before the next
        well = (code, digest(folder / name), sorted(folder.iterdir())) == (2, before, there)
        found["old, and one line" if well else f"exit code {code}"] += 1
    return dict(found)


def stopped(number: signal.Signals, moments: int, seed: int, folder: Path) -> dict[str, int]:
    """End a command at random moments: the old file or the new, no temporary, the exit code of a shell."""
    rng, found = random.Random(f"{seed} {number}"), Counter[str]()
    save, known, _ = prepared("a.csv", folder)
    words = [
        sys.executable,
        "-m",
        "knobcam",
        "simulate",
        "knob3",
        "--duration",
        "1",
        "-o",
        str(folder / "a.csv"),
    ]
    for _ in range(moments):
        save(1)
        child = subprocess.Popen(words, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True)
        time.sleep(rng.uniform(0.1, 1.2))
        child.send_signal(number)
        _, said = child.communicate()
        # Before its first line runs, Python ends as the system has it.
        well = child.returncode in (0, _SIGNALS[number], -number) and "Traceback" not in said
        well = (
            well
            and digest(folder / "a.csv") in known
            and sorted(p.name for p in folder.iterdir()) == ["a.csv"]
        )
        found["as it should" if well or child.returncode == -number else f"exit code {child.returncode}"] += 1
    return dict(found)


_READ = """
import re, sys, time
import knobcam as kc
began = time.monotonic()
try:
    said, failed = f"capture of {kc.load(sys.argv[1]).samples}", 0
except kc.InputError as error:
    said, failed = str(error), 0
except BaseException as error:
    said, failed = repr(error), 1
# What the process that started this one had held is not counted here, as it is in ru_maxrss.
peak = int(re.search(r"VmHWM:\\s+(\\d+)", open("/proc/self/status").read())[1]) // 1024
print(failed, peak, round(time.monotonic() - began, 1), said.replace(chr(10), " "))
"""


def read(name: str, folder: Path) -> dict[str, Any]:
    """Read an input that is as bad as can be, in a process of its own: what was said, memory and time."""
    path = folder / name
    hostile.INPUTS[name](path)
    size = path.stat().st_size
    words = [sys.executable, "-c", _READ, str(path)]
    try:
        ran = subprocess.run(words, capture_output=True, text=True, timeout=10 * _LONGEST_S, check=False)
        failed, peak, seconds, said = ran.stdout.split(" ", 3)
    except (subprocess.TimeoutExpired, ValueError):
        failed, peak, seconds, said = "1", "0", "inf", "did not end"
    path.unlink()
    well = failed == "0" and int(peak) <= _MOST_MB
    figures = {"mb": round(size / 1e6, 1), "peak_mb": int(peak), "seconds": float(seconds), "well": well}
    return figures | {"said": said.strip().replace(str(folder), "")[:120]}


def studied(moments: int, sequences: int, stalls: int, seed: int, only: str | None) -> dict[str, Any]:
    """Return the rows of the table: what was done, cases, and those in which it did not hold."""
    rows: dict[str, Any] = {}

    def row(name: str, must: str, count: Callable[[], tuple[int, int, Any]]) -> None:
        if only is None or only in name or (only == "page" and name in _PAGE):
            cases, failed, seen = count()
            rows[name] = {"must": must, "cases": cases, "failed": failed, "seen": seen}
            print(f"{name}: {cases} cases, {failed} failed", flush=True)

    def of(found: dict[str, dict[str, int]], well: str) -> tuple[int, int, Any]:
        cases = sum(sum(counts.values()) for counts in found.values())
        return cases, cases - sum(counts.get(well, 0) for counts in found.values()), found

    def each(study: Callable[[str, int, int, Path], dict[str, int]], well: str) -> tuple[int, int, Any]:
        found = {}
        for name in WRITERS:
            with tempfile.TemporaryDirectory() as scratch:
                found[name] = study(name, moments, seed, Path(scratch))
        return of(found, well)

    def signals() -> tuple[int, int, Any]:
        found = {}
        for number in _SIGNALS:
            with tempfile.TemporaryDirectory() as scratch:
                found[number.name] = stopped(number, moments, seed, Path(scratch))
        return of(found, "as it should")

    def inputs() -> tuple[int, int, Any]:
        with tempfile.TemporaryDirectory() as scratch:
            found = {name: read(name, Path(scratch)) for name in hostile.INPUTS}
        return len(found), sum(not one["well"] for one in found.values()), found

    def wrong() -> tuple[int, int, Any]:
        found = list(wrong_calls.every())
        failed = [f"{what}: {why}" for what, why in found if why is not None]
        return len(found), len(failed), failed

    def clocks() -> tuple[int, int, Any]:
        found, failures = faults_rig.played(seed, 5 * sequences, 25 * sequences)
        return found.total(), found["failed"], failures

    row("writers killed", "the old file or the new, whole", lambda: each(killed, "old or new"))
    row("disks that fill", "the old file, one line, nothing left", lambda: each(filled, "old, and one line"))
    row("commands ended", "no temporary, exit code 130, 143, 129", signals)
    row("inputs of 100 MB", f"an answer or one line, at most {_MOST_MB} MB of memory", inputs)
    row("wrong values", "taken, or one line", wrong)
    row("clocks that jump at a rig", "a capture or one line; no torque, the log opens", clocks)
    page = dict.fromkeys(_PAGE, (0, 0, None))
    if only in (None, "page") or any(only in name for name in page):
        found, failures = faults_page.played(seed, sequences, _COMMANDS, stalls)
        page = {name: (counts.total(), counts["failed"], []) for name, counts in found.items()}
        page["commands to the page"][2].extend(failures)
        print(*failures, sep="\n")
    for name, must in _PAGE.items():
        row(name, must, lambda: page[name])  # noqa: B023 - it is called at once
    return rows


def elsewhere() -> dict[str, dict[str, Any]]:
    """Return the rows that other studies count."""
    rows = {}
    files, limits = (RESULTS.with_name(f"{name}.json") for name in ("mutated", "safety"))
    if files.exists():
        found = json.loads(files.read_text())
        must = "what it holds, or one line; 30 s, 2 GB"
        rows["spoiled files"] = {"must": must, "cases": found["files"], "failed": found["failed"]}
    if limits.exists():
        found = json.loads(limits.read_text())["sequences"]
        must = "torque, speed and energy within their limits"
        rows["commands to a rig"] = {
            "must": must,
            "cases": found["sequences"],
            "failed": found["limits_exceeded"],
        }
    return rows


def report(rows: dict[str, Any]) -> list[str]:
    """Return the results as the page of figures has them."""
    every = rows | elsewhere()
    lines = [f"{'what is done':<26}{'what must hold':<52}{'cases':>8}{'did not':>9}"]
    lines += [
        f"{name:<26}{one['must']:<52}{one['cases']:>8}{one['failed']:>9}" for name, one in every.items()
    ]
    whole = {key: sum(one[key] for one in every.values()) for key in ("cases", "failed")}
    lines.append(f"{'all of them':<78}{whole['cases']:>8}{whole['failed']:>9}")
    if "inputs of 100 MB" in rows:
        seen = rows["inputs of 100 MB"]["seen"].values()
        most, longest = (max(one[key] for one in seen) for key in ("peak_mb", "seconds"))
        lines.append(f"inputs of up to 100 MB took at most {most} MB of memory and {longest:.0f} s")
    spoiled = RESULTS.with_name("mutated.json")
    if spoiled.exists():
        first, _, *others = json.loads(spoiled.read_text())["report"]
        lines += [first, *others]
    return lines


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    parser.add_argument("--moments", type=int, default=50, help="for each writer")
    parser.add_argument("--sequences", type=int, default=200, help=f"of {_COMMANDS} commands to the page")
    parser.add_argument("--stalls", type=int, default=5000, help="connections")
    parser.add_argument("--seed", type=int, default=time.time_ns() % 2**32, help="default a new one")
    parser.add_argument("--only", metavar="NAME", help="rows with this word alone")
    args = parser.parse_args()
    known = json.loads(RESULTS.read_text())["rows"] if RESULTS.exists() else {}
    print(f"seed {args.seed}")
    for other in ("study_mutated.py", "study_safety.py") if args.only is None else ():
        subprocess.run([sys.executable, str(Path(__file__).with_name(other))], check=True)
    found = studied(args.moments, args.sequences, args.stalls, args.seed, args.only)
    rows = known | {name: {**one, "seed": args.seed} for name, one in found.items()}
    RESULTS.write_text(json.dumps({"report": report(rows), "rows": rows}, indent=1) + "\n")
    print(*report(rows), sep="\n")


if __name__ == "__main__":
    main()
