"""Spoiled files of every format that is read: what it holds, or one line that refuses it.

    python benches/study_mutated.py [--each 10000] [--seed N] [--processes 2] [--anew]
    python benches/study_mutated.py --one SEED CASE [--keep FOLDER]
    python benches/study_mutated.py --again

Anything else fails: another exception, a warning, a message that is no line or names no file, 30 s, 2 GB of
address space, the end of the process. What took too long is tried once more, alone: a busy machine is no
hang. It goes on seed by seed until there are as many files of each format, those of earlier runs counted;
`--anew` forgets them. `--one` runs a single case here and shows
what it says, `--again` tries what failed, and says how much of that was mended. Writes
benches/results/mutated.json.
"""

from __future__ import annotations

import argparse
import json
import multiprocessing
import os
import random
import resource
import tempfile
import time
import traceback
import warnings
from collections import Counter
from multiprocessing.connection import Connection, wait
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from every_format import Source, sources
from mutations import bombs, mutated, sealed
from resumed import version

import knobcam as kc
from knobcam.base.arrays import groups
from knobcam.rig.calibration import Calibration
from knobcam.workbench.kept import Told

_WORDS = {"read": "read", "refused": "refused in one line", "failed": "failed"}
RESULTS = Path(__file__).parent / "results" / "mutated.json"
LONGEST_S = 30.0
MOST_BYTES = 2 * 2**30
_TOO_LONG = "took longer than 30 s"
_OF_A_SEED = 500
"""Files of each format by one seed."""
_NAMES = {"session": "journal"}
"""What a file has to be called, where that matters."""


class Ending(NamedTuple):
    """How a case ended: read, refused or failed, with what was said, its time and the process's memory."""

    kind: str
    said: str
    seconds: float
    peak_mb: float


class Case(NamedTuple):
    """A file by the seed that makes it."""

    seed: int
    index: int
    source: str

    @property
    def format(self) -> str:
        """What kind of file it is."""
        return self.source.partition("/")[0]

    @property
    def file(self) -> str:
        """How the file is called."""
        return _NAMES.get(self.format, "spoiled.log")

    def content(self, files: dict[str, Source]) -> tuple[bytes, dict[str, Any], str]:
        """Return the file, the options to read it with and what was done to it."""
        raw, options = files[self.source]
        if self.index < 0:
            return raw, options, "bomb"
        rng = random.Random(f"{self.seed} {self.index}")
        spoiled, done = mutated(raw, rng)
        kept = rng.random() < 0.7
        if self.format == "session" and kept:  # else nothing but its check sums would be tried
            spoiled = sealed(spoiled)
        return spoiled, options if kept else {}, ", ".join(done)


def cases(each: int, seed: int, files: dict[str, Source]) -> list[Case]:
    """Return that many cases of each format, its sources in turn."""
    kinds = sorted({name.partition("/")[0] for name in files})
    of = {kind: [name for name in files if name.startswith(f"{kind}/")] for kind in kinds}
    return [
        Case(seed, turn * len(kinds) + place, of[kind][(seed + turn) % len(of[kind])])
        for turn in range(each)
        for place, kind in enumerate(kinds)
    ]


def _is_read(path: Path, format: str, options: dict[str, Any]) -> str:
    """Read a file; return what is wrong with what it held, nothing where all is well."""
    if format == "model":
        model = kc.Model.load(path)
        return "" if kc.Model.parse(model.text()) == model else "another model once it was written"
    if format == "calibration":
        Calibration.load(path)
    elif format == "session":
        Told.of(path.parent)
    else:
        capture = kc.load(path, **options)
        if not all(np.isfinite(values[capture.mask]).all() for values in capture.columns.values()):
            return "a sample that counts is not finite"
    return ""


def tried(path: Path, format: str, options: dict[str, Any]) -> Ending:
    """Read a file and say how that ended."""
    start = time.monotonic()
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        try:
            said = _is_read(path, format, options)
            kind = "failed" if said else "read"
        except kc.KnobcamError as error:
            kind, said = "refused", str(error)
            if error.exit_code != 2 or "\n" in said or path.name not in said or "MemoryError" in said:
                kind = "failed"
        except Exception:
            kind, said = "failed", traceback.format_exc()
    peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024.0
    return Ending(kind, said, time.monotonic() - start, peak)


def work(pipe: Connection, files: dict[str, Source], folder: Path) -> None:
    """Try what comes through the pipe, within the memory that there is."""
    resource.setrlimit(resource.RLIMIT_AS, (MOST_BYTES, MOST_BYTES))
    while (case := pipe.recv()) is not None:
        raw, options, _ = case.content(files)
        path = folder / case.file
        path.write_bytes(raw)
        pipe.send(tried(path, case.format, options))


