"""What decides in Python, piece by piece: against brute force, theory, and what it must not depend on."""

from __future__ import annotations

import math
from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

import knobcam as kc
from knobcam.capture.prepare import prepare
from knobcam.fit import zeros
from knobcam.fit.doubts import _moves_like_a_spring, at_floor
from knobcam.fit.estimate import Z95, Estimate
from knobcam.fit.plausible import one_velocity, out_of_range
from knobcam.fit.power import gives_back
from knobcam.fit.rule import RULE
from knobcam.fit.unheard import Unheard
from knobcam.learn import limitations, rivals, selection
from knobcam.learn.agreement import disagreements
from knobcam.learn.ladder import LearningStep

RATE_HZ = 1000.0


def estimate(value: float, se: float, unit: str = "N m") -> Estimate:
    return Estimate(value, (value - Z95 * se, value + Z95 * se), unit, se)


def turned(seed: int = 1, seconds: float = 10.0, reach: float = 6.0) -> tuple[Any, ...]:
    """Time, angle, velocity and acceleration of a motion of three frequencies."""
    random = np.random.default_rng(seed)
    t = np.arange(round(seconds * RATE_HZ)) / RATE_HZ
    theta, omega, alpha = np.zeros((3, len(t)))
    for share, hz in ((0.38, 0.17), (0.1, 0.43), (0.02, 1.9)):
        rate, phase = 2.0 * np.pi * hz * random.uniform(0.85, 1.15), random.uniform(0.0, 2.0 * np.pi)
        theta += share * reach * np.sin(rate * t + phase)
        omega += share * reach * rate * np.cos(rate * t + phase)
        alpha -= share * reach * rate**2 * np.sin(rate * t + phase)
    return t, theta, omega, alpha


def recorded(
    seed: int = 1,
    start: float = 0.0,
    inertia: float = 6e-5,
    waves: Any = None,
    sign: float = 1.0,
    **more: Any,
) -> kc.Capture:
    """A knob with inertia, friction and waves of position, whose counter reads `start` less."""
    t, theta, omega, alpha = turned(seed, **more)
    tau = inertia * alpha + 3e-3 * np.sign(omega) + 4e-4 * omega
    for order, size in (waves or {}).items():
        tau += size * np.sin(order * theta + order)
    tau += 3e-4 * np.random.default_rng(seed + 100).standard_normal(len(t))
    return kc.Capture.from_arrays(t=t, theta=theta - start, omega=omega, alpha=alpha, tau=sign * tau)


def test_how_far_two_maps_are_apart_is_what_every_shift_by_itself_says():
    random = np.random.default_rng(3)
    maps = []
    for cells in (40, 53):
        counts = np.where(random.uniform(size=cells) < 0.2, 0.0, random.integers(1, 9, cells)).astype(float)
        values = np.where(counts > 0.0, random.normal(size=cells), 0.0)
        maps.append(zeros._Map(values, counts, 0.01 * cells / 40))
    a, b = maps
    lags, differ = zeros._differences(a, b)
    noise, shared = a.noise + b.noise, 0
    fewest = zeros._OVERLAP * min(np.count_nonzero(one.counts) for one in maps)
    for lag, found in zip(lags.astype(int), differ, strict=True):
        both = [
            (a.values[i + lag], b.values[i])
            for i in range(len(b.counts))
            if 0 <= i + lag < len(a.counts) and a.counts[i + lag] > 0.0 and b.counts[i] > 0.0
        ]
        if len(both) < fewest:
            assert np.isnan(found), lag
            continue
        x, y = np.array(both).T
        own = np.var(x) + np.var(y)
        assert found == pytest.approx((np.var(x - y) - noise) / (own - noise), abs=1e-9), lag
        shared += 1
    assert shared > 20


