"""Faults planted by a machine: how many of them do the tests notice?

    python benches/study_mutants.py [--count 420] [--seed 0] [--processes 2] [--work FOLDER] [--again]

Draws mutants from the list of [cargo-mutants](https://mutants.rs), from each folder as many as its share of
all, plants them all in a copy of the sources (`planting.py`), builds once, and runs the Rust tests with one
fault after the other: first those of the changed file, then all, until one fails. Also caught is a fault with
which a test takes more than five times as long; what the compiler refuses is none. Goes on where it was
stopped: FOLDER/results.jsonl has what is known. Needs `cargo install cargo-mutants` and
`pip install tree-sitter tree-sitter-rust`. Writes its part of benches/results/mutants.json; the survivors
that were looked at stand in benches/survivors.toml, each with the reason.
"""

from __future__ import annotations

import argparse
import hashlib
import json
import os
import re
import subprocess
import threading
import time
import tomllib
from collections import Counter
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import Any, NamedTuple

ROOT = Path(__file__).resolve().parents[1]
RESULTS = ROOT / "benches" / "results" / "mutants.json"
REASONS = ROOT / "benches" / "survivors.toml"
CRATES = ("knobcore", "knobrender", "knobrig")
TESTS = ("--lib", "--test=golden_filter", "--test=laws_filter", "--test=laws", "--test=render")
BUILD = ("--locked", *(f"--package={name}" for name in CRATES), *TESTS)
PATIENCE = 5.0  # times the unmutated time
LEAST_S = 10.0  # added to it


def stratum(file: str) -> str:
    """The folder or the file whose share a mutant counts for."""
    crate, part = re.fullmatch(r"(?:crates|python)/(\w+)/(?:src/)?([^/]+?)(?:\.rs|/.*)", file).groups()  # type: ignore[union-attr]
    return "render" if crate == "knobrender" else "chain" if part == "motion" else part


def sample(entries: list[dict[str, Any]], count: int, seed: int) -> list[dict[str, Any]]:
    """As many from each stratum as its share of all, by a hash: a change elsewhere keeps them."""
    strata: dict[str, list[dict[str, Any]]] = {}
    for entry in entries:
        strata.setdefault(stratum(entry["file"]), []).append(entry)
    drawn = []
    for members in strata.values():
        members.sort(key=lambda entry: hashlib.sha256(f"{seed} {entry['name']}".encode()).hexdigest())
        drawn += members[: round(count * len(members) / len(entries))]
    return sorted(drawn, key=lambda entry: entry["name"])


class Suite(NamedTuple):
    """A test program and how long it takes."""

    crate: str
    program: Path
    folder: Path
    seconds: float = 0.0


def cargo(tree: Path, *words: str) -> list[dict[str, Any]]:
    """Run cargo at low priority and return its messages."""
    environment = {"CARGO_TARGET_DIR": str(tree.parent / "target")} | os.environ
    command = ("nice", "-n10", "cargo", *words, "--quiet", "--message-format=json", "--profile=dev", *BUILD)
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
) -> tuple[list[Any], list[tuple[Any, str]], list[Suite]]:
    """Plant all, leave out what the compiler refuses, and compile the tests."""
    from planting import Mutant, planted

    tree = work / "tree"
    every = [Mutant.listed(number, entry) for number, entry in enumerate(entries)]
    unviable = {mutant.number: "" for mutant in every if mutant.name in refused_before}
    tracked = subprocess.run(("git", "ls-files", "-z"), cwd=ROOT, capture_output=True, text=True, check=True)
    names = [name for name in tracked.stdout.split("\0") if name.startswith(("crates/", "Cargo"))]
    while True:
        living = [mutant for mutant in every if mutant.number not in unviable]
        unviable |= (now := planted(ROOT, tree, names, living))
        if now:
            continue
        messages = cargo(tree, "check", "--keep-going")
        now = refused(tree, messages)
        if not now:
            break
        print(
            *(f"refused: {every[number].name}: {said}" for number, said in now.items()), sep="\n", flush=True
        )
        unviable |= now
    messages = cargo(tree, "test", "--no-run")
    suites = [
        Suite(
            message["target"]["name"] if message["target"]["kind"] == ["lib"] else "",
            Path(message["executable"]),
            Path(message["manifest_path"]).parent,
        )
        for message in messages
        if message["reason"] == "compiler-artifact" and message.get("executable")
    ]
    if not suites:
        raise SystemExit("the tests do not compile")
    return living, [(every[number], reason) for number, reason in unviable.items()], suites


def noticed(suite: Suite, number: int | None, words: tuple[str, ...], seconds: float) -> str:
    """Run tests until one fails and say which, or "" if all pass."""
    environment = {key: value for key, value in os.environ.items() if key != "PLANTED"}
    environment |= {} if number is None else {"PLANTED": str(number)}
    running = subprocess.Popen(
        ("nice", "-n10", suite.program, "--test-threads=1", *words),
        cwd=suite.folder,
        env=environment,
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
        errors="replace",
        bufsize=1,
    )
    late = threading.Timer(seconds, running.kill)
    late.start()
    last = ""
    try:
        assert running.stdout is not None
        for line in running.stdout:
            if match := re.match(r"test (\S+)( - should panic)? \.\.\.", line):
                last = match[1]
            if line.rstrip().endswith("FAILED"):
                return f"{suite.program.name.rsplit('-', 1)[0]} {last}"
        code = running.wait()
        if not late.is_alive():
            return f"{last} takes too long"
        return f"{last} ends the process ({code})" if code else ""
    finally:
        late.cancel()
        running.kill()
        running.wait()


