"""A session as the page is told it: one JSON document."""

from __future__ import annotations

import math
import re
from itertools import combinations
from typing import TYPE_CHECKING, NamedTuple

from ..base import pages
from ..base.remembered import remembered
from ..base.said import OfEffect, OfParam, Said, joined, said
from ..errors import InputError
from ..fit.doubts import may_be_nothing, said_once, unsettled
from ..fit.plausible import out_of_range
from ..learn import LearningResult
from ..learn.contenders import untold_of_each
from ..learn.limitations import limitations
from ..learn.limits import Limits
from ..learn.showing_more import along, longest_s
from ..model.effects import base_effects, base_effects_shown, effects, titles
from ..show.samples import below_hz, candidates, peak
from . import proposing, ruling, surface
from .closing import open_ones
from .designing import origin
from .learned import carried, conclusion, in_vain, ladder

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from ..base.pages_left import Limitation
    from ..fit import Estimate, Fit
    from ..fit.diagnose import Diagnosis
    from ..learn.ladder import LearningStep
    from ..model import Model, Parameter
    from ..model.effects import Effect
    from .designed import Designed
    from .session import Session
    from .tree import Branch, Node, Opened
    from .view import View

SCHEMA = "knobcam.workbench/1"
NOTHING = "may be nothing as well, for the interval holds zero"
_PARAM = re.compile(r"(\w+\.\w+)")
_PAIRS = 12  # of parameters that move together, shown to who asks


def document(session: Session) -> pages.Session:
    """Return the state of a session; what is not a number is NaN, and JSON has null for it."""
    with session.lock:
        known = _nothing(session)
        if not session.branches:
            return known
        branch, view = session.branch, session.view
        diagnosis = session.diagnosis_of(branch.node.id)
        shown, laws = session.experiment, session.proposals.get(branch.node.id)
        foreign = session.laws_of_others(branch.node)
        searched = session.searched.get(branch.node.id)
        disagreed = session.disagreed.get(branch.node.id, ())
        needless = session.needless.get(branch.node.id, [])
    fitted = view.fit
    told = _said(fitted)
    steps = ladder(branch.done)
    story = searched or _end(steps, diagnosis, needless)
    left = None if story is None else story.unexplained
    headline = None if story is None else story.headline
    shown_along = None if story is None else along(story)
    return {
        **known,
        "captures": [_capture(one, fitted, view.node.captures) for one in open_ones(session)],
        "active": list(view.node.captures),
        "branch": branch.id,
        "node": view.id,
        "noise_floor": fitted.noise_floor,
        "unit": fitted.torque_unit,
        "peak": told.peak,
        "below_hz": below_hz(fitted),
        "params": _parameters(view, fitted.params if searched is None else searched.params),
        "together": told.together,
        "rmse": view.rmse,
        "rmse_heldout": view.rmse_heldout,
        "added": _added(steps, headline, needless),
        "concluded": [] if headline is None else headline.document(),
        "searched": searched is not None,
        "sets": searched is None and left is not None and not fitted.log_fault and fitted.noise_floor > 0.0,
        "verdict": _verdict(
            steps, diagnosis or (None if searched is None else searched.weighed), story
        ).document(),
        "record": None if story is None else story.record,
        "shown_along": shown_along,
        "carried": [
            {
                "added": step.added,
                "rmse": step.rmse,
                "rmse_heldout": step.rmse_heldout,
                "noise_floor": step.fit.noise_floor,
            }
            for step in carried(branch.done)
        ],
        "ladder": [
            {
                "label": "first model" if step.added is None else f"+ {step.added}",
                "rmse": step.rmse,
                "rmse_heldout": step.rmse_heldout,
            }
            for step in steps
        ],
        "candidates": known["candidates"] if diagnosis is None else candidates(diagnosis, left),
        "warnings": list(fitted.warnings),
        "limitations": told.limitations,
        "disagreements": [{"param": one.param, "said": one.sentence.document()} for one in disagreed],
        "titles": titles(fitted.model.coordinate),
        "absent": [one for one in told.absent if one["effect"] not in foreign],
        "untold": [[added, *others] for added, others in untold_of_each(steps).items()],
        "needless": needless,
        "proposed": proposing.document(laws),
        "proposed_said": proposing.headline(laws),
        "curve": proposing.curve(laws),
        "surface": surface.document(laws),
        # For as long as a motion takes at most here that is for nothing that is typed.
        "limits": told.limits and told.limits | {"duration_s": longest_s(shown_along)},
        "experiment": None if shown is None else shown.document(_source(session, shown)),
    }


