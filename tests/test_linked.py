"""The linked plots as a page: that of a notebook without widgets, of a file, and within a report."""

from __future__ import annotations

import re
from html import unescape
from pathlib import Path

import numpy as np
import pytest
from carried import carried, unpacked

import knobcam as kc
from knobcam.show import look_page
from knobcam.show.linked import Look
from knobcam.show.packed import FINE, packed, step_of
from knobcam.show.samples import Shown


def test_a_notebook_without_widgets_shows_the_same_page_as_the_file(
    story: kc.LearningResult, tmp_path: Path
) -> None:
    look = story.look()
    shown = re.findall(r'srcdoc="([^"]*)"', look._repr_html_())
    assert [unescape(one) for one in shown] == [look.save(tmp_path / "look.html").read_text("utf-8")]
    assert 'sandbox="allow-scripts"' in look._repr_html_()


def test_a_page_carries_every_sample_as_fine_as_a_picture_needs(story: kc.LearningResult) -> None:
    held = carried(story.fit.look().html())
    signals = story.fit.signals
    assert held["n"] == held["all"] == signals.capture.samples
    for name in ("theta", "omega", "tau"):
        column = signals.on_capture(getattr(signals, name))
        near = np.nanmax(column) - np.nanmin(column)
        assert unpacked(held["columns"][name]) == pytest.approx(column, abs=1e-5 * near, nan_ok=True)
    t = signals.capture.t
    assert unpacked(held["columns"]["t"]) == pytest.approx(t - t[0], abs=1e-6)


def test_what_a_page_carries_of_the_error_is_the_error(story: kc.LearningResult) -> None:
    held = carried(story.look().html())
    for step, residual in zip(story.ladder, map(unpacked, held["residuals"]), strict=True):
        assert np.sqrt(np.nanmean(residual**2)) == pytest.approx(step.rmse, rel=1e-6)


def test_what_a_candidate_would_explain_is_what_goes_when_it_is_added(story: kc.LearningResult) -> None:
    held = carried(story.look().html())
    added = story.ladder[1].added
    assert [row["effect"] for row in held["steps"][0]["candidates"]["rows"]] == list(held["signatures"][0])
    left = unpacked(held["residuals"][0]) - unpacked(held["signatures"][0][str(added)])
    assert np.sqrt(np.nanmean(left**2)) == pytest.approx(story.ladder[1].rmse, rel=1e-2)


def test_a_diagnosis_shows_its_candidates_beside_the_plots(fit: kc.Fit) -> None:
    diagnosis = fit.diagnose()
    (step,) = diagnosis.look().steps
    assert step.effects == tuple(one.effect for one in diagnosis.candidates)
    assert fit.look().steps[0].effects == ()


def test_of_more_samples_than_a_page_carries_it_says_how_many(
    story: kc.LearningResult, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(look_page, "MOST", 4000)
    held = carried(story.fit.look().html())
    assert (held["n"], held["all"]) == (4000, story.captures[0].samples)
    residual = unpacked(held["residuals"][0])
    assert np.all(np.diff(unpacked(held["columns"]["t"])) > 0.0)
    assert np.sqrt(np.nanmean(residual**2)) == pytest.approx(story.fit.rmse, rel=0.1)


@pytest.mark.parametrize(
    "values",
    [
        np.full(5, np.nan),
        np.zeros(3),
        np.array([]),
        np.array([np.nan, -1e9, np.nan, 1e9, 3.0]),
        np.full(4, 7e-12),
    ],
    ids=["nothing known", "all zero", "empty", "with gaps", "all the same"],
)
def test_packing_moves_no_value_by_more_than_half_a_step(values: np.ndarray) -> None:
    for steps in (2**16, FINE):
        step = step_of(values, steps)
        assert unpacked(packed(values, step)) == pytest.approx(values, abs=0.51 * step, nan_ok=True)


def test_a_hostile_label_cannot_end_the_element_it_stands_in(story: kc.LearningResult) -> None:
    page = Look((Shown("</script><script>alert(1)</script>", story.fit),)).html()
    assert page.count("<script") == 2 and page.count("</script") == 2
