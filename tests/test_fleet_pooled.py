"""What a lot has that no capture of it shows: found by all of them together, and nothing where nothing is."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from command import knobcam
from test_fleet_lots import made

import knobcam as kc
from knobcam.fit.hints import hints
from knobcam.fleet import BatchResult
from knobcam.fleet.frame import frame
from knobcam.fleet.pooled import LEVEL, compared, pooled
from knobcam.fleet.row import Row
from knobcam.fleet.settings import Settings
from knobcam.fleet.store import Store
from knobcam.fleet.study import Study

LEANS = ("stribeck", "quadratic_drag", "friction_drift", "return_spring", "unbalance")
GAINS = ("torque_drift", "end_stop", "presliding", "position_friction")


def lot(rng: np.random.Generator, name: str, count: int, **more: float) -> list[Row]:
    """Rows of a lot whose captures each have so much more of some effects than chance."""
    rows = []
    for at in range(count):
        told = {f"lean.{one}": rng.normal() + more.get(one, 0.0) for one in LEANS}
        told |= {f"gain.{one}": 2.0 + 0.5 * rng.normal() + more.get(one, 0.0) for one in GAINS}
        rows.append(made(rng, f"{name}/{at:03d}", name) | {"hints": told})
    return rows


def test_a_lot_has_what_is_in_all_of_its_captures_and_in_none_of_the_old_ones() -> None:
    rng = np.random.default_rng(1)
    (one,) = Study.of(lot(rng, "A", 20) + lot(rng, "B", 20, stribeck=2.0), None).pooled
    assert (one.lot, one.than, one.effect, one.captures) == ("B", "A", "stribeck", (20, 20))
    assert one.p_value < 1e-4 and one.weak and not one.alike
    assert "lot B has stribeck that lot A has not (p = " in str(one)
    assert str(one).endswith(", 20 captures and 20), too weak for one capture")


def test_what_the_old_lot_had_and_the_new_one_lacks_is_the_old_ones() -> None:
    rng = np.random.default_rng(2)
    found = Study.of(lot(rng, "A", 20, torque_drift=1.5) + lot(rng, "B", 30), None).pooled
    assert [(one.lot, one.than, one.effect, one.captures) for one in found] == [
        ("A", "B", "torque_drift", (20, 30))
    ]


def test_one_lot_alone_is_held_against_chance_by_what_has_a_sign() -> None:
    rng = np.random.default_rng(3)
    (one,) = Study.of(lot(rng, "A", 20, stribeck=2.0, torque_drift=9.0), None).pooled
    assert (one.lot, one.than, one.effect) == ("A", None, "stribeck")
    assert "lot A has stribeck (p = " in str(one)
    loud = [row | {"verdict": None} for row in lot(rng, "A", 20, stribeck=2.0)]
    assert not Study.of(loud, None).pooled, "what single captures show is for learn to name"


def test_what_leans_the_way_that_no_effect_of_the_kind_can_is_not_named() -> None:
    rng = np.random.default_rng(4)
    study = Study.of(lot(rng, "A", 20) + lot(rng, "B", 20, quadratic_drag=-2.0), None)
    assert not study.pooled
    (one,) = [one for one in study.held if one.sure]
    assert one.effect == "quadratic_drag" and not one.plausible and one.score < 0.0


def test_effects_that_say_as_much_are_said_beside_the_one_that_says_most() -> None:
    rng = np.random.default_rng(5)
    rows = lot(rng, "A", 20) + lot(rng, "B", 20, return_spring=2.0)
    for row in rows:
        row["hints"]["lean.unbalance"] = row["hints"]["lean.return_spring"] + 0.1 * rng.normal()
    (one,) = Study.of(rows, None).pooled
    assert {one.effect, *one.alike} == {"return_spring", "unbalance"}
    assert "would look the same" in str(one)


def test_of_equal_lots_nothing_is_said_but_as_often_as_was_promised() -> None:
    said, draws = 0, 40
    for seed in range(draws):
        rng = np.random.default_rng(1000 + seed)
        rows = [one for name in "ABC" for one in lot(rng, name, 12)]
        said += bool(pooled(compared(frame(rows), rows), rows))
    assert said <= draws * LEVEL + 3.0 * np.sqrt(draws * LEVEL)


def test_few_captures_or_rows_without_hints_say_nothing() -> None:
    rng = np.random.default_rng(6)
    assert not Study.of(lot(rng, "A", 4, stribeck=9.0) + lot(rng, "B", 4), None).held
    assert not Study.of([made(rng, f"A/{at}") for at in range(20)], None).held


def test_the_report_shows_effects_over_lots_and_hints_are_read_back(tmp_path: Path) -> None:
    rng = np.random.default_rng(7)
    rows = lot(rng, "A", 12) + lot(rng, "B", 12, stribeck=3.0)
    store = Store.open(tmp_path / "r", Settings())
    store.put(rows)
    store.finish(rows)
    assert [row["hints"] for row in BatchResult.read(tmp_path / "r").rows] == [row["hints"] for row in rows]
    ended = knobcam("report", tmp_path / "r", "--json")
    (one,) = ended.document["study"]["pooled"]
    assert (one["lot"], one["effect"]) == ("B", "stribeck")
    page = (tmp_path / "r.html").read_text()
    assert page.count("data:image/svg+xml") == 5 and "lot B has stribeck that lot A has not" in page
    assert "lot B has stribeck that lot A has not" in knobcam("report", tmp_path / "r").out


def test_a_batch_keeps_hints_and_a_folder_stays_as_it_was_begun(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    model = kc.Model.load("knob5")
    for lot_name, rise in ("A", 0.0), ("B", 0.03):
        folder = tmp_path / "captures" / f"lot={lot_name}"
        folder.mkdir(parents=True)
        part = model.with_effect("stribeck").with_value("stribeck.rise", rise)
        part = part.with_value("stribeck.vs", 0.5)
        for at in range(5):
            kc.simulate(part, "sweep", seed=100 * ord(lot_name) + at).save(folder / f"{at}.npz")
    result = kc.batch(tmp_path / "captures", tmp_path / "r", learn="none")
    leans = {lot_name: [] for lot_name in "AB"}
    for row in result.rows:
        assert row["verdict"] == "complete" and "lean.quadratic_drag" in row["hints"]
        leans[row["lot"]].append(row["hints"]["lean.stribeck"])
    assert np.median(leans["B"]) - np.median(leans["A"]) > 1.0
    monkeypatch.setattr("knobcam.fleet.batching._HINTED", 9)
    with_none = kc.batch(tmp_path / "captures", tmp_path / "n", learn="none")
    assert all(row["hints"] == {} for row in with_none.rows) and not with_none.study.held
    (tmp_path / "captures" / "lot=A" / "0.npz").unlink()
    kc.simulate(model, "sweep", seed=5).save(tmp_path / "captures" / "lot=A" / "0.npz")
    monkeypatch.setattr("knobcam.fleet.batching._HINTED", 10)
    again = kc.batch(tmp_path / "captures", tmp_path / "n", learn="none")
    assert again.fresh == 1 and all(row["hints"] == {} for row in again.rows)


def test_hints_are_of_the_effects_that_a_fit_lacks() -> None:
    capture: Any = kc.simulate(kc.Model.load("knob5"), "sweep", seed=1)
    told = hints(kc.fit(capture))
    assert {"lean.stribeck", "gain.torque_drift"} <= set(told)
    assert not {name for name in told if name.partition(".")[2] in ("coulomb", "backlash", "wavelet")}
