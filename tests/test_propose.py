"""Laws for what no effect explains: proposed where they are, fitted as any effect, and never called found."""

from __future__ import annotations

import dataclasses
import math
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from command import knobcam, refused
from small import COUPLINGS

import knobcam as kc
from knobcam.fit.estimate import Estimate
from knobcam.learn.proposals import Proposals
from knobcam.learn.proposing import _ordered
from knobcam.workbench import proposing, surface


@pytest.fixture(scope="module")
def story(braked: kc.Capture) -> kc.LearningResult:
    return kc.learn(braked, without=COUPLINGS)


@pytest.fixture(scope="module")
def found(story: kc.LearningResult) -> Proposals:
    before = set(kc.effects())
    proposals = story.propose()
    # Nobody else's search knows of it.
    assert set(kc.effects()) == before
    return proposals


def proposed(gain: float, complexity: int, se: float, label: str = "", part: bool = False) -> Any:
    """A law as far as its place in the table depends on it."""
    low = -1.0 if part else 0.5
    params = {"a": Estimate(1.0, (low, 2.0), "N m", se)}
    own = label or f"a^{complexity}"
    known = {"gain": gain, "score": gain, "complexity": complexity, "params": params, "label": own}
    return SimpleNamespace(**known, variables=("omega",))


@pytest.mark.parametrize(
    ("laws", "order"),
    [
        # A constant that nothing determines: left out where what is known explains most of as much.
        ([(1000.0, 15, math.nan), (850.0, 4, 0.1), (700.0, 3, 0.1)], [1, 2]),
        ([(1000.0, 15, math.nan), (750.0, 4, 0.1)], [0, 1]),
        # A part that may be nothing: behind what explains most of as much, before what does not.
        ([(1000.0, 15, 0.1, "b", True), (850.0, 4, 0.1), (700.0, 3, 0.1)], [1, 0, 2]),
        ([(1000.0, 15, 0.1, "b", True), (750.0, 4, 0.1)], [0, 1]),
        # Of several that are whole and explain most of as much the best comes first.
        ([(1000.0, 15, 0.1, "b", True), (850.0, 9, 0.1), (860.0, 4, 0.1)], [2, 0, 1]),
        # The same written anew with more words is left out, and nothing else is.
        ([(1000.0, 15, 0.1), (999.6, 4, 0.1), (998.0, 3, 0.1)], [1, 2]),
        # One formula with other constants is one law.
        ([(1000.0, 9, 0.1, "a/w"), (990.0, 5, 0.1, "a w"), (900.0, 9, 0.1, "a/w")], [0, 1]),
    ],
)
def test_of_laws_the_first_is_one_that_the_data_decide(laws: list[Any], order: list[int]) -> None:
    given = [proposed(*law) for law in laws]
    assert [given.index(one) for one in _ordered([(one, False) for one in given])] == order


def test_a_brake_that_has_no_name_is_proposed_by_its_law(story: kc.LearningResult, found: Proposals) -> None:
    assert story.verdict == "unexplained"
    first = found.laws[0]
    assert first.variables == ("omega",) and found.p_value < 0.01
    omega = np.linspace(-4.0, 4.0, 801)
    a, w = first.params["a"].value, first.params["w"].value
    torque = eval(first.law.replace("^", "**"), {"a": a, "w": w, "omega": omega})
    truth = 0.016 * (omega / 1.3) / (1.0 + (omega / 1.3) ** 2)
    assert np.sqrt(np.mean((torque - truth) ** 2)) < 0.03 * np.sqrt(np.mean(truth**2))
    assert first.rmse_heldout < 1.03 * story.noise_floor
    low, high = first.params["w"].ci95
    assert low < 1.3 < high and first.params["w"].unit == "rad/s"


def test_what_is_proposed_says_so_and_draws_itself(found: Proposals) -> None:
    said = repr(found)
    assert "proposed, not found" in said and f"--law '{found.laws[0].law}'" in said
    assert found.plot().axes
    complexities = [one.complexity for one in found.front]
    errors = [one.rmse for one in found.front]
    assert complexities == sorted(complexities) and errors == sorted(errors, reverse=True)


