"""What was learned as one HTML file: no network, no other file, nothing in it that could be markup."""

from __future__ import annotations

import math
import os
import re
from collections import Counter
from html import escape
from importlib import resources
from pathlib import Path
from string import Template
from typing import TYPE_CHECKING

from .._core import __version__
from ..base.writing import write as write_file
from ..fit.diagnose import LEAST_P
from ..fit.doubts import said_once, unsettled
from ..fit.plausible import out_of_range
from ..fit.refit import percent
from ..fit.unheard import unheard
from ..learn.contenders import untold_of_each
from ..model.effects import effect as catalogued
from ..model.effects import effects
from .look_page import section
from .markup import bullets, figure, law, paragraph, style, wide_table
from .samples import steps
from .values import HEAD, rows
from .words import (
    and_words,
    axis_word,
    bound_word,
    effect_word,
    or_words,
    param_phrase,
    sentence,
    with_params,
    worded,
)

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence

    from ..fit import Fit
    from ..fit.diagnose import Diagnosis
    from ..learn import LearningResult
    from ..learn.ladder import LearningStep

_FEW = 2  # captures of which each has its own facts
_ROOM = 12  # parameters that stand on one page beside a picture
_MINUS = re.compile(r"(?<![\w.-])-(?=\d)")
"""The hyphen before a number."""
_NAMES = re.compile(r"[^\w.@]+")
"""What parts the names in a sentence."""


def write(learned: LearningResult, path: str | os.PathLike[str]) -> Path:
    """Write the report; it appears whole or not at all."""
    # A path of the system may hold what no text can.
    return write_file(path, html(learned).encode("utf-8", "replace"))


def html(learned: LearningResult) -> str:
    """Return the report: a page to hand in, then what was found, why, what else it could be, what remains."""
    look = section(steps(learned))
    page = resources.files("knobcam.show").joinpath("report.html").read_text("utf-8")
    return Template(page).substitute(
        title=escape(_title(learned)),
        facts=escape(_facts(learned)),
        verdict=learned.verdict,
        headline=escape(sentence(learned.headline, learned.model.coordinate)),
        learned=_story(learned),
        style=style(),
        params=_on_sheet(learned),
        doubtful=_doubtful(learned),
        untold=_untold(learned),
        next=_next(learned),
        look=look.markup,
        look_style=look.style,
        look_hash=look.script_hash,
        found=_found(learned),
        why=_why(learned),
        **{"else": _alternatives(learned)},
        remains=_remains(learned),
        sure=_sure(learned),
        made=escape(_made(learned)),
    )


def _story(learned: LearningResult) -> str:
    """All in one picture, without the headline that stands above it."""
    drawn = learned.plot()
    drawn.suptitle("")
    return figure(drawn, "Error ladder, residual before and after, parameters that moved, the rest.")


def _title(learned: LearningResult) -> str:
    from .plot.style import name_of  # with what draws, which a page alone does not need

    if len(learned.captures) > _FEW:  # the appendix has the others
        others = len(learned.captures) - 1
        return f"What is missing in the model of {name_of(learned.captures[0])} and {others} more captures"
    names = Counter(map(name_of, learned.captures))
    known = (name if count == 1 else f"{name} ({count} captures)" for name, count in names.items())
    return f"What is missing in the model of {', '.join(known)}"


def _doubtful(learned: LearningResult) -> str:
    """What speaks against the values of the last model, with its heading; nothing where nothing does."""
    kind = learned.model.coordinate
    said = [with_params(worded(one, kind), learned.params, kind) for one in said_once(learned.fit.warnings)]
    warned = _warned(learned)
    for name, why in _strange(learned).items():
        if name not in warned:
            said.append(f"{param_phrase(name, kind)}: {why}")
    told = [_MINUS.sub("−", one[:1].upper() + one[1:]) for one in said]
    return f"<h2>What is doubtful</h2>\n{bullets(told)}" if told else ""