def test_what_is_within_cells_has_no_mean_in_any_and_a_map_has_none_at_all():
    random = np.random.default_rng(4)
    cell = random.integers(0, 30, 900)
    cell[:30] = np.arange(30)
    run = zeros._Run(random.normal(size=900), np.zeros(900), random.normal(size=(900, 2)), cell)
    for values in (run.theta, run.base):
        within = run.within(values)
        for one in range(30):
            assert within[cell == one] == pytest.approx(values[cell == one] - values[cell == one].mean(0))
    tau = np.sin(cell / 3.0) + 0.1 * random.normal(size=900)
    map_ = zeros._mapped(run._replace(tau=tau))
    assert map_ is not None
    assert map_.counts @ map_.values == pytest.approx(0.0, abs=1e-9)
    means = np.array([tau[cell == one].mean() for one in range(30)])
    assert map_.values - map_.values[0] == pytest.approx(means - means[0])
    # The mean of n samples of noise 0.1 has the variance 0.01 / n.
    assert map_.noise == pytest.approx(0.01 * np.mean(1.0 / map_.counts), rel=0.1)
    assert zeros._mapped(run._replace(tau=0.1 * random.normal(size=900))) is None


@pytest.mark.parametrize("start", [0.41, -1.37])
def test_an_angle_that_is_counted_from_elsewhere_is_moved_and_no_other(start: float):
    waves = {7.0: 3e-3, 12.0: 4e-3, 24.0: 1.5e-3}
    both = [recorded(1, waves=waves), recorded(2, start, waves=waves)]

    def moves(captures: list[kc.Capture]) -> float:
        ours, theirs = zeros.aligned([prepare(one) for one in captures])
        assert ours.capture is captures[0]
        return float(theirs.capture.theta[0] - captures[1].theta[0])

    assert moves(both) == pytest.approx(start, abs=2e-3)
    assert moves(both[::-1]) == pytest.approx(-start, abs=2e-3)
    assert moves([both[0], recorded(2, 0.0, waves=waves)]) == 0.0
    # Of a knob without any map, and of what goes by other places, nothing can be said.
    assert moves([recorded(1), recorded(2, start)]) == 0.0
    assert moves([both[0], recorded(2, 40.0, waves={5.0: 4e-3})]) == 0.0
    only = (prepare(both[0]),)
    assert zeros.aligned(only) == only


def test_a_torque_of_the_other_sign_gives_power_back_whatever_lies_along_the_position():
    for waves in ({}, {1.0: 0.1}, {7.0: 3e-3}):
        for unit in (1.0, 1e3):
            sound = recorded(5, waves=waves, seconds=4.0)
            sound = replace(sound, tau=unit * sound.tau)
            turned_round = replace(sound, tau=-sound.tau)
            assert not gives_back([prepare(sound)])
            assert gives_back([prepare(turned_round)])
            assert not gives_back([prepare(turned_round), prepare(sound)])
    # Where the angle is counted from, and which way is forward, is nobody's affair.
    far = recorded(5, start=50.0, waves={1.0: 0.1}, seconds=4.0)
    for one in (far, replace(far, theta=-far.theta, omega=-far.omega, alpha=-far.alpha, tau=-far.tau)):
        assert not gives_back([prepare(one)])
        assert gives_back([prepare(replace(one, tau=-one.tau))])
    noise = replace(sound, tau=np.random.default_rng(6).standard_normal(len(sound.tau)))
    assert not gives_back([prepare(noise)])
    short = recorded(5, sign=-1.0, seconds=0.9)
    assert not gives_back([prepare(short)])


def test_an_error_at_the_floor_is_told_by_the_rule_and_never_without_a_floor():
    def of(rmse: float, floor: float, white_squares: float = 1e5) -> Any:
        return SimpleNamespace(rmse=rmse, noise_floor=floor, white_squares=white_squares)

    assert at_floor(of(RULE.at_floor * 2.0, 2.0))
    assert not at_floor(of(RULE.at_floor * 2.0 * 1.0001, 2.0))
    assert not at_floor(of(0.0, 0.0)) and not at_floor(of(1.0, math.nan))
    # Of a short capture the floor is less known.
    assert at_floor(of(RULE.at_floor * 2.0 * 1.0001, 2.0, 400.0))


