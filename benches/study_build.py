"""What a build costs: `python benches/study_build.py`, on a machine that does nothing else.

In a copy of the checkout: the extension from nothing, then what follows a change of one effect's law. Prints
seconds, and those of processors, and writes `benches/results/build.json`.
"""

import json
import os
import resource
import shutil
import subprocess
import tempfile
import time
from collections.abc import Iterator
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
RESULTS = ROOT / "benches" / "results" / "build.json"
EFFECT = Path("crates", "knobcore", "src", "effects", "quadratic_drag.rs")
# The same law in other words: what is compiled differs, what it computes does not.
LAW = ("Load::drive(*d * motion.omega", "Load::drive(T::of(1.0) * *d * motion.omega")
EXTENSION = ("build", "--locked", "--package", "knobpy")


def timed(copy: Path, *command: str) -> tuple[float, float]:
    """Seconds, and seconds of processor, that cargo takes."""
    before, start = resource.getrusage(resource.RUSAGE_CHILDREN), time.monotonic()
    subprocess.run(("cargo", *command), cwd=copy, check=True, capture_output=True)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    spent = after.ru_utime - before.ru_utime + after.ru_stime - before.ru_stime
    return time.monotonic() - start, spent


def change(copy: Path) -> None:
    """Say the law of one effect in other words, or in the words before."""
    text = (copy / EFFECT).read_text("utf-8")
    old, new = LAW if LAW[0] in text else LAW[::-1]
    (copy / EFFECT).write_text(text.replace(old, new), "utf-8")


def report(copy: Path) -> Iterator[str]:
    """A row per build."""
    subprocess.run(("cargo", "fetch", "--locked"), cwd=copy, check=True, capture_output=True)
    yield f"{'':62} {'s':>6} {'s of processor':>15}"

    def row(what: str, *command: str) -> str:
        print(what, flush=True)
        elapsed, spent = timed(copy, *command)
        return f"{what:62} {elapsed:6.1f} {spent:15.1f}"

    work, tests = (*EXTENSION, "--profile", "develop"), ("test", "--locked", "--package", "knobcore")
    yield row("extension from nothing, as in a wheel", *EXTENSION, "--release")
    yield row("extension from nothing, to work with", *work)
    change(copy)
    yield row("the same after one effect's law was changed", *work)
    timed(copy, *tests, "--no-run")
    change(copy)
    yield row("that effect's own tests after its law was changed", *tests, "--lib", EFFECT.stem)
    yield f"on {os.cpu_count()} processors, load {os.getloadavg()[0]:.1f} at the end"


def main() -> None:
    with tempfile.TemporaryDirectory() as folder:
        copy = Path(folder)
        shutil.copytree(ROOT / "crates", copy / "crates")
        for name in ("Cargo.toml", "Cargo.lock"):
            shutil.copy(ROOT / name, copy)
        lines = list(report(copy))
    print("\n".join(lines))
    RESULTS.write_text(json.dumps({"report": lines}, indent=1) + "\n", "utf-8")


if __name__ == "__main__":
    main()
