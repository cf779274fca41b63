"""Spoiled files of every format are read or refused in one line; `benches/study_mutated.py` has more."""

from __future__ import annotations

import random
import time
from functools import cache
from pathlib import Path

import pytest
from command import knobcam, refused
from every_format import ROWS, Source, settings, sources
from mutations import bombs
from study_mutated import MOST_BYTES, Case, cases, counted, run, told, tried

EACH = 20
PAST = [  # seed, number, file, and its rows
    (1003, 1227, "json/rows", 1500),  # a name of 50 000 blanks
    (1007, 2458, "hdf5/native", 1500),  # a heap in which the library would go round for ever
    (1006, 3296, "parquet/native", 1500),  # a description at which pyarrow ends the process
]


@cache
def files(rows: int = ROWS) -> dict[str, Source]:
    return sources(real=False, rows=rows)


def test_a_sound_file_of_every_format_is_read(tmp_path: Path) -> None:
    for name, (raw, options) in files().items():
        case = Case(0, 0, name)
        path = tmp_path / case.file
        path.write_bytes(raw)
        assert tried(path, case.format, options).kind == "read", name


def test_spoiled_files_are_read_or_refused_in_one_line_within_time_and_memory(tmp_path: Path) -> None:
    seed = time.time_ns() % 2**32  # another one each time
    print(f"seed {seed}")
    every = cases(EACH, seed, files())
    found = told(counted(run(every, files(), 2, tmp_path), files()))
    assert found["failures"] == []
    assert set(found["by_format"].values()) == {EACH}
    assert found["read"] > len(every) // 20 and found["refused"] > len(every) // 2
    assert found["peak_mb"] < MOST_BYTES / 2**20


@pytest.mark.parametrize(("seed", "index", "source", "rows"), PAST)
def test_what_failed_once_does_not_again(
    tmp_path: Path, seed: int, index: int, source: str, rows: int
) -> None:
    there = files(rows)
    found = counted(run([Case(seed, index, source)], there, 1, tmp_path), there)
    assert found["failures"] == []


def test_a_row_of_a_bag_that_claims_more_than_there_can_be_is_refused_in_words(tmp_path: Path) -> None:
    raw, options = files()["db3/bag"]
    path = tmp_path / "spoiled.log"
    path.write_bytes(raw[:43_437] + b"\xff" * 22 + raw[43_459:])
    ended = tried(path, "db3", options)
    assert (ended.kind, "a row of it is damaged" in ended.said) == ("refused", True)  # and not MemoryError


def test_the_command_refuses_them_in_one_line_too(tmp_path: Path) -> None:
    logs = {name: one for name, one in files().items() if name not in settings()}
    for case in random.Random(7).sample(cases(EACH, 21, logs), 30):
        raw, options, _ = case.content(files())
        path = tmp_path / "spoiled.log"
        path.write_bytes(raw)
        words = [f"--{name.removesuffix('_hz')}={value}" for name, value in options.items()]
        ended = knobcam("import", path, "-o", tmp_path / "out.npz", *words)
        if ended.code:
            refused(ended, "spoiled.log")


def test_every_command_takes_every_sound_file_or_refuses_it_in_one_line(tmp_path: Path) -> None:
    path, out = tmp_path / "sound.log", tmp_path / "out"
    commands = (
        *(
            ("export", path, "-o", f"{out}.csv"),
            ("import", path, "-o", f"{out}.npz"),
            ("fit", path, "--json"),
        ),
        *(("compare", path, "knob3"), ("fit", path, "--model", path), ("calibrate", "--port", path)),
        *(("simulate", path, "-o", f"{out}.h5", "--duration", "0.5"), ("render", path, "--seconds", "0.1")),
        *(("convert", path, "--kt", "1", "-o", f"{out}.toml"), ("emulate", path, "--speed", "0")),
    )
    seed = time.time_ns() % 2**32
    print(f"seed {seed}")
    every = [(name, words) for name in files() for words in commands]
    for name, words in random.Random(seed).sample(every, 60):
        path.write_bytes(files()[name][0])
        ended = knobcam(*words)
        if ended.code:
            assert ended.code == 2, (name, words, ended)
            refused(ended, "")


def test_small_files_that_unpack_to_gigabytes_are_refused(tmp_path: Path) -> None:
    large = bombs()
    found = counted(run([Case(0, -1, name) for name in large], large, 2, tmp_path), large)
    assert found["by_source"] == {name: {"refused": 1} for name in large}
