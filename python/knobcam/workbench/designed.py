"""The motion of a next experiment as a session keeps it: its rivals, what it promises, what came of it."""

from __future__ import annotations

from dataclasses import asdict, dataclass, fields, replace
from typing import TYPE_CHECKING, Any

import numpy as np

from ..base import pages_next
from ..base.said import OfParam, Said, joined, number, said
from ..capture.by_hand import by_hand, hand_can
from ..capture.motion_plan import MotionPlan
from ..fit import fit
from ..fit.rule import RULE
from ..learn.designing import SEARCH, next_experiment
from ..learn.experiment import Change
from ..learn.limits import Limits
from ..learn.showing_more import along, longest_s
from ..learn.telling import TOLD, Telling, apart, wrong_choice
from ..model import Model
from ..model.simulate import exact

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from ..base.arrays import FloatArray
    from ..capture import Capture
    from ..learn import LearningResult
    from ..learn.experiment import Experiment
    from .tell import Tell
    from .tree import Node

_SHOWN = 4000  # samples of a motion, which a page draws and a hand is led through
_SENTENCES = ("promise", "headline", "verdict")


@dataclass(frozen=True)
class Pair:
    """Two rivals by their places: D that was promised, D of the best standard motion, and D that came."""

    one: int
    other: int
    d: float
    standard_d: float
    came: float | None = None


@dataclass(frozen=True)
class Known:
    """The parameter that a motion makes known best where nothing is to be told apart, and its error now."""

    param: str
    before: float


