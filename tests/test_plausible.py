"""What no knob has, and what only looks so: of fits of which everything is known."""

from __future__ import annotations

import math
from types import SimpleNamespace
from typing import Any, cast

import numpy as np
import pytest
from known import estimate

import knobcam as kc
from knobcam.base.said import number
from knobcam.fit import plausible
from knobcam.fit.doubts import log_in_doubt
from knobcam.fit.estimate import Estimate
from knobcam.fit.rule import RULE

SURE = {"inertia.M": (1e-4, 1e-6), "coulomb.neg": (0.02, 1e-4), "coulomb.pos": (0.02, 1e-4)}
SURE |= {"viscous.neg": (1e-3, 1e-5), "viscous.pos": (1e-3, 1e-5)}
EFFECTS = ("inertia", "coulomb", "viscous")


def fitted(rmse: float = 1.0, effects: tuple[str, ...] = EFFECTS, heldout: float = 1.0, **other: Any) -> Any:
    """A fit with these values; inertia__M=(-1e-4, 1e-6) says so of inertia.M."""
    values = SURE | {name.replace("__", "."): value for name, value in other.items()}
    params = {name: estimate(*value) for name, value in values.items()}
    names = {a: {b: float(a == b) for b in params} for a in params}
    model = SimpleNamespace(coordinate="rotary", effects=effects, catalogue=kc.effects)

    def bootstrap(draws: int) -> dict[str, Any]:
        known = [name for name, one in params.items() if math.isfinite(one.se)]
        se = np.array([params[name].se for name in known])
        joint = np.outer(se, se) * np.array([[names[a][b] for b in known] for a in known])
        means = [params[name].value for name in known]
        refits = np.random.default_rng(1).multivariate_normal(means, joint, draws)
        return dict(zip(known, refits.T, strict=True))

    return SimpleNamespace(
        model=model,
        params=params,
        rmse=rmse,
        rmse_heldout=heldout,
        prepared=(),
        correlation=names,
        bootstrap=bootstrap,
        torque_unit="N m",
    )


@pytest.fixture(autouse=True)
def torques(monkeypatch: pytest.MonkeyPatch) -> dict[str, float]:
    """The RMS torque of each parameter; a tenth of the error where it is not said."""
    known: dict[str, float] = {}
    monkeypatch.setattr(plausible, "torque_of", lambda fit, name: known.get(name, 0.1 * fit.rmse))
    monkeypatch.setattr(plausible, "gives_back", lambda prepared: False)
    return known


def power(monkeypatch: pytest.MonkeyPatch, value: float, error: float) -> None:
    monkeypatch.setattr(plausible, "_friction_power", lambda fit: (value, error))


def test_an_inertia_below_zero_is_none_where_it_makes_more_torque_than_is_left(
    monkeypatch: pytest.MonkeyPatch, torques: dict[str, float]
):
    power(monkeypatch, 1.0, 0.0)
    below = {"inertia__M": (-1e-4, 1e-6)}
    assert plausible.impossible(fitted()) is None and plausible.impossible(fitted(**below)) is None
    torques["inertia.M"] = 1.1
    assert plausible.impossible(fitted(**below)) == "inertia.M came out negative, which no knob has"
    # Within four standard errors of zero it may be none.
    for error, said in ((0.9e-4 / RULE.surely, True), (1.1e-4 / RULE.surely, False)):
        assert (plausible.impossible(fitted(inertia__M=(-1e-4, error))) is not None) == said
    assert plausible.impossible(fitted(inertia__M=(-1e-4, math.inf))) is None


def test_a_term_is_none_that_another_takes_away(torques: dict[str, float]):
    torques["coulomb.pos"] = 10.1
    tau = np.array([0.8, -1.2, 9.0])
    measured = (SimpleNamespace(tau=tau, used=np.array([True, True, False])),)
    for error, rms, said in ((0.9, 1.0, True), (0.4, 1.0, False), (0.9, 1.1, False)):
        fit = fitted(coulomb__pos=(1.0, error))
        fit.prepared = measured
        tau[:2] = rms, -rms
        words = "coulomb.pos makes many times the torque that was measured, which others take away again"
        assert plausible.impossible(fit) == (words if said else None)


