"""An axis that slides is spoken of as one: mass and force, not inertia and torque of a knob that turns."""

from __future__ import annotations

import re

import knobcam as kc
from knobcam.model.sliding import read, written


def test_what_is_told_of_an_axis_that_slides_has_no_torque_and_no_moment_of_inertia() -> None:
    for one in kc.effects("linear").values():
        told = [one.title, one.name, one.about, one.shows, *one.causes, *one.remedies]
        told += [param.meaning for param in one.params]
        assert not [words for words in told if "torque" in words or "moment of inertia" in words], one.id
    assert kc.effects("linear")["inertia"].parameter("M").meaning == "mass"
    assert kc.effects("rotary")["inertia"].parameter("M").meaning == "moment of inertia"


def test_nor_a_knob_that_turns_on_a_shaft() -> None:
    strange = re.compile(r"\b(knobs?|shaft|radians?|per turn|revolution|turn the)\b", re.IGNORECASE)
    for one in kc.effects("linear").values():
        told = [one.title, one.name, one.about, one.shows, *one.causes, *one.remedies]
        told += [param.meaning for param in one.params]
        assert not [words for words in told if strange.search(words)], one.id
    about = {coordinate: kc.effects(coordinate)["detent"].about for coordinate in ("rotary", "linear")}
    assert about["rotary"].startswith("The knob falls")
    assert about["linear"].startswith("The carriage runs over")


def test_what_returns_along_a_slide_is_a_ripple_and_no_detent() -> None:
    """A screw, a rack or the poles of a linear motor make it, and nobody feels a catch."""
    for one in kc.effects("linear").values():
        words = [one.title, one.name, one.about, one.shows, *one.causes, *one.remedies]
        words += [param.meaning for param in one.params]
        assert not [said for said in words if "detent" in said.lower()]
    assert kc.effects("linear")["detent"].title == "ripple"
    assert kc.effects("rotary")["detent"].title == "detent"


def test_laws_of_a_slide_are_of_its_position_and_velocity_and_a_force() -> None:
    slides = kc.effects("linear")
    assert not [one.id for one in slides.values() if re.search(r"\\(theta|omega|alpha|tau)\b", one.latex)]
    assert slides["return_spring"].latex == r"k\,(x - x_0)"
    assert kc.effects()["return_spring"].latex == r"k\,(\theta - \theta_0)"
    kc.own_law("screw_law", "a sin(theta/P) + m alpha")
    try:
        laws = [kc.effects(coordinate)["screw_law"].law for coordinate in ("rotary", "linear")]
    finally:
        kc.forget_effect("screw_law")
    assert laws == ["a sin(theta/P) + m alpha", "a sin(x/P) + m dv/dt"]


def test_what_is_written_of_a_slide_is_read_as_the_same_law() -> None:
    for law in (
        "2*a*(omega/w)/(1 + (omega/w)^2)",
        "k*theta + m*alpha",
        "a*exp(-s/d)",
        "a*x*theta",
        "v*omega",
    ):
        assert read(written(law, "linear"), "linear") == law
        assert written(law, "rotary") == read(law, "rotary") == law
    assert read("a 2x + xx", "linear") == "a 2theta + xx"
