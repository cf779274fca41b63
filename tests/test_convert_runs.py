"""Converted models where they run: a program in C, a unit of FMI, MuJoCo, a block of Modelica."""

from __future__ import annotations

import json
import re
import subprocess
from collections.abc import Iterator
from functools import cache
from pathlib import Path

import fmpy
import mujoco
import numpy as np
import pytest
from fmpy.fmi2 import FMU2Slave
from fmpy.fmi3 import FMU3Slave
from fmpy.validation import validate_fmu

import knobcam as kc
from knobcam.render.convert import convert, library
from knobcam.render.convert.mujoco import callback

KNOBS = (*kc.KNOBS, "presliding", "backlash")
RATE_HZ = 5000.0
WRAPPED = [f"-Wl,--wrap={name}" for name in ("malloc", "calloc", "realloc")]


@cache
def named(name: str) -> kc.Model:
    return kc.Model.load(name) if name in kc.KNOBS else kc.hiding("knob5", name)


@pytest.fixture
def joint() -> Iterator[None]:
    """Whatever a test gives MuJoCo to call is taken back."""
    yield
    mujoco.set_mjcb_passive(None)


def simulated(model: kc.Model) -> tuple[mujoco.MjModel, mujoco.MjData]:
    mujoco.set_mjcb_passive(None)
    text = convert(model, "mujoco", motion=kc.motion("hand", 0.1)).form.content
    made = mujoco.MjModel.from_xml_string(text)
    mujoco.set_mjcb_passive(callback(made))
    return made, mujoco.MjData(made)


def friction(model: kc.Model) -> float:
    return min(model.params[name].value for name in ("coulomb.neg", "coulomb.pos"))


@pytest.mark.parametrize("name", kc.KNOBS)
@pytest.mark.parametrize("way", [-1.0, 1.0])
def test_a_knob_that_is_held_at_half_its_friction_does_not_creep(name: str, way: float, joint: None) -> None:
    model = kc.Model.load(name)
    made, data = simulated(model)
    data.qfrc_applied[0] = way * 0.5 * friction(model)
    for _ in range(5000):
        mujoco.mj_step(made, data)
    before = data.qpos[0]
    for _ in range(5000):
        mujoco.mj_step(made, data)
    assert abs(data.qpos[0] - before) * made.opt.timestep * 5000 <= 1e-9
    assert abs(data.qvel[0]) <= 1e-9


@pytest.mark.parametrize("name", kc.KNOBS)
def test_a_knob_that_is_pushed_beyond_its_friction_goes(name: str, joint: None) -> None:
    model = kc.Model.load(name)
    made, data = simulated(model)
    data.qfrc_applied[0] = 0.01 + 2.0 * max(p.value for p in model.params.values() if p.unit == "N m")
    for _ in range(100):
        mujoco.mj_step(made, data)
    assert data.qvel[0] > 0.1


@pytest.mark.parametrize("inertia", [1e-3, 1e-5, 1e-7])
def test_however_light_a_knob_comes_to_rest_and_stays(inertia: float, joint: None) -> None:
    rubs = {"coulomb__neg": 0.01, "coulomb__pos": 0.01}
    made, data = simulated(kc.Model.of(["inertia", "coulomb"], inertia__M=inertia, **rubs))
    data.qvel[0], data.qfrc_applied[0] = 1.0, 0.005
    for _ in range(5000):
        mujoco.mj_step(made, data)
    assert abs(data.qvel[0]) <= 1e-9


def test_a_second_look_at_one_instant_is_no_step_and_going_back_is_a_reset(joint: None) -> None:
    made, data = simulated(kc.hiding("knob1", "presliding"))
    answers = []
    for times in (1, 3):
        mujoco.mj_resetData(made, data)
        data.qfrc_applied[0] = 0.4
        for _ in range(200):
            for _ in range(times - 1):
                mujoco.mj_forward(made, data)
            mujoco.mj_step(made, data)
        answers.append(float(data.qpos[0]))
    assert answers[0] == answers[1] != 0.0


