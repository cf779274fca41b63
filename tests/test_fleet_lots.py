"""What statistics say of lots and stations: what was planted, and nothing where nothing was."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from command import knobcam, refused

from knobcam.errors import InputError
from knobcam.fleet import BatchResult
from knobcam.fleet.judged import judged
from knobcam.fleet.limits import Between, Limits
from knobcam.fleet.lots import capable, chart
from knobcam.fleet.row import Row
from knobcam.fleet.settings import Settings
from knobcam.fleet.store import Store
from knobcam.fleet.study import Study
from knobcam.show import batch_report, plot

UNITS = {
    "coulomb.neg": "N m",
    "coulomb.pos": "N m",
    "detent.A": "N m",
    "detent.P": "rad",
    "inertia.M": "N m s^2/rad",
}
USUAL = {"coulomb.neg": 0.008, "coulomb.pos": 0.009, "detent.A": 0.02, "detent.P": 0.08, "inertia.M": 5e-5}


def made(rng: np.random.Generator, name: str, lot: str = "A", station: str = "1", **change: float) -> Row:
    """The row of a part: each parameter 2 % from the usual one, by what is given times more."""
    values = {
        one: usual * rng.normal(1.0, 0.02) * change.get(one.partition(".")[0], 1.0)
        for one, usual in USUAL.items()
    }
    angle = np.linspace(-1.0, 1.0, 12).tolist()
    return {
        **{"capture": name, "sha256": name, "lot": lot, "station": station, "part": None, "date": None},
        **{"time": None, "verdict": "complete", "found": [], "weights": [], "findings": [], "error": None},
        **{"coordinate": "rotary", "unit": "N m", "learned": False, "first": None, "headline": None},
        **{"settings": Settings().digest, "version": "0", "effects": ["coulomb", "detent", "inertia"]},
        **{"ok": None, "failed_limits": [], "failed_why": [], "outlier": [], "cause": None},
        **{"rmse": 1e-3, "rmse_heldout": 1e-3, "noise_floor": 1e-3, "units": UNITS},
        "params": {one: [value, 0.99 * value, 1.01 * value] for one, value in values.items()},
        "curve": {"theta": angle, "forward": angle, "backward": [-one for one in angle]},
    }


def several(rng: np.random.Generator, count: int, lot: str = "A", **how: Any) -> list[Row]:
    return [made(rng, f"{lot}{how.get('station', '')}/{at:03d}", lot, **how) for at in range(count)]


def test_friction_of_a_lot_that_is_ten_per_cent_more_is_said_with_its_interval():
    rng = np.random.default_rng(1)
    found = Study.of(several(rng, 30) + several(rng, 30, "B", coulomb=1.1), None)
    assert {(one.name, one.parameter) for one in found.shifts} == {("B", "coulomb.neg"), ("B", "coulomb.pos")}
    assert all(one.ci95[0] < 10.0 < one.ci95[1] for one in found.shifts)
    assert not found.gains


def test_a_station_whose_torque_is_off_by_one_factor_is_told_from_parts_that_differ():
    rng = np.random.default_rng(2)
    gained = dict.fromkeys(("coulomb", "inertia"), 1.03)
    rows = several(rng, 60, station="1") + several(rng, 60, station="2", detent=1.0, **gained)
    for row in rows[60:]:
        row["params"]["detent.A"] = [1.03 * one for one in row["params"]["detent.A"]]
    (gain,) = Study.of(rows, None).gains
    assert (gain.by, gain.name) == ("station", "2")
    assert gain.ci95[0] < 3.0 < gain.ci95[1]
    assert "gain of its torque sensor" in Study.of(rows, None).said[0]


def test_a_parameter_that_is_tied_to_another_says_nothing_of_its_own_of_a_station():
    rng = np.random.default_rng(7)
    gained = dict.fromkeys(("coulomb", "inertia"), 1.03)
    rows = several(rng, 30, station="1") + several(rng, 30, station="2", **gained)
    for row in rows:
        row["params"]["coulomb.neg"] = row["params"]["coulomb.pos"]
        if row["station"] == "2":
            row["params"]["detent.A"] = [1.03 * one for one in row["params"]["detent.A"]]
    (gain,) = Study.of(rows, None).gains
    assert gain.name == "2" and gain.ci95[0] < 3.0 < gain.ci95[1]


def test_where_nothing_was_planted_nothing_is_said():
    said = 0
    for seed in range(10):
        rng = np.random.default_rng(100 + seed)
        rows = [one for lot in "ABCD" for one in several(rng, 12, lot)]
        said += bool(Study.of(rows, None).said)
    assert said <= 1


def test_an_effect_that_one_lot_has_is_said_to_be_of_that_lot():
    rng = np.random.default_rng(3)
    rows = several(rng, 12) + several(rng, 12, "B")
    for at, row in enumerate(rows):
        row |= {"learned": True, "found": ["backlash"] if at >= 14 else []}
    (one,) = Study.of(rows, None).more
    assert (one.lot, one.effect, one.here, one.there) == ("B", "backlash", (10, 12), (0, 12))


def test_cp_and_cpk_are_those_of_the_textbook_and_their_intervals_hold_the_truth():
    limits = Between("inertia.M", 4e-5, 6e-5, "N m s^2/rad")
    held = {"cp": 0, "cpk": 0}
    for seed in range(200):
        values = np.random.default_rng(seed).normal(5.2e-5, 2.5e-6, 40)
        one = capable(values, limits, "A")
        assert one is not None and one.cp is not None
        assert one.cp[0] == pytest.approx(2e-5 / (6.0 * np.std(values, ddof=1)))
        held["cp"] += one.cp[1] < 2e-5 / 15e-6 < one.cp[2]
        held["cpk"] += one.cpk[1] < 0.8e-5 / 7.5e-6 < one.cpk[2]
    assert all(180 <= count <= 199 for count in held.values()), held
    assert capable(np.ones(3), limits, "A") is None


def test_a_control_chart_sees_a_drift_that_no_single_capture_shows_and_no_other():
    rng = np.random.default_rng(4)
    still = rng.normal(1.0, 0.02, 60)
    assert chart(still, "x", 30).out == []
    moved = still + np.where(np.arange(60) >= 30, 0.035, 0.0)
    out = chart(moved, "x", 30).out
    assert out and 30 <= out[0] <= 45 and out[-1] == 59


@pytest.mark.parametrize(("begun", "values"), [(10, 30), (50, 150), (100, 300)])
def test_of_a_process_that_stays_hardly_any_chart_is_red(begun: int, values: int):
    rng = np.random.default_rng(begun)
    red = sum(bool(chart(rng.normal(1.0, 0.02, values), "x", begun).out) for _ in range(300))
    assert red <= 10  # three are expected


def test_what_drifts_within_one_lot_is_said():
    rng = np.random.default_rng(7)
    rows = []
    for number in range(60):
        row = made(rng, f"{number:02d}")
        row["params"]["coulomb.pos"] = [0.009 * (1.0 + 0.003 * number) + rng.normal(0.0, 1e-4), 0.0, 1.0]
        rows.append(row)
    said = [one for one in Study.of(rows, None).said if "drifts" in one]
    assert len(said) == 1 and said[0].startswith("coulomb.pos drifts: its running mean is beyond chance")


def test_of_three_stations_the_one_that_moved_is_told_and_not_the_others():
    rng = np.random.default_rng(6)
    rows = []
    for station, gain in (("1", 1.0), ("2", 1.03), ("3", 1.0)):
        for number in range(40):
            row = made(rng, f"{station}/{number}", station=station)
            row["params"]["coulomb.pos"] = [gain * (0.009 + rng.normal(0.0, 1e-4)), 0.0, 1.0]
            rows.append(row)
    told = [one for one in Study.of(rows, None).shifts if one.parameter == "coulomb.pos"]
    assert [one.name for one in told] == ["2"] and told[0].ci95[0] < 3.0 < told[0].ci95[1]


def test_gauge_study_takes_apart_repeats_stations_and_parts():
    rng = np.random.default_rng(5)
    part, station = rng.normal(0.0, 4e-4, 20), {"1": -1e-4, "2": 0.0, "3": 1e-4}
    rows = []
    for number, own in enumerate(part):
        for name, more in station.items():
            for repeat in range(3):
                row = made(rng, f"{number:02d}/{name}/{repeat}", station=name) | {"part": f"{number}"}
                row["params"]["coulomb.pos"] = [0.009 + own + more + rng.normal(0.0, 1.5e-4), 0.0, 1.0]
                rows.append(row)
    one = next(g for g in Study.of(rows, None).gauges if g.parameter == "coulomb.pos")
    assert one.repeats == pytest.approx(1.5e-4, rel=0.15)
    assert one.stations == pytest.approx(1e-4, rel=0.3)
    assert one.parts == pytest.approx(np.std(part, ddof=1), rel=0.15)
    assert one.percent == pytest.approx(100.0 * np.hypot(1.5, 1.0) / np.sqrt(1.5**2 + 1.0 + 16.0), rel=0.25)
    assert 2 <= one.distinct <= 3


def test_the_report_is_one_page_with_what_failed_and_why_and_nothing_in_it_is_markup(tmp_path: Path):
    rng = np.random.default_rng(6)
    rows = several(rng, 12) + several(rng, 12, "<b>B", coulomb=1.2)
    rows[3] |= {"ok": False, "failed_why": ["coulomb.pos is <script> high"], "cause": "coulomb: dry friction"}
    rows[3]["failed_limits"] = ["coulomb.pos"]
    rows[5] |= {"error": "A/005: is empty", "params": {}, "units": {}, "curve": None}
    store = Store.open(tmp_path / "r", Settings())
    store.put(rows)
    store.finish(rows)
    ended = knobcam("report", tmp_path / "r", "--json")
    assert ended.code == 0, ended.err
    assert {one["parameter"] for one in ended.document["study"]["shifts"]} == {"coulomb.neg", "coulomb.pos"}
    page = (tmp_path / "r.html").read_text()
    assert page.count("data:image/svg+xml") == 4 and "http://" not in page and "https://" not in page
    assert "coulomb.pos is &lt;script&gt; high" in page and "A/005: is empty" in page
    assert "<script" not in page and "<b>B" not in page
    before = (tmp_path / "r.html").read_bytes()
    BatchResult.read(tmp_path / "r").report(tmp_path / "again.html")
    assert (tmp_path / "again.html").read_bytes() == before


def test_what_holds_no_results_is_refused(tmp_path: Path):
    refused(knobcam("report", tmp_path), "holds no results")
    refused(knobcam("report", tmp_path, "-o", tmp_path / "x.html"), "is within the table")
    with pytest.raises(InputError, match="not empty"):
        (tmp_path / "x").write_text("")
        Store.open(tmp_path, Settings())


def test_two_that_write_to_one_folder_are_kept_apart(tmp_path: Path):
    one, other = (Store.open(tmp_path / "r", Settings()) for _ in range(2))
    rows = several(np.random.default_rng(1), 2)
    one.put(rows[:1])
    with pytest.raises(InputError, match="another batch or watch writes there"):
        other.put(rows[1:])
    one.close()
    other.put(rows[1:])


@pytest.mark.usefixtures("undrawn")
def test_a_batch_that_was_ended_is_reported_with_what_there_is_and_says_that_it_is_not_at_its_end(
    tmp_path: Path,
):
    judged = ("ok", "failed_limits", "failed_why", "outlier", "cause")
    rows = [
        {name: value for name, value in row.items() if name not in judged}
        for row in several(np.random.default_rng(6), 8)
    ]
    store = Store.open(tmp_path / "r", Settings())
    store.put(rows)
    store.close()
    ended = knobcam("report", tmp_path / "r")
    assert ended.code == 0 and "8 captures" in ended.out and "not at its end yet" in ended.out
    assert "not at its end yet" in (tmp_path / "r.html").read_text("utf-8")
    store = Store.open(tmp_path / "r", Settings())
    store.finish(list(BatchResult.read(tmp_path / "r").rows))
    store.close()
    assert "not at its end yet" not in knobcam("report", tmp_path / "r").out


@pytest.mark.usefixtures("undrawn")
def test_one_bad_part_leaves_all_others_apart_and_is_named_at_the_edge_and_a_far_limit_is_said():
    rng = np.random.default_rng(3)
    rows = several(rng, 20) + several(rng, 20, "B", coulomb=1.1)
    rows[3]["params"]["coulomb.pos"] = [0.9, 0.89, 0.91]
    rows[3]["curve"] = {**rows[3]["curve"], "forward": [30.0 * one for one in rows[3]["curve"]["forward"]]}
    text = "[parameters]\ncoulomb.pos = { min = 0.007, max = 0.012 }\ncoulomb.neg = { max = 0.5 }"
    limits = Limits.parse(text, "limits", None, learned=True)
    result = BatchResult(Path("r"), tuple(judged(rows, limits)), frozenset(), limits=limits)
    told = {axes.get_title(loc="left").split(" ")[0]: axes for axes in plot.batch_parameters(result).axes}
    low, high = told["coulomb.pos"].get_ylim()
    assert low < 0.007 and 0.012 < high < 0.015
    assert [one.get_text() for one in told["coulomb.pos"].texts] == ["A/003: 0.9"]
    assert [one.get_text() for one in told["coulomb.neg"].texts] == ["limit 0.5, far above"]
    assert told["coulomb.neg"].get_ylim()[1] < 0.02
    for drawn in (plot.batch_charts(result).axes[1], plot.batch_curves(result).axes[0]):
        assert any("A/003" in one.get_text() for one in drawn.texts)
    assert plot.batch_charts(result).axes[1].get_ylim()[1] < 0.02
    assert plot.batch_curves(result).axes[0].get_ylim()[1] < 2000.0  # mNm; all others are within 1000
    page = batch_report.html(result)
    assert "<td>N m</td>" in page and "0.007 to 0.012" in page


def test_a_picture_of_a_hundred_lots_is_no_wider_and_no_higher_than_a_page():
    rng = np.random.default_rng(3)
    rows = [one for lot in range(100) for one in several(rng, 5, f"L{lot:02d}")]
    for row in rows:
        row["hints"] = {"lean.stribeck": float(rng.normal()) + 9.0 * (row["lot"] == "L99")}
    rows[7] |= {"verdict": "unexplained"}
    result = BatchResult(Path("r"), tuple(judged(rows, None)), frozenset())
    for drawn in (plot.batch(result), plot.batch_hints(result)):
        width, height = drawn.get_size_inches()
        assert width <= 14.0 and height <= 14.0
    lots = [one.get_text() for one in plot.batch(result).axes[0].get_yticklabels()]
    assert lots[0] == "L00 (5)" and "L01 (5)" in lots and lots[-1] == "80 other lots (400)"


def test_a_lot_that_is_not_ok_is_among_the_few_of_many_that_are_drawn_and_by_its_share():
    rng = np.random.default_rng(3)
    rows = [
        one for lot in range(40) for one in several(rng, 5, f"L{lot:02d}", coulomb=1.0 + 0.5 * (lot == 39))
    ]
    limits = Limits.parse("[parameters]\ncoulomb.pos = { max = 0.012 }", "limits", None, learned=True)
    drawn = plot.batch(BatchResult(Path("r"), tuple(judged(rows, limits)), frozenset(), limits=limits)).axes[
        0
    ]
    lots = [one.get_text() for one in drawn.get_yticklabels()]
    bars = {one.get_label(): [bar.get_width() for bar in one] for one in drawn.containers}
    assert "L39 (5)" in lots and bars["not OK"][lots.index("L39 (5)")] == 100.0
    assert sum(bars["not OK"]) == 100.0


def test_one_bad_part_is_no_drift_and_a_step_that_stays_is():
    rows = several(np.random.default_rng(5), 60)
    rows[40]["params"]["coulomb.pos"] = [0.9, 0.89, 0.91]
    assert not [one for one in Study.of(rows, None).said if "drifts" in one]
    for row in rows[45:]:
        row["params"]["coulomb.pos"] = [1.15 * one for one in row["params"]["coulomb.pos"]]
    assert [one for one in Study.of(rows, None).said if one.startswith("coulomb.pos drifts")]
