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


def test_render_refuses_a_model_that_rings_unless_it_is_forced(tmp_path: Path) -> None:
    stiff = kc.Model.load("knob4").with_value("detent.A", 0.3).save(tmp_path / "stiff.toml")
    words = ("render", stiff, *VIRTUAL, "--delay", "10", "--json")
    refused(knobcam(*words), "stiff.toml", "rings", "--force")
    ended = knobcam(*words, "--force")
    assert ended.document["stability"]["stable"] is False
    assert "warning: It rings" in ended.err


@pytest.mark.parametrize(
    ("term", "value"),
    [("return_spring.k", -5.0), ("inertia.M", -5e-5), ("coulomb.pos", -0.003), ("viscous.neg", -0.002)],
)
def test_render_refuses_a_model_that_feeds_the_hand_by_its_term(
    term: str, value: float, tmp_path: Path
) -> None:
    model = kc.Model.load("knob4")
    if term.startswith("return_spring"):
        model = model.with_effect("return_spring")
    wrong = model.with_value(term, value)
    path = wrong.save(tmp_path / "wrong.toml")
    refused(knobcam("render", path, *VIRTUAL), "wrong.toml", f"{term}: is -", "correct it, or force it")
    with pytest.raises(kc.InputError, match=term):
        kc.Renderer(wrong)
    found = kc.check_stability(wrong)
    assert not found.passive and found.objection is not None and term in found.objection
    assert term in repr(found) and "feeds the hand" in found._repr_html_()


def test_a_forced_model_lets_go_when_it_has_given_out_what_its_tank_holds(tmp_path: Path) -> None:
    model = kc.Model.load("knob4").with_effect("return_spring").with_value("return_spring.k", -5.0)
    refused(
        knobcam("render", model.save(tmp_path / "a.toml"), *VIRTUAL, "--force"), "let go after", "0.1 J more"
    )
    knob = kc.Renderer(model, force=True)
    theta = 0.0
    while knob.fault is None and theta < 1.0:
        knob.step(theta, 1.0)
        theta += 1.0 / 5000.0
    assert knob.fault is not None and 0.15 < theta < 0.3  # 0.1 J = 5 N m/rad theta^2/2
    state = knob.state
    assert state["tank_J"] <= 0.0
    knob.reset()
    knob.set_state({name: value for name, value in knob.state.items() if name != "tank_J"})
    assert knob.state["tank_J"] == 0.1


def test_knobs_1_to_3_of_the_paper_are_rendered_in_spite_of_their_negative_viscous_terms() -> None:
    for n in (1, 2, 3):
        assert kc.check_stability(f"knob{n}").passive
        assert knobcam("render", f"knob{n}", *VIRTUAL).code == 0


def test_render_refuses_what_it_cannot_do_in_one_line(tmp_path: Path) -> None:
    refused(knobcam("render", "knob9"), "knob9")
    refused(knobcam("render", "knob4", "--seconds", "0"), "seconds")
    refused(knobcam("render", "knob4", "--rate", "0"), "rate")
    refused(knobcam("render", "knob4", "--delay", "-1"), "--delay")
    refused(knobcam("render", "knob4", "--rt", "always"), "--rt")
    refused(knobcam("render", "knob4", "--time", "virtual", "--rt", "enforce"), "--rt enforce")
    refused(knobcam("render", "knob4", "--plots", tmp_path / "none" / "plots"), "make it first")
