"""What `python3 dev.py` does of its commands, without doing it."""

from __future__ import annotations

import subprocess
import sys
from importlib import util
from pathlib import Path
from types import ModuleType

import pytest

FILE = Path(__file__).parents[1] / "dev.py"


@pytest.fixture
def dev(monkeypatch: pytest.MonkeyPatch) -> ModuleType:
    """The file, in a checkout in which nothing is set up yet and no command runs."""
    spec = util.spec_from_file_location("dev", FILE)
    assert spec is not None and spec.loader is not None
    module = util.module_from_spec(spec)
    spec.loader.exec_module(module)
    for name in ("done", "collect"):
        monkeypatch.setattr(module, name, lambda *_: None)
    monkeypatch.setattr(module, "changed", lambda *_: True)
    return module


def ran(dev: ModuleType, command: str, monkeypatch: pytest.MonkeyPatch) -> list[str]:
    lines: list[str] = []
    monkeypatch.setattr(dev, "run", lambda *words, **_: lines.append(" ".join(map(str, words))))
    getattr(dev, command)(*([[]] if command == "demo" else []))
    return lines


def test_a_first_look_builds_the_extension_and_nothing_for_other_programs(
    dev: ModuleType, monkeypatch: pytest.MonkeyPatch
) -> None:
    looked, worked = ran(dev, "demo", monkeypatch), ran(dev, "setup", monkeypatch)
    assert [line for line in looked if "maturin" in line] and looked[-1].endswith("knobcam demo")
    assert not [line for line in looked if "knobstep" in line]
    assert len([line for line in worked if "knobstep" in line]) == 2


def test_what_a_command_compiles_of_python_is_kept_where_the_environment_forbids_it(
    dev: ModuleType, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("PYTHONDONTWRITEBYTECODE", "1")
    told = dev.run(sys.executable, "-c", "import sys; print(sys.dont_write_bytecode)", silent=True)
    assert told == "False\n"


def asked_of_crates(*selection: str) -> dict[str, str]:
    """The features of every crate that a build of cargo would compile."""
    words = [
        "cargo",
        "tree",
        "--locked",
        "--prefix",
        "none",
        "--no-dedupe",
        "--format",
        "{p}\t{f}",
        *selection,
    ]
    told = subprocess.run(words, cwd=FILE.parent, capture_output=True, text=True, check=True).stdout
    return {name: features for name, _, features in (line.partition("\t") for line in told.splitlines())}


def test_one_compiled_core_serves_whatever_is_built_with_an_operating_system() -> None:
    core = asked_of_crates("--package", "knobcore", "--edges", "normal")
    tests = [word for name in ("core", "render", "rig", "step") for word in ("--package", f"knob{name}")]
    for selection in (
        ["--package", "knobpy", "--edges", "normal"],
        ["--package", "knobstep", "--edges", "normal"],
        [*tests, "--edges", "normal,dev"],
        ["--package", "knobrig", "--features", "orders", "--edges", "normal,dev"],
    ):
        asked = asked_of_crates(*selection)
        other = {name: asked[name] for name in core.keys() & asked.keys() if asked[name] != core[name]}
        assert not other, selection
