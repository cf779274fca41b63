"""Motors without a torque sensor: a current, a voltage or a duty cycle stands for the torque."""

from __future__ import annotations

import math
import pickle
from pathlib import Path

import numpy as np
import pytest
from command import knobcam, refused

import knobcam as kc
from knobcam.capture.quality.torque import Limit
from knobcam.errors import InputError

KT = 0.05  # N m/A
UNITS = {
    "inertia.M": "A s^2/rad",
    "coulomb.neg": "A",
    "coulomb.pos": "A",
    "viscous.neg": "A s/rad",
    "viscous.pos": "A s/rad",
    "detent.A": "A",
    "detent.P": "rad",
    "detent.S": "rad",
}


@pytest.fixture(scope="module")
def torque() -> kc.Capture:
    """A motor whose torque was measured."""
    return kc.simulate("knob4", "sweep", duration_s=3.0)


@pytest.fixture(scope="module")
def current(torque: kc.Capture) -> kc.Capture:
    """The same, of which the current is known."""
    return of(torque, torque.tau / KT, "A")


@pytest.fixture(scope="module")
def fitted(current: kc.Capture) -> kc.Fit:
    return kc.fit(current)


def of(motion: kc.Capture, given: np.ndarray, unit: str) -> kc.Capture:
    columns = {name: values for name, values in motion.columns.items() if name != "tau"}
    meta = {"source": f"motor in {unit}"}
    return kc.Capture.from_arrays(**columns, tau=given, torque_unit=unit, meta=meta)


def test_a_fit_of_a_current_is_that_of_the_torque_in_amperes(torque: kc.Capture, fitted: kc.Fit) -> None:
    beside = kc.fit(torque)
    assert {name: estimate.unit for name, estimate in fitted.params.items()} == UNITS
    for name, estimate in fitted.params.items():
        factor = 1.0 if name in ("detent.P", "detent.S") else KT
        assert factor * estimate.value == pytest.approx(beside.params[name].value, rel=1e-4), name
    assert KT * fitted.rmse == pytest.approx(beside.rmse, rel=1e-6)
    assert KT * fitted.noise_floor == pytest.approx(beside.noise_floor, rel=1e-3)


def test_every_figure_of_a_current_is_in_amperes(fitted: kc.Fit, tmp_path: Path) -> None:
    comparison = fitted.compare()
    said = "\n".join(map(repr, (fitted, fitted.model, comparison, fitted.add("offset"))))
    assert " A (" in said and " A s^2/rad" in said
    assert "N m" not in said
    assert fitted.document()["unit"] == comparison.document()["unit"] == "A"
    (load,) = [split for split in comparison.splits if split.axis == "load"]
    assert load.unit == "A"
    axes = fitted.plot().axes
    assert any("current" in one.get_ylabel() and "(A)" in one.get_ylabel() for one in axes)
    assert not any("Nm" in one.get_ylabel() for one in axes)
    assert "(A)" in fitted.signals.capture.plot().axes[-1].get_ylabel()


def test_a_model_of_a_current_says_so_in_its_file(fitted: kc.Fit, tmp_path: Path) -> None:
    path = fitted.model.save(tmp_path / "motor.toml")
    text = path.read_text()
    assert 'torque_unit = "A"' in text and "# A s^2/rad" in text
    assert kc.Model.load(path) == fitted.model
    assert pickle.loads(pickle.dumps(fitted.model)).torque_unit == "A"
    path.write_text(text.replace('"A"', '"N cm"', 1))
    with pytest.raises(InputError, match=r'motor\.toml.*torque_unit.*must be "A", "V" or "duty"'):
        kc.Model.load(path)


@pytest.mark.parametrize("name", ["run.npz", "run.csv", "run.parquet"])
@pytest.mark.parametrize("unit", ["A", "V", "duty"])
def test_a_capture_keeps_its_unit_in_a_file(name: str, unit: str, torque: kc.Capture, tmp_path: Path) -> None:
    capture = of(torque, torque.tau, unit)
    back = kc.load(capture.save(tmp_path / name))
    assert (back.torque_unit, back.units["tau"]) == (unit, unit)
    np.testing.assert_array_equal(back.tau, capture.tau)
    assert pickle.loads(pickle.dumps(back)).torque_unit == unit


def test_a_map_says_the_unit_and_computes_what_stands_for_the_torque(tmp_path: Path) -> None:
    t = np.arange(200) / 100.0
    columns = np.column_stack([t, np.sin(t), 1e3 * np.cos(t), 0.5 * np.cos(t), 12.0 + 0.0 * t])
    path = tmp_path / "run.csv"
    np.savetxt(path, columns, delimiter=",", header="t,pos,iq,duty,supply", comments="")
    for text, unit, peak in (
        ("tau=iq [mA]", "A", 1.0),
        ("tau=duty [duty]", "duty", 0.5),
        ("tau=50*iq/1000 [%]", "duty", 0.5),
        ("tau=duty*supply [V]", "V", 6.0),
        ("tau=0.05*iq/1000", "N m", 0.05),
    ):
        capture = kc.load(path, map=f"t=t, theta=pos, {text}")
        assert capture.torque_unit == unit
        assert capture.tau.max() == pytest.approx(peak)


