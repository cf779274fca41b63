"""JSON files, sound and damaged: lines, rows, arrays, and the logs of BAM and of tview."""

from __future__ import annotations

import gzip
import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from command import knobcam, refused
from measurements import SHARED, real

import knobcam as kc
from knobcam.capture.formats import read_table
from knobcam.errors import InputError

N = 300
T = np.arange(N) / 200.0
THETA = np.sin(7.0 * T)
OMEGA = 7.0 * np.cos(7.0 * T)
TAU = 0.01 * OMEGA + 0.002 * np.sign(OMEGA) + 1e-5 * np.random.default_rng(3).standard_normal(N)
TURN = 2.0 * np.pi


def rows(**columns: Any) -> list[dict[str, Any]]:
    return [dict(zip(columns, row, strict=True)) for row in zip(*columns.values(), strict=True)]


def written(folder: Path, content: Any, lines: bool = False) -> Path:
    path = folder / "run.log"
    path.write_text("\n".join(map(json.dumps, content)) if lines else json.dumps(content))
    return path


MOTION = {"time": T.tolist(), "position_deg": np.rad2deg(THETA).tolist(), "torque": TAU.tolist()}


@pytest.mark.parametrize("form", ["lines", "list of rows", "rows under a key", "arrays"])
def test_a_capture_is_in_every_form_of_json(form: str, tmp_path: Path) -> None:
    content: dict[str, Any] = {
        "lines": rows(**MOTION),
        "list of rows": rows(**MOTION),
        "rows under a key": {"motor": "mine", "samples": rows(**MOTION)},
        "arrays": {"rig": {"gain": 2.0}, **MOTION},
    }
    path = written(tmp_path, content[form], lines=form == "lines")
    for file in (path, tmp_path / "run.gz"):
        file.write_bytes(path.read_bytes() if file == path else gzip.compress(path.read_bytes()))
        capture = kc.load(file)
        np.testing.assert_allclose(capture.theta, THETA, atol=1e-12)
        np.testing.assert_array_equal(capture.tau, TAU)


def test_nested_values_have_dotted_names_and_what_a_row_lacks_is_nan(tmp_path: Path) -> None:
    content = [{"a": {"b": 1, "c": [2.5, True]}}, {"a": {"b": None}, "late": 7}, {"a": {"c": [3, 4]}}]
    columns = read_table(written(tmp_path, content, lines=True)).columns
    np.testing.assert_array_equal(columns["a.b"], [1.0, np.nan, np.nan])
    np.testing.assert_array_equal(columns["a.c.c0"], [2.5, np.nan, 3.0])
    np.testing.assert_array_equal(columns["a.c.c1"], [1.0, np.nan, 4.0])
    np.testing.assert_array_equal(columns["late"], [np.nan, 7.0, np.nan])


def test_a_word_among_numbers_is_named_with_its_row_where_its_column_is_asked_for(tmp_path: Path) -> None:
    content = rows(**MOTION, note=["ok"] * N)
    assert kc.load(written(tmp_path, content, lines=True)).samples == N
    content[6]["torque"] = "saturated"
    with pytest.raises(InputError, match="row 7, column torque: 'saturated' is not a number"):
        kc.load(written(tmp_path, content, lines=True))


@pytest.mark.parametrize(
    ("content", "words"),
    [
        ('{"t": 1}\n{"t": 2', ["row 2 is damaged JSON"]),
        ('{"t": 1}\n[2]', ["row 2 is no object"]),
        ('[{"t": 1}, 2]', ["row 2 is no object"]),
        ('{"entries": [{"t": 1}', ["damaged JSON"]),
        ('{"a": "b"}', ["without rows or arrays"]),
        ('{"knob-0": {"motion": "hand", "k": 1.5, "ends": [1, 2]}}', ["without rows or arrays"]),
        ('{"schema": "knobcam.next/1", "theta": [1, 2, 3]}', ["itself knobcam.next/1", "no capture"]),
        ('# mine\nschema = "knobcam.motion/1"\nstart = 0.0\n', ["itself knobcam.motion/1", "no capture"]),
        ("[[]]", ["run.log"]),
        ("[" * 100_000, ["run.log"]),
        ('[{"a":' * 50_000, ["run.log"]),
        ('{"a": ' + '{"a":' * 30 + "1" + "}" * 31 + "\n{}", ["nested deeper than 16"]),
        ("[{" + ",".join(f'"k{index}": 1' for index in range(5000)) + "}]", ["more than 4096 names"]),
        ('{"a": [{"t": 1}], "b": [{"t": 1}]}', ["rows under a, b"]),
        ('{"t": ' + "9" * 5000 + "}\n{}", ["run.log"]),
        ('{"t": "\ud800"}\n{"t": 1}', ["run.log"]),
    ],
)
def test_json_that_is_damaged_or_no_table_is_refused_in_one_line(
    content: str, words: list[str], tmp_path: Path
) -> None:
    path = tmp_path / "run.log"
    path.write_bytes(content.encode("utf-8", "surrogatepass"))
    refused(knobcam("import", path, "-o", tmp_path / "out.npz"), "run.log", *words)


def bam(**changed: Any) -> dict[str, Any]:
    load = np.round(885 * TAU / 0.1).astype(int) % 65536
    motion = {"position": THETA, "speed": OMEGA, "load": load, "input_volts": 7.4 + 0.0 * T, "timestamp": T}
    entries = rows(**{name: values.tolist() for name, values in motion.items()})
    for entry in entries:
        entry.update(goal_position=0.0, torque_enable=True)
    return {
        "mass": 0.49,
        "length": 0.1,
        "kp": 100,
        "vin": 7.4,
        "motor": "xl330",
        "entries": entries,
    } | changed


