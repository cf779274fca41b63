"""Two versions on the same work, in turn: `python benches/study_versions.py OTHER [--rounds N]`.

OTHER is a checkout of another version. Both have their extension as a wheel has it, of the release profile:
what `dev.py setup` builds to work with takes a tenth longer a step. Prints every line of the speed table for
both and writes `benches/results/versions.json`.
"""

import argparse
import json
import os
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
RESULTS = ROOT / "benches" / "results" / "versions.json"
BENCHES = ("bench_filter", "bench_fit", "bench_bootstrap", "bench_process", "bench_render")
# What a version says of itself: its own benches, on its own package.
ASK = "import json, sys\nfor row in __import__(sys.argv[1]).rows():\n print(json.dumps(row))"


def measured(checkout: Path, bench: str) -> dict[tuple[str, str], float]:
    """Seconds that a version takes for each work of a bench, beside each peer."""
    places = os.pathsep.join(str(checkout / folder) for folder in ("python", "benches"))
    # One thread each, as for the speed table.
    environment = os.environ | {"PYTHONPATH": places, "OPENBLAS_NUM_THREADS": "1"}
    command = [sys.executable, "-c", ASK, bench]
    out = subprocess.check_output(command, cwd=checkout, env=environment, text=True)
    rows = (json.loads(line) for line in out.splitlines())
    return {(work, peer): ours_s for work, peer, ours_s, *_ in rows}


def report(other: Path, rounds: int) -> Iterator[str]:
    """The least time of each version over all rounds."""
    best: dict[Path, dict[tuple[str, str], float]] = {other: {}, ROOT: {}}
    for bench in BENCHES:
        for turn in range(rounds):
            for checkout, least in best.items():
                print(f"{bench}: round {turn + 1} of {rounds}, {checkout}", file=sys.stderr, flush=True)
                for key, seconds in measured(checkout, bench).items():
                    least[key] = min(seconds, least.get(key, seconds))
    yield f"least of {rounds} rounds of each version in turn, ms: before, now, now / before"
    for (work, peer), now in best[ROOT].items():
        before = best[other].get((work, peer))
        if before is not None:
            name = f"{work}, beside {peer}"
            yield f"{name:90} {1e3 * before:9.3f} {1e3 * now:9.3f} {now / before:6.2f}"


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("other", type=Path)
    parser.add_argument("--rounds", type=int, default=3)
    asked = parser.parse_args()
    lines = list(report(asked.other.resolve(), asked.rounds))
    print("\n".join(lines))
    RESULTS.write_text(json.dumps({"report": lines}, indent=1) + "\n", "utf-8")


if __name__ == "__main__":
    main()
