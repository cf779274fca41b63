"""Linked plots in a notebook: what Python and the widget tell each other, and what is shown without one."""

from __future__ import annotations

import json
import subprocess
import sys

import numpy as np
import pytest

import knobcam as kc
from knobcam.show.linked import Look

WIDGET = "application/vnd.jupyter.widget-view+json"


@pytest.fixture
def look(story: kc.LearningResult) -> Look:
    return story.look()


def told(look: Look, **state: object) -> None:
    """Let the browser's side of the widget change what is shared."""
    look.widget.set_state(state)


def test_a_notebook_gets_the_widget_and_for_its_file_the_page(look: Look) -> None:
    shown, _ = look._repr_mimebundle_()
    assert shown[WIDGET]["model_id"] == look.widget.model_id
    assert shown["text/html"] == look._repr_html_()


def test_where_anywidget_is_absent_a_notebook_shows_the_page_and_the_rest_says_what_to_install() -> None:
    script = """
import sys
sys.modules["anywidget"] = None
import knobcam as kc
look = kc.fit(kc.simulate(kc.Model.load("knob4"), duration_s=1.0)).look()
shown, _ = look._repr_mimebundle_()
assert sorted(shown) == ["text/html", "text/plain"], shown
try:
    look.chosen
except kc.InputError as error:
    print(error)
"""
    said = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, check=True).stdout
    assert 'pip install "knobcam[notebook]"' in said


def test_samples_go_to_the_widget_whole_and_as_bytes(look: Look, story: kc.LearningResult) -> None:
    head = json.loads(look.widget.head)
    floats = np.frombuffer(look.widget.floats, "<f4").reshape(4 + len(story.ladder), head["n"])
    assert head["n"] == head["all"] == story.captures[0].samples
    for step, residual in zip(story.ladder, floats[4:], strict=True):
        assert residual == pytest.approx(step.fit.residual, rel=1e-6, nan_ok=True)


def test_what_is_brushed_comes_back_as_indices_with_its_share_of_the_error(look: Look) -> None:
    heard = []
    look.widget.observe(lambda change: heard.append(change["new"]), "chosen")
    told(look, chosen=memoryview(np.packbits([0, 1, 0, 0, 1, 1], bitorder="little").tobytes()))
    assert [rows.tolist() for rows in look.chosen] == [[1, 4, 5]]
    assert len(heard) == 1
    told(look, chosen=memoryview(b""))
    assert look.share == 0.0 and not look.chosen[0].size
    residual = look.steps[0].fit.residual
    worst = np.argsort(-np.abs(np.nan_to_num(residual)))[: len(residual) // 10]
    look.chosen = [worst]
    assert look.share == pytest.approx(np.sum(residual[worst] ** 2) / np.nansum(residual**2))
    assert look.share > 0.1


def test_what_python_chooses_is_sent_as_bits(look: Look) -> None:
    look.chosen = [[9, 1]]
    bits = np.unpackbits(
        np.frombuffer(look.widget.get_state("chosen")["chosen"], np.uint8), bitorder="little"
    )
    assert np.flatnonzero(bits).tolist() == [1, 9]


def test_the_captures_of_a_joint_fit_have_their_own_indices() -> None:
    captures = [kc.simulate(kc.Model.load("knob4"), duration_s=1.0, seed=seed) for seed in (1, 2)]
    look = kc.fit(captures).look()
    count = captures[0].samples
    flags = np.zeros(2 * count, bool)
    flags[[3, count, count + 7]] = True
    told(look, chosen=memoryview(np.packbits(flags, bitorder="little").tobytes()))
    assert [rows.tolist() for rows in look.chosen] == [[3], [0, 7]]


def test_the_share_is_that_of_the_model_that_is_shown(look: Look) -> None:
    residuals = [step.fit.residual for step in look.steps]
    look.chosen = [np.argsort(-np.abs(np.nan_to_num(residuals[0])))[:1000]]
    before = look.share
    look.step = 1
    assert look.share < before


@pytest.mark.parametrize("step", [-1, 2])
def test_a_step_that_is_not_there_is_refused(look: Look, step: int) -> None:
    with pytest.raises(kc.InputError, match=f"step={step} is none of the 2 models"):
        look.step = step


def test_samples_that_are_not_there_are_refused(look: Look) -> None:
    with pytest.raises(kc.InputError, match="chosen has 2 arrays; there are 1 captures"):
        look.chosen = [[1], [2]]
    for rows in ([-1], [10**9]):
        with pytest.raises(kc.InputError, match="counted from 0"):
            look.chosen = [rows]


def test_a_mask_is_refused_rather_than_taken_for_indices(look: Look) -> None:
    for rows in (np.array([True, False]), [0.5]):
        with pytest.raises(kc.InputError, match="flatnonzero"):
            look.chosen = [rows]


def test_a_candidate_that_is_looked_at_is_answered_with_what_it_would_explain(look: Look) -> None:
    effect = look.steps[0].effects[0]
    told(look, looked=effect)
    overlay = look.widget.overlay
    assert (overlay["effect"], overlay["step"]) == (effect, 0)
    expected = look.steps[0].explained(effect)
    assert np.frombuffer(overlay["floats"], "<f4") == pytest.approx(expected, rel=1e-5, nan_ok=True)
    told(look, looked="no such effect")
    assert look.widget.overlay == overlay


def test_what_goes_to_the_widget_is_json_even_where_numbers_are_none(fit: kc.Fit) -> None:
    def refuse(word: str) -> None:
        raise AssertionError(word)

    json.loads(fit.diagnose().look().widget.head, parse_constant=refuse)


def test_the_step_that_is_shown_is_found_under_its_old_name_too(look: Look) -> None:
    with pytest.warns(DeprecationWarning, match=r"Look\.rung is now called step"):
        look.rung = 1
    with pytest.warns(DeprecationWarning, match=r"Look\.rung is now called step"):
        assert look.rung == look.step == 1
    with pytest.warns(DeprecationWarning, match=r"Look\.rungs is now called steps"):
        assert look.rungs is look.steps
