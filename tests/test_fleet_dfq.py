"""Parameters of parts go to the statistics programs of the industry, and come back to the last bit."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest
from test_fleet_lots import several

from knobcam.errors import InputError
from knobcam.fleet import BatchResult
from knobcam.fleet.aqdef import parse, read
from knobcam.fleet.limits import Limits
from knobcam.fleet.settings import Settings
from knobcam.fleet.store import Store

LIMITS = "[parameters]\ncoulomb.pos = { min = 0.0085, max = 0.0095 }\ninertia.M = { max = 6e-5 }\n"


def test_values_limits_and_lots_are_read_as_they_were_written(tmp_path: Path):
    rows = several(np.random.default_rng(1), 6) + several(np.random.default_rng(2), 3, "B")
    rows[4]["params"]["inertia.M"] = [None, None, None]
    rows[2]["time"] = "2026-11-24T22:43:44+00:00"
    store = Store(tmp_path / "r", Settings(), LIMITS)
    store.put(rows)
    store.finish(rows)
    BatchResult.read(tmp_path / "r").dfq(tmp_path / "x.dfq")
    assert (
        (tmp_path / "x.dfq")
        .read_bytes()
        .startswith(b"K0100 5\r\nK1001/1 r\r\nK2001/1 1\r\nK2002/1 coulomb.neg\r\n")
    )
    found = {one.name: one for one in read(str(tmp_path / "x.dfq"))}
    assert found["coulomb.pos"].values == [row["params"]["coulomb.pos"][0] for row in rows]
    assert (found["coulomb.pos"].low, found["coulomb.pos"].high, found["coulomb.pos"].unit) == (
        0.0085,
        0.0095,
        "N m",
    )
    assert (found["inertia.M"].low, found["inertia.M"].high) == (None, 6e-5)
    assert [math.isnan(value) for value in found["inertia.M"].values] == [at == 4 for at in range(9)]
    assert found["detent.A"].lots == 6 * ["A"] + 3 * ["B"]
    assert found["detent.A"].parts == [row["capture"] for row in rows]
    assert found["detent.A"].times[2] == "24.11.2026/22:43:44"
    limits, same = (Limits.load(tmp_path / name, None, learned=True) for name in ("x.dfq", "r/_limits.toml"))
    assert limits.checks == same.checks


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("K0100 1\nK2110/1 much", "line 2: K2110 is 'much'"),
        ("K0100 1\nhello", "line 2: 'hello' is no key"),
        ("K1001 7", "line 1"),
    ],
)
def test_a_damaged_file_is_refused_with_its_line(text: str, words: str):
    with pytest.raises(InputError, match=r"x\.dfq, line") as refused:
        parse(text, "x.dfq")
    assert words in str(refused.value)


def test_numbers_with_a_comma_and_keys_that_are_not_known_are_read():
    (one,) = parse("K0100 1\nK1041 x\nK2002/1 depth\nK2111/1 1,5\nK0001/1 0,25\nK0008/1 3\n", "x.dfq")
    assert (one.name, one.high, one.values) == ("depth", 1.5, [0.25])