class _Said(NamedTuple):
    """What is said of a fit whatever a hand moves; looking through its samples takes its time."""

    peak: float
    together: list[pages.Together]
    limitations: list[Limitation]
    absent: list[pages.Effect]
    limits: dict[str, float] | None


@remembered
def _said(fitted: Fit) -> _Said:
    cannot: list[Limitation] = [
        {"said": Said(one.message, "; ", one.record).document(), "sharpen": one.sharpen}
        for one in limitations(fitted)
    ]
    missing = [one.document() for one in absent(fitted.model)]
    return _Said(peak(fitted), _together(fitted), cannot, missing, _reached(fitted))


def _reached(fitted: Fit) -> dict[str, float] | None:
    """Return the limits that captures reached; None of such as nothing moves in."""
    if not any(one.used.any() for one in fitted.prepared):
        return None
    try:
        return Limits.reached(fitted.prepared).numbers
    except InputError:
        return None


def unexplained(session: Session) -> bool:
    """Whether it is known where the session is, and what is left there has no name."""
    node = session.node.id
    needless = session.needless.get(node, [])
    end = session.searched.get(node) or _end(
        ladder(session.branch.done), session.diagnosis_of(node), needless
    )
    return end is not None and end.unexplained is not None


def _end(
    steps: list[LearningStep], diagnosis: Diagnosis | None, needless: Sequence[str]
) -> LearningResult | None:
    """What a ladder comes to; None where something is left to be added, and nothing is concluded yet."""
    open_still = diagnosis is None or diagnosis.best is not None
    return (
        None if diagnosis is None or open_still else LearningResult(*conclusion(steps, diagnosis, needless))
    )


def absent(model: Model) -> list[Effect]:
    """Return the effects that a model could be given."""
    return [
        one for one in effects(model.coordinate).values() if one.id not in model.effects and _fits(one, model)
    ]


def _fits(effect: Effect, model: Model) -> bool:
    try:
        model.with_effect(effect.id)
    except InputError:
        return False
    return True


def _nothing(session: Session) -> pages.Session:
    """What is told of a session before anything is fitted in it."""
    return {
        "schema": SCHEMA,
        "revision": session.revision,
        "captures": [_capture(one) for one in open_ones(session)],
        "branches": [_branch(one) for one in session.branches.values()],
        "active": [],
        "branch": None,
        "node": None,
        "noise_floor": None,
        "unit": "N m",
        "peak": 0.0,
        "below_hz": None,
        "params": [],
        "together": [],
        "rmse": None,
        "rmse_heldout": None,
        "added": [],
        "concluded": [],
        "searched": False,
        "sets": False,
        "verdict": ["Open a capture to begin."],
        "record": None,
        "shown_along": None,
        "carried": [],
        "ladder": [],
        "candidates": {"ready": False, "rows": [], "unexplained": None, "left_out": {}},
        "warnings": [],
        "limitations": [],
        "disagreements": [],
        "titles": {},
        "absent": [],
        "untold": [],
        "needless": [],
        "proposed": None,
        "proposed_said": [],
        "curve": None,
        "surface": None,
        "limits": None,
        "experiment": None,
    }


def _capture(opened: Opened, fitted: Fit | None = None, to: Sequence[str] = ()) -> pages.CaptureInfo:
    capture = opened.capture
    there = opened.id in to
    return {
        "id": opened.id,
        "name": opened.name,
        "samples": capture.samples,
        "rate_hz": capture.rate_hz,
        "coordinate": capture.coordinate,
        "findings": ruling.document(opened, fitted if there else None, to.index(opened.id) if there else 0),
        "hides": bool(opened.hidden),
    }


def _branch(branch: Branch) -> pages.Branch:
    return {
        "id": branch.id,
        "name": branch.name,
        "at": branch.at,
        "steps": [
            {
                "node": node.id,
                "anew": node.how == "fitted" and not node.onward,
                "added": node.effect if node.how == "added" else None,
                "along": _along(node, before),
                "dropped": [
                    *node.also_dropped,
                    *([node.effect] if node.how == "dropped" and node.effect else []),
                ],
                "rmse": node.fit.rmse,
                "rmse_heldout": node.fit.rmse_heldout,
                "noise_floor": node.fit.noise_floor,
                "captures": list(node.captures),
            }
            for before, node in zip([None, *branch.steps], branch.steps, strict=False)
        ],
    }


def _along(node: Node, before: Node | None) -> list[str]:
    """Return what came in by itself with an effect, whether one by one or in a search."""
    if node.how != "added" or before is None:
        return []
    there = {*before.fit.model.effects, node.effect}
    return [one for one in node.fit.model.effects if one not in there]


