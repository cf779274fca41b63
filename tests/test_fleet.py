"""A batch: a row a capture, whatever a file is, whatever ends it, on one machine or on a cluster."""

from __future__ import annotations

import asyncio
import errno
import gc
import json
import os
import shutil
import signal
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path

import numpy as np
import psutil
import pyarrow as pa
import pyarrow.parquet as pq
import pytest
from command import knobcam, refused
from small import NAMES, recorded, rises

import knobcam as kc
from knobcam.base.ended import heard
from knobcam.fleet.cluster import workers

COUNT = 1200
"""Samples: few, as a batch is about many captures and not about long ones."""


def part(seed: int, friction: float = 0.0, **how: object) -> kc.Capture:
    """A knob of a lot: its friction differs a little from its neighbours', by what is given more."""
    own = 2e-4 * np.random.default_rng(seed).standard_normal() + friction
    return recorded(seed, lambda t, theta, omega, alpha: own * np.sign(omega), count=COUNT)


@pytest.fixture(scope="module")
def lot(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Ten knobs, one of them with friction that rises towards standstill, and what is no capture."""
    folder = tmp_path_factory.mktemp("fleet") / "lot=7" / "station=2"
    folder.mkdir(parents=True)
    for seed in range(9):
        part(seed).save(folder / f"k{seed}.npz")
    recorded(9, rises, count=2500).save(folder / "k9.npz")
    shutil.copy(folder / "k0.npz", folder / "l0.npz")
    (folder / "half.npz").write_bytes((folder / "k1.npz").read_bytes()[:9000])
    (folder / "notes.txt").write_text("torque wrench was recalibrated\n")
    return folder.parents[1]


@contextmanager
def cluster(folder: Path, workers: int) -> Iterator[tuple[str, list[subprocess.Popen[bytes]]]]:
    """A scheduler of Dask and some workers, each a process of its own."""
    file = folder / "scheduler.json"
    about = ("--no-dashboard", "--scheduler-file", str(file))
    running = [started("scheduler", "--port", "0", "--host", "127.0.0.1", *about)]
    try:
        wait_for(file.is_file)
        running += [started("worker", "--nthreads", "1", "--no-nanny", *about) for _ in range(workers)]
        yield json.loads(file.read_text())["address"], running
    finally:
        for one in running[::-1]:
            one.terminate()
            one.wait(20.0)


@pytest.fixture(scope="module")
def scheduler(tmp_path_factory: pytest.TempPathFactory) -> Iterator[str]:
    with cluster(tmp_path_factory.mktemp("dask"), 2) as (address, _):
        yield address


def started(what: str, *words: str) -> subprocess.Popen[bytes]:
    module, nowhere = f"distributed.cli.dask_{what}", subprocess.DEVNULL
    return subprocess.Popen([sys.executable, "-m", module, *words], stdout=nowhere, stderr=nowhere)


def wait_for(true: Callable[[], object], seconds: float = 60.0) -> None:
    until = time.monotonic() + seconds
    while not true():
        assert time.monotonic() < until
        time.sleep(0.02)


def table_of(folder: Path) -> list[dict[str, object]]:
    return pq.read_table(folder).to_pylist()  # type: ignore[no-any-return]


def bytes_of(folder: Path) -> dict[str, bytes]:
    return {str(one.relative_to(folder)): one.read_bytes() for one in sorted(folder.rglob("*.parquet"))}


@pytest.fixture(scope="module")
def done(lot: Path, scheduler: str, tmp_path_factory: pytest.TempPathFactory) -> kc.BatchResult:
    folder = tmp_path_factory.mktemp("done") / "results"
    return kc.batch(lot, folder, scheduler=scheduler)


def test_every_file_is_a_row_and_what_is_none_says_why(lot: Path, done: kc.BatchResult):
    rows = {Path(str(row["capture"])).name: row for row in table_of(done.folder)}
    assert sorted(rows) == sorted(one.name for one in lot.rglob("*.*"))
    assert {name for name, row in rows.items() if row["error"]} == {"half.npz", "notes.txt"}
    assert "notes.txt" in str(rows["notes.txt"]["error"])
    good = rows["k3.npz"]
    assert (good["lot"], good["station"], good["verdict"]) == ("7", "2", "complete")
    assert good["ok"] is None and good["failed_limits"] == []
    assert good["inertia.M.lo"] < good["inertia.M"] < good["inertia.M.hi"]  # type: ignore[operator]
    assert good["samples"] == COUNT and good["version"] == kc.__version__


def test_a_row_has_the_numbers_of_a_fit(lot: Path, done: kc.BatchResult):
    path = next(lot.rglob("k3.npz"))
    fitted = kc.fit(path)
    row = next(one for one in done.rows if one["capture"] == str(path))
    assert row["rmse"] == fitted.rmse and row["noise_floor"] == fitted.noise_floor
    for name, estimate in fitted.params.items():
        assert row["params"][name] == [estimate.value, *estimate.ci95]


def test_what_is_unlike_its_lot_is_learned_and_named(done: kc.BatchResult):
    rows = {Path(str(row["capture"])).name: row for row in done.rows}
    odd = rows["k9.npz"]
    assert odd["learned"] and "stribeck" in odd["found"]
    assert "stribeck" in odd["cause"]
    assert not rows["k3.npz"]["learned"]
    assert "duplicate" in rows["l0.npz"]["findings"] and "duplicate" not in rows["k0.npz"]["findings"]


def test_a_batch_that_was_done_is_not_done_again_and_one_that_changed_is(
    lot: Path, scheduler: str, tmp_path: Path
):
    some = tmp_path / "some"
    shutil.copytree(lot, some)
    first = kc.batch(some, tmp_path / "results", scheduler=scheduler, learn="none")
    assert first.fresh == len(first.rows)
    before = bytes_of(tmp_path / "results")
    again = kc.batch(some, tmp_path / "results", scheduler=scheduler, learn="none")
    assert again.fresh == 0 and bytes_of(tmp_path / "results") == before
    part(77).save(next(some.rglob("k3.npz")))
    third = kc.batch(some, tmp_path / "results", scheduler=scheduler, learn="none")
    assert third.fresh == 1


def test_a_run_killed_in_its_midst_goes_on_and_ends_in_the_same_bytes(
    lot: Path, scheduler: str, done: kc.BatchResult, tmp_path: Path
):
    words = [sys.executable, "-m", "knobcam", "batch", str(lot), "-o", str(tmp_path / "results")]
    running = subprocess.Popen([*words, "--scheduler", scheduler], start_new_session=True)
    parts = tmp_path / "results" / "_parts"
    wait_for(lambda: parts.is_dir() and any(parts.glob("*.json")))
    running.send_signal(signal.SIGKILL)
    running.wait()
    on = kc.batch(lot, tmp_path / "results", scheduler=scheduler)
    assert on.fresh < len(on.rows)
    assert bytes_of(tmp_path / "results") == bytes_of(done.folder)


def test_an_interrupt_that_a_finaliser_swallows_is_raised_again_and_not_printed(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    printed: list[object] = []
    monkeypatch.setattr(sys, "unraisablehook", lambda ignored: printed.append(ignored.exc_type))

    class Future:
        def __del__(self) -> None:
            signal.raise_signal(signal.SIGINT)

    class Broken:
        def __del__(self) -> None:
            raise ValueError("said")

    with heard() as check, pytest.raises(KeyboardInterrupt):
        Future()
        Broken()
        check()
    assert printed == [ValueError]


def test_a_wait_that_a_closing_loop_forgets_is_told_to_nobody(
    scheduler: str, caplog: pytest.LogCaptureFixture
) -> None:
    kept = []

    async def wait() -> None:
        kept.append(asyncio.get_running_loop().create_future())
        kept[-1].set_exception(TimeoutError("Timeout"))

    for address in (None, scheduler):
        with workers(address) as client:
            client.sync(wait)
    assert len(kept) == 2
    kept.clear()
    gc.collect()
    assert not [one for one in caplog.records if one.name == "asyncio"]


def test_ctrl_c_keeps_what_is_done_and_a_killed_worker_costs_no_more_than_what_it_was_at(tmp_path: Path):
    # So many that a batch is not at its end before a worker was killed and the other went on.
    for seed in range(40):
        saved = part(100 + seed).save(tmp_path / f"{seed:02d}.npz")
        for again in range(9):
            shutil.copy(saved, tmp_path / f"{seed:02d}-{again}.npz")
    words = [sys.executable, "-m", "knobcam", "batch", str(tmp_path), "-o", str(tmp_path / "_results")]
    running = subprocess.Popen(
        [*words, "--learn", "all"], start_new_session=True, stderr=subprocess.PIPE, text=True
    )

    def parts() -> int:
        return len(list(tmp_path.glob("_results/_parts/*.json")))

    wait_for(parts)
    crew = psutil.Process(running.pid).children()[0]
    before = parts()
    crew.children()[0].kill()
    # A worker comes anew first, and a machine that is busy otherwise takes a minute for two parts.
    wait_for(lambda: parts() > before + 1, seconds=300.0)
    os.killpg(running.pid, signal.SIGINT)
    _, said = running.communicate(timeout=60.0)
    assert running.returncode == 130
    assert said.startswith("knobcam: interrupted; the rows of ") and said.count("\n") == 1
    rows = kc.BatchResult.read(tmp_path / "_results").rows
    assert 0 < len(rows) < 400 and not any(row["error"] for row in rows)
    psutil.wait_procs([crew], timeout=10.0)
    assert not crew.is_running()


@pytest.mark.filterwarnings("ignore::pytest.PytestUnraisableExceptionWarning")  # what Python says of it
def test_an_interrupt_that_a_finaliser_swallows_ends_a_batch_all_the_same(lot: Path, tmp_path: Path):
    class Ends:
        def __del__(self) -> None:
            signal.raise_signal(signal.SIGINT)

    def told(words: str) -> None:
        if words.startswith("fitting") and " of " in words:
            Ends()

    with pytest.raises(KeyboardInterrupt, match="captures are kept; the same command goes on from there"):
        kc.batch(lot, tmp_path / "results", progress=told)
    assert signal.getsignal(signal.SIGINT) is signal.default_int_handler


def test_a_scheduler_that_goes_away_costs_one_line_and_nothing_that_was_done(tmp_path: Path):
    for seed in range(30):
        part(seed).save(tmp_path / f"{seed:02d}.npz")
    with cluster(tmp_path, 1) as (address, processes):
        words = ["batch", str(tmp_path / "*.npz"), "-o", str(tmp_path / "r"), "--learn", "all"]
        command = [sys.executable, "-m", "knobcam", *words, "--scheduler", address]
        running = subprocess.Popen(command, stderr=subprocess.PIPE, text=True)
        wait_for(lambda: any(tmp_path.glob("r/_parts/*.json")))
        processes[0].kill()
        _, said = running.communicate(timeout=60.0)
    assert running.returncode == 1
    assert said.startswith("knobcam: the scheduler went away; the rows of ") and said.count("\n") == 1
    assert len(kc.BatchResult.read(tmp_path / "r").rows) > 0


def test_a_full_disk_is_one_line_and_what_was_kept_stays(
    lot: Path, scheduler: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
):
    """The disk is full when the table is written: its rows stand in parts by then."""
    words = ("batch", lot, "-o", tmp_path / "r", "--scheduler", scheduler, "--learn", "none")

    def full(*_: object, **__: object) -> None:
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))

    with monkeypatch.context() as patched:
        patched.setattr(pq, "write_table", full)
        refused(knobcam(*words), "rows.parquet", "No space left")
    assert len(kc.BatchResult.read(tmp_path / "r").rows) == 13
    assert knobcam(*words, "--json").document["fresh"] == 0


def test_captures_lie_in_parquet_datasets_with_a_key(lot: Path, scheduler: str, tmp_path: Path):
    captures = {f"knob {seed}": part(seed) for seed in range(3)}
    columns = {
        name: np.concatenate([getattr(one, at) for one in captures.values()]) for at, name in NAMES.items()
    }
    keys = np.repeat(list(captures), COUNT)
    lots = np.repeat(["a", "a", "b"], COUNT)
    pq.write_table(
        pa.table({"capture": keys, "lot": lots, **columns}), tmp_path / "x.parquet", row_group_size=1000
    )
    whole = kc.batch(tmp_path / "x.parquet", tmp_path / "r", scheduler=scheduler, learn="none")
    assert [row["capture"] for row in whole.rows] == list(captures)
    assert [row["lot"] for row in whole.rows] == ["a", "a", "b"]
    assert [row["rmse"] for row in whole.rows] == [kc.fit(one).rmse for one in captures.values()]

    lists = {name: [getattr(one, at) for one in captures.values()] for at, name in NAMES.items()}
    pq.write_table(pa.table({"capture": list(captures), **lists}), tmp_path / "y.parquet")
    other = kc.batch(tmp_path / "y.parquet", tmp_path / "s", scheduler=scheduler, learn="none")
    assert [row["params"] for row in other.rows] == [row["params"] for row in whole.rows]
    lists["tau_Nm"] = [[None, *some[1:].tolist()] for some in lists["tau_Nm"]]
    pq.write_table(pa.table({"capture": list(captures), **lists}), tmp_path / "z.parquet")
    with_gaps = kc.batch(tmp_path / "z.parquet", tmp_path / "u", scheduler=scheduler, learn="none")
    assert [(row["error"], row["masked"]) for row in with_gaps.rows] == 3 * [(None, 1)]


def test_the_command_answers_in_one_document_and_counts_what_failed(
    lot: Path, scheduler: str, tmp_path: Path
):
    ended = knobcam("batch", lot, "-o", tmp_path / "r", "--scheduler", scheduler, "--learn", "none", "--json")
    assert ended.code == 1
    assert ended.document["failed"] == 2 and ended.document["captures"] == 13
    assert "2 of 13 captures failed" in ended.err


def test_wrong_calls_are_one_line_and_write_nothing(lot: Path, tmp_path: Path):
    results = tmp_path / "results"
    refused(knobcam("batch", tmp_path / "none", "-o", results), "none", "check the name")
    refused(knobcam("batch", lot, "-o", lot), "not empty")
    refused(knobcam("batch", lot, "-o", results, "--scheduler", "tcp://127.0.0.1:9"), "--scheduler")
    limits = tmp_path / "limits.toml"
    limits.write_text("[parameters]\nbacklash.gap = { max = 0.01 }\n")
    refused(knobcam("batch", lot, "-o", results, "--limits", limits), "backlash.gap", "the model has no such")
    assert not results.exists()
