"""A diagnosis ranks named causes with their evidence; adding one refits everything."""

from __future__ import annotations

import dataclasses
import importlib
import json
import math

import numpy as np
import pytest

import knobcam as kc
from knobcam.fit import refit
from knobcam.fit.doubts import unsettled
from knobcam.fit.estimate import Estimate


@pytest.fixture(scope="module")
def bent(sprung: kc.Capture) -> kc.Fit:
    """The base model fitted to the knob with a spring."""
    return kc.fit(sprung)


@pytest.fixture(scope="module")
def diagnosis(bent: kc.Fit) -> kc.Diagnosis:
    return bent.diagnose()


def test_the_hidden_spring_comes_first_or_is_named_among_those_that_look_like_it(
    diagnosis: kc.Diagnosis,
) -> None:
    best = diagnosis.best
    assert best is not None
    assert "return_spring" in (best.effect, *best.equivalent)
    assert best.error_fall > 0.5
    assert best.rmse < 1.05 * diagnosis.fit.noise_floor


def test_what_could_be_missing_stands_before_what_could_not(diagnosis: kc.Diagnosis) -> None:
    solid = [one.could_be for one in diagnosis.candidates]
    assert solid == sorted(solid, reverse=True)
    assert all(one.p_value <= 0.05 for one in diagnosis.beyond_chance)


def test_every_absent_effect_is_weighed_and_none_that_is_there(diagnosis: kc.Diagnosis) -> None:
    weighed = [one.effect for one in diagnosis.candidates]
    assert len(weighed) == len(set(weighed))
    assert not set(weighed) & set(diagnosis.fit.model.effects)
    assert set(weighed) <= set(kc.effects())


def test_an_effect_left_out_of_the_catalogue_is_not_weighed(bent: kc.Fit) -> None:
    weighed = {one.effect for one in bent.diagnose(without=["return_spring"]).candidates}
    assert "return_spring" not in weighed and "position_polynomial" in weighed
    alone = kc.diagnose(bent, only=["return_spring"])
    assert [one.effect for one in alone.candidates] == ["return_spring"]


def test_weighing_tells_how_far_it_is_and_ends_when_whoever_is_told_raises(bent: kc.Fit) -> None:
    told: list[float] = []
    kc.diagnose(bent, progress=told.append)
    assert told[0] == 0.0 and told == sorted(told) and 0.5 < told[-1] <= 1.0

    def enough(share: float) -> None:
        told.append(share)
        raise KeyError("enough")

    told.clear()
    with pytest.raises(KeyError, match="enough"):
        kc.diagnose(bent, progress=enough)
    assert len(told) == 1


@pytest.mark.parametrize("argument", ["without", "only"])
def test_an_unknown_effect_to_leave_out_or_to_weigh_is_named(bent: kc.Fit, argument: str) -> None:
    with pytest.raises(kc.InputError, match=rf"{argument}: effect 'magic' is not in the catalogue"):
        kc.diagnose(bent, **{argument: ["magic"]})
    with pytest.raises(kc.InputError, match=rf"{argument}='return_spring' is one text"):
        kc.diagnose(bent, **{argument: "return_spring"})


def test_a_knob_with_nothing_missing_is_accused_of_nothing(fit: kc.Fit) -> None:
    diagnosis = fit.diagnose()
    assert diagnosis.best is None and diagnosis.beyond_chance == ()
    assert "No effect of the catalogue lowers this error beyond chance" in diagnosis.summary
    assert "Could be missing: nothing" in repr(diagnosis)


def test_a_diagnosis_prints_as_a_table_with_a_line_between_evidence_and_chance(
    diagnosis: kc.Diagnosis,
) -> None:
    rest = "Too little, no more than chance"
    text = repr(diagnosis) + f"\n{rest}"  # where it is not said, nothing stands below it
    for one in diagnosis.candidates:
        solid = text.index(f"  {one.effect}") < text.index(rest)
        assert solid == one.could_be
    assert "<table>" in diagnosis._repr_html_()


def test_the_document_of_a_diagnosis_has_every_candidate_with_its_evidence(diagnosis: kc.Diagnosis) -> None:
    document = diagnosis.document()
    assert document["schema"] == "knobcam.diagnose/1"
    first, best = document["candidates"][0], diagnosis.candidates[0]
    assert first["effect"] == best.effect and first["word"] == "missing"
    assert first["beyond_chance"] is first["could_be"] is True
    assert set(first["params"]) == set(best.parameters)
    assert first["moved"].keys() == best.moved.keys()
    assert document["remains"]["complete"] is True
    json.dumps(document)


def test_adding_the_spring_gives_a_new_fit_that_knows_the_old_one(bent: kc.Fit) -> None:
    fitted = bent.add("return_spring")
    assert fitted.before is bent and bent.before is None
    assert "return_spring" not in bent.model.effects and "return_spring" in fitted.model.effects
    assert fitted.error_fall == pytest.approx(1.0 - fitted.rmse / bent.rmse)
    assert fitted.params["return_spring.k"].value == pytest.approx(0.004, rel=0.03)
    assert bent.error_fall == 0.0 and bent.moved == {}