def test_one_frequency_moves_like_a_spring_and_two_do_not():
    t = np.arange(4000) / RATE_HZ
    for hz, other, like in ((1.0, 0.0, True), (3.0, 0.0, True), (1.0, 0.4, False)):
        w, v = 2.0 * np.pi * hz, 2.0 * np.pi * 2.5 * hz
        theta = 5.0 + np.sin(w * t) + other * np.sin(v * t)
        alpha = -(w**2) * np.sin(w * t) - other * v**2 * np.sin(v * t)
        used = np.ones(len(t), dtype=bool)
        for sign in (1.0, -1.0):
            signals = SimpleNamespace(theta=theta, alpha=sign * alpha, used=used)
            assert _moves_like_a_spring(signals) == (like and sign > 0.0)
    assert not _moves_like_a_spring(SimpleNamespace(theta=np.ones(9), alpha=np.ones(9), used=used[:9]))


def test_a_value_is_implausible_only_where_its_error_leaves_no_doubt():
    inside, edge = (1.0, 3.0), RULE.sure * 0.1
    assert (
        out_of_range(estimate(1.0, 0.0), inside) is None and out_of_range(estimate(3.0, 0.0), inside) is None
    )
    for off in (3.0 + edge, 1.0 - edge):
        beyond = math.copysign(1e-6, off - 2.0)
        assert out_of_range(estimate(off - beyond, 0.1), inside) is None
        assert "1 N m to 3 N m" in (out_of_range(estimate(off + beyond, 0.1), inside) or "")
        # What the data say nothing about has no error to hide behind.
        assert out_of_range(estimate(off - beyond, math.inf), inside) is not None
    assert "at least 1" in (out_of_range(estimate(0.2, 0.0), (1.0, math.inf)) or "")


def test_a_motion_at_one_velocity_is_named_with_it():
    t = np.arange(2000) / RATE_HZ

    def said(theta: Any) -> str | None:
        return one_velocity(
            [
                SimpleNamespace(
                    capture=SimpleNamespace(t=t, theta=theta, mask=slice(None), units={"omega": "rad/s"})
                )
            ]
        )

    assert "-2.5 rad/s" in (said(7.0 - 2.5 * t) or "")
    assert said(7.0 - 2.5 * t + 0.01 * np.sin(9.0 * t)) is None
    assert said(7.0 - 2.5 * t + 1e-3 * np.sin(9.0 * t)) is not None


def test_captures_disagree_about_what_differs_and_by_so_many_standard_errors():
    same = kc.fit([recorded(1), recorded(2)])
    assert disagreements(same) == ()
    assert disagreements(kc.fit([recorded(1)])) == ()
    fit = kc.fit([recorded(1), recorded(2), recorded(3, inertia=9e-5)])
    alone = [kc.fit([recorded(seed, inertia=inertia)]) for seed, inertia in ((1, 6e-5), (2, 6e-5), (3, 9e-5))]
    worst = disagreements(fit)[0]
    assert worst.param == "inertia.M" and worst.values[1] == pytest.approx(9e-5, rel=0.05)
    a, b = (one.params["inertia.M"] for one in (alone[0], alone[2]))
    c = alone[1].params["inertia.M"]
    by = max(abs(x.value - b.value) / math.sqrt(x.se**2 + b.se**2) for x in (a, c))
    assert worst.by_se == pytest.approx(by, rel=0.02)


def test_a_split_is_in_the_units_of_its_axis():
    units = {one.axis: one.unit for one in kc.compare(kc.fit(recorded(1, seconds=3.0))).splits}
    assert (units["position"], units["velocity"], units["load"]) == ("rad", "rad/s", "N m")
    t, theta, omega, alpha = turned(2, seconds=3.0)
    force = 0.3 * alpha + 2.0 * np.sign(omega) + 0.1 * np.random.default_rng(1).standard_normal(len(t))
    rail = kc.Capture.from_arrays(t=t, theta=theta, omega=omega, alpha=alpha, tau=force, coordinate="linear")
    units = {one.axis: one.unit for one in kc.compare(kc.fit(rail)).splits}
    assert (units["position"], units["velocity"], units["load"]) == ("m", "m/s", "N")


