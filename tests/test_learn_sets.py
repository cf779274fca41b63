"""Sets of causes, and causes that look like others, on knobs that share no code with the core."""

from __future__ import annotations

import numpy as np
import pytest
from hidden import Hidden, make
from known import BASE
from small import COUPLINGS, recorded
from strata import Stratum

import knobcam as kc
from knobcam.learn import LearningResult
from knobcam.learn.exchanged import straightened
from knobcam.learn.loosened import with_shapes


def learnt(
    case: str, motion: str | None = None, every: int = 1, without: tuple[str, ...] = ()
) -> LearningResult:
    """A search with `every` so many samples of the capture, where fewer show the same."""
    return kc.learn(thinned(Stratum.parse(case).make(motion), every), without=without)


def thinned(hidden: Hidden, every: int) -> kc.Capture:
    t, theta, omega, alpha, tau = (
        hidden.capture[name][::every]
        for name in ("t_s", "theta_rad", "omega_rad_s", "alpha_rad_s2", "tau_Nm")
    )
    return kc.Capture.from_arrays(t=t, theta=theta, omega=omega, alpha=alpha, tau=tau)


def test_what_came_in_first_gives_way_to_the_two_that_it_stood_in_for() -> None:
    story = learnt("pair/quadratic_drag+directional_detent:967", every=4)
    assert set(story.found) == {"quadratic_drag", "directional_detent"}
    assert story.verdict == "missing"
    falls = [step.rmse for step in story.ladder]
    assert falls == sorted(falls, reverse=True)


@pytest.mark.parametrize("seed", [907, 908])
def test_a_ripple_is_found_beside_detents_that_are_a_whole_order_or_taken_for_one(seed: int) -> None:
    story = learnt(f"one/cogging:{seed}", "turns", every=4)
    assert story.found == ("cogging",)


def test_a_law_that_is_a_little_off_brings_no_second_name() -> None:
    story = learnt("one/quadratic_drag:909", every=4)
    assert (story.verdict, story.found) == ("missing", ("quadratic_drag",))


def test_of_two_that_explain_as_much_the_one_that_leaves_friction_positive() -> None:
    story = learnt("one/stribeck:905", every=2)
    assert story.found == ("stribeck",)
    assert all(story.params[name].value > 0.0 for name in ("viscous.neg", "viscous.pos"))


def test_a_sensor_that_is_often_at_its_limit_keeps_its_noise() -> None:
    story = learnt("pair/position_polynomial+saturation:982", "hand", without=COUPLINGS)
    tau = story.captures[0].tau
    assert np.mean(np.abs(tau) >= np.abs(tau).max()) > 0.2
    assert story.fit.rmse < 1.03 * story.noise_floor
    assert set(story.found) == {"position_polynomial", "saturation"}


def test_what_was_looked_for_in_the_error_of_another_is_looked_for_anew_beside_it() -> None:
    # Friction that falls as it warms up hides which waves over position it has.
    story = learnt("pair/position_friction+friction_drift:3100", every=5)
    assert set(story.found) == {"position_friction", "friction_drift"}
    assert story.fit.rmse < 1.05 * story.noise_floor


def test_what_is_bent_by_another_that_is_missing_is_looked_for_anew_beside_it() -> None:
    knob = Stratum.parse("pair/quadratic_drag+position_friction:88440").make("chirp")
    fit = kc.fit(thinned(knob, every=3))
    diagnosis = fit.diagnose(without=COUPLINGS)
    led = max(diagnosis.candidates, key=lambda one: one.score)
    assert led.effect == "position_friction" and led.implausible
    steps = straightened(diagnosis, lambda _: None)
    assert steps is not None
    assert [step.added for step in steps] == ["quadratic_drag", "position_friction"]
    assert steps[-1].rmse < 1.05 * fit.noise_floor


def test_stops_that_hid_which_detents_there_are_are_named_alone() -> None:
    knob = make(1076, ["end_stop"], "multisine", 8.5)
    story = kc.learn(thinned(knob, every=2))
    assert (story.verdict, story.found) == ("missing", ("end_stop",))
    assert story.params["detent.P"].value == pytest.approx(knob.knob["detent.P"], rel=0.01)


def test_a_torque_that_is_late_is_not_ahead_too() -> None:
    story = learnt("pair/torque_lag+second_detent:3105", every=5)
    assert set(story.found) == {"torque_lag", "second_detent"}


def test_what_only_led_to_a_joint_is_not_named_with_it() -> None:
    story = learnt("one/compliance:6000")
    assert story.found == ("compliance",)
    assert story.verdict == "missing"


def test_a_spring_over_fine_detents_is_no_soft_joint() -> None:
    # One slow wave follows the spring, with any joint and without.
    knob = kc.hiding("knob3", "return_spring", motion="sweep", duration_s=6.0)
    story = kc.learn(kc.simulate(knob, "sweep", duration_s=6.0, rate_hz=1000.0))
    assert (story.verdict, story.found) == ("missing", ("return_spring",))
    assert "detent" in story.fit.model.effects


@pytest.mark.parametrize("power", [1.7, 2.0, 2.3])
def test_the_power_of_a_drag_is_fitted_where_the_data_pay_for_it(power: float) -> None:
    def drag(t: np.ndarray, theta: np.ndarray, omega: np.ndarray, alpha: np.ndarray) -> np.ndarray:
        return 3e-3 * np.sign(omega) * np.abs(omega) ** power

    story = kc.learn(recorded(3, drag, count=6000))
    assert (story.verdict, story.found) == ("missing", ("quadratic_drag",))
    told = story.params["quadratic_drag.n"]
    assert (told.se > 0.0) == (power != 2.0)
    low, high = told.ci95
    assert low <= power <= high and high - low < 0.1
    # Where it is held the terms beside it are known as well as it is.
    known, beside = story.params["viscous.pos"].se, story.fit.params["viscous.pos"].se
    assert (known > 2.0 * beside) == (power == 2.0)
    low, high = story.params["viscous.pos"].ci95
    assert low <= 5e-4 <= high


def test_the_power_of_a_drag_that_is_not_fitted_stays() -> None:
    def drag(t: np.ndarray, theta: np.ndarray, omega: np.ndarray, alpha: np.ndarray) -> np.ndarray:
        return 3e-3 * np.sign(omega) * np.abs(omega) ** 1.7

    capture = recorded(3, drag, count=3000)
    known = kc.fit(capture, kc.Model.of([*BASE, "quadratic_drag"])).model
    held = known.with_fixed("quadratic_drag.d")
    assert kc.learn(capture, held, without=COUPLINGS).params["quadratic_drag.n"].held
    assert not kc.learn(capture, known, without=COUPLINGS).params["quadratic_drag.n"].held


def test_what_is_tied_is_as_little_known_beside_a_shape_that_is_held_as_what_it_is_tied_to() -> None:
    knob = kc.hiding("knob4", "quadratic_drag", "directional_detent")
    assert knob.params["directional_detent.P"].role == "detent.P"
    fit = kc.fit(kc.simulate(knob, "sweep", duration_s=3.0, rate_hz=2000.0), knob)
    wider = with_shapes(fit.params, fit)
    tied, own = (wider[name].se for name in ("directional_detent.P", "detent.P"))
    assert tied == pytest.approx(own) and own > fit.params["detent.P"].se > 0.0