def test_no_unit_but_those_of_the_axis_and_of_motors_is_taken() -> None:
    with pytest.raises(InputError, match=r"torque_unit='W' is unknown; choose N m, A, V, duty"):
        kc.Model.of(["inertia"], torque_unit="W")
    with pytest.raises(InputError, match=r"torque_unit='N m' is unknown; choose N, A, V, duty"):
        kc.Model.of(["inertia"], "linear", torque_unit="N m")


def test_what_no_hand_turns_is_said_of_a_torque_and_of_no_motor(tmp_path: Path) -> None:
    t = np.arange(1000) / 500.0
    path = tmp_path / "run.csv"
    np.savetxt(
        path,
        np.column_stack([t, 500.0 * np.sin(t), 40.0 * np.cos(t)]),
        delimiter=",",
        header="t,x,i",
        comments="",
    )
    for text, told in (("tau=i", {"theta", "tau"}), ("tau=i [A]", set()), ("tau=i [V]", set())):
        findings = kc.load(path, map=f"t=t, theta=x, {text}").findings
        assert {one.column for one in findings if one.kind == "unit"} == told


def test_torques_of_different_units_are_no_one_fit(
    torque: kc.Capture, current: kc.Capture, fitted: kc.Fit
) -> None:
    with pytest.raises(
        InputError, match=r"different units, .* in N m and motor in A in A, cannot be one fit"
    ):
        kc.fit([torque, current])
    with pytest.raises(InputError, match="the model is in N m, motor in A in A; convert"):
        kc.fit(current, "knob4")
    with pytest.raises(InputError, match=r"the model is in A, .* in N m; convert"):
        fitted.compare(torque)
    with pytest.raises(InputError, match="the model is in A"):
        fitted.predict(torque)


def test_a_model_of_a_current_is_not_rendered(fitted: kc.Fit, tmp_path: Path) -> None:
    for tried in (kc.Renderer, kc.check_stability):
        with pytest.raises(
            InputError, match=r"is in A, and a hand feels torque; .*knobcam convert MODEL --kt"
        ):
            tried(fitted.model)
    path = fitted.model.save(tmp_path / "motor.toml")
    refused(knobcam("render", path, "--seconds", "1"), "is in A", "knobcam convert MODEL --kt KT")


def test_what_is_learned_of_a_current_is_told_in_amperes(torque: kc.Capture) -> None:
    knob = kc.Model.load("knob4").with_effect("return_spring").with_value("return_spring.k", 0.004)
    sprung = kc.simulate(knob, "sweep")
    story = kc.learn(of(sprung, sprung.tau / KT, "A"))
    assert story.found == ("return_spring",)
    assert story.document()["unit"] == "A"
    assert "N m" not in repr(story) + story.headline
    last = story.document()["ladder"][-1]["params"]["return_spring.k"]
    assert last["unit"] == "A/rad" and KT * last["value"] == pytest.approx(0.004, rel=0.05)
    assert not math.isnan(story.noise_floor)


def test_a_current_is_converted_by_the_torque_constant(
    torque: kc.Capture, current: kc.Capture, fitted: kc.Fit, tmp_path: Path
) -> None:
    capture, model = current.as_torque(kt=KT), fitted.model.as_torque(kt=KT)
    assert (capture.torque_unit, model.torque_unit) == ("N m", "N m")
    np.testing.assert_allclose(capture.tau, torque.tau, rtol=1e-12)
    assert capture.meta["motor"] == {"of": "A", "kt": KT, "resistance_ohm": None}
    for name, parameter in kc.fit(capture).model.params.items():
        assert model.params[name].unit == parameter.unit
        assert model.params[name].value == pytest.approx(parameter.value, rel=1e-4), name
    kc.Renderer(model)
    path = current.save(tmp_path / "motor.npz")
    np.testing.assert_array_equal(kc.load(path, kt=KT).tau, capture.tau)
    assert kc.load(capture.save(tmp_path / "torque.npz")).torque_unit == "N m"


