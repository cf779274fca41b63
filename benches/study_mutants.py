"""Faults planted by a machine: how many of them do the tests notice?

    python benches/study_mutants.py [--count 420] [--seed 0] [--processes 2] [--work FOLDER] [--again]

Draws mutants from the list of [cargo-mutants](https://mutants.rs), from each folder as many as its share of
all, plants them all in a copy of the sources (`planting.py`), builds once, and runs the Rust tests with one
fault after the other: first those of the changed file, then all, until one fails. Also caught is a fault with
which a test takes more than four times as long; what the compiler refuses is none. Goes on where it was
stopped: FOLDER/results.jsonl has what is known. Needs `cargo install cargo-mutants` and
`pip install tree-sitter tree-sitter-rust`. Writes its part of benches/results/mutants.json; the survivors
that were looked at stand in benches/survivors.toml, each with the reason.
"""

from __future__ import annotations

import argparse
import hashlib
import json
import math
import os
import random
import re
import signal
import subprocess
import tempfile
import threading
import time
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from itertools import groupby
from pathlib import Path
from typing import Any, NamedTuple

from mutants import ROOT, keep, report, rows_of, sample, stratum
from planting import EVERY, VARIABLE, Mutant, planted

CRATES = ("knobcore", "knobrender", "knobrig")
TESTS = (
    "--lib",
    *(f"--test={name}" for name in ("golden_filter", "laws_filter", "laws", "kept", "render", "passive")),
)
BUILD = ("--profile=dev", "--locked", *(f"--package={name}" for name in CRATES), *TESTS)
PATIENCE = 4.0  # times the unmutated time, of the processor
LEAST_S = 5.0  # added to it
STEPS_S = (0.1, 1.0)  # quicker tests, by these, run before slower ones


class Test(NamedTuple):
    """A test, what it costs the processor, and the mutants that it comes past."""

    crate: str
    program: Path
    folder: Path
    name: str
    seconds: float = 0.0
    passed: frozenset[int] = frozenset()


def cargo(tree: Path) -> list[dict[str, Any]]:
    """Compile the tests at low priority and return the compiler's messages."""
    environment = {"CARGO_TARGET_DIR": str(tree.parent / "target")} | os.environ | {"CARGO_INCREMENTAL": "0"}
    command = (
        "nice",
        "-n10",
        "cargo",
        "test",
        "--no-run",
        "--quiet",
        "--message-format=json",
        *BUILD,
    )
    ended = subprocess.run(command, cwd=tree, env=environment, stdout=subprocess.PIPE, text=True, check=False)
    return [json.loads(line) for line in ended.stdout.splitlines() if line.startswith("{")]


def refused(tree: Path, messages: list[dict[str, Any]]) -> dict[int, str]:
    """The mutants that errors of the compiler lie in, with what it said."""
    found: dict[int, str] = {}
    for message in messages:
        said = message.get("message") or {}
        if message["reason"] != "compiler-message" or said.get("level") != "error" or not said["spans"]:
            continue
        spans = sorted(said["spans"], key=lambda span: not span["is_primary"])
        numbers = [number for span in spans for number in _around(tree, span)]
        if not numbers:
            raise SystemExit(f"no mutant is to blame for: {said['rendered']}")
        found |= dict.fromkeys(numbers[:1], said["message"])
    return found


def _around(tree: Path, span: dict[str, Any]) -> Iterator[int]:
    """The innermost mutant around a span; of one that is in no mutant, all that lie inside."""
    if span["expansion"]:
        yield from _around(tree, span["expansion"]["span"])
    if not (tree / span["file_name"]).is_file():
        return
    text = (tree / span["file_name"]).read_bytes()
    start, end = span["byte_start"], span["byte_end"]
    regions = [
        (one.start(), text.index(b"/*%s>*/" % one[1], one.end()), int(one[1]))
        for one in re.finditer(rb"/\*<(\d+)\*/", text)
    ]
    around = [one for one in regions if one[0] <= start and end <= one[1]]
    inside = [one for one in regions if start <= one[0] and one[1] <= end]
    for _, _, number in [max(around)] if around else inside:
        yield number


