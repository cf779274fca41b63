"""Models in other forms: what is said of each effect, what it costs in torque, and what the files then do."""

from __future__ import annotations

import io
import zipfile
from functools import cache
from itertools import product
from pathlib import Path

import numpy as np
import pytest
from command import knobcam, refused

import knobcam as kc
from knobcam.cli import converting
from knobcam.render.convert import TARGETS, Conversion, convert
from knobcam.render.convert.terms import terms_of

MOTIONS = {name: kc.motion(name, 1.0) for name in ("sweep", "turns", "hand")}
EXACT = 1e-3
"""Share of the torque RMS within which a form that is said to be exact has to be."""


def knob(*effects: str, **values: float) -> kc.Model:
    """Knob 4 with more effects, at these values."""
    model = kc.Model.load("knob4")
    for effect in effects:
        model = model.with_effect(effect)
    for name, value in values.items():
        model = model.with_value(name.replace("__", "."), value)
    return model


HIDDEN = {"presliding": "knob5", "stribeck": "knob4", "load_friction": "knob4", "backlash": "knob4"}
HIDDEN |= {"compliance": "knob4", "detent_harmonics": "knob4"}
GIVEN: dict[str, dict[str, float]] = {
    "return_spring": {"return_spring__k": 0.01, "return_spring__theta0": 0.3},
    "position_polynomial": {"position_polynomial__p2": 0.002, "position_polynomial__p3": 0.01},
    "quadratic_drag": {"quadratic_drag__d": 2e-4},
    "unbalance": {"unbalance__a": 0.01, "unbalance__phi": 1.0},
    "friction_drift": {"friction_drift__rise": 0.5, "friction_drift__tau": 2.0},
}
VARIOUS = ("knob1", "knob5", *HIDDEN, *GIVEN)
"""Models of every place at which an effect of the knob may act."""


@cache
def various(name: str) -> kc.Model:
    if name in GIVEN:
        return knob(name, **GIVEN[name])
    return kc.hiding(HIDDEN[name], name) if name in HIDDEN else kc.Model.load(name)


CASES = [
    (name, motion)
    for name, motion in product(VARIOUS, MOTIONS)
    if motion == "hand" or name in ("knob1", "backlash")
]
"""All of them on one motion, two on all; `benches/study_convert.py` goes through all of both."""
STEPPING = ("c", "fmu", "modelica")


def right(conversion: Conversion) -> bool:
    """Whether it is as near as it says: exact, or wrong by what was foretold, to a tenth."""
    error, foretold = conversion.measured_error, conversion.predicted_error
    assert error is not None, conversion.measured.why_not
    if any(fate.kind == "approximate" for fate in conversion.fates):
        return abs(foretold - error) <= 0.1 * error + 1e-9 * conversion.measured.torque
    return foretold == 0.0 and error <= EXACT * conversion.measured.torque


@pytest.mark.parametrize(("name", "motion"), CASES)
def test_what_mujoco_is_said_to_do_exactly_it_does(name: str, motion: str) -> None:
    conversion = convert(various(name), "mujoco", motion=MOTIONS[motion])
    assert right(conversion), conversion


@pytest.mark.parametrize(("name", "motion"), CASES)
def test_the_library_renders_what_the_model_predicts(name: str, motion: str) -> None:
    for target in STEPPING if name == "knob1" else STEPPING[:1]:
        conversion = convert(various(name), target, motion=MOTIONS[motion])
        assert right(conversion), conversion


@pytest.mark.parametrize(("name", "motion"), CASES)
def test_what_urdf_costs_is_foretold(name: str, motion: str) -> None:
    conversion = convert(various(name), "urdf", motion=MOTIONS[motion], without=["impossible"])
    assert right(conversion), conversion