def test_a_callback_for_a_model_without_a_knob_is_refused_in_one_line() -> None:
    made = mujoco.MjModel.from_xml_string("<mujoco/>")
    with pytest.raises(kc.InputError, match=r"no text knobcam.JOINT; take over what `knobcam convert` wrote"):
        callback(made)
    text = convert("knob1", "mujoco", motion=kc.motion("hand", 0.1)).form.content
    made = mujoco.MjModel.from_xml_string(str(text).replace('joint name="knob"', 'joint name="elbow"'))
    with pytest.raises(kc.InputError, match="has no joint 'knob', of which a text tells"):
        callback(made)


def test_a_robot_has_many_knobs(joint: None) -> None:
    robot = mujoco.MjSpec()
    robot.option.timestep = 1.0 / RATE_HZ
    robot.option.gravity = [0.0, 0.0, 0.0]
    robot.option.integrator = mujoco.mjtIntegrator.mjINT_IMPLICITFAST
    robot.compiler.degree = False
    alone = []
    for name in ("knob1", "knob2"):
        model = kc.Model.load(name)
        made, data = simulated(model)
        text = convert(model, "mujoco", motion=kc.motion("hand", 0.1)).form.content
        robot.attach(
            mujoco.MjSpec.from_string(str(text)), prefix=f"{name}_", frame=robot.worldbody.add_frame()
        )
        data.qfrc_applied[0] = 0.3
        for _ in range(100):
            mujoco.mj_step(made, data)
        alone.append(float(data.qpos[0]))
    mujoco.set_mjcb_passive(None)
    both = robot.compile()
    mujoco.set_mjcb_passive(callback(both))
    data = mujoco.MjData(both)
    data.qfrc_applied[:] = 0.3
    for _ in range(100):
        mujoco.mj_step(both, data)
    assert np.allclose(data.qpos, alone, rtol=1e-9) and min(alone) > 0.0


MAIN = """\
#include <stdio.h>
#include <stdlib.h>
#include "knob.h"

static int counting = 0, taken = 0;
void *__real_malloc(size_t size);
void *__wrap_malloc(size_t size) { taken += counting; return __real_malloc(size); }
void *__real_calloc(size_t number, size_t size);
void *__wrap_calloc(size_t number, size_t size) { taken += counting; return __real_calloc(number, size); }
void *__real_realloc(void *old, size_t size);
void *__wrap_realloc(void *old, size_t size) { taken += counting; return __real_realloc(old, size); }

int main(void) {
    char why[200];
    double row[4], tau;
    knobcam_knob *knob = knob_new(0, why, sizeof why);
    if (knob == NULL) { fprintf(stderr, "%s\\n", why); return 1; }
    while (fread(row, sizeof row, 1, stdin) == 1) {
        counting = 1;
        tau = row[3] == row[3] ? knobcam_step_beside(knob, row[0], row[1], row[2], row[3])
                               : knobcam_step(knob, row[0], row[1], row[2]);
        counting = 0;
        fwrite(&tau, sizeof tau, 1, stdout);
    }
    fprintf(stderr, "%d %d", taken, knobcam_fault(knob));
    knobcam_free(knob);
    return 0;
}
"""


