"""Feel the model: the step that answers a sensed motion with the knob's torque, and what a device allows."""

from __future__ import annotations

import math
import os
from dataclasses import dataclass, fields
from typing import TYPE_CHECKING, Any, Self

import numpy as np

from .. import _core
from ..base import showing
from ..base.arrays import vector
from ..base.door import check, checked
from ..base.renamed import renamed
from ..base.tables import TextTable, text_table
from ..capture.formats.units import GIVEN
from ..errors import InputError
from ..model import Model

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

    from ..base.arrays import FloatArray
    from ..base.showing import Figure


_MOST_DELAY = 1000  # samples


@dataclass(frozen=True)
class Device:
    """A force-feedback device: what a motor with its handle adds to whatever it renders.

    `delay_samples` are whole samples from a measurement to the torque that answers it. `held` says that a
    rig holds the handle and imposes its motion; then all that the device adds is taken off. A free handle is
    never made lighter than it is, because what acts late would create energy.
    """

    inertia_kg_m2: float = 5e-5
    damping_Nms_rad: float = 1e-4
    delay_samples: int = 1
    torque_limit_Nm: float = math.inf
    torque_rate_limit_Nm_s: float = math.inf
    encoder_step_rad: float = 9.8e-6
    held: bool = False

    def __post_init__(self) -> None:
        for one in fields(self):
            check(one.name, getattr(self, one.name), str(one.type))

    @property
    def row(self) -> _core.DeviceRow:
        """The same as the core takes it."""
        if not 0 <= self.delay_samples <= _MOST_DELAY:
            raise InputError(f"device delay: is {self.delay_samples} samples; give 0 to {_MOST_DELAY}")
        return (
            self.inertia_kg_m2,
            self.damping_Nms_rad,
            self.delay_samples,
            self.torque_limit_Nm,
            self.torque_rate_limit_Nm_s,
            self.encoder_step_rad,
            self.held,
        )


class Renderer(_core.Renderer):
    """A model that is rendered, sample by sample: stick and slip without drift, detents, every effect.

    `step(theta, omega, alpha=0, tau_other=None)` takes what the device senses (rad, rad/s, rad/s^2) and the
    torque that the hand applies (N m; None where it is not measured), and returns the torque of the model
    (Equation 1: what the hand has to apply), N m; the motor applies its negative. Call it once a sample.
    `along` does the same for whole arrays, to the last bit.

    Without a `device` the model is rendered as it is. With one it is evaluated where the handle will be when
    the torque acts, inertia beyond what the delay allows is filtered, and a stuck knob is held as stiffly as
    the device can. Effects of the sensor (lag, drift, saturation) are not rendered: they are the measuring
    rig's.

    A model that would feed a hand (within its `reach`, by default a turn to each side, up to 5 rad/s), or
    that rings on the `device`, is refused by the term that is to blame. With `force` it is rendered all the
    same, until it has given out 0.1 J more than it took: then it has a `fault`.

    A quantity that is not finite, or a motion beyond `speed_limit` (rad/s), gives zero torque and a `fault`
    that stays until `reset()`. `state` and `set_state()` are all that it remembers.

    Sources: Karnopp 1985; Hayward & Armstrong 2000; Kikuuwe et al. 2006 (the anchored friction).
    """

    @checked
    def __new__(
        cls,
        model: Model | str | os.PathLike[str],
        rate_hz: float = 5000.0,
        *,
        rate: float | None = None,
        device: Device | None = None,
        torque_limit: float = math.inf,
        torque_rate_limit: float = math.inf,
        speed_limit: float = 1000.0,
        force: bool = False,
    ) -> Self:
        """Render `model` (or its file or name); limits in N m, N m/s, rad/s. `rate` is short for `rate_hz`.

        Raises InputError for a rate, limit or device that cannot be, and for a model that is not passive.
        """
        model = model if isinstance(model, Model) else Model.load(model)
        check_torque(model)
        row = None if device is None else device.row
        rate_hz = rate_hz if rate is None else rate
        limits = (torque_limit, torque_rate_limit, speed_limit)
        return super().__new__(cls, model.core, rate_hz, row, *limits, force)

    def along(
        self,
        theta: ArrayLike,
        omega: ArrayLike,
        alpha: ArrayLike | None = None,
        tau_other: ArrayLike | None = None,
    ) -> FloatArray:
        """Return the torque along a motion, N m, shape (samples,): single steps, to the last bit.

        Columns of shape (samples,), SI; NaN in `tau_other` where the hand is not measured. Raises InputError
        for columns of different lengths.
        """
        theta = _column("theta", theta)
        return super().along(
            theta,
            _column("omega", omega),
            np.zeros_like(theta) if alpha is None else _column("alpha", alpha),
            None if tau_other is None else _column("tau_other", tau_other),
        )

    def __repr__(self) -> str:
        state = self.state
        doing = self.fault or ("sliding" if state["slipping"] else "sticking")
        return f"Renderer at {self.rate_hz:g} Hz after {state['samples']} samples: {doing}"


