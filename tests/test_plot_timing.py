"""The picture of a loop's timing shows its wake-ups and its misses where they were."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from matplotlib.figure import Figure

from knobcam import plot
from knobcam.render.loop_report import Durations, LastSecond, LoopReport

PERIOD = 2e-4


def durations(seconds: np.ndarray) -> Durations:
    edges = np.concatenate([[0.0], np.geomspace(1e-9, 4.0, 400)])
    counts, _ = np.histogram(seconds, edges)
    figures = (np.min(seconds), *np.quantile(seconds, [0.5, 0.99, 0.999]), np.max(seconds), np.mean(seconds))
    return Durations(*map(float, figures), edges, counts.astype(np.uint64))


@pytest.fixture(scope="module")
def report() -> LoopReport:
    """One second at 5 kHz: wake-ups late by some microseconds, and 20 periods missed from 0.4 s on."""
    kept = np.setdiff1d(np.arange(5000), np.arange(2000, 2020))
    late = 5e-6 * np.exp(np.random.default_rng(0).standard_normal(len(kept)))
    zero = np.zeros(len(kept))
    last = LastSecond(PERIOD * kept + late, zero, zero, zero, zero, zero, late)
    late_bins, busy_bins = durations(late), durations(zero + 1e-6)
    return LoopReport(
        *(5000.0, 0.02, len(kept), 20, 20, late_bins, busy_bins, last, "time", "its time was over", None),
        "not permitted: $1$ <b>",
    )


def by_title(figure: Figure, title: str):
    (axes,) = [axes for axes in figure.axes if axes.get_title(loc="left") == title]
    return axes


def test_the_histogram_holds_every_step(report):
    axes = by_title(report.plot(), "All steps")
    assert (axes.get_xscale(), axes.get_yscale()) == ("log", "log")
    late, busy = (patch.get_data() for patch in axes.patches[:2])
    assert late.values.sum() == busy.values.sum() == report.steps
    assert late.edges[0] <= 1e6 * report.late.min
    assert late.edges[-1] >= 1e6 * report.late.max
    assert axes.lines[0].get_xdata()[0] == pytest.approx(200.0)


def test_missed_periods_are_marked_where_they_were(report):
    axes = by_title(report.plot(), "Last second")
    (marks,) = [c for c in axes.collections if str(c.get_label()).startswith("missed")]
    assert marks.get_label() == "missed (20 periods)"
    (span,) = [path.get_extents().intervalx for path in marks.get_paths()]
    np.testing.assert_allclose(span, [0.4, 0.404], atol=1e-9)
    assert np.max(axes.lines[0].get_ydata()) == pytest.approx(1e6 * report.late.max)


def test_a_punctual_loop_has_no_marks_and_the_title_says_the_standing(report):
    zero = np.zeros(5000)
    punctual = LastSecond(PERIOD * np.arange(5000), *(zero,) * 6)
    figure = plot.timing(replace(report, last=punctual, late=durations(zero)))
    assert not by_title(figure, "Last second").collections
    assert figure._suptitle.get_text().endswith("not permitted: \\$1\\$ <b>")
    assert figure._repr_png_().startswith(b"\x89PNG")


def test_a_loop_that_took_no_step_is_drawn_empty(report):
    none = Durations(*(0.0,) * 6, report.late.edges, np.zeros_like(report.late.counts))
    empty = LastSecond(*(np.zeros(0),) * 7)
    figure = plot.timing(replace(report, steps=0, missed=0, late=none, busy=none, last=empty))
    assert not by_title(figure, "All steps").patches
    assert figure._repr_png_().startswith(b"\x89PNG")
