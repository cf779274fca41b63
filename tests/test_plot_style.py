"""Pictures over time mark what is masked, names are printed as they are, and no global state changes."""

from __future__ import annotations

import subprocess
import sys

import matplotlib as mpl
import numpy as np
import pytest

import knobcam as kc
from knobcam import plot
from knobcam.show.plot.style import plain, torque_scale
from knobcam.show.plot.thin import envelope, some


def test_importing_knobcam_does_not_import_matplotlib() -> None:
    code = "import sys, knobcam; sys.exit('matplotlib' in sys.modules)"
    assert subprocess.run([sys.executable, "-c", code], check=False).returncode == 0


def test_pictures_need_no_pyplot() -> None:
    code = (
        "import sys, knobcam as kc; from knobcam import plot; "
        "plot.model(kc.Model.load('knob4'))._repr_png_(); sys.exit('matplotlib.pyplot' in sys.modules)"
    )
    assert subprocess.run([sys.executable, "-c", code], check=False).returncode == 0


def test_a_picture_leaves_the_settings_as_they_were_and_does_not_depend_on_them(fit: kc.Fit) -> None:
    plain_picture = plot.scan(fit)._repr_png_()
    with mpl.rc_context(
        {"lines.linewidth": 7.0, "font.size": 30.0, "axes.facecolor": "red", "xtick.major.size": 40}
    ):
        before = dict(mpl.rcParams)
        assert plot.scan(fit)._repr_png_() == plain_picture
        assert dict(mpl.rcParams) == before


def test_strong_torque_is_drawn_in_newton_metres_and_force_in_newtons() -> None:
    assert torque_scale("N m", 0.2) == (1000.0, "mNm")
    assert torque_scale("N m", 12.0) == (1.0, "N m")
    assert torque_scale("N", 0.2) == (1.0, "N")


def test_masked_samples_are_marked_where_they_are(capture: kc.Capture) -> None:
    tau = capture.tau.copy()
    tau[2_000:2_100] = np.nan
    tau[4_000] = np.inf
    damaged = kc.Capture.from_arrays(t=capture.t, theta=capture.theta, tau=tau)
    for figure in (plot.capture(damaged), plot.prepared(kc.prepare(damaged))):
        for axes in figure.axes:
            (marks,) = [c for c in axes.collections if str(c.get_label()).startswith("masked")]
            assert marks.get_label() == "masked (101 of 6000 samples)"
            spans = [path.get_extents().intervalx for path in marks.get_paths()]
            np.testing.assert_allclose(spans[0], [2.0, 2.1], atol=1e-3)
            assert spans[1][0] == pytest.approx(4.0, abs=1e-3)
    (drawn,) = plot.capture(damaged).axes[-1].lines
    assert not np.any(np.isinf(np.asarray(drawn.get_ydata())))


def test_a_clean_capture_has_no_marks(capture: kc.Capture) -> None:
    assert all(not axes.collections for axes in plot.capture(capture).axes)


def test_a_masked_spike_does_not_flatten_the_rest(capture: kc.Capture) -> None:
    mask = np.ones(capture.samples, dtype=bool)
    tau = capture.tau.copy()
    tau[100], mask[100] = 50.0, False
    spiked = kc.Capture(capture.t, capture.theta, None, None, tau, mask, "rotary", capture.rate_hz)
    assert plot.capture(spiked).axes[-1].get_ylim()[1] < 30.0


def test_a_derived_column_says_so(capture: kc.Capture) -> None:
    bare = kc.Capture.from_arrays(t=capture.t, theta=capture.theta, tau=capture.tau)
    titles = [axes.get_title(loc="left") for axes in plot.prepared(kc.prepare(bare)).axes]
    assert ["derived" in title for title in titles] == [False, True, True, False]


def test_commanded_lies_wide_under_measured(capture: kc.Capture) -> None:
    track = kc.motion("sweep")
    figure = plot.overlay(track, capture)
    assert len(figure.axes) == 3
    for axes in figure.axes:
        wide, thin = axes.lines
        assert wide.get_linewidth() > 3.0 * thin.get_linewidth()
    assert len(plot.overlay(track, capture, torque=np.zeros(30_000)).axes) == 4
    with pytest.raises(kc.InputError, match="torque has shape"):
        plot.overlay(track, capture, torque=np.zeros(3))


HOSTILE = [
    "$\\frac{1}{$",
    "50$ and 60$",
    "$x$",
    "a\\$b$c$",
    "line\nbreak\x00",
    "漢字 \U0001f600",
    "_hidden",
    "%s {0} <b>",
]


@pytest.mark.parametrize("name", HOSTILE)
def test_a_hostile_name_is_printed_and_never_interpreted(name: str) -> None:
    t = np.arange(200) / 100.0
    named = kc.Capture.from_arrays(t=t, theta=np.sin(t), tau=np.cos(t), meta={"source": name})
    figure = plot.capture(named)
    assert figure._repr_png_().startswith(b"\x89PNG")
    title = figure.findobj(lambda artist: artist is figure._suptitle)[0]
    shown, is_math = title._preprocess_math(title.get_text())
    assert not is_math
    assert "\n" not in shown
    printable = "".join(c for c in name if c.isascii() and c.isprintable())
    assert "".join(c for c in shown if c.isascii() and c != "?") == printable.replace("?", "")
    plot.model(kc.Model.load("knob4").renamed(name.replace("\x00", "")))._repr_png_()


def test_a_long_name_keeps_its_beginning_and_its_end() -> None:
    short = plain("begin" + 500 * "x" + "end.csv")
    assert len(short) <= 80
    assert short.startswith("begin")
    assert short.endswith("end.csv")


def test_many_dots_are_thinned_and_all_lie_inside() -> None:
    inside = np.arange(1_000_000) % 2 == 0
    rows = some(inside)
    assert len(rows) == 20_000
    assert inside[rows].all()
    assert np.array_equal(some(inside), rows)


def test_a_thinned_line_keeps_every_spike_and_its_gaps() -> None:
    t = np.arange(1_000_000, dtype=float)
    y = np.zeros(1_000_000)
    y[123_456], y[777_777] = 5.0, -7.0
    y[300_000:400_000] = np.nan
    x, thin = envelope(t, y)
    assert len(x) < 10_000
    assert x[np.nanargmax(thin)] == 123_456
    assert x[np.nanargmin(thin)] == 777_777
    assert np.isnan(thin[(x > 300_500) & (x < 399_500)]).all()
    assert np.all(np.diff(x) >= 0.0)
