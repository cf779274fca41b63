"""The loop on an emulated rig: record, learn, design, record again."""

from __future__ import annotations

import dataclasses
from pathlib import Path
from typing import Any

import pytest
from command import knobcam, refused
from small import COUPLINGS

import knobcam as kc
from knobcam.capture.motion_plan import MotionPlan
from knobcam.learn.contenders import contenders
from knobcam.learn.designing import design
from knobcam.learn.limits import Limits
from knobcam.learn.telling import Rival
from knobcam.rig import experiments as experiments_module
from knobcam.rig.emulator import EmulatedRig
from knobcam.rig.experiments import experiments
from knobcam.rig.figures import Figures


@pytest.fixture(autouse=True)
def _short(monkeypatch: pytest.MonkeyPatch) -> None:
    """Motions of five seconds, for which three are searched at most: a busy machine too gets to the best."""

    def designed(rivals: tuple[Rival, ...], limits: Limits) -> kc.Experiment:
        return design(rivals, dataclasses.replace(limits, duration_s=5.0), search_s=3.0)

    monkeypatch.setattr(experiments_module, "design", designed)


@pytest.fixture(scope="module")
def sprung_knob() -> kc.Model:
    """A spring so weak that a short sweep cannot tell it from something else."""
    return kc.Model.load("knob4").with_effect("return_spring").with_value("return_spring.k", 0.002)


def test_what_one_motion_left_tied_is_parted_by_the_next(
    sprung_knob: kc.Model, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    stories: list[kc.LearningResult] = []

    def learn(*captures: Any, **how: Any) -> kc.LearningResult:
        stories.append(kc.learn(*captures, **how))
        return stories[-1]

    monkeypatch.setattr(experiments_module, "learn", learn)
    with EmulatedRig(sprung_knob, speed=8.0) as rig:
        done = experiments(rig.port, 1, tmp_path, duration_s=3.0, without=COUPLINGS)
    tied = {one.name for one in contenders(stories[0], ())}
    assert len(stories) == 2 and done.learned is stories[1]
    assert len(tied) > 1 and "return_spring" in tied
    assert len(done.logs) == 2 and len(done.designed) == 1
    assert done.learned.found == ("return_spring",) and not contenders(done.learned, ())
    assert {rival.name for rival in done.designed[0].rivals} == tied and done.designed[0].separable
    # The second recording kept to what the first had reached.
    second, limits = kc.load(done.logs[1]), done.designed[0].limits
    assert abs(second.tau).max() < limits.torque_Nm + 5.0 * 1.8e-3
    assert limits.theta_min_rad - 1e-3 < second.theta.min() < second.theta.max() < limits.theta_max_rad + 1e-3
    document = done.document()
    assert document["schema"] == "knobcam.learn/1" and document["recordings"] == [
        str(log) for log in done.logs
    ]
    assert document["experiments"][0]["schema"] == "knobcam.next/1"


def test_a_knob_that_hides_nothing_is_recorded_once(tmp_path: Path) -> None:
    with EmulatedRig("knob4", speed=8.0) as rig:
        ended = knobcam(
            *("learn", "--port", rig.port, "--experiments", "2", "--records", tmp_path / "logs", "--json")
        )
    assert ended.code == 0, ended.err
    document = ended.document
    assert document["verdict"] == "complete" and document["experiments"] == []
    assert document["recordings"] == [str(tmp_path / "logs" / "experiment-0.kcwire")]
    assert document["ended"].startswith("nothing is left")


def test_of_a_rig_that_stops_half_way_what_came_is_used_and_said(
    sprung_knob: kc.Model, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def pulled(figures: Figures) -> None:
        if figures.received > 20_000:
            raise kc.InputError("the cable is out")

    def cut(port: str, motion: object, **options: Any) -> kc.Capture:
        more = {"progress": pulled} if isinstance(motion, MotionPlan) else {}
        return whole(port, motion, **options, **more)

    whole = experiments_module.record
    monkeypatch.setattr(experiments_module, "record", cut)
    with EmulatedRig(sprung_knob, speed=8.0) as rig:
        done = experiments(rig.port, 3, tmp_path, duration_s=3.0, without=COUPLINGS)
    assert len(done.logs) == 2 and len(done.designed) == 1
    assert done.ended.startswith("the cable is out; ") and str(done.logs[1]) in done.ended
    assert len(done.learned.captures) == 2 and 4.0 < done.learned.captures[1].duration_s < 8.0
    assert done.learned.found == ("return_spring",)
    assert done.ended in repr(done) and done.document()["ended"] == done.ended


@pytest.fixture
def held(tmp_path: Path) -> Path:
    """Limits narrower than the sweep that a first recording makes."""
    path = tmp_path / "rig.toml"
    path.write_text("omega_rad_s = 1.0\ntheta_min_rad = -0.3\ntheta_max_rad = 0.5\n", "utf-8")
    return path


def test_the_first_recording_is_made_smaller_where_limits_ask_for_that(tmp_path: Path, held: Path) -> None:
    with EmulatedRig("knob4", speed=8.0) as rig:
        done = experiments(rig.port, 1, tmp_path / "logs", duration_s=3.0, limits=held, without=COUPLINGS)
    first = kc.load(done.logs[0])
    assert -0.31 < first.theta.min() < -0.2 and 0.2 < first.theta.max() < 0.51
    assert abs(first.omega).max() < 1.05


def test_limits_that_are_none_are_refused_before_anything_moves(tmp_path: Path, held: Path) -> None:
    held.write_text("torque = 0.1\n", "utf-8")
    with EmulatedRig("knob4", speed=8.0) as rig:
        words = ("learn", "--port", rig.port, "--records", tmp_path / "logs", "--limits")
        refused(knobcam(*words, held), "torque: is no limit")
        refused(knobcam(*words, tmp_path / "absent.toml"), "cannot be read")
        held.write_text("theta_min_rad = 0.2\ntheta_max_rad = 0.5\n", "utf-8")
        refused(knobcam(*words, held), "turn it by +0.35 rad (+20 degrees)")
    assert not [*(tmp_path / "logs").iterdir()]


def test_where_no_motion_is_within_limits_what_came_is_learned_and_that_is_said(
    sprung_knob: kc.Model, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def none(rivals: tuple[Rival, ...], limits: Limits) -> kc.Experiment:
        return design(rivals, dataclasses.replace(limits, torque_Nm=1e-6, duration_s=2.0))

    monkeypatch.setattr(experiments_module, "design", none)
    with EmulatedRig(sprung_knob, speed=8.0) as rig:
        done = experiments(rig.port, 2, tmp_path, duration_s=3.0, without=COUPLINGS)
    assert done.learned.found == ("return_spring",) and len(done.logs) == 1
    assert "torque_Nm: 1e-06 moves no rival" in done.ended


@pytest.mark.parametrize(
    ("words", "said"),
    [
        ((), "one of both"),
        (("--experiments", "2"), "--experiments"),
        (("--port", "nowhere", "--experiments", "0"), "give a number from 1"),
        (("--port", "nowhere"), "nowhere"),
    ],
)
def test_wrong_calls_end_in_one_line(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, words: tuple[str, ...], said: str
) -> None:
    monkeypatch.chdir(tmp_path)
    refused(knobcam("learn", *words), said)
