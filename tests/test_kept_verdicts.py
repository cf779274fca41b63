"""Kept answers of what is concluded and said of all that may be found: see `test_kept_decisions.py`."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from answers import Answers
from test_kept_decisions import about, candidate, estimate, fitted, one_of

import knobcam as kc
from knobcam.fit.beyond import Beyond
from knobcam.fit.diagnose import Diagnosis
from knobcam.fit.forward import Forward, ForwardRun
from knobcam.fit.rule import RULE
from knobcam.learn import earlier, exchanged, headline, proposing, selection
from knobcam.learn.ladder import LearningStep, Unexplained
from knobcam.learn.learning import LearningResult
from knobcam.learn.proposals import Proposal, Proposals

EFFECTS = ("stribeck", "return_spring", "position_polynomial", "unbalance")


@dataclass
class Fake:
    """A fit, of which only this much is asked."""

    rmse: float
    before: Any = None

    def drop(self, effect: str) -> Fake:
        return Fake(2.0 * self.rmse, self)


def whole(rng: np.random.Generator, before: Any = None, effects: tuple[str, ...] = ()) -> Any:
    """A fit of which anything may be said."""
    fit = fitted(rng, before)
    fit.model = SimpleNamespace(
        effects=("inertia", *effects),
        period=None,
        coordinate="rotary",
        catalogue=kc.effects,
        laws={},
        joint=None,
    )
    fit.log_fault = one_of(rng, *(None,) * 7, "tau is in another unit")
    fit.impossible = one_of(rng, *(None,) * 4, "inertia came out negative")
    words = "waves beyond the filter"
    fit.beyond = one_of(rng, *(None,) * 4, Beyond(words, "position", 0.3))
    fit.prepared = [SimpleNamespace(core=SimpleNamespace(incoherent=one_of(rng, *(None,) * 6, [40.0])))]
    fit.wide = one_of(rng, None, None, "less than one detent")
    return fit


def comparison(rng: np.random.Generator, fit: Any) -> Any:
    axes = ("position", "velocity", "time", "frequency")
    region = SimpleNamespace(start=49.0, end=52.0)
    splits = [
        SimpleNamespace(axis=one, share=float(rng.random()), mean_share=float(rng.random()), regions=[region])
        for one in axes
    ]
    for split in splits:
        split.where = lambda split=split: f"the end of {split.axis}"
    worst = one_of(rng, None, *splits)
    for split in splits:
        split.fails = worst is not None
    complete = bool(rng.random() < 0.5)
    return SimpleNamespace(splits=splits, worst=worst, complete=complete, fit=fit, summary="It is as it is.")


class Looked(SimpleNamespace):
    """A comparison or a diagnosis that is asked by name."""

    def __getitem__(self, axis: str) -> Any:
        return next(one for one in self.splits if one.axis == axis)


def test_of_what_a_ladder_says_in_the_end(monkeypatch: pytest.MonkeyPatch) -> None:
    told, rng = Answers("concluded"), np.random.default_rng(51)
    maps = ("return_spring", "position_polynomial")
    monkeypatch.setattr(selection, "_is_map", lambda effect, _: effect in maps)
    monkeypatch.setattr(selection, "width", lambda fit: fit.wide)
    monkeypatch.setattr(selection, "friction_drives", lambda fit: None)
    monkeypatch.setattr(selection, "at_bounds", lambda fit: {})
    monkeypatch.setattr(selection, "in_doubt", lambda *_: None)
    monkeypatch.setattr(headline, "within_rounding", lambda fit: None)
    for one in (selection, headline):
        monkeypatch.setattr(one, "tells_nothing", lambda prepared: None)
    for at in range(150):
        fit = whole(rng)
        ladder = [LearningStep(fit)]
        came = EFFECTS[: at % 5]
        for number, effect in enumerate(came):
            fit = whole(rng, fit, came[: number + 1] if rng.random() < 0.9 else came[:number])
            before = Looked(**vars(comparison(rng, fit)))
            ladder.append(LearningStep(fit, effect, diagnosis=SimpleNamespace(comparison=before)))  # type: ignore[arg-type]
        last: Any = SimpleNamespace(comparison=Looked(**vars(comparison(rng, fit))), candidates=())
        if fit.noise_floor == 0.0:
            fit.noise_floor = 1e-3
        found = selection.concluded(ladder, last, one_of(rng, ("inertia",), ("inertia", "stribeck")))
        told.put(f"{at}", [" ".join(came), "found", *found.found])
        told.put("  unexplained", list(found.unexplained) if found.unexplained else None)
        story: Any = SimpleNamespace(
            found=found.found,
            unexplained=found.unexplained,
            fit=fit,
            cut=one_of(rng, *(None,) * 8, SimpleNamespace(words="the search was cut after 3 s")),
            noise_floor=one_of(rng, *(fit.noise_floor,) * 8, math.nan),
            after=last.comparison,
            ladder=ladder,
            not_added=None if at % 5 else SimpleNamespace(effect="stribeck", error_fall=0.16),
            one_more=SimpleNamespace(effect="presliding", error_fall=0.12) if at % 5 == 4 else None,
            without=(),
        )
        told.put("  said", headline._judged(story))
        story.verdict = LearningResult.verdict.fget(story)  # type: ignore[attr-defined]
        told.put("  verdict", [story.verdict, proposing._needless(story), proposing._closed(story)])
        told.put("  bars", LearningResult._bars(story))
    told.done()


def proposal(rng: np.random.Generator, at: int, fit: Any) -> Proposal:
    law = one_of(
        rng, "a*theta^2", "b*omega", "a*spline((theta - from)/by, 1, 2)", "a*omega*spline((t - from)/by, 1)"
    )
    richer = whole(rng, fit)
    richer.params |= {f"law{at}.a": estimate(rng, 0.0123456), f"law{at}.b": estimate(rng, -7.0)}
    unseen = about(rng, 1e-3) if "spline" in law else None
    return Proposal(law, f"law{at}", ("theta",), richer, about(rng, 60.0), int(rng.integers(2, 9)), unseen)


def test_of_which_laws_are_proposed_and_which_names_do_as_well() -> None:
    told, rng = Answers("proposed"), np.random.default_rng(52)
    for _ in range(60):
        fit = whole(rng)
        laws = tuple(proposal(rng, at, fit) for at in range(int(rng.integers(0, 5))))
        found = Proposals(fit, laws, float(rng.choice([5e-4, 0.02])), None, "chance explains it")
        told.put("laws", [one.label for one in laws])
        told.put("  score", [one.score for one in laws])
        told.put("  guess", [one.guess for one in laws])
        told.put("  unseen", [one.rmse_heldout for one in laws])
        told.put("  front", [one.name for one in found.front])
        told.put("  says", [found.headline, len(found)])
        told.put("  rows", [list(row) for row in found.rows()])
        could = [candidate(rng, one, fit) for one in EFFECTS]
        later = whole(rng, fit)
        for base, other in ((fit, later), (later, fit)):
            weighed: Any = SimpleNamespace(fit=other, candidates=could)
            story: Any = SimpleNamespace(
                fit=base, last=weighed, ladder=[SimpleNamespace(fit=fit)], first_diagnosis=weighed
            )
            if math.isnan(base.noise_floor) or base.noise_floor == 0.0:
                continue
            noise_alone = SimpleNamespace(rmse=1e-3, noise_floor=1e-3, white_squares=1500.0)
            for gain in (0.0, 20.0, 60.0, 400.0):
                for left in (base, noise_alone):
                    law: Any = SimpleNamespace(gain=gain, score=gain - RULE.price * 2, fit=left)
                    told.put("  named", proposing._named(story, base, law))
        if fit.noise_floor > 0.0:
            story = SimpleNamespace(ladder=[SimpleNamespace(fit=fit)])
            rows = [["a*theta", {"a": 1.0, "b": 2.0}, None, 55.0, True, 3, 1, 2]]
            spline = [["a*spline(theta, 1, 2)", {"a": 1.0}, None, 90.0, False, 5, 1, 1], 0.5]
            told.put("  gain", [proposing._speaks(story, later, []), proposing._speaks(story, later, rows)])
            told.put("  curve", proposing._speaks(story, later, rows, ([], None, spline)))
    told.done()


def of(effects: tuple[str, ...]) -> Any:
    """A fit with these effects, which may be dropped."""
    model = SimpleNamespace(effects=effects)
    return SimpleNamespace(model=model, drop=lambda gone: of(tuple(one for one in effects if one != gone)))


def gone(fit: Any, other: Any) -> str:
    """The effect that another fit lacks."""
    (effect,) = {*fit.model.effects} - {*other.model.effects}
    return str(effect)


def test_of_what_is_looked_for_anew_and_what_goes(monkeypatch: pytest.MonkeyPatch) -> None:
    told, rng = Answers("anew"), np.random.default_rng(53)
    monkeypatch.setattr(exchanged, "_found", lambda first, last: list(EFFECTS[: last.count]))
    monkeypatch.setattr(exchanged, "follows", lambda fit: False)
    for share in (0.5, 0.97, 0.979, 0.981, 0.99, 1.0, 1.01, 1.03):
        monkeypatch.setattr(
            exchanged, "add", lambda fit, effect, _, share=share: Fake(0.5 * share * fit.rmse)
        )
        for count in range(4):
            for complete in (False, True):
                last: Any = Fake(3e-3, Fake(1.0))
                last.count = count
                steps: Any = [SimpleNamespace(fit=last)] * 2
                again = exchanged.anew(steps, SimpleNamespace(complete=complete), lambda _: None)  # type: ignore[arg-type]
                told.put(f"{share} of {count}", [again is not None, again.rmse if again else 0.0])
    monkeypatch.setattr(earlier, "needed", lambda *_: False)
    monkeypatch.setattr(earlier, "drop", lambda fit, effect: fit.drop(effect))
    monkeypatch.setattr(earlier, "converged", lambda fit: fit)
    for _ in range(40):
        needless = {effect: bool(rng.random() < 0.5) for effect in EFFECTS}
        monkeypatch.setattr(earlier, "needless", lambda fit, other, known=needless: known[gone(fit, other)])
        kept, dropped = earlier.retested(of(EFFECTS[: int(rng.integers(1, 5))]), [*EFFECTS, "offset"])
        told.put("kept", [*kept.model.effects, "without", *dropped])
    told.done()


def test_of_how_far_any_simulated_motion_is_off() -> None:
    told, rng = Answers("simulated"), np.random.default_rng(54)
    for at in range(30):
        coordinate = one_of(rng, "rotary", "linear")
        catalogue = {
            "stribeck": SimpleNamespace(place="load"),
            "torque_drift": SimpleNamespace(place="sensor"),
        }
        effects = one_of(rng, ("stribeck",), ("stribeck", "torque_drift"))
        model = SimpleNamespace(
            coordinate=coordinate, effects=effects, catalogue=lambda catalogue=catalogue: catalogue
        )
        runs = []
        for _ in range(1 + at % 2):
            measured = one_of(rng, 0.0, 1.0) * np.sin(np.arange(200) / 9.0)
            measured[:5] = math.nan
            theta = measured + about(rng, 0.05) * rng.standard_normal(200)
            theta[-7:] = math.nan
            source = one_of(rng, "", "a.csv")
            signals: Any = SimpleNamespace(capture=SimpleNamespace(meta={"source": source}))
            runs.append(ForwardRun(signals, measured, theta, np.arange(int(rng.integers(1, 4)))))
        fit: Any = SimpleNamespace(model=model)
        found = Forward(fit, tuple(runs), one_of(rng, None, 0.2))
        told.put(f"{at} of {len(runs)}", [found.rmse, found.r2, found.nrmse, found.largest])
        told.put("  says", [found.unit, *found.text.splitlines()])
        told.put("  document", found.document())
    told.done()


def test_of_what_any_diagnosis_says() -> None:
    told, rng = Answers("said"), np.random.default_rng(55)
    words = ("missing", "part", "alike", "less", "implausible", "too_little", "unpaid", "chance", "untold")
    for at in range(60):
        fit = whole(rng)
        fit.beyond = one_of(rng, None, Beyond("waves", "position", 0.3))
        fit.compare = lambda fit=fit: comparison(np.random.default_rng(1), fit)
        some = [candidate(rng, one, fit) for one in EFFECTS[: at % 5]]
        for number, one in enumerate(some):
            one.word = one_of(rng, *words[(2 if number else 0) :])
            one.beyond_chance = one.word not in words[-3:]
            one.could_be = one.word in words[:4]
            one.error_fall, one.rmse_heldout = float(rng.uniform(-0.1, 0.9)), about(rng, 3e-3)
            one.remarks, one.said = "; ".join(one.equivalent), one.word
            one.fit.compare = fit.compare
        found: Any = Diagnosis(fit, tuple(some), one_of(rng, {}, {"offset": "it is in it"}))
        told.put(f"{at}", [found.summary, " ".join(one.effect for one in found.could_be)])
        told.put("  printed", repr(found).splitlines())
        told.put("  tables", [len(table.rows) for table in found.tables()])
    for one in (replace(Fake(1.0), rmse=2.0), Unexplained("time", 0.5, "it hums")):
        told.put("others", str(one))
    told.done()
