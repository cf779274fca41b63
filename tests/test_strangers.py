"""The strangers' physics: bristles, a gap with restitution and ageing contacts obey the laws of theirs."""

from __future__ import annotations

import hidden
import numpy as np
import pytest
from hidden.base import Base
from hidden.bodies import one_body
from hidden.chain import Chain, Scene
from hidden.impacts import Gap, fly, gapped
from hidden.likeness import left_by
from hidden.loads import Loads
from hidden.motions import MOTIONS, Track
from hidden.rubbing import Ageing, Bristles
from hidden.sensors import FLOOR, filtered
from scipy.optimize import nnls

T = np.arange(10_000) / 5000.0
KNOB = Loads(1e-4, 0.010, 0.012, 1e-3, 1.2e-3, 0.0, 0.1, 0.0)
BARE = Loads(1e-4, 0.0, 0.0, 0.0, 0.0, 0.0, 0.1, 0.0)
STILL = KNOB._replace(inertia=0.0, viscous_neg=0.0, viscous_pos=0.0, coulomb_neg=0.012)
FIELD = Bristles.spread(np.random.default_rng(0).lognormal(0.0, 0.5, 1000), 0.01, 0.5, 0.4)


def moved(name: str = "multisine", seed: int = 0) -> Track:
    return MOTIONS[name](np.random.default_rng(seed), T)


def at(velocity: float, seconds: float = 2.0) -> Track:
    t = np.arange(round(seconds * 5000)) / 5000.0
    return Track(t, velocity * t, np.full_like(t, velocity), np.zeros_like(t))


def swung(cycles: int, reach: float, samples: int = 2000) -> Track:
    t = np.arange(cycles * samples) / 5000.0
    w = 2.0 * np.pi * 5000.0 / samples
    return Track(t, -reach * np.cos(w * t), reach * w * np.sin(w * t), reach * w * w * np.cos(w * t))


def rms(values: np.ndarray) -> float:
    return float(np.sqrt(np.mean(values**2)))


@pytest.mark.parametrize("velocity", [-2.0, 0.3])
def test_bristles_that_slide_steadily_rub_as_coulomb_does(velocity: float) -> None:
    torque = one_body(at(velocity), STILL._replace(bristles=FIELD))
    assert np.mean(torque) == pytest.approx(np.sign(velocity) * 0.012, rel=0.005)
    assert np.std(torque) < 0.03 * 0.012


@pytest.mark.parametrize("reach", [0.002, 0.01, 0.1])
def test_the_loop_of_bristles_closes_and_takes_energy(reach: float) -> None:
    track = swung(8, reach)
    torque = one_body(track, STILL._replace(bristles=FIELD)).reshape(8, -1)
    # Bristles that break loose at every turn take hold anew until they are strong enough for small swings.
    assert rms(torque[7] - torque[6]) < 0.04 * 0.012
    work = np.sum(torque * track.omega.reshape(8, -1), axis=1) / 5000.0
    assert np.all(work > -1e-12)
    # Coulomb friction takes more: it stores nothing and gives nothing back.
    assert np.all(work < 4.0 * reach * 0.012)


def test_no_sum_of_slip_elements_draws_the_loop_of_bristles() -> None:
    track = swung(3, 0.02)
    plain = one_body(track, STILL)
    own = (one_body(track, STILL._replace(bristles=FIELD)) - plain)[2000:]
    elements = [
        (one_body(track, STILL._replace(weights=np.ones(1), distances=np.array([d]))) - plain)[2000:]
        for d in np.geomspace(2e-4, 0.1, 40)
    ]
    left = nnls(np.stack(elements, 1), own)[1] / np.sqrt(len(own))
    assert 0.01 < left / rms(own) < 0.2


@pytest.mark.parametrize("velocity", [-5.0, -0.2, 0.03, 1.0])
def test_ageing_contacts_that_slide_steadily_rub_as_the_closed_form_says(velocity: float) -> None:
    ageing = Ageing(direct=0.01, evolving=0.3, speed=1.0, cutoff=0.5, way=1e-3)
    torque = one_body(at(velocity), STILL._replace(ageing=ageing))
    steady = 0.012 * ageing.steady(np.array([velocity]))[0]
    assert torque[-1] == pytest.approx(steady, rel=1e-9)
    # Started elsewhere it comes there over its way.
    fast, slow = at(4.0, 0.5), at(velocity)
    joined = Track(*(np.concatenate(both) for both in zip(fast, slow, strict=True)))
    joined = joined._replace(t=np.arange(len(joined.t)) / 5000.0)
    assert one_body(joined, STILL._replace(ageing=ageing))[-1] == pytest.approx(steady, rel=1e-6)


