"""Batches of many captures: what one costs, and whether what is planted in lots is found and named.

`python benches/study_fleet.py` makes lots of knobs by the second simulator, 30 000 samples each: friction
10 % higher in a lot, a play of 0.01 rad or a soft shaft in single parts, a station with 3 % too much torque.
`--cost` times batches instead: processor time a capture by a worker and by all that Dask does, and how much
faster two workers are than one, round by round in turns. `--whole --size 10000` is one batch of so many
captures by two workers, of which 2 % are learned, as a line has them: how long, and how much memory.
"""

import argparse
import resource
import tempfile
import time
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import psutil
import pyarrow as pa
import pyarrow.parquet as pq
from hidden.bodies import Contact
from hidden.chain import Chain, plain_knob
from hidden.loads import Loads
from hidden.motions import MOTIONS
from hidden.sensors import RATE_HZ, measured

import knobcam as kc
from knobcam.fleet import cluster
from knobcam.fleet.row import row_of
from knobcam.fleet.settings import Settings
from knobcam.fleet.sources import sources

SAMPLES = 30_000
FILE = 200  # captures in a file of a large batch
EMPTY = 2000  # captures that cost nothing but what Dask does for each
SPREAD = 0.02  # of a parameter from part to part, relative
FRICTION = ("coulomb_neg", "coulomb_pos")


def part(design: Loads, rng: np.random.Generator, fault: str = "") -> dict[str, Any]:
    """The columns of a capture of one part."""
    names = ("inertia", *FRICTION, "viscous_neg", "viscous_pos", "detent")
    knob = design._replace(**{name: getattr(design, name) * rng.normal(1.0, SPREAD) for name in names})
    if fault == "friction":
        knob = knob._replace(**{name: 1.1 * getattr(knob, name) for name in FRICTION})
    share, stiff = 0.7, 0.7 * knob.inertia * (2.0 * np.pi * 150.0) ** 2
    contact = None
    if fault == "backlash":
        stiff = max(stiff, 10.0 * knob.coulomb_pos / 0.01)
        contact = Contact(0.01, stiff, 0.8 * np.sqrt(share * knob.inertia * stiff), share)
    if fault == "compliance":
        stiff /= 9.0  # 50 Hz
        contact = Contact(0.0, stiff, 0.1 * np.sqrt(share * knob.inertia * stiff), share)
    track = MOTIONS["chirp"](rng, np.arange(SAMPLES) / RATE_HZ)
    tau, limit = Chain(knob, contact).torque(track)
    return measured(rng, track, 1.03 * tau if fault == "gain" else tau, limit)


def write(path: Path, parts: dict[str, dict[str, Any]], **labels: list[str]) -> None:
    """A Parquet file of captures with lists, compressed."""
    columns = {name: [one[name] for one in parts.values()] for name in next(iter(parts.values()))}
    pq.write_table(
        pa.table({"capture": list(parts), **labels, **columns}), path, compression="zstd", row_group_size=8
    )


def planted(seed: int, size: int, client: str | None) -> dict[str, Any]:
    """What a batch says of two lots and, in another one, of two stations."""
    rng = np.random.default_rng([seed, 19])
    design = plain_knob(rng, detents=True)
    single = ["backlash", "compliance"]
    parts = {f"A{at}": part(design, rng) for at in range(size)}
    parts |= {f"B{at}": part(design, rng, "friction") for at in range(size)}
    parts |= {fault: part(design, rng, fault) for fault in single}
    with tempfile.TemporaryDirectory() as folder:
        write(Path(folder, "lots.parquet"), parts, lot=[*"A" * size, *"B" * size, *"A" * len(single)])
        lots = kc.batch(Path(folder, "lots.parquet"), Path(folder, "lots"), scheduler=client)
        told = {f"1/{at}": part(design, rng) for at in range(size)}
        told |= {f"2/{at}": part(design, rng, "gain") for at in range(size)}
        write(Path(folder, "two.parquet"), told, station=[*"1" * size, *"2" * size])
        stations = kc.batch(Path(folder, "two.parquet"), Path(folder, "two"), scheduler=client)
    rows = {row["capture"]: row for row in (*lots.rows, *stations.rows)}
    moved = {one.parameter.partition(".")[0] for one in lots.study.shifts if one.by == "lot"}
    good = [row for name, row in rows.items() if name not in single]
    result: dict[str, Any] = {
        "friction": (bool(moved), moved == {"coulomb"} and not lots.study.gains),
        "gain": (bool(stations.study.shifts or stations.study.gains), bool(stations.study.gains)),
        "rejects": (sum(bool(row["found"]) or row["verdict"] == "unexplained" for row in good), len(good)),
        "outliers": (sum(bool(row["outlier"]) for row in good), len(good)),
    }
    return result | {name: (bool(rows[name]["outlier"]), rows[name]["found"] == [name]) for name in single}


def lots(first: int, rounds: int, size: int) -> None:
    """Print how often what was planted is found and named."""
    with cluster.workers(None) as client:
        told = [planted(seed, size, client.scheduler.address) for seed in range(first, first + rounds)]
    print(f"{rounds} rounds from seed {first}, {size} parts of each kind, {SAMPLES} samples each")
    for name in ("friction", "gain", "backlash", "compliance"):
        found, named = (sum(one[name][at] for one in told) for at in (0, 1))
        print(f"  {name:<11} found in {found} of {rounds}, named rightly in {named}")
    for name, what in (
        ("rejects", "good parts with something named or unexplained"),
        ("outliers", "good parts learned"),
    ):
        some, every = (sum(one[name][at] for one in told) for at in (0, 1))
        print(f"  {what}: {some} of {every}")