def test_the_missing_spring_had_bent_the_inertia_and_its_refit_is_right(bent: kc.Fit) -> None:
    """A stiffness looks like a negative inertia where position and acceleration are opposite."""
    moved = bent.add("return_spring").moved
    assert "return_spring.k" not in moved
    assert moved["inertia.M"].by_se > 10.0
    old, new = bent.params["inertia.M"].value, bent.add("return_spring").params["inertia.M"]
    assert moved["inertia.M"].by_percent == pytest.approx(100.0 * (new.value - old) / abs(old))
    assert moved["inertia.M"].by_se == pytest.approx((new.value - old) / new.se)


def test_a_fit_prints_what_adding_did(bent: kc.Fit) -> None:
    text = repr(bent.add("return_spring"))
    assert "With return_spring: RMS error from" in text and "moved by (standard errors)" in text
    assert "With" not in repr(bent)


def test_an_effect_that_only_fits_noise_is_said_to_have_made_things_no_better(fit: kc.Fit) -> None:
    added = fit.add("quadratic_drag")
    document = refit.document(added)
    assert document["worse"] is True and document["why_worse"]
    assert "That made things no better: " in repr(added)
    rose = added.rmse_heldout > fit.rmse_heldout
    assert any("unseen blocks rose" in why for why in document["why_worse"]) == rose
    assert any("no more than chance" in why for why in document["why_worse"])


def test_an_effect_that_was_missing_is_not_said_to_have_made_things_worse(bent: kc.Fit) -> None:
    added = bent.add("return_spring")
    assert refit.worse(added) == () and refit.document(added)["worse"] is False
    assert "no better" not in repr(added)
    assert refit.worse(bent) == ()


def test_a_fit_is_asked_once_whether_its_log_is_at_fault(
    capture: kc.Capture, monkeypatch: pytest.MonkeyPatch
) -> None:
    asked = []
    module = importlib.import_module("knobcam.fit.fitting")
    monkeypatch.setattr(module, "log_fault", asked.append)
    fit = kc.fit(capture)
    assert fit.document()["warnings"] == list(fit.warnings) and repr(fit)
    assert asked == [fit]


def test_an_effect_that_cannot_be_added_is_refused_with_the_reason(bent: kc.Fit) -> None:
    with pytest.raises(kc.InputError, match=r"'magic' is not in the catalogue; it has .*inertia"):
        bent.add("magic")
    with pytest.raises(kc.InputError, match="'viscous' is in the model already"):
        bent.add("viscous")


def test_results_cannot_be_changed(bent: kc.Fit, diagnosis: kc.Diagnosis) -> None:
    for result, name in ((bent, "core"), (diagnosis, "candidates"), (diagnosis.candidates[0], "p_value")):
        with pytest.raises(dataclasses.FrozenInstanceError):
            setattr(result, name, None)


def test_several_captures_are_weighed_jointly(sprung: kc.Capture) -> None:
    knob = kc.Model.parse(sprung.meta["model"])
    both = kc.fit([sprung, kc.simulate(knob, "hand", seed=3)]).add("return_spring")
    assert len(both.prepared) == 2
    assert both.params["return_spring.k"].value == pytest.approx(0.004, rel=0.03)
    assert np.isfinite(both.residual).sum() == sum(one.core.used for one in both.prepared)


def test_an_effect_that_cannot_be_weighed_is_left_out_with_the_reason() -> None:
    knob = kc.Model.load("knob1")
    diagnosis = kc.fit(kc.simulate(knob), detents="no").diagnose()
    assert "detent_harmonics" not in [one.effect for one in diagnosis.candidates]
    assert "'detent'" in diagnosis.left_out["detent_harmonics"]
    assert "Left out: detent_harmonics" in repr(diagnosis)
    assert diagnosis.document()["left_out"] == diagnosis.left_out


def test_values_of_which_most_may_be_nothing_are_said_not_to_be_determined() -> None:
    def one(value: float, half: float) -> Estimate:
        return Estimate(value, (value - half, value + half), "1", half / 2.0)

    held = Estimate(3.0, (3.0, 3.0), "1", 0.0)
    unknown = Estimate(1.0, (math.nan, math.nan), "1", math.nan)
    ripple, presliding = kc.effects()["cogging"], kc.effects()["presliding"]
    known = {"presliding.s": one(2.0, 1.0), "presliding.w1": one(0.3, 0.1), "presliding.w2": one(0.0, 1.0)}
    assert unsettled(presliding, known) == ""
    told = unsettled(presliding, known | {"presliding.w3": unknown, "presliding.w4": one(-0.1, 5.0)})
    assert told == "3 of its 5 values are not determined, and may be nothing as well"
    alone = {"presliding.s": one(2.0, 3.0), "presliding.w1": unknown}
    assert unsettled(presliding, alone) == "none of its values is determined: each may be nothing as well"
    # Of a phase or a place zero is a value like any other, and what is held was not asked.
    spring = {"return_spring.k": one(0.01, 0.001), "return_spring.theta0": unknown}
    assert unsettled(kc.effects()["return_spring"], spring) == ""
    waves = {"cogging.n1": held, "cogging.a1": one(0.5, 0.1), "cogging.phi1": one(0.0, 0.3)}
    assert unsettled(ripple, waves) == ""
