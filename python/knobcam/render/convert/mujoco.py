"""MuJoCo: a joint with what MJCF says exactly, and the rest by a callback of the render step.

MJCF of MuJoCo 4.0 has, of a joint, `armature`, `damping` as a polynomial a v + b v |v| + c v^3 and
`stiffness` as a x + b x^2 + c x^3 about `springref`, and passive `dcmotor` actuators whose `cogging` is a
sine of the angle. Its `frictionloss` creeps below the friction that it stands for, so nothing is made of it.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import TYPE_CHECKING, Any, NamedTuple
from xml.sax.saxutils import escape, quoteattr

import numpy as np

from ...base.optional import require
from ...errors import InputError
from ...model import Model
from ..renderer import Device, Renderer
from .conversion import Fate, Form
from .target import IMPOSED, OF_THE_SENSOR, Options, Target, Unmeasured, rendered
from .terms import EXACT, Wave

if TYPE_CHECKING:
    from ...base.arrays import FloatArray
    from .terms import Term

JOINT = "knob"
_REST = "knobcam."  # of a text: what the callback has of the joint's knob
_LEAST = 1e-12  # kg m^2 and kg: MuJoCo wants some of a body that moves; its share is taken off the armature
_CALLBACK = "callback"
_POWERS = (0, 1, 2, 3)


class _Native(NamedTuple):
    """What MJCF has of a model, and the effects that are so said."""

    armature: float
    damping: tuple[float, float, float]
    stiffness: tuple[float, float, float]
    springref: float
    waves: tuple[Wave, ...]
    how: dict[str, str]


def _native(terms: Mapping[str, Term]) -> _Native:
    joined = any(term.place == "coupling" for term in terms.values())
    by_load = any(term.rubs_by_load for term in terms.values())
    armature, damping, series = 0.0, np.zeros(3), np.zeros(len(_POWERS))
    waves: tuple[Wave, ...] = ()
    how: dict[str, str] = {}
    for name, term in terms.items():
        if term.place != "load":
            continue
        if term.inertia is not None and not joined and not by_load:
            armature, how[name] = armature + term.inertia, "armature"
        if joined or (by_load and term.presses):
            continue
        if (speed := term.damping()) is not None:
            damping, how[name] = damping + speed, "damping"
        elif (place := term.series(*_POWERS)) is not None:
            series, how[name] = series + place, "stiffness"
        elif (sines := term.waves()) is not None:
            waves, how[name] = waves + sines, "dcmotor cogging"
    sprung = _sprung(series)
    if sprung is None:  # a force that is nowhere zero has no springref
        how = {name: one for name, one in how.items() if one != "stiffness"}
        sprung = 0.0, (0.0, 0.0, 0.0)
    a, b, c = map(float, damping)
    return _Native(armature, (a, b, c), sprung[1], sprung[0], waves, how)


def _sprung(series: FloatArray) -> tuple[float, tuple[float, float, float]] | None:
    """Return where a polynomial of the angle is zero, and its coefficients about there."""
    if not series.any():
        return 0.0, (0.0, 0.0, 0.0)
    polynomial = np.polynomial.Polynomial(series)
    roots = [0.0] if series[0] == 0.0 else _real(polynomial.trim().roots())
    if not roots:
        return None
    at = min(roots, key=abs)
    a, b, c = (float(polynomial.deriv(n)(at)) / f for n, f in ((1, 1.0), (2, 2.0), (3, 6.0)))
    return at, (a, b, c)


def _real(roots: Iterable[complex]) -> list[float]:
    return [float(root.real) for root in map(complex, roots) if abs(root.imag) <= EXACT * max(1.0, abs(root))]


def judge(model: Model, terms: Mapping[str, Term], options: Options) -> tuple[Fate, ...]:
    """Judge each effect: what MJCF has, what the callback adds; sensors do not act on a joint."""
    how = _native(terms).how

    def fate(term: Term) -> Fate:
        if term.place == "sensor":
            return Fate(term.effect, "impossible", OF_THE_SENSOR)
        return Fate(term.effect, "exact", how.get(term.effect, _CALLBACK))

    return tuple(fate(term) for term in terms.values())


def write(model: Model, terms: Mapping[str, Term], options: Options) -> Form:
    """Write a joint that turns a body of nothing but its armature."""
    native = _native(terms)
    rest = tuple(name for name in terms if name not in native.how)
    armature = native.armature
    if rest:
        left = Model(model.core.only(list(rest)))
        knob = rendered(left, options.rate_hz)
        if any(terms[name].place == "coupling" for name in rest) or not armature:
            armature = _felt(knob)
    if armature <= _LEAST:
        raise InputError(
            f"model '{model.name}': has no inertia at the shaft, and MuJoCo moves no joint without; add one"
        )
    hinge = model.coordinate == "rotary"
    lines = [
        '<mujoco model="knob">',
        *(f"  <!-- {line.replace('--', '- -')} -->" for line in options.header),
        '  <compiler angle="radian"/>',
        f'  <option timestep="{1.0 / options.rate_hz!r}" gravity="0 0 0" integrator="implicitfast"/>',
    ]
    if rest:
        lines += [
            "  <custom>",
            f"    <!-- By the callback: {escape(', '.join(rest))}. -->",
            f'    <text name="{_REST}{JOINT}" data={quoteattr(left.text(), {chr(10): "&#10;"})}/>',
            "  </custom>",
        ]
    attributes = {"armature": repr(armature - _LEAST)}
    for name, values in (("damping", native.damping), ("stiffness", native.stiffness)):
        if any(values):
            attributes[name] = " ".join(map(repr, values))
    if native.springref:
        attributes["springref"] = repr(native.springref)
    said = " ".join(f'{name}="{value}"' for name, value in attributes.items())
    lines += [
        "  <worldbody>",
        f'    <body name="{JOINT}">',
        f'      <inertial pos="0 0 0" mass="{_LEAST!r}" diaginertia="{" ".join([repr(_LEAST)] * 3)}"/>',
        f'      <joint name="{JOINT}" type="{"hinge" if hinge else "slide"}" axis="0 0 1" {said}/>',
        "    </body>",
        "  </worldbody>",
    ]
    if native.waves:
        # A passive motor pushes the joint; the model's torque is what a hand has to push with.
        motor = f'<dcmotor joint="{JOINT}" input="none" motorconst="0" resistance="1" cogging='
        lines += [
            "  <actuator>",
            *(f'    {motor}"{-w.amplitude!r} {w.per_unit!r} {w.phase!r}"/>' for w in native.waves),
            "  </actuator>",
        ]
    lines += ["</mujoco>", ""]
    line = "import mujoco; from knobcam.render.convert.mujoco import callback; "
    line += "mujoco.set_mjcb_passive(callback(model))"
    remarks = (f"The callback of the rest, {', '.join(rest)}: {line}",) if rest else ()
    return Form(judge(model, terms, options), "\n".join(lines), remarks=remarks)


def _felt(knob: Renderer) -> float:
    """Return the inertia by which a step answers an acceleration at once, kg m^2."""
    torques = []
    for alpha in (0.0, 1.0):
        torques.append(knob.step(0.0, 0.0, alpha))
        knob.reset()
    return torques[1] - torques[0]


class _Joint:
    """A joint of a MuJoCo model, and the render step of what its knob has beside it."""

    def __init__(self, model: Any, joint: int, rest: str, imposed: bool) -> None:
        self.position, self.speed = int(model.jnt_qposadr[joint]), int(model.jnt_dofadr[joint])
        self.imposed = imposed
        # A knob that sticks is held as stiffly as a sampled spring on the inertia of the joint may be.
        device = IMPOSED if imposed else Device(float(model.dof_M0[self.speed]), 0.0, 0, encoder_step_rad=0.0)
        self.renderer = Renderer(Model.parse(rest), 1.0 / model.opt.timestep, device=device)
        self._inertia = _felt(self.renderer)  # which the joint has as its armature
        self._before, self._last = self.renderer.state, -1.0

    def push(self, data: Any) -> None:
        """Take the knob's torque off the joint."""
        if data.time < self._last:
            self.renderer.reset()
        if data.time == self._last:
            self.renderer.set_state(self._before)
        else:
            self._before, self._last = self.renderer.state, data.time
        dof = self.speed
        acts = data.qfrc_applied[dof] + data.qfrc_actuator[dof] + data.qfrc_passive[dof] - data.qfrc_bias[dof]
        other = None if self.imposed else float(acts)
        theta, omega, alpha = data.qpos[self.position], data.qvel[dof], data.qacc[dof]
        torque = self.renderer.step(float(theta), float(omega), float(alpha), other)
        data.qfrc_passive[dof] -= torque - self._inertia * alpha