def tried(mutant: Any, suites: list[Suite]) -> str:
    """Which test notices a mutant, or "" if none does."""
    own = next(suite for suite in suites if suite.crate == mutant.package)
    path = re.sub(r"^crates/\w+/src/|(/mod)?\.rs$", "", mutant.file).replace("/", "::")
    if caught := noticed(own, mutant.number, (f"{path}::",), PATIENCE * own.seconds + LEAST_S):
        return caught
    for suite in sorted(suites, key=lambda one: (one is not own, one.seconds)):
        if caught := noticed(suite, mutant.number, (), PATIENCE * suite.seconds + LEAST_S):
            return caught
    return ""


def timed(suite: Suite) -> Suite:
    """With the time that it takes where nothing is planted."""
    start = time.monotonic()
    if failed := noticed(suite, None, (), 3600.0):
        raise SystemExit(f"without any fault: {failed}")
    return suite._replace(seconds=time.monotonic() - start)


def rows_of(log: Path) -> list[dict[str, Any]]:
    """What a log has, of every mutant the last."""
    lines = log.read_text("utf-8").splitlines() if log.is_file() else []
    return list({row["name"]: row for row in map(json.loads, lines)}.values())


def run(work: Path, count: int, seed: int, processes: int, again: bool) -> None:
    """Try what was not tried yet, or survived."""
    log = work / "results.jsonl"
    rows = rows_of(log)
    known = {row["name"] for row in rows if not (again and row["end"] == "survived")}
    listing = subprocess.run(
        ("cargo", "mutants", "--list", "--json"), cwd=ROOT, capture_output=True, text=True, check=True
    )
    entries = json.loads(listing.stdout)
    refused_before = {row["name"] for row in rows if row["end"] == "refused"}
    living, unviable, suites = build(work, sample(entries, count, seed), refused_before)
    suites = [timed(suite) for suite in suites]
    print(*(f"{suite.program.name}: {suite.seconds:.1f} s" for suite in suites), sep="\n", flush=True)
    with log.open("a", encoding="utf-8") as out, ThreadPoolExecutor(processes) as pool:
        for mutant, reason in unviable:
            if mutant.name not in known:
                row = {"name": mutant.name, "stratum": stratum(mutant.file), "end": "refused", "by": reason}
                out.write(json.dumps(row) + "\n")

        def one(mutant: Any) -> None:
            start = time.monotonic()
            by = tried(mutant, suites)
            row = {
                "name": mutant.name,
                "stratum": stratum(mutant.file),
                "end": "caught" if by else "survived",
                "by": by,
            }
            row["seconds"] = round(time.monotonic() - start, 1)
            out.write(json.dumps(row) + "\n")
            out.flush()
            print(row, flush=True)

        list(pool.map(one, [mutant for mutant in living if mutant.name not in known]))


def report(part: str, rows: list[dict[str, Any]]) -> None:
    """Write what is known of a part, "rust" or "python", beside the other: the table and the survivors."""
    document = json.loads(RESULTS.read_text("utf-8")) if RESULTS.is_file() else {"parts": {}}
    document["parts"][part] = sorted(rows, key=lambda row: str(row["name"]))
    reasons = tomllib.loads(REASONS.read_text("utf-8")) if REASONS.is_file() else {}
    table, survivors = (
        [f"{'':24} {'drawn':>6} {'refused':>8} {'caught':>7} {'survived':>9} {'caught, %':>10}"],
        [],
    )
    for name, every in document["parts"].items():
        strata = sorted({row["stratum"] for row in every})
        for label, members in [
            *((f"{name}, {one}", [row for row in every if row["stratum"] == one]) for one in strata),
            (f"{name}, all", every),
        ]:
            ends = Counter(row["end"] for row in members)
            tried = ends["caught"] + ends["survived"]
            table.append(
                f"{label:24} {len(members):6} {ends['refused']:8} {ends['caught']:7} {ends['survived']:9} "
                f"{100.0 * ends['caught'] / max(tried, 1):10.1f}"
            )
        survivors += [
            f"{row['name']}\n    {reasons.get(row['name'], 'not looked at')}"
            for row in every
            if row["end"] == "survived"
        ]
    document |= {"report": table, "at_length": survivors}
    RESULTS.write_text(json.dumps(document, indent=1) + "\n", "utf-8")
    print(*table, sep="\n")


def main() -> None:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--count", type=int, default=420)
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--processes", type=int, default=2)
    parser.add_argument("--work", type=Path, default=Path("/tmp/knobcam-mutants"))
    parser.add_argument("--again", action="store_true", help="what survived before is tried again")
    parser.add_argument("--report", action="store_true", help="no more than the report")
    told = parser.parse_args()
    told.work.mkdir(parents=True, exist_ok=True)
    if not told.report:
        run(told.work, told.count, told.seed, told.processes, told.again)
    report("rust", rows_of(told.work / "results.jsonl"))


if __name__ == "__main__":
    main()