def test_a_voltage_is_converted_without_its_back_emf(torque: kc.Capture) -> None:
    ohm = 2.0
    assert torque.omega is not None
    voltage = of(torque, torque.tau * ohm / KT + KT * torque.omega, "V")
    fitted = kc.fit(voltage)
    (said,) = [one for one in fitted.warnings if "back-EMF" in one]
    assert said.startswith("viscous.neg and viscous.pos hold the motor's back-EMF beside its friction")
    model = fitted.model.as_torque(kt=KT, resistance_ohm=ohm)
    beside = kc.fit(voltage.as_torque(kt=KT, resistance_ohm=ohm))
    for name, parameter in kc.fit(torque).params.items():
        for found in (model.params[name].value, beside.params[name].value):
            assert found == pytest.approx(parameter.value, rel=2e-3, abs=2e-6), name
    assert not any("back-EMF" in one for one in beside.warnings)


@pytest.mark.parametrize(
    ("unit", "options", "why"),
    [
        ("N m", {"kt": KT}, "in N m already"),
        ("A", {"kt": -1.0}, "kt = -1.0 must be a positive number"),
        ("A", {"kt": math.nan}, "kt: is NaN"),
        ("A", {"kt": KT, "resistance_ohm": 1.0}, "leave the resistance out"),
        ("V", {"kt": KT}, "needs the resistance"),
        ("V", {"kt": None, "resistance_ohm": 1.0}, "needs kt"),
        ("V", {"kt": KT, "resistance_ohm": 0.0}, "resistance = 0.0 must be"),
        ("duty", {"kt": KT, "resistance_ohm": 1.0}, r"tau=duty\*SUPPLY \[V\]"),
    ],
)
def test_what_cannot_be_converted_says_what_is_missing_or_too_much(
    unit: str, options: dict[str, float | None], why: str, torque: kc.Capture
) -> None:
    with pytest.raises(InputError, match=why):
        of(torque, torque.tau, unit).as_torque(**options)
    with pytest.raises(InputError, match=why):
        kc.Model.of(["inertia"], torque_unit=unit).as_torque(**options)


def test_the_command_converts_captures_and_models(
    current: kc.Capture, fitted: kc.Fit, tmp_path: Path
) -> None:
    path, model = current.save(tmp_path / "motor.npz"), fitted.model.save(tmp_path / "motor.toml")
    new = tmp_path / "knob.toml"
    ended = knobcam("convert", model, "--kt", str(KT), "-o", new, "--json")
    assert ended.document["unit"] == "N m"
    assert ended.document["params"]["inertia.M"]["unit"] == "N m s^2/rad"
    assert kc.Model.load(new) == fitted.model.as_torque(kt=KT)
    told = knobcam("compare", path, new, "--kt", str(KT), "--json").document
    assert told["unit"] == "N m"
    refused(knobcam("compare", path, new), "the model is in N m", "--kt")
    refused(knobcam("convert", new, "--kt", "1", "-o", model), "in N m already")
    refused(knobcam("fit", path, "--kt", "0"), "motor in A", "kt = 0.0")


@pytest.fixture(scope="module")
def limited(torque: kc.Capture) -> np.ndarray:
    """What a drive gives that ends before the knob does."""
    return np.clip(torque.tau / KT, -0.22, 0.25)


@pytest.mark.parametrize(("unit", "usual"), [("N m", "sensor"), ("A", "actuator"), ("V", "actuator")])
def test_a_torque_at_its_extreme_is_masked_of_a_sensor_and_counts_of_a_drive(
    unit: str, usual: Limit, torque: kc.Capture, limited: np.ndarray, tmp_path: Path
) -> None:
    usually = of(torque, limited, unit)
    path = usually.save(tmp_path / "motor.npz")
    other: Limit = "sensor" if usual == "actuator" else "actuator"
    found = {usual: usually, other: kc.load(path, limit=other)}
    at = np.isin(limited, (-0.22, 0.25))
    assert 0.01 < at.mean() < 0.5
    np.testing.assert_array_equal(found["sensor"].mask, ~at)
    assert found["actuator"].mask.all()
    for limit, kind in (("sensor", "clipped"), ("actuator", "limit")):
        messages = [one.message for one in found[limit].findings if one.kind == kind]
        assert len(messages) == 2
        assert all("the sensor is saturated; masked" in one for one in messages) == (limit == "sensor")
        assert all("the drive's limit, so they count" in one for one in messages) == (limit == "actuator")
        assert kc.load(path, limit=limit).findings == found[limit].findings  # the one that was saved too
    told = knobcam("import", path, "-o", tmp_path / "other.npz", "--limit", other, "--json").document
    assert told["findings"][-1]["kind"] == ("clipped" if other == "sensor" else "limit")


def test_a_limit_is_of_a_sensor_or_of_an_actuator(torque: kc.Capture) -> None:
    with pytest.raises(InputError, match="limit='drive' is unknown; choose sensor or actuator"):
        kc.Capture.from_arrays(
            theta=torque.theta,
            tau=torque.tau,
            t=torque.t,
            limit="drive",  # type: ignore[arg-type]
        )
