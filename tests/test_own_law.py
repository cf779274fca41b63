"""Effects of one's own as formulas: what the catalogue has they repeat, a model file carries them."""

from __future__ import annotations

import dataclasses
from pathlib import Path

import numpy as np
import pytest
from brake import braked_knob
from command import knobcam, refused

import knobcam as kc
from knobcam.rig.emulator import EmulatedRig
from knobcam.rig.record import record

BRAKE = "2 a (omega/w) / (1 + (omega/w)^2)"


@pytest.fixture(scope="module")
def braked() -> kc.Capture:
    return braked_knob(0.008, 2.0)


def test_a_law_that_repeats_an_effect_is_that_effect() -> None:
    knob = kc.Model.load("knob4").with_effect("quadratic_drag").with_value("quadratic_drag.d", 3e-4)
    capture = kc.simulate(knob, "sweep", duration_s=3.0, seed=1)
    row = kc.own_law("drag_law", "d omega |omega|")["d"]
    assert row.unit == "N m s^2/rad^2" and row.linear
    base = kc.fit(capture)
    own, known = base.add("drag_law"), base.add("quadratic_drag")
    assert own.rmse == pytest.approx(known.rmse, rel=1e-12)
    mine, theirs = own.params["drag_law.d"], known.params["quadratic_drag.d"]
    assert mine.value == pytest.approx(theirs.value, rel=1e-9)
    assert mine.se == pytest.approx(theirs.se, rel=1e-6)


def test_a_factor_on_friction_that_repeats_an_effect_is_that_effect() -> None:
    knob = kc.Model.load("knob4").with_effect("stribeck")
    values = {"rise": 0.8, "vs": 0.4, "delta": 1.5}
    for name, value in values.items():
        knob = knob.with_value(f"stribeck.{name}", value)
    kc.own_law("stribeck_law", "1 + rise exp(-(|omega|/vs)^delta)", acts="friction")
    own = kc.Model.load("knob4").with_effect("stribeck_law")
    for name, value in values.items():
        own = own.with_value(f"stribeck_law.{name}", value)
    quiet = {"duration_s": 1.0, "noise": "none"}
    np.testing.assert_allclose(
        kc.simulate(own, "sweep", **quiet).tau, kc.simulate(knob, "sweep", **quiet).tau, atol=1e-12
    )
    theta, omega = np.linspace(0.0, 1.0, 50), np.linspace(-3.0, 3.0, 50)
    felt = [kc.Renderer(model, rate_hz=5000.0) for model in (own, knob)]
    one, other = ([render.step(a, b) for a, b in zip(theta, omega, strict=True)] for render in felt)
    np.testing.assert_allclose(one, other, atol=1e-12)


MINE = """schema = "knobcam.model/1"
[effects.inertia]
M = 7e-5
[effects.coulomb]
neg = 0.01
pos = 0.01
[effects.viscous]
neg = 1e-3
pos = 1e-3
[effects.mine]
"""


def test_a_model_has_its_laws_for_itself(braked: kc.Capture) -> None:
    one = kc.Model.parse(MINE + 'law = "a sin(theta)"\na = 0.01\n')
    other = kc.Model.parse(MINE + 'law = "a exp(-s/b) direction"\na = 0.02\nb = 0.3\n')
    assert "mine" not in kc.effects()
    assert one.catalogue()["mine"].law == "a sin(theta)" and other.catalogue()["mine"].params[1].unit == "rad"
    assert kc.Model.parse(one.text()) == one != other
    for model in (one, other):
        fitted = kc.fit(braked, model)
        assert "mine.a" in fitted.params and "mine" in repr(fitted.compare().fit)
        assert fitted.drop("mine").rmse >= fitted.rmse
    # What was read is in no search of another capture.
    assert "mine" not in {one.effect for one in kc.fit(braked).diagnose().candidates}
    with pytest.raises(kc.InputError, match="'mine' is not in the catalogue"):
        kc.fit(braked).add("mine")


def test_a_law_of_the_distance_since_a_reversal_is_found_in_data_that_were_made_without_it() -> None:
    plain = kc.simulate("knob4", "sweep", duration_s=4.0, seed=5)
    track = kc.motion("sweep", 4.0)
    distance, turned, way = np.zeros(len(track.theta)), track.theta[0], np.sign(track.omega)
    for i in range(1, len(distance)):
        turned = track.theta[i - 1] if way[i] != way[i - 1] else turned
        distance[i] = abs(track.theta[i] - turned)
    relaxing = dataclasses.replace(plain, tau=plain.tau + 0.01 * way * np.exp(-distance / 0.2))
    kc.own_law("relaxation", "a direction exp(-s/b)", bounds={"b": (0.01, 5.0)})
    base = kc.fit(relaxing)
    fitted = base.add("relaxation")
    assert fitted.rmse < 1.03 * fitted.noise_floor < base.rmse / 1.2
    assert fitted.params["relaxation.b"].value == pytest.approx(0.2, rel=0.05)


