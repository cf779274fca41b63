"""Spoiled files of every format are captures or refused in one line; `benches/study_mutated.py` has more."""

from __future__ import annotations

import random
import time
from functools import cache
from pathlib import Path

import pytest
from command import knobcam, refused
from every_format import Source, sources
from mutations import bombs
from study_mutated import MOST_BYTES, Case, cases, run, summary, tried

COUNT = 300
PAST = [
    (1003, 1227, "rows.json"),  # a name of 50 000 blanks
    (1007, 2458, "native.h5"),  # a heap in which the library would go round for ever
    (1006, 3296, "native.parquet"),  # a description at which pyarrow ends the process
]


@cache
def files() -> dict[str, Source]:
    return sources(real=False)


def test_a_sound_file_of_every_format_is_a_capture(tmp_path: Path) -> None:
    for name, (raw, options) in files().items():
        path = tmp_path / "sound.log"
        path.write_bytes(raw)
        assert tried(path, options).kind == "capture", name


def test_spoiled_files_are_captures_or_refused_in_one_line_within_time_and_memory(tmp_path: Path) -> None:
    seed = time.time_ns() % 2**32  # another one each time
    print(f"seed {seed}")
    every = cases(COUNT, seed, files())
    found = summary(run(every, files(), 2, tmp_path), files())
    assert found["failures"] == []
    assert found["capture"] > COUNT // 20 and found["refused"] > COUNT // 2
    assert found["peak_mb"] < MOST_BYTES / 2**20


@pytest.mark.parametrize(("seed", "index", "source"), PAST)
def test_what_failed_once_does_not_again(tmp_path: Path, seed: int, index: int, source: str) -> None:
    found = summary(run([Case(seed, index, source)], files(), 1, tmp_path), files())
    assert found["failures"] == []


def test_the_command_refuses_them_in_one_line_too(tmp_path: Path) -> None:
    for case in random.Random(7).sample(cases(COUNT, 21, files()), 30):
        raw, options, _ = case.content(files())
        path = tmp_path / "spoiled.log"
        path.write_bytes(raw)
        words = [f"--{name.removesuffix('_hz')}={value}" for name, value in options.items()]
        ended = knobcam("import", path, "-o", tmp_path / "out.npz", *words)
        if ended.code:
            refused(ended, "spoiled.log")


def test_small_files_that_unpack_to_gigabytes_are_refused(tmp_path: Path) -> None:
    large = bombs()
    found = summary(run([Case(0, -1, name) for name in large], large, 2, tmp_path), large)
    assert (found["refused"], found["failures"]) == (len(large), [])