@pytest.mark.parametrize(("suffix", "per_turn"), [*product((".csv", ".cfg"), (1, 12, 29, 80))])
def test_what_a_table_rounds_away_is_foretold(suffix: str, per_turn: int) -> None:
    model = knob(detent__P=1.0 / per_turn, detent__S=0.4)
    made = convert(model, "cogging-table", without=["impossible"], kt=0.05, suffix=suffix)
    assert right(made), made


def test_a_table_of_moteus_is_1024_whole_numbers_of_8_bits_that_times_its_scale_are_the_current() -> None:
    model = knob("unbalance", unbalance__a=0.02, unbalance__phi=0.3, detent__P=1.0 / 12, detent__A=0.0)
    made = convert(model, "cogging-table", without=["impossible"], kt=0.05)
    text = made.form.content
    lines = [line.split() for line in str(text).splitlines() if not line.startswith("#")]
    values = {name: float(value) for name, value in lines}
    scale = values.pop("motor.cogging_dq_scale")
    table = np.array([values[f"motor.cogging_dq_comp.{i}"] for i in range(1024)])
    assert len(values) == 1024 and np.abs(table).max() == 127 and (table == np.rint(table)).all()
    current = 0.02 * np.sin(np.arange(1024) * 2.0 * np.pi / 1024 + 0.3) / 0.05
    assert np.abs(table * scale - current).max() <= 0.5001 * scale


def native() -> kc.Model:
    """A model of nothing but what MJCF has words for."""
    return kc.Model.of(
        [
            "inertia",
            "viscous",
            "detent",
            "quadratic_drag",
            "return_spring",
            "position_polynomial",
            "unbalance",
        ],
        inertia__M=1e-4,
        viscous__neg=3e-3,
        detent__A=0.002,
        detent__P=0.037,
        viscous__pos=3e-3,
        quadratic_drag__d=1e-4,
        return_spring__k=0.02,
        return_spring__theta0=-0.4,
        position_polynomial__p2=0.003,
        position_polynomial__p3=0.01,
        unbalance__a=0.004,
    )


def test_what_mjcf_has_words_for_needs_no_callback() -> None:
    made = convert(native(), "mujoco", motion=MOTIONS["sweep"])
    assert right(made)
    assert {fate.how for fate in made.fates} == {"armature", "damping", "stiffness", "dcmotor cogging"}
    assert "<text" not in str(made.form.content) and made.form.remarks == ()


@pytest.mark.parametrize("target", [name for name in TARGETS if name != "cogging-table"])
def test_a_form_says_what_becomes_of_every_effect_and_its_file_what_is_missing(target: str) -> None:
    model = knob("offset", "torque_lag", offset__tau0=1e-3, torque_lag__delay=1e-3)
    made = convert(model, target, without=["impossible"], motion=MOTIONS["hand"])
    assert [fate.effect for fate in made.fates] == list(model.effects)
    gone = [fate.effect for fate in made.fates if fate.left_out]
    assert {"offset", "torque_lag"} <= set(gone)
    assert set(made.kept.effects) == set(model.effects) - set(gone)
    assert all(name in repr(made) for name in model.effects)
    file = made.form.content
    if isinstance(file, bytes):
        file = zipfile.ZipFile(io.BytesIO(file)).read("modelDescription.xml").decode()
    assert all(f"Left out: {name}" in file for name in gone)