def test_what_a_sensor_adds_is_measured_and_moves_nothing(braked: kc.Capture, tmp_path: Path) -> None:
    plain = kc.simulate("knob4", "sweep", duration_s=3.0, seed=7)
    pulled = dataclasses.replace(plain, tau=plain.tau + 0.02 * kc.motion("sweep", 3.0).theta)
    pulled.save(tmp_path / "log.npz")
    words = ("add", "--law", "g theta", "--acts", "sensor", "--name", "cable", tmp_path / "log.npz", "knob4")
    ended = knobcam(*words, "-o", tmp_path / "better.toml", "--json")
    assert ended.code == 0, ended.err
    assert ended.document["params"]["cable.g"]["value"] == pytest.approx(0.02, rel=0.03)
    assert 'acts = "sensor"' in (tmp_path / "better.toml").read_text("utf-8")
    model = kc.Model.load("knob4").with_effect("cable").with_value("cable.g", 0.01)
    pushed, bare = (kc.simulate(knob, "push", noise="none") for knob in (model, "knob4"))
    np.testing.assert_array_equal(pushed.theta, bare.theta)
    assert np.max(np.abs(pushed.tau - bare.tau)) > 1e-3


LAWS = """
[effects.own_drag]
law = "a omega |omega| + b direction exp(-s/c)"
a = 4e-4
b = 0.004
c = { value = 0.1, lower = 0.01, upper = 1.0 }
[effects.own_wear]
law = "1 + r exp(-t/d)"
acts = "friction"
r = 0.6
d = { value = 2.0, lower = 0.1, upper = 10.0 }
[effects.own_cable]
law = "g theta"
acts = "sensor"
g = 0.006
"""


def test_an_emulated_rig_has_a_knob_with_the_laws_of_its_model(tmp_path: Path) -> None:
    bare = kc.Model.load("knob2")
    stated = kc.Model.parse(bare.text() + LAWS)
    with EmulatedRig(stated.save(tmp_path / "knob.toml"), speed=20.0, noise=False) as rig:
        capture = record(rig.port, "sweep", duration_s=3.0, output=tmp_path / "a.kcwire")
    left = {name: kc.fit(capture, one.frozen()).rmse for name, one in (("bare", bare), ("stated", stated))}
    assert left["stated"] < 0.1 * left["bare"]


def test_a_law_of_the_command_line_explains_what_no_effect_does(braked: kc.Capture, tmp_path: Path) -> None:
    braked.save(tmp_path / "log.npz")
    base = knobcam("fit", tmp_path / "log.npz", "-o", tmp_path / "base.toml")
    assert base.code == 0, base.err
    ended = knobcam(
        *("add", "--law", BRAKE, "--name", "eddy", tmp_path / "log.npz", tmp_path / "base.toml"),
        *("-o", tmp_path / "better.toml", "--json"),
    )
    assert ended.code == 0, ended.err
    params = ended.document["params"]
    for name, value, unit in (("a", 0.004, "N m"), ("w", 2.0, "rad/s")):
        low, high = params[f"eddy.{name}"]["ci95"]
        assert low - (high - low) < value < high + (high - low) and params[f"eddy.{name}"]["unit"] == unit
    # Whoever reads the model has the law, without having seen it before.
    kc.forget_effect("eddy")
    model = kc.Model.load(tmp_path / "better.toml")
    assert f'law = "{BRAKE}"' in (tmp_path / "better.toml").read_text("utf-8")
    fitted = kc.fit(braked, model)
    assert fitted.rmse < 1.03 * fitted.noise_floor < kc.fit(braked).rmse / 1.2


@pytest.mark.parametrize(
    ("law", "said"),
    [
        ("a * (theta", "')'"),
        ("a foo(theta)", "'foo' is no function"),
        ("a + theta", "another unit"),
        ("a b omega", "give it"),
        ("a" * 2000, "2000 characters"),
        ("(" * 999, "brackets"),
        ("a (1 + omega)", "other units"),
        ("a theta + b - b", "'b' changes nothing"),
    ],
)
def test_what_is_no_law_is_refused_in_one_line(law: str, said: str, tmp_path: Path) -> None:
    kc.simulate("knob4", "hand", duration_s=1.0).save(tmp_path / "log.npz")
    refused(knobcam("add", "--law", law, tmp_path / "log.npz", "knob4"), said)


def test_options_of_a_law_without_one_are_refused() -> None:
    refused(knobcam("add", "stribeck", "log.npz", "knob4", "--name", "x"), "--law")
    refused(knobcam("add", "stribeck", "log.npz", "knob4", "--acts", "friction"), "--law")
    refused(knobcam("add", "--law", "a omega", "--name", "viscous", "log.npz", "knob4"), "is an effect")


def test_a_law_that_has_no_value_somewhere_says_where() -> None:
    kc.own_law("steep", "a log(theta/c)", bounds={"c": (0.1, 1.0)})
    model = kc.Model.load("knob4").with_effect("steep").with_value("steep.a", 1e-3)
    with pytest.raises(kc.InputError, match=r"'steep': returned NaN at theta = "):
        kc.simulate(model, kc.motion("sweep", 3.0))
    with pytest.raises(kc.InputError, match="steep"):
        kc.Renderer(model, rate_hz=5000.0)
