"""A sample of planted faults, what became of each, and the tables of it."""

from __future__ import annotations

import hashlib
import json
import re
import time
import tomllib
from collections import Counter
from pathlib import Path
from typing import Any, TextIO

ROOT = Path(__file__).resolve().parents[1]
RESULTS = ROOT / "benches" / "results" / "mutants.json"
REASONS = ROOT / "benches" / "survivors.toml"
TELLING = 200  # of fewer, the shares by place say nothing
SAME = ("equivalent: ", "speed: ")  # reasons of those that answer as the original does, as soon or later


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


def keep(out: TextIO, name: str, file: str, by: str, start: float, **more: int) -> None:
    """Keep what became of one that was tried from `start` on, at once, and say it."""
    end = "caught" if by else "survived"
    row = {"name": name, "stratum": stratum(file), "end": end, "by": by, **more}
    row["seconds"] = round(time.monotonic() - start, 1)
    out.write(json.dumps(row) + "\n")
    out.flush()
    print(row, flush=True)


def rows_of(log: Path) -> list[dict[str, Any]]:
    """What a log has, of every mutant the last."""
    lines = log.read_text("utf-8").splitlines() if log.is_file() else []
    return list({row["name"]: row for row in map(json.loads, lines)}.values())


def report(part: str, rows: list[dict[str, Any]], note: str = "") -> None:
    """Write what is known of a part, "rust" or "python", beside the other: table, note, survivors."""
    document = json.loads(RESULTS.read_text("utf-8")) if RESULTS.is_file() else {"parts": {}}
    document["parts"][part] = sorted(rows, key=lambda row: str(row["name"]))
    document["notes"] = document.get("notes", {}) | {part: note}
    reasons = tomllib.loads(REASONS.read_text("utf-8")) if REASONS.is_file() else {}
    heads = f"{'drawn':>6} {'refused':>8} {'caught':>7} {'survived':>9} {'the same':>9} {'caught, %':>10}"
    table = [f"{'python benches/study_mutants.py':32} {heads} {'of others, %':>13}"]
    survivors = []
    for name, every in document["parts"].items():
        ends = Counter(row["end"] for row in every)
        left = [row["name"] for row in every if row["end"] == "survived"]
        same = sum(reasons.get(one, "").startswith(SAME) for one in left)
        numbers = f"{len(every):6} {ends['refused']:8} {ends['caught']:7} {len(left):9} {same:9}"
        shares = f"{_percent(every, 0):10.1f} {_percent(every, same):13.1f}"
        table.append(f"{name:32} {numbers} {shares}")
        if len(every) >= TELLING:
            strata = sorted({row["stratum"] for row in every})
            parts = [f"{one} {_percent([r for r in every if r['stratum'] == one], 0):.0f}" for one in strata]
            table.append(f"  caught by place, %: {', '.join(parts)}")
        survivors += [f"{one.removeprefix('crates/')}: {reasons.get(one, 'not looked at')}" for one in left]
    table += [f"{name}: {note}" for name, note in document["notes"].items() if note]
    document |= {"report": table, "at_length": survivors}
    RESULTS.write_text(json.dumps(document) + "\n", "utf-8")
    print(*table, sep="\n")


def _percent(rows: list[dict[str, Any]], same: int) -> float:
    """How many of what was tried was caught, but for some that do the same as what they replace."""
    ends = Counter(row["end"] for row in rows)
    return 100.0 * ends["caught"] / max(ends["caught"] + ends["survived"] - same, 1)
