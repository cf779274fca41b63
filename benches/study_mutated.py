"""Spoiled files of every format through `knobcam.load`: a capture, or one line that refuses it.

    python benches/study_mutated.py [--count 10000] [--seed 0] [--minutes M] [--processes 2]
    python benches/study_mutated.py [--count 10000] [--seed 0] --one CASE [--keep FOLDER]
    python benches/study_mutated.py [--count 10000] --again

Anything else fails: another exception, a warning, a message that is no line or names no file, 30 s, 2 GB of
address space, the end of the process. What took too long is tried once more, alone: a busy machine is no
hang. `--minutes` goes on with the next seeds for so long. `--one` runs a single case here and shows what it
says, `--again` tries what failed in the last run, and says how much of that was mended. Writes
benches/results/mutated.json.
"""

from __future__ import annotations

import argparse
import itertools
import json
import multiprocessing
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
from mutations import bombs, mutated

import knobcam as kc

_WORDS = {"capture": "captures", "refused": "refused in one line", "failed": "failed"}
RESULTS = Path(__file__).parent / "results" / "mutated.json"
LONGEST_S = 30.0
MOST_BYTES = 2 * 2**30
_TOO_LONG = "took longer than 30 s"


class Ending(NamedTuple):
    """How a case ended: capture, refused or failed, with what was said, its time and the process's memory."""

    kind: str
    said: str
    seconds: float
    peak_mb: float


class Case(NamedTuple):
    """A file by the seed that makes it."""

    seed: int
    index: int
    source: str

    def content(self, files: dict[str, Source]) -> tuple[bytes, dict[str, Any], str]:
        """Return the file, the options to read it with and what was done to it."""
        raw, options = files[self.source]
        if self.index < 0:
            return raw, options, "bomb"
        rng = random.Random(f"{self.seed} {self.index}")
        spoiled, done = mutated(raw, rng)
        return spoiled, options if rng.random() < 0.7 else {}, ", ".join(done)


def cases(count: int, seed: int, files: dict[str, Source]) -> list[Case]:
    """Return that many cases, every source in turn."""
    names = list(files)
    return [Case(seed, index, names[index % len(names)]) for index in range(count)]


def tried(path: Path, options: dict[str, Any]) -> Ending:
    """Load a file and say how that ended."""
    start = time.monotonic()
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        try:
            capture = kc.load(path, **options)
            kind, said = "capture", ", ".join(sorted({one.kind for one in capture.findings}))
            if not all(np.isfinite(values[capture.mask]).all() for values in capture.columns.values()):
                kind, said = "failed", "a sample that counts is not finite"
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
        path = folder / "spoiled.log"
        path.write_bytes(raw)
        pipe.send(tried(path, options))


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


def summary(endings: dict[Case, Ending], files: dict[str, Source]) -> dict[str, Any]:
    """Return the figures, and every failure with what makes it again."""
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
    seeds = sorted({case.seed for case in endings})
    shown = str(seeds[0]) if len(seeds) == 1 else f"{seeds[0]} to {seeds[-1]}"
    total = Counter(ending.kind for ending in endings.values())
    slowest = max(endings.items(), key=lambda item: item[1].seconds)
    peak_mb = round(max(ending.peak_mb for ending in endings.values()))
    report = [
        f"{len(endings)} files of {len(by_source)} kinds, spoiled (seed {shown}): "
        + ", ".join(f"{total[kind]} {words}" for kind, words in _WORDS.items()),
        f"slowest {slowest[1].seconds:.1f} s; most memory of a process {peak_mb} MB",
        *(f"failed: {one['source']} {one['seed']}, {one['case']}, {one['done']}" for one in failures),
    ]
    return {
        "report": report,
        "seeds": seeds,
        "files": len(endings),
        **{kind: total[kind] for kind in ("capture", "refused", "failed")},
        "slowest_s": round(slowest[1].seconds, 2),
        "slowest": [slowest[0].index, slowest[0].source],
        "peak_mb": peak_mb,
        "by_source": {name: dict(counts) for name, counts in by_source.items() if counts},
        "failures": failures,
    }


def again(found: dict[str, Any], count: int, files: dict[str, Source], folder: Path) -> dict[str, Any]:
    """Return the figures of a run after its failures were tried anew with the program as it is."""
    failed = {(one["seed"], one["case"]): one for one in found["failures"]}
    every = [cases(count, seed, files)[index] for seed, index in failed]
    endings = run(every, files, 1, folder)
    left = [failed[case.seed, case.index] for case in every if endings[case].kind == "failed"]
    for case in every:
        kind = endings[case].kind
        if kind != "failed":
            for counts in (found, found["by_source"][case.source]):
                counts["failed"] -= 1
                counts[kind] = counts.get(kind, 0) + 1
    first, *others = found["report"]
    told = ", ".join(f"{found[kind]} {words}" for kind, words in _WORDS.items())
    mended = f"{len(every) - len(left)} of them had failed, and were mended and tried again"
    others = [line for line in others if not line.startswith("failed")]
    report = [f"{first.partition(': ')[0]}: {told}", *others, mended]
    report += [f"failed: {one['source']} {one['seed']}, {one['case']}, {one['done']}" for one in left]
    return found | {"report": report, "failures": left}


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    parser.add_argument("--count", type=int, default=10_000, help="of spoiled files; the bombs come on top")
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--minutes", type=float, default=0.0, help="go on with the next seeds for so long")
    parser.add_argument("--processes", type=int, default=2)
    parser.add_argument("--again", action="store_true", help="what failed in the last run")
    parser.add_argument("--one", type=int, metavar="CASE", help="its number in the results")
    parser.add_argument("--keep", type=Path, metavar="FOLDER", help="where to write the file of --one")
    args = parser.parse_args()
    files = sources()
    every = cases(args.count, args.seed, files)
    with tempfile.TemporaryDirectory() as scratch:
        folder = Path(scratch)
        if args.again:
            found = again(json.loads(RESULTS.read_text()), args.count, files, folder)
            RESULTS.write_text(json.dumps(found, indent=1) + "\n")
            print(*found["report"], sep="\n")
            return
        if args.one is not None:
            raw, options, done = every[args.one].content(files)
            path = (args.keep or folder) / "spoiled.log"
            path.write_bytes(raw)
            print(every[args.one], options, done, len(raw))
            print(tried(path, options))
            return
        large = bombs()
        every = [*(Case(args.seed, -1, name) for name in large), *every]
        ends, endings = time.monotonic() + 60.0 * args.minutes, {}
        for seed in itertools.count(args.seed + 1):
            endings |= run(every, files | large, args.processes, folder)
            found = summary(endings, files | large)
            RESULTS.write_text(json.dumps(found, indent=1) + "\n")
            if time.monotonic() > ends:
                break
            every = cases(args.count, seed, files)
    shown = {name: found[name] for name in found if name not in ("by_source", "failures")}
    print(json.dumps(shown), *(json.dumps(one) for one in found["failures"]), sep="\n")


if __name__ == "__main__":
    main()
