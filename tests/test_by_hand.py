"""A motion in words for a hand: what is alike is one step, and what no hand can do is said."""

from __future__ import annotations

import math

import pytest

import knobcam as kc
from knobcam.capture.by_hand import TEMPI, by_hand, hand_can, in_words, on_beats
from knobcam.capture.motion_plan import MotionPlan, Move, Rest, Waves
from knobcam.learn.limits import Limits
from knobcam.learn.motion_space import bank, plan

RAD = math.radians(1.0)


def to_and_fro(half: float, speed: float, moves: int) -> MotionPlan:
    ends = (half, -half)
    parts = [Move(half, speed, 50.0), *(Move(ends[(n + 1) % 2], speed, 50.0) for n in range(moves))]
    return MotionPlan(tuple(parts))


def test_passes_between_the_same_ends_are_one_step_with_degrees_seconds_and_beats() -> None:
    motion = to_and_fro(1.5 * RAD, 0.07, 20)
    first, second = by_hand(motion)
    one_way = motion.parts[1].seconds(1.5 * RAD)
    assert first.words.startswith("to 1.5 degrees in ")
    assert second.words.startswith("to and fro between 1.5 and -1.5 degrees, 10 times, one way in 0.75 s")
    assert second.seconds == pytest.approx(20 * one_way)
    assert second.beats_per_minute == pytest.approx(60.0 / one_way)
    assert f"{60.0 / one_way:.0f} beats a minute" in second.words
    assert hand_can([first, second])


def test_a_quick_there_and_back_is_one_beat() -> None:
    motion = to_and_fro(20.0 * RAD, 4.0, 20)
    one_way = motion.parts[1].seconds(20.0 * RAD)
    assert 0.25 < one_way < 0.5
    step = by_hand(motion)[-1]
    assert step.beats_per_minute == pytest.approx(30.0 / one_way)
    assert f"(two on a beat, {30.0 / one_way:.0f} beats a minute)" in step.words


def test_a_motion_for_a_hand_keeps_to_one_metronome_and_becomes_slower_nowhere_faster() -> None:
    limits = Limits(0.1, 6.0, 80.0, -1.0, 1.0, duration_s=9.0, sample_rate_hz=2000.0)
    for pieces in bank():
        whole = plan(pieces, limits)
        if any(isinstance(part, Waves) for part in whole.parts):
            continue
        made = on_beats(whole, 9.0)
        assert 0.0 < made.seconds <= 9.0
        assert limits.hold(made.track(2000.0))
        steps = by_hand(made)
        (tempo,) = {one.beats_per_minute for one in steps if not one.cannot} or {TEMPI[0]}
        assert tempo in TEMPI or len(made.parts) == 1
        for step in steps:
            assert 2.0 * step.seconds * tempo / 60.0 == pytest.approx(
                round(step.seconds * tempo / 30.0), abs=0.1
            )


def test_no_metronome_is_faster_or_slower_than_a_hand_can_follow() -> None:
    tempi = []
    for speed in (1.0, 4.0, 12.0, 30.0):
        limits = Limits(0.1, speed, 20.0 * speed, -1.0, 1.0, duration_s=9.0, sample_rate_hz=2000.0)
        tempi += [one.beats_per_minute for pieces in bank() for one in by_hand(plan(pieces, limits))]
    asked = [one for one in tempi if one > 0.0]
    assert len(asked) > 50
    assert min(asked) >= 40.0 and max(asked) <= 120.0 + 1e-9


def test_a_slow_pass_has_a_beat_about_every_second() -> None:
    (step,) = by_hand(MotionPlan((Move(1.0, 0.1, 50.0),)))
    assert step.seconds > 10.0 and 55.0 < step.beats_per_minute < 65.0
    assert "10 beats" in step.words


def test_stairs_with_rests_are_one_step() -> None:
    parts = [part for n in range(1, 6) for part in (Move(0.1 * n, 0.5, 20.0), Rest(0.4))]
    (step,) = by_hand(MotionPlan(tuple(parts)))
    assert step.words.startswith("in 5 steps of 5.7 degrees to 28.6, each in 0.24 s, then 0.4 s of rest (94 ")
    assert step.seconds == pytest.approx(MotionPlan(tuple(parts)).seconds)


@pytest.mark.parametrize(
    ("motion", "why"),
    [
        (MotionPlan((Waves(2.0, 0.4, 0.5, (0.1,), (0.0,)),)), "for a motor"),
        (to_and_fro(0.1 * RAD, 0.01, 8), "too small"),
        (to_and_fro(0.05, 40.0, 8), "too quick"),
    ],
)
def test_what_no_hand_can_do_is_said(motion: MotionPlan, why: str) -> None:
    steps = by_hand(motion)
    assert not hand_can(steps) and why in steps[-1].cannot
    assert in_words(steps).startswith("No hand can do all of this:\n")


def test_no_second_of_any_motion_is_left_out_of_the_words() -> None:
    limits = Limits(0.1, 6.0, 80.0, -1.0, 2.0, duration_s=9.0, sample_rate_hz=2000.0)
    for pieces in bank():
        motion = plan(pieces, limits)
        steps = by_hand(motion)
        assert sum(one.seconds for one in steps) == pytest.approx(motion.seconds, rel=1e-9)
        assert len(in_words(steps).splitlines()) <= 9


def test_a_linear_axis_is_told_in_millimetres() -> None:
    (step,) = by_hand(MotionPlan((Move(0.012, 0.01, 1.0),)), "linear")
    assert step.words.startswith("to 12 mm")


def test_the_text_of_a_motion_gives_it_back() -> None:
    motion = MotionPlan((Move(0.5, 3.0, 50.0), Rest(0.1), Waves(2.0, 0.4, 0.5, (0.1,), (0.0,))), 0.1, 'a "x"')
    assert MotionPlan.parse(motion.text()) == motion


def test_only_what_a_hand_can_make_is_designed_where_that_is_asked_for() -> None:
    knob = kc.hiding("knob4", "return_spring", motion="sweep", duration_s=3.0)
    story = kc.learn(kc.simulate(knob, "sweep", duration_s=3.0))
    rivals = ["return_spring", "unbalance"]
    designed = kc.next_experiment(story, rivals=rivals, by_hand=True, search_s=1.0)
    steps = by_hand(designed.plan)
    assert hand_can(steps) and designed.separable
    assert len({one.beats_per_minute for one in steps}) == 1
