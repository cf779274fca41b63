"""Effects of one's own: as good as a built-in one when right, named and refused when not."""

from __future__ import annotations

import json
import os
import pickle
import shutil
import subprocess
import sys
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import knobcam as kc
from knobcam import _core

BASE = ["inertia", "coulomb", "viscous"]
DRAG = kc.OwnParameter("N m s^2/rad^2", linear=True, meaning="drag")
HEIGHT = kc.OwnParameter("N m", linear=True)


def own_drag(motion: kc.OwnMotion, d: float) -> Any:
    return d * motion.omega * np.abs(motion.omega)


def bump(motion: kc.OwnMotion, a: float, c: float, w: float) -> Any:
    return a * np.exp(-(((motion.theta - c) / w) ** 2))


def register_bump(**more: Any) -> None:
    center = kc.OwnParameter("rad", -3.0, 3.0, 0.5)
    width = kc.OwnParameter("rad", 0.01, 1.0, 0.1)
    kc.own_effect("bump", law="a exp(-((theta-c)/w)^2)", a=HEIGHT, c=center, w=width, **more)(bump)


def register_law(function: Callable[..., Any], name: str = "odd") -> kc.Model:
    kc.own_effect(name, law="odd", a=kc.OwnParameter("N m", -1.0, 1.0, 0.01))(function)
    return kc.Model.of([*BASE, name])


def refusal(act: Callable[[], object]) -> str:
    with pytest.raises(kc.InputError) as refused:
        act()
    return str(refused.value)


def own_python(folder: Path, *words: str) -> subprocess.CompletedProcess[str]:
    """Run a fresh Python that finds packages in `folder`."""
    paths = os.pathsep.join([str(folder), str(Path(kc.__file__).parents[1])])
    environment = os.environ | {"PYTHONPATH": paths}
    return subprocess.run(
        [sys.executable, *words], env=environment, capture_output=True, text=True, check=False
    )


@pytest.fixture
def dragged() -> kc.Capture:
    knob = kc.Model.load("knob2").with_effect("quadratic_drag").with_value("quadratic_drag.d", 1e-4)
    return kc.simulate(knob)


def test_a_copy_of_a_built_in_law_predicts_the_same_torque(dragged: kc.Capture):
    kc.own_effect("own_drag", law="d omega |omega|", d=DRAG)(own_drag)
    knobs = [kc.Model.load("knob2").with_effect(name) for name in ("quadratic_drag", "own_drag")]
    built_in, own = (
        kc.simulate(knob.with_value(f"{knob.effects[-1]}.d", 1e-4), noise="none") for knob in knobs
    )
    np.testing.assert_allclose(own.tau, built_in.tau, rtol=1e-13, atol=0.0)


def test_a_copy_of_a_built_in_law_fits_the_same_values_with_the_same_intervals(dragged: kc.Capture):
    kc.own_effect("own_drag", law="d omega |omega|", d=DRAG)(own_drag)
    built_in = kc.fit(dragged, kc.Model.of([*BASE, "quadratic_drag"]))
    own = kc.fit(dragged, kc.Model.of([*BASE, "own_drag"]))
    np.testing.assert_allclose(
        [(e.value, e.se) for e in own.params.values()],
        [(e.value, e.se) for name, e in built_in.params.items() if name != "quadratic_drag.n"],
        rtol=1e-7,
    )
    assert own.params["own_drag.d"].unit == "N m s^2/rad^2"
    assert own.rmse == pytest.approx(built_in.rmse, rel=1e-10)


