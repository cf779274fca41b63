"""Static friction: breakaway torques and the stick band, from a capture in which the knob sticks."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from .. import _core
from ..base import showing
from ..base.door import checked
from ..base.tables import TextTable, text_table
from ..errors import InputError
from ..model import Model
from .estimate import Z95, Estimate

if TYPE_CHECKING:
    from ..base.showing import Figure
    from .fitting import Fit

_STUCK = "karnopp"
_NAMES = ("D_neg", "D_pos", "dv")
# A model that leaves more than this many times the noise floor misses something that stiction then carries.
_CLOSE = 1.1


@dataclass(frozen=True, eq=False, repr=False)
class Stiction(showing.Tabled):
    """What a capture says about sticking; None for what it does not say.

    `d_neg`, `d_pos`: breakaway friction backward and forward (N m, magnitudes); `dv`: half-width of the stick
    band (rad/s); `breakaways`: how many slips were seen backward and forward.
    """

    fit: Fit
    d_neg: Estimate | None
    d_pos: Estimate | None
    dv: Estimate | None
    breakaways: tuple[int, int]

    @property
    def determined(self) -> bool:
        """Whether all three are known."""
        return None not in (self.d_neg, self.d_pos, self.dv)

    @property
    def missing(self) -> tuple[str, ...]:
        """What the captures do not show or cannot be trusted with, and what to record; a sentence each."""
        advice = []
        for value, side, count in (
            (self.d_neg, "backward", self.breakaways[0]),
            (self.d_pos, "forward", self.breakaways[1]),
        ):
            if value is None:
                advice.append(
                    f"{count} breakaways {side}, and 3 are needed: push the knob from rest, {side}, slowly, "
                    "until it slips, several times"
                )
        if self.dv is None:
            advice.append(
                "the knob never stands still long enough to show its stick band: let it rest in between"
            )
        elif self.dv.ci95[0] == 0.0:
            advice.append(
                "while it sticks the knob stands as still as its velocity can be resolved: dv is that "
                "resolution, and the true band may be wider"
            )
        if any(f.kind == "clipped" for s in self.fit.prepared for f in s.capture.findings):
            advice.append("the torque was clipped: a breakaway beyond the sensor's limit is not seen")
        if self.fit.rmse > _CLOSE * self.fit.noise_floor:
            times = self.fit.rmse / self.fit.noise_floor
            advice.append(
                f"the model leaves {times:.2g} times the noise floor, and what it misses is in these "
                "torques: fit a capture that moves together with this one"
            )
        return tuple(advice)

    @property
    def model(self) -> Model:
        """The fitted model with the `karnopp` effect at these values.

        Raises InputError where the capture does not determine all of them.
        """
        if self.d_neg is None or self.d_pos is None or self.dv is None:
            raise InputError(f"stiction: {self.missing[0]}")
        fitted = self.fit.model
        model = fitted if _STUCK in fitted.effects else fitted.with_effect(_STUCK)
        for name, estimate in zip(_NAMES, (self.d_neg, self.d_pos, self.dv), strict=True):
            model = model.with_value(f"{_STUCK}.{name}", estimate.value)
        return model

    def plot(self) -> Figure:
        """Density of the isolated friction torque over slow velocities, as Figure 24 of the paper."""
        return showing.plot(self)

    def document(self) -> dict[str, Any]:
        """Return it as it stands in the JSON document of `knobcam fit --json`."""
        rows = zip(_NAMES, (self.d_neg, self.d_pos, self.dv), strict=True)
        return {
            "params": {
                f"{_STUCK}.{name}": {"value": e.value, "ci95": list(e.ci95), "unit": e.unit}
                for name, e in rows
                if e is not None
            },
            "breakaways": {"backward": self.breakaways[0], "forward": self.breakaways[1]},
            "missing": list(self.missing),
        }

    def _rows(self) -> list[tuple[str, ...]]:
        rows: list[tuple[str, ...]] = []
        for name, e in zip(_NAMES, (self.d_neg, self.d_pos, self.dv), strict=True):
            if e is not None:
                rows.append((f"{_STUCK}.{name}", f"{e.value:.6g}", e.interval, e.unit))
        return rows

    _HEAD = ("parameter", "value", "95 % interval", "unit")

    def __repr__(self) -> str:
        table = [text_table(self._HEAD, self._rows())] if self._rows() else []
        return "\n".join([f"Stiction from {sum(self.breakaways)} breakaways", *table, *self.missing])

    def tables(self) -> tuple[TextTable, ...]:
        """What it says of itself, as text."""
        return (TextTable(f"Stiction from {sum(self.breakaways)} breakaways", self._HEAD, self._rows()),)


@checked
def stiction(fit: Fit) -> Stiction:
    """Return the static friction that the captures of a fit show.

    A capture that only sticks and slips hardly shows inertia and detents, which must be taken off the torque:
    fit it together with one that moves (`kc.fit([moving, sticking])`).

    The density argument of the haptic-camera paper (Figure 24) as an estimator: dv is the edge in the density
    of speeds (interval by block bootstrap), D the friction that held the knob just before each slip (interval
    over the slips).
    """
    signals = [prepared.core for prepared in fit.prepared]
    d_neg, d_pos, dv, breakaways = _core.stiction(signals, fit.core.model)
    torque, speed = fit.torque_unit, "rad/s" if fit.model.coordinate == "rotary" else "m/s"
    backward, forward = _estimate(d_neg, torque), _estimate(d_pos, torque)
    return Stiction(fit, backward, forward, _estimate(dv, speed), (breakaways[0], breakaways[1]))


def _estimate(row: tuple[float, float, float] | None, unit: str) -> Estimate | None:
    if row is None:
        return None
    value, low, high = row
    return Estimate(value, (low, high), unit, (high - low) / (2.0 * Z95))