def test_a_bam_log_is_known_and_its_torque_is_the_voltage_of_its_motor(tmp_path: Path) -> None:
    path = written(tmp_path, bam())
    capture = kc.load(path)
    assert "tau = duty*input_volts [V]" in capture.findings[0].message
    assert capture.torque_unit == "V"
    np.testing.assert_allclose(capture.tau, 7.4 * TAU / 0.1, atol=0.06 * 74.0 * np.abs(TAU).max())


def test_a_folder_of_runs_is_its_captures_for_a_command_of_several(tmp_path: Path) -> None:
    runs = tmp_path / "runs"
    runs.mkdir()
    for name, vin in (("a", 7.4), ("b", 7.0)):
        run = bam(vin=vin)
        for entry in run["entries"]:
            entry["input_volts"] = vin
        (runs / f"{name}.json").write_text(json.dumps(run))
    with pytest.raises(InputError, match=r"a folder of 2 runs \(a\.json, b\.json\); name one"):
        kc.load(runs)
    right = ["t=timestamp", "theta=position", "omega=speed", "tau=0.0135*duty*input_volts"]
    ended = knobcam("fit", runs, "--map", *right, "--json")
    assert ended.code == 0, ended.err
    assert [Path(one["path"]).name for one in ended.document["captures"]] == ["a.json", "b.json"]


@pytest.mark.parametrize("form", ["documents", "rows", "named", "columns"])
def test_several_runs_in_one_file_are_chosen_between(form: str, tmp_path: Path) -> None:
    runs = [bam(vin=7.4), bam(vin=7.0)]
    for run, sign in zip(runs, (1.0, -1.0), strict=True):
        for entry, angle in zip(run["entries"], THETA, strict=True):
            entry["position"] = sign * angle
    both: Any = runs
    if form == "rows":
        both = [run["entries"] for run in runs]
    elif form == "named":
        both = {"machine": "arm", "runs": runs}
    elif form == "columns":
        both = [{"timestamp": T.tolist(), "position": (sign * THETA).tolist()} for sign in (1.0, -1.0)]
    path = written(tmp_path, both)
    with pytest.raises(InputError, match=r"2 runs in one file; choose one.*--joint 1.*a folder of them"):
        read_table(path)
    with pytest.raises(InputError, match=r"no run '3'; there are 1, 2"):
        read_table(path, joint="3")
    for joint, sign in (("1", 1.0), ("2", -1.0)):
        np.testing.assert_allclose(read_table(path, joint=joint).column("position"), sign * THETA)


def test_a_run_alone_in_a_list_is_that_run(tmp_path: Path) -> None:
    assert kc.load(written(tmp_path, [bam()])).torque_unit == "V"


def test_the_duty_of_a_real_servo_has_a_sign_and_ends_at_one() -> None:
    for path in sorted(real(SHARED / "bam_xl330").glob("*.json")):
        columns = read_table(path).columns
        assert columns["load"].max() > 60000.0
        assert -1.0 <= columns["duty"].min() < -0.05 and columns["duty"].max() <= 1.0
        capture = kc.load(path, map="t=timestamp, theta=position, omega=speed, tau=0.085*duty*input_volts")
        assert capture.duration_s > 5.0


def tview(*controllers: str) -> list[dict[str, Any]]:
    said: list[dict[str, Any]] = []
    for index in range(N):
        for name in controllers:
            data = {"position": THETA[index] / TURN, "velocity": OMEGA[index] / TURN}
            data |= {"torque_Nm": TAU[index], "q_A": 0.0, "d_A": 0.0, "mode": "position"}
            record = {"controller": name, "timestamp": T[index]}
            said.append(record | {"channel": "servo_stats", "data": data})
            said.append(record | {"channel": "git", "data": {"hash": "abc"}})
    return said


def test_one_controller_of_a_log_of_tview_is_chosen_by_name(tmp_path: Path) -> None:
    capture = kc.load(written(tmp_path, tview("1"), lines=True))
    np.testing.assert_allclose(capture.theta, THETA, atol=1e-12)
    path = written(tmp_path, tview("1", "2"), lines=True)
    with pytest.raises(InputError, match="2 controllers, 1, 2; choose one, for example --joint 1"):
        kc.load(path)
    assert kc.load(path, joint="2").samples == N
    refused(knobcam("fit", path, "--joint", "3"), "no controller '3'; there are 1, 2")


def test_a_joint_is_refused_where_there_is_none_to_choose(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="has no joints to choose from"):
        kc.load(written(tmp_path, rows(**MOTION), lines=True), joint="elbow")
    np.save(tmp_path / "run.npy", np.zeros((10, 3)))
    with pytest.raises(InputError, match="has no joints to choose from"):
        kc.load(tmp_path / "run.npy", joint="elbow")


def test_a_step_beside_sweeps_is_a_run_as_they_are(tmp_path: Path) -> None:
    """96 runs of a servo, of 12 to 150 readings, were one run of 96 rows and 303 columns."""
    sizes = (150, 12, 12, 100, 12)
    runs = [{"type": "x", "angle": THETA[:size].tolist(), "torque": TAU[:size].tolist()} for size in sizes]
    path = written(tmp_path, {"dataset": "real", "data": [{**one, "targets": [0.0, 1.0]} for one in runs]})
    with pytest.raises(InputError, match="5 runs in one file"):
        kc.load(path)
    np.testing.assert_array_equal(kc.load(path, joint="2", rate_hz=100.0).theta, THETA[:12])
    # Rows of which one has more of something are rows.
    touched = rows(t=T.tolist(), angle=THETA.tolist(), torque=TAU.tolist(), hits=[[0.0] * 3] * N)
    touched[7]["hits"] = [0.0] * 70
    np.testing.assert_array_equal(kc.load(written(tmp_path, touched)).theta, THETA)
