"""Which effects come in, in which order, and when to stop."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING

from ..base.said import OfEffect, said
from ..base.said import joined as in_words
from ..fit.absent import absent
from ..fit.diagnose import Candidate, Diagnosis, diagnose, worth_adding
from ..fit.plausible import columns_at_fault
from ..fit.refit import begun, converged, drop, gain, with_clipped
from ..fit.rule import RULE
from ..fit.verdict import judged, within_law
from ..model.effects import base_effects_shown, clipping, descriptions
from .cut import Deadline, OutOfTime
from .earlier import retested, without_help
from .exchanged import anew, at_own_values, exchanged, straightened, with_detents, with_other_detents
from .joined import chance_of, joined, rejoined
from .joints import followed_to, joints, overlooked
from .knocks import beside_play, knocking, quiet, with_play
from .ladder import LearningStep, first_weighed
from .loosened import loosened
from .selection import Selection, concluded, cut_short
from .ties import told_again

if TYPE_CHECKING:
    from collections.abc import Callable, Collection, Sequence

    from ..fit import Fit


@dataclass(frozen=True)
class Search:
    """A search: from which model, without which effects, and until when, or until Ctrl-C.

    `given` says that a user gave the first model; the base model has detents where there are any, so that
    these are nothing to find. `detents` says that they come in by themselves where the data show them.
    """

    first: Fit
    without: Collection[str]
    tell: Callable[[str], None]
    deadline: Deadline
    given: bool
    detents: bool

    def selected(self) -> Selection:
        """Add effects as long as one is beyond chance, physical and worth it; re-test the earlier ones."""
        clips = clipping(self.first.model.coordinate) - set(self.without)
        ladder = [LearningStep(with_clipped(self.first) if clips else self.first)]
        try:
            grown = self.beside_a_joint(self.grown(ladder))
            return self.told(grown if grown.unexplained is None else self.between_knocks(grown))
        except (OutOfTime, KeyboardInterrupt) as ended:
            return cut_short(ladder, self.deadline.cut(ended), self.base)

    @property
    def base(self) -> Collection[str]:
        """The effects that are no finding: those of a first model that was given, or the base's."""
        own = self.first.model.effects
        return own if self.given else [*own, *base_effects_shown(self.first.model.coordinate)]

    def grown(self, ladder: list[LearningStep], without: Collection[str] = ()) -> Selection:
        """Let a ladder grow in place to its end."""
        return _Climb(self, ladder, {*self.without, *without}).ended()

    def beside_a_joint(self, grown: Selection) -> Selection:
        """Search once more beside the joint alone, where what came in before it may have stood in for it."""
        start = joint_first(grown.ladder)
        if start is None:
            return grown
        template = "weighing what could be missing beside {joint} alone"
        self.tell(said(template, joint=OfEffect(str(start.added))))
        again = self.grown([grown.ladder[0], start])
        return again if again.unexplained is None else grown

    def between_knocks(self, grown: Selection) -> Selection:
        """Search once more between the knocks of a play, at which most of what is left lies."""
        knocks = knocking(grown.ladder, grown.last)
        if knocks is None:
            return grown
        template = "weighing what could be missing between the knocks of {it}"
        self.tell(said(template, it=OfEffect(knocks.joint)))
        rigid = quiet(knocks, grown.ladder[0].fit)
        again = self.grown([rigid], joints(rigid.fit.model.coordinate))
        if again.unexplained is None and (steps := with_play(knocks, again.ladder)) is not None:
            again = self.ended(steps)
        else:
            again = self.grown([rigid, beside_play(knocks, rigid)])
        return again if again.unexplained is None and knocks.joint in again.found else grown

    def told(self, grown: Selection) -> Selection:
        """Tell apart beside all that came in what could not be told apart when it came in."""
        steps = told_again(grown.ladder, self.tell, self.deadline)
        same = steps[-1].fit is grown.ladder[-1].fit
        return grown._replace(ladder=steps) if same else self.ended(steps)

    def ended(self, steps: Sequence[LearningStep]) -> Selection:
        """Conclude from steps beside which nothing more is weighed."""
        return concluded(steps, diagnose(steps[-1].fit, only=()), self.base)