def test_beside_a_stiff_shaft_a_copy_of_a_built_in_law_acts_the_same():
    kc.own_effect("own_drag", law="d omega |omega|", d=DRAG)(own_drag)
    model = kc.Model.of([*BASE, "compliance"], inertia__M=1e-4, compliance__k=50.0)
    for name in ("k", "d", "share"):
        model = model.with_fixed(f"compliance.{name}")
    built_in, own = (
        model.with_effect(name).with_value(f"{name}.d", 1e-3) for name in ("quadratic_drag", "own_drag")
    )
    torques = [kc.simulate(knob, noise="none", duration_s=2.0).tau for knob in (built_in, own)]
    np.testing.assert_allclose(torques[1], torques[0], atol=1e-3 * np.max(torques[0]))
    capture = kc.simulate(built_in, duration_s=2.0)
    drag = kc.fit(capture, built_in).params["quadratic_drag.d"]
    copy = kc.fit(capture, own).params["own_drag.d"]
    assert abs(copy.value - drag.value) < 0.5 * drag.se
    assert copy.se == pytest.approx(drag.se, rel=0.02)


def test_a_bump_is_fitted_down_to_the_noise_where_the_base_model_fails():
    register_bump()
    truth = {"bump.a": 0.01, "bump.c": 0.8, "bump.w": 0.15}
    knob = kc.Model.load("knob2").with_effect("bump")
    for name, value in truth.items():
        knob = knob.with_value(name, value)
    capture = kc.simulate(knob)
    base = kc.fit(capture)
    fit = kc.fit(capture, base.model.with_effect("bump").with_value("bump.c", 0.7))
    assert base.rmse > 2.0 * base.noise_floor and base.compare().worst is not None
    assert fit.rmse < 1.03 * fit.noise_floor and fit.compare().complete
    for name, value in truth.items():
        assert abs(fit.params[name].value - value) < 4.0 * fit.params[name].se


def test_an_effect_that_remembers_gets_every_stretch_whole():
    lengths = set()

    def relaxing(motion: kc.OwnMotion, a: float) -> Any:
        """A friction that takes 0.1 s to follow a reversal."""
        lengths.add(len(motion.t))
        level, follow, torque = 0.0, 1.0 - np.exp(-np.diff(motion.t, prepend=motion.t[0]) / 0.1), []
        for direction, share in zip(motion.direction, follow, strict=True):
            level += share * (direction - level)
            torque.append(a * level)
        return np.array(torque)

    kc.own_effect("relaxing", law="a z", remembers=True, a=HEIGHT)(relaxing)
    knob = kc.Model.load("knob2").with_effect("relaxing").with_value("relaxing.a", 0.01)
    capture = kc.simulate(knob, rate_hz=2000.0)
    fit = kc.fit(capture, kc.Model.of([*BASE, "relaxing"]))
    assert fit.rmse < 1.03 * fit.noise_floor
    assert abs(fit.params["relaxing.a"].value - 0.01) < 4.0 * fit.params["relaxing.a"].se
    assert lengths == {capture.samples}


def test_a_law_sees_the_motion_read_only_and_the_sign_where_it_is_certain():
    seen: list[kc.OwnMotion] = []

    def look(motion: kc.OwnMotion, a: float) -> Any:
        seen.append(motion)
        return a * motion.direction

    kc.simulate(register_law(look), noise="none")
    motion = seen[0]
    moving = np.abs(motion.omega) > 0.0
    np.testing.assert_array_equal(motion.direction[moving], np.sign(motion.omega[moving]))
    with pytest.raises(ValueError, match="read-only"):
        motion.theta[0] = 1.0


def test_an_effect_of_ones_own_stands_in_the_catalogue_and_is_drawn():
    register_bump(source="a magnet", shows="over position")
    entry = kc.effects()["bump"]
    assert (entry.place, entry.law, entry.source) == ("load", "a exp(-((theta-c)/w)^2)", "a magnet")
    assert [(p.name, p.unit) for p in entry.params] == [("a", "N m"), ("c", "rad"), ("w", "rad")]
    assert [p.unit for p in kc.effects("linear")["bump"].params] == ["N", "m", "m"]
    assert entry.plot().axes


def test_an_effect_that_was_forgotten_stands_in_no_catalogue_whoever_came_after_it():
    register_bump()
    register_law(lambda motion, a: a * motion.theta, "newer")
    assert {"bump", "newer"} <= set(kc.effects())
    kc.forget_effect("bump")
    assert "newer" in kc.effects() and "bump" not in kc.effects()