def _strange(learned: LearningResult) -> dict[str, str]:
    """Return the parameters whose values are surely out of what is plausible, and why."""
    catalogue = learned.model.catalogue()
    found: dict[str, str] = {}
    for name, one in learned.params.items():
        effect, _, own = name.partition(".")
        why = None if one.held else out_of_range(one, catalogue[effect].parameter(own).plausible)
        if why is not None:
            found[name] = why
    return found


def _warned(learned: LearningResult) -> set[str]:
    """Return the parameters that a warning of the last fit is about."""
    return {name for name in learned.params for one in learned.fit.warnings if name in _NAMES.split(one)}


def _untold(learned: LearningResult) -> str:
    """What the captures cannot tell: names that explain them as well, and values.

    What the error that nothing explains looks like is in the headline of the page.
    """
    kind = learned.model.coordinate
    said = [
        f"{effect_word(added, kind)} from {or_words([effect_word(other, kind) for other in others])}: "
        f"{'either' if len(others) == 1 else 'each'} explains {_these(learned).lower()}"
        for added, others in untold_of_each(learned.ladder).items()
    ]
    said += [worded(one.message, kind) for one in learned.limitations]
    fit = learned.fit
    why_not: dict[str, list[str]] = {}
    for name, why in fit.undetermined.items():
        why_not.setdefault(with_params(why, fit.params, kind), []).append(param_phrase(name, kind))
    said += [f"{and_words(names)}: {why}" for why, names in why_not.items()]
    said += _unsettled(learned)
    rest = ["what the error that is left comes of, as said above"] if learned.unexplained else []
    if said or rest:
        return bullets([*rest, *said])
    return paragraph("Nothing: what was weighed is told apart, and every value is determined.")


def _unsettled(learned: LearningResult) -> list[str]:
    """Of each effect that came in which values may be nothing as well, where that is most of them."""
    kind = learned.model.coordinate
    told = []
    for effect in dict.fromkeys(step.added for step in learned.ladder):
        own = {name: one for name, one in learned.params.items() if name.startswith(f"{effect}.")}
        known = effects(kind).get(effect or "")
        if known and own and (why := unsettled(known, own)):
            told.append(f"{known.title}: {why}")
    return told


def _these(learned: LearningResult) -> str:
    return "This capture" if len(learned.captures) == 1 else "These captures"


def _next(learned: LearningResult) -> str:
    said = []
    if untold_of_each(learned.ladder):
        how = "Tell apart in the workbench, or the command knobcam next,"
        said.append(f"the motion that tells them apart, which {how} designs for {_these(learned).lower()}")
    said += dict.fromkeys(one.record for one in learned.limitations)
    if learned.record is not None:
        said.append(f"to see more of what no effect explains: {learned.record}")
    return bullets(said) if said else paragraph("Nothing more, for this verdict.")


def _facts(learned: LearningResult) -> str:
    if len(learned.captures) > _FEW:
        count = sum(one.samples for one in learned.captures)
        fitted = sum(one.core.used for one in learned.fit.prepared)
        seconds = sum(one.duration_s for one in learned.captures)
        return f"{len(learned.captures)} captures, {count} samples, {seconds:.4g} s, {fitted} samples fitted"
    return "; ".join(_each(learned))


def _each(learned: LearningResult) -> list[str]:
    """Facts of each capture."""
    parts = []
    for capture, signals in zip(learned.captures, learned.fit.prepared, strict=True):
        masked = int((~capture.mask).sum())
        parts.append(
            f"{capture.samples} samples, {capture.duration_s:.4g} s at {capture.rate_hz:.6g} Hz, "
            f"{masked} masked, {signals.core.used} fitted"
        )
    return parts