def check_torque(model: Model) -> None:
    """Raise InputError for a model of what a motor was given: a hand feels torques."""
    if model.torque_unit in GIVEN:
        raise InputError(
            f"model '{model.name}': is in {model.torque_unit}, and a hand feels torque; convert it with the "
            "motor's torque constant: knobcam convert MODEL --kt KT -o NEW"
        )


def check_rotary(model: Model) -> None:
    """Raise InputError for a model that a device cannot render: it turns, by torques."""
    check_torque(model)
    if model.coordinate != "rotary":
        raise InputError(
            f"model '{model.name}': is of a {model.coordinate} axis, and the device turns; give a rotary one"
        )


def _column(name: str, values: ArrayLike) -> FloatArray:
    plain = type(values) is np.ndarray and values.dtype == np.float64 and values.ndim == 1
    return np.ascontiguousarray(values if plain else vector(name, values))  # a long one is not copied


@dataclass(frozen=True, repr=False)
class Stability(showing.Tabled):
    """What a device allows: stiffness, margins, and whether a model rings on it; see `check_stability`."""

    model: Model
    device: Device
    rate_hz: float
    figures: dict[str, Any]

    @property
    def stable(self) -> bool:
        """Whether the model does not ring on the device."""
        return bool(self.figures["stable"])

    @property
    def passive(self) -> bool:
        """Whether the model itself feeds no hand, whatever the device."""
        return self.objection is None

    @property
    def objection(self) -> str | None:
        """The term by which the model would feed a hand, and why; None where it does not."""
        told = self.figures["objection"]
        return None if told is None else str(told)

    @property
    def refusal(self) -> str | None:
        """Why the model is rendered on this device only if that is forced; None where it simply is."""
        if self.stable or not self.passive:
            return self.objection
        return (
            f"the model rings on it: the device allows {self.allowed_stiffness_Nm_rad:.3g} N m/rad, the "
            f"model has {self.figures['stiffness_Nm_rad']:.3g}; soften the model, or --force it"
        )

    @property
    def allowed_stiffness_Nm_rad(self) -> float:
        """Stiffness that the delay allows with a phase margin of 50 degrees."""
        return float(self.figures["allowed_stiffness_Nm_rad"])

    @property
    def passivity_margin_Nms_rad(self) -> float:
        """Colgate & Schenkel's `b - K (T/2 + delay) - |B|` at the model's stiffest place."""
        return float(self.figures["passivity_margin_Nms_rad"])

    def document(self) -> dict[str, Any]:
        """Return the figures as JSON can keep them."""
        return {"schema": "knobcam.stability/1", **self.figures}

    def plot(self) -> Figure:
        """Allowed stiffness over the delay, and where this device and this model are."""
        return showing.plot(self)

    def _rows(self) -> list[tuple[str, str, str]]:
        figures = self.figures
        degrees = 180.0 / math.pi

        def margin(name: str) -> str:
            return f"{figures[name] * degrees:.0f}"

        return [
            ("delay, with half a sample of hold", f"{1e3 * figures['delay_s']:.3g}", "ms"),
            ("the model's greatest stiffness", f"{figures['stiffness_Nm_rad']:.4g}", "N m/rad"),
            ("  allowed, with 50 degrees of margin", f"{self.allowed_stiffness_Nm_rad:.4g}", "N m/rad"),
            ("  passive in any hand", f"{figures['passive_stiffness_Nm_rad']:.4g}", "N m/rad"),
            ("Colgate-Schenkel margin", f"{self.passivity_margin_Nms_rad:.3g}", "N m s/rad"),
            ("stiffness that holds a stuck knob", f"{figures['anchor_stiffness_Nm_rad']:.4g}", "N m/rad"),
            ("model inertia / device inertia", f"{figures['inertia_ratio']:.3g}", "1"),
            ("phase margin while it slides", margin("sliding_margin_rad"), "degrees"),
            ("phase margin while it sticks", margin("sticking_margin_rad"), "degrees"),
        ]

    @property
    def verdict(self) -> str:
        """One sentence."""
        if self.objection is not None:
            return f"It feeds the hand by {self.objection}."
        if not self.stable:
            return (
                f"It rings: at this delay the device allows {self.allowed_stiffness_Nm_rad:.3g} N m/rad and "
                f"the model has {self.figures['stiffness_Nm_rad']:.3g}; render it on the device's own side "
                "(`knobcam render --port`), or soften the model."
            )
        if self.passivity_margin_Nms_rad < 0.0:
            return (
                "It does not ring. Without the knob's dry friction some hand could draw energy out of its "
                "stiffest place."
            )
        return "It does not ring, and no hand can draw energy out of it."

    def __repr__(self) -> str:
        return f"{self.verdict}\n{text_table(('figure', 'value', 'unit'), self._rows())}"

    def tables(self) -> tuple[TextTable, ...]:
        """What it says of itself, as text."""
        return (TextTable(self.verdict, ("figure", "value", "unit"), self._rows()),)


