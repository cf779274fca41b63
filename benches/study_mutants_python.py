"""Faults planted in the Python that decides: how many of them do the tests notice?

    python benches/study_mutants_python.py [--count 220] [--seed 0] [--processes 2] [--work FOLDER] [--again]

What `study_mutants.py` is for Rust, for `PLACES`. All faults of a sample are planted in a copy
(`planting_python.py`); the tests run once to note which of them come past which fault; then, fault by fault,
those tests alone, the quickest first, until one fails. Goes on where it was stopped. Texts that people read,
and what raises, are left as they are. Writes its part of benches/results/mutants.json.
"""

from __future__ import annotations

import argparse
import json
import math
import os
import random
import shutil
import subprocess
import sys
import time
from collections import defaultdict
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import Any

import pytest
from mutants import ROOT, keep, report, rows_of, sample
from planting_python import MODULE, VARIABLE, Fault, faults, planted

PACKAGES = Path("python", "knobcam")
PLACES = ("learn", "fit")
# Those that look at sources, drive browsers or wait for a rig say nothing about what is decided.
APART = (
    "house",
    "docs",
    "docs_site",
    "browser",
    "rig_",
    "examiner",
    "hidden_simulator",
    "instruction_sets",
    "loop",
)
APART += (
    "wire_vectors",
    "workbench",
    "wrong_calls",
    "pages",
    "plot",
    "mutated",
    "notebook",
    "formats",
    "strangers",
)
PATIENCE = 5.0  # times the unmutated time, of the processor
LEAST_S = 20.0  # added to it


class Told:
    """A plugin of pytest: notes in the environment which test, or shared fixture, comes past a fault."""

    def __init__(self) -> None:
        self.fixtures: dict[str, list[str]] = {}
        self.seconds: dict[str, float] = defaultdict(float)

    def pytest_runtest_protocol(self, item: pytest.Item) -> None:
        os.environ[f"{VARIABLE}_IN"] = item.nodeid
        self.fixtures[item.nodeid] = sorted(getattr(item, "fixturenames", ()))

    @pytest.hookimpl(wrapper=True)
    def pytest_fixture_setup(self, fixturedef: Any) -> Any:
        before, start = os.environ.get(f"{VARIABLE}_IN", ""), time.monotonic()
        os.environ[f"{VARIABLE}_IN"] = f"fixture {fixturedef.argname}"
        try:
            return (yield)
        finally:
            os.environ[f"{VARIABLE}_IN"] = before
            self.seconds[f"fixture {fixturedef.argname}"] = time.monotonic() - start

    def pytest_runtest_logreport(self, report: pytest.TestReport) -> None:
        if report.when == "call":
            self.seconds[report.nodeid] = report.duration
        if report.failed:
            print(f"fails without any fault: {report.nodeid}", flush=True)

    def pytest_sessionfinish(self) -> None:
        notes = Path(os.environ[f"{VARIABLE}_NOTES"])
        (notes / "tests.txt").write_text(json.dumps([self.fixtures, self.seconds]), "utf-8")


def prepared(work: Path, count: int, seed: int) -> list[Fault]:
    """A copy of the checkout with a sample of all faults in it."""
    tree = work / "tree"
    tracked = subprocess.run(("git", "ls-files", "-z"), cwd=ROOT, capture_output=True, text=True, check=True)
    for name in (*tracked.stdout.rstrip("\0").split("\0"), str(PACKAGES / "_core.abi3.so")):
        (tree / name).parent.mkdir(parents=True, exist_ok=True)
        shutil.copy(ROOT / name, tree / name)
    found = every()
    drawn = {
        entry["name"]
        for entry in sample([{"name": one.name, "file": one.file} for one in found], count, seed)
    }
    living = [one for one in found if one.name in drawn]
    numbers = {one.name: number for number, one in enumerate(living)}
    for file in sorted({one.file for one in living}):
        (tree / file).write_text(planted(file, (ROOT / file).read_text("utf-8"), numbers), "utf-8")
    (tree / PACKAGES / "_planted.py").write_text(MODULE, "utf-8")
    return living


def every() -> list[Fault]:
    """All faults that could be planted."""
    files = sorted(path for place in PLACES for path in (ROOT / PACKAGES / place).rglob("*.py"))
    return [one for path in files for one in faults(str(path.relative_to(ROOT)), path.read_text("utf-8"))]


def pytest_words(work: Path) -> tuple[list[str], dict[str, str]]:
    """The call of Python, before its words, and the environment."""
    environment = os.environ | {
        "PYTHONPATH": str(work / "tree" / "python"),
        f"{VARIABLE}_NOTES": str(work / "notes"),
    }
    environment |= {"OPENBLAS_NUM_THREADS": "1", "PYTHONDONTWRITEBYTECODE": "1"}
    return ["nice", "-n10", sys.executable], environment