@pytest.mark.parametrize("name", KNOBS)
def test_a_program_in_c_renders_to_the_last_bit_and_takes_no_memory(name: str, tmp_path: Path) -> None:
    model = named(name)
    convert(model, "c", motion=kc.motion("hand", 0.1)).save(tmp_path / "knob.h")
    (tmp_path / "main.c").write_text(MAIN)
    static = library.static() or library.shared()
    strict = ("-std=c99", "-O2", "-Wall", "-Wextra", "-Wpedantic", "-Wno-overlength-strings", "-Werror")
    words = ["gcc", *strict, "main.c", str(static), *WRAPPED, "-o", "main"]
    subprocess.run(words, cwd=tmp_path, check=True)
    track = kc.motion("hand", 1.0)
    hand = np.where(np.arange(len(track.t)) % 3 == 0, 0.3 * friction(model), np.nan)
    rows = np.stack([track.theta, track.omega, track.alpha, hand], axis=1)
    ended = subprocess.run([tmp_path / "main"], input=rows.tobytes(), capture_output=True, check=True)
    assert ended.stderr == b"0 0"
    exact = kc.Renderer(model, RATE_HZ).along(track.theta, track.omega, track.alpha, hand)
    assert ended.stdout == exact.tobytes()


LAW = """
[effects.eddy_brake]
law = "2 a (omega/w) / (1 + (omega/w)^2)"
a = { value = 0.01, fixed = true }
w = { value = 3.0, unit = "rad/s", lower = 0.1, upper = 100.0, meaning = "speed at which it brakes most" }
"""
LITTLE = """\
#include <stdio.h>
#include "knob.h"

int main(void) {
    static double memory[KNOB_MEMORY / sizeof(double)];
    char why[200];
    if (knobcam_new(KNOB_MODEL, KNOB_RATE_HZ, 0, why, sizeof why) == NULL) { puts(why); }
    knobcam_memory(memory, sizeof memory / 2);
    if (knobcam_new(KNOB_MODEL, KNOB_RATE_HZ, 0, why, sizeof why) == NULL) { puts(why); }
    for (int i = 0; i < 3; i++) {
        knobcam_knob *knob = knob_new(0, why, sizeof why);
        int fits = knobcam_needs(KNOB_MODEL) <= sizeof memory;
        printf("%d %g\\n", fits, knobcam_step(knob, 0.0, 3.0, 0.0));
        knobcam_free(knob);
    }
    return 0;
}
"""


def test_a_program_in_c_gives_the_memory_that_the_header_says_and_with_less_is_refused(
    tmp_path: Path,
) -> None:
    text = kc.Model.load("knob1").text() + LAW
    (tmp_path / "model.toml").write_text(text)
    convert(kc.Model.load(tmp_path / "model.toml"), "c", motion=kc.motion("hand", 0.1)).save(
        tmp_path / "knob.h"
    )
    (tmp_path / "main.c").write_text(LITTLE)
    words = ["gcc", "-O2", "-Wall", "-Werror", "main.c", str(library.static()), "-o", "main"]
    subprocess.run(words, cwd=tmp_path, check=True)
    said = subprocess.run([tmp_path / "main"], capture_output=True, check=True, text=True).stdout.splitlines()
    assert said[:2] == 2 * [
        "memory: too little is left for this model; give as much as knobcam_needs says by knobcam_memory"
    ]
    sliding = kc.Renderer(kc.Model.load(tmp_path / "model.toml"), RATE_HZ).along([0.0], [3.0], [0.0])[0]
    assert said[2:] == 3 * [f"1 {sliding:g}"]


def test_the_library_for_c_asks_nothing_of_an_operating_system() -> None:
    listed = subprocess.run(["nm", str(library.static())], capture_output=True, check=True, text=True).stdout
    rows = [line.split()[-2:] for line in listed.splitlines() if line and not line.endswith(":")]
    asked = {name for kind, name in rows if kind == "U"} - {name for kind, name in rows if kind not in "Uw"}
    # What a compiler of C brings along; `abort` and `_Unwind_Resume` are never called.
    of_c = {"bcmp", "memcmp", "memcpy", "memmove", "memset", "strlen", "__udivti3"}
    assert asked <= of_c | {"abort", "_Unwind_Resume"}


