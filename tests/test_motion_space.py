"""The motions that an experiment is chosen from: what each of their numbers does, from end to end."""

from __future__ import annotations

import math
import re
from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from knobcam.capture.motion_plan import MotionPlan, Move, Rest, Waves
from knobcam.errors import InputError
from knobcam.learn import designing
from knobcam.learn import motion_space as space
from knobcam.learn.limits import Limits
from knobcam.learn.motion_space import Piece, changed, plan, standard
from knobcam.learn.ranked import Scored, best_of
from knobcam.learn.telling import Telling, Told

LIMITS = Limits(0.1, 6.0, 80.0, -1.0, 2.0, duration_s=8.0, sample_rate_hz=1000.0)


def made(kind: str, *numbers: float, eased: float = 1.0, seconds: float = 6.0) -> tuple[list[Any], str]:
    return space._KINDS[kind](numbers, LIMITS, eased, seconds, 0.25)


def moves(parts: list[Any]) -> list[Move]:
    return [part for part in parts if isinstance(part, Move)]


@pytest.mark.parametrize("eased", [1.0, 0.5])
def test_passes_go_to_and_fro_over_their_span_at_their_speed(eased: float):
    (first, *rest), words = made("passes", 1.0, 1.0, 0.5, 1.0, 0.0, eased=eased)
    assert first == Move(-1.0, eased * 6.0, eased * 80.0)
    assert [move.to for move in rest] == [(2.0, -1.0)[at % 2] for at in range(len(rest))]
    assert {(move.speed, move.acceleration) for move in rest} == {(eased * 6.0, eased * 80.0)}
    assert words == f"to and fro over 3 rad at {eased * 6:.3g} rad/s, {-(-len(rest) // 2)} times"
    # Another one would take longer than there is.
    takes = sum(move.seconds(at.to) for at, move in zip([first, *rest], rest, strict=False))
    assert 6.0 - rest[0].seconds(-1.0) < takes + first.seconds(0.25) <= 6.0
    # The other ends: a twentieth of the way, at either end of it, a three hundredth of the speed.
    for place, low in ((0.0, -1.0), (1.0, 2.0 - 0.15)):
        (_, *small), _ = made("passes", 0.0, 1.0, place, 0.0, 0.0)
        assert sorted({round(move.to, 9) for move in small}) == pytest.approx([low, low + 0.15])
        assert small[0].acceleration == pytest.approx(0.03 * 80.0)
    (_, *slow), _ = made("passes", 1.0, 0.0, 0.5, 1.0, 0.0, eased=eased)
    speed = eased * 3e-3 * 6.0
    assert slow[0].speed == pytest.approx(speed) and len(slow) >= 2
    # So slow that it goes no farther than it comes in its time, about the middle of its span.
    assert abs(slow[0].to - slow[1].to) == pytest.approx(0.45 * speed * 6.0)
    assert slow[0].to + slow[1].to == pytest.approx(1.0)


@pytest.mark.parametrize("kind", ["passes", "speeds", "loops", "rests"])
def test_what_is_said_of_a_motion_is_the_speed_that_it_reaches_on_its_way(kind: str) -> None:
    parts, words = made(kind, 0.0, 1.0, 0.5, 0.0, 0.0)
    track = MotionPlan(tuple(parts), 0.25).track(1000.0)
    # The way to where it begins, and from place to place, is longer, and no part of what is told.
    fastest = float(np.max(np.abs(track.omega[track.t > 0.8 * track.t[-1]])))
    assert fastest < 0.5 * 6.0
    assert f"{fastest:.2g}" in {f"{float(one):.2g}" for one in re.findall(r"([\d.e-]+) rad/s", words)}, words