class Callback:
    """What model files for MuJoCo leave to the render step, for `mujoco.set_mjcb_passive`.

    A joint's text `knobcam.JOINT` has it; a model may have many, all of one step. A call at the same time as
    the one before does not count as a step, and going back in time is a reset. A knob that sticks is held
    against all that else acts on the joint: what is applied, actuators, springs, gravity. `imposed` is for
    inverse dynamics, where the motion is given, and nothing of what acts.
    """

    def __init__(self, model: Any, *, imposed: bool = False) -> None:
        """Read the rest of every knob from `model`; InputError where it has none, or a joint is missing."""
        mujoco = require("mujoco", "a callback for MuJoCo", "mujoco")
        self.joints = []
        for at, name in _rests(mujoco, model):
            joint = mujoco.mj_name2id(model, mujoco.mjtObj.mjOBJ_JOINT, name)
            if joint < 0:
                raise InputError(
                    f"the MuJoCo model has no joint '{name}', of which a text tells; rename both alike"
                )
            first, size = int(model.text_adr[at]), int(model.text_size[at])
            rest = bytes(model.text_data[first : first + size]).split(b"\0")[0].decode()
            self.joints.append(_Joint(model, joint, rest, imposed))
        if not self.joints:
            raise InputError(
                f"the MuJoCo model has no text {_REST}JOINT; take over what `knobcam convert` wrote"
            )

    def __call__(self, model: Any, data: Any) -> None:
        """Take the torque of every knob off its joint."""
        for joint in self.joints:
            joint.push(data)