def test_a_fit_with_an_effect_of_ones_own_is_drawn_and_printed():
    register_bump()
    capture = kc.simulate(kc.Model.load("knob2"), duration_s=2.0)
    fit = kc.fit(capture, kc.Model.of([*BASE, "bump"]).with_value("bump.a", 0.001))
    assert "bump.a" in repr(fit) and "bump" in fit.document()["effects"]
    assert fit.plot().axes and fit.compare().plot().axes and fit.model.plot().axes


def test_a_model_file_needs_the_effect_and_says_so_by_name(tmp_path: Path):
    bent = kc.OwnParameter("rad", neutral=0.1, meaning="two\nlines")
    kc.own_effect("bump", law="a # b\n\x00c", a=bent)(lambda motion, a: a * motion.theta)
    model = kc.Model.of([*BASE, "bump"]).with_value("bump.a", 0.1)
    path = model.save(tmp_path / "model.toml")
    assert kc.Model.load(path) == model
    assert pickle.loads(pickle.dumps(model)) == model
    kc.forget_effect("bump")
    said = refusal(lambda: kc.Model.load(path))
    assert "model.toml" in said and "'bump'" in said and "registered" in said
    assert "'bump'" in refusal(lambda: kc.forget_effect("bump"))


def test_an_effect_registered_anew_is_another_one_for_new_models_only(dragged: kc.Capture):
    kc.own_effect("own_drag", law="d omega |omega|", d=DRAG)(own_drag)
    before = kc.Model.of([*BASE, "own_drag"]).with_value("own_drag.d", 1e-4)
    torque = kc.simulate(before, noise="none").tau
    kc.own_effect("own_drag", law="none", d=DRAG)(lambda motion, d: 0.0 * motion.omega)
    after = kc.Model.of([*BASE, "own_drag"]).with_value("own_drag.d", 1e-4)
    np.testing.assert_array_equal(kc.simulate(before, noise="none").tau, torque)
    assert np.all(kc.simulate(after, noise="none").tau == 0.0)
    assert kc.effects()["own_drag"].law == "none"
    assert "already" in refusal(lambda: before.with_effect("own_drag"))


def fails(motion: kc.OwnMotion, a: float) -> Any:
    raise ZeroDivisionError("the magnet\nis gone")


def is_nan(motion: kc.OwnMotion, a: float) -> Any:
    return np.where(motion.theta > 0.0, np.nan, a)


def is_column(motion: kc.OwnMotion, a: float) -> Any:
    return a * motion.theta[:, None]


def is_scalar(motion: kc.OwnMotion, a: float) -> Any:
    return a


def is_complex(motion: kc.OwnMotion, a: float) -> Any:
    return a * motion.theta * 1j


def is_text(motion: kc.OwnMotion, a: float) -> Any:
    return np.full(len(motion.t), "a")


@pytest.mark.parametrize(
    ("law", "why"),
    [
        (fails, "raised ZeroDivisionError: the magnet is gone"),
        (is_nan, "returned NaN at theta = "),
        (is_column, "one torque a sample"),
        (is_scalar, "shape ()"),
        (is_complex, "complex128"),
        (is_text, "real numbers"),
    ],
)
def test_a_law_that_fails_is_named_with_its_values_and_the_cause(
    law: Callable[..., Any], why: str, capture: kc.Capture
):
    model = register_law(law)
    for act in (lambda: kc.fit(capture, model), lambda: kc.simulate(model)):
        said = refusal(act)
        assert "effect 'odd'" in said and why in said and "(with a = 0.01)" in said
    assert kc.fit(capture).rmse > 0.0  # what the effect is no part of goes on


