"""The simulator of knobs with hidden effects: laws of its physics; a capture is what it says it is."""

from __future__ import annotations

import hidden
import numpy as np
import pytest
from hidden.bodies import Contact, one_body, two_bodies
from hidden.chain import plain_knob
from hidden.loads import Loads
from hidden.motions import MOTIONS, Track
from hidden.sensors import FLOOR, Sensor, filtered

import knobcam as kc

T = np.arange(10_000) / 5000.0
KNOB = Loads(1e-4, 0.010, 0.012, 1e-3, 1.2e-3, 0.0, 0.1, 0.0)
WITH_DETENTS = KNOB._replace(detent=0.015)


def moved(name: str = "multisine", seed: int = 0) -> Track:
    return MOTIONS[name](np.random.default_rng(seed), T)


def capture(knob: hidden.Hidden) -> kc.Capture:
    columns = {name.split("_")[0]: values for name, values in knob.capture.items()}
    return kc.Capture.from_arrays(**columns)


def rms(values: np.ndarray) -> float:
    return float(np.sqrt(np.mean(values**2)))


@pytest.mark.parametrize("name", MOTIONS)
@pytest.mark.parametrize("seed", range(3))
def test_velocity_and_acceleration_are_the_derivatives_of_position(name: str, seed: int) -> None:
    track = moved(name, seed)
    for value, slope in ((track.theta, track.omega), (track.omega, track.alpha)):
        central = (value[2:] - value[:-2]) / (track.t[2:] - track.t[:-2])
        # The acceleration of a hand has kinks where one submovement begins.
        assert rms(central - slope[1:-1]) < 1e-3 * rms(slope)


@pytest.mark.parametrize("motion", MOTIONS)
def test_a_faultless_knob_is_explained_down_to_the_noise(motion: str) -> None:
    for seed in range(5):
        knob = hidden.make(seed, motion=motion)
        fit = kc.fit(capture(knob))
        assert fit.rmse / knob.noise_floor == pytest.approx(1.0, abs=0.01)
        assert fit.noise_floor / knob.noise_floor == pytest.approx(1.0, abs=0.05)


@pytest.mark.parametrize(
    "effect", ["stribeck", "load_friction", "end_stop", "friction_drift", "backlash", "mains_hum", "surge"]
)
def test_the_strength_is_what_the_base_model_leaves(effect: str) -> None:
    knob = hidden.make(3, [effect], strength=3.0)
    assert knob.strength == pytest.approx(3.0, rel=0.03)
    fit = kc.fit(capture(knob), detents="yes" if knob.knob["detent.A"] > 0.0 else "no")
    left = np.sqrt(fit.rmse**2 - knob.noise_floor**2) / knob.noise_floor
    assert left == pytest.approx(knob.strength, rel=0.2)


@pytest.mark.parametrize("effect", hidden.KINDS)
def test_every_kind_can_be_hidden_and_makes_a_difference(effect: str) -> None:
    knob = hidden.make(11, [effect], strength=1.5, duration_s=2.0)
    assert knob.effects == (effect,)
    assert knob.strength == pytest.approx(1.5, rel=0.05)
    assert all(np.isfinite(column).all() for column in knob.capture.values())


def test_the_same_seed_gives_the_same_capture_and_another_another() -> None:
    tau = [hidden.make(seed, ["stribeck"]).capture["tau_Nm"] for seed in (5, 5, 6)]
    assert np.array_equal(tau[0], tau[1])
    assert not np.array_equal(tau[0], tau[2])


def test_of_two_effects_each_leaves_something_that_the_other_does_not_explain() -> None:
    for seed in range(4):
        knob = hidden.make(seed, ["position_friction", "stribeck"])
        assert min(knob.strengths) >= 0.7


