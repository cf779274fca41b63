"""Bad options, models and calls end in exit code 2 and one line that names them; nothing is written."""

from __future__ import annotations

from pathlib import Path

import pytest
from command import knobcam, refused
from test_bad_input import good, written

OPTIONS: dict[str, tuple[list[str], list[str]]] = {
    "unknown column in the map": (
        ["--map", "t=t_s", "theta=angle", "tau=tau_Nm"],
        ["good.csv", "angle", "theta_rad"],
    ),
    "map of an unknown target": (["--map", "torque=tau_Nm"], ["'torque'", "tau"]),
    "map that calls code": (["--map", "t=t_s, theta=open(theta_rad), tau=tau_Nm"], ["open"]),
    "map without equals sign": (["--map", "theta_rad"], ["--map", "'theta_rad'"]),
    "map in an unknown unit": (["--map", "t=t_s", "theta=theta_rad [parsec_]", "tau=tau_Nm"], ["parsec_"]),
    "the other kind of axis": (["--coordinate", "linear"], ["good.csv", "[rad]", "but it is linear"]),
    "an unknown kind of axis": (["--coordinate", "spiral"], ["--coordinate", "'spiral'", "rotary"]),
    "negative rate": (["--rate", "-5"], ["rate of -5", "Hz"]),
    "rate of zero": (["--rate", "0"], ["rate of 0", "Hz"]),
    "rate that is no number": (["--rate", "fast"], ["--rate", "'fast'"]),
    "rate that contradicts the times": (["--rate", "5000"], ["good.csv", "1000", "5000"]),
    "an infinite rate": (["--rate", "inf"], ["rate of inf"]),
    "start behind the end": (["--start", "1.5", "--end", "1.0"], ["good.csv", "from 1.5 to 1 s"]),
    "start behind the capture": (["--start", "100"], ["good.csv", "from 100 s on"]),
    "edge above Nyquist": (["--option", "torque_edge_hz=4000"], ["good.csv", "4000", "Nyquist"]),
    "edge of zero": (["--option", "torque_edge_hz=0"], ["good.csv", "edge_hz", "0 Hz"]),
    "edge of nan": (["--option", "torque_edge_hz=nan"], ["good.csv", "edge_hz", "NaN"]),
    "motion edge above Nyquist": (
        ["--prepare", "paper", "--option", "motion_edge_hz=4000"],
        ["good.csv", "4000", "Nyquist"],
    ),
    "decimation of zero": (["--prepare", "differences", "--option", "decimate=0"], ["decimate"]),
    "decimation by half a sample": (["--prepare", "differences", "--option", "decimate=2.5"], ["decimate"]),
    "decimation of everything": (["--prepare", "differences", "--option", "decimate=1e9"], ["good.csv"]),
    "cutoff above Nyquist": (
        ["--prepare", "differences", "--option", "cutoff_hz=600"],
        ["good.csv", "600", "Nyquist"],
    ),
    "unknown preparation": (["--prepare", "magic"], ["prepare='magic'", "smooth"]),
    "unknown option": (["--option", "edge=4"], ["'edge'", "torque_edge_hz"]),
    "an argument of the library as option": (["--option", "model=4"], ["'model'", "torque_edge_hz"]),
    "option that is no number": (["--option", "torque_edge_hz=fast"], ["torque_edge_hz", "'fast'"]),
    "option given twice": (
        ["--option", "torque_edge_hz=50", "torque_edge_hz=60"],
        ["torque_edge_hz", "twice"],
    ),
    "unknown answer about detents": (["--detents", "maybe"], ["--detents", "'maybe'"]),
    "unknown argument": (["--frobnicate"], ["--frobnicate", "knobcam"]),
    "missing model": (["--model", "absent.toml"], ["absent.toml", "No such file"]),
}


@pytest.mark.parametrize("case", OPTIONS)
def test_a_bad_option_is_refused_in_one_line_and_nothing_is_written(case: str, tmp_path: Path) -> None:
    options, words = OPTIONS[case]
    path = good(tmp_path)
    refused(
        knobcam("fit", path, "-o", tmp_path / "model.toml", "--plots", tmp_path / "plots", *options), *words
    )
    assert list(tmp_path.iterdir()) == [path]


