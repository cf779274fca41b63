"""Pictures show what they say: units, values, masked samples, and nobody's global state changes."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path
from types import SimpleNamespace

import matplotlib as mpl
import numpy as np
import pytest
from matplotlib.axes import Axes
from matplotlib.figure import Figure

import knobcam as kc
from knobcam import plot
from knobcam.plot.components import PARTS, Samples, curve, curve_band, part_of
from knobcam.plot.signature import example
from knobcam.plot.style import plain, torque_scale
from knobcam.plot.thin import envelope, some

SLED_NOISE = kc.SensorNoise(tau_sd=0.5, omega_sd=1e-4, alpha_sd=1e-3)


@pytest.fixture(scope="module")
def capture() -> kc.Capture:
    return kc.simulate(kc.Model.load("knob4"), "sweep")


@pytest.fixture(scope="module")
def fit(capture: kc.Capture) -> kc.Fit:
    return kc.fit(capture)


@pytest.fixture(scope="module")
def sticky() -> kc.Fit:
    """A fit of a model that knows its stiction."""
    knob = kc.Model.load("knob3")
    model = kc.Model.of(["inertia", "coulomb", "viscous", "karnopp"])
    for name in ("D_neg", "D_pos", "dv"):
        model = model.with_value(f"karnopp.{name}", knob.params[f"karnopp.{name}"].value)
        model = model.with_fixed(f"karnopp.{name}")
    return kc.fit(kc.simulate(knob, "micro", duration_s=2.0), model)


@pytest.fixture(scope="module")
def linear() -> kc.Fit:
    """A sled: 100 kg, 20 N of friction, 200 N s/m."""
    values = {"inertia__M": 100.0, "coulomb__neg": 20.0, "coulomb__pos": 20.0}
    model = kc.Model.of(
        ["inertia", "coulomb", "viscous"], "linear", **values, viscous__neg=200.0, viscous__pos=200.0
    )
    t = np.arange(1, 5001) / 1000.0
    track = kc.MotionTrack(t, *(0.1 * column for column in kc.motion("multisine", 5.0, 1000.0)[1:]))
    return kc.fit(kc.simulate(model, track, noise=SLED_NOISE), detents="no")


def panel(figure: Figure, title: str) -> Axes:
    found = [axes for axes in figure.axes if axes.get_title(loc="left").startswith(title)]
    assert found, [axes.get_title(loc="left") for axes in figure.axes]
    return found[0]


def line(axes: Axes, label: str) -> tuple[np.ndarray, np.ndarray]:
    found = [artist for artist in axes.lines if str(artist.get_label()).startswith(label)]
    assert found, [artist.get_label() for artist in axes.lines]
    return np.asarray(found[0].get_xdata()), np.asarray(found[0].get_ydata())


def writing(figure: Figure) -> str:
    """Everything that is written on a figure."""
    return "\n".join(text.get_text() for text in figure.findobj(mpl.text.Text))


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


def test_every_result_plots_itself(fit: kc.Fit) -> None:
    results = (fit, fit.signals, fit.signals.capture, fit.model, fit.compare(), kc.effects()["viscous"])
    for result in results:
        assert isinstance(result.plot(), Figure)


def test_torque_is_drawn_in_thousandths_of_a_newton_metre(capture: kc.Capture) -> None:
    figure = plot.capture(capture)
    axes = figure.axes[-1]
    assert "(mNm)" in axes.get_ylabel()
    drawn = np.asarray(axes.lines[0].get_ydata())
    assert np.max(drawn) == pytest.approx(1000.0 * np.max(capture.tau))
    assert np.min(drawn) == pytest.approx(1000.0 * np.min(capture.tau))


def test_strong_torque_is_drawn_in_newton_metres_and_force_in_newtons() -> None:
    assert torque_scale("rotary", 0.2) == (1000.0, "mNm")
    assert torque_scale("rotary", 12.0) == (1.0, "N m")
    assert torque_scale("linear", 0.2) == (1.0, "N")


def test_every_axis_carries_its_unit(capture: kc.Capture, fit: kc.Fit) -> None:
    labels = [axes.get_ylabel() for axes in plot.capture(capture).axes]
    assert [label.split("(")[1] for label in labels] == ["rad)", "rad/s)", "rad/s²)", "mNm)"]
    for figure in (
        plot.fit(fit),
        plot.residual(fit),
        plot.scan(fit),
        plot.zoom(fit),
        plot.comparison(fit.compare()),
    ):
        for axes in figure.axes:
            assert axes.get_xlabel() and axes.get_xlabel().rstrip().endswith((")", "turn", "below"))


def test_a_linear_axis_is_drawn_in_metres_and_newtons(linear: kc.Fit) -> None:
    words = (
        writing(plot.fit(linear))
        + writing(plot.model(linear.model))
        + writing(plot.capture(linear.signals.capture))
    )
    assert "position (m)" in words
    assert "velocity (m/s)" in words
    assert "Force over velocity" in words
    assert "mNm" not in words
    assert "rad" not in words


def test_the_isolated_fit_is_the_models_own_component(fit: kc.Fit) -> None:
    p = {name: estimate.value for name, estimate in fit.params.items()}
    theta, tau = line(panel(plot.position(fit), "Position part isolated"), "Fit")
    np.testing.assert_allclose(
        tau, 1e3 * p["detent.A"] * np.sin(theta / p["detent.P"] + p["detent.S"]), atol=1e-9
    )
    omega, tau = line(panel(plot.velocity(fit), "Velocity part isolated"), "Fit")
    forward = p["coulomb.pos"] + p["viscous.pos"] * omega
    backward = -p["coulomb.neg"] + p["viscous.neg"] * omega
    np.testing.assert_allclose(tau, 1e3 * np.where(omega > 0.0, forward, backward), atol=1e-9)


def test_raw_torque_without_the_rest_scatters_about_the_isolated_fit_like_the_residual(fit: kc.Fit) -> None:
    theta, raw = line(panel(plot.position(fit), "Position part isolated"), "Raw")
    scatter = raw - 1e3 * curve(fit.model, "position", theta)
    assert np.std(scatter) == pytest.approx(1e3 * fit.rmse, rel=0.05)


def test_the_parts_and_the_residual_add_up_to_the_measured_torque(fit: kc.Fit) -> None:
    samples = Samples(fit)
    parts = sum(
        samples.modelled_part(part) for part in ("position", "velocity", "acceleration", "sensor", "other")
    )
    np.testing.assert_allclose(parts, samples.modelled, atol=1e-12)
    np.testing.assert_allclose(
        samples.isolated("position") - samples.modelled_part("position"),
        samples.tau - samples.modelled,
        atol=1e-12,
    )


def test_every_effect_that_is_not_a_function_of_one_coordinate_belongs_to_no_part() -> None:
    assert part_of("an effect that nobody knows") == "other"
    assert set(PARTS) <= set(kc.effects())


def test_the_band_of_friction_is_the_interval_of_its_coulomb_level_at_standstill(fit: kc.Fit) -> None:
    low, high = fit.params["coulomb.pos"].ci95
    band = curve_band(fit, "velocity", np.full(40, 1e-9))
    np.testing.assert_allclose(band, 0.5 * (high - low), rtol=1e-4)


def test_a_zoom_shows_its_window_and_only_what_is_in_it(fit: kc.Fit) -> None:
    axes = panel(plot.position(fit, zoom=(0.1, 0.3), zoom_y=(-12.0, 12.0)), "Torque over position")
    assert axes.get_xlim() == pytest.approx((0.1, 0.3))
    assert axes.get_ylim() == pytest.approx((-12.0, 12.0))
    theta, _ = line(axes, "Raw")
    assert theta.min() >= 0.1
    assert theta.max() <= 0.3


def test_the_automatic_zoom_shows_two_detents_and_the_reversal(fit: kc.Fit) -> None:
    figure = plot.zoom(fit)
    low, high = panel(figure, "Position part").get_xlim()
    assert high - low == pytest.approx(4.0 * np.pi * fit.params["detent.P"].value)
    low, high = panel(figure, "Velocity part").get_xlim()
    assert low == -high


def test_a_part_that_the_model_lacks_is_zoomed_only_on_demand(sticky: kc.Fit) -> None:
    assert len(plot.zoom(sticky).axes) == 1
    assert len(plot.zoom(sticky, position=(-0.01, 0.01)).axes) == 2


@pytest.mark.parametrize("window", [(1.0, 1.0), (2.0, 1.0), (np.nan, 1.0)])
def test_a_window_without_width_is_refused(fit: kc.Fit, window: tuple[float, float]) -> None:
    with pytest.raises(kc.InputError, match=r"zoom=.* is no window"):
        plot.position(fit, zoom=window)


def test_masked_samples_are_marked_where_they_are(capture: kc.Capture) -> None:
    tau = capture.tau.copy()
    tau[10_000:10_500] = np.nan
    tau[20_000] = np.inf
    damaged = kc.Capture.from_arrays(t=capture.t, theta=capture.theta, tau=tau)
    for figure in (plot.capture(damaged), plot.prepared(kc.prepare(damaged))):
        for axes in figure.axes:
            (marks,) = [c for c in axes.collections if str(c.get_label()).startswith("masked")]
            assert marks.get_label() == "masked (501 of 30000 samples)"
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


def test_the_model_picture_names_every_parameter_that_it_draws() -> None:
    words = writing(plot.model(kc.Model.load("knob4")))
    for text in (
        "C₊ = 1.1 mNm",
        "B₋ = 0.48 mNm s/rad",
        "D₊ = 20 mNm",
        "Δv = 0.01 rad/s",
        "A = −11 mNm",
        "S = −0.19 rad",
    ):
        assert text in words
    assert "2πP = 0.478 rad" in words
    assert "inertia.M = 4.9e−05" in words


def test_stiction_lines_stand_at_the_models_karnopp_parameters(sticky: kc.Fit) -> None:
    axes = panel(plot.stiction(sticky), "Friction near standstill")
    dv = sticky.params["karnopp.dv"].value
    positions = sorted(float(np.asarray(a.get_xdata())[0]) for a in axes.lines if "Δv" in str(a.get_label()))
    assert positions == [pytest.approx(dv)]
    labels = [str(a.get_label()) for a in axes.lines]
    assert any(label.startswith("−D₋ = −") for label in labels)
    assert any(label.startswith("D₊ = ") for label in labels)


def test_a_stiction_estimate_comes_with_its_intervals(fit: kc.Fit) -> None:
    def interval(value: float, low: float, high: float) -> SimpleNamespace:
        return SimpleNamespace(value=value, ci95=(low, high))

    estimate = SimpleNamespace(
        dv=interval(0.01, 0.009, 0.011),
        d_neg=interval(0.003, np.nan, np.nan),
        d_pos=interval(0.003, 0.002, 0.004),
    )
    axes = panel(plot.stiction(fit, estimate), "Friction near standstill")
    assert axes.get_xlim() == pytest.approx((-0.05, 0.05))
    assert len(axes.lines) == 4
    assert len(axes.patches) == 3  # +dv, -dv and D_pos; D_neg has no interval


def test_without_known_stiction_the_density_is_drawn_alone(fit: kc.Fit) -> None:
    assert not panel(plot.stiction(fit), "Friction near standstill").lines


def test_the_haptic_profile_colours_torque_over_position_and_velocity(
    fit: kc.Fit, capture: kc.Capture
) -> None:
    axes = panel(plot.haptic_profile(fit), "Measured")
    dots = axes.collections[0]
    low, high = dots.get_clim()
    assert low == -high
    tau = np.asarray(dots.get_array())
    assert np.std(tau) == pytest.approx(1e3 * np.std(Samples(fit).tau), rel=0.05)
    assert "Modelled" not in writing(plot.haptic_profile(capture))


def test_the_comparison_marks_the_failing_regions_and_frames_the_worst_axis(capture: kc.Capture) -> None:
    comparison = kc.fit(capture, detents="no").compare()
    figure = plot.comparison(comparison)
    assert len(figure.axes) == 8
    worst = comparison.worst
    assert worst is not None
    for split in comparison.splits:
        axes = panel(figure, f"{split.axis}:")
        framed = axes.spines["top"].get_visible()
        assert framed == (split is worst)
        assert bool(axes.patches) == split.fails
        if split.fails:
            assert f"{100 * split.share:.0f} %" in axes.get_title(loc="left")


def test_a_complete_model_has_nothing_marked(fit: kc.Fit) -> None:
    comparison = fit.compare()
    assert comparison.complete
    figure = plot.comparison(comparison)
    assert "Chance explains the rest" in writing(figure)
    assert not any(axes.patches for axes in figure.axes[1:])


def test_the_scan_peaks_at_the_chosen_detent_with_its_amplitude(fit: kc.Fit) -> None:
    axes = panel(plot.scan(fit), "Search for detents")
    at, _ = line(axes, "chosen")
    assert at[0] == pytest.approx(1.0 / fit.params["detent.P"].value)
    per_turn, amplitude = np.asarray(axes.lines[0].get_xdata()), np.asarray(axes.lines[0].get_ydata())
    assert per_turn[np.argmax(amplitude)] == pytest.approx(at[0], rel=0.02)
    assert np.max(amplitude) == pytest.approx(1e3 * abs(fit.params["detent.A"].value), rel=0.1)


def test_a_fit_without_scan_says_how_to_get_one(sticky: kc.Fit) -> None:
    with pytest.raises(kc.InputError, match="looked for no detents"):
        plot.scan(sticky)


@pytest.mark.parametrize("effect", list(kc.effects()))
def test_every_effect_has_a_signature_with_values_within_its_bounds(effect: str) -> None:
    entry = kc.effects()[effect]
    for info, value in zip(entry.params, example(entry).values(), strict=True):
        assert info.lower <= value <= info.upper
        assert value != 0.0
    figure = plot.effect(entry)
    assert effect in writing(figure)
    drawn = np.concatenate(
        [np.asarray(a.get_ydata()) for axes in figure.axes for a in axes.lines], dtype=float
    )
    assert np.max(np.abs(drawn)) > 0.0


def test_the_signature_of_viscosity_is_a_straight_line_over_velocity() -> None:
    axes = panel(plot.effect(kc.effects()["viscous"]), "Over velocity")
    omega, tau = line(axes, "moving forward")
    np.testing.assert_allclose(tau, 1e3 * example(kc.effects()["viscous"])["viscous.pos"] * omega, atol=1e-9)


def test_save_all_writes_numbered_pictures_and_returns_their_paths(fit: kc.Fit, tmp_path: Path) -> None:
    paths = plot.save_all(fit, tmp_path / "new" / "folder", fit.compare())
    assert [path.name[:3] for path in paths] == [f"{n:02d}-" for n in range(1, len(paths) + 1)]
    assert all(path.read_bytes().startswith(b"\x89PNG") for path in paths)
    assert {"fit", "comparison", "scan"} <= {path.stem[3:] for path in paths}


def test_a_joint_fit_of_two_captures_is_drawn_whole(capture: kc.Capture) -> None:
    other = kc.simulate(kc.Model.load("knob4"), "hand", duration_s=2.0, seed=1)
    joint = kc.fit([capture, other])
    assert len(Samples(joint).theta) == sum(s.core.used for s in joint.prepared)
    figure = plot.fit(joint)
    assert "and 1 more" in writing(figure)
    assert panel(figure, "Residual").get_xlim()[1] > 7.9


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