@pytest.mark.parametrize("name", KNOBS)
def test_a_unit_of_fmi_renders_to_the_last_bit(name: str, tmp_path: Path) -> None:
    model = named(name)
    file = convert(model, "fmu", motion=kc.motion("hand", 0.1)).save(tmp_path / "knob.fmu")
    assert fmpy.supported_platforms(str(file)) == [library.fmi_platform(2)]
    assert validate_fmu(str(file)) == []
    described = fmpy.read_model_description(str(file), validate=True)
    numbers = {one.name: one.valueReference for one in described.modelVariables}
    inputs = [numbers[one] for one in ("theta", "omega", "alpha")]
    unit = FMU2Slave(
        guid=described.guid,
        unzipDirectory=fmpy.extract(str(file), str(tmp_path / "unit")),
        modelIdentifier=described.coSimulation.modelIdentifier,
    )
    unit.instantiate()
    unit.setupExperiment(startTime=0.0)
    unit.enterInitializationMode()
    unit.exitInitializationMode()
    track = kc.motion("hand", 0.5)
    found = []
    for t, *motion in zip(*track, strict=True):
        unit.setReal(inputs, motion)
        unit.doStep(t - 1.0 / RATE_HZ, 1.0 / RATE_HZ)
        found.append(unit.getReal([numbers["tau"]])[0])
    unit.setBoolean([numbers["held"]], [True])
    assert unit.getBoolean([numbers["held"]]) == [1]
    with pytest.raises(Exception, match="fmi2DoStep"):
        unit.doStep(1.0, 1.5 / RATE_HZ)
    unit.terminate()
    unit.freeInstance()
    assert np.array_equal(found, kc.Renderer(model, RATE_HZ).along(track.theta, track.omega, track.alpha))


@pytest.mark.parametrize("name", KNOBS)
def test_a_unit_of_fmi_3_renders_to_the_last_bit(name: str, tmp_path: Path) -> None:
    model = named(name)
    file = convert(model, "fmu", motion=kc.motion("hand", 0.1), fmi=3).save(tmp_path / "knob.fmu")
    assert fmpy.supported_platforms(str(file)) == [fmpy.platform]
    assert validate_fmu(str(file)) == []
    described = fmpy.read_model_description(str(file), validate=True)
    assert described.fmiVersion == "3.0"
    numbers = {one.name: one.valueReference for one in described.modelVariables}
    assert len(set(numbers.values())) == len(numbers)
    inputs = [numbers[one] for one in ("theta", "omega", "alpha")]
    unit = FMU3Slave(
        guid=described.guid,
        instanceName="knob",
        unzipDirectory=fmpy.extract(str(file), str(tmp_path / "unit")),
        modelIdentifier=described.coSimulation.modelIdentifier,
    )
    unit.instantiate()
    unit.enterInitializationMode(startTime=0.0)
    unit.exitInitializationMode()
    track = kc.motion("hand", 0.5)
    found = []
    for t, *motion in zip(*track, strict=True):
        unit.setFloat64(inputs, motion)
        assert unit.doStep(t - 1.0 / RATE_HZ, 1.0 / RATE_HZ) == (False, False, False, pytest.approx(t))
        found.append(unit.getFloat64([numbers["tau"]])[0])
    assert np.array_equal(found, kc.Renderer(model, RATE_HZ).along(track.theta, track.omega, track.alpha))
    assert unit.getFloat64([numbers["time"]]) == [pytest.approx(track.t[-1])]
    unit.setBoolean([numbers["held"]], [True])
    assert unit.getBoolean([numbers["held"], numbers["tau_other_measured"]]) == [True, False]
    for wrong in (
        lambda: unit.doStep(1.0, 1.5 / RATE_HZ),
        lambda: unit.setFloat64([numbers["tau"]], [1.0]),
        lambda: unit.getFloat64([numbers["held"]]),
        lambda: unit.setBoolean([numbers["theta"]], [True]),
        lambda: unit.getFMUState(),
    ):
        with pytest.raises(Exception, match="fmi3"):
            wrong()
    unit.reset()
    assert unit.getBoolean([numbers["held"]]) == [False]
    unit.terminate()
    unit.freeInstance()


