"""What a comparison says first, and whether it is of captures that the model was fitted to."""

from __future__ import annotations

import dataclasses
import json
from pathlib import Path

import numpy as np
import pytest

import knobcam as kc
from knobcam.fit.compare import Figures, in_floors


@pytest.fixture(scope="module")
def other() -> kc.Capture:
    return kc.simulate(kc.Model.load("knob4"), "multisine", seed=7)


def test_error_variance_and_relative_error_stand_first_and_the_floor_beside_them(fit: kc.Fit) -> None:
    comparison = fit.compare()
    figures = comparison.figures
    tau = fit.signals.tau[fit.signals.used]
    assert figures.rmse == pytest.approx(fit.rmse)
    assert figures.relative == pytest.approx(fit.rmse / np.sqrt(np.mean(tau**2)))
    assert figures.explained == pytest.approx(1.0 - fit.rmse**2 / np.var(tau))
    first = repr(comparison).splitlines()[0]
    head = (
        f"RMS error {fit.rmse:.4g} N m, {100.0 * figures.explained:.1f} % of the variance explained, relative"
    )
    assert first.startswith(head) and f"the noise floor of {fit.noise_floor:.4g} N m" in first
    names = list(comparison.document())
    assert names[:6] == ["schema", "rmse", "explained", "relative_error", "noise_floor", "unit"]
    json.dumps(comparison.document())


def test_of_an_error_far_above_the_noise_it_is_said_that_hardly_any_of_it_is_chance() -> None:
    model = kc.Model.of(["inertia", "coulomb"], inertia__M=1e-4, coulomb__pos=0.02, coulomb__neg=0.02)
    quiet = kc.SensorNoise(tau_sd=1e-6)
    capture = kc.simulate(model, "sweep", noise=quiet, duration_s=3.0, rate_hz=1000.0)
    comparison = kc.fit(capture, kc.Model.of(["inertia"], inertia__M=1e-4)).compare()
    fit = comparison.fit
    assert fit.rmse > 10.0 * fit.noise_floor > 0.0
    left = f"; noise alone would leave {fit.noise_floor:.4g} N m, so hardly any of it is chance."
    assert left in comparison.summary and "times" not in comparison.summary
    assert (in_floors(9.994), in_floors(14.6)) == ("9.99", "15")


def test_a_comparison_of_a_linear_axis_is_in_newtons() -> None:
    model = kc.Model.of(["inertia", "coulomb"], "linear", inertia__M=2.0, coulomb__pos=5.0, coulomb__neg=5.0)
    noise = kc.SensorNoise(tau_sd=0.1)
    comparison = kc.fit(kc.simulate(model, "sweep", noise=noise), model).compare()
    assert comparison.document()["unit"] == "N"
    assert " N," in comparison.summary and "N m" not in comparison.summary


def test_each_of_several_captures_has_its_own_figures(capture: kc.Capture, other: kc.Capture) -> None:
    comparison = kc.fit([capture, other]).compare()
    squares = [figures.rmse**2 for figures in comparison.by_capture]
    counts = [signals.core.used for signals in comparison.fit.prepared]
    assert comparison.figures.rmse**2 == pytest.approx(np.average(squares, weights=counts))
    said = comparison.document()["captures"]
    assert [one["rmse"] for one in said] == [figures.rmse for figures in comparison.by_capture]
    assert repr(comparison).count(" N m") > repr(comparison.summary).count(" N m")
    assert [len(table.rows) for table in comparison.tables()] == [7, 2]


def test_a_model_held_against_another_recording_says_that_it_was_not_fitted_to_it(
    fit: kc.Fit, other: kc.Capture
) -> None:
    own, held = fit.compare(), fit.compare(other)
    assert (own.held_out, own.origin) == (False, "")
    assert held.held_out is True
    assert held.fit.model.params["inertia.M"].value == fit.model.params["inertia.M"].value
    lines = repr(held).splitlines()
    assert lines[0].startswith("RMS error ")
    assert lines[1].startswith("The model was not fitted to this capture: it was fitted to simulated knob 4")
    assert held.document()["captures"][0]["fitted_to_it"] is False
    assert held.tables()[0].caption.endswith(held.origin)


def test_a_model_file_keeps_what_it_was_fitted_to(fit: kc.Fit, other: kc.Capture, tmp_path: Path) -> None:
    model = kc.Model.load(fit.model.save(tmp_path / "m.toml"))
    assert model == fit.model and len(model.fitted_to) == 1
    again = kc.load(fit.signals.capture.save(tmp_path / "other-name.csv"))
    both = kc.fit([again, other], model.frozen()).compare()
    assert [one["fitted_to_it"] for one in both.document()["captures"]] == [True, False]
    assert both.held_out is False and "not fitted to simulated knob 4:" in both.origin
    refitted = kc.fit(other, model).compare()
    assert (refitted.held_out, refitted.origin) == (False, "")


def test_a_model_that_does_not_say_what_it_was_fitted_to_leaves_that_open(
    fit: kc.Fit, capture: kc.Capture
) -> None:
    for model in (kc.Model.load("knob4"), fit.model.with_value("detent.A", 0.01)):
        assert model.fitted_to == ()
        comparison = kc.fit(capture, model.frozen()).compare()
        assert comparison.held_out is None and "does not say" in repr(comparison)


def test_a_part_of_what_a_model_was_fitted_to_counts_as_another_capture(fit: kc.Fit) -> None:
    whole = fit.signals.capture
    columns = {name: values[:4_000] for name, values in whole.columns.items()}
    assert fit.compare(kc.Capture.from_arrays(**columns)).held_out is True


def test_masked_samples_are_in_no_figure(capture: kc.Capture) -> None:
    mask = capture.mask.copy()
    mask[5_000:5_002] = False
    comparison = kc.fit(dataclasses.replace(capture, mask=mask)).compare()
    assert comparison.by_capture[0] == comparison.figures
    assert comparison.figures.rmse == pytest.approx(comparison.fit.rmse)


def test_what_a_model_nearly_explains_is_not_said_to_be_all() -> None:
    assert str(Figures(0.005, 0.99956, 0.021).in_percent) == "more than 99.9 %"
    assert str(Figures(0.005, 0.9994, 0.021).in_percent) == "99.9 %"
    assert str(Figures(1e-12, 1.0, 1e-11).in_percent) == "100.0 %"