@renamed(rate="rate_hz")
@checked
def check_stability(
    model: Model | str | os.PathLike[str], rig: Device | None = None, *, rate_hz: float = 5000.0
) -> Stability:
    """Say which stiffness the delay of a device allows, and how far `model` on it is from ringing.

    Two questions: whether any hand at all could draw energy out of it (Colgate & Schenkel 1997, Equation
    10: `b > K T/2 + |B|`, with the delay added to T/2), and whether it rings by itself (phase margin of the
    loop through the delay). Beside both, whether the model itself would feed a hand (`passive`,
    `objection`). Raises InputError for a device or a rate that cannot be.
    """
    model = model if isinstance(model, Model) else Model.load(model)
    check_torque(model)
    rig = Device() if rig is None else rig
    if not 10.0 <= rate_hz <= 1e6:
        raise InputError(f"a rate of {rate_hz} Hz is none of a device; choose 10 to 1e6, usually 5000")
    figures = _core.check_stability(model.core, rig.row, rate_hz)
    objection = _core.check_passive(model.core, None, rate_hz)
    return Stability(model, rig, rate_hz, figures | {"passive": objection is None, "objection": objection})


def check_passive(model: Model, *, rate_hz: float = 5000.0) -> None:
    """Raise InputError for a model that would feed a hand: the term that is to blame, and why.

    Looked at are inertia, dry friction and what depends on the speed, within the model's `reach`, by default
    a turn to each side of zero and up to 5 rad/s (1 m and 1 m/s on a linear axis), where the angle alone
    would take the handle, and the work over closed cycles.
    """
    objection = _core.check_passive(model.core, None, rate_hz)
    if objection is not None:
        raise InputError(objection)
