"""The verdict of a search in words."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from ..base.said import Advice, OfAxis, OfEffect, Said, joined, number, said
from ..fit.beyond import incoherent
from ..fit.coarse import within_rounding
from ..fit.doubts import log_in_doubt
from ..fit.uncounted import tells_nothing
from ..fit.verdict import explained
from .knocks import KNOCK
from .ties import with_ties

if TYPE_CHECKING:
    from collections.abc import Callable

    from .ladder import Unexplained
    from .learning import LearningResult

    Head = Callable[[str, str], Said]
    """How a sentence begins, beside what was found or alone."""


def headline(story: LearningResult) -> Said:
    """Return the verdict in a sentence, and in others what it may be wrong by and what was left out of it."""
    beyond = story.fit.beyond
    return joined(" ", (_judged(story), _in_doubt(story), beyond and beyond.sentence, _uncounted(story)))


def _in_doubt(story: LearningResult) -> str:
    """That the log may be wrong, where no effect explains what is left and nothing says so already."""
    what, fit = story.unexplained, story.fit
    if what is None or story.cut is not None or fit.log_fault is not None or what.hint == fit.impossible:
        return ""
    doubt = log_in_doubt(fit)
    return f"Beside that {doubt}." if doubt else ""


def _uncounted(story: LearningResult) -> str:
    """What share of the captures says nothing, because a play knocks there as no model tells."""
    captures = story.fit.prepared
    knocks = sum(found.count for one in captures for found in one.findings if found.kind == KNOCK)
    if not knocks:
        return ""
    share = 100.0 * knocks / (knocks + sum(int(one.used.sum()) for one in captures))
    return f"What shows in its knocks alone, {share:.0f} % of what was measured, is not counted."


def _judged(story: LearningResult) -> Said:
    names = joined(" and ", with_ties(story.found, story.ladder))
    what = story.unexplained

    def head(beside: str, alone: str) -> Said:
        return said(f"{{names}} found{beside}", names=names) if names else Said(alone)

    if story.cut is not None:
        whether = head("; whether anything more", "Whether anything")
        return said("{whether} is missing is not known: {why}.", whether=whether, why=story.cut.words)
    if what is None:
        return _nothing_left(story, names, beyond=False)
    if (sieved := story.fit.beyond) is not None and what.hint == sieved.words:
        return _nothing_left(story, names, beyond=True)
    untellable = _not_to_be_told(story, what, head)
    return _still_missing(story, what, head) if untellable is None else untellable


def _nothing_left(story: LearningResult, names: Said, *, beyond: bool) -> Said:
    """What is said where chance explains the rest, or all of it that passes the torque filter."""
    if names:
        was, it = ("was", "it") if len(story.found) == 1 else ("were", "them")
        rest = "what else passes the torque filter" if beyond else "the rest"
        if not story.after.complete:
            off = math.sqrt(max(story.fit.excess, 0.0) / explained(story.fit))
            rest = f"{rest}, beside {100.0 * off:.1f} % by which a law may be off,"
        return said(f"{{names}} {was} missing; with {it} {rest} is chance.", names=names)
    if beyond:
        return Said("Nothing is missing of what passes the torque filter: chance explains that.")
    these = "these captures" if len(story.fit.prepared) > 1 else "this capture"
    return Said(f"Nothing is missing that {these} could show: chance explains the error.")


def _not_to_be_told(story: LearningResult, what: Unexplained, head: Head) -> Said | None:
    """What keeps anything from being said of what is left; None where nothing does."""
    share, along = number(100.0 * what.share, "%", ".0f"), OfAxis(what.axis)
    if (fault := story.fit.log_fault) is not None:
        said_so = "The log or its map is to be mended first, until then it tells nothing: {fault}."
        return said(said_so, fault=fault)
    if what.hint == tells_nothing(story.fit.prepared):
        return said("Whether anything is missing cannot be told: {hint}.", hint=what.hint)
    if math.isnan(story.noise_floor):
        return said(
            "Whether anything is missing cannot be told: these samples do not show how much of the "
            "error is noise; {share} of it lies along {along}.",
            share=share,
            along=along,
        )
    if what.hint == story.fit.impossible:
        return said(
            "{the} model leaves chance alone, but {hint}: it is not this knob's. Look for swapped "
            "columns, signs, units and parts that belong to another run{how}.",
            the=head("; the", "The"),
            hint=what.hint,
            how=Advice(" (--start, --end)", "command"),
        )
    if incoherent(story.fit):
        return said(
            "{what} is left, {share} of it along {along} ({hint}), cannot be told from errors of the "
            "recorded motion.",
            what=head("; what", "What"),
            share=share,
            along=along,
            hint=what.hint,
        )
    if (steps := within_rounding(story.fit)) is not None:
        return said(
            "{what} is left, {share} of it along {along}, cannot be told from the rounding of the "
            "torque, which is read in steps of {steps}.",
            what=head("; what", "What"),
            share=share,
            along=along,
            steps=number(steps, story.fit.torque_unit),
        )
    return None


def _still_missing(story: LearningResult, what: Unexplained, head: Head) -> Said:
    """What is said of what is left and no effect that is in the model explains."""
    share, along = number(100.0 * what.share, "%", ".0f"), OfAxis(what.axis)
    if (best := story.not_added) is not None:
        return said(
            "{what} is missing and not in the model yet: {best}, which takes {fall} off the error.",
            what=head(", and more", "Something"),
            best=OfEffect(best.effect),
            fall=number(100.0 * best.error_fall, "%", ".1f"),
        )
    something = head(", and still something", "Something")
    if (more := story.one_more) is not None and not story.after.complete:
        return said(
            "{something} is missing that {count} effects together do not explain: {share} of the "
            "remaining error lies along {along} ({hint}). One more, such as {more}, would take "
            "{fall} off it, but so many draw nearly anything.",
            something=something,
            count=str(len(story.ladder) - 1),
            share=share,
            along=along,
            hint=what.hint,
            more=OfEffect(more.effect),
            fall=number(100.0 * more.error_fall, "%", ".0f"),
        )
    template = (
        "{something} is missing that no single effect of the catalogue explains: {share} of the "
        "error lies along {along} ({hint}); with these the rest is chance."
        if story.after.complete
        else "{something} is missing that no effect of the catalogue explains: {share} of the "
        "remaining error lies along {along} ({hint})."
    )
    return said(template, something=something, share=share, along=along, hint=what.hint)