def test_friction_of_which_only_the_offset_is_unknown_is_told(torques: dict[str, float]):
    """A zero of the sensor that drifts slowly takes an offset away, and leaves what both directions have."""
    torques |= {"coulomb.neg": 20.0, "coulomb.pos": 20.0}
    fit = fitted(coulomb__neg=(0.12, 0.4), coulomb__pos=(-0.11, 0.4))
    fit.prepared = (SimpleNamespace(tau=np.array([0.8, -1.2]), used=np.array([True, True])),)
    for correlation, said in ((-1.0, False), (-0.5, True)):
        fit.correlation["coulomb.neg"]["coulomb.pos"] = fit.correlation["coulomb.pos"]["coulomb.neg"] = (
            correlation
        )
        assert (plausible.impossible(fit) is not None) == said


def test_friction_below_zero_is_told_by_its_power_alone(
    monkeypatch: pytest.MonkeyPatch, torques: dict[str, float]
):
    torques["coulomb.neg"] = 5.0
    bent = fitted(coulomb__neg=(-0.02, 1e-4))
    for value, error, said in (
        (-1.0, 0.99 / RULE.surely, True),
        (-1.0, 1.01 / RULE.surely, False),
        (1.0, 0.0, False),
    ):
        power(monkeypatch, value, error)
        found = plausible.impossible(bent)
        assert found == ("friction gives power back, which no knob does" if said else None)
        # Where nothing is below zero nobody asks.
        assert plausible.impossible(fitted()) is None


def test_an_effect_beside_is_held_to_its_range_and_the_base_model_is_not(monkeypatch: pytest.MonkeyPatch):
    power(monkeypatch, 1.0, 0.0)
    drag = fitted(effects=(*EFFECTS, "quadratic_drag"), quadratic_drag__d=(-1e-3, 1e-5))
    assert plausible.impossible(drag) == (
        "quadratic_drag.d = -0.001 N m is implausible: it should be at least 0"
    )
    assert plausible._out_of_range("quadratic_drag", fitted()) == []
    unsure = fitted(effects=(*EFFECTS, "quadratic_drag"), quadratic_drag__d=(-1e-3, 1e-3))
    assert plausible.impossible(unsure) is None


def test_a_torque_of_the_other_sign_is_one_where_all_that_is_sure_is_below_zero(
    monkeypatch: pytest.MonkeyPatch,
):
    power(monkeypatch, -1.0, 0.1)
    turned = {name.replace(".", "__"): (-value, error) for name, (value, error) in SURE.items()}
    assert plausible.reversed_torque(fitted(**turned)) and not plausible.reversed_torque(fitted())
    assert (
        plausible.log_fault(fitted(**turned)) == plausible.REVERSED and plausible.log_fault(fitted()) is None
    )
    one_sound = turned | {"inertia__M": SURE["inertia.M"]}
    assert not plausible.reversed_torque(fitted(**one_sound))
    unsure = turned | {"inertia__M": (1e-4, 1e-3)}
    assert plausible.reversed_torque(fitted(**unsure))
    for error, said in ((0.99 / RULE.surely, True), (1.01 / RULE.surely, False)):
        power(monkeypatch, -1.0, error)
        assert plausible.reversed_torque(fitted(**turned)) == said
    # Beside a spring that hides all of it the hand's power tells, but only of what is below zero at all.
    monkeypatch.setattr(plausible, "gives_back", lambda prepared: True)
    assert plausible.reversed_torque(fitted(inertia__M=(-1e-4, 1e-3))) and not plausible.reversed_torque(
        fitted()
    )