def test_speeds_rise_by_equal_ratios_and_no_pass_takes_more_than_its_share():
    (first, *rest), words = made("speeds", 1.0, 0.5, 0.5, 1.0, 0.25)
    assert first.to == -1.0 and "4 speeds" in words
    slowest = 6.0 * math.sqrt(3e-3 * 0.5)
    ratio = (6.0 / slowest) ** (1.0 / 3.0)
    expected = [slowest * ratio ** (at // 2 % 4) for at in range(len(rest))]
    assert [move.speed for move in rest] == pytest.approx(expected) and len(rest) > 6
    for at, move in enumerate(rest):
        way = min(3.0, move.speed * 6.0 / 8.0)
        assert move.to == pytest.approx(-1.0 + way if at % 2 == 0 else -1.0)
    counts = {
        len({round(move.speed, 9) for move in made("speeds", 0.1, 1.0, 0.5, 1.0, u)[0][1:]})
        for u in (0.0, 1.0)
    }
    assert counts == {2, 10}


def test_loops_stay_within_their_size_at_each_of_their_places():
    parts, words = made("loops", 0.5, 0.8, 0.5, 1.0, 0.0)
    size = 3.0 * math.sqrt(2e-3 * 0.5)
    places = [-1.0 + 0.5 * size + (3.0 - size) * (at + 0.5) / 4.0 for at in range(4)]
    nearest = [min(places, key=lambda place, to=move.to: abs(place - to)) for move in parts]
    assert sorted(set(nearest)) == pytest.approx(places) and "at 4 places" in words
    offsets = {round(abs(move.to - place), 9) for move, place in zip(parts, nearest, strict=True)}
    assert offsets == {0.0, round(0.5 * size, 9)}
    assert f"within {math.degrees(size):.3g} degrees" in words
    # As much time at each of them.
    counts = [nearest.count(place) for place in dict.fromkeys(nearest)]
    assert max(counts) - min(counts) <= 2
    wide, said = made("loops", 1.0, 1.0, 0.0, 1.0, 0.0)
    assert "within 1.5 rad" in said and "at one place" in said
    assert {round(move.to, 9) for move in wide} == {0.5, 1.25, -0.25}


def test_rests_climb_by_equal_steps_and_down_again():
    parts, words = made("rests", 1.0, 1.0, 0.0, 1.0, 2.0 / 9.0)
    levels = [move.to for move in moves(parts)]
    assert levels[:8] == pytest.approx([-1.0, 0.0, 1.0, 2.0, 1.0, 0.0, -1.0, 0.0])
    rests = [part for part in parts if isinstance(part, Rest)]
    assert {rest.s for rest in rests} == {0.02} and abs(len(rests) - len(levels) + 1) <= 1
    assert words.startswith(f"{len(rests)} moves at 6 rad/s with rests of 0.02 s")
    assert {part.s for part in made("rests", 1.0, 1.0, 1.0, 1.0, 0.0)[0] if isinstance(part, Rest)} == {0.5}


def test_waves_fall_off_with_their_order_and_fill_what_the_limits_leave():
    for fall in (0.0, 0.5, 1.0):
        parts, words = made("waves", 1.0, 0.5, 0.3, 0.5, fall)
        go, shape = parts
        assert go == Move(0.5, 6.0, 80.0) and isinstance(shape, Waves)
        sizes = np.hypot(shape.sine, shape.cosine)
        orders = np.arange(1, len(sizes) + 1)
        assert sizes / sizes[0] == pytest.approx(orders ** (-2.0 * fall))
        highest = math.sqrt(0.5 * 12.0)
        assert shape.fundamental_hz * len(sizes) == pytest.approx(highest, rel=0.05)
        assert shape.s == pytest.approx(6.0 - go.seconds(0.25)) and f"to {highest:.1f}"[:4] in words
        t = np.linspace(0.0, shape.s, 20_001)
        theta, omega, alpha = shape.along(t, 0.5)
        used = max(
            np.max(np.abs(theta - 0.5)) / 1.5, np.max(np.abs(omega)) / 6.0, np.max(np.abs(alpha)) / 80.0
        )
        assert used == pytest.approx(0.98, rel=0.01)
        small = made("waves", 0.0, 0.5, 0.3, 0.5, fall)[0][1]
        assert np.hypot(small.sine, small.cosine) == pytest.approx(0.2 * sizes)
    assert made("waves", 1.0, 0.5, 0.3, 0.5, 0.5, seconds=0.49) == ([], "nothing")
    # Where the way to the middle takes too much of the time, it goes about where it is.
    (about,), _ = space._waves((1.0, 0.5, 0.3, 0.5, 0.5), LIMITS, 1.0, 0.6, -0.5)
    assert isinstance(about, Waves) and about.s == 0.6 and about.swell_s == pytest.approx(0.24)
    assert np.abs(about.along(np.linspace(0.0, 0.6, 999), 0.0)[0]).max() <= 0.98 * 0.5


def test_a_plan_shares_its_time_and_words():
    pieces = (
        Piece("passes", (0.5, 1.0, 0.5, 1.0, 0.0), 0.75),
        Piece("waves", (0.5, 0.5, 0.5, 0.5, 0.5), 0.25),
    )
    both = plan(pieces, LIMITS)
    first, then = both.about.split("; then ")
    assert "to and fro" in first and "mixture" in then and both.start == 0.0
    waves = both.parts[-1]
    assert isinstance(waves, Waves) and waves.s <= 0.25 * 8.0 < both.seconds <= 8.0
    far = replace(LIMITS, theta_min_rad=0.5)
    assert plan(pieces, far).start == 0.5 and plan(pieces, replace(LIMITS, theta_max_rad=-0.5)).start == -0.5
    brief = plan((pieces[1],), replace(LIMITS, duration_s=0.3))
    assert brief.parts == (Rest(0.25),)


def test_a_move_is_never_brisker_than_a_rig_follows_nor_later_than_there_is_time():
    filling = space._Filling(0.0, 1.0)
    assert filling.put(Move(1e-3, 6.0, 1e6)) and filling.parts[0].seconds(0.0) == pytest.approx(0.06)
    assert filling.at == 1e-3 and filling.left == pytest.approx(0.94)
    assert filling.put(Rest(0.9)) and not filling.put(Rest(0.05)) and len(filling.parts) == 2
    gentle = Move(2.0, 6.0, 80.0)
    long = space._Filling(0.0, 10.0)
    assert long.put(gentle) and long.parts == [gentle]


@pytest.mark.parametrize("name", ["sweep", "turns"])
def test_a_standard_motion_is_as_large_as_one_of_the_limits_lets_it_be(name: str):
    for eased in (1.0, 0.4):
        track = standard(name, LIMITS, 500.0, eased)
        theta = 0.5 * (track.theta.min() + track.theta.max())
        used = [
            np.ptp(track.theta) / 3.0,
            np.max(np.abs(track.omega)) / 6.0,
            np.max(np.abs(track.alpha)) / 80.0,
        ]
        assert max(used) == pytest.approx(eased, rel=1e-6) and theta == pytest.approx(0.5)
        assert LIMITS.hold(track)


def test_a_motion_not_far_from_another_has_numbers_between_nought_and_one():
    assert space._folded(np.array([-0.2, 0.4, 1.3, 2.5, -1.3])) == pytest.approx([0.2, 0.4, 0.7, 0.5, 0.7])
    assert (space._between(2.0, 8.0, 0.0), space._between(2.0, 8.0, 0.5), space._between(2.0, 8.0, 1.0)) == (
        2,
        4,
        8,
    )
    rng = np.random.default_rng(1)
    pieces = (Piece("loops", (0.1, 0.9, 0.5, 0.5, 0.5), 0.5),)
    lengths = []
    for _ in range(400):
        after = changed(pieces, rng, 0.3)
        lengths.append(len(after) - len(pieces))
        pieces = after
        assert 1 <= len(pieces) <= 3
        for piece in pieces:
            assert all(0.0 <= one <= 1.0 for one in piece.numbers) and 0.1 <= piece.share <= 1.0
            assert len(piece.numbers) == space.COUNT and piece.kind in space._KINDS
    assert {-1, 0, 1} == set(lengths) and lengths.count(0) > 250
    # Not far: nothing moves by more than it is asked to.
    near = changed((Piece("loops", (0.5,) * 5, 0.5),), np.random.default_rng(4), 1e-6)
    if len(near) == 1:
        assert near[0].numbers == pytest.approx((0.5,) * 5, abs=1e-4) and near[0].share == pytest.approx(
            0.5, rel=1e-4
        )


def rival(
    effects: tuple[str, ...], free: int, rmse: float = 1.0, floor: float = 0.5, white: float = 50.0
) -> Any:
    prepared = (SimpleNamespace(core=SimpleNamespace(used=200)),)
    core = SimpleNamespace(free=list(range(free)))
    fit = SimpleNamespace(core=core, rmse=rmse, noise_floor=floor, white_squares=white, prepared=prepared)
    fit.model = SimpleNamespace(effects=effects, coordinate="rotary")
    return SimpleNamespace(effects=effects, fit=fit)


def test_a_pair_is_told_apart_as_well_as_the_worse_way_but_for_what_contains_the_other():
    d = np.array([[0.0, 9.0, 0.5], [4.0, 0.0, 20.0], [30.0, 7.0, 0.0]])
    told = Told(d, np.zeros(3))
    apart = Telling((rival(("offset",), 4), rival(("stribeck",), 4), rival(("offset", "stribeck"), 5)))
    apart.__dict__["leads"] = np.full((3, 3), math.nan)  # of captures that tell them
    assert apart.between(told, 0, 1) == 4.0 == apart.between(told, 1, 0)
    # The third contains both others: where one of these is right the plainer is chosen anyhow.
    assert apart.between(told, 0, 2) == 30.0 and apart.between(told, 1, 2) == 7.0
    assert apart.least(told) == 4.0
    # One with more parameters that imitates another: less than a tenth of what it takes the other way.
    rich = Telling((rival(("offset",), 4), rival(("stribeck",), 4), rival(("unbalance",), 5)))
    rich.__dict__["leads"] = np.full((3, 3), math.nan)
    assert rich.between(told, 0, 2) == 30.0 and rich.between(told, 1, 2) == 7.0
    d[0, 2] = 3.1
    assert rich.between(told, 0, 2) == 3.1


def test_the_noise_is_that_of_the_rival_that_leaves_least():
    # 200 samples of a floor of 0.5, which are 50 variances of white noise.
    loud = rival(("offset",), 4, rmse=3.0, floor=2.0)
    assert Telling((loud, rival(("stribeck",), 4))).white == pytest.approx(0.25 * 200 / 50)
    assert Telling((rival((), 4, floor=math.nan),)).white == pytest.approx(1.0 * 200 / 50)
    assert Telling((rival((), 4, white=0.0),)).white == pytest.approx(0.25)


def test_motions_of_a_slide_are_told_in_metres_and_one_move_is_no_plural():
    slide = replace(LIMITS, coordinate="linear")
    assert slide.unit == "m" and slide.with_some({"torque_Nm": 1.0}).unit == "m"
    numbers = (0.5, 0.5, 0.5, 0.5, 0.5)
    told = [space._KINDS[kind](numbers, slide, 1.0, 6.0, 0.25)[1] for kind in space._KINDS]
    assert not any("rad" in words or "degrees" in words for words in told)
    assert sum(" m/s" in words for words in told) >= 4
    with pytest.raises(InputError, match="coordinate: is no limit"):
        slide.with_some({"coordinate": "linear"})
    _, words = made("rests", 0.2, 0.2, 0.5, 0.2, 0.0)
    assert words == "one move at 0.0575 rad/s"


def test_the_motion_is_the_one_that_refits_say_most_of_whichever_the_line_had_first(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    pool = [(Piece(kind, (0.5,) * 5, 1.0),) for kind in ("passes", "loops", "rests")]
    motions = [plan(pieces, LIMITS) for pieces in pool]
    pairs = [(one, one.track(1000.0)) for one in motions]
    monkeypatch.setattr(designing._Design, "_runnable", lambda _, one, *, draws: pairs[pool.index(one)])
    asked: list[int] = []

    def chosen(*each: float, over: bool = False) -> int:
        asked.clear()
        tells = {len(track.t): d for (_, track), d in zip(pairs, each, strict=True)}
        assert len(tells) == len(pairs)

        def refitted(track: Any, over: Any) -> Told:
            asked.append(len(track.t))
            return Told(np.full((2, 2), tells[len(track.t)]), np.zeros(2))

        asks: Any = SimpleNamespace(rivals=(0, 1), refitted=refitted)
        asks.pairs = lambda told: [float(told.d[1, 0])]
        asks.least = lambda told: float(told.d[1, 0])
        known = designing._Design(asks, LIMITS, None)._rated(pool, lambda: over)
        best = max(known, key=lambda one: one.worth)
        assert best.told.d[1, 0] == best.least == each[motions.index(best.motion)]
        return motions.index(best.motion)

    assert chosen(3.0, 20.0, 12.0) == 1 and len(asked) == 3
    assert chosen(3.0, 20.0, 12.0, over=True) == 0 and len(asked) == 1, "there is no time for others"
    assert chosen(50.0, 60.0, 70.0) == 0 and len(asked) == 1, "one that tells enough ends it"


def test_of_motions_that_are_looked_at_last_no_two_are_of_one_kind() -> None:
    def scored(score: float, *kinds: str) -> Any:
        return Scored(score, 0.0, 0.0, tuple(Piece(kind, (score,) * 5, 1.0) for kind in kinds))

    every = [scored(4.0, "waves"), scored(5.0, "loops"), scored(6.0, "loops"), scored(3.0, "loops", "waves")]
    assert [one[0].numbers[0] for one in best_of(every)] == [6.0, 4.0, 3.0]