def _found(learned: LearningResult) -> str:
    """Each effect that came in: its law, its values, its evidence."""
    kind = learned.model.coordinate
    if not learned.found:
        tried = [effect_word(step.added, kind) for step in learned.ladder if step.added]
        why = "no effect was added"
        if tried:
            why = f"{and_words(tried)} came in, but cannot be named as the cause"
        return paragraph(f"Nothing of the catalogue: {why}.")
    parts = []
    for step in learned.ladder:
        if step.added not in learned.found:
            continue
        entry = catalogued(step.added, kind)
        parts.append(f"<h3>{escape(entry.title)}</h3>")
        shows = f"; shows {entry.shows}" if entry.shows else ""
        about = f"{entry.about} Acts on the {entry.place}{shows}."
        parts.append(paragraph(about) + law(entry.latex, entry.law))
        parts.append(paragraph(_evidence(step, kind)))
        parts.append(paragraph(f"Source: {entry.source}.", "soft"))
        parts.append(_params("As fitted in the end", learned, step.added))
    came = (step.added for step in learned.ladder if step.added in learned.model.effects)
    if beside := [effect_word(one, kind) for one in came if one and one not in learned.found]:
        parts.append(paragraph(f"In the model too, but not named as causes: {', '.join(beside)}."))
    return "\n".join(parts)


def _params(caption: str, learned: LearningResult, effect: str | None = None, most: int | None = None) -> str:
    """The parameters of the last model as a table, or of one of its effects; or `most` that were fitted."""
    names = [
        name
        for name, one in learned.params.items()
        if effect in (None, name.partition(".")[0]) and not (most and one.held)
    ]
    doubted = {*_strange(learned), *_warned(learned)}
    return wide_table(caption, HEAD, rows(learned, names[:most], doubted))


def _on_sheet(learned: LearningResult) -> str:
    """As many of the parameters as there is room for on one page, and where the others are."""
    count = len(learned.params)
    if count <= _ROOM:
        return _params("All parameters of the last model", learned)
    fitted = sum(not one.held for one in learned.params.values())
    what = f"{min(_ROOM, fitted)} of the {count} parameters of the last model"
    rest = "the others, and what is fixed, stand in the appendix, under How sure"
    return _params(f"{what}; {rest}", learned, most=_ROOM)


def _worded(rows: Iterable[Sequence[str]], kind: str) -> list[tuple[str, ...]]:
    return [tuple(_MINUS.sub("−", bound_word(worded(cell, kind))) for cell in row) for row in rows]


def _evidence(step: LearningStep, kind: str) -> str:
    unit = step.fit.torque_unit
    said = f"With it the RMS error changes by {percent(-step.error_fall)}, to {step.rmse:.4g} {unit}"
    said += f" ({step.rmse_heldout:.4g} {unit} on blocks that the fit did not see)."
    if math.isfinite(step.p_value):
        said += f" Chance alone would do as well in {_chances(step.p_value)}."
    if step.dropped:
        said += f" It made superfluous: {', '.join(effect_word(one, kind) for one in step.dropped)}."
    return _MINUS.sub("−", said)


def _chances(p_value: float) -> str:
    return "at most one capture of 1000" if p_value <= LEAST_P else f"{100.0 * p_value:.2g} captures of 100"


def _why(learned: LearningResult) -> str:
    said = "Where the first model failed: the residual along every axis, beside the band of chance."
    return "\n".join(
        [
            paragraph(f"The first model: {worded(learned.before.summary, learned.model.coordinate)}"),
            figure(learned.before.plot(), said),
            wide_table("The error ladder", learned.head, _worded(learned.rows(), learned.model.coordinate)),
        ]
    )


def _alternatives(learned: LearningResult) -> str:
    """What was weighed on each step, and what looks alike in this capture."""
    parts = []
    # Effects that came in as a set were weighed once.
    sets: dict[int, list[str]] = {}
    for step in learned.ladder:
        if step.added is not None and step.diagnosis is not None:
            sets.setdefault(id(step.diagnosis), []).append(effect_word(step.added, learned.model.coordinate))
    for step in learned.ladder:
        if step.added is None or step.diagnosis is None or not step.diagnosis.candidates:
            continue  # what a model brought along was weighed on other captures
        kind = learned.model.coordinate
        names = sets.pop(id(step.diagnosis), None)
        if names is None:
            continue
        parts.append(f"<h3>Instead of {escape(and_words(names))}</h3>")
        if step.equivalent:
            names = [step.added, *step.equivalent]
            shows = [f"{effect_word(name, kind)} shows {catalogued(name, kind).shows}" for name in names]
            parts.append(
                paragraph(f"{_these(learned)} cannot tell them apart. Record a motion in which they differ:")
            )
            parts.append(bullets(shows))
        else:
            parts.append(paragraph("No other effect explains as much for its number of parameters."))
        parts.append(_weighed(step.diagnosis))
    parts.append("<h3>Weighed in the end, and not added</h3>")
    parts.append(_weighed(learned.last))
    if learned.without:
        left_out = (effect_word(one, learned.model.coordinate) for one in learned.without)
        parts.append(paragraph(f"Not weighed at all: {', '.join(left_out)}."))
    return "\n".join(parts)