class Worker:
    """A process that tries one case after the other, replaced when it ends or takes too long."""

    def __init__(self, files: dict[str, Source], folder: Path) -> None:
        self.files, self.folder = files, folder
        self.case: Case | None = None
        folder.mkdir(exist_ok=True)
        self._start()

    def _start(self) -> None:
        context = multiprocessing.get_context("spawn")
        self.pipe, theirs = context.Pipe()
        self.process = context.Process(target=work, args=(theirs, self.files, self.folder), daemon=True)
        self.process.start()
        theirs.close()

    def give(self, case: Case) -> None:
        """Let it try a case."""
        self.case, self.began = case, time.monotonic()
        self.pipe.send(case)

    def ended(self) -> Ending | None:
        """Return how its case ended, None while it runs."""
        taken = time.monotonic() - self.began
        try:
            if self.pipe.poll():
                return self.pipe.recv()  # type: ignore[no-any-return]
            if self.process.is_alive() and taken < LONGEST_S:
                return None
            said = _TOO_LONG
        except (EOFError, ConnectionResetError):
            self.process.join()
            said = f"the process ended with {self.process.exitcode}"
        self.process.kill()
        self.process.join()
        self._start()
        return Ending("failed", said, taken, 0.0)

    def stop(self) -> None:
        """End it."""
        self.pipe.send(None)
        self.process.join()


def run(every: list[Case], files: dict[str, Source], processes: int, folder: Path) -> dict[Case, Ending]:
    """Try all cases and return how each ended."""
    endings = run_once(every, files, processes, folder)
    late = [case for case, ending in endings.items() if ending.said == _TOO_LONG]
    return endings | (run_once(late, files, 1, folder) if late else {})


def run_once(every: list[Case], files: dict[str, Source], processes: int, folder: Path) -> dict[Case, Ending]:
    """Try all cases in some processes."""
    endings: dict[Case, Ending] = {}
    workers = [Worker(files, folder / f"worker-{index}") for index in range(processes)]
    waiting = list(reversed(every))
    busy: list[Worker] = []
    while waiting or busy:
        for worker in workers:
            if waiting and worker not in busy:
                worker.give(waiting.pop())
                busy.append(worker)
        wait([worker.pipe for worker in busy], timeout=1.0)
        for worker in list(busy):
            ending = worker.ended()
            if ending is not None and worker.case is not None:
                endings[worker.case] = ending
                busy.remove(worker)
    for worker in workers:
        worker.stop()
    return endings


def counted(endings: dict[Case, Ending], files: dict[str, Source]) -> dict[str, Any]:
    """Return the figures of some cases, and every failure with what makes it again."""
    by_source = {
        name: Counter(ending.kind for case, ending in endings.items() if case.source == name)
        for name in files
    }
    failures = [
        {
            "seed": case.seed,
            "case": case.index,
            "source": case.source,
            "done": case.content(files)[2],
            "said": ending.said[-800:],
        }
        for case, ending in endings.items()
        if ending.kind == "failed"
    ]
    slowest, ending = max(endings.items(), key=lambda item: item[1].seconds)
    return {
        "seeds": sorted({case.seed for case in endings}),
        "slowest_s": round(ending.seconds, 2),
        "slowest": list(slowest),
        "peak_mb": round(max(ending.peak_mb for ending in endings.values())),
        "by_source": {name: dict(counts) for name, counts in by_source.items() if counts},
        "failures": failures,
    }


def added(found: dict[str, Any], more: dict[str, Any]) -> dict[str, Any]:
    """Return the figures of two runs as those of one."""
    if not found:
        return more
    by_source = {
        name: dict(Counter(found["by_source"].get(name, {})) + Counter(more["by_source"].get(name, {})))
        for name in {**found["by_source"], **more["by_source"]}
    }
    slowest = max(found, more, key=lambda one: one["slowest_s"])
    return {
        "seeds": [*found["seeds"], *more["seeds"]],
        "programs": sorted({*found.get("programs", ()), *more.get("programs", ())}),
        "slowest_s": slowest["slowest_s"],
        "slowest": slowest["slowest"],
        "peak_mb": max(found["peak_mb"], more["peak_mb"]),
        "by_source": by_source,
        "failures": [*found["failures"], *more["failures"]],
        "mended": found.get("mended", 0) + more.get("mended", 0),
    }


