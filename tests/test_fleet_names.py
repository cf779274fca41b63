"""Names of a folder that are no files: each is a row that says why, and the rest is done."""

from __future__ import annotations

import os
import sys
from collections.abc import Iterator
from pathlib import Path

import pyarrow.parquet as pq
import pytest
from command import knobcam, refused
from small import recorded

import knobcam as kc
from knobcam.errors import InputError
from knobcam.fleet.sources import sources
from knobcam.fleet.watch import Watch


@pytest.fixture
def mess(tmp_path: Path) -> Iterator[Path]:
    """One good capture, a link to nowhere, a link back, a link to itself, a pipe."""
    folder = tmp_path / "mess"
    folder.mkdir()
    recorded(1, count=1200).save(folder / "good.npz")
    (folder / "dangling.npz").symlink_to("/nowhere/at/all.npz")
    (folder / "loop").symlink_to("..")
    (folder / "self.npz").symlink_to("self.npz")
    os.mkfifo(folder / "pipe.npz")
    return folder


BAD = {
    "dangling.npz": "No such file",
    "loop": "link back to a folder that it lies in",
    "pipe.npz": "is a pipe, not a file",
    "self.npz": "cannot be read",
}


def test_a_name_that_is_no_file_is_a_row_that_says_why_and_the_rest_is_done(mess: Path, tmp_path: Path):
    ended = knobcam("batch", mess, "-o", tmp_path / "r", "--learn", "none", "--json")
    assert ended.code == 1 and "4 of 5 captures failed" in ended.err
    errors = {Path(row["capture"]).name: row["error"] for row in pq.read_table(tmp_path / "r").to_pylist()}
    assert errors.pop("good.npz") is None and errors.keys() == BAD.keys()
    for name, words in BAD.items():
        assert words in errors[name] and str(mess / name) in errors[name]


def test_a_station_is_not_blinded_by_a_name_that_is_no_file(mess: Path, tmp_path: Path):
    watch = Watch.of(mess, tmp_path / "r", learn="none")
    told = {Path(row["capture"]).name: row["error"] for row in watch.rows(once=True)}
    watch.finish()
    assert told.pop("good.npz") is None and told.keys() == BAD.keys()


def test_a_capture_that_became_a_pipe_since_its_row_was_made_is_not_waited_for(tmp_path: Path):
    folder = tmp_path / "in"
    folder.mkdir()
    for seed in range(2):
        recorded(seed, count=1200).save(folder / f"{seed}.npz")
    assert not kc.batch(folder, tmp_path / "r", learn="none").failed
    (folder / "1.npz").unlink()
    os.mkfifo(folder / "1.npz")
    assert len(kc.batch(folder, tmp_path / "r", learn="none").failed) == 1


def test_names_that_a_shell_made_of_a_pattern_are_rows_too_and_a_wrong_name_is_a_wrong_call(mess: Path):
    every = sources(sorted(mess.iterdir()))
    assert {Path(one.name).name for one in every if one.error} == BAD.keys() and len(every) == len(BAD) + 1
    refused(knobcam("batch", mess / "none.npz", "-o", mess / "_r"), "none.npz", "check the name")


def test_two_folders_that_lead_to_each_other_are_gone_through_once(tmp_path: Path):
    for name, other in (("a", "b"), ("b", "a")):
        (tmp_path / name).mkdir()
        (tmp_path / name / "on").symlink_to(f"../{other}")
        (tmp_path / name / f"{name}.npz").write_bytes(b"")
    names = [str(Path(one.name).relative_to(tmp_path)) for one in sources([tmp_path]) if one.error is None]
    assert names == ["a/a.npz", "a/on/b.npz", "b/b.npz", "b/on/a.npz"]


@pytest.mark.skipif(sys.platform != "linux", reason="other systems have no name that is not UTF-8")
def test_a_name_that_is_not_utf_8_is_read_and_written_with_its_bytes_as_escapes(tmp_path: Path):
    folder = os.fsencode(tmp_path / "in") + b"/lot=\xf6"
    os.makedirs(folder)  # noqa: PTH103 - a name of bytes
    good = recorded(1, count=1200).save(tmp_path / "k.npz").read_bytes()
    for name, content in ((b"knob\xf6b.npz", good), (b"not\xf6.csv", b"nothing\n")):
        with open(folder + b"/" + name, "wb") as file:  # noqa: PTH123 - the same
            file.write(content)
    done = kc.batch(tmp_path / "in", tmp_path / "r", learn="none")
    rows = {Path(row["capture"]).name: row for row in pq.read_table(tmp_path / "r").to_pylist()}
    assert rows["knob\\udcf6b.npz"]["error"] is None and rows["knob\\udcf6b.npz"]["verdict"] == "complete"
    assert "not\\udcf6.csv" in rows["not\\udcf6.csv"]["error"] and len(done.rows) == 2
    assert kc.batch(tmp_path / "in", tmp_path / "r", learn="none").fresh == 0


@pytest.mark.parametrize("command", ["batch", "watch"])
def test_results_at_an_address_are_refused_and_no_folder_of_its_name_is_made(
    command: str, mess: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
):
    monkeypatch.chdir(tmp_path)
    before = sorted(tmp_path.iterdir())
    refused(knobcam(command, mess, "-o", "s3://line/results"), "is an address", "a folder of this machine")
    with pytest.raises(InputError, match="s3://line/results: is an address"):
        kc.batch(mess, "s3://line/results")
    assert sorted(tmp_path.iterdir()) == before
