"""The next experiment: the motion that tells apart what captures so far cannot, within limits."""

from __future__ import annotations

import os
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any, NamedTuple

from ..base import showing
from ..base.said import OfAxis, OfParam, Said, joined, said
from ..base.tables import TextTable, text_table
from ..capture.motion_plan import MotionPlan
from ..capture.motions import MotionTrack
from ..errors import InputError
from .limits import Limits
from .telling import TOLD, Rival, apart, wrong_choice
from .to_record import TELLS

if TYPE_CHECKING:
    from pathlib import Path

    from ..base.showing import Figure


_SHARPER = 1.1
"""Times as well as now that a parameter has to be known after a motion that is worth recording."""


class Expected(NamedTuple):
    """A pair of rivals (places in `Experiment.rivals`): D of the motion, and of the best standard one."""

    pair: tuple[int, int]
    d: float
    standard_d: float

    @property
    def wrong_choice(self) -> float:
        """How often the wrong one would be chosen."""
        return wrong_choice(self.d)


class Sharpened(NamedTuple):
    """A parameter and its standard error: now, after the motion, and after the best standard one."""

    param: str
    before: float
    after: float
    after_standard: float


class Change(NamedTuple):
    """The limit that would have to be widened, to what, and the least D then."""

    limit: str
    to: float
    d: float


class NoMotion(InputError):
    """No motion is within the limits; `enough` is a limit, and how wide it would have to be, where known."""

    def __init__(self, message: str, enough: tuple[str, float] | None) -> None:
        way = "" if enough is None else f": with {enough[0]} = {enough[1]:.4g} there is one"
        super().__init__(f"{message}{way}")
        self.enough = enough


