"""What has another name now: for one version it is found under its old one too."""

from __future__ import annotations

import sys
from importlib import import_module

import pytest

import knobcam as kc
from knobcam.fit.compare import Split

MOVED = {
    "compare": "fit.compare",
    "effects": "model.effects",
    "finding": "capture.finding",
    "linked": "show.linked",
    "loop": "render.loop",
    "loop_report": "render.loop_report",
    "plot": "show.plot",
}


@pytest.fixture(autouse=True)
def forgotten(monkeypatch: pytest.MonkeyPatch) -> None:
    for old in MOVED:
        monkeypatch.delitem(sys.modules, f"knobcam.{old}", raising=False)


@pytest.mark.parametrize("old", MOVED)
def test_a_module_under_its_old_name_is_the_same_and_says_what_it_is_called_now(old: str) -> None:
    now = import_module(f"knobcam.{MOVED[old]}")
    with pytest.warns(DeprecationWarning, match=rf"knobcam\.{old} is {now.__name__} now"):
        assert import_module(f"knobcam.{old}") is now
    assert now.__spec__ is not None
    assert now.__spec__.name == now.__name__


def test_a_name_of_an_old_module_is_the_same_and_the_function_of_that_name_stays() -> None:
    with pytest.warns(DeprecationWarning):
        from knobcam.compare import Split as before
    assert before is Split
    assert kc.compare.__name__ == "compare"


def test_the_warning_names_the_line_that_has_to_change() -> None:
    with pytest.warns(DeprecationWarning) as said:
        import knobcam.linked  # noqa: F401
    assert said[0].filename == __file__


RENAMED = {"Lack": kc.Limitation, "Rung": kc.LearningStep, "Story": kc.LearningResult}
DRAWN = {"save_story": kc.plot.save_learning, "story": kc.plot.learned}


@pytest.mark.parametrize("old", RENAMED)
def test_a_class_that_was_renamed_is_found_under_its_old_name_too(old: str) -> None:
    with pytest.warns(DeprecationWarning, match=f"{old} is now called {RENAMED[old].__name__}"):
        assert getattr(kc, old) is RENAMED[old]
    assert old not in dir(kc)


@pytest.mark.parametrize("old", DRAWN)
def test_a_picture_that_was_renamed_is_found_under_its_old_name_too(old: str) -> None:
    with pytest.warns(DeprecationWarning, match=f"{old} is now called {DRAWN[old].__name__}"):
        assert getattr(kc.plot, old) is DRAWN[old]
