"""What `python3 dev.py` does of its commands, without doing it."""

from __future__ import annotations

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
