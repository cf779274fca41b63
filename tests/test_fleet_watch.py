"""A station: a part's row when its file is complete, and none lost or twice whatever ends the watch."""

from __future__ import annotations

import hashlib
import json
import signal
import subprocess
import sys
import threading
import time
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import Any

import pyarrow.parquet as pq
import pytest
from command import knobcam, refused
from small import recorded, rises

from knobcam.fleet.watch import PATIENCE_S, SETTLED_S, Watch


@pytest.fixture(scope="module")
def parts(tmp_path_factory: pytest.TempPathFactory) -> list[bytes]:
    """Files of captures: three of sound parts, and one of a part with friction that rises to standstill."""
    folder = tmp_path_factory.mktemp("parts")
    captures = [*(recorded(seed, count=1200) for seed in range(3)), recorded(9, rises)]
    return [one.save(folder / f"{number}.npz").read_bytes() for number, one in enumerate(captures)]


def started(folder: Path, results: Path, *words: str) -> subprocess.Popen[str]:
    command = [sys.executable, "-m", "knobcam", "watch", str(folder), "-o", str(results), *words]
    return subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)


def line(running: subprocess.Popen[str]) -> dict[str, Any]:
    assert running.stdout is not None
    told = json.loads(running.stdout.readline())
    assert isinstance(told, dict)
    return told


