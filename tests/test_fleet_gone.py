"""Captures that are not there any more, results that lie among captures, limits of a batch that was ended."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pyarrow.parquet as pq
import pytest
from command import knobcam, refused
from small import recorded
from test_fleet_lots import several

import knobcam as kc
from knobcam.errors import InputError
from knobcam.fleet import BatchResult
from knobcam.fleet.judged import judged
from knobcam.fleet.limits import Limits
from knobcam.fleet.row import GONE
from knobcam.fleet.settings import Settings
from knobcam.fleet.sources import gone, sources
from knobcam.fleet.store import Store

LIMITS = "[parameters]\ncoulomb.pos = { min = 0.0, max = 0.0085 }"


@pytest.fixture
def lot(tmp_path: Path) -> Path:
    """A folder with two captures and what is none."""
    folder = tmp_path / "in"
    folder.mkdir()
    for number in (1, 2):
        recorded(number, count=1200).save(folder / f"{number}.npz")
    (folder / "bad.csv").write_text("nothing\n")
    return folder


@pytest.mark.usefixtures("undrawn")
def test_a_capture_that_is_gone_keeps_its_row_and_counts_no_more(lot: Path, tmp_path: Path):
    (tmp_path / "limits.toml").write_text(LIMITS)
    words = ("batch", lot, "-o", tmp_path / "r", "--learn", "none", "--limits", tmp_path / "limits.toml")
    first = knobcam(*words, "--json")
    assert first.code == 1 and first.document["not_ok"] == 2 and first.document["gone"] == 0
    for name in ("1.npz", "bad.csv"):
        (lot / name).unlink()
    ended = knobcam(*words, "--json")
    told = ended.document
    assert ended.code == 0
    assert [told[name] for name in ("captures", "gone", "failed", "not_ok")] == [1, 2, 0, 1]
    for ended in (knobcam(*words), knobcam("report", tmp_path / "r")):
        said = ended.out + ended.err
        assert (
            ended.code == 0
            and "1 captures" in said
            and "left out are 2 whose files are not there any more" in said
        )
        assert "bad.csv" not in said and "1.npz" not in said
    assert "left out are 2 whose" in (tmp_path / "r.html").read_text("utf-8")
    assert len(pq.read_table(tmp_path / "r")) == 3
    again = knobcam(*words, "--json", "--count-gone")
    assert again.document["captures"] == 3 and again.document["not_ok"] == 2 and again.code == 0


def test_a_capture_that_moved_is_no_duplicate_of_what_it_was_and_one_that_comes_back_counts(
    lot: Path, tmp_path: Path
):
    (lot / "bad.csv").unlink()
    kc.batch(lot, tmp_path / "r", learn="none")
    (lot / "1.npz").rename(lot / "3.npz")
    moved = {
        Path(row["capture"]).name: row["findings"] for row in kc.batch(lot, tmp_path / "r", learn="none").rows
    }
    assert moved["1.npz"] == [GONE] and moved["3.npz"] == []
    (lot / "3.npz").rename(lot / "1.npz")
    back = {
        Path(row["capture"]).name: row["findings"] for row in kc.batch(lot, tmp_path / "r", learn="none").rows
    }
    assert back["1.npz"] == [] and back["3.npz"] == [GONE]


def test_captures_of_other_sources_that_are_still_there_count(tmp_path: Path):
    for name in ("a", "b"):
        (tmp_path / name).mkdir()
        recorded(ord(name), count=1200).save(tmp_path / name / "1.npz")
        result = kc.batch(tmp_path / name, tmp_path / "r", learn="none")
    assert len(result.counted) == 2 and "1 of them of calls before" in result.headline
    recorded(ord("b"), count=1300).save(tmp_path / "b" / "2.npz")
    (tmp_path / "a" / "1.npz").unlink()
    assert [
        Path(row["capture"]).parent.name
        for row in kc.batch(tmp_path / "b", tmp_path / "r", learn="none").counted
    ] == [
        "b",
        "b",
    ]


def test_a_lot_whose_files_are_gone_moves_no_other_and_is_in_no_statistics():
    rng = np.random.default_rng(4)
    rows = several(rng, 20) + several(rng, 20, "B", coulomb=1.3)
    away = [row["capture"] for row in rows if row["lot"] == "B"]
    limits = Limits.parse(LIMITS, "limits", None, learned=True)
    told = judged(rows, limits, away)
    result = BatchResult(Path("r"), tuple(told), frozenset(), limits=limits)
    assert set(result.study.table["lot"]) == {"A"}
    assert not result.study.shifts and {one.lot for one in result.study.capability} == {"A"}
    every = BatchResult(Path("r"), tuple(judged(rows, limits)), frozenset(), limits=limits)
    assert every.study.shifts and {one.lot for one in every.study.capability} == {"A", "B"}


def test_results_that_lie_among_captures_are_no_captures(lot: Path):
    kc.batch(lot, lot / "results of before", learn="none")
    every = [lot, lot / "results of before"]
    assert [Path(one.name).name for one in sources([lot])] == ["1.npz", "2.npz", "bad.csv"]
    assert [one.name for one in sources(every)] == [one.name for one in sources([lot])]
    with pytest.raises(InputError, match="holds results of a batch, and no captures"):
        sources([lot / "results of before"])
    for command in (("batch",), ("watch", "--once")):
        ended = knobcam(*command, lot / "results of before", "-o", lot / "other")
        refused(ended, "holds results of a batch")


@pytest.mark.parametrize("words", [("", "-o", "r"), ("in", "-o", "")])
def test_an_empty_name_is_not_the_folder_that_one_is_in(
    words: tuple[str, ...], lot: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
):
    monkeypatch.chdir(tmp_path)
    for command in (("batch",), ("watch", "--once")):
        refused(knobcam(*command, *words), "is a variable of the shell empty?")
    assert [one.name for one in tmp_path.iterdir()] == [lot.name]


def test_results_behind_an_address_are_no_captures(tmp_path: Path):
    import fsspec

    store = fsspec.filesystem("memory")
    for name in ("a.csv", "r/_batch.json", "r/rows.parquet", "_parts/1.csv"):
        store.pipe(f"/line/{name}", b"nothing")
    found = sources(["memory://line"])
    assert [one.name for one in found] == ["memory:///line/a.csv"]
    known = {name: f"memory://{name}" for name in ("/line/a.csv", "/line/away.csv", "/other/away.csv")}
    assert found[0].labels == sources(["memory://line/a.csv"])[0].labels == {}
    # What lies where nobody looked is not asked for.
    assert gone({place: place for place in known.values()}, found, ["memory://line"]) == {
        known["/line/away.csv"]
    }


@pytest.mark.usefixtures("undrawn")
def test_a_batch_that_was_ended_is_judged_by_the_limits_that_it_was_given(tmp_path: Path):
    own = ("ok", "failed_limits", "failed_why", "outlier", "cause")
    raw = several(np.random.default_rng(6), 8)
    rows = [{name: value for name, value in row.items() if name not in own} for row in raw]
    old = Store(tmp_path / "r", Settings(), "[parameters]\ncoulomb.pos = { max = 1.0 }")
    old.put(rows[:4])
    old.finish(judged(rows[:4], Limits.parse(old.limits, "limits", None, learned=True)))
    old.close()
    limits = Limits.parse(LIMITS, "limits", None, learned=True)
    store = Store.open(tmp_path / "r", Settings(), limits)
    store.put(rows[4:])  # and here it ends
    store.close()
    read = BatchResult.read(tmp_path / "r")
    assert read.limits is not None and read.limits.text == LIMITS and read.unfinished
    beyond = {row["capture"] for row in rows if row["params"]["coulomb.pos"][0] > 0.0085}
    assert beyond and {row["capture"] for row in read.rows if row["ok"] is False} == beyond
    ended = knobcam("report", tmp_path / "r", "--json")
    assert json.loads(ended.out)["not_ok"] == len(beyond)
