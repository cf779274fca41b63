"""The pictures of a story show its numbers: the ladder, the change, the movements, what was weighed."""

from __future__ import annotations

import dataclasses
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import matplotlib as mpl
import numpy as np
import pytest
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.patches import Rectangle
from small import COUPLINGS

import knobcam as kc
from knobcam import plot
from knobcam.model.typical import typical
from knobcam.show.plot.movements import plotted
from knobcam.show.words import param_word, sentence


@pytest.fixture(scope="module")
def humming() -> kc.LearningResult:
    """A knob with nothing missing and a torque that hums."""
    capture = kc.simulate("knob4", "sweep", duration_s=3.0, rate_hz=1000.0)
    tau = capture.tau + 2e-3 * np.sin(2.0 * np.pi * 50.0 * capture.t)
    named = dataclasses.replace(capture, tau=tau, meta={"source": "$hum$ <b>"})
    return kc.learn(named, without=COUPLINGS)


def writing(figure: Figure) -> str:
    return "\n".join(text.get_text() for text in figure.findobj(mpl.text.Text))


def bars(axes: Axes) -> list[tuple[float, float, float]]:
    """Row, left and right end of every bar; what spans the whole height is none."""
    patches = [p for p in axes.patches if isinstance(p, Rectangle) and p.get_height() < 0.9]
    ends = [(p.get_y() + p.get_height() / 2, p.get_x(), p.get_x() + p.get_width()) for p in patches]
    return [(row, min(a, b), max(a, b)) for row, a, b in ends]


def test_the_results_of_a_search_plot_themselves(story: kc.LearningResult) -> None:
    assert isinstance(story.plot(), Figure)
    assert isinstance(story.last.plot(), Figure)


def test_the_waterfall_hangs_each_effect_between_the_errors_before_and_after_it(
    story: kc.LearningResult,
) -> None:
    (axes,) = plot.ladder(story).axes
    drawn = bars(axes)
    first, last = 1e3 * story.ladder[0].rmse, 1e3 * story.ladder[-1].rmse
    assert drawn[0][1:] == pytest.approx((0.0, first))
    assert drawn[1][1:] == pytest.approx((last, first))
    assert drawn[-1][1:] == pytest.approx((0.0, last))
    assert "(mNm)" in axes.get_xlabel()


def test_the_floor_is_a_line_and_what_is_beyond_it_has_a_colour_of_its_own(
    story: kc.LearningResult, humming: kc.LearningResult
) -> None:
    for one in (story, humming):
        (axes,) = plot.ladder(one).axes
        (floor,) = [line for line in axes.lines if str(line.get_label()).startswith("sensor noise")]
        assert np.asarray(floor.get_xdata())[0] == pytest.approx(1e3 * one.noise_floor)
    assert len(bars(plot.ladder(story).axes[0])) == 3
    chance, beyond = bars(plot.ladder(humming).axes[0])[-2:]
    assert chance[2] == beyond[1] == pytest.approx(1e3 * humming.noise_floor)
    assert beyond[2] == pytest.approx(1e3 * humming.fit.rmse)


def test_before_and_after_share_one_scale_on_the_axis_that_failed(story: kc.LearningResult) -> None:
    top, bottom = plot.before_after(story).axes
    assert story.before.worst is not None
    assert story.before.worst.axis in bottom.get_xlabel()
    assert top.get_ylim() == bottom.get_ylim()
    assert "of the excess" in top.get_title(loc="left") and bottom.get_title(loc="left").endswith("chance")


def test_movements_are_drawn_in_standard_errors_for_every_parameter_of_the_first_model(
    story: kc.LearningResult,
) -> None:
    (axes,) = plot.movements(story).axes
    names = [label.get_text() for label in axes.get_yticklabels()]
    params = list(story.ladder[0].params)
    assert names == [param_word(one, "rotary") for one in params]
    step = story.ladder[1]
    drawn = {params[round(row)]: right if right > 0.0 else left for row, left, right in bars(axes)}
    for name, move in step.moved.items():
        assert drawn[name] == pytest.approx(move.by_se)


def test_no_title_of_a_story_lies_on_a_legend(story: kc.LearningResult) -> None:
    figure = story.plot()
    FigureCanvasAgg(figure).draw()
    for axes in figure.axes:
        legend, title = axes.get_legend(), axes._left_title  # type: ignore[attr-defined]
        if legend is not None and title.get_text():
            assert not legend.get_window_extent().overlaps(title.get_window_extent()), title.get_text()