@dataclass
class _Climb:
    """A ladder that grows, and which of the searches that are made once were made."""

    search: Search
    ladder: list[LearningStep]
    without: Collection[str]
    together: bool = False
    sets: bool = False
    helped: set[str] = field(default_factory=set)

    def __post_init__(self) -> None:
        coordinate = self.fit.model.coordinate
        self.barred = {*self.without, *descriptions(coordinate)}
        self.shown = base_effects_shown(coordinate)
        self.base = self.fit.model.effects

    @property
    def fit(self) -> Fit:
        """Where it stands."""
        return self.ladder[-1].fit

    def ended(self) -> Selection:
        """Let it grow to its end."""
        while True:
            self._stands_at(begun(self.fit))
            fit, diagnosis = self.fit, self._weighed()
            if self._freed(diagnosis) or self._bent(diagnosis) or self._other_sets(diagnosis):
                continue
            best = diagnosis.best
            if best is None or len(self.ladder) > RULE.most or columns_at_fault(fit.prepared):
                selection = concluded(self.ladder, diagnosis, self.search.base)
                # What is wrong with a log, or lies beyond its filter, no effect explains.
                enough = diagnosis.comparison.complete or within_law(fit)
                if self.together or fit.log_fault or enough or not fit.noise_floor > 0.0:
                    return selection
                led = followed(diagnosis, self.search.tell)
                diagnosis = led or diagnosis
                best = led.best if led is not None else None
                if best is None:
                    if self._with_a_joint(first_weighed(self.ladder) or diagnosis, fit):
                        continue
                    return selection
            self._add(diagnosis, best)

    def _weighed(self) -> Diagnosis:
        """Weigh everything that is not in the model."""
        there = in_words(", ", map(OfEffect, self.fit.model.effects))
        self.search.tell(said("weighing what could be missing from {there}", there=there))
        deadline = self.search.deadline
        deadline.weighing = absent(self.fit, self.barred)[0]
        deadline()
        return overlooked(worth_adding(self.fit, self.without, deadline), self.barred, deadline)

    def _stands_at(self, fit: Fit | None) -> bool:
        """Take another fit of the same model for where it stands, if there is one."""
        if fit is not None:
            self.ladder[-1] = replace(self.ladder[-1], fit=fit)
        return fit is not None

    def _begins(self, steps: Sequence[LearningStep] | None) -> bool:
        """Take other steps after the first one, if there are some."""
        if steps is not None:
            self.ladder[1:] = steps
        return steps is not None

    def _freed(self, diagnosis: Diagnosis) -> bool:
        """Let go what holds a parameter of the model, where that is worth more than the best effect."""
        best = diagnosis.best
        return self._stands_at(loosened(diagnosis, best.score if best else 0.0))

    def _bent(self, diagnosis: Diagnosis) -> bool:
        """Begin with a joint and another effect together, where one shows bent by the other."""
        if self.together or len(self.ladder) > 1 or not bent(diagnosis):
            return False
        best = diagnosis.best
        return self._with_a_joint(diagnosis, best.fit if best else self.fit)

    def _with_a_joint(self, diagnosis: Diagnosis, beside: Fit) -> bool:
        """Begin with a joint and another effect together."""
        self.together = True
        self.search.tell("weighing what could be missing together with a joint of shaft and knob")
        self.search.deadline.weighing = ["sets of a joint and another effect"]
        return self._begins(joined(diagnosis, beside, self.barred, self.search.deadline))

    def _other_sets(self, diagnosis: Diagnosis) -> bool:
        """Weigh what came in against other sets, once nothing more comes in."""
        fit, deadline = self.fit, self.search.deadline
        if diagnosis.best is not None or self.sets or fit.log_fault or not fit.noise_floor > 0.0:
            return False
        self.search.tell("weighing what came in against other sets")
        if self._stands_at(at_own_values(self.ladder, deadline)):
            return True
        if self._stands_at(anew(self.ladder, diagnosis.comparison, deadline)):
            return True
        if (steps := straightened(diagnosis, deadline)) is not None:
            self.ladder += steps
            return True
        self.sets = True
        return self._begins(exchanged(self.ladder, diagnosis.comparison, deadline)) or self._begins(
            rejoined(self.ladder, self.barred, deadline)
        )

    def _with_detents(self, fit: Fit) -> Fit:
        """Return a fit with the detents that show in it now, where they come in by themselves."""
        return with_detents(fit) if self.search.detents and fit.model.period is None else fit

    def _add(self, diagnosis: Diagnosis, best: Candidate) -> None:
        """Go a step up, unless what came in before does better without help than with what would come in."""
        detents, tell = self.search.detents, self.search.tell
        tell(said("adding {best}", best=OfEffect(best.effect)))
        fit = self.fit
        best, richer = followed_to(diagnosis, best, self._with_detents)
        tell("re-testing the effects that came in before")
        came = {*(step.added for step in self.ladder), *self.shown}
        own = (*self.base, best.effect)
        tested = [one for one in richer.model.effects if one in came and one not in own]
        if best.effect not in self.helped and self._stands_at(without_help(richer, best, fit)):
            self.helped.add(best.effect)
            return
        shown = [one for one in self.shown if detents and one in self.base]
        richer, dropped = retested(richer, [*tested, *shown])
        richer = replace(converged(richer) if dropped else richer, before=fit)
        richer = with_other_detents(richer) if detents else richer
        step = LearningStep(richer, best.effect, best.p_value, best.equivalent, dropped, diagnosis)
        self.ladder.append(step)


