"""What the knocks of a play hide: a search beside them, and the play put back."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from .. import _core
from ..base.said import OfColumn, number, said
from ..capture.finding import Finding, spans
from ..fit.knocked import between_knocks
from ..fit.refit import converged, cores, on, started
from ..fit.rule import RULE
from .joined import chance_of
from .ladder import LearningStep, first_weighed

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from ..capture.prepare import Prepared
    from ..fit import Fit
    from ..fit.diagnose import Candidate, Diagnosis

KNOCK = "knock"
"""The finding that says what of a capture is not counted."""


class Knocks(NamedTuple):
    """A play, the fit that found it, and the captures without what was measured while it knocks."""

    joint: str
    gapped: Fit
    known: Diagnosis
    quiet: tuple[Prepared, ...]


def knocking(ladder: Sequence[LearningStep], last: Diagnosis) -> Knocks | None:
    """Return the play at whose knocks most of what is left lies; None where there is none.

    When a knock begins is known to a row of the log at best, and how it goes on no law of a contact tells as
    well as it is measured: what is left there is no sign of another effect, and hides those that there are.
    """
    for joint, gapped, known in _plays(ladder, last):
        if any(one.capture.clipped for one in gapped.prepared):
            return None  # what is counted of it changes as effects come in
        floor = gapped.noise_floor
        squares, rows, parts = np.zeros(2), np.zeros(2), between_knocks(gapped)
        for one, part, rest in zip(gapped.prepared, parts, gapped.residuals, strict=True):
            for at, counted in enumerate((one.used & ~part.used, one.used)):
                squares[at] += np.sum(np.square(rest[one.rows[counted]]))
                rows[at] += np.sum(counted)
        inside, every = squares - rows * floor**2
        if 0 < rows[0] <= RULE.knocks * rows[1] and inside >= RULE.knocking * every > 0.0:
            times = float(np.sqrt(squares[0] / rows[0])) / floor
            told = (_told(*both, times) for both in zip(gapped.prepared, parts, strict=True))
            return Knocks(joint, gapped, known, tuple(told))
    return None


def _plays(ladder: Sequence[LearningStep], last: Diagnosis) -> Iterator[tuple[str, Fit, Diagnosis]]:
    """Go through the joints that were found: that of the model, or those that only another effect beat."""
    end, weighed = ladder[-1].fit, first_weighed(ladder) or last
    if end.model.joint is not None:
        yield end.model.joint, end, weighed
        return

    def could(one: Candidate) -> bool:
        return one.place == "coupling" and one.beyond_chance and not one.implausible

    for known in (last, weighed):
        yield from ((one.effect, one.fit, known) for one in known.candidates if could(one))


def _told(one: Prepared, quiet: Prepared, times: float) -> Prepared:
    """Return a capture without its knocks, which says so."""
    rows = one.rows[one.used & ~quiet.used]
    if not len(rows):
        return one
    words = said(
        "{tau}: {count} rows around knocks at the ends of a play do not count: they are {times} times the "
        "noise off, for when a knock begins and how it goes on no model tells as well as it is measured",
        tau=OfColumn("tau"),
        count=len(rows),
        times=number(times, "", ".2g"),
    )
    found = Finding(KNOCK, "tau", len(rows), spans(rows), words, "masked")
    return replace(quiet, findings=(*one.findings, found))


def quiet(knocks: Knocks, first: Fit) -> LearningStep:
    """Return the first model on what was measured while nothing knocks."""
    return LearningStep(on(replace(first, before=None), knocks.quiet))


def beside_play(knocks: Knocks, rigid: LearningStep) -> LearningStep:
    """Return the step to the play alone, which shows between its knocks too."""
    alone = knocks.gapped.core.model.only([*rigid.effects, knocks.joint])
    core = _core.refine(cores(rigid.fit), alone, True)
    joined = replace(rigid.fit, core=core, before=rigid.fit)
    # It may have come in with another effect, and not be among those that were weighed alone.
    p_value = chance_of(joined, rigid.fit, knocks.known)
    return LearningStep(joined, knocks.joint, p_value, (), (), knocks.known)


def with_play(knocks: Knocks, ladder: Sequence[LearningStep]) -> list[LearningStep] | None:
    """Return the steps of a search beside knocks and as the last one the play, on what that was held on.

    It is fitted, and has to be worth it, on all that was measured; None where it is not.
    """
    end, prefix = ladder[-1].fit, f"{knocks.joint}."
    rigid = on(replace(end, before=None), knocks.gapped.prepared)
    own = {name: one.value for name, one in knocks.gapped.params.items() if name.startswith(prefix)}
    joined = converged(started(rigid, knocks.joint, {name[len(prefix) :]: own[name] for name in own}))
    p_value = chance_of(joined, rigid, knocks.known)
    if p_value > RULE.chance or joined.rmse >= knocks.gapped.rmse:
        return None
    last = replace(on(joined, knocks.quiet), before=end)
    return [*ladder, LearningStep(last, knocks.joint, p_value, (), (), knocks.known)]
