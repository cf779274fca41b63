"""Writes BENCHMARKS.md and docs/measured.md from what this machine measures: `python benches/report.py`.

The statistical part comes from `benches/results`, which the `benches/study_*.py` write; `--studies` writes
that part alone and leaves the figures of speed as they stand. What was written by hand beside a table stays.
"""

import argparse
import json
import os
import platform
import re
import sys
from collections.abc import Iterator, Sequence
from pathlib import Path

# One thread each: NumPy's matrix products of this size are faster so, and our fit has one thread.
THREADS = "OPENBLAS_NUM_THREADS"

ROOT = Path(__file__).resolve().parents[1]
STUDIES = {
    "table2": "The paper's Table 2",
    "basin": "No starting values",
    "rig": "Random knobs under the rig's sensors",
    "hidden": "Knobs with something hidden in them",
    "strata": "One and two effects, from weak to strong, and peers",
    "logs": "Logs with faults",
    "capture": "Recording",
    "render": "Rendering",
    "faults": "Faults, and what came of them",
    "page": "The workbench in a browser",
    "build": "Building",
    "mutants": "Faults planted by a machine",
}
# Those whose tables are long have a page of their own, as have the single cases of others.
AT_LENGTH = {
    "strata": "One and two effects, each and by pair",
    "logs": "Logs with faults, not answered as they should be",
    "pairs": "Every effect in every knob",
    "roundtrip": "Round trips",
    "safety": "Limits of the rig",
    "versions": "Speed before and after",
    "sets": "Speed by instruction set",
    "mutants": "Faults planted by a machine that no test noticed",
}


def machine() -> str:
    """Processor, cores, versions."""
    import lmfit
    import numba
    import numpy
    import scipy

    lines = Path("/proc/cpuinfo").read_text("utf-8").splitlines()
    name = next((line.split(":")[1].strip() for line in lines if line.startswith("model name")), "unknown")
    versions = ", ".join(f"{m.__name__} {m.__version__}" for m in (numpy, scipy, lmfit, numba))
    return (
        f"{name}, {os.cpu_count()} cores, {platform.system()} {platform.machine()}, "
        f"Python {platform.python_version()}, {versions}. Load when measured: {os.getloadavg()[0]:.1f}."
    )


def table(head: Sequence[str], rows: Sequence[Sequence[str]]) -> Iterator[str]:
    yield "| " + " | ".join(head) + " |"
    yield "|" + "---|" * len(head)
    for row in rows:
        yield "| " + " | ".join(row) + " |"


def ratios() -> list[tuple[str, ...]]:
    import bench_bootstrap
    import bench_filter
    import bench_fit
    import bench_process
    import bench_render

    cells = []
    for bench in (bench_filter, bench_fit, bench_bootstrap, bench_process, bench_render):
        for row in bench.rows():
            print(row, file=sys.stderr)
            reach = "" if row.reach is None else f"{row.reach:g}"
            verdict = "" if row.reach is None else "yes" if row.times >= row.reach else "**no**"
            ours, peer = (f"{1e3 * seconds:.4g} ms" for seconds in (row.ours_s, row.peer_s))
            cells.append((row.work, row.peer, ours, peer, f"{row.times:.3g}", reach, verdict))
    return cells


def lines() -> Iterator[str]:
    import bench_memory

    yield "# Measured"
    yield ""
    made = " && ".join(
        f"python benches/{name}.py"
        for name in (
            "study_recovery",
            "study_hidden",
            "study_strata",
            "study_logs",
            "study_capture",
            "study_render",
            "study_roundtrip",
            "study_page",
            "report",
        )
    )
    yield f"Made by `{made}`. {machine()} Longer tables: [measured, at length](docs/measured.md)."
    yield ""
    yield "## Speed"
    yield ""
    yield "Least times over interleaved rounds in one run, answers checked first. `times` is how many times"
    yield "longer the peer takes, `to reach` the least that was aimed at. One BLAS thread each."
    yield ""
    yield from table(("work", "peer", "knobcam", "peer's", "times", "to reach", "reached"), ratios())
    yield ""
    yield "## Length"
    yield ""
    yield "Fits of longer captures, each in a process of its own: time and memory grow as the length does."
    yield ""
    yield from table(bench_memory.HEAD, [g.cells for g in bench_memory.growth()])
    yield ""


def renewed(page: str, titles: dict[str, str], part: str, fence: str) -> str:
    """A page with the table of each study that was held, that part of its results or else the report, anew.

    What was written beside a table, and whatever section is of no study, stays.
    """
    for name, title in titles.items():
        results = ROOT / "benches" / "results" / f"{name}.json"
        if not results.is_file():
            continue
        document = json.loads(results.read_text("utf-8"))
        told = "\n".join(document.get(part, document["report"])).splitlines()
        table = "\n".join([fence, *(line.rstrip() for line in told), "```"])
        head = f"\n## {title}\n"
        start = page.find(head)
        if start < 0:
            page = f"{page.rstrip()}\n{head}\n{table}\n"
            continue
        end = page.find("\n## ", start + len(head))
        end = len(page) if end < 0 else end
        section, there = re.subn(
            r"```.*?\n```", lambda _, new=table: new, page[start:end], count=1, flags=re.S
        )
        if not there:
            section = f"{page[start:end].rstrip()}\n\n{table}\n"
        page = page[:start] + section + page[end:]
    return page


def write_studies(timed: str = "") -> None:
    """Write both pages, with the figures of speed as they stand or as they were `timed`."""
    page = ROOT / "BENCHMARKS.md"
    first = f"## {next(iter(STUDIES.values()))}"
    before, _, rest = page.read_text("utf-8").partition(first)
    written = (timed or before) + first + rest
    page.write_text(renewed(written, STUDIES, "report", "```"), "utf-8")
    longer = ROOT / "docs" / "measured.md"
    # A page of the site says what each block is.
    longer.write_text(renewed(longer.read_text("utf-8"), AT_LENGTH, "at_length", "```text"), "utf-8")


def main() -> None:
    parser = argparse.ArgumentParser(description="The pages of figures.")
    parser.add_argument("--studies", action="store_true", help="the studies' tables alone, nothing is timed")
    if parser.parse_args().studies:
        write_studies()
        return
    if os.environ.get(THREADS) != "1":
        os.environ[THREADS] = "1"
        os.execv(sys.executable, [sys.executable, *sys.argv])  # NumPy reads it when it is loaded
    write_studies("\n".join(lines()) + "\n")


if __name__ == "__main__":
    main()