MODEL = 'schema = "knobcam.model/1"\naxis = "rotary"\n'
MODELS: dict[str, tuple[str | bytes, list[str]]] = {
    "empty": ("", ["m.toml", "schema"]),
    "no TOML": ("knob = {", ["m.toml"]),
    "binary": (b"\xff\xfe\x00\x81", ["m.toml", "no text"]),
    "no effects": (MODEL, ["m.toml", "effects"]),
    "a newer schema": (MODEL.replace("/1", "/9"), ["m.toml", "knobcam.model/9", "update knobcam"]),
    "a motion": ('schema = "knobcam.motion/1"\n', ["m.toml", "knobcam.motion/1", "name a model file"]),
    "an unknown axis": (MODEL.replace("rotary", "spiral"), ["m.toml", "axis", "rotary"]),
    "an unknown effect": (MODEL + "[effects.magic]\nM = 1.0\n", ["m.toml", "magic"]),
    "an unknown parameter": (MODEL + "[effects.inertia]\nJ = 1.0\n", ["m.toml", "inertia", "J"]),
    "a parameter out of bounds": (
        MODEL + "[effects.detent]\nA = 0.001\nP = -0.03\nS = 0.0\n",
        ["m.toml", "detent.P", "-0.03"],
    ),
    "a text for a number": (MODEL + '[effects.inertia]\nM = "heavy"\n', ["m.toml", "inertia.M"]),
    "a parameter of nan": (MODEL + "[effects.inertia]\nM = nan\n", ["m.toml", "inertia.M"]),
    "a parameter of inf": (MODEL + "[effects.inertia]\nM = inf\n", ["m.toml", "inertia.M"]),
    "a parameter given twice": (MODEL + "[effects.inertia]\nM = 1.0\nM = 2.0\n", ["m.toml"]),
}


@pytest.mark.parametrize("command", ["fit", "compare", "simulate", "diagnose", "learn"])
@pytest.mark.parametrize("case", MODELS)
def test_a_bad_model_is_refused_in_one_line_and_nothing_is_written(
    command: str, case: str, tmp_path: Path
) -> None:
    content, words = MODELS[case]
    path, model = good(tmp_path), written(tmp_path, content, "m.toml")
    calls = {
        "fit": ["fit", path, "--model", model, "-o", tmp_path / "fitted.toml"],
        "compare": ["compare", path, model, "--plots", tmp_path / "plots"],
        "simulate": ["simulate", model, "-o", tmp_path / "c.npz"],
        "diagnose": ["diagnose", path, model, "--plots", tmp_path / "plots"],
        "learn": ["learn", path, "--model", model, "--report", tmp_path / "r.html"],
    }
    refused(knobcam(*calls[command]), *words)
    assert sorted(tmp_path.iterdir()) == [path, model]


def test_a_model_of_the_other_kind_of_axis_is_refused(tmp_path: Path) -> None:
    linear = MODEL.replace("rotary", "linear") + "[effects.inertia]\nM = 1.0\n"
    path, model = good(tmp_path), written(tmp_path, linear, "m.toml")
    refused(knobcam("fit", path, "--model", model), "good.csv", "model", "axis")
    refused(knobcam("compare", path, model), "good.csv", "model", "axis")


