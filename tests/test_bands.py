"""Bands in which the recorded motion is none of the torque's, on logs that this file simulates itself."""

from __future__ import annotations

from functools import cache

import numpy as np
import pytest

import knobcam as kc
from knobcam.capture.finding import Finding

INERTIA, GRAVITY = 0.1, 2.0
RNG = np.random.default_rng(5)


def bands(capture: kc.Capture) -> list[Finding]:
    return [finding for finding in capture.prepare().findings if finding.kind == "band"]


def bursts(t: np.ndarray, hz: float) -> np.ndarray:
    """A ring of amplitude one that comes and goes."""
    loud = np.maximum(np.sin(2.0 * np.pi * 0.6 * t + 0.5) + 0.6 * np.sin(2.0 * np.pi * 1.7 * t), 0.0)
    return loud * np.sin(2.0 * np.pi * hz * t + 3.0 * np.sin(2.0 * np.pi * 1.1 * t))


@cache
def pendulum(shakes: float = 0.0) -> kc.Capture:
    """A pendulum that is swung slowly by a drive that chatters; its encoder shakes in bursts (rad)."""
    rate_hz = 300.0
    t = np.arange(0.0, 15.0, 1.0 / rate_hz)
    theta, omega, alpha = np.zeros((3, len(t)))
    for amplitude, hz, phase in ((1.2, 0.31, 0.2), (0.5, 0.83, 1.1), (0.12, 1.9, 0.4)):
        w = 2.0 * np.pi * hz
        theta += amplitude * np.sin(w * t + phase)
        omega += amplitude * w * np.cos(w * t + phase)
        alpha -= amplitude * w**2 * np.sin(w * t + phase)
    tau = INERTIA * alpha + GRAVITY * np.sin(theta) + 0.02 * omega + 0.05 * np.sign(omega)
    tau += 0.05 * RNG.normal(size=len(t)) + 0.2 * bursts(t, 34.0)
    shaken = theta + shakes * bursts(t, 22.0) + 1e-4 * RNG.normal(size=len(t))
    speed = omega + shakes * np.gradient(bursts(t, 22.0), t) + 0.02 * RNG.normal(size=len(t))
    return kc.Capture.from_arrays(t=t, theta=shaken, omega=speed, tau=tau)


@cache
def sprung() -> kc.Capture:
    """A knob that resonates at 64 Hz behind a spring, turned with all that a hand does not hold back."""
    rate_hz, fine = 1000.0, 40
    h = 1.0 / rate_hz / fine
    t = np.arange(0.0, 8.0, h)
    turned, speed = np.zeros((2, len(t)))
    for k in range(12):
        hz, phase = 0.7 * 1.55**k, 2.4 * k
        amplitude = 0.8 / (1.0 + hz**1.7)
        turned += amplitude * np.sin(2.0 * np.pi * hz * t + phase)
        speed += amplitude * 2.0 * np.pi * hz * np.cos(2.0 * np.pi * hz * t + phase)
    inertia, stiffness, damping = 1e-4, 16.0, 4e-3
    position, velocity = float(turned[0]), float(speed[0])
    torque = np.zeros(len(t))
    for i, (theta, omega) in enumerate(zip(turned.tolist(), speed.tolist(), strict=True)):
        torque[i] = stiffness * (theta - position) + damping * (omega - velocity)
        friction = 0.01 * np.tanh(velocity / 1e-3) + 1e-3 * velocity
        velocity += h * (torque[i] - friction) / inertia
        position += h * velocity
    noise = RNG.normal(size=(2, len(t[::fine])))
    theta = turned[::fine] + 1e-5 * noise[0]
    return kc.Capture.from_arrays(t=t[::fine], theta=theta, tau=torque[::fine] + 2e-3 * noise[1])


@cache
def late() -> kc.Capture:
    """A motor whose rows were sampled up to half an interval from their stamps, sixty times a second."""
    t = np.arange(0.0, 20.0, 1e-3)
    sampled = t + 0.5e-3 * (np.mod(60.6 * t, 1.0) - 0.5)
    omega = 120.0 * np.sin(2.0 * np.pi * 0.9 * t) + 20.0 * np.sin(2.0 * np.pi * 2.3 * t)
    alpha = np.gradient(omega, 1e-3)
    theta = np.interp(sampled, t, np.cumsum(omega) * 1e-3) + 1e-3 * RNG.normal(size=len(t))
    tau = 2e-4 * alpha + 0.08 * np.sign(omega) + 2e-4 * omega + 0.01 * RNG.normal(size=len(t))
    return kc.Capture.from_arrays(t=t, theta=theta, tau=tau)


def test_a_shaking_encoder_costs_a_pendulum_neither_its_inertia_nor_its_gravity() -> None:
    capture = pendulum(1e-2)
    (finding,) = bands(capture)
    assert finding.severity == "mended"
    assert "the torque has nothing to do with the recorded motion" in finding.message
    story = kc.learn(capture)
    assert story.found == ("unbalance",)
    assert story.fit.params["inertia.M"].value == pytest.approx(INERTIA, rel=0.05)
    assert story.fit.params["unbalance.a"].value == pytest.approx(GRAVITY, rel=0.05)


def test_what_was_left_out_is_in_the_way_of_an_all_clear() -> None:
    story = kc.learn(pendulum(1e-2))
    assert story.verdict == "unexplained"
    assert "Not weighed: what is faster than" in story.headline
    assert [one["kind"] for one in story.document()["findings"]].count("band") == 1
    reason = "errors of the recorded motion look like it"
    left_out = story.last.left_out
    assert left_out["compliance"] == left_out["torque_lag"] == reason


def test_an_edge_that_is_given_leaves_the_motion_as_it_was_recorded() -> None:
    capture = pendulum(1e-2)
    given = capture.prepare(torque_edge_hz=30.0)
    assert given.core.incoherent is None
    lost = kc.fit(capture, torque_edge_hz=30.0).params["inertia.M"].value
    assert lost < 0.5 * INERTIA


def test_the_same_pendulum_with_a_good_encoder_has_no_such_band() -> None:
    assert bands(pendulum()) == []


def test_rows_that_were_sampled_beside_their_stamps_cost_no_inertia() -> None:
    assert len(bands(late())) == 1
    fit = kc.fit(late())
    assert fit.params["inertia.M"].value == pytest.approx(2e-4, rel=0.01)
    assert kc.fit(late(), torque_edge_hz=100.0).params["inertia.M"].value < 1.8e-4


def test_a_knob_behind_a_spring_is_no_error_of_the_motion() -> None:
    assert bands(sprung()) == []
    assert kc.learn(sprung()).found == ("compliance",)