def moving(omega: Any, alpha: Any = None) -> Any:
    used = np.ones(len(omega), dtype=bool)
    core = SimpleNamespace(used=len(omega), rate_hz=RATE_HZ)
    one = SimpleNamespace(omega=omega, alpha=alpha, used=used, core=core)
    return SimpleNamespace(
        prepared=[one],
        model=SimpleNamespace(coordinate="rotary", period=None, catalogue=kc.effects),
        noise_floor=1.0,
    )


def test_what_a_motion_does_not_show_is_told_from_its_speeds(monkeypatch):
    t = np.arange(5000) / RATE_HZ
    wave = np.sin(2.0 * np.pi * t)

    def kinds(omega: Any) -> list[str]:
        return [one.kind for one in limitations._directions(moving(omega), omega) if one is not None]

    assert kinds(wave) == []
    assert kinds(np.abs(wave) + 0.1) == ["no_reversal", "one_direction"]
    # A hundredth of the way back is one direction, a twentieth is not.
    for share, told in ((0.01, ["one_direction"]), (0.05, [])):
        assert kinds(np.where(wave > 0.0, wave, share * wave)) == told or share < limitations._MOVING
    said = limitations._directions(moving(-np.abs(wave) - 0.1), -np.abs(wave) - 0.1)[1]
    assert said is not None and "backward only" in said.message and "friction forward" in said.message
    # Of a motion that turns so often that hardly a row counts it is not said that it goes one way.
    often = moving(wave)
    often.prepared[0].used = wave > 0.5
    (both,) = [one for one in limitations._directions(often, wave[wave > 0.5]) if one is not None]
    assert both.message.startswith("what counts of the motion is forward only") and "faster" in both.record
    # Below a fiftieth of the fastest a sign means nothing.
    assert limitations._reversals(np.array([1.0, 0.01, -0.01, 1.0, -1.0, 0.0, -1.0, 1.0]), 0.02) == 2
    assert limitations._slowness(moving(wave), wave) is None
    fast = 1.0 + 0.5 * wave
    assert limitations._slowness(moving(fast), fast) is not None
    assert limitations._length(moving(wave)) is None
    assert (
        limitations._length(moving(wave[:999])) is not None
        and limitations._length(moving(wave[:1000])) is None
    )
    assert limitations._noise(moving(wave)) is None
    monkeypatch.setattr(limitations, "unheard", lambda fit: Unheard("nothing is heard", "listen"))
    unknown = limitations._noise(SimpleNamespace(noise_floor=math.nan))
    assert unknown is not None and unknown.record == "listen"


