"""An axis that slides is spoken of as one: mass and force, not inertia and torque of a knob that turns."""

from __future__ import annotations

import re

import knobcam as kc


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
