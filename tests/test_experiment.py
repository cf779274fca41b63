"""The next experiment: motions from rest to rest within limits, and what they tell of rivals."""

from __future__ import annotations

import dataclasses
import math
import sys
import time
from functools import partial
from pathlib import Path

import numpy as np
import pytest
from command import knobcam, refused

import knobcam as kc
from knobcam.capture.motion_plan import MotionPlan, Move, Rest, Waves
from knobcam.learn import designing
from knobcam.learn.designing import design
from knobcam.learn.limits import Limits
from knobcam.learn.motion_space import bank, changed, plan
from knobcam.learn.telling import Rival, Telling, wrong_choice

LIMITS = Limits(0.1, 6.0, 80.0, -1.0, 2.0, duration_s=4.0, sample_rate_hz=2000.0)

QUICK = {"duration_s": 4.0, "sample_rate_hz": 1000.0}
"""Where no motion is possible, all are tried at every size: as well short ones, of few samples."""


def test_every_motion_begins_and_ends_at_rest_and_keeps_to_the_limits() -> None:
    rng = np.random.default_rng(5)
    motions = bank()
    motions += [changed(motions[int(rng.integers(len(motions)))], rng, 0.4) for _ in range(60)]
    for pieces in motions:
        track = plan(pieces, LIMITS).track(LIMITS.sample_rate_hz)
        assert LIMITS.hold(track), pieces
        step = 1.0 / LIMITS.sample_rate_hz
        assert abs(track.omega[0]) <= 1.01 * LIMITS.alpha_rad_s2 * step and track.omega[-1] == 0.0
        # Speed and acceleration are those of the angle: what is left is the rule's, of second order.
        np.testing.assert_allclose(np.gradient(track.theta, step), track.omega, atol=1.5 * 80.0 * step)


def test_a_move_is_exact() -> None:
    move = Move(0.7, 3.0, 40.0)
    seconds = move.seconds(-0.2)
    t = np.linspace(0.0, seconds, 20_001)
    theta, omega, alpha = move.along(t, -0.2)
    assert (theta[0], omega[0], omega[-1]) == (-0.2, 0.0, 0.0) and theta[-1] == pytest.approx(0.7)
    assert omega.max() == pytest.approx(3.0) and np.abs(alpha).max() == pytest.approx(40.0)
    np.testing.assert_allclose(np.gradient(theta, t)[1:-1], omega[1:-1], atol=1e-5)
    np.testing.assert_allclose(np.cumsum(alpha) * (t[1] - t[0]), omega, atol=1e-2)
    # Too short to gain that speed: it takes as long as its acceleration makes it.
    short = Move(1e-4, 3.0, 40.0)
    assert short.along(np.linspace(0.0, short.seconds(0.0), 99), 0.0)[1].max() < 0.06


def test_a_motion_file_gives_the_motion_back_to_the_last_bit(tmp_path: Path) -> None:
    made = MotionPlan(
        (Move(0.5, 3.0, 50.0), Rest(0.1), Waves(2.0, 0.4, 0.5, (0.1, 0.05), (0.0, 0.02))), 0.1, 'a "test"'
    )
    path = made.save(tmp_path / "m.toml")
    read = kc.motion(str(path), rate_hz=5000.0)
    for one, other in zip(read, made.track(5000.0), strict=True):
        assert (one == other).all()
    capture = kc.simulate("knob3", str(path), noise="none")
    assert capture.samples == len(read.t) and capture.theta[-1] == pytest.approx(0.5, abs=1e-5)


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("x = [", "is no motion file"),
        ("schema = 'other/1'", "has no schema"),
        ("schema = 'knobcam.motion/1'", "neither [[parts]] nor theta"),
        ("schema = 'knobcam.motion/1'\nparts = [{ jump = 3 }]", "part 1 is none"),
        ("schema = 'knobcam.motion/1'\nparts = [{ rest = { s = -1.0 } }]", "give a number above 0"),
        ("schema = 'knobcam.motion/1'\nparts = [{ rest = { s = nan } }]", "give a number"),
        ("schema = 'knobcam.motion/1'\nparts = [{ rest = { s = 1e9 } }]", "at most 600 s"),
        (
            "schema = 'knobcam.motion/1'\nsample_rate_hz = 5000.0\ntheta = [0.0, 0.0, 0.0, 1.0, 1.0, 1.0]",
            "theta jumps near row 3",
        ),
        ("schema = 'knobcam.motion/1'\nsample_rate_hz = 100.0\ntheta = [0, 0, 0, 0, 0]", "of 100 Hz"),
    ],
)
def test_a_file_that_is_no_motion_is_refused_in_one_line(tmp_path: Path, text: str, said: str) -> None:
    path = tmp_path / "m.toml"
    path.write_text(text, "utf-8")
    with pytest.raises(kc.InputError, match=r".") as refusal:
        kc.simulate("knob3", str(path))
    assert said in str(refusal.value) and "\n" not in str(refusal.value)