@pytest.mark.parametrize("name", MOTIONS)
def test_friction_only_takes_energy(name: str) -> None:
    still = KNOB._replace(inertia=0.0)
    rough = still._replace(rough=np.array([[3.0, 0.9, 0.0], [7.0, 0.8, 1.0]]), rise=1.5, warm=-0.7, mu=0.5)
    track = moved(name)
    assert np.all(one_body(track, rough) * track.omega >= 0.0)


def test_a_stop_pushes_back_and_never_holds() -> None:
    bare = Loads(0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.1, 0.0)
    stops = np.array([[1.0, 0.3, 0.5, 1.0, 0.05], [-1.0, -0.2, 0.5, 0.0, 0.05]])
    track = moved()
    torque = one_body(track, bare._replace(stops=stops))
    assert np.all(torque[track.theta > 0.3] >= 0.0)
    assert np.all(torque[track.theta < -0.2] <= 0.0)
    assert np.all(torque[(track.theta <= 0.3) & (track.theta >= -0.2)] == 0.0)


def test_slip_elements_reach_coulombs_level_when_all_of_them_slip() -> None:
    weights, distances = np.full(10, 0.1), np.geomspace(1e-3, 2e-2, 10)
    sliding = KNOB._replace(weights=weights, distances=distances)
    t = np.arange(2000) / 5000.0
    track = Track(t, t, np.ones_like(t), np.zeros_like(t))
    built, at_once = one_body(track, sliding), one_body(track, KNOB)
    assert np.all(np.diff(built) >= 0.0)
    assert built[0] < 0.2 * at_once[0]
    assert built[-1] == pytest.approx(at_once[-1], rel=1e-12)


@pytest.mark.parametrize("name", MOTIONS)
@pytest.mark.parametrize("gap", [0.0, 1e-9])
def test_two_bodies_in_stiff_contact_are_one(name: str, gap: float) -> None:
    track = moved(name)
    stiffness = KNOB.inertia * (2.0 * np.pi * 2000.0) ** 2
    contact = Contact(gap, stiffness, 2.0 * np.sqrt(stiffness * KNOB.inertia), 0.6)
    two = two_bodies(track, WITH_DETENTS, contact, substeps=80)
    assert rms(filtered(two - one_body(track, WITH_DETENTS))[200:-200]) < 0.3 * FLOOR


def test_within_its_play_the_shaft_moves_nothing_but_itself() -> None:
    track = moved()
    slow = Track(track.t, track.theta, track.omega, track.alpha)
    torque = two_bodies(slow, KNOB, Contact(10.0, 50.0, 0.01, 0.7))
    assert torque == pytest.approx(0.3 * KNOB.inertia * track.alpha, rel=1e-12)


@pytest.mark.parametrize("gap", [0.0, 0.01])
def test_the_hidden_knob_is_simulated_finely_enough(gap: float) -> None:
    contact = Contact(gap, 30.0, 0.02, 0.7)
    usual, fine = (two_bodies(moved(), WITH_DETENTS, contact, substeps) for substeps in (40, 160))
    assert rms(filtered(usual - fine)) < 0.05 * FLOOR


def test_a_delay_of_one_sample_shows_the_torque_of_the_sample_before() -> None:
    tau = one_body(moved(), WITH_DETENTS)
    late = Sensor(delay_s=T[1]).late(T, tau)
    np.testing.assert_allclose(late[1:], tau[:-1], atol=1e-9)


def test_a_saturated_channel_shows_its_limit_and_nothing_beyond() -> None:
    knob = hidden.make(2, ["saturation"])
    tau = np.abs(knob.capture["tau_Nm"])
    assert np.sum(tau == tau.max()) > 20


def test_random_knobs_have_the_size_of_those_that_the_paper_measured() -> None:
    knobs = [plain_knob(np.random.default_rng(seed), True) for seed in range(200)]
    assert 2e-3 < np.median([knob.coulomb_pos for knob in knobs]) < 2e-2
    assert all(3e-5 <= knob.inertia <= 2.2e-4 and knob.period >= 0.03 for knob in knobs)