def test_what_returns_less_than_once_a_turn_is_no_detent(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(limitations, "travel", lambda prepared: 2.7)

    def asked(period: float | None, coordinate: str) -> str | None:
        fit = SimpleNamespace(prepared=(), model=SimpleNamespace(period=period, coordinate=coordinate))
        found = limitations.width(fit)
        return None if found is None else found.record

    assert asked(0.75, "rotary") == "turn through at least 9.4 rad"
    assert asked(13.9, "rotary") is None and asked(None, "rotary") is None
    assert asked(13.9, "linear") == "turn through at least 1.7e+02 m"


def candidate(effect: str, gain: float, count: int, value: float = 1.0, **more: Any) -> Any:
    fit = SimpleNamespace(
        params={"viscous.pos": estimate(value, 0.1), "detent.S": estimate(value, 0.1, unit="rad")}
    )
    known = {"effect": effect, "gain": gain, "count": count, "score": gain - 12.0 * count, "rmse": 1.0}
    row = SimpleNamespace(along=False, friction=False)
    known |= {"charged": float(count), "equivalent": (), "fit": fit, "row": row}
    return SimpleNamespace(**(known | more))


def diagnosed(*could: Any, floor: float = 1.0) -> Any:
    return SimpleNamespace(could_be=could, fit=SimpleNamespace(noise_floor=floor, white_squares=1000.0))


def test_rivals_weigh_as_the_information_criterion_says():
    two = diagnosed(candidate("a", 100.0, 1), candidate("b", 104.0, 2))
    weights = rivals.weights(two, "a")
    # Half of what one takes off more, less half of ln n for each parameter more (Schwarz 1978).
    ratio = math.exp(0.5 * (4.0 - math.log(1000.0)))
    assert weights["b"] / weights["a"] == pytest.approx(ratio) and sum(weights.values()) == pytest.approx(1.0)
    assert list(weights) == ["a", "b"]
    # What may be anything within its range costs nothing.
    spared = diagnosed(candidate("a", 100.0, 1), candidate("b", 104.0, 2, charged=1.0))
    weights = rivals.weights(spared, "a")
    assert weights["b"] / weights["a"] == pytest.approx(math.exp(2.0))
    assert rivals.weights(two, "c") == {} and rivals.weights(None, "a") == {}
    assert rivals.weights(diagnosed(candidate("a", 1.0, 1), floor=math.nan), "a") == {}
    # Noise that is half of what is left counts for a quarter of each gain.
    loud = diagnosed(candidate("a", 100.0, 1), candidate("b", 104.0, 1), floor=0.5)
    weights = rivals.weights(loud, "b")
    assert weights["b"] / weights["a"] == pytest.approx(math.exp(0.5 * 0.25 * 4.0))


def test_the_spread_over_rivals_widens_an_interval_and_moves_no_value():
    two = diagnosed(candidate("a", 100.0, 1, 1.0), candidate("b", 100.0, 1, 3.0))
    step = SimpleNamespace(diagnosis=two, added="a")
    params = {"viscous.pos": estimate(1.0, 0.5), "coulomb.pos": estimate(2.0, 0.5)}
    wider = rivals.with_choice(params, [step])
    assert wider["coulomb.pos"] == params["coulomb.pos"]
    # Half of the weight lies two away: the variance about the value is 2.
    one = wider["viscous.pos"]
    assert one.value == 1.0 and one.se == pytest.approx(math.sqrt(0.25 + 2.0))
    assert one.ci95 == pytest.approx((1.0 - Z95 * one.se, 1.0 + Z95 * one.se))
    # An angle is no farther away than the way round.
    round_ = diagnosed(candidate("a", 100.0, 1, 0.1), candidate("b", 100.0, 1, 2.0 * math.pi - 0.1))
    angle = rivals.with_choice(
        {"detent.S": estimate(0.1, 0.1, unit="rad")}, [SimpleNamespace(diagnosis=round_, added="a")]
    )
    assert angle["detent.S"].se == pytest.approx(math.sqrt(0.01 + 0.5 * 0.04))


def test_an_effect_is_the_main_one_where_it_takes_off_most_of_what_noise_does_not_explain():
    for share, mainly in ((RULE.mainly + 1e-6, True), (RULE.mainly - 1e-6, False)):
        before = SimpleNamespace(rmse=2.0, excess=3.0)
        fit = SimpleNamespace(rmse=math.sqrt(4.0 - share * 3.0), before=before)
        assert selection._mainly(SimpleNamespace(fit=fit)) == mainly
    assert not selection._mainly(SimpleNamespace(fit=SimpleNamespace(rmse=1.0, before=None)))


def test_the_interval_of_an_error_is_that_of_its_chi_square():
    random = np.random.default_rng(8)
    n, widths = 8000, []
    for _ in range(30):
        rest = 0.2 * random.standard_normal(n)
        step = LearningStep(SimpleNamespace(residual=rest, rmse=float(np.sqrt(np.mean(rest**2)))))
        low, high = step.rmse_ci95
        assert low < step.rmse < high
        widths.append((high**2 - low**2) / 2.0)
    assert np.mean(widths) == pytest.approx(Z95 * 0.04 * math.sqrt(2.0 / n), rel=0.06)