def _rests(mujoco: Any, model: Any) -> list[tuple[int, str]]:
    """Return the texts that have the rest of a knob, and their joints; both have what attaching prefixes."""
    names = [mujoco.mj_id2name(model, mujoco.mjtObj.mjOBJ_TEXT, at) or "" for at in range(model.ntext)]
    return [(at, name.replace(_REST, "", 1)) for at, name in enumerate(names) if _REST in name]


def measure(form: Form, model: Model, options: Options) -> FloatArray:
    """Return the torque that MuJoCo says the written joint needs along the motion, N m."""
    try:
        mujoco = require("mujoco", "measuring it", "mujoco")
    except InputError:
        raise Unmeasured("the package mujoco is not installed") from None
    before = mujoco.get_mjcb_passive()
    mujoco.set_mjcb_passive(None)
    try:
        joint = mujoco.MjModel.from_xml_string(form.content)
        data = mujoco.MjData(joint)
        if joint.ntext:
            mujoco.set_mjcb_passive(callback(joint, imposed=True))
        found = []
        for row in zip(*options.motion, strict=True):
            data.time, data.qpos[0], data.qvel[0], data.qacc[0] = row
            mujoco.mj_inverse(joint, data)
            if len(data.actuator_force):
                mujoco.mj_fwdActuation(joint, data)
            found.append(data.qfrc_inverse[0] - data.qfrc_actuator[0])
        return np.array(found)
    finally:
        mujoco.set_mjcb_passive(before)


def callback(model: Any, *, imposed: bool = False) -> Callback:
    """Return what `mujoco.set_mjcb_passive` takes, for joints that were converted; see `Callback`."""
    return Callback(model, imposed=imposed)


TARGET = Target(judge, write, measure)
