"""The command does its job: each subcommand, its document, its two streams, its end."""

from __future__ import annotations

import functools
import importlib
import io
import os
import shlex
import signal
import subprocess
import sys
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from command import knobcam, process, refused
from small import COUPLINGS

import knobcam as kc
from knobcam import cli, show
from knobcam.cli import command_parser, demonstration
from knobcam.cli.examples import EXAMPLES
from knobcam.show import report as page

COMMANDS = ["import", "simulate", "fit", "compare", "diagnose", "add", "learn", "effects", "demo"]


@pytest.fixture(scope="module")
def capture(tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("captures") / "knob3.npz"
    assert knobcam("simulate", "knob3", "-o", path).code == 0
    return path


@pytest.fixture
def pictures(monkeypatch: pytest.MonkeyPatch) -> None:
    """Pictures that cost nothing: what is drawn is the business of other tests."""

    def save_all(
        fit: kc.Fit,
        folder: Path,
        comparison: kc.Comparison | None = None,
        forward: object = None,
        kind: str = "png",
    ) -> list[Path]:
        name = f"fit.{kind}" if comparison is None else f"comparison.{kind}"
        folder.mkdir(exist_ok=True)
        (folder / name).write_bytes(b"picture")
        return [folder / name]

    def effect(effect: kc.Effect) -> Any:
        return SimpleNamespace(savefig=lambda path: Path(path).write_text(effect.id))

    def save_learning(story: kc.LearningResult, folder: Path, *_: object, **__: object) -> list[Path]:
        folder.mkdir(exist_ok=True)
        (folder / "story.png").write_bytes(b"picture")
        return [folder / "story.png"]

    def write(story: kc.LearningResult, path: Path) -> Path:
        path.write_text(story.headline)
        return path

    plot = SimpleNamespace(save_all=save_all, save_learning=save_learning, effect=effect)
    monkeypatch.setitem(sys.modules, "knobcam.show.report", SimpleNamespace(write=write))
    monkeypatch.setitem(sys.modules, "knobcam.show.plot", plot)
    monkeypatch.setattr(show, "plot", plot, raising=False)


def test_the_command_loads_neither_numpy_nor_the_core_before_it_needs_them() -> None:
    heavy = ["numpy", "matplotlib", "scipy", "pint", "asyncio", "knobcam._core"]
    code = f"import sys, knobcam.cli; print(*set({heavy}) & set(sys.modules))"
    where = str(Path(kc.__file__).parents[1])
    ended = subprocess.run(
        [sys.executable, "-c", code], env={"PYTHONPATH": where}, capture_output=True, text=True, check=False
    )
    assert (ended.returncode, ended.stdout, ended.stderr) == (0, "\n", "")


@pytest.mark.parametrize("name", kc.__all__)
def test_every_public_name_is_found_when_it_is_asked_for(name: str) -> None:
    assert getattr(kc, name) is not None
    assert name in dir(kc)


@pytest.mark.parametrize("name", ["fit", "learn"])
def test_a_function_keeps_its_name_though_its_package_has_the_same(name: str) -> None:
    code = f"import knobcam.{name}, knobcam as kc, sys; sys.exit(not callable(kc.{name}))"
    where = str(Path(kc.__file__).parents[1])
    assert (
        subprocess.run([sys.executable, "-c", code], env={"PYTHONPATH": where}, check=False).returncode == 0
    )
    assert importlib.import_module(f"knobcam.{name}").__name__ == f"knobcam.{name}"


def test_an_unknown_name_of_the_package_is_an_attribute_error() -> None:
    with pytest.raises(AttributeError, match="module 'knobcam' has no attribute 'fitt'"):
        kc.fitt  # noqa: B018


@pytest.mark.parametrize("argv", [["--help"], *[[command, "--help"] for command in COMMANDS]])
def test_help_names_every_command_and_option_and_ends_well(argv: list[str]) -> None:
    ended = knobcam(*argv)
    assert (ended.code, ended.err) == (0, "")
    for word in COMMANDS if argv == ["--help"] else ["--json", "--traceback"]:
        assert word in ended.out


def test_every_command_has_a_call_below_its_help_that_is_one() -> None:
    parser = command_parser()
    commands = next(one.choices for one in parser._actions if isinstance(one.choices, dict))
    assert EXAMPLES.keys() == commands.keys()
    for name, example in EXAMPLES.items():
        program, *words = shlex.split(example)
        assert program == "knobcam" and words[0] == name
        assert parser.parse_args(words).run is not None
        assert example in " ".join(commands[name].format_help().split())


def test_the_version_is_that_of_the_core() -> None:
    assert knobcam("--version") == (0, f"knobcam {kc.__version__}\n", "")


def test_import_writes_the_capture_that_load_reads(tmp_path: Path) -> None:
    source, target = tmp_path / "log.csv", tmp_path / "run.npz"
    n = np.arange(500)
    np.savetxt(source, np.column_stack([n / 1000.0, 8192 * np.sin(n / 50), np.cos(n / 50)]), delimiter=";")
    column_map = ["t=c0", "theta=c1/8192 [turn]", "tau=c2 [mNm]"]
    ended = knobcam("import", source, "-o", target, "--map", *column_map, "--start", "0.1", "--json")
    assert ended.code == 0
    expected, written = kc.load(source, map=column_map, start=0.1), kc.load(target)
    np.testing.assert_array_equal(written.theta, expected.theta)
    np.testing.assert_array_equal(written.tau, expected.tau)
    assert ended.document["schema"] == "knobcam.import/1"
    assert ended.document["capture"]["samples"] == expected.samples == 400
    assert ended.document["files"] == {"capture": str(target)}
    assert len(ended.document["findings"]) == len(expected.findings) == ended.err.count("\n")


@pytest.mark.parametrize(
    "call",
    [
        "simulate -o c.npz",
        "compare c.npz",
        "diagnose c.npz",
        "add offset c.npz",
        "render",
        "emulate",
        "fit c.npz",
    ],
)
def test_a_model_is_taken_by_its_option_and_where_there_is_one_by_its_place(call: str) -> None:
    parse = command_parser().parse_args
    assert parse([*call.split(), "--model", "knob2"]).model == "knob2"
    command, *others = call.split()
    assert parse([command, "--model=knob2", *others]).model == "knob2"
    if command != "fit":
        assert parse([*call.split(), "knob2"]).model == "knob2"


def test_simulate_gives_the_same_capture_for_the_same_seed(tmp_path: Path) -> None:
    runs = {name: tmp_path / f"{name}.npz" for name in ("first", "again", "other")}
    for (name, path), seed in zip(runs.items(), (4, 4, 5), strict=True):
        call = ["simulate", "knob1", "--motion", "turns", "--seed", str(seed), "--duration", "0.5"]
        assert knobcam(*call, "--rate", "2000", "-o", path).code == 0, name
    first, again, other = (kc.load(path) for path in runs.values())
    assert (first.samples, first.rate_hz) == (1000, 2000.0)
    np.testing.assert_array_equal(first.tau, again.tau)
    assert not np.array_equal(first.tau, other.tau)


def test_fit_prints_the_document_of_the_contract_and_writes_the_model(capture: Path, tmp_path: Path) -> None:
    target = tmp_path / "model.toml"
    document = knobcam("fit", capture, "-o", target, "--json").document
    assert document["schema"] == "knobcam.fit/1"
    for name in ("rmse", "rmse_heldout", "noise_floor", "iterations", "evaluations", "correlation"):
        assert document[name], name
    assert {"status", "message", "notes", "undetermined"} <= document.keys()
    period = document["params"]["detent.P"]
    assert period["ci95"][0] < 0.034 < period["ci95"][1] and period["unit"] == "rad"
    assert document["files"] == {"model": str(target)}
    values = {name: param.value for name, param in kc.Model.load(target).params.items()}
    assert values == {name: param["value"] for name, param in document["params"].items()}


def test_fit_takes_several_captures_and_a_model(capture: Path, tmp_path: Path) -> None:
    model = tmp_path / "model.toml"
    kc.Model.of(["inertia", "coulomb"]).save(model)
    again = tmp_path / "again.npz"
    assert knobcam("simulate", "knob3", "--seed", "5", "-o", again).code == 0
    ended = knobcam("fit", capture, again, "--model", model, "--prepare", "paper", "--json")
    assert len(ended.document["captures"]) == 2
    assert ended.document["effects"] == ["inertia", "coulomb"]


def test_fit_prints_a_table_with_units_and_says_what_was_found_apart(tmp_path: Path) -> None:
    path = tmp_path / "slow.csv"
    assert knobcam("simulate", "knob2", "--rate", "1000", "-o", path).code == 0
    ended = knobcam("fit", path)
    assert ended.code == 0
    assert "coulomb.pos" in ended.out and "N m" in ended.out and "95 % interval" in ended.out
    assert f"{path}: note: sampled at 1000 Hz" in ended.err


def test_compare_holds_the_model_as_it_is_and_fits_it_only_when_asked(capture: Path, tmp_path: Path) -> None:
    path = tmp_path / "model.toml"
    model = kc.fit(kc.load(capture)).model.with_value("coulomb.pos", 0.004)
    model.save(path)
    as_it_is = knobcam("compare", capture, path, "--json").document
    refitted = knobcam("compare", capture, path, "--refit", "--json").document
    assert as_it_is["schema"] == "knobcam.compare/1"
    assert not as_it_is["complete"] and refitted["complete"]
    assert as_it_is["rmse"] > 1.3 * refitted["rmse"]
    assert kc.Model.load(path).text() == model.text()


def test_effects_lists_the_catalogue_and_shows_one(tmp_path: Path) -> None:
    every = knobcam("effects")
    assert all(name in every.out for name in kc.effects())
    one = knobcam("effects", "coulomb", "--coordinate", "linear")
    assert "Coulomb 1785" in one.out and "coulomb.pos" in one.out and "N m" not in one.out
    document = knobcam("effects", "detent", "--json").document
    assert [effect["id"] for effect in document["effects"]] == ["detent"]
    assert document["effects"][0]["params"][0]["upper"] is None  # infinity, which JSON does not have


@pytest.mark.usefixtures("pictures")
def test_pictures_go_where_the_call_says(capture: Path, tmp_path: Path) -> None:
    plots, one = tmp_path / "plots", tmp_path / "one.svg"
    fitted = knobcam("fit", capture, "--plots", plots, "--json").document
    compared = knobcam("compare", capture, "knob3", "--plots", plots, "--json").document
    shown = knobcam("effects", "coulomb", "--plots", plots, "-o", one, "--json").document
    assert fitted["files"]["pictures"] == [str(plots / "fit.png")]
    assert compared["files"]["pictures"] == [str(plots / "comparison.png")]
    assert shown["files"]["pictures"] == [str(plots / "coulomb.png"), str(one)]
    assert one.read_text() == "coulomb"
    printed = knobcam("fit", capture, "--plots", plots, "--format", "pdf", "--json").document
    drawn = knobcam("effects", "coulomb", "--plots", plots, "--format", "svg", "--json").document
    assert printed["files"]["pictures"] == [str(plots / "fit.pdf")]
    assert drawn["files"]["pictures"] == [str(plots / "coulomb.svg")]
    refused(knobcam("fit", capture, "--plots", plots, "--format", "gif"), "--format", "svg")


@pytest.fixture
def short(monkeypatch: pytest.MonkeyPatch) -> None:
    """Demonstrations that cost a fraction: of half as long, without couplings and pictures in the report."""
    monkeypatch.setattr(page, "figure", lambda drawn, caption: f"<figure>{caption}</figure>")
    monkeypatch.setattr(demonstration, "learn", functools.partial(demonstration.learn, without=COUPLINGS))
    monkeypatch.setattr(demonstration, "record", functools.partial(demonstration.record, duration_s=3.0))


@pytest.mark.usefixtures("pictures", "short")
def test_demo_leaves_capture_model_report_and_pictures_in_a_folder_that_it_names_and_records_again_into(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    folder = tmp_path / "knobcam-demo-knob2"
    ended = knobcam("demo", "--knob", "knob2")
    assert ended.code == 0 and str(folder) in ended.out and "hides stribeck" in ended.out
    assert "stribeck was missing" in ended.out
    captured = [f"{name}.{kind}" for name in ("capture", "rendered") for kind in ("kcwire", "npz")]
    made = sorted([*captured, "model.toml", "report.html", "story.png"])
    assert sorted(path.name for path in folder.iterdir()) == made
    again = knobcam("demo", "--knob", "knob2", "--json").document
    assert again["found"] == ["stribeck"] and again["files"]["folder"] == str(folder)
    assert sorted(path.name for path in folder.iterdir()) == made


@pytest.mark.usefixtures("pictures", "short")
@pytest.mark.parametrize("knob", ["1", "3", "4", "5"])  # 2: above
def test_demo_finds_what_it_hid_in_every_knob(knob: str, tmp_path: Path) -> None:
    document = knobcam("demo", "--knob", knob, "-o", tmp_path / "demo", "--json").document
    assert document["schema"] == "knobcam.learn/1" and document["verdict"] == "missing"
    assert document["hidden"] == ["stribeck"] and "stribeck" in document["found"]
    assert document["files"]["folder"] == str(tmp_path / "demo")
    files = [document["files"][kind] for kind in ("log", "capture", "model", "rendered", "report")]
    assert all(Path(file).is_file() for file in files)


@pytest.mark.usefixtures("pictures", "short")
def test_demo_hides_the_effect_that_is_asked_for(tmp_path: Path) -> None:
    folder = tmp_path / "demo"
    document = knobcam(
        "demo", "--knob", "4", "--effect", "position_polynomial", "-o", folder, "--json"
    ).document
    assert document["hidden"] == ["position_polynomial"]
    assert document["verdict"] == "missing"
    assert "position_polynomial" in (*document["found"], *document["ladder"][-1]["equivalent"])
    assert Path(document["files"]["report"]).is_file()
    assert kc.load(document["files"]["capture"]).samples == kc.load(document["files"]["log"]).samples
    assert document["rendered"]["rmse"] == pytest.approx(document["noise_floor"], rel=0.05)


def test_a_process_answers_like_the_function(capture: Path, tmp_path: Path) -> None:
    assert process("fit", capture, "--json") == knobcam("fit", capture, "--json")


def test_a_failure_of_the_program_is_one_line_and_how_to_see_more(monkeypatch: pytest.MonkeyPatch) -> None:
    def broken(axis: str) -> None:
        raise ZeroDivisionError("first\nsecond")

    monkeypatch.setattr(importlib.import_module("knobcam.model.effects"), "effects", broken)
    ended = knobcam("effects")
    assert (ended.code, ended.out, ended.err.count("\n")) == (1, "", 1)
    assert "ZeroDivisionError: first second" in ended.err and "--traceback" in ended.err
    traced = knobcam("effects", "--traceback")
    assert traced.code == 1 and "Traceback" in traced.err and "in broken" in traced.err


def test_an_interrupt_is_one_line(monkeypatch: pytest.MonkeyPatch) -> None:
    def interrupted(axis: str) -> None:
        raise KeyboardInterrupt

    monkeypatch.setattr(importlib.import_module("knobcam.model.effects"), "effects", interrupted)
    assert knobcam("effects") == (130, "", "knobcam: interrupted\n")


@pytest.mark.parametrize("argv", [["effects", "--json"], ["--help"]])
def test_a_reader_that_has_seen_enough_is_no_failure(argv: list[str]) -> None:
    words = [sys.executable, "-m", "knobcam", *argv]
    where = {"PYTHONPATH": str(Path(cli.__file__).parents[2])}
    with subprocess.Popen(words, stdout=subprocess.PIPE, stderr=subprocess.PIPE, env=where) as running:
        assert running.stdout is not None and running.stderr is not None
        running.stdout.close()
        assert running.stderr.read() == b""
    assert running.returncode == 0


@pytest.mark.skipif(not Path("/dev/full").exists(), reason="there is no device that is always full")
def test_a_full_disk_behind_standard_output_is_one_line() -> None:
    words = [sys.executable, "-m", "knobcam", "effects"]
    where = {"PYTHONPATH": str(Path(cli.__file__).parents[2])}
    with Path("/dev/full").open("w") as full:
        ended = subprocess.run(words, stdout=full, stderr=subprocess.PIPE, text=True, env=where, check=False)
    assert ended.returncode == 2
    assert ended.stderr.startswith("knobcam: standard output: ") and ended.stderr.count("\n") == 1


def test_progress_is_shown_on_a_terminal_and_gone_in_the_end(
    capture: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    class Terminal(io.StringIO):
        def isatty(self) -> bool:
            return True

    shown = Terminal()
    monkeypatch.setattr(sys, "stderr", shown)
    monkeypatch.setattr(sys, "stdout", io.StringIO())
    assert cli.main(["fit", str(capture)]) == 0
    assert "fitting ..." in shown.getvalue()
    assert shown.getvalue().endswith("\r\x1b[K")


def test_who_makes_another_error_of_being_ended_hides_nothing(monkeypatch: pytest.MonkeyPatch) -> None:
    def half_imported() -> None:
        try:
            os.kill(os.getpid(), signal.SIGTERM)
        except SystemExit:
            raise ImportError("half of a library") from None

    monkeypatch.setattr(cli, "command_parser", half_imported)
    assert knobcam("effects") == (143, "", "knobcam: ended by SIGTERM\n")