CALLS: dict[str, tuple[list[str], list[str]]] = {
    "no command": ([], ["COMMAND", "knobcam --help"]),
    "unknown command": (["knit"], ["'knit'", "simulate"]),
    "a slip in a command": (["fitt", "good.csv"], ["'fitt'", "perhaps fit;"]),
    "a slip in an option": (
        ["fit", "good.csv", "--plot", "p"],
        ["--plot p", "perhaps --plots", "fit --help"],
    ),
    "an option of another command": (["effects", "--seed", "1"], ["--seed", "see knobcam effects --help"]),
    "a slip in an effect": (["effects", "Stribek"], ["'Stribek'", "perhaps stribeck;"]),
    "half the name of an effect": (["effects", "spring"], ["'spring'", "perhaps return_spring;"]),
    "a report that says it is something else": (
        ["learn", "good.csv", "--report", "r.pdf"],
        ["r.pdf", ".html", "name it so"],
    ),
    "an export of no known kind": (["export", "good.csv", "-o", "x.xlsx"], ["x.xlsx", ".csv", "name it so"]),
    "an end before the start": (["fit", "good.csv", "--end", "-1"], ["up to -1 s; the file runs from"]),
    "import without a file": (["import", "-o", "c.npz"], ["FILE"]),
    "import without an output": (["import", "good.csv"], ["-o"]),
    "import of a missing file": (["import", "absent.csv", "-o", "c.npz"], ["absent.csv"]),
    "import over its own input": (["import", "good.csv", "-o", "good.csv"], ["good.csv", "another file"]),
    "import into a missing folder": (["import", "good.csv", "-o", "no/such/c.npz"], ["no/such", "no folder"]),
    "import onto a folder": (["import", "good.csv", "-o", "."], ["is a folder"]),
    "import into a file as folder": (
        ["import", "good.csv", "-o", "good.csv/c.npz"],
        ["good.csv", "no folder"],
    ),
    "simulate an unknown knob": (["simulate", "knob9", "-o", "c.npz"], ["knob9", "knob1"]),
    "capture into a missing folder": (
        ["capture", "--port", "/dev/no-rig", "-o", "no/such/x.kcwire"],
        ["no/such", "no folder"],
    ),
    "render into a missing folder": (
        ["render", "knob3", "--port", "/dev/no-rig", "--log", "no/such/x.kcwire"],
        ["no/such", "no folder"],
    ),
    "unknown motion": (["simulate", "knob3", "--motion", "waltz", "-o", "c.npz"], ["'waltz'", "sweep"]),
    "unknown noise": (["simulate", "knob3", "--noise", "loud", "-o", "c.npz"], ["'loud'", "rig"]),
    "negative seed": (["simulate", "knob3", "--seed", "-1", "-o", "c.npz"], ["--seed", "'-1'"]),
    "broken seed": (["simulate", "knob3", "--seed", "1.5", "-o", "c.npz"], ["--seed", "'1.5'"]),
    "no duration": (["simulate", "knob3", "--duration", "0", "-o", "c.npz"], ["duration=0"]),
    "negative duration": (["simulate", "knob3", "--duration", "-6", "-o", "c.npz"], ["duration=-6"]),
    "endless duration": (["simulate", "knob3", "--duration", "inf", "-o", "c.npz"], ["duration=inf"]),
    "duration of nan": (
        ["simulate", "knob3", "--duration", "nan", "-o", "c.npz"],
        ["--duration", "'nan' is no number"],
    ),
    "a duration of years": (["simulate", "knob3", "--duration", "1e9", "-o", "c.npz"], ["duration=1", "1e8"]),
    "negative simulated rate": (["simulate", "knob3", "--rate", "-5", "-o", "c.npz"], ["rate"]),
    "both negative": (["simulate", "knob3", "--rate", "-5000", "--duration", "-6", "-o", "c.npz"], ["rate"]),
    "rate of nan": (["simulate", "knob3", "--rate", "nan", "-o", "c.npz"], ["rate"]),
    "a rate below any motion": (
        ["simulate", "knob3", "--rate", "1e-300", "--duration", "1e301", "-o", "c.npz"],
        ["rate of 1e-300"],
    ),
    "fit into a missing folder": (["fit", "good.csv", "-o", "no/such/m.toml"], ["no/such", "no folder"]),
    "fit over its own input": (["fit", "good.csv", "-o", "good.csv"], ["good.csv", "another file"]),
    "pictures into a missing folder": (
        ["fit", "good.csv", "--plots", "no/such/plots"],
        ["no/such", "no folder"],
    ),
    "pictures into a file": (["fit", "good.csv", "--plots", "good.csv"], ["good.csv", "is a file"]),
    "pictures where the model goes": (["fit", "good.csv", "--plots", "p", "-o", "p"], ["p:", "two names"]),
    "compare without a model": (["compare", "good.csv"], ["MODEL"]),
    "compare with two models": (["compare", "good.csv", "knob1", "--model", "knob2"], ["MODEL", "twice"]),
    "compare with a capture for a model": (["compare", "good.csv", "good.csv"], ["good.csv", "line 1"]),
    "compare with a missing model": (["compare", "good.csv", "absent.toml"], ["absent.toml"]),
    "compare with a horizon of nothing": (
        ["compare", "good.csv", "knob1", "--horizon", "1"],
        ["--horizon", "--forward"],
    ),
    "simulate forward over no time": (
        ["compare", "good.csv", "knob1", "--forward", "--horizon", "0"],
        ["good.csv", "horizon", "above 0 s"],
    ),
    "compare with one capture twice": (
        ["compare", "good.csv", "good.csv", "knob1"],
        ["captures 1 and 2 are the same"],
    ),
    "diagnose without a capture": (["diagnose"], ["CAPTURE"]),
    "diagnose with two models": (["diagnose", "good.csv", "knob1", "--model", "knob2"], ["MODEL", "twice"]),
    "diagnose with a missing model": (["diagnose", "good.csv", "absent.toml"], ["absent.toml"]),
    "diagnose without an unknown effect": (
        ["diagnose", "good.csv", "--without", "magic"],
        ["without", "'magic'", "coulomb"],
    ),
    "pictures of a diagnosis into a file": (["diagnose", "good.csv", "--plots", "good.csv"], ["is a file"]),
    "add without a model": (["add", "offset", "good.csv"], ["MODEL"]),
    "add an unknown effect": (["add", "magic", "good.csv", "knob3"], ["'magic'", "coulomb"]),
    "add what is there": (["add", "viscous", "good.csv", "knob3"], ["'viscous'", "already"]),
    "add what lacks its ground": (
        ["add", "directional_detent", "good.csv", "knob1", "-o", "m.toml"],
        ["'directional_detent'", "'detent'", "add that first"],
    ),
    "add over its own capture": (["add", "offset", "good.csv", "knob3", "-o", "good.csv"], ["another file"]),
    "learn without a capture": (["learn"], ["CAPTURE"]),
    "learn from a missing capture": (["learn", "absent.csv", "--report", "r.html"], ["absent.csv"]),
    "learn from one capture twice": (["learn", "good.csv", "good.csv"], ["captures 1 and 2 are the same"]),
    "learn from a missing model": (["learn", "good.csv", "--model", "absent.toml"], ["absent.toml"]),
    "report over the capture": (["learn", "good.csv", "--report", "good.csv"], ["good.csv", "another file"]),
    "report into a missing folder": (["learn", "good.csv", "--report", "no/such/r.html"], ["no folder"]),
    "report where the model goes": (
        ["learn", "good.csv", "--report", "x", "-o", "x"],
        ["x:", "two names"],
    ),
    "report where the pictures go": (["learn", "good.csv", "--report", "p", "--plots", "p"], ["two names"]),
    "learn without an unknown effect": (
        ["learn", "good.csv", "--without", "magic", "--report", "r.html", "-o", "m.toml", "--plots", "p"],
        ["knobcam: --without: ", "'magic'"],
    ),
    "demo that hides what is there": (["demo", "--effect", "detent"], ["'detent'", "anyway"]),
    "demo that hides what no capture shows": (["demo", "--effect", "offset"], ["'offset'", "dry friction"]),
    "demo that hides a description": (["demo", "--effect", "wavelet"], ["'wavelet'", "whatever the cause"]),
    "demo that hides an unknown effect": (["demo", "--effect", "magic"], ["'magic'", "coulomb"]),
    "unknown effect": (["effects", "magic"], ["'magic'", "coulomb"]),
    "picture of no effect": (["effects", "-o", "e.png"], ["e.png", "--plots"]),
    "picture of unknown kind": (["effects", "coulomb", "-o", "e.doc"], ["e.doc", ".png"]),
    "demo of a sixth knob": (["demo", "--knob", "6"], ["'6'", "1 to 5"]),
    "demo of no knob": (["demo", "--knob", "²"], ["choose 1 to 5"]),
    "demo into a missing folder": (["demo", "-o", "no/such/demo"], ["no/such", "no folder"]),
    "demo into a file": (["demo", "-o", "good.csv"], ["good.csv", "is a file"]),
}


@pytest.mark.parametrize("case", CALLS)
def test_a_bad_call_is_refused_in_one_line_and_nothing_is_written(
    case: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    argv, words = CALLS[case]
    monkeypatch.chdir(tmp_path)
    path = good(tmp_path)
    content = path.read_bytes()
    refused(knobcam(*argv), *words)
    assert list(tmp_path.iterdir()) == [path]
    assert path.read_bytes() == content