def test_who_stops_after_the_first_few_motions_has_seen_every_kind() -> None:
    kinds = [tuple(piece.kind for piece in pieces) for pieces in bank()]
    first = kinds[: len(set(kinds)) - 2]
    assert {one for one in kinds if len(one) == 1} < set(first) and any(len(one) == 2 for one in first)
    assert len({repr(pieces) for pieces in bank()}) == len(kinds)


def test_five_and_one_of_a_hundred_are_wrong_where_d_is_so_large() -> None:
    assert wrong_choice(0.0) == 0.5
    assert wrong_choice(10.8) == pytest.approx(0.05, rel=0.01)
    assert wrong_choice(21.6) == pytest.approx(0.01, rel=0.01)


@pytest.fixture(scope="module")
def weak() -> kc.LearningResult:
    """A Stribeck effect too weak for the sweep that it was recorded on."""
    knob = kc.Model.load("knob4").with_effect("stribeck")
    knob = knob.with_value("stribeck.rise", 0.004).with_value("stribeck.vs", 0.3)
    return kc.learn(kc.simulate(knob, "sweep", seed=4, duration_s=2.0))


def test_a_rival_that_no_torque_there_is_could_turn_is_left_out_and_said_to_be(
    weak: kc.LearningResult,
) -> None:
    (capture,) = weak.captures
    heavy = Rival(("offset",), kc.fit(dataclasses.replace(capture, tau=1000.0 * capture.tau)))
    others = (Rival((), weak.ladder[0].fit), Rival(("stribeck",), weak.ladder[0].fit.add("stribeck")))
    limits = dataclasses.replace(Limits.reached(weak.fit.prepared), **QUICK)
    found = design((*others, heavy), limits, search_s=0.2)
    assert found.rivals == others and found.left_out == (heavy,)
    assert found.headline.endswith(
        "offset: left out, as on any motion within these limits it asks for more torque than there is."
    )
    assert found.document()["left_out"] == [["offset"]]
    with pytest.raises(kc.InputError, match="moves no rival"):
        design((others[0], heavy), limits, search_s=0.2)


def test_what_is_expected_comes_true_on_the_motion_that_is_designed(weak: kc.LearningResult) -> None:
    designed = kc.next_experiment(weak, rivals=["base", "stribeck"], search_s=1.5)
    (expected,) = designed.expected
    told = Telling(designed.rivals).evidence(designed.track).d[1, 0]
    # The knob of the rival, recorded on the motion, without noise: what the base model then leaves.
    right = designed.rivals[1].fit.model
    second = kc.simulate(right, designed.track, noise="none")
    base = designed.rivals[0].fit
    both = kc.fit([weak.captures[0], second], base.model)
    white = base.noise_floor**2 * base.prepared[0].core.used / base.white_squares
    squares = [fit.rmse**2 * sum(one.core.used for one in fit.prepared) / white for fit in (both, base)]
    assert squares[0] - squares[1] == pytest.approx(told, rel=0.1)
    assert expected.pair == (0, 1) and expected.d > 0.0 and expected.standard_d > 0.0


def test_fewer_samples_that_count_as_more_tell_what_more_samples_do(weak: kc.LearningResult) -> None:
    limits = Limits.reached(weak.fit.prepared)
    rivals = (Rival((), weak.ladder[0].fit), Rival(("stribeck",), weak.ladder[0].fit.add("stribeck")))
    told, alone = Telling(rivals), Telling(rivals[1:])
    for pieces in bank()[::5]:
        made = plan(pieces, limits)
        full, thinned = (made.track(rate) for rate in (5000.0, 1250.0))
        if np.abs(full.omega).max() > 0.05:
            whole = told.evidence(full).d
            assert told.evidence(thinned, 5000.0).d == pytest.approx(whole, rel=0.25, abs=0.5), made.about
            few = alone.errors(thinned, 5000.0)
            assert few == pytest.approx(alone.errors(full), rel=0.2), made.about


