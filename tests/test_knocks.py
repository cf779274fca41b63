"""What is found between the knocks of a play, where no law of a contact tells how these go."""

import numpy as np
import pytest

import knobcam as kc
from knobcam.learn import knocks
from knobcam.learn.ladder import LearningStep

JOINT = {"backlash.gap": 0.02, "backlash.k": 60.0, "backlash.d": 0.05, "backlash.share": 0.7}
VALUES = {"inertia.M": 1e-4} | dict.fromkeys(("coulomb.neg", "coulomb.pos"), 0.01)


def knob(**more: float) -> kc.Model:
    """A knob behind a play, with effects more by their parameters."""
    values = {**JOINT, **VALUES, **{name.replace("__", "."): value for name, value in more.items()}}
    model = kc.Model.of(("inertia", "coulomb", "viscous"), "rotary")
    for name in dict.fromkeys(name.partition(".")[0] for name in values):
        model = model if name in model.effects else model.with_effect(name)
    for name, value in values.items():
        model = model.with_value(name, value)
    return model


def recorded(model: kc.Model, uneven: float) -> kc.Capture:
    """A capture of it, each of whose knocks is harder or softer than the play lets expect."""
    capture = kc.simulate(model, motion="multisine", duration_s=3.0, rate_hz=2500.0, seed=3)
    prepared = kc.prepare(capture)
    quiet = model.core.without_knocks(prepared.core, 1.0)
    assert quiet is not None
    rows = prepared.rows[prepared.used & ~(np.asarray(quiet.column("weight")) > 0.0)]
    tau = capture.tau.copy()
    rng = np.random.default_rng(4)
    for knock in np.split(rows, np.flatnonzero(np.diff(rows) > 1) + 1):
        tau[knock] *= 1.0 + uneven * rng.uniform(-1.0, 1.0)
    columns = {name: capture.columns[name] for name in ("theta", "omega", "alpha")}
    return kc.Capture.from_arrays(t=capture.t, tau=tau, **columns)


def test_knocks_that_go_otherwise_than_a_contact_lets_expect_hide_no_effect_beside_the_play():
    story = kc.learn(recorded(knob(quadratic_drag__d=4e-4), uneven=0.3), detents="no")
    assert (story.verdict, set(story.found)) == ("missing", {"backlash", "quadratic_drag"})
    drag = story.params["quadratic_drag.d"]
    assert drag.ci95[0] < 4e-4 < drag.ci95[1]
    (told,) = (one for one in story.document()["findings"] if one["kind"] == "knock")
    assert 0.0 < told["count"] < 0.25 * story.captures[0].samples
    counted = int(story.fit.prepared[0].used.sum())
    share = 100.0 * told["count"] / (told["count"] + counted)
    assert f"knocks alone, {share:.0f} %" in story.headline


def test_knocks_that_are_explained_are_counted():
    capture = recorded(knob(), uneven=0.0)
    fit = kc.fit(capture, detents="no").add("backlash")
    assert fit.rmse < 1.05 * fit.noise_floor
    assert knocks.knocking([LearningStep(fit)], fit.diagnose(only=())) is None


@pytest.mark.parametrize("effect", ["compliance", "stribeck"])
def test_what_knows_no_play_does_not_knock(effect: str):
    capture = recorded(knob(), uneven=0.3)
    fit = kc.fit(capture, detents="no").add(effect)
    prepared = fit.prepared[0]
    assert fit.core.model.without_knocks(prepared.core, fit.noise_floor) is None


def test_a_play_that_came_in_with_another_effect_is_looked_beside_though_it_was_not_weighed_alone():
    fit = kc.fit(recorded(knob(), uneven=0.0), detents="no")
    gapped, known = fit.add("backlash"), fit.diagnose(only=("stribeck",))
    found = knocks.Knocks("backlash", gapped, known, gapped.prepared)
    step = knocks.beside_play(found, knocks.quiet(found, fit))
    assert step.added == "backlash" and step.p_value <= 0.01
    assert step.fit.rmse < 1.05 * step.fit.noise_floor


@pytest.mark.parametrize(
    "there, uneven, effect, of_knocks",
    [
        ({}, 0.8, "position_friction", True),
        ({"torque_lag__lag": 1e-3}, 0.0, "torque_lag", False),
        ({"quadratic_drag__d": 4e-4}, 0.3, "quadratic_drag", False),
    ],
)
def test_what_explains_nothing_but_how_a_play_knocks_and_little_of_that_is_no_cause(
    there: dict[str, float], uneven: float, effect: str, of_knocks: bool
) -> None:
    gapped = kc.fit(recorded(knob(**there), uneven), detents="no").add("backlash")
    told = gapped.diagnose(only=(effect,))[effect]
    assert told.gain > 100.0 and told.p_value <= 0.001
    assert any("between the knocks" in str(why) for why in told.implausible) is of_knocks