def passed(work: Path, files: list[str]) -> dict[int, list[tuple[float, str]]]:
    """For each fault the tests that come past it, the quickest first, with their seconds."""
    notes = work / "notes"
    if not (notes / "tests.txt").is_file():
        notes.mkdir(exist_ok=True)
        python, environment = pytest_words(work)
        command = [*python, str(Path(__file__).resolve()), "--work", str(work), "--note", "--tests", *files]
        subprocess.run(command, cwd=work / "tree", env=environment | {VARIABLE: "all"}, check=True)
    fixtures, seconds = json.loads((notes / "tests.txt").read_text("utf-8"))
    by_place: dict[str, set[int]] = defaultdict(set)
    for path in notes.glob("*.json"):
        for place, numbers in json.loads(path.read_text("utf-8")).items():
            by_place[place] |= set(numbers)
    tests: dict[int, list[tuple[float, str]]] = defaultdict(list)
    for test, names in fixtures.items():
        used = [f"fixture {name}" for name in names]
        cost = seconds.get(test, 0.0) + sum(seconds.get(name, 0.0) for name in used)
        for number in set().union(by_place[test], *(by_place[name] for name in used), by_place[""]):
            tests[number].append((cost, test))
    return {number: sorted(found) for number, found in tests.items()}


def noted(tree: Path, files: list[str]) -> None:
    """Run these tests, or all that may tell, with the plugin."""
    if not files:
        every = sorted((tree / "tests").glob("test_*.py"))
        files = [str(path) for path in every if not path.stem[5:].startswith(APART)]
        files += [str(tree / PACKAGES / place) for place in PLACES]
    pytest.main(["-q", "-p", "no:cacheprovider", *files], plugins=[Told()])


def tried(work: Path, number: int, tests: list[tuple[float, str]]) -> str:
    """Which test notices a fault, or "" if none does."""
    python, environment = pytest_words(work)
    # A few at a time: the quickest tell most, and those that come past an import's fault are all.
    while tests:
        some = tests[
            : 1 + sum(1 for at in range(1, len(tests)) if sum(cost for cost, _ in tests[: at + 1]) < LEAST_S)
        ]
        tests = tests[len(some) :]
        limit = math.ceil(PATIENCE * sum(cost for cost, _ in some) + LEAST_S)
        words = ["-m", "pytest", "-x", "-q", "--tb=no", "-p", "no:cacheprovider", *(test for _, test in some)]
        # By the processor's time, since others may use the machine; by the clock too, should it wait forever.
        try:
            ended = subprocess.run(
                ["prlimit", f"--cpu={limit}", *python, *words],
                cwd=work / "tree",
                env=environment | {VARIABLE: str(number)},
                capture_output=True,
                text=True,
                timeout=20.0 * limit,
                check=False,
            )
        except subprocess.TimeoutExpired:
            return "waits too long"
        if ended.returncode < 0:
            return "takes too long"
        if ended.returncode:
            failed = [line for line in ended.stdout.splitlines() if line.startswith(("FAILED", "ERROR"))]
            return failed[0].split(" - ")[0] if failed else f"ends with {ended.returncode}"
    return ""


def run(
    work: Path, count: int, seed: int, processes: int, again: bool, files: list[str], longest_s: float
) -> None:
    """Try what was not tried yet, or survived."""
    log = work / "results.jsonl"
    known = {row["name"] for row in rows_of(log) if not (again and row["end"] == "survived")}
    living = prepared(work, count, seed)
    tests = passed(work, files)
    with log.open("a", encoding="utf-8") as out, ThreadPoolExecutor(processes) as pool:

        def one(job: tuple[int, Fault]) -> None:
            number, fault = job
            start = time.monotonic()
            own = [test for test in tests.get(number, []) if test[0] <= longest_s]
            keep(out, fault.name, fault.file, tried(work, number, own), start, tests=len(own))

        jobs = [(at, fault) for at, fault in enumerate(living) if fault.name not in known]
        random.Random(seed).shuffle(jobs)  # what was tried when it is stopped is a sample too
        list(pool.map(one, jobs))


def main() -> None:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--count", type=int, default=220)
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--processes", type=int, default=2)
    parser.add_argument("--work", type=Path, default=Path("/tmp/knobcam-mutants-python"))
    parser.add_argument("--again", action="store_true", help="what survived before is tried again")
    parser.add_argument("--longest", type=float, default=math.inf, help="tests that take longer wait, s")
    parser.add_argument("--report", action="store_true", help="no more than the report")
    parser.add_argument("--tests", nargs="*", default=[], help="files of tests; without, all that may tell")
    parser.add_argument("--note", action="store_true", help=argparse.SUPPRESS)
    told = parser.parse_args()
    if told.note:
        return noted(told.work / "tree", told.tests)
    told.work.mkdir(parents=True, exist_ok=True)
    if not told.report:
        run(told.work, told.count, told.seed, told.processes, told.again, told.tests, told.longest)
    # What was not run may have caught more.
    few = ", ".join(Path(one).stem for one in told.tests)
    limit = "" if math.isinf(told.longest) else f"tests of up to {told.longest:g} s"
    note = " of ".join(part for part in (limit, few) if part) + " alone" if limit or few else ""
    report("python", rows_of(told.work / "results.jsonl"), note)
    return None


if __name__ == "__main__":
    main()