def build(
    work: Path, entries: list[dict[str, Any]], refused_before: set[str]
) -> tuple[list[Mutant], list[tuple[Mutant, str]], list[Test]]:
    """Plant all, leave out what the compiler refuses, and compile the tests."""
    tree = work / "tree"
    every = [Mutant.listed(number, entry) for number, entry in enumerate(entries)]
    unviable = {mutant.number: "" for mutant in every if mutant.name in refused_before}
    tracked = subprocess.run(("git", "ls-files", "-z"), cwd=ROOT, capture_output=True, text=True, check=True)
    names = tracked.stdout.rstrip("\0").split("\0")  # tests read models from the Python package
    while True:
        living = [mutant for mutant in every if mutant.number not in unviable]
        unviable |= (now := planted(ROOT, tree, names, living))
        if now:
            continue
        messages = cargo(tree)
        now = refused(tree, messages)
        if not now:
            break
        print(
            *(f"refused: {every[number].name}: {said}" for number, said in now.items()), sep="\n", flush=True
        )
        unviable |= now
    programs = [
        Test(
            message["target"]["name"] if message["target"]["kind"] == ["lib"] else "",
            Path(message["executable"]),
            Path(message["manifest_path"]).parent,
            "",
        )
        for message in messages
        if message["reason"] == "compiler-artifact" and message.get("executable")
    ]
    if len(programs) < len(CRATES) + len(TESTS) - 1:
        raise SystemExit(f"not all tests compile; see `cargo test --no-run` in {tree}")
    return living, [(every[number], reason) for number, reason in unviable.items()], programs


def noted(program: Test, processes: int) -> Iterator[Test]:
    """Every test of a program, run alone without any fault to see what it comes past."""
    listing = subprocess.run(
        (program.program, "--list", "--format=terse"), capture_output=True, text=True, check=True
    )

    def one(name: str) -> Test | None:
        with tempfile.TemporaryDirectory() as folder:
            notes, spent = Path(folder, "notes"), [0.0]
            if failed := noticed([program._replace(name=name)], EVERY, 3600.0, notes, spent):
                print(f"left out, for it fails without any fault: {failed}", flush=True)
                return None
            passed = frozenset(map(int, notes.read_text("utf-8").split())) if notes.is_file() else frozenset()
        return program._replace(name=name, seconds=sum(spent), passed=passed)

    with ThreadPoolExecutor(processes) as pool:
        every = pool.map(one, re.findall(r"^(\S+): test$", listing.stdout, re.MULTILINE))
        yield from (test for test in every if test is not None)


def known_tests(program: Test, work: Path, processes: int) -> list[Test]:
    """The same, as it was noted before if the program is the same."""
    digest = hashlib.sha256(program.program.read_bytes()).hexdigest()
    path = work / f"tests-{digest[:16]}.json"
    if not path.is_file():
        tests = [[test.name, test.seconds, sorted(test.passed)] for test in noted(program, processes)]
        path.write_text(json.dumps(tests), "utf-8")
    rows = json.loads(path.read_text("utf-8"))
    return [
        program._replace(name=name, seconds=spent, passed=frozenset(passed)) for name, spent, passed in rows
    ]


def noticed(
    tests: list[Test], number: int, limit: float, notes: Path | None = None, spent: list[float] | None = None
) -> str:
    """Run tests of one program until one fails, and say which, or "" if all pass; `spent` gets the time."""
    running = subprocess.Popen(
        (
            *("nice", "-n10", "prlimit", f"--cpu={math.ceil(limit)}", tests[0].program, "--test-threads=1"),
            "--exact",
            *(test.name for test in tests),
        ),
        cwd=tests[0].folder,
        env=os.environ | {VARIABLE: str(number), f"{VARIABLE}_NOTES": str(notes)},
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
        errors="replace",
        bufsize=1,
    )
    # By the processor's time, since others may use the machine; by the clock too, should it wait forever.
    late = threading.Timer(20.0 * limit, running.kill)
    late.start()
    last = ""
    try:
        assert running.stdout is not None
        for line in running.stdout:
            if match := re.match(r"test (\S+)( - should panic)? \.\.\.", line):
                last = match[1]
            if line.rstrip().endswith("FAILED"):
                return f"{tests[0].program.name.rsplit('-', 1)[0]} {last}"
        _, status, usage = os.wait4(running.pid, 0)
        code = running.returncode = os.waitstatus_to_exitcode(status)
        if spent is not None:
            spent.append(usage.ru_utime + usage.ru_stime)
        if not late.is_alive() or code in (-signal.SIGXCPU, -signal.SIGKILL):
            return f"{last} takes too long"
        return f"{last} ends the process ({code})" if code else ""
    finally:
        late.cancel()
        running.kill()
        running.wait()