def test_who_takes_a_law_has_it_in_the_model(
    story: kc.LearningResult, found: Proposals, tmp_path: Path
) -> None:
    taken = story.accept(found, 1, "eddy")
    assert taken.found == ("eddy",) and taken.verdict == "missing"
    taken.model.save(tmp_path / "eddy.toml")
    kc.forget_effect("eddy")
    assert "eddy" in kc.Model.load(tmp_path / "eddy.toml").effects
    with pytest.raises(kc.InputError, match="no proposal has that number"):
        story.accept(found, 99)


def test_what_is_printed_is_what_the_command_line_adds(
    braked: kc.Capture, story: kc.LearningResult, found: Proposals, tmp_path: Path
) -> None:
    first = found.laws[0]
    braked.save(tmp_path / "log.npz")
    story.ladder[0].fit.model.save(tmp_path / "base.toml")
    guess = [f"{name}={value}" for name, value in first.start.items()]
    ended = knobcam(
        *("add", "--law", first.law, tmp_path / "log.npz", tmp_path / "base.toml", "--json"),
        *("--guess", *guess),
    )
    assert ended.code == 0, ended.err
    for name, estimate in first.params.items():
        assert ended.document["params"][f"law.{name}"]["value"] == pytest.approx(estimate.value, rel=1e-3)


def test_where_no_formula_fits_the_curve_itself_is_a_law(tmp_path: Path) -> None:
    plain = kc.simulate("knob4", "sweep", duration_s=5.0, rate_hz=3000.0, seed=3)
    motion = kc.motion("sweep", 5.0, 3000.0)
    pads = ((3.0, -0.8, 0.12), (1.5, -0.35, 0.1), (3.5, 0.35, 0.1), (2.0, 0.8, 0.15))
    drag = sum(1e-3 * high * np.exp(-(((motion.theta - at) / wide) ** 2)) for high, at, wide in pads)
    worn = dataclasses.replace(plain, tau=plain.tau + drag * motion.omega)
    story = kc.learn(worn, without=COUPLINGS)
    found = story.propose()
    *formulas, last = found.laws
    assert last.document()["law"] is None and last.label == "a curve over theta, times omega"
    assert last.label in repr(found) and found.plot().axes
    assert min(one.rmse for one in formulas) > 1.2 * story.noise_floor
    assert last.rmse < 1.02 * story.noise_floor and last.rmse < last.rmse_heldout < 1.05 * story.noise_floor
    assert last in found.front and last.complexity > max(one.complexity for one in formulas)
    taken = story.accept(found, len(found), "worn")
    assert taken.after.complete and taken.fit.rmse_heldout < 1.05 * story.noise_floor
    taken.model.save(tmp_path / "worn.toml")
    kc.forget_effect("worn")
    # What another session reads from the file is the drag that was there, and can be felt.
    model = kc.Model.load(tmp_path / "worn.toml")
    clear: Any = {"duration_s": 5.0, "rate_hz": 3000.0, "noise": "none"}
    learned, clean = (kc.simulate(one, "sweep", **clear) for one in (model, "knob4"))
    off = learned.tau - clean.tau - drag * motion.omega
    assert np.sqrt(np.mean(off**2)) < 0.3 * story.noise_floor
    hand = kc.Renderer(model, 5000.0)
    assert all(np.isfinite(hand.step(0.3, 2.0)) for _ in range(500))


def test_nothing_is_proposed_for_a_knob_of_which_nothing_is_missing() -> None:
    story = kc.learn(kc.simulate("knob4", "sweep", duration_s=3.0, rate_hz=1000.0, seed=5), without=COUPLINGS)
    found = story.propose()
    assert found.laws == () and "No law is proposed" in repr(found)


def test_where_a_name_explains_it_the_name_comes_first() -> None:
    knob = kc.Model.load("knob4").with_effect("quadratic_drag").with_value("quadratic_drag.d", 5e-4)
    story = kc.learn(kc.simulate(knob, "sweep", duration_s=3.0, rate_hz=2000.0, seed=6), without=COUPLINGS)
    assert story.found == ("quadratic_drag",)
    assert story.propose().laws == ()


def test_where_names_end_the_way_on_is_said(braked: kc.Capture, tmp_path: Path) -> None:
    without = [word for name in (*COUPLINGS, "torque_drift", "presliding") for word in ("--without", name)]
    ended = knobcam("learn", braked.save(tmp_path / "log.npz"), *without)
    assert ended.code == 0 and "the same with --propose" in ended.out