def joint_first(ladder: Sequence[LearningStep]) -> LearningStep | None:
    """Return the step to a joint alone that came in after others, where more came in than are believed.

    What came in before it may have stood in for it, and what came in after it for what that bent. None where
    it came in first, and without one.
    """
    last, diagnosis = ladder[-1].fit, first_weighed(ladder)
    came = [step.added for step in ladder if step.added in last.model.effects]
    joint = last.model.joint
    if diagnosis is None or joint not in came[1:] or len(came) <= RULE.believed or last.log_fault is not None:
        return None
    bare = last
    for one in came:
        # What changes another went with that.
        if one is not None and one != joint and one in bare.model.effects:
            bare = drop(bare, one)
    alone = replace(converged(bare), before=diagnosis.fit)
    p_value = chance_of(alone, diagnosis.fit, diagnosis)
    return LearningStep(alone, joint, p_value, (), (), diagnosis) if p_value <= RULE.chance else None


def followed(diagnosis: Diagnosis, tell: Callable[[str], None]) -> Diagnosis | None:
    """Return a diagnosis with the coupling that leads the candidates followed to its end; None without one.

    Candidates are sketched, and the error of a coupling is so rough that a sketch may stop far from its end.
    """
    led = [one for one in diagnosis.candidates if one.beyond_chance and not one.implausible]
    best = max(led, key=lambda one: one.score, default=None)
    if best is None or best.place != "coupling":
        return None
    tell(said("following {best} to its end", best=OfEffect(best.effect)))
    fit = diagnosis.fit
    end = replace(best, fit=replace(converged(best.fit), before=fit))
    end = replace(end, gain=gain(fit, end.fit, fit))
    rest = [one for one in diagnosis.candidates if one is not best]
    return replace(diagnosis, candidates=judged(diagnosis.comparison, [end, *rest]))


def bent(diagnosis: Diagnosis) -> bool:
    """Whether a joint leads that cannot be one by its values, and what would be added in its place is a part.

    What loads the shaft beside it bends it so; one after the other neither is found.
    """
    led = max(diagnosis.candidates, key=lambda one: one.score, default=None)
    best = diagnosis.best
    open_still = best is None or best.word == "part"
    return led is not None and led.place == "coupling" and led.word == "implausible" and open_still
