"""Limits of a part: in its unit, in per cent, by what a hand notices, along its curve, by what is missing."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from small import detents, recorded

import knobcam as kc
from knobcam.errors import InputError
from knobcam.fleet import BatchResult
from knobcam.fleet.judged import judged, mixed
from knobcam.fleet.limits import Limits
from knobcam.fleet.noticeable import SHARE, ripple
from knobcam.fleet.outliers import outliers
from knobcam.fleet.row import Row, row_of
from knobcam.fleet.settings import Settings
from knobcam.fleet.sources import of_path, sources
from knobcam.fleet.store import _partition


@pytest.fixture(scope="module")
def row(tmp_path_factory: pytest.TempPathFactory) -> Row:
    path = tmp_path_factory.mktemp("one") / "knob.npz"
    recorded(1, detents).save(path)
    found = row_of(sources([path])[0], Settings(), False, None)
    assert found is not None and found["error"] is None
    return found


def limits(tmp_path: Path, text: str, model: kc.Model | None = None, *, learned: bool = True) -> Limits:
    file = tmp_path / "limits.toml"
    file.write_text(text)
    return Limits.load(file, model, learned=learned)


def failed(given: Limits, row: Row) -> list[str]:
    return [one.limit for one in given.failed(row)]


def test_a_parameter_is_held_in_its_unit_and_in_per_cent_of_a_reference(row: Row, tmp_path: Path):
    value = row["params"]["coulomb.pos"][0]
    held = limits(tmp_path, f"[parameters]\ncoulomb.pos = {{ min = {0.9 * value}, max = {1.1 * value} }}")
    assert failed(held, row) == []
    less = limits(tmp_path, f'[parameters]\n"coulomb.pos" = {{ reference = {1.2 * value}, percent = 10 }}')
    assert failed(less, row) == ["coulomb.pos"]
    assert "below" in less.failed(row)[0].why and "N m" in less.failed(row)[0].why


def test_what_a_hand_notices_is_a_tenth_of_friction_and_of_a_ripple_what_its_period_makes_of_it(
    row: Row, tmp_path: Path
):
    value = row["params"]["coulomb.pos"][0]
    for factor, beyond in ((1.0 + 0.9 * SHARE, []), (1.0 + 1.3 * SHARE, ["coulomb.pos"])):
        text = f"[parameters]\ncoulomb.pos = {{ reference = {factor * value}, jnd = 1 }}"
        assert failed(limits(tmp_path, text), row) == beyond
    assert ripple(180.0) == pytest.approx(0.2617 * 0.030)
    assert ripple(2.8) == pytest.approx(0.0037 * 0.030)
    depth = row["params"]["detent.A"][0]
    text = "[parameters]\ndetent.A = {{ reference = {}, jnd = 1, period_deg = 28.8 }}"
    assert failed(limits(tmp_path, text.format(depth + 0.9 * ripple(28.8))), row) == []
    assert failed(limits(tmp_path, text.format(depth + 1.1 * ripple(28.8))), row) == ["detent.A"]


def test_a_band_holds_the_curve_of_its_direction_alone(row: Row, tmp_path: Path):
    band = "[curve.{}]\ntheta = [-0.8, 0.8]\nmin = [{low}, {low}]\nmax = [{high}, {high}]"
    forward = np.array(row["curve"]["forward"], dtype=float)
    high = float(np.nanmax(forward)) + 1e-3
    assert failed(limits(tmp_path, band.format("forward", low=-1.0, high=high)), row) == []
    cut = limits(tmp_path, band.format("forward", low=-1.0, high=high - 4e-3))
    assert failed(cut, row) == ["curve.forward"]
    assert "above" in cut.failed(row)[0].why


def test_the_curve_goes_by_direction_and_has_no_inertia_in_it(row: Row):
    forward, backward = (np.array(row["curve"][name], dtype=float) for name in ("forward", "backward"))
    both = np.isfinite(forward) & np.isfinite(backward)
    # Dry friction either way, and viscous friction up to 8 rad/s.
    assert 17e-3 < np.mean(forward[both] - backward[both]) < 17e-3 + 9e-4 * 8.0


def test_an_effect_that_may_not_be_there_fails_a_part_by_its_name(row: Row, tmp_path: Path):
    text = '[effects]\nforbidden = ["backlash"]\nunexplained = false'
    found = {**row, "found": ["backlash"], "verdict": "missing"}
    assert failed(limits(tmp_path, text), found) == ["effects.backlash"]
    assert failed(limits(tmp_path, text), {**row, "verdict": "unexplained"}) == ["effects.unexplained"]
    assert failed(limits(tmp_path, '[effects]\nforbidden = "any"'), found) == ["effects.backlash"]
    told = judged([found], limits(tmp_path, text))[0]
    assert told["ok"] is False and told["cause"].startswith("backlash: ")


def test_a_cause_says_by_how_much_a_part_is_beyond_its_limit_and_how_many_of_its_lot_are(
    row: Row, tmp_path: Path
):
    rows = [made(number, "a", row, verdict="complete") for number in range(40)]
    for one in rows[:9]:
        one["params"]["coulomb.pos"] = [0.0124, 0.0123, 0.0125]
    held = limits(tmp_path, "[parameters]\ncoulomb.pos = { max = 0.0100 }")
    told = {one["capture"]: one["cause"] for one in judged(rows, held)}
    middle = np.median([one["params"]["coulomb.pos"][0] for one in rows])
    said = (
        "coulomb: dry friction moving forward (coulomb.pos) 24 % above its limit (0.0124 N m, at most 0.01)"
    )
    assert told["a/03"] == f"{said}; usual in its lot is {middle:.4g}; 8 of 39 others of its lot too"
    assert told["a/20"] is None
    alone = judged([rows[3]], held)[0]["cause"]
    assert alone == said  # nothing is known of a lot
    weak = limits(tmp_path, "[parameters]\ncoulomb.pos = { min = 0.0372 }")
    assert "0.333 times" not in judged([rows[3]], weak)[0]["cause"]
    assert "66.7 % below its limit" in judged([rows[3]], weak)[0]["cause"]
    strong = limits(tmp_path, "[parameters]\ncoulomb.pos = { max = 0.0031 }")
    assert (
        "(coulomb.pos) 4 times its limit (0.0124 N m, at most 0.0031)"
        in judged([rows[3]], strong)[0]["cause"]
    )


def test_a_curve_beyond_its_band_has_the_parameter_for_its_cause_that_is_unlike_the_lot(
    row: Row, tmp_path: Path
):
    rows = [made(number, "a", row, verdict="complete") for number in range(20)]
    rows[4]["params"]["coulomb.pos"] = [0.0124, 0.0123, 0.0125]
    rows[4]["curve"] = {**row["curve"], "forward": [1.0] * len(row["curve"]["forward"])}
    held = limits(tmp_path, "[curve.forward]\ntheta = [-0.8, 0.8]\nmin = [-0.5, -0.5]\nmax = [0.5, 0.5]")
    bad = judged(rows, held)[4]
    assert bad["failed_limits"] == ["curve.forward"]
    assert "dry friction moving forward (coulomb.pos)" in bad["cause"]
    assert "above what is usual in its lot (0.0124 N m, usually" in bad["cause"]
    rows[5]["curve"] = rows[4]["curve"]
    assert (
        judged(rows, held)[5]["cause"] == "not named: nothing was found missing, and no parameter is unusual"
    )


def test_a_part_is_told_by_its_cause_and_what_that_does_not_name(row: Row, tmp_path: Path):
    rows = [made(number, "a", row, verdict="complete") for number in range(20)]
    rows[4]["params"]["coulomb.pos"] = [0.0124, 0.0123, 0.0125]
    rows[4]["curve"] = {**row["curve"], "forward": [1.0] * len(row["curve"]["forward"])}
    band = "[curve.forward]\ntheta = [-0.8, 0.8]\nmin = [-0.5, -0.5]\nmax = [0.5, 0.5]"
    held = limits(tmp_path, f"[parameters]\ncoulomb.pos = {{ max = 0.0100 }}\n{band}")
    told = judged(rows, held)
    assert len(told[4]["failed_why"]) == 2
    (one,) = BatchResult(tmp_path, tuple(told), frozenset(), limits=held).text_rows()
    assert one[-1].startswith("the forward curve is 1 N m at") and one[-1].count("coulomb.pos") == 1


def test_an_effect_that_was_found_is_said_with_its_size_and_how_many_of_the_lot_have_it(row: Row):
    gap = {"params": {**row["params"], "backlash.gap": [0.0102, 0.0098, 0.0106]}, "found": ["backlash"]}
    gap |= {"units": {**row["units"], "backlash.gap": "rad"}, "verdict": "missing"}
    rows = [made(number, "a", row, verdict="complete") for number in range(18)]
    rows += [{**made(number, "a", row), **gap} for number in (18, 19)]
    size = "free play (backlash.gap) 0.0102 rad (0.0098 to 0.0106)"
    told = judged(rows, None)[18]["cause"]
    assert (
        told == f"backlash: there is free play between shaft and knob, {size}; 1 of 19 others of its lot too"
    )


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("[parameters]\nspring.k = { max = 1 }", "spring.k: the model has no such parameter"),
        ("[parameters]\ninertia.M = { max = 'much' }", "inertia.M: max: is 'much'; give a number"),
        ("[parameters]\ninertia.M = { percent = 3 }", "give reference"),
        ("[parameters]\ninertia.M = { min = 2, max = 1 }", "give min below max"),
        ("[parameters]\ndetent.P = { reference = 1, jnd = 1 }", "nobody measured"),
        ("[parameters]\ndetent.A = { reference = 1, jnd = 1 }", "add period_deg"),
        ("[curve.up]\ntheta = []", "is no direction"),
        ("[curve.forward]\ntheta = [0, 1]\nmin = [0]\nmax = [1, 1]", "have 2, 1 and 2 numbers"),
        ("[effects]\nforbidden = ['magic']", "'magic' is no effect"),
        ("[torque]\nmax = 1", "no kind of limit"),
        ("", "has no limit"),
        ("nonsense", "is no file of limits"),
    ],
)
def test_a_file_of_limits_that_says_nothing_sensible_is_refused_in_one_line(
    text: str, words: str, tmp_path: Path
):
    with pytest.raises(InputError, match=r"limits\.toml: ") as refused:
        limits(tmp_path, text)
    assert words in str(refused.value) and "\n" not in str(refused.value)


def test_limits_are_those_of_the_model_that_is_fitted(tmp_path: Path):
    text = "[parameters]\nreturn_spring.k = { max = 1 }"
    model = kc.Model.load("knob4").with_effect("return_spring")
    assert limits(tmp_path, text, model).checks
    with pytest.raises(InputError, match="--learn outliers"):
        limits(tmp_path, "[effects]\nforbidden = []", learned=False)


def made(number: int, lot: str, row: Row, **change: object) -> Row:
    rng = np.random.default_rng(number)
    params = {
        name: [value + rng.normal(0, 1e-4), value - 1e-4, value + 1e-4]
        for name, (value, *_) in row["params"].items()
    }
    return {
        **row,
        "capture": f"{lot}/{number:02d}",
        "sha256": f"{number}",
        "lot": lot,
        "params": params,
        **change,
    }


def test_one_that_is_unlike_its_lot_is_found_and_its_neighbours_are_not(row: Row):
    rows = [made(number, "a", row, verdict="complete") for number in range(30)]
    rows[7]["params"]["coulomb.pos"] = [0.02, 0.0199, 0.0201]
    rows[9] = {**rows[9], "rmse": 3.0 * row["rmse"]}
    assert outliers(rows, lambda _: False) == {"a/07": ["coulomb.pos"], "a/09": ["rmse"]}
    for one in rows:
        one["verdict"] = None
    assert sum(why == ["typical"] for why in outliers(rows, lambda _: False).values()) == 1


def test_a_lot_of_several_kinds_of_axis_says_so_and_compares_only_what_is_alike(row: Row):
    rows = [made(number, "a", row) for number in range(4)]
    rows[2] |= {"coordinate": "linear", "unit": "N"}
    assert [one["capture"] for one in judged(rows, None) if "mixed" in one["findings"]] == ["a/02"]
    assert "1 linear in N, 3 rotary in N m" in mixed(rows)[0]


def test_folders_say_what_a_capture_belongs_to():
    assert of_path("x/lot=7/station-2/2026-11-24/a.csv", "lot=7/a.csv") == {
        **{"lot": "7", "station": "2", "date": "2026-11-24"}
    }
    assert of_path("x/spring/left/a.csv", "spring/left/a.csv") == {"lot": "spring", "station": "left"}
    assert of_path("x/a.csv", "a.csv") == {}


def test_files_that_were_written_on_one_day_lie_in_one_part_of_the_table():
    days = [f"2026-11-{day}T18:52:{second}+00:00" for day, second in ((24, 36), (24, 37), (25, 36))]
    folders = [
        _partition({"lot": "a b", "station": None, "date": one}) for one in (*days, "2026-11-24", "KW 48")
    ]
    ends = ("2026-11-24", "2026-11-24", "2026-11-25", "2026-11-24", "KW 48")
    assert folders == [f"lot-a b/date-{end}" for end in ends]


@pytest.mark.parametrize(("coordinate", "unit"), [("linear", "N"), ("rotary", "A"), ("linear", "A")])
def test_a_part_in_another_unit_than_its_limits_is_not_ok_by_it_and_held_by_limits_in_its_own(
    coordinate: str, unit: str, row: Row, tmp_path: Path
):
    other = {**row, "coordinate": coordinate, "unit": unit, "capture": "other"}
    wide = "[parameters]\ncoulomb.pos = { max = 9 }"
    held = limits(tmp_path, wide)
    told = {one["capture"]: one for one in judged([row, other], held)}
    assert told[row["capture"]]["ok"] is True and told["other"]["ok"] is False
    assert told["other"]["failed_limits"] == ["unit"] and not told["other"]["cause"]
    assert (
        f"it is {coordinate} in {unit}, and the numbers of its limits are rotary in N m"
        in (told["other"]["failed_why"][0])
    )
    assert not held.beyond(other)  # and no search for what is missing makes it another unit
    if (coordinate, unit) != ("linear", "A"):
        own = limits(tmp_path, f'unit = "{unit}"\n{wide}')
        assert failed(own, other) == [] and failed(own, row) == ["unit"]
    assert failed(limits(tmp_path, '[effects]\nforbidden = "any"'), other) == []


def test_what_a_hand_notices_of_a_ripple_is_no_current(tmp_path: Path):
    text = 'unit = "A"\n[parameters]\ndetent.A = { reference = 1, jnd = 1, period_deg = 28.8 }'
    with pytest.raises(InputError, match="nobody measured"):
        limits(tmp_path, text)


def test_how_capable_a_process_is_and_where_limits_are_drawn_is_not_said_by_numbers_of_another_unit(
    row: Row, tmp_path: Path
):
    held = limits(tmp_path, "[parameters]\ncoulomb.pos = { min = 0, max = 9 }")
    for unit, many in (("N m", 1), ("A", 0)):
        rows = [made(number, "a", row, unit=unit) for number in range(8)]
        told = BatchResult(tmp_path, tuple(judged(rows, held)), frozenset(), limits=held)
        assert len(told.study.capability) == many and (told.drawn is not None) == bool(many)


def test_the_unit_of_limits_is_one_that_there_is_and_that_of_the_model(tmp_path: Path):
    wide = "[parameters]\ncoulomb.pos = { max = 9 }"
    with pytest.raises(InputError, match="unit: is 'lb'; choose N m, N, A, V, duty"):
        limits(tmp_path, f'unit = "lb"\n{wide}')
    model = kc.Model.of(["inertia", "coulomb"], "rotary", "A")
    assert limits(tmp_path, wide, model).axis == ("rotary", "A")
    with pytest.raises(InputError, match="the model is in A; leave it out"):
        limits(tmp_path, f'unit = "N m"\n{wide}', model)
    text = "K0100 1\nK2002/1 coulomb.pos\nK2111/1 9\nK2142/1 {}\n"
    units = [limits(tmp_path, text.format(unit)).axis[1] for unit in ("A", "N", "N m", "Nm")]
    assert units == ["A", "N", "N m", "N m"]