def test_what_an_effect_bends_below_zero_speaks_against_it(torques: dict[str, float]):
    def said(now: tuple[float, float], then: tuple[float, float]) -> list[str]:
        candidate: Any = SimpleNamespace(fit=fitted(inertia__M=now), rmse=1.0)
        return plausible._below_zero(candidate, fitted(inertia__M=then))

    good, bad = (1e-4, 1e-6), (-1e-4, 1e-6)
    assert said(bad, good) == []
    torques["inertia.M"] = 1.1
    assert said(bad, good) == ["beside it inertia.M = -0.0001, which no knob has"]
    assert said(bad, bad) == [] and said(good, bad) == [] and said(bad, (1e-4, math.inf)) == []
    for error, bent in ((0.99e-4 / RULE.sure, True), (1.01e-4 / RULE.sure, False)):
        assert bool(said((-1e-4, error), good)) == bent
    # It was below zero before, but not so far.
    assert said(bad, (-1e-5, 1e-6)) != [] and said((-1.1e-5, 1e-7), (-1e-5, 1e-6)) == []


def test_one_direction_of_friction_below_zero_may_be_an_offset(torques: dict[str, float]):
    """The mean of the two is friction, and what they differ in a constant torque."""
    torques |= {"coulomb.neg": 1.1}
    before = fitted(coulomb__neg=(0.02, 1e-4))

    def bent(neg: float, pos: float) -> bool:
        now = fitted(coulomb__neg=(neg, 1e-4), coulomb__pos=(pos, 1e-4))
        return bool(plausible._below_zero(cast(Any, SimpleNamespace(fit=now, rmse=1.0)), before))

    assert bent(-0.02, 0.01) and not bent(-0.02, 0.02) and not bent(-0.02, 0.0199)


def test_what_an_effect_loses_on_unseen_blocks_speaks_against_it_where_it_is_more_than_it_wins():
    before = fitted(rmse=2.0, heldout=2.0)
    assert plausible._unseen(fitted(rmse=1.0, heldout=1.0), before) == []
    for heldout, said in ((2.9, []), (3.2, ["on blocks that the fit did not see it adds 60.0 %"])):
        assert plausible._unseen(fitted(rmse=1.0, heldout=heldout), before) == said
    assert plausible._unseen(fitted(rmse=2.1, heldout=2.01), before) != []
    assert plausible._unseen(fitted(rmse=1.0, heldout=9.0), fitted(rmse=0.0)) == []


def test_a_log_is_at_fault_by_its_findings_unless_they_were_mended():
    def of(*found: tuple[str, str]) -> Any:
        findings = [SimpleNamespace(kind=kind, severity=severity, message=kind) for kind, severity in found]
        return (SimpleNamespace(findings=[], capture=SimpleNamespace(samples=9, findings=findings)),)

    assert plausible.columns_at_fault(of(("unit", "mended"), ("clipped", "warning"))) is None
    assert plausible.columns_at_fault(of(("clipped", "warning"), ("swapped", "warning"))) == "swapped"


def test_friction_below_zero_both_ways_is_a_fault_of_the_log_and_an_offset_is_none() -> None:
    knob = kc.simulate(kc.Model.load("knob4"), duration_s=2.0)
    given = np.sign(knob.omega)

    def doubt(tau: np.ndarray) -> str | None:
        columns = {"t": knob.t, "theta": knob.theta, "omega": knob.omega, "alpha": knob.alpha, "tau": tau}
        return log_in_doubt(kc.fit(kc.Capture.from_arrays(**columns)))

    assert doubt(knob.tau) is None
    assert doubt(knob.tau + 0.02) is None
    said = doubt(knob.tau - 0.02 * given)
    assert said is not None and said.startswith("coulomb.neg and coulomb.pos came out negative")