def test_the_same_seed_gives_the_same_motion_however_slow_the_machine(
    weak: kc.LearningResult, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(designing, "_TRIES", 20)
    rivals = {"rivals": ["base", "stribeck"], "limits": LIMITS}
    quick = kc.next_experiment(weak, **rivals)
    looked: list[int] = []
    slow = kc.next_experiment(weak, **rivals, between=lambda: (looked.append(1), time.sleep(0.005)))
    assert slow.plan == quick.plan and slow.took_s > 0.005 * len(looked) > 0.1
    # And one that tells plenty ends a search at once.
    for plenty, weighed in ((1e9, len(bank()) + 20), (0.0, len(bank()))):
        looked.clear()
        monkeypatch.setattr(designing, "ENOUGH", plenty)
        monkeypatch.setattr(designing, "_PLENTY", plenty)
        kc.next_experiment(weak, **rivals, between=partial(looked.append, 1))
        assert len(looked) == weighed


def test_no_rival_asks_for_more_than_the_limits(weak: kc.LearningResult) -> None:
    limits = Limits(0.2, 3.0, 40.0, -0.3, 0.4, duration_s=3.0, sample_rate_hz=1000.0)
    designed = kc.next_experiment(weak, rivals=["base", "stribeck"], limits=limits, search_s=1.0)
    assert limits.hold(designed.track)
    for rival in designed.rivals:
        asked = kc.simulate(rival.fit.model, designed.track, noise="none")
        assert np.abs(asked.tau).max() <= limits.torque_Nm
    assert designed.peak[0] <= limits.torque_Nm
    with pytest.raises(kc.InputError, match="torque_Nm"):
        tiny = dataclasses.replace(limits, torque_Nm=1e-6)
        kc.next_experiment(weak, rivals=["base", "stribeck"], limits=tiny, search_s=1.0)


def test_a_parameter_is_known_better_after_the_motion_made_for_it(weak: kc.LearningResult) -> None:
    designed = kc.next_experiment(weak, sharpen="inertia.M", search_s=1.0)
    (one,) = designed.sharpened
    assert not designed.untied
    assert one.after < one.after_standard < one.before
    assert designed.plot().axes[-1].get_xlabel() == "standard error of inertia.M (N m s^2/rad)"
    second = kc.simulate(weak.model, designed.track, seed=9)
    both = kc.fit([weak.captures[0], second], weak.model)
    assert both.params["inertia.M"].se == pytest.approx(one.after, rel=0.3)
    with pytest.raises(kc.InputError, match="no parameter that was fitted"):
        kc.next_experiment(weak, sharpen="inertia.X", search_s=1.0)


def test_the_command_prints_the_document_and_writes_the_motion(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(designing, "next_experiment", partial(kc.next_experiment, search_s=0.5))
    capture, motion = tmp_path / "c.npz", tmp_path / "m.toml"
    knobcam("simulate", "knob3", "--duration", "2", "--rate", "1000", "-o", capture)
    limits = tmp_path / "l.toml"
    limits.write_text("duration_s = 2.0\nomega_rad_s = 5.0\n", "utf-8")
    document = knobcam(
        *("next", capture, "--rivals", "base,stribeck", "--limits", limits),
        *("-o", motion, "--plots", tmp_path / "p", "--json"),
    ).document
    assert document["schema"] == "knobcam.next/1" and document["rivals"] == [[], ["stribeck"]]
    (expected,) = document["expected"]
    assert expected["pair"] == [0, 1]
    assert expected["wrong_choice"] == pytest.approx(0.5 * math.erfc(math.sqrt(expected["D"] / 8.0)))
    assert document["separable"] == (expected["D"] >= 10.8)
    theta = np.array(document["motion"]["theta"])
    assert len(theta) <= 2.0 * document["motion"]["sample_rate_hz"]
    assert np.abs(np.gradient(theta)).max() * 1000.0 <= 5.0
    assert document["peak"]["omega_rad_s"] <= 5.0
    hand = document["by_hand"]
    assert sum(step["seconds"] for step in hand["steps"]) == pytest.approx(len(theta) / 1000.0, abs=2e-3)
    tempi = {step["beats_per_minute"] for step in hand["steps"]} - {0.0, None}
    cannot = any(step["cannot"] for step in hand["steps"])
    assert hand["possible"] == (not cannot and len(hand["steps"]) <= 12 and len(tempi) <= 1)
    assert (tmp_path / "p" / "experiment.png").stat().st_size > 10_000
    again = knobcam(
        "simulate", "knob3", "--motion", motion, "--rate", "1000", "-o", tmp_path / "d.npz", "--json"
    ).document
    assert again["capture"]["samples"] == len(theta)


def test_a_parameter_that_there_is_none_of_is_said_before_anything_is_learned(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    capture = tmp_path / "c.npz"
    knobcam("simulate", "knob3", "--duration", "1", "-o", capture)
    monkeypatch.setattr(sys.modules["knobcam.learn"], "learn", None)
    for name in ("spring.k", "stribeck.speed", "inertia"):
        refused(knobcam("next", capture, "--sharpen", name), "is no parameter")


@pytest.mark.parametrize(
    ("words", "limits", "said"),
    [
        (("--rivals", "stribeck"), "", "are not two"),
        (("--rivals", "stribeck,nothing"), "", "nothing"),
        (("--rivals", "stribeck,"), "", "between commas"),
        (("--rivals", "detent,base"), "", "part of the base model"),
        (("--rivals", "base,stribeck", "--sharpen", "inertia.M"), "", "leave one out"),
        (("--sharpen", "spring.k"), "", "sharpen='spring.k': is no parameter; write one as inertia.M"),
        (("--sharpen", "stribeck.v"), "", "is no parameter of stribeck; it has stribeck.rise, stribeck.vs"),
        (("--sharpen", "stribeck.vs"), "", "sharpen='stribeck.vs': is no parameter that was fitted"),
        ((), "torque = 1.0", "is no limit"),
        ((), "[parameters]", "parameters: is a table of what a batch judges parts by, and no limit"),
        ((), "torque_Nm = nan", "give a number above 0"),
        ((), 'schema = "knobcam.motion/1"\nstart = 0.0', "itself knobcam.motion/1, which is no file"),
        ((), "duration_s = 600.0\nsample_rate_hz = 1e6", "600 s at 1e+06 Hz are 6e+08 samples"),
        (
            ("--rivals", "stribeck+end_stop,base"),
            "duration_s = 4.0",
            "rivals: stribeck + end_stop: motion: is none that the model can follow",
        ),
        ((), "theta_min_rad = 3.0\ntheta_max_rad = 2.0", "nothing could move"),
    ],
)
def test_wrong_calls_end_in_one_line(tmp_path: Path, words: tuple[str, ...], limits: str, said: str) -> None:
    capture = tmp_path / "c.npz"
    knobcam("simulate", "knob3", "--duration", "1", "-o", capture)
    file = tmp_path / "l.toml"
    file.write_text(limits, "utf-8")
    more = ("--limits", file) if limits else ()
    refused(knobcam("next", capture, *words, *more), said)


@pytest.mark.parametrize(
    ("narrow", "said"),
    [
        ({"torque_Nm": 1e-6}, "limits, torque_Nm: 1e-06 moves no rival, the gentlest motion takes 0.0"),
        ({"duration_s": 0.01}, "limits, duration_s: 0.01 is too short for any motion"),
    ],
)
def test_of_limits_that_no_motion_keeps_the_one_that_is_at_fault_is_named(
    weak: kc.LearningResult, narrow: dict[str, float], said: str
) -> None:
    limits = dataclasses.replace(Limits.reached(weak.fit.prepared), **QUICK | narrow)
    with pytest.raises(kc.InputError, match=r".") as refusal:
        kc.next_experiment(weak, rivals=["base", "stribeck"], limits=limits)
    assert str(refusal.value).startswith(said)


def test_of_a_slide_what_is_too_short_is_said_in_its_own_unit(weak: kc.LearningResult) -> None:
    slide = dataclasses.replace(Limits.reached(weak.fit.prepared), duration_s=0.01, coordinate="linear")
    with pytest.raises(kc.InputError, match=r"too short for any motion at [\d.]+ m/s; give more"):
        design((Rival((), weak.fit),), slide)


def test_of_a_rival_that_runs_away_that_is_said_and_no_limit_is_blamed_for_it(
    weak: kc.LearningResult,
) -> None:
    # A shaft so soft and light that it swings faster than the samples of a search tell.
    values = {"compliance.k": 4.38, "compliance.d": 1e-9, "compliance.share": 0.04, "inertia.M": 2e-6}
    soft = kc.Model.load("knob4").with_effect("compliance")
    for name, value in values.items():
        soft = soft.with_value(name, value).with_fixed(name)
    lost = Rival(("compliance",), kc.fit(weak.captures, soft))
    limits = dataclasses.replace(Limits.reached(weak.fit.prepared), duration_s=4.0, sample_rate_hz=500.0)
    assert Telling((lost,)).peak(kc.motion("sweep", 4.0, 500.0), draws=False) == math.inf
    with pytest.raises(
        kc.InputError, match=r"^rivals: compliance: motion: is none that the model can follow"
    ):
        design((Rival((), weak.ladder[0].fit), lost), limits)


def test_a_call_that_is_wrong_is_refused_before_anything_is_learned(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def learn(*_: object, **__: object) -> None:
        raise AssertionError("learned first")

    monkeypatch.setattr(sys.modules["knobcam.learn"], "learn", learn)
    limits = tmp_path / "rig.toml"
    limits.write_text("torque = 0.1", "utf-8")
    kc.simulate("knob4", duration_s=1.0).save(tmp_path / "a.npz")
    refused(knobcam("next", tmp_path / "a.npz", "--limits", limits), "torque: is no limit")
    refused(knobcam("next", tmp_path / "a.npz", "--rivals", "base,stribek"), "stribek")
    refused(knobcam("next", tmp_path / "a.npz", "--rivals", "base"), "are not two")