def test_options_of_proposals_without_them_are_refused() -> None:
    refused(knobcam("learn", "log.npz", "--accept", "1"), "--propose")
    refused(knobcam("add", "stribeck", "log.npz", "knob4", "--guess", "a=1"), "--law")
    refused(knobcam("add", "log.npz", "knob4", "--law", "a omega", "--guess", "a=x"), "no number")


def test_a_power_with_an_exponent_of_its_own_is_proposed_and_kept_with_its_speed_held(tmp_path: Path) -> None:
    plain = kc.simulate("knob4", "sweep", duration_s=5.0, rate_hz=1000.0, seed=3)
    omega = kc.motion("sweep", 5.0, 1000.0).omega
    film = 0.02 * np.sign(omega) * (np.abs(omega) / 3.0) ** 0.4
    thinned = dataclasses.replace(plain, tau=plain.tau + film)
    story = kc.learn(thinned, without=COUPLINGS)
    found = story.propose()
    first = found.laws[0]
    assert first.law == "a*sign(omega)*(abs(omega)/w)^n" and first.variables == ("omega",)
    low, high = first.params["n"].ci95
    assert low < 0.4 < high and high - low < 0.2
    assert first.params["w"].held and first.params["w"].interval == "fixed" and "w=" in first.guess
    assert first.rmse_heldout < 1.05 * story.noise_floor
    taken = story.accept(found, 1, "film")
    taken.model.save(tmp_path / "film.toml")
    kc.forget_effect("film")
    model = kc.Model.load(tmp_path / "film.toml")
    assert model.params["film.w"].role == "fixed" and model.params["film.n"].role == "free"
    # It has a value at rest, where it is simulated and rendered too.
    hand = kc.Renderer(model, 5000.0)
    assert all(np.isfinite(hand.step(0.3, speed)) for speed in (0.0, 1e-12, -2.0, 0.0, 2.0))
    assert np.isfinite(kc.simulate(model, "sweep", duration_s=1.0).tau).all()


def test_what_is_left_over_two_variables_is_ranked_mapped_and_kept() -> None:
    plain = kc.simulate("knob4", "multisine", duration_s=5.0, rate_hz=2000.0, seed=3)
    motion = kc.motion("multisine", 5.0, 2000.0)
    theta, omega = (column / np.quantile(np.abs(column), 0.9) for column in (motion.theta, motion.omega))
    places = ((0.015, -0.5, 0.6), (-0.015, 0.5, 0.1), (0.015, 0.1, -0.7))
    relief = sum(
        high * np.exp(-(((theta - x) / 0.45) ** 2) - ((omega - v) / 0.45) ** 2) for high, x, v in places
    )
    story = kc.learn(dataclasses.replace(plain, tau=plain.tau + relief), without=COUPLINGS)
    found = story.propose()
    assert found.needs[0].variables == ("omega", "theta") and found.needs[0].p_value < 0.01
    assert "omega and theta" in found.needed and found.needed in repr(found)
    assert found.map is not None and found.map.over == ("theta", "omega")
    known = np.isfinite(found.map.value)
    assert 0.1 < known.mean() < 0.95 and (np.isfinite(found.map.band) == known).all()
    assert len(found.plot().axes) == 4  # curve or time, map and its bar, front
    last = found.laws[-1]
    assert last.label == "a surface over theta and omega"
    (*_, told) = proposing.document(found) or ()
    assert {*told["words"]} <= {"no shorter law is as good"} and told["doubt"] == ""  # nor splines' numbers
    shown = surface.document(found)
    assert shown is not None and shown["over"] == ("theta", "omega") and shown["laws"][-1] is not None
    left, law = (np.array(one, dtype=float) for one in (shown["value"], shown["laws"][-1]))
    both = np.isfinite(left) & np.isfinite(law)
    assert left.shape == (len(shown["y"]), len(shown["x"])) and both.sum() > 0.8 * known.sum()
    assert np.corrcoef(left[both], law[both])[0, 1] > 0.8
    assert np.sqrt(np.mean((left - law)[both] ** 2)) < 0.6 * np.sqrt(np.mean(left[both] ** 2))
    assert last.rmse < last.rmse_heldout < 0.75 * found.beside.rmse
    taken = story.accept(found, len(found), "relief")
    # It says what little friction there is as well, which is then nought and may come out below.
    hand = kc.Renderer(taken.model, 5000.0, force=True)
    assert all(np.isfinite(hand.step(0.3, 2.0)) for _ in range(500))
    kc.forget_effect("relief")