def _weighed(diagnosis: Diagnosis) -> str:
    if not diagnosis.candidates:
        return paragraph("There was nothing to weigh: the catalogue has no other effect.")
    kind = diagnosis.fit.model.coordinate
    rows = _worded(diagnosis.rows(diagnosis.candidates), kind)
    table = wide_table("Every absent effect, best first", diagnosis.HEAD, rows)
    left_out = bullets(
        f"{effect_word(one, kind)}, left out: {why}" for one, why in diagnosis.left_out.items()
    )
    there = "this capture" if len(diagnosis.fit.prepared) == 1 else "these captures"
    picture = figure(diagnosis.plot(), f"Solid bars: could be missing. Linked: alike in {there}.")
    return picture + table + (left_out if diagnosis.left_out else "")


def _remains(learned: LearningResult) -> str:
    parts = [paragraph(worded(learned.left, learned.model.coordinate))]
    if learned.unexplained is not None:
        parts.append(paragraph(f"Unexplained: {_unexplained(learned)}"))
    said = "Where the last model fails: the residual along every axis, beside the band of chance."
    if len(learned.ladder) > 1:
        parts.append(figure(learned.after.plot(), said))
    if learned.disagreements:
        parts.append("<h3>Where the captures disagree</h3>")
        axis = learned.model.coordinate
        parts.append(bullets(f"{sentence(one.sentence, axis)}." for one in learned.disagreements))
    return "\n".join(parts)


def _unexplained(learned: LearningResult) -> str:
    what, best = learned.unexplained, learned.not_added
    assert what is not None
    does = "No effect of the catalogue does that."
    if learned.one_more is not None:
        does = f"The {len(learned.ladder) - 1} effects that came in do not, and one more would draw anything."
    if best is not None:
        does = (
            f"{effect_word(best.effect, learned.model.coordinate)} could be missing, and is not in the model."
        )
    share = f"{100.0 * what.share:.0f} % of the remaining error variance lies along {axis_word(what.axis)}"
    return f"{share}; {worded(what.hint, learned.model.coordinate)}. {does}"


def _noise(fit: Fit) -> str:
    if math.isnan(fit.noise_floor):
        return f"What the sensor's noise alone would leave is not known ({unheard(fit).why})"
    return f"The sensor's noise alone would leave {fit.noise_floor:.4g} {fit.torque_unit}"


def _sure(learned: LearningResult) -> str:
    fit = learned.fit
    unit = fit.torque_unit
    parts = [
        paragraph(
            f"{_noise(fit)}; the last model leaves {fit.rmse:.4g} {unit}, and {fit.rmse_heldout:.4g} {unit} "
            "on blocks that the fit did not see."
        )
    ]
    if len(learned.captures) > _FEW:
        from .plot.style import name_of

        each = zip(map(name_of, learned.captures), _each(learned), strict=True)
        parts += ["<h3>The captures</h3>", bullets(f"{name}: {facts}" for name, facts in each)]
    if len(learned.params) > _ROOM:
        parts.append(_params("All parameters of the last model", learned))
    said: list[str] = []
    for signals in fit.prepared:
        said += signals.notes
        said += [str(finding) for finding in signals.findings]
    if said:
        parts += ["<h3>Remarks</h3>", bullets(said)]
    return "\n".join(parts)


def _made(learned: LearningResult) -> str:
    signals = learned.fit.signals
    options = "".join(f", {name}={value:g}" for name, value in signals.options.items())
    return f"Made by knobcam {__version__}; signals prepared by '{signals.method}'{options}. SI units."