def test_a_diagnosis_finds_the_right_own_effect_and_leaves_a_failing_one_out():
    register_bump(starts=[{"c": c} for c in np.linspace(-1.0, 1.0, 9)])
    register_law(fails)
    knob = kc.Model.load("knob2").with_effect("bump").with_value("bump.a", 0.01).with_value("bump.c", 0.8)
    base = kc.fit(kc.simulate(knob))
    found = _core.diagnose(
        [base.signals.core], base.model.core, ["odd", "quadratic_drag", "unbalance", "bump"]
    )
    effects = {effect: (fit, note) for effect, fit, *_, note in found}
    assert found[0][0] == "bump" and found[0][1].rmse < 1.03 * base.noise_floor
    assert effects["odd"][0] is None and "is gone" in effects["odd"][1]
    assert effects["quadratic_drag"][0] is not None and effects["unbalance"][0] is not None


def test_a_hidden_effect_of_ones_own_is_learned_first_whatever_else_fails():
    register_bump(starts=[{"c": c} for c in np.linspace(-1.0, 1.0, 9)])
    register_law(is_nan)
    knob = kc.Model.load("knob2").with_effect("bump").with_value("bump.a", 0.01).with_value("bump.c", 0.8)
    story = kc.learn(kc.simulate(knob, duration_s=3.0))
    assert (story.verdict, story.found) == ("missing", ("bump",))
    assert story.fit.params["bump.c"].value == pytest.approx(0.8, abs=0.01)
    assert "returned NaN" in story.first_diagnosis.left_out["odd"]
    assert "odd" not in [one.effect for one in story.last.candidates]


def test_what_evaluates_a_law_that_fails_raises_what_is_wrong_with_it(capture: kc.Capture):
    healthy = True

    def law(motion: kc.OwnMotion, a: float) -> Any:
        return a * np.sin(9.0 * motion.theta) if healthy else fails(motion, a)

    fitted = kc.fit(capture, register_law(law))
    healthy = False
    for act in (fitted.compare, fitted.diagnose, fitted.stiction, lambda: fitted.add("stribeck")):
        assert "effect 'odd'" in refusal(act)


@pytest.mark.parametrize("kind", [np.int8, np.float32])
def test_whole_numbers_and_single_precision_are_torques_too(kind: type):
    model = register_law(lambda motion, a: np.sign(motion.omega).astype(kind))
    assert set(kc.simulate(model, noise="none").tau) == {-1.0, 1.0}


def test_a_law_that_is_not_linear_as_declared_is_refused(capture: kc.Capture):
    kc.own_effect("square", law="a^2", a=HEIGHT)(lambda motion, a: a**2 * motion.theta)
    kc.own_effect("product", law="a b", a=HEIGHT, b=HEIGHT)(lambda motion, a, b: a * b * motion.theta)
    for name, which in (("square", "to a,"), ("product", "to a, b,")):
        said = refusal(lambda name=name: kc.fit(capture, kc.Model.of([*BASE, name])))
        assert f"effect '{name}': is not proportional {which}" in said


def test_an_effect_that_remembers_is_refused_where_a_hand_pushes_sample_by_sample():
    kc.own_effect("late", law="a", remembers=True, a=HEIGHT)(lambda motion, a: a * motion.theta)
    knob = kc.Model.load("knob2").with_effect("late")
    assert "effect 'late': remembers" in refusal(lambda: kc.simulate(knob, "push", duration_s=0.1))


def test_ctrl_c_in_a_law_is_no_failure_of_it(capture: kc.Capture):
    def interrupted(motion: kc.OwnMotion, a: float) -> Any:
        raise KeyboardInterrupt

    model = register_law(interrupted)
    with pytest.raises(KeyboardInterrupt):
        kc.fit(capture, model)


SHAPE = kc.OwnParameter("rad", -1.0, 1.0)


