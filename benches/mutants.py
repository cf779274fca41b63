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
    head = f"{'python benches/study_mutants.py':32}"
    table, survivors = (
        [f"{head} {'drawn':>6} {'refused':>8} {'caught':>7} {'survived':>9} {'caught, %':>10}"],
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
                f"{label:32} {len(members):6} {ends['refused']:8} {ends['caught']:7} {ends['survived']:9} "
                f"{100.0 * ends['caught'] / max(tried, 1):10.1f}"
            )
        survivors += [
            f"{row['name'].removeprefix('crates/')}: {reasons.get(row['name'], 'not looked at')}"
            for row in every
            if row["end"] == "survived"
        ]
    table += [f"{name}: {note}" for name, note in document["notes"].items() if note]
    document |= {"report": table, "at_length": survivors}
    RESULTS.write_text(json.dumps(document) + "\n", "utf-8")
    print(*table, sep="\n")
