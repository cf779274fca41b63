"""`knobcam render`: stability first, then the loop, its figures and its pictures."""

from __future__ import annotations

from pathlib import Path

import pytest
from command import knobcam, refused

import knobcam as kc

VIRTUAL = ("--time", "virtual", "--seconds", "1")


def test_render_says_what_the_delay_allows_and_what_the_loop_reached() -> None:
    ended = knobcam("render", "knob4", *VIRTUAL)
    assert ended.code == 0 and ended.err == ""
    assert ended.out.index("It does not ring") < ended.out.index("5000 steps at 5000 Hz, 0 periods missed")
    assert "the hand's work on the handle" in ended.out


def test_render_hands_over_one_document() -> None:
    document = knobcam("render", "knob4", *VIRTUAL, "--delay", "3", "--rate", "2500", "--json").document
    assert document["schema"] == "knobcam.render/1"
    assert document["on"]["kind"] == "emulated" and document["on"]["delay_samples"] == 3
    assert document["stability"]["stable"] is True
    assert document["stability"]["delay_s"] == pytest.approx(3.5 / 2500.0)
    assert document["loop"]["steps"] == 2500 and document["loop"]["ending"] == "time"
    assert document["work_J"] > 0.0


def test_render_draws_timing_torque_and_stability(tmp_path: Path) -> None:
    plots = tmp_path / "plots"
    document = knobcam("render", "knob4", *VIRTUAL, "--plots", plots, "--json").document
    names = ["timing.png", "felt.png", "stability.png"]
    assert document["files"]["pictures"] == [str(plots / name) for name in names]
    assert all((plots / name).read_bytes().startswith(b"\x89PNG") for name in names)


def test_render_warns_of_a_model_that_rings(tmp_path: Path) -> None:
    stiff = kc.Model.load("knob4").with_value("detent.A", 3.0).save(tmp_path / "stiff.toml")
    ended = knobcam("render", stiff, *VIRTUAL, "--delay", "10", "--json")
    assert ended.document["stability"]["stable"] is False
    assert "warning: It rings" in ended.err


def test_render_refuses_what_it_cannot_do_in_one_line(tmp_path: Path) -> None:
    refused(knobcam("render", "knob9"), "knob9")
    refused(knobcam("render", "knob4", "--seconds", "0"), "seconds")
    refused(knobcam("render", "knob4", "--rate", "0"), "rate")
    refused(knobcam("render", "knob4", "--delay", "-1"), "--delay")
    refused(knobcam("render", "knob4", "--rt", "always"), "--rt")
    refused(knobcam("render", "knob4", "--time", "virtual", "--rt", "enforce"), "--rt enforce")
    refused(knobcam("render", "knob4", "--plots", tmp_path / "none" / "plots"), "make it first")