def cost(count: int, rounds: int) -> None:
    """Print what a capture costs, of processor time, and what a second worker brings."""
    rng = np.random.default_rng(5)
    design = plain_knob(rng, detents=True)
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        write(folder / "a.parquet", {f"{at:05d}": part(design, rng) for at in range(count)})
        size = (folder / "a.parquet").stat().st_size / count
        found = sources([folder / "a.parquet"])
        row_of(found[0], Settings(hints=False), False, None)
        begun = time.process_time()
        for one in found:
            row_of(one, Settings(hints=False), False, None)
        alone = (time.process_time() - begun) / count
        print(f"{count} captures of {SAMPLES} samples, {size / 1e3:.0f} kB each as Parquet with zstd")
        print(f"  read and fitted in this process: {1e3 * alone:.1f} ms of processor time a capture")
        empty = [replace(found[0], name=str(at), error="not read") for at in range(EMPTY)]
        for workers in (1, 2):  # the first is to have all imported
            own, others, _ = timed(empty, workers)
        print(f"  Dask in this process, with its scheduler: {1e3 * own / EMPTY:.2f} ms a capture")
        print(f"  Dask in the workers: {1e3 * others / EMPTY:.2f} ms a capture")
        spent: list[float] = []
        walls: dict[int, list[float]] = {1: [], 2: []}
        for _ in range(rounds):
            for workers in (1, 2):
                _, others, wall = timed(found, workers)
                spent.append(others / count)
                walls[workers].append(wall)
        print(f"  by workers: {1e3 * np.median(spent):.1f} ms of processor time a capture")
        ratio = [one / two for one, two in zip(walls[1], walls[2], strict=True)]
        ends = f"({min(ratio):.2f} to {max(ratio):.2f}), load {psutil.getloadavg()[0]:.1f}"
        print(f"  two workers are {np.median(ratio):.2f} times one {ends}")
        kc.batch(folder / "a.parquet", folder / "t", learn="none", hints=False)
        table = sum(one.stat().st_size for one in (folder / "t").rglob("*.parquet"))
        peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1e3
        print(f"  {table / count / 1e3:.1f} kB of table a capture, peak memory of this process {peak:.0f} MB")


def whole(count: int) -> None:
    """Print how long one batch of so many captures takes by two workers, and what memory it comes to."""
    rng = np.random.default_rng(6)
    design = plain_knob(rng, detents=True)
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        parts = {f"{at:03d}": part(design, rng, "" if at % 50 else "compliance") for at in range(FILE)}
        write(folder / "parts.parquet", parts)
        for lot in range(count // FILE):  # the same content under other names is work like any other
            (folder / "captures" / f"lot={lot}").mkdir(parents=True)
            (folder / "captures" / f"lot={lot}" / "parts.parquet").hardlink_to(folder / "parts.parquet")
        cluster.cores = lambda: 2
        begun = time.perf_counter()
        memory: list[tuple[float, float]] = []

        def look(_: str) -> None:
            if not memory or time.perf_counter() - begun - memory[-1][0] > 10.0:
                every = [psutil.Process(), *psutil.Process().children(recursive=True)]
                memory.append(
                    (time.perf_counter() - begun, sum(one.memory_info().rss for one in every) / 1e6)
                )

        result = kc.batch(folder / "captures", folder / "r", progress=look)
        took = time.perf_counter() - begun
        learned = sum(row["learned"] for row in result.rows)
        found = sum(row["found"] == ["compliance"] for row in result.rows)
        print(f"{len(result.rows)} captures of {SAMPLES} samples in {took / 60.0:.1f} min by two workers")
        print(
            f"  {learned} learned, {found} of {count // 50} named rightly, load {psutil.getloadavg()[0]:.1f}"
        )
        print(
            "  memory of all processes over time: " + ", ".join(f"{s:.0f} s {mb:.0f} MB" for s, mb in memory)
        )


def timed(found: list[Any], workers: int) -> tuple[float, float, float]:
    """Processor time of this process and of its workers, and wall time, while captures are worked on."""
    cluster.cores = lambda: workers
    with cluster.workers(None) as client:
        client.wait_for_workers(workers)
        tasks = [(one, None) for one in found]
        cluster.run(
            client, tasks[: 8 * workers], Settings(hints=False), False, lambda *_: None
        )  # all is imported
        inside = psutil.Process().children(recursive=True)
        before = sum(sum(one.cpu_times()[:2]) for one in inside)
        own, wall = time.process_time(), time.perf_counter()
        cluster.run(client, tasks, Settings(hints=False), False, lambda *_: None)
        wall, own = time.perf_counter() - wall, time.process_time() - own
        return own, sum(sum(one.cpu_times()[:2]) for one in inside) - before, wall


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--cost", action="store_true")
    parser.add_argument("--whole", action="store_true")
    parser.add_argument("--first", type=int, default=0, help="seed of the first round")
    parser.add_argument("--rounds", type=int, default=5)
    parser.add_argument("--size", type=int, default=20, help="parts of each kind; else captures")
    args = parser.parse_args()
    if args.whole:
        whole(args.size)
    elif args.cost:
        cost(args.size, args.rounds)
    else:
        lots(args.first, args.rounds, args.size)