def told(found: dict[str, Any]) -> dict[str, Any]:
    """Return the figures with what they say as a whole."""
    total, kinds = Counter[str](), Counter[str]()
    for name, counts in found["by_source"].items():
        total.update(counts)
        kinds[name.partition("/")[0]] += sum(counts.values())
    figures = {"files": total.total(), **{kind: total[kind] for kind in _WORDS}, "by_format": dict(kinds)}
    runs = groups(np.unique(found["seeds"]), 1)
    shown = ", ".join(f"{one[0]} to {one[-1]}" if len(one) > 1 else str(one[0]) for one in runs)
    again = found.get("mended")
    mended = f" ({again} had, were mended and tried again)" if again else ""
    report = [
        f"{total.total()} files, {fewest(figures)} or more of each of {len(kinds.keys() - {'bomb'})} formats "
        f"(seed {shown}): " + ", ".join(f"{total[kind]} {words}" for kind, words in _WORDS.items()) + mended,
        f"slowest {found['slowest_s']:.1f} s; most memory of a process {found['peak_mb']} MB",
    ]
    report += [
        f"failed: {one['source']} {one['seed']}, {one['case']}, {one['done']}" for one in found["failures"]
    ]
    return found | {"report": report, **figures}


def fewest(found: dict[str, Any]) -> int:
    """Return of how many files of every format there are figures at least."""
    return min((count for kind, count in found.get("by_format", {}).items() if kind != "bomb"), default=0)


def again(found: dict[str, Any], files: dict[str, Source], folder: Path) -> dict[str, Any]:
    """Return the figures of a run after its failures were tried anew with the program as it is."""
    failed = {Case(one["seed"], one["case"], one["source"]): one for one in found["failures"]}
    endings = run(list(failed), files, 1, folder)
    by_source = {name: Counter(counts) for name, counts in found["by_source"].items()}
    for case, ending in endings.items():
        by_source[case.source]["failed"] -= 1
        by_source[case.source][ending.kind] += 1
    left = [one for case, one in failed.items() if endings[case].kind == "failed"]
    mended = found.get("mended", 0) + len(failed) - len(left)
    by_source = {name: dict(+counts) for name, counts in by_source.items()}
    return told(found | {"by_source": by_source, "failures": left, "mended": mended})


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    parser.add_argument("--each", type=int, default=10_000, help="of every format; the bombs come on top")
    parser.add_argument("--seed", type=int, help="the first one; default the one behind the last")
    parser.add_argument("--processes", type=int, default=2)
    parser.add_argument("--anew", action="store_true", help="forget what was counted")
    parser.add_argument("--again", action="store_true", help="what failed")
    parser.add_argument("--one", type=int, nargs=2, metavar=("SEED", "CASE"), help="as in the results")
    parser.add_argument("--keep", type=Path, metavar="FOLDER", help="where to write the file of --one")
    args = parser.parse_args()
    files = sources() | bombs()
    spoiled = {name: one for name, one in files.items() if not name.startswith("bomb/")}
    known = json.loads(RESULTS.read_text()) if RESULTS.exists() and not args.anew else {}
    # Files that live for a moment need no disk.
    memory = "/dev/shm" if os.access("/dev/shm", os.W_OK) else None
    with tempfile.TemporaryDirectory(dir=memory) as scratch:
        folder = Path(scratch)
        if args.one is not None:
            case = cases(_OF_A_SEED, args.one[0], spoiled)[args.one[1]]
            raw, options, done = case.content(files)
            path = (args.keep or folder) / case.file
            path.write_bytes(raw)
            print(case, options, done, len(raw))
            print(tried(path, case.format, options))
            return
        if args.again:
            known = again(known, files, folder)
            RESULTS.write_text(json.dumps(known, indent=1) + "\n")
        program = version(Path(kc.__file__).parent)
        seed = args.seed if args.seed is not None else max(known.get("seeds", [-1])) + 1
        while not args.again and (left := args.each - fewest(known)) > 0:
            every = cases(min(_OF_A_SEED, left), seed, spoiled)
            if not known:
                every = [*(Case(seed, -1, name) for name in files.keys() - spoiled.keys()), *every]
            more = counted(run(every, files, args.processes, folder), files) | {"programs": [program]}
            known = told(added(known, more))
            RESULTS.write_text(json.dumps(known, indent=1) + "\n")
            print(f"{time.strftime('%H:%M:%S')} seed {seed}: {known['files']} files", flush=True)
            seed += 1
    print(*known["report"], sep="\n")


if __name__ == "__main__":
    main()