@pytest.mark.parametrize("name", ["knob1", "knob4", "return_spring", "quadratic_drag"])
def test_what_is_left_out_costs_what_its_own_law_says_and_all_of_it_what_is_measured(name: str) -> None:
    motion = MOTIONS["hand"]
    made = convert(various(name), "urdf", without=["impossible"], motion=motion)
    cost = {fate.effect: fate.error for fate in made.fates if fate.left_out}
    value = {name: one.value for name, one in made.model.params.items()}
    moves = np.abs(motion.omega) > 1e-9 * np.abs(motion.omega).max()
    theta = motion.theta[moves]
    laws = {
        "detent": lambda: value["detent.A"] * np.sin(theta / value["detent.P"] + value["detent.S"]),
        "return_spring": lambda: value["return_spring.k"] * (theta - value["return_spring.theta0"]),
        "karnopp": lambda: np.zeros_like(theta),  # it holds what stands still
    }
    known = [one for one in laws if one in cost]
    assert known
    for one in known:
        assert cost[one] == pytest.approx(np.sqrt(np.mean(laws[one]() ** 2)), rel=1e-6, abs=1e-12)
    assert made.measured_whole_error == pytest.approx(made.predicted_whole_error, rel=0.1)
    assert max(cost.values()) <= 1.1 * made.predicted_whole_error
    said = {row["effect"]: row["predicted_error"] for row in made.document()["effects"]}
    assert (
        all(said[one] == error for one, error in cost.items()) and "With what is left out: " in made.summary
    )


def test_an_effect_that_does_nothing_is_impossible_nowhere_and_left_out_nowhere() -> None:
    plain = kc.Model.of(["inertia", "coulomb"], inertia__M=1e-4, coulomb__neg=0.01, coulomb__pos=0.01)
    for effect, row in kc.effects().items():
        if effect in plain.effects or row.place == "coupling" or row.needs not in (None, *plain.effects):
            continue
        model = plain.with_effect(effect)
        assert terms_of(model)[effect].neutral
        made = convert(model, "urdf", motion=MOTIONS["hand"])
        assert right(made) and made.kept.effects == ("inertia", "coulomb"), effect


def test_a_model_is_converted_by_its_own_method(tmp_path: Path) -> None:
    made = kc.Model.load("knob1").to("urdf", without=["karnopp"])
    assert made.save(tmp_path / "knob.urdf") == tmp_path / "knob.urdf"
    assert made.measured_error == pytest.approx(made.predicted_error, rel=0.1)
    assert made.plot().axes


def test_the_command_writes_one_document_and_the_file(tmp_path: Path) -> None:
    file = tmp_path / "knob.urdf"
    words = ("convert", "knob4", "--to", "urdf", "--without", "detent", "karnopp", "-o", file)
    ended = knobcam(*words, "--plots", tmp_path, "--json")
    assert ended.code == 0, ended.err
    document = ended.document
    assert document["schema"] == "knobcam.convert/1" and document["to"] == "urdf"
    kinds = {row["effect"]: (row["kind"], row["left_out"]) for row in document["effects"]}
    assert kinds["inertia"] == ("exact", False) and kinds["viscous"] == ("approximate", False)
    assert kinds["detent"] == kinds["karnopp"] == ("impossible", True)
    assert document["measured_error"] == pytest.approx(document["predicted_error"], rel=0.1)
    assert file.is_file() and (tmp_path / "converted.png").is_file()
    assert "approximate" in knobcam(*words).out


def in_amperes() -> str:
    text = kc.Model.of(["inertia", "coulomb"], torque_unit="A", inertia__M=1e-3, coulomb__pos=0.1).text()
    assert "A" in text
    return text