def tried(mutant: Mutant, tests: list[Test]) -> str:
    """Which test notices a mutant, or "" if none does: those of its file first, then the quick ones."""
    path = re.sub(r"^crates/\w+/src/|(/mod)?\.rs$", "", mutant.file).replace("/", "::")

    def order(test: Test) -> tuple[bool, int, float]:
        is_own = test.crate == mutant.package and test.name.startswith(f"{path}::")
        return not is_own, sum(test.seconds > limit for limit in STEPS_S), test.seconds

    some = sorted((test for test in tests if mutant.number in test.passed), key=order)
    for _, batch in groupby(some, key=lambda test: order(test)[:2]):
        for _, same in groupby(sorted(batch, key=lambda test: test.program), key=lambda test: test.program):
            now = list(same)
            if caught := noticed(now, mutant.number, PATIENCE * sum(test.seconds for test in now) + LEAST_S):
                return caught
    return ""


def run(work: Path, count: int, seed: int, processes: int, again: bool, longest_s: float) -> None:
    """Try what was not tried yet, or survived."""
    log = work / "results.jsonl"
    rows = rows_of(log)
    known = {row["name"] for row in rows if not (again and row["end"] == "survived")}
    listing = subprocess.run(
        ("cargo", "mutants", "--list", "--json"), cwd=ROOT, capture_output=True, text=True, check=True
    )
    entries = json.loads(listing.stdout)
    refused_before = {row["name"] for row in rows if row["end"] == "refused"}
    drawn = sample(entries, count, seed)
    (work / "sample.json").write_text(json.dumps([entry["name"] for entry in drawn]), "utf-8")
    living, unviable, programs = build(work, drawn, refused_before)
    tests = [test for program in programs for test in known_tests(program, work, processes)]
    print(f"{len(tests)} tests, {sum(test.seconds for test in tests):.1f} s", flush=True)
    tests = [test for test in tests if test.seconds <= longest_s]
    with log.open("a", encoding="utf-8") as out, ThreadPoolExecutor(processes) as pool:
        for mutant, reason in unviable:
            if mutant.name not in known:
                row = {"name": mutant.name, "stratum": stratum(mutant.file), "end": "refused", "by": reason}
                out.write(json.dumps(row) + "\n")

        def one(mutant: Mutant) -> None:
            start = time.monotonic()
            keep(out, mutant.name, mutant.file, tried(mutant, tests), start)

        jobs = [mutant for mutant in living if mutant.name not in known]
        random.Random(seed).shuffle(jobs)  # what was tried when it is stopped is a sample too
        list(pool.map(one, jobs))


def main() -> None:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--count", type=int, default=420)
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--processes", type=int, default=2)
    parser.add_argument("--work", type=Path, default=Path("/tmp/knobcam-mutants"))
    parser.add_argument("--again", action="store_true", help="what survived before is tried again")
    parser.add_argument("--longest", type=float, default=math.inf, help="tests that take longer wait, s")
    parser.add_argument("--report", action="store_true", help="no more than the report")
    told = parser.parse_args()
    told.work.mkdir(parents=True, exist_ok=True)
    if not told.report:
        run(told.work, told.count, told.seed, told.processes, told.again, told.longest)
    drawn = set(json.loads((told.work / "sample.json").read_text("utf-8")))
    # What was not run may have caught more.
    note = "" if math.isinf(told.longest) else f"tests of up to {told.longest:g} s of processor alone"
    report("rust", [row for row in rows_of(told.work / "results.jsonl") if row["name"] in drawn], note)


if __name__ == "__main__":
    main()