def test_a_station_that_is_killed_goes_on_and_a_file_that_grows_is_waited_for(
    parts: list[bytes], tmp_path: Path
):
    folder, results = tmp_path / "in", tmp_path / "results"
    folder.mkdir()
    (folder / "0.npz").write_bytes(parts[0])
    running = started(folder, results, "--learn", "none")
    first = line(running)
    assert (
        Path(first["capture"]).name == "0.npz" and first["error"] is None and first["verdict"] == "complete"
    )
    with (folder / "1.npz").open("wb") as file:
        for at in range(0, len(parts[1]), len(parts[1]) // 4 + 1):
            file.write(parts[1][at : at + len(parts[1]) // 4 + 1])
            file.flush()
            time.sleep(0.4 * SETTLED_S)
    second = line(running)
    assert second["sha256"] == hashlib.sha256(parts[1]).hexdigest() and second["error"] is None
    running.send_signal(signal.SIGKILL)
    running.communicate()

    (folder / "2.npz").write_bytes(parts[2])
    again = started(folder, results, "--learn", "none")
    assert Path(line(again)["capture"]).name == "2.npz"
    again.send_signal(signal.SIGINT)
    out, said = again.communicate(timeout=60.0)
    assert again.returncode == 0 and out == ""
    assert said == "3 captures, 1 of them fitted now; 3 complete.\n"
    assert len(pq.read_table(results)) == 3


def test_a_part_has_its_verdict_at_once_and_is_named_when_it_is_learned(parts: list[bytes], tmp_path: Path):
    (tmp_path / "odd.npz").write_bytes(parts[3])
    (tmp_path / "sound.npz").write_bytes(parts[0])
    limits = tmp_path / "_limits.toml"
    limits.write_text('[effects]\nforbidden = ["stribeck"]')
    watch = Watch.of(tmp_path, tmp_path / "_results", limits=limits)
    told = [(Path(row["capture"]).name, row["learned"], row["ok"]) for row in watch.rows(once=True)]
    assert told == [("odd.npz", False, True), ("sound.npz", False, True), ("odd.npz", True, False)]
    rows = {Path(row["capture"]).name: row for row in watch.finish().rows}
    assert rows["odd.npz"]["failed_limits"] == ["effects.stribeck"]
    assert "stribeck: " in rows["odd.npz"]["cause"]


def test_what_is_no_capture_is_a_line_that_says_so_and_the_exit_code_counts_it(
    parts: list[bytes], tmp_path: Path
):
    folder = tmp_path / "in"
    folder.mkdir()
    (folder / "bad.csv").write_text("nothing\n")
    (folder / "good.npz").write_bytes(parts[0])
    once = ("--once", "--learn", "none", "--patience", "0.5")
    ended = knobcam("watch", folder, "-o", tmp_path / "r", *once)
    told = {Path(row["capture"]).name: row["error"] for row in map(json.loads, ended.out.splitlines())}
    assert ended.code == 1
    assert told["good.npz"] is None and "bad.csv" in told["bad.csv"]
    again = knobcam("watch", folder, "-o", tmp_path / "r", "--once", "--json")
    assert again.code == 0 and again.document["captures"] == 2 and again.document["fresh"] == 0
    refused(knobcam("watch", tmp_path / "none", "-o", tmp_path / "r"), "is no folder")
    refused(knobcam("watch", folder, "-o", tmp_path / "r", "--patience", "-1"), "patience_s=-1", "is no time")


@pytest.mark.parametrize("open_meanwhile", [True, False])
def test_a_part_that_is_half_written_for_a_second_is_told_once_and_whole(
    open_meanwhile: bool, parts: list[bytes], tmp_path: Path
):
    folder = tmp_path / "in"
    folder.mkdir()
    watch = Watch.of(folder, tmp_path / "r", learn="none")
    told: list[tuple[float, dict[str, Any]]] = []

    def station() -> None:
        for row in watch.rows():
            told.append((time.monotonic(), row))

    threading.Thread(target=station, daemon=True).start()
    half = len(parts[0]) // 2
    file = (folder / "0.npz").open("wb")
    file.write(parts[0][:half])
    file.flush()
    if not open_meanwhile:
        file.close()
    time.sleep(4.0 * SETTLED_S)
    assert not told
    file = file if open_meanwhile else (folder / "0.npz").open("ab")
    file.write(parts[0][half:])
    file.close()
    whole = time.monotonic()
    while not told and time.monotonic() - whole < 60.0:
        time.sleep(0.05)
    time.sleep(4.0 * SETTLED_S)
    (when, row), *more = told
    assert not more and row["sha256"] == hashlib.sha256(parts[0]).hexdigest() and row["error"] is None
    assert when - whole < PATIENCE_S  # by then it would be told as it is


def test_rows_of_text_that_a_recorder_still_writes_are_no_shorter_part(tmp_path: Path):
    lines = (
        (recorded(1, count=1200).save(tmp_path / "whole.csv")).read_text("utf-8").splitlines(keepends=True)
    )
    folder = tmp_path / "in"
    folder.mkdir()
    with (folder / "0.csv").open("w") as file:
        file.writelines(lines[:900])
        file.flush()
        watch = Watch.of(folder, tmp_path / "r", learn="none")
        told = watch.rows(once=True)
        waits = ThreadPoolExecutor(1).submit(next, told)
        time.sleep(4.0 * SETTLED_S)
        assert not waits.done()
        file.writelines(lines[900:])
    assert waits.result(60.0)["samples"] == 1200


def test_a_file_that_a_recorder_never_closes_is_told_when_patience_ends(parts: list[bytes], tmp_path: Path):
    with (tmp_path / "0.npz").open("wb") as file:
        file.write(parts[0])
        file.flush()
        watch = Watch.of(tmp_path, tmp_path / "_r", learn="none", patience_s=2.0 * SETTLED_S)
        (row,) = watch.rows(once=True)
    assert row["error"] is None and row["verdict"] == "complete"


@pytest.mark.usefixtures("undrawn")
def test_parts_that_were_taken_away_from_a_station_still_count(parts: list[bytes], tmp_path: Path):
    folder = tmp_path / "in"
    folder.mkdir()
    for number in range(2):
        (folder / f"{number}.npz").write_bytes(parts[number])
    words = ("watch", folder, "-o", tmp_path / "r", "--once", "--learn", "none", "--json")
    knobcam(*words)
    (folder / "0.npz").unlink()
    (folder / "2.npz").write_bytes(parts[2])
    assert knobcam(*words).document["captures"] == 3
    assert knobcam("report", tmp_path / "r", "--json").document["captures"] == 3