@dataclass(frozen=True, eq=False)
class Designed:
    """A motion that was designed at a node of a session; `white` is the variance of the noise, (N m)^2.

    `names` and `models` are the rivals' as fitted by then. `capture` is the recording that was made of it,
    and `verdict` what that told; `right` is the place of the rival that alone explains it, if one does.
    """

    id: str
    node: str
    names: tuple[Said, ...]
    models: tuple[Model, ...]
    plan: MotionPlan
    limits: Limits
    white: float
    headline: Said
    separable: bool
    pairs: tuple[Pair, ...]
    capture: str | None = None
    verdict: Said | None = None
    right: int | None = None
    known: Known | None = None
    promise: Said | None = None
    change: Change | None = None

    def of_use(self, done: Sequence[Node]) -> bool:
        """Whether it is for a branch that came this way; one that was not recorded is for its model alone.

        Nor is it for other captures than those that it was designed from, which are of another knob. Where
        its recording was undone, what came of it is not so.
        """
        way = done[:-1] if self.capture else done[-1:]
        return any(one.id == self.node and {*one.captures} <= {*done[-1].captures} for one in way)

    def track(self) -> Any:
        """Return the motion at the rate of the captures."""
        return self.plan.track(self.limits.sample_rate_hz)

    def columns(self) -> dict[str, FloatArray]:
        """Return the motion and by what each rival's torque differs from their mean, thinned for the eye.

        Of one model alone, what its torque is.
        """
        track = self.track()
        coordinate = self.models[0].coordinate
        still = exact(coordinate, track)
        torques = np.array([model.core.torque(still, filtered=False) for model in self.models])
        apart = torques - torques.mean(axis=0) if len(torques) > 1 else torques
        some = slice(None, None, max(1, -(-len(track.t) // _SHOWN)))
        found = {"t": track.t, "theta": track.theta, "omega": track.omega}
        found |= {f"rival {at}": torque for at, torque in enumerate(apart)}
        return {name: column[some] for name, column in found.items()}

    def document(self, source: str | None) -> pages_next.Experiment:
        """Return what a page shows of it; `source` is what it can be recorded from at once, in words."""
        steps = by_hand(self.plan, self.models[0].coordinate)
        return {
            "id": self.id,
            "rivals": [one.document() for one in self.names],
            "promises": (Said(self.promise, ".") if self.promise else self.headline).document(),
            "headline": self.headline.document(),
            "separable": self.separable,
            "seconds": self.plan.seconds,
            "limits": self.limits.numbers,
            "change": None if self.change is None else {"limit": self.change.limit, "to": self.change.to},
            "pairs": [
                {
                    "names": (self.names[one.one].document(), self.names[one.other].document()),
                    "d": one.d,
                    "standard_d": one.standard_d,
                    "wrong_choice": wrong_choice(one.d),
                    "came": one.came,
                }
                for one in self.pairs
            ],
            "told": TOLD,
            "by_hand": hand_can(steps),
            "steps": [
                {
                    "words": one.words,
                    "seconds": one.seconds,
                    "beats": one.beats_per_minute,
                    "cannot": one.cannot,
                }
                for one in steps
            ],
            "source": source,
            "capture": self.capture,
            "verdict": None if self.verdict is None else self.verdict.document(),
        }

    def record(self) -> dict[str, Any]:
        """Return it as a journal keeps it."""
        told: dict[str, Any] = {one.name: getattr(self, one.name) for one in fields(self)}
        told |= {"models": [model.text() for model in self.models], "plan": self.plan.text()}
        told |= {"known": None if self.known is None else asdict(self.known)}
        told |= {"names": [one.document() for one in self.names]}
        told |= {name: told[name] and told[name].document() for name in _SENTENCES}
        return told | {"limits": asdict(self.limits), "pairs": [asdict(pair) for pair in self.pairs]}

    @classmethod
    def again(cls, told: Mapping[str, Any]) -> Designed:
        """Return what `record` told."""
        given = dict(told)
        given["names"] = tuple(map(_sentence, told["names"]))
        given |= {name: told[name] and _sentence(told[name]) for name in _SENTENCES if name in told}
        given["models"] = tuple(Model.parse(text) for text in told["models"])
        given["plan"] = MotionPlan.parse(told["plan"])
        given["limits"] = Limits(**told["limits"])
        given["pairs"] = tuple(Pair(**pair) for pair in told["pairs"])
        known = told.get("known")  # which older journals do not have
        given["known"] = None if known is None else Known(**known)
        given["change"] = Change(*told["change"]) if told.get("change") else None
        return cls(**given)


def _sentence(told: str | list[Any]) -> Said:
    """Return what a journal kept of a sentence; older ones have it as text."""
    return Said(told) if isinstance(told, str) else Said.of(told)


def rivals(story: LearningResult, names: Sequence[str]) -> list[str]:
    """Return the sets that are to be told apart, for `next_experiment`: one with each of these effects.

    What the model has besides stays in each; of those that it has already, each takes the others' place.
    """
    base = story.ladder[0].fit.model.effects
    beyond = [one for one in story.ladder[-1].fit.model.effects if one not in base]
    rest = [one for one in beyond if one not in names]
    return ["+".join([*rest, one]) for one in names]


def designed(
    story: LearningResult,
    names: Sequence[str],
    limits: Mapping[str, Any],
    by_hand: bool,
    node: str,
    tell: Tell,
    sharpen: str = "",
) -> Designed:
    """Return the motion that would tell models with each of these effects apart.

    With `sharpen` the one that makes that parameter known best. Of none: what the captures could not tell;
    where something is left that has no name, the motion that shows more of that, and where they told
    everything, the one that makes the parameter known best which is known least.
    """
    tell("fitting the rivals")
    axis = None if names or sharpen else along(story)
    within = Limits.reached(story.fit.prepared, longest_s(axis)).with_some(limits)
    found = next_experiment(
        story,
        rivals=() if sharpen else rivals(story, names),
        sharpen=sharpen or None,
        limits=within,
        by_hand=by_hand,
        progress=tell,
        between=lambda: tell(SEARCH),  # a search that nobody wants any more would take the processors
    )
    return _kept(found, node)


def _kept(found: Experiment, node: str) -> Designed:
    return Designed(
        "",
        node,
        (Said("the model as it is"),) if found.shows else apart(found.rivals),
        tuple(one.fit.model for one in found.rivals),
        found.plan,
        found.limits,
        Telling(found.rivals).white,
        found.headline,
        found.separable,
        tuple(Pair(*one.pair, one.d, one.standard_d) for one in found.expected),
        known=next((Known(one.param, one.before) for one in found.sharpened), None),
        promise=found.promise,
        change=found.change,
    )


def came(
    kept: Designed, captures: Sequence[Capture], name: str, options: Mapping[str, Any], tell: Tell
) -> Designed:
    """Return it with what a recording of the motion told: every rival is fitted to it and to all before."""
    if kept.known is not None:
        return _sharper(kept, kept.known, captures, name, options, tell)
    if len(kept.names) == 1:
        return _seen(kept, captures, name, options, tell)
    left, params, fits = [], [], []
    for rival, model in zip(kept.names, kept.models, strict=True):
        tell(f"fitting {rival} to all")
        fitted = fit(captures, model, **options)
        used = sum(one.core.used for one in fitted.prepared)
        left.append(fitted.rmse**2 * used / kept.white)
        params.append(len(fitted.core.free))
        fits.append(fitted)
    # As `learn` weighs what could be missing: by what they leave and the price of their parameters.
    cost = [one + RULE.price * count for one, count in zip(left, params, strict=True)]
    best = int(np.argmin(cost))
    others = [at for at in range(len(left)) if at != best]
    tied = [at for at in others if cost[at] - cost[best] <= RULE.alike]
    words = [said("{best} explains all captures best", best=kept.names[best])]
    for at in (one for one in others if one not in tied):
        if left[at] - left[best] > RULE.alike:
            leaves = "{name} leaves {more} where it leaves {least}"
            unit, [more, least] = fits[best].torque_unit, (fits[one].rmse for one in (at, best))
            error = {"more": number(more, unit), "least": number(least, unit)}
            words.append(said(leaves, name=kept.names[at], **error))
        else:
            words.append(said("{name} explains too little more for its parameters", name=kept.names[at]))
    if tied:
        names = joined(", ", (kept.names[at] for at in tied))
        words.append(said("still not told from it: {names}", names=names))
    pairs = tuple(replace(one, came=abs(left[one.one] - left[one.other])) for one in kept.pairs)
    verdict = said("{words}.", words=joined("; ", words))
    # Who is best while something else is missing too may be so for what it takes of that.
    lacking = fits[best].noise_floor > 0.0 and not fits[best].compare().complete
    if lacking:
        whole = (
            "{verdict} None leaves only chance: something else is missing too, so add one and weigh again."
        )
        verdict = said(whole, verdict=verdict)
    right = None if tied or lacking else best
    return replace(kept, pairs=pairs, capture=name, verdict=verdict, right=right)


def _seen(
    kept: Designed, captures: Sequence[Capture], name: str, options: Mapping[str, Any], tell: Tell
) -> Designed:
    """Return a motion that was to show more of what is left with what that is of all captures now."""
    tell("fitting all")
    now = fit(captures, kept.models[0], **options).compare()
    return replace(kept, capture=name, verdict=said("With it: {now}", now=now.summary))


def _sharper(
    kept: Designed,
    known: Known,
    captures: Sequence[Capture],
    name: str,
    options: Mapping[str, Any],
    tell: Tell,
) -> Designed:
    """Return a motion for one parameter with how well that is known by all captures now."""
    tell("fitting all")
    now = fit(captures, kept.models[0], **options).params[known.param]
    times = f"{known.before / now.se:.3g} times as well as before" if now.se > 0.0 else "exactly"
    half = 0.5 * (now.ci95[1] - now.ci95[0])
    verdict = said(
        "{param} is known {times}: {value} ± {half}.",
        param=OfParam(known.param),
        times=times,
        value=number(now.value, now.unit),
        half=number(half, now.unit, ".2g"),
    )
    return replace(kept, capture=name, verdict=verdict, right=0)