@pytest.mark.parametrize("fmi", [2, 3])
def test_a_unit_is_simulated_as_a_whole(fmi: int, tmp_path: Path) -> None:
    model = named("knob4")
    file = convert(model, "fmu", motion=kc.motion("hand", 0.1), fmi=fmi).save(tmp_path / "knob.fmu")
    track = kc.motion("hand", 0.2)
    rows = [("time", float), *((name, float) for name in ("theta", "omega", "alpha"))]
    given = np.array(list(zip(*track, strict=True)), dtype=rows)
    step = {"output_interval": 1.0 / RATE_HZ, "step_size": 1.0 / RATE_HZ}
    told = fmpy.simulate_fmu(str(file), stop_time=0.1, input=given, output=["tau"], **step)
    assert len(told) == 501 and np.all(np.isfinite(told["tau"])) and np.ptp(told["tau"]) > 0.0


def test_a_unit_whose_resource_is_gone_says_so_in_a_line(tmp_path: Path) -> None:
    file = convert("knob4", "fmu", motion=kc.motion("hand", 0.1), fmi=3).save(tmp_path / "knob.fmu")
    folder = Path(fmpy.extract(str(file), str(tmp_path / "unit")))
    (folder / "resources" / "knob.txt").unlink()
    unit = FMU3Slave(guid="", instanceName="knob", unzipDirectory=str(folder), modelIdentifier="knobcam")
    said: list[str] = []
    with pytest.raises(Exception, match="instantiate"):
        unit.instantiate(logMessage=lambda _, status, category, message: said.append(message.decode()))
    assert len(said) == 1 and "knob.txt" in said[0]


@pytest.mark.parametrize("fmi", [2, 3])
def test_the_same_model_gives_the_same_unit(fmi: int) -> None:
    still = kc.motion("hand", 0.1)
    first, second = (convert("knob4", "fmu", motion=still, fmi=fmi).form.content for _ in range(2))
    assert first == second


@pytest.mark.parametrize("name", kc.KNOBS)
def test_a_free_handle_that_the_library_renders_does_not_creep_at_half_its_friction(name: str) -> None:
    model = kc.Model.load(name)
    knob = library.Knob(model.text(), RATE_HZ)
    theta, omega, hand, dt, inertia = 0.0, 0.0, 0.5 * friction(model), 1.0 / RATE_HZ, 5e-5
    angles = []
    for _ in range(20_000):
        alpha = (hand - knob.step(theta, omega, 0.0)) / inertia
        omega += alpha * dt
        theta += omega * dt
        angles.append(theta)
    assert abs(angles[-1] - angles[10_000]) / (10_000 * dt) <= 1e-9
    assert abs(omega) <= 1e-9 and abs(theta) < 0.05


UTILITIES = "void ModelicaFormatError(const char *format, ...);\n"


def test_a_block_of_modelica_holds_the_model_and_its_c_compiles(tmp_path: Path) -> None:
    """No Modelica compiler is at hand: its texts and its C are looked at, not the block as a whole."""
    model = kc.Model.load("knob4")
    text = convert(model, "modelica", motion=kc.motion("hand", 0.1)).form.content

    def constant(after: str) -> str:
        lines = re.match(r"(?:\s*\".*\"(?: \+)?\n?)+", str(text).partition(after)[2])
        assert lines is not None
        return "".join(map(json.loads, re.findall(r'(?m)^\s*(".*")', lines.group())))

    assert kc.Model.parse(constant("constant String model_text =\n")).text() == model.frozen().text()
    (tmp_path / "ModelicaUtilities.h").write_text(UTILITIES)
    (tmp_path / "include.c").write_text(constant("Include =\n"))
    words = ["gcc", "-Wall", "-Wno-unused-function", "-Werror", "-fsyntax-only", "include.c", "-I."]
    subprocess.run(words, cwd=tmp_path, check=True)