def test_candidates_that_could_be_missing_are_solid_and_those_that_look_alike_are_linked(
    story: kc.LearningResult,
) -> None:
    diagnosis = story.first_diagnosis
    (axes,) = plot.diagnosis(diagnosis).axes
    patches = [patch for patch in axes.patches if isinstance(patch, Rectangle)]
    assert [patch.get_hatch() is None for patch in patches] == [one.could_be for one in diagnosis.candidates]
    assert [p.get_width() for p in patches] == pytest.approx(
        [100 * c.error_fall for c in diagnosis.candidates]
    )
    linked = "look alike in this capture" in writing(axes.figure)
    assert linked == any(one.equivalent for one in diagnosis.candidates)


def test_the_story_shows_what_remains_where_it_is_unexplained(
    humming: kc.LearningResult, story: kc.LearningResult
) -> None:
    assert "What is left along frequency" in writing(humming.plot())
    assert "Chance explains the rest" in writing(story.plot())
    assert sentence(humming.headline, "rotary").split(":")[0] in writing(humming.plot()).replace("\n", " ")


def test_a_hostile_name_is_printed_in_every_picture_of_a_story(
    humming: kc.LearningResult, tmp_path: Path
) -> None:
    paths = plot.save_learning(humming, tmp_path)
    assert paths[0].name == "01-story.png"
    assert all(path.read_bytes().startswith(b"\x89PNG") for path in paths)
    assert r"\$hum\$ <b>" in writing(plot.ladder(humming))


def test_a_linear_axis_is_told_in_newtons() -> None:
    model = kc.Model.of(["inertia", "coulomb", "return_spring"], "linear", inertia__M=100.0)
    model = model.with_value("coulomb.pos", 20.0).with_value("coulomb.neg", 20.0)
    model = model.with_value("return_spring.k", 300.0)
    whole = kc.motion("multisine", 5.0, 1000.0)
    track = kc.MotionTrack(whole.t, *(0.1 * column for column in whole[1:]))
    noise = kc.SensorNoise(tau_sd=0.5, omega_sd=1e-4, alpha_sd=1e-3)
    story = kc.learn(kc.simulate(model, track, noise=noise), detents="no", without=COUPLINGS)
    assert story.found
    words = writing(story.plot())
    assert "RMS error (N)" in words and "mNm" not in words
    assert "RMS error (N)" in repr(story)


@pytest.mark.parametrize("effect", [name for name in kc.effects() if name != "karnopp"])
def test_every_signature_shows_the_effect_over_time_and_where_it_is_a_line(effect: str) -> None:
    figure = plot.effect(kc.effects()[effect])
    assert len(figure.axes) == 6
    labels = [axes.get_xlabel() for axes in figure.axes]
    assert labels[0] == "time (s)" and labels[5].startswith("distance since reversal")
    (added,) = [line for line in figure.axes[0].lines if line.get_label() == "what it adds"]
    assert np.max(np.abs(np.asarray(added.get_ydata()))) > 0.0


def test_the_axis_that_an_effect_follows_is_framed() -> None:
    followed = {"inertia": "acceleration", "viscous": "velocity", "return_spring": "position"}
    for effect, axis in followed.items():
        framed = [axes for axes in plot.effect(kc.effects()[effect]).axes if axes.spines["top"].get_visible()]
        assert [axes.get_xlabel().split(" ")[0] for axes in framed] == [axis]


def test_typical_values_of_an_effect_are_what_a_small_knob_has() -> None:
    spring = typical(kc.effects()["return_spring"])
    assert 1e-4 < spring["return_spring.k"] < 1.0


def test_parameters_that_went_with_their_effect_have_no_empty_row(story: kc.LearningResult) -> None:
    first, *steps = story.ladder
    gone = next(iter(first.params))
    assert gone in plotted(story.ladder)
    without: Any = [
        SimpleNamespace(
            added=step.added, moved={name: one for name, one in step.moved.items() if name != gone}
        )
        for step in steps
    ]
    assert gone not in plotted((first, *without)) and len(plotted((first, *without))) > 0
    assert gone in plotted((first,))