def test_an_offset_over_a_motion_that_ends_elsewhere_gives_no_power_back() -> None:
    t = np.arange(5000) / 1000.0
    omega = 2.0 + 3.0 * np.cos(9.0 * t)
    alpha = -27.0 * np.sin(9.0 * t)
    theta = 2.0 * t + 3.0 * np.sin(9.0 * t) / 9.0
    noise = 1e-4 * np.random.default_rng(2).standard_normal(len(t))

    def fitted_with(offset: float, friction: float) -> str | None:
        tau = 1e-4 * alpha + friction * np.sign(omega) + offset + noise
        return kc.fit(kc.Capture.from_arrays(t=t, theta=theta, omega=omega, alpha=alpha, tau=tau)).impossible

    assert fitted_with(-0.05, 0.01) is None
    assert fitted_with(0.05, -0.01) == "friction gives power back, which no knob does"


def test_what_is_the_same_both_ways_is_that_of_the_rows_that_are_known() -> None:
    omega = np.array([1.0, 2.0, -1.0, -2.0])
    nan = np.nan
    both = plausible._without_constant(np.array([3.0, nan, -1.0, -1.0]), omega)
    np.testing.assert_allclose(both, [2.0, nan, -2.0, -2.0])
    # Of the way forward nothing is known: what is left has no constant that could be told.
    backward = plausible._without_constant(np.array([nan, nan, -1.0, -1.0]), omega)
    np.testing.assert_allclose(backward, [nan, nan, -1.0, -1.0])


@pytest.mark.parametrize(("count", "several"), [(199, False), (200, True)])
def test_an_angle_of_which_a_fifth_is_of_another_motion_tells_nothing(count: int, several: bool) -> None:
    astray = SimpleNamespace(kind="spike", column="theta", count=count)
    loud = SimpleNamespace(kind="spike", column="omega", count=900)
    log = SimpleNamespace(findings=[astray, loud], capture=SimpleNamespace(samples=1000, findings=()))
    assert ("split it" in (plausible.columns_at_fault([log]) or "")) == several


@pytest.mark.parametrize(
    ("times", "often"), [(1.0, "once"), (0.999, "once"), (0.5, "0.5 times"), (1.2, "1.2 times")]
)
def test_detents_that_return_hardly_more_than_once_a_turn_are_said_to_be_an_unbalance(
    times: float, often: str
) -> None:
    turning = cast(Any, SimpleNamespace(model=SimpleNamespace(period=1.0 / times, coordinate="rotary")))
    said = plausible._once_a_turn("detent", turning)
    assert said == [f"it returns {often} a turn, as an unbalance does and no detents do"]


def test_friction_whose_mean_is_known_is_not_taken_away_by_a_zero_that_drifts_however_slowly():
    knob = kc.Model.of(("inertia", "coulomb", "viscous"), "rotary").with_value("inertia.M", 1e-4)
    for name in ("coulomb.neg", "coulomb.pos"):
        knob = knob.with_value(name, 0.004)
    capture = kc.simulate(knob, motion="multisine", duration_s=3.0, rate_hz=2500.0, seed=3)
    drifts = kc.fit(capture, detents="no").add("torque_drift").model
    # In three seconds of hours a transient is an offset and a line.
    fit = kc.fit(capture, drifts.with_value("torque_drift.T", 1e4).with_fixed("torque_drift.T"))
    each = fit.params["coulomb.neg"], fit.params["coulomb.pos"]
    assert all(one.se > 100.0 * 0.004 for one in each)
    assert abs(sum(one.value for one in each) / 2.0 - 0.004) < 1e-4
    assert plausible.impossible(fit) is None


def test_a_value_that_none_can_have_is_told_with_its_unit_and_so_are_the_limits_of_it():
    lag = Estimate(0.05, (0.049, 0.051), "s", 1e-6)
    assert plausible.out_of_range(lag, (0.0, 0.02)) == ("0.05 s is implausible: it should be 0 to 0.02 s")
    share = Estimate(1.5, (1.4, 1.6), "1", 1e-6)
    assert plausible.out_of_range(share, (0.0, 1.0)) == "1.5 is implausible: it should be 0 to 1"
    weak = plausible.out_of_range(Estimate(-2e-4, (-3e-4, -1e-4), "N m", 1e-6), (0.0, math.inf))
    assert weak is not None and weak.parts[0] == number(-2e-4, "N m", ".3g")
