"""Friction that grows with every load, as in gears: pendulums that this file simulates, and a real servo."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from measurements import SHARED, real

import knobcam as kc


def pendulum(mu: float, share: float, seed: int) -> kc.Capture:
    """A pendulum of 5e-3 kg m^2 and 0.25 N m in a gear, swung by five sines for 8 s at 1 kHz."""
    rng = np.random.default_rng(seed)
    t = np.arange(8000) / 1000.0
    theta, omega, alpha = np.zeros((3, t.size))
    for hz in rng.uniform(0.2, 2.5, 5):
        size, phase, w = rng.uniform(0.2, 0.9) / hz**0.8, rng.uniform(0.0, 6.28), 2.0 * np.pi * hz
        theta += size * np.sin(w * t + phase)
        omega += size * w * np.cos(w * t + phase)
        alpha -= size * w**2 * np.sin(w * t + phase)
    gravity = 0.25 * np.sin(theta + 0.2)
    friction = 0.02 + mu * np.abs(gravity + share * 5e-3 * alpha)
    tau = 5e-3 * alpha + gravity + 4e-3 * omega + friction * np.sign(omega)
    columns = zip((theta, tau, omega, alpha), (1e-5, 4e-3, 2e-3, 0.3), strict=True)
    theta, tau, omega, alpha = (column + noise * rng.normal(size=t.size) for column, noise in columns)
    return kc.Capture.from_arrays(theta=theta, tau=tau, t=t, omega=omega, alpha=alpha)


@pytest.mark.parametrize(("mu", "share"), [(0.1, 1.0), (0.3, 0.5), (0.2, 0.0)])
def test_a_pendulum_in_a_gear_is_told_by_its_gravity_and_then_its_gear(mu: float, share: float) -> None:
    story = kc.learn(pendulum(mu, share, seed=2))
    assert story.found == ("unbalance", "load_friction")
    fitted = story.fit.params
    for name, truth in (("mu", mu), ("s_alpha", share), ("s_theta", 1.0)):
        estimate = fitted[f"load_friction.{name}"]
        assert abs(estimate.value - truth) < 0.03, name
    low, high = fitted["load_friction.mu"].ci95
    assert low <= mu <= high


@pytest.mark.parametrize("seed", [3, 4])
def test_a_pendulum_without_a_gear_is_not_accused_of_one(seed: int) -> None:
    assert kc.learn(pendulum(0.0, 1.0, seed)).found == ("unbalance",)


def test_what_else_presses_is_weighed_against_the_detents_where_both_are_there(tmp_path: Path) -> None:
    older = tmp_path / "older.toml"
    older.write_text(
        'schema = "knobcam.model/1"\naxis = "rotary"\n[effects.inertia]\nM = 1e-4\n'
        "[effects.detent]\nA = 0.02\nP = 0.1\nS = 0.0\n[effects.load_friction]\nmu = 0.3\n"
    )
    model = kc.Model.load(older)
    shares = ("load_friction.s_theta", "load_friction.s_alpha")
    assert [model.params[name].value for name in shares] == [1.0, 1.0]
    assert [model.params[name].role for name in shares] == ["fixed", "free"]
    both = model.with_effect("unbalance")
    assert both.params["load_friction.s_theta"].role == "free"


def test_a_servo_with_a_pendulum_rubs_by_gravity_and_inertia() -> None:
    servo = real(SHARED / "bam_xl330" / "2026-01-15_10h29m04.json")
    capture = kc.load(servo, map="t=timestamp, theta=position, tau=0.085*duty*input_volts")
    weighed = kc.fit(capture, detents="no").add("unbalance")
    geared = weighed.add("load_friction")
    assert geared.rmse < 0.85 * weighed.rmse and geared.rmse_heldout < 0.85 * weighed.rmse_heldout
    low, high = geared.params["load_friction.mu"].ci95
    assert 0.1 < low < high < 0.6