def test_a_wrong_call_says_one_line_and_writes_nothing(tmp_path: Path) -> None:
    def call(model: object, *words: object) -> None:
        refused(knobcam("convert", str(model), *map(str, words)), *expected)

    out = tmp_path / "out"
    expected = ("impossible in urdf", "detent, karnopp", "--without impossible", "in N m RMS", "detent 0.00")
    call("knob4", "--to", "urdf", "-o", out)
    expected = (f"{out}: a unit of FMI ends in .fmu",)
    call("knob4", "--to", "fmu", "-o", out)
    expected = ("detent", "does not repeat after a turn")
    call("knob4", "--to", "cogging-table", "--without", "impossible", "-o", out)
    expected = ("moteus", "--kt")
    whole = tmp_path / "whole.toml"
    knob(detent__P=1.0 / 12).save(whole)
    call(whole, "--to", "cogging-table", "--without", "impossible", "-o", out)
    expected = ("fmi=3", "leave it out of c")
    call("knob4", "--to", "c", "--fmi", "3", "-o", out)
    expected = ("--fmi: belongs to another form",)
    call("knob4", "--fmi", "3", "-o", out)
    expected = ("--to: 'simulink' is none that there is; choose mujoco, c, fmu",)
    call("knob4", "--to", "simulink", "-o", out)
    expected = ("without stribeck", "is no effect of the model")
    call("knob4", "--to", "c", "--without", "stribeck", "-o", out)
    expected = ("is in A", "--kt KT")
    (tmp_path / "motor.toml").write_text(in_amperes())
    call(tmp_path / "motor.toml", "--to", "c", "-o", out)
    expected = ("viscous.pos", "feeds the hand", "correct it")
    feeding = tmp_path / "feeding.toml"
    knob(viscous__pos=-0.05).save(feeding)
    call(feeding, "--to", "c", "-o", out)
    call(feeding, "--to", "mujoco", "-o", out)
    feeding.unlink()
    expected = ("--motion: belongs to another form",)
    call("knob4", "--motion", "hand", "-o", out)
    expected = ("is needed",)
    call("knob4", "-o", out)
    expected = (str(tmp_path / "none"),)
    call("knob4", "--to", "c", "-o", tmp_path / "none" / "knob.h")
    expected = (str(tmp_path), "folder")
    call("knob4", "--to", "c", "-o", tmp_path)
    assert not out.exists()
    assert sorted(path.name for path in tmp_path.iterdir()) == ["motor.toml", "whole.toml"]


def test_a_model_in_amperes_leaves_by_its_torque_constant(tmp_path: Path) -> None:
    (tmp_path / "motor.toml").write_text(in_amperes())
    ended = knobcam(
        "convert", tmp_path / "motor.toml", "--to", "c", "--kt", "0.1", "-o", tmp_path / "k.h", "--json"
    )
    assert ended.document["unit"] == "N m"


def test_a_form_takes_the_motion_at_its_own_rate_and_the_command_knows_every_form() -> None:
    assert tuple(TARGETS) == converting.FORMS
    with pytest.raises(kc.InputError, match="motion: has 5000 samples a second; give one of rate_hz=1000"):
        convert("knob1", "c", motion=MOTIONS["hand"], rate_hz=1000.0)
    made = convert("knob1", "c", motion="hand", rate_hz=1000.0, without=["viscous"])
    assert right(made) and "Left out: viscous (by request), " in str(made.form.content)


def test_a_function_in_python_is_impossible_outside_of_it_and_rendered_in_mujoco() -> None:
    @kc.own_effect("wiggle", law="a sin(5 theta) cos(theta)", a=kc.OwnParameter("N m"))
    def wiggle(motion: kc.OwnMotion, a: float) -> np.ndarray:
        return a * np.sin(5.0 * motion.theta) * np.cos(motion.theta)

    try:
        model = knob("wiggle", wiggle__a=1e-3)
        with pytest.raises(kc.InputError, match=r"impossible in c: wiggle \(is a function in Python"):
            convert(model, "c")
        assert convert(model, "c", without=["wiggle"]).fates[-1].left_out
        assert right(convert(model, "mujoco", motion=kc.motion("hand", 0.2)))
    finally:
        kc.forget_effect("wiggle")


def test_knocks_that_rounding_parts_are_said_and_nothing_is_where_all_is_as_foretold() -> None:
    knob = kc.Model.load("knob4").with_effect("backlash").with_value("backlash.gap", 0.01)
    knob = knob.with_value("backlash.k", 50.0)
    said = {}
    for damping in (0.01, 0.05):
        made = knob.with_value("backlash.d", damping).to("c", motion="hand")
        said[damping] = [one for one in made.remarks if one.startswith("More is measured")]
        assert made.document()["remarks"] == list(made.remarks)
    assert [len(lines) for lines in said.values()] == [1, 0] and "knock" in said[0.01][0]
