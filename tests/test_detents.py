"""Detents are found where they are, and nowhere else."""

import numpy as np
import pytest

import knobcam as kc

BASE = {
    "inertia__M": 1e-4,
    "coulomb__neg": 0.01,
    "coulomb__pos": 0.012,
    "viscous__neg": 5e-4,
    "viscous__pos": 4e-4,
}
MOTIONS = ["sweep", "multisine", "turns", "hand"]


def knob(*more, **values):
    return kc.Model.of(["inertia", "coulomb", "viscous", *more], **BASE, **values)


@pytest.mark.parametrize("motion", MOTIONS)
@pytest.mark.parametrize("period", [0.031, 0.09, 0.3])
def test_detents_are_found_with_their_period(motion, period):
    fit = kc.fit(
        kc.simulate(knob("detent", detent__A=0.004, detent__P=period, detent__S=0.7), motion, seed=5)
    )
    assert fit.params["detent.P"].value == pytest.approx(period, rel=0.01)


@pytest.mark.parametrize("motion", MOTIONS)
@pytest.mark.parametrize("seed", range(3))
def test_a_smooth_knob_has_no_detents(motion, seed):
    assert "detent" not in kc.fit(kc.simulate(knob(), motion, seed=seed)).model.effects


@pytest.mark.parametrize("motion", MOTIONS)
@pytest.mark.parametrize("stiffness", [0.0005, 0.005, 0.05])
def test_a_spring_is_not_taken_for_detents(motion, stiffness):
    spring = knob("return_spring", return_spring__k=stiffness, return_spring__theta0=0.2)
    assert "detent" not in kc.fit(kc.simulate(spring, motion, seed=3)).model.effects


@pytest.mark.parametrize("motion", MOTIONS)
def test_what_comes_once_a_turn_is_not_taken_for_detents(motion):
    eccentric = knob("detent", detent__A=0.01, detent__P=1.0, detent__S=0.4)
    assert "detent" not in kc.fit(kc.simulate(eccentric, motion, seed=4)).model.effects


def test_a_user_who_asks_for_detents_gets_their_best_period():
    fit = kc.fit(kc.simulate(knob(), "sweep"), detents="yes")
    assert "detent" in fit.model.effects
    assert np.isfinite(fit.params["detent.P"].value)


def test_noise_on_a_linear_axis_is_not_taken_for_detents():
    sled = kc.Model.of(
        ["inertia", "coulomb", "viscous"],
        "linear",
        inertia__M=2.0,
        coulomb__neg=3.0,
        coulomb__pos=3.5,
        viscous__neg=8.0,
        viscous__pos=6.0,
    )
    sensors = kc.SensorNoise(omega_sd=1e-3, alpha_sd=0.05, tau_sd=0.5, theta_step=1e-6, tau_step=0.01)
    for seed in range(6):
        track = kc.motion("multisine", duration_s=5.0, rate_hz=1000.0, amplitude=0.1, seed=seed)
        assert "detent" not in kc.fit(kc.simulate(sled, track, noise=sensors, seed=seed)).model.effects