@pytest.mark.parametrize(
    ("name", "more", "said"),
    [
        ("viscous", {"a": SHAPE}, "effect 'viscous': is built in"),
        ("a b", {"a": SHAPE}, "'a b'"),
        ("", {"a": SHAPE}, "effect ''"),
        ("bôsse", {"a": SHAPE}, "effect 'bôsse'"),
        ("own", {}, "no parameter"),
        ("own", {"b": SHAPE}, "must take (motion, b): missing a required argument: 'a'"),
        ("own", {"a": SHAPE, "w": SHAPE}, "unexpected keyword argument 'w'"),
        ("own", {"a": 3.0}, "OwnParameter"),
        ("own", {"a": kc.OwnParameter("mNm")}, "parameter 'own.a': unit 'mNm': is no unit"),
        ("own", {"a": kc.OwnParameter("rad", 1.0, 1.0, 1.0)}, "'own.a': has the bounds [1, 1]"),
        ("own", {"a": kc.OwnParameter("rad", 1.0, 2.0)}, "'own.a': is neutral at 0"),
        ("own", {"a": kc.OwnParameter("rad", 0.0, linear=True)}, "'own.a': a linear one has no bounds"),
        ("own", {"a": SHAPE, "starts": [{"a": 3.0}]}, "'own.a': starts at"),
        ("own", {"a": SHAPE, "starts": [{"q": 3.0}]}, "'q'"),
    ],
)
def test_what_cannot_be_registered_is_refused_by_name(name: str, more: dict[str, Any], said: str):
    def register() -> object:
        return kc.own_effect(name, law="a", **more)(lambda motion, a: a * motion.theta)

    assert said in refusal(register)
    assert name not in kc.effects() or name == "viscous"


def test_two_fits_at_a_time_do_not_disturb_each_other(dragged: kc.Capture):
    kc.own_effect("own_drag", law="d omega |omega|", d=DRAG)(own_drag)
    good, bad = kc.Model.of([*BASE, "own_drag"]), register_law(fails)
    alone = kc.fit(dragged, good)
    with ThreadPoolExecutor(4) as threads:
        fits = [threads.submit(kc.fit, dragged, model) for model in [good, bad] * 6]
    for fit in fits[::2]:
        assert fit.result().params == alone.params
    for fit in fits[1::2]:
        assert "effect 'odd'" in refusal(fit.result)


PLUGIN = """
import knobcam as kc

@kc.own_effect("from_plugin", law="k theta", k=kc.OwnParameter("N m/rad", linear=True))
def from_plugin(motion, k):
    assert "from_plugin" in kc.effects()
    return k * motion.theta
"""


@pytest.fixture(params=["folder", "archive"])
def installed(tmp_path: Path, request: pytest.FixtureRequest) -> Path:
    """Where a package is installed that brings one effect, and one that is broken."""
    (tmp_path / "goodplug.py").write_text(PLUGIN)
    (tmp_path / "badplug.py").write_text("raise OSError('no magnet')")
    for name in ("goodplug", "badplug"):
        about = tmp_path / f"{name}-1.0.dist-info"
        about.mkdir()
        (about / "METADATA").write_text(f"Metadata-Version: 2.1\nName: {name}\nVersion: 1.0\n")
        (about / "entry_points.txt").write_text(f"[knobcam.effects]\nmagnets = {name}\n")
    if request.param == "archive":
        return Path(shutil.make_archive(str(tmp_path / "packages"), "zip", tmp_path))
    return tmp_path


def test_effects_of_an_installed_package_are_found_and_a_broken_one_is_named(installed: Path):
    ended = own_python(installed, "-m", "knobcam", "effects", "from_plugin", "--json")
    assert ended.returncode == 0, ended.stderr
    assert json.loads(ended.stdout)["effects"][0]["params"][0]["unit"] == "N m/rad"
    assert ended.stderr.startswith("knobcam: warning: ") and len(ended.stderr.splitlines()) == 1
    assert "badplug" in ended.stderr and "no magnet" in ended.stderr


def test_a_model_of_an_installed_effect_loads_without_asking_for_the_catalogue(installed: Path):
    code = "import knobcam as kc; kc.simulate(kc.Model.of(['inertia', 'from_plugin']), duration_s=0.1)"
    ended = own_python(installed, "-c", code)
    assert ended.returncode == 0 and "KnobcamWarning" in ended.stderr, ended.stderr