@dataclass(frozen=True, eq=False, repr=False)
class Experiment(showing.Tabled):
    """A motion, and what it is expected to tell; immutable.

    `expected` has a row for each pair of rivals, `sharpened` one for each parameter that was asked for;
    `shows` is the axis of which it shows more, where something is left that no effect explains.
    `change` is the smallest change of the limits that would tell the rivals apart where the motion does not;
    None: none that was tried would.
    """

    rivals: tuple[Rival, ...]
    limits: Limits
    plan: MotionPlan
    track: MotionTrack
    expected: tuple[Expected, ...]
    peak: tuple[float, float, float]
    sharpened: tuple[Sharpened, ...] = ()
    change: Change | None = None
    took_s: float = field(default=0.0, compare=False)
    left_out: tuple[Rival, ...] = ()
    shows: str | None = None
    untied: bool = False
    """Whether it sharpens because nobody asked for anything and the captures leave nothing to tell apart."""

    @property
    def separable(self) -> bool:
        """Whether all rivals are told apart: D is at least 10.8, and at most 5 of 100 choices are wrong."""
        return all(one.d >= TOLD for one in self.expected)

    @property
    def useful(self) -> bool:
        """Whether some of the rivals are told apart, a parameter is known better, or the rest is."""
        return self.shows is not None or self._sharper or any(one.d >= TOLD for one in self.expected)

    @property
    def _sharper(self) -> bool:
        """Whether the parameter that was asked for would be known better."""
        return any(one.before >= _SHARPER * one.after for one in self.sharpened)

    @property
    def promise(self) -> Said | None:
        """What the motion would tell, without how it moves; None where it tells nothing."""
        if self.shows is not None:
            more = "{seconds:.3g} s that show more of what is left along {axis}"
            return said(more, seconds=self.seconds, axis=OfAxis(self.shows))
        if self.sharpened:
            one = self.sharpened[0]
            if not self._sharper:
                return None
            return said(
                "{param} would be known {times:.3g} times as well after {seconds:.3g} s",
                param=OfParam(one.param),
                times=one.before / one.after,
                seconds=self.seconds,
            )
        told = [one for one in self.expected if one.d >= TOLD]
        if not told:
            return None
        worst = min(told, key=lambda one: one.d)
        return said(
            "{seconds:.3g} s tell {names} apart (the wrong one is chosen in {wrong} of cases)",
            seconds=self.seconds,
            names=self._every if len(told) == len(self.expected) else self._names(worst),
            wrong=_percent(worst.wrong_choice),
        )

    @property
    def untold(self) -> Said | None:
        """Which of the rivals no motion tells apart, or what none makes known better; None where one does."""
        if self.sharpened and not self._sharper:
            better = "No motion within these limits makes {param} known better than these captures do."
            return said(better, param=OfParam(self.sharpened[0].param))
        if self.sharpened or self.separable:
            return None
        worst = min(self.expected, key=lambda one: one.d)
        if worst.standard_d >= TOLD:
            cut = (
                "The motion that was found does not tell {names} apart, D is {d:.3g}; a standard one as "
                "large as the limits would, D is {standard:.3g}: the search ended too soon. Try again on a "
                "machine with less to do, or with fewer rivals."
            )
            return said(cut, names=self._names(worst), d=worst.d, standard=worst.standard_d)
        return said(
            "No runnable motion within these limits tells {names} apart: D is {d:.3g} at most{changed}",
            names=self._names(worst),
            d=max(worst.d, worst.standard_d),
            changed=self._changed(),
        )

    @property
    def headline(self) -> Said:
        """What the motion would tell, and how it moves, in a sentence."""
        promise = self.promise
        whole = promise and said("{promise}: {about}.", promise=promise, about=self.plan.about)
        return joined(" ", (self._untied, whole, self._tells, self._as_usual, self.untold, self._left_out))

    @property
    def _untied(self) -> str:
        """Why a parameter is sharpened that nobody asked for."""
        why = "These captures leave nothing tied, so the widest parameter is to be known better."
        return why if self.untied else ""

    @property
    def _tells(self) -> str:
        """What is to be seen in a motion that shows more of what has no name."""
        tells = TELLS.get(self.shows or "", "")
        return f"{tells[:1].upper()}{tells[1:]}." if tells else ""

    @property
    def _as_usual(self) -> str:
        """That no motion had to be designed for this, where that is so."""
        usual = self.separable and min((one.standard_d for one in self.expected), default=0.0) >= TOLD
        return "Standard motions within these limits would, too." if usual else ""

    @property
    def _left_out(self) -> Said | None:
        """Which rivals no motion can be for."""
        if not self.left_out:
            return None
        why = "{names}: left out, as on any motion within these limits it asks for more torque than there is."
        return said(why, names=joined(", ", (one.name for one in self.left_out)))

    def _names(self, one: Expected, between: str = " and ") -> Said:
        names = apart(self.rivals)
        return joined(between, (names[i] for i in one.pair))

    @property
    def _every(self) -> Said:
        *head, last = apart(self.rivals)
        return joined(" and ", (joined(", ", head), last))

    def _changed(self) -> str:
        if self.change is None:
            return ", and no limit that alone is made up to five times as wide helps."
        limit, to, d = self.change
        return f". With {limit} = {to:.4g} it would be {d:.3g}."

    @property
    def seconds(self) -> float:
        """How long the motion takes."""
        return float(self.track.t[-1])

    def document(self) -> dict[str, Any]:
        """Return the JSON document of `knobcam next --json`."""
        torque, omega, alpha = self.peak
        return {
            "schema": "knobcam.next/1",
            "rivals": [list(rival.effects) for rival in self.rivals],
            "separable": self.separable,
            "expected": [
                {
                    "pair": list(one.pair),
                    "D": one.d,
                    "wrong_choice": one.wrong_choice,
                    "standard_D": one.standard_d,
                }
                for one in self.expected
            ],
            "sharpened": [one._asdict() for one in self.sharpened],
            "change": None if self.change is None else self.change._asdict(),
            "motion": {
                "sample_rate_hz": self.limits.sample_rate_hz,
                "theta": self.track.theta.tolist(),
                "about": self.plan.about,
            },
            "peak": {"torque_Nm": torque, "omega_rad_s": omega, "alpha_rad_s2": alpha},
            "left_out": [list(rival.effects) for rival in self.left_out],
            "shows": self.shows,
            "headline": self.headline,
            "took_s": self.took_s,
        }

    HEAD = ("to be told apart", "D", "wrong choice", "D of the best standard motion")
    SHARPENED = ("parameter", "standard error now", "after the motion", "after the best standard one")

    def rows(self) -> list[tuple[str, ...]]:
        """What is expected as rows of text, under the words of `HEAD`, or of `SHARPENED`."""
        if self.sharpened:
            return [
                (one.param, f"{one.before:.3g}", f"{one.after:.3g}", f"{one.after_standard:.3g}")
                for one in self.sharpened
            ]
        rows: list[tuple[str, ...]] = []
        for one in self.expected:
            names = self._names(one, " or ")
            rows.append((names, f"{one.d:.3g}", _percent(one.wrong_choice), f"{one.standard_d:.3g}"))
        return rows

    def tables(self) -> tuple[TextTable, ...]:
        """What it says of itself, as text."""
        return (TextTable(self.headline, self.SHARPENED if self.sharpened else self.HEAD, self.rows()),)

    def __repr__(self) -> str:
        torque, omega, alpha = self.peak
        at_most, unit = self.limits, self.limits.unit
        head = self.SHARPENED if self.sharpened else self.HEAD
        return "\n".join(
            [
                self.headline,
                *([text_table(head, self.rows())] if self.rows() else []),
                f"At most {torque:.3g} {self.rivals[0].fit.torque_unit} (limit {at_most.torque_Nm:.3g}), "
                f"{omega:.3g} {unit}/s ({at_most.omega_rad_s:.3g}), {alpha:.3g} {unit}/s^2 "
                f"({at_most.alpha_rad_s2:.3g}){', for every rival' if self.rivals[1:] else ''}.",
            ]
        )

    def plot(self) -> Figure:
        """The motion, how the rivals' torques part on it, and D beside that of the standard motions."""
        return showing.plot(self)

    def save(self, path: str | os.PathLike[str]) -> Path:
        """Write the motion file, which `capture`, `simulate` and `record` take, and return its path."""
        return self.plan.save(path)


def _percent(share: float) -> str:
    """Return a share for people."""
    return "< 0.01 %" if share < 1e-4 else f"{100.0 * share:.2g} %"
