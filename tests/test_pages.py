"""What the pages are told: one schema, kept by Python, which writes it, and by `web/`, which reads it."""

from __future__ import annotations

import json
import runpy
from pathlib import Path

import pytest
import told
from carried import carried

import knobcam as kc
from knobcam.base import pages
from knobcam.base.strict_json import as_json
from knobcam.show import samples
from knobcam.show.linked import Look

WEB = Path(__file__).resolve().parents[1] / "web"
typed = runpy.run_path(str(WEB / "typed.py"))


def test_the_types_of_the_page_are_made_of_the_schema():
    """Else `python3 dev.py page` makes them anew."""
    assert (WEB / "src" / "types.js").read_text("utf-8") == typed["module"]()


@pytest.mark.parametrize(
    ("hint", "written"),
    [
        (list[str | None], "(string | null)[]"),
        (dict[str, list[float]], "Record<string, number[]>"),
        (tuple[float, bool] | None, "[number, boolean] | null"),
        (pages.Packed | None, "Packed | null"),
    ],
)
def test_types_are_written_as_the_page_writes_them(hint: object, written: str):
    assert typed["javascript"](hint) == written


def test_what_json_does_not_have_is_no_type_of_the_page():
    with pytest.raises(TypeError, match="nothing that JSON has"):
        typed["javascript"](set[str])


def test_a_page_of_linked_plots_holds_what_the_schema_says(story: kc.LearningResult):
    told.check(carried(story.look().html()), pages.Kept)
    told.check(carried(Look((samples.Shown("alone", story.fit),)).html()), pages.Kept)


def test_a_notebook_is_told_what_the_schema_says(story: kc.LearningResult):
    told.check(json.loads(story.look().widget.head), pages.Head)


def test_what_is_left_unexplained_is_told_as_the_schema_says(story: kc.LearningResult):
    left = samples.candidates(story.last, kc.Unexplained("time", 0.4, "a line at 50.0 Hz"))
    told.check(json.loads(as_json(left)), pages.Candidates)


STATE = {
    **{"id": "j1", "what": ["waiting"], "done": None, "recording": False},
    **{"takes_s": None, "seconds": 0.5, "stops": False},
}


@pytest.mark.parametrize(
    "wrong", [{"more": 1}, {"done": "half"}, {"recording": 0}, {"id": None}, {"done": True}]
)
def test_a_field_more_or_of_another_type_is_noticed(wrong: dict[str, object]):
    told.check(STATE, pages.Job)
    with pytest.raises(AssertionError):
        told.check(STATE | wrong, pages.Job)


@pytest.mark.parametrize("name", STATE)
def test_a_field_less_is_noticed(name: str):
    with pytest.raises(AssertionError, match=name):
        told.check({one: value for one, value in STATE.items() if one != name}, pages.Job)