def test_ageing_contacts_rub_more_the_slower_they_slide_and_never_push() -> None:
    ageing = Ageing(direct=0.005, evolving=0.3, cutoff=0.5)
    levels = ageing.steady(np.geomspace(0.01, 10.0, 50))
    assert np.all(np.diff(levels) < 0.0)
    for name in MOTIONS:
        track = moved(name)
        assert np.all(one_body(track, STILL._replace(ageing=ageing)) * track.omega >= 0.0)


@pytest.mark.parametrize("restitution", [0.0, 0.4, 0.9])
def test_between_walls_that_stand_still_each_bounce_keeps_its_share(restitution: float) -> None:
    still = Track(T, *np.zeros((3, len(T))))
    speed = fly(still, BARE, Gap(0.01, restitution, 1e-3, 1.0), (0.0, 1.0), 10).omega
    kept = np.unique(np.round(np.abs(speed), 9))[::-1]
    assert kept[0] == 1.0
    assert np.all(np.diff(np.abs(speed)) <= 1e-12)
    expected = restitution ** np.arange(len(kept))
    assert kept[expected > 0.03] == pytest.approx(expected[expected > 0.03])


@pytest.mark.parametrize("name", MOTIONS)
@pytest.mark.parametrize("load", [BARE, KNOB._replace(detent=0.01)])
def test_a_gap_makes_no_energy(name: str, load: Loads) -> None:
    track, gap = moved(name), Gap(0.004, 0.5, 1e-3, 0.7)
    flight = fly(track, load, gap, (track.theta[0], track.omega[0]), 10)
    given = np.cumsum(flight.pressed * track.omega / 5000.0 + flight.knocked * track.omega)
    kinetic = 0.5 * gap.share * load.inertia * flight.omega**2
    stored = -load.detent * load.period * np.cos(flight.theta / load.period + load.phase)
    energy = kinetic + stored
    made = energy[1:] - energy[0] - given[:-1]
    # The work of a knock is taken with the shaft's velocity at the sample before it.
    assert np.max(made) < 0.02 * np.max(kinetic)


def test_within_its_gap_the_shaft_moves_nothing_but_itself() -> None:
    track = moved()
    torque = gapped(track, KNOB, Gap(10.0, 0.3, 1e-3, 0.7))
    assert torque == pytest.approx(0.3 * KNOB.inertia * track.alpha, rel=1e-12)


@pytest.mark.parametrize("name", MOTIONS)
@pytest.mark.parametrize(
    ("load", "off"),
    # Bristles break loose one after the other, in another order each time.
    [(KNOB, 0.3), (KNOB._replace(bristles=FIELD), 0.6), (KNOB._replace(ageing=Ageing(0.005, 0.1)), 0.3)],
)
def test_two_bodies_without_a_gap_are_one(name: str, load: Loads, off: float) -> None:
    track = moved(name)
    two = gapped(track, load, Gap(1e-9, 0.0, 2e-4, 0.6), substeps=80)
    assert rms(filtered(two - one_body(track, load))[200:-200]) < off * FLOOR


@pytest.mark.parametrize(
    ("name", "own"),
    [
        ("stribeck", {"rise": 0.6, "vs": 0.3, "delta": 1.2}),
        ("presliding", {"weights": np.array([0.7, 0.3]), "distances": np.array([0.01, 0.04])}),
    ],
)
def test_a_textbook_law_leaves_nothing_of_itself(name: str, own: dict[str, object]) -> None:
    scene = Scene(moved(), KNOB)
    chain = Chain(KNOB._replace(**own))
    other = "presliding" if name == "stribeck" else "stribeck"
    own_law, another = (left_by(law, scene, chain, Base(*scene)) for law in (name, other))
    # Slip elements have distances in steps: between two of them a little is left.
    assert own_law < 0.3
    assert another > max(5.0 * own_law, hidden.ALIKE)


@pytest.mark.parametrize("effect", hidden.STRANGER)
def test_a_stranger_has_the_name_whose_textbook_law_is_like_it(effect: str) -> None:
    knob = hidden.make(3, [effect], "turns", (1.5, 3.0), duration_s=2.0)
    assert 1.45 < knob.strength < 3.1
    assert knob.accepted[0][0] in ("presliding", "backlash", "stribeck")
    assert 0.0 < knob.misfit < knob.strength / 2.0
