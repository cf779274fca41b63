"""Fits of real measurements and practice captures; where a file is absent, its tests skip and say so."""

from __future__ import annotations

import json
from functools import cache
from typing import Any

import numpy as np
import pytest
from measurements import SHARED, real
from scipy.stats import binom  # type: ignore[import-untyped]

import knobcam as kc

PRACTICE = SHARED.parent / "practice"
EMPS = SHARED / "emps" / "DATA_EMPS.mat"
ODRIVE = SHARED / "odrive_cogging" / "slow2_slower_nocomp_0.npy"
# As its authors prepare the axis (Janot, Gautier & Brunot 2019).
AS_PUBLISHED: dict[str, Any] = {"prepare": "differences", "cutoff_hz": 100.0, "decimate": 10.0}


@cache
def emps() -> kc.Capture:
    return kc.load(real(EMPS), map="t=t, theta=qm, tau=35.1507*vir", coordinate="linear")


@cache
def odrive() -> kc.Capture:
    return kc.load(real(ODRIVE), map="t=c0, theta=c1/8192 [turn], tau=0.0551*c2", start=1.0)


@cache
def answers() -> dict[str, Any]:
    document: dict[str, Any] = json.loads(real(PRACTICE / "answers.json").read_text("utf-8"))
    return document


def complete() -> list[str]:
    """The practice captures of knobs with nothing missing."""
    return [name for name, answer in answers().items() if not answer["effects"]]


@cache
def practice(name: str) -> kc.Fit:
    return kc.fit(kc.load(real(PRACTICE / name)))


def relative_error(fit: kc.Fit) -> float:
    tau = fit.signals.tau[fit.signals.used]
    return fit.rmse / float(np.sqrt(np.mean(tau**2)))


def test_emps_with_one_friction_and_offset_gives_the_published_parameters() -> None:
    model = kc.Model.of(["inertia", "coulomb", "viscous", "offset"], "linear")
    tied = model.with_tie("coulomb.neg", "coulomb.pos").with_tie("viscous.neg", "viscous.pos")
    fit = kc.fit(emps(), tied, **AS_PUBLISHED)
    published = {
        "inertia.M": 95.1089,
        "viscous.pos": 203.5034,
        "coulomb.pos": 20.3935,
        "offset.tau0": -3.1648,
    }
    assert {name: fit.params[name].value for name in published} == pytest.approx(published, rel=1e-3)
    assert fit.params["coulomb.neg"].value == fit.params["coulomb.pos"].value
    assert relative_error(fit) == pytest.approx(0.04083, rel=1e-3)


def test_emps_with_friction_per_direction_gives_the_published_asymmetry() -> None:
    fit = kc.fit(emps(), detents="no", **AS_PUBLISHED)
    published = {"viscous.pos": 166.71, "viscous.neg": 240.42, "coulomb.pos": 20.14, "coulomb.neg": 20.63}
    assert {name: fit.params[name].value for name in published} == pytest.approx(published, rel=1e-2)
    assert relative_error(fit) == pytest.approx(0.0311, rel=1e-2)


def test_emps_prepared_by_the_smoother_agrees_with_the_published_preparation() -> None:
    fit, published = kc.fit(emps(), detents="no"), kc.fit(emps(), detents="no", **AS_PUBLISHED)
    for name, estimate in fit.params.items():
        assert estimate.ci95[0] < published.params[name].value < estimate.ci95[1], name
    assert any("of 500 Hz" in note and "lowered to 100 Hz" in note for note in fit.signals.notes)


def test_the_force_of_emps_makes_its_motion_as_its_benchmark_scores_it() -> None:
    """Open loop over all of it, from force to position."""
    fit = kc.fit(emps(), detents="no")
    forward = fit.forward()
    assert forward.r2 > 0.998 and forward.rmse < 3.5e-3
    assert fit.forward(horizon_s=1.0).rmse < 0.3 * forward.rmse


def test_emps_fitted_to_one_half_makes_the_motion_of_the_other() -> None:
    halves = [
        kc.load(real(EMPS), map="t=t, theta=qm, tau=35.1507*vir", coordinate="linear", **part)
        for part in ({"end": 12.4}, {"start": 12.4})
    ]
    fit = kc.fit(halves[0], detents="no")
    held = fit.compare(halves[1])
    assert held.held_out and held.figures.relative < 0.04
    assert fit.forward(halves[1]).r2 > 0.98


def test_the_base_model_without_detents_explains_almost_nothing_of_the_motor_and_position_is_why() -> None:
    comparison = kc.fit(odrive(), detents="no").compare()
    explained = 1.0 - (comparison.fit.rmse / comparison.torque_rms) ** 2
    assert explained < 0.2
    assert comparison.worst is not None and comparison.worst.axis == "position"
    assert comparison["position"].share > 0.5
    assert not comparison.complete


def test_the_scan_finds_the_seven_pole_pairs_of_the_motor() -> None:
    fit = kc.fit(odrive(), detents="yes")
    assert 1.0 / fit.params["detent.P"].value == pytest.approx(7.0, abs=0.1)
    inverse_period, gain = fit.core.scan or (np.zeros(0), np.zeros(0))
    assert inverse_period[np.argmax(gain)] == pytest.approx(7.0, abs=0.25)


@pytest.mark.parametrize("number", range(26))
def test_every_practice_capture_is_fitted_without_help(number: int) -> None:
    fit = practice(f"knob-{number:02d}.csv.gz")
    assert np.isfinite([fit.rmse, fit.rmse_heldout, fit.noise_floor]).all()
    assert fit.core.status in ("linear", "converged")
    assert all(np.isfinite(estimate.value) for estimate in fit.params.values())


def test_a_fit_of_a_knob_with_nothing_missing_ends_at_the_noise_floor() -> None:
    for name in complete():
        above = practice(name).rmse / answers()[name]["noise_floor_Nm"]
        assert 0.98 < above < (1.03 if answers()[name]["motion"] == "hand" else 1.02), name


def test_detents_are_found_where_they_are_and_only_there() -> None:
    for name in complete():
        there = answers()[name]["knob"]["detent.A"] != 0.0
        assert ("detent" in practice(name).model.effects) == there, name


def test_base_parameters_lie_in_their_intervals_as_often_as_95_percent_promises() -> None:
    missed = total = 0
    for name in complete():
        truth = answers()[name]["knob"]
        for parameter, estimate in practice(name).params.items():
            total += 1
            missed += not estimate.ci95[0] <= truth[parameter] <= estimate.ci95[1]
    assert total >= 20
    assert missed <= binom.ppf(0.999, total, 0.05), f"{missed} of {total} intervals miss the truth"