def _parameters(view: View, estimates: Mapping[str, Estimate]) -> list[pages.Param]:
    catalogue = view.model.catalogue()
    rows: list[pages.Param] = []
    for name, now in view.model.params.items():
        effect, own = name.split(".", 1)
        info = catalogue[effect].parameter(own)
        estimate = estimates[name]
        doubt = _doubt(name, estimate, catalogue[effect], view)
        rows.append(
            {
                "name": name,
                "value": now.value,
                "ci95": estimate.ci95 if estimate.determined else None,
                "unit": now.unit,
                "role": now.role,
                "fitted": estimate.value,
                "dragged": _moved(name, now, view),
                "lower": info.lower,
                "upper": info.upper,
                "meaning": info.meaning,
                "doubt": None if doubt is None else _named(doubt, view.model).document(),
            }
        )
    return rows


def _together(fitted: Fit) -> list[pages.Together]:
    """Return the pairs of parameters that move together most, the closest first."""
    rows = fitted.correlation
    pairs = [(rows[a][b], a, b) for a, b in combinations(rows, 2) if not math.isnan(rows[a][b])]
    pairs.sort(key=lambda one: -abs(one[0]))
    return [{"names": [a, b], "correlation": value} for value, a, b in pairs[:_PAIRS]]


def _source(session: Session, shown: Designed) -> str | None:
    """What a motion can be recorded from at once, in words."""
    found = origin([session.captures[one] for one in session.captures_of(shown)])
    return None if found is None else found.words


def _moved(name: str, now: Parameter, view: View) -> bool:
    return name in view.dragged or (bool(view.dragged) and now.role in view.dragged)


def _named(doubt: str, model: Model) -> Said:
    """Return a doubt as a sentence that knows which of its words are parameters."""
    words = _PARAM.split(doubt) if not isinstance(doubt, Said) else [doubt]
    return Said(*(OfParam(one) if one in model.params else one for one in words))


def _doubt(name: str, estimate: Estimate, effect: Effect, view: View) -> str | None:
    """What is doubtful about a fitted value, if anything is."""
    own = name.partition(".")[2]
    if name in view.fit.undetermined:
        return view.fit.undetermined[name]
    doubted = [warning for warning in view.fit.warnings if warning.startswith(f"{name} ")]
    if doubted:
        return doubted[0]
    strange = out_of_range(estimate, effect.parameter(own).plausible)
    if strange is None and may_be_nothing(effect, own, estimate) and _said_before(effect, view):
        return NOTHING
    return strange


def _said_before(effect: Effect, view: View) -> bool:
    """Whether it was said of an effect before it came in that its captures do not determine its values.

    Or would have been, had it not come in by itself.
    """
    if effect.id in base_effects(view.model.coordinate):
        return False
    if effect.id in base_effects_shown(view.model.coordinate):
        return True  # nobody asked for it
    own = {one: e for one, e in view.fit.params.items() if one.startswith(f"{effect.id}.")}
    return effect.id in view.model.laws or bool(unsettled(effect, own))


def _added(steps: list[LearningStep], headline: Said | None, needless: Sequence[str]) -> list[str]:
    """Return what came into the model and is not named otherwise in what is said of it."""
    parts = () if headline is None else headline.parts
    named = {part.effect for part in parts if isinstance(part, OfEffect)} | {*in_vain(steps), *needless}
    came = dict.fromkeys(step.added for step in steps if step.added in steps[-1].effects)
    return [one for one in came if one is not None and one not in named]


def _verdict(steps: list[LearningStep], diagnosis: Diagnosis | None, story: LearningResult | None) -> Said:
    """Return what is said beside what is concluded."""
    vain = _in_vain(in_vain(steps))
    if diagnosis is None:
        return joined(" ", (vain, "What could be missing is not weighed yet."))
    compared, beyond = diagnosis.comparison, diagnosis.fit.beyond
    if story is None:  # what is missing the page says first, of the candidates
        # Chance may explain the error as a whole, and an effect still a part of it: not both is said.
        size = said("{error}.", error=compared.error) if compared.complete else compared.summary
        return joined(" ", (vain, size, beyond and beyond.sentence))
    # An error like chance's is no proof of a model that no knob can have.
    warned = diagnosis.fit.warnings if compared.complete else ()
    against = joined("; ", said_once(warned)) if warned else ""
    but = said("But {warnings}.", warnings=against) if against else ""
    return joined(" ", (vain, story.left, but))


def _in_vain(effects: list[str]) -> Said | None:
    """Return that effects came in which were not missing."""
    if not effects:
        return None
    was, it = ("was", "it") if len(effects) == 1 else ("were", "they")
    end = f"{{names}} {was} added, and {it} took off too little to have been missing."
    return said(end, names=joined(" and ", map(OfEffect, effects)))
