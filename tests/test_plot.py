"""Pictures show what they say: values, units, regions."""

from __future__ import annotations

import io
import re
from pathlib import Path
from typing import Any

import matplotlib as mpl
import numpy as np
import pytest
from matplotlib.axes import Axes
from matplotlib.figure import Figure

import knobcam as kc
from knobcam import plot
from knobcam.model.typical import typical, with_typical
from knobcam.show.plot.components import Samples, curve, curve_band, part_of
from knobcam.show.words import axis_tick

SLED_NOISE = kc.SensorNoise(tau_sd=0.5, omega_sd=1e-4, alpha_sd=1e-3)


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


def test_an_effect_belongs_to_the_part_of_the_one_coordinate_that_it_follows() -> None:
    parts = {name: part_of(effect) for name, effect in kc.effects().items()}
    assert (parts["detent"], parts["unbalance"]) == ("position", "position")
    assert (parts["coulomb"], parts["stribeck"]) == ("velocity", "velocity")
    assert (parts["inertia"], parts["offset"]) == ("acceleration", "sensor")
    assert (parts["position_friction"], parts["backlash"]) == ("other", "other")


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


def test_the_density_near_standstill_holds_the_samples_that_stick() -> None:
    pushed = kc.fit(kc.simulate(kc.Model.load("knob3"), "push"))
    (density,) = panel(plot.stiction(pushed), "Friction near standstill").collections
    drawn = np.nansum(np.asarray(density.get_array(), dtype=float))
    reach = 0.05 * np.max(np.abs(pushed.signals.omega))
    assert drawn == np.sum(np.abs(pushed.signals.omega) <= reach)
    assert drawn > 2.0 * np.sum(np.abs(pushed.signals.omega[pushed.signals.used]) <= reach)


def test_a_stiction_estimate_comes_with_its_intervals_and_without_what_it_does_not_know(fit: kc.Fit) -> None:
    dv = kc.Estimate(0.01, (0.009, 0.011), "rad/s", 0.0005)
    d_pos = kc.Estimate(0.003, (0.002, 0.004), "N m", 0.0005)
    axes = panel(plot.stiction(fit, kc.Stiction(fit, None, d_pos, dv, (0, 5))), "Friction near standstill")
    assert axes.get_xlim() == pytest.approx((-0.05, 0.05))
    assert len(axes.lines) == 3  # +dv, -dv and D_pos
    assert [patch.get_height() for patch in axes.patches][-1] == pytest.approx(2.0)
    assert len(axes.patches) == 3


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
        axes = panel(figure, f"{axis_tick(split.axis)}:")
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
    assert per_turn[np.argmax(amplitude)] == pytest.approx(at[0], abs=np.diff(per_turn).max())
    assert np.max(amplitude) == pytest.approx(1e3 * abs(fit.params["detent.A"].value), rel=0.1)


def test_a_fit_without_scan_says_how_to_get_one(sticky: kc.Fit) -> None:
    with pytest.raises(kc.InputError, match="looked for no detents"):
        plot.scan(sticky)


@pytest.mark.parametrize("effect", list(kc.effects()))
def test_every_effect_has_a_signature_with_values_within_its_bounds(effect: str) -> None:
    entry = kc.effects()[effect]
    for info, value in zip(entry.params, typical(entry).values(), strict=True):
        assert info.lower <= value <= info.upper
    # An order that a ripple does not use is nought, and its wave with it.
    shown = kc.Model.of([effect, *filter(None, [entry.needs])]).core
    used = {name for name, *_ in with_typical(kc.Model(shown), entry).core.rows()}
    assert all(value != 0.0 for name, value in typical(entry).items() if name in used)
    figure = plot.effect(entry)
    words = writing(figure).replace("\n", " ")
    assert entry.title in words and not re.search(r" = 0(?![.\d])", words)
    drawn = np.concatenate(
        [np.asarray(a.get_ydata()) for axes in figure.axes for a in axes.lines], dtype=float
    )
    assert np.max(np.abs(drawn)) > 0.0


def test_the_signature_of_viscosity_is_a_straight_line_over_velocity() -> None:
    axes = panel(plot.effect(kc.effects()["viscous"]), "100 % follows velocity")
    omega, tau = line(axes, "moving forward")
    np.testing.assert_allclose(tau, 1e3 * typical(kc.effects()["viscous"])["viscous.pos"] * omega, atol=1e-9)


def test_save_all_writes_numbered_pictures_and_returns_their_paths(
    fit: kc.Fit, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    paths = plot.save_all(fit, tmp_path / "new" / "folder", fit.compare())
    assert [path.name[:3] for path in paths] == [f"{n:02d}-" for n in range(1, len(paths) + 1)]
    assert all(path.read_bytes().startswith(b"\x89PNG") for path in paths)
    assert {"fit", "comparison", "scan"} <= {path.stem[3:] for path in paths}
    # Of the other kind one is painted, which takes seconds, and the others are its copies.
    paint, painted = Figure.savefig, io.BytesIO()

    def copied(figure: Figure, file: Any, **how: Any) -> None:
        if not painted.getvalue():
            paint(figure, painted, **how)
        file.write(painted.getvalue())

    monkeypatch.setattr(Figure, "savefig", copied)
    drawn = plot.save_all(fit, tmp_path / "drawn", kind="svg")
    assert all(path.suffix == ".svg" and path.read_bytes().startswith(b"<?xml") for path in drawn)


def test_a_joint_fit_of_two_captures_is_drawn_whole(capture: kc.Capture) -> None:
    other = kc.simulate(kc.Model.load("knob4"), "hand", duration_s=2.0, seed=1)
    joint = kc.fit([capture, other])
    assert len(Samples(joint).theta) == sum(s.core.used for s in joint.prepared)
    figure = plot.fit(joint)
    assert "and 1 more" in writing(figure)
    assert panel(figure, "Residual").get_xlim()[1] > 7.9
