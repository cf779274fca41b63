"""URDF: a link with the inertia, and a joint whose `dynamics` have damping and friction; nothing else."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, NamedTuple
from xml.etree import ElementTree

import numpy as np

from ...errors import InputError
from ...model import Model
from .conversion import Fate, Form
from .target import OF_THE_SENSOR, Options, Target
from .terms import Term

if TYPE_CHECKING:
    from ...base.arrays import FloatArray

_HAS = "a joint of URDF has only damping and friction, the same both ways"
_LINK_KG = 1e-3  # of a link that turns: its inertia about the axis is the model's
_LINK_KG_M2 = 1e-9  # of one that slides


class _Part(NamedTuple):
    """An effect as URDF has it: which attribute, its value, and what that misses along the motion, N m."""

    attribute: str
    value: float
    missed: FloatArray
    exact: bool


def _part(term: Term, options: Options) -> _Part | None:
    motion = options.motion
    if term.place != "load":
        return None
    if (inertia := term.inertia) is not None:
        return _Part("izz", inertia, np.zeros_like(motion.t), exact=True)
    if (friction := term.friction) is not None:
        back, forth = friction
        missed = np.full_like(motion.t, 0.5 * (back - forth))
        return _Part("friction", 0.5 * (back + forth), missed, back == forth)
    if term.by_speed:
        omega = motion.omega
        torque = term.at(motion.theta, omega).drive
        slope = float(torque @ omega / (omega @ omega))
        powers = term.damping()
        return _Part("damping", slope, slope * omega - torque, powers is not None and not any(powers[1:]))
    return None


def _fate(term: Term, options: Options) -> Fate:
    if term.place == "sensor":
        return Fate(term.effect, "impossible", OF_THE_SENSOR)
    part = _part(term, options)
    if part is None:
        return Fate(term.effect, "impossible", f"has no word there: {_HAS}")
    how = "inertia of the link" if part.attribute == "izz" else part.attribute
    if part.exact:
        return Fate(term.effect, "exact", how)
    missed = float(np.sqrt(np.mean(part.missed**2)))
    return Fate(term.effect, "approximate", f"{how}, what is nearest on the motion", missed)


def judge(model: Model, terms: Mapping[str, Term], options: Options) -> tuple[Fate, ...]:
    """Judge each effect along the motion, which decides what damping fits best."""
    return tuple(_fate(term, options) for term in terms.values())


def write(model: Model, terms: Mapping[str, Term], options: Options) -> Form:
    """Write a robot of one joint."""
    parts = [part for term in terms.values() if (part := _part(term, options)) is not None]
    values = {"izz": 0.0, "friction": 0.0, "damping": 0.0}
    for part in parts:
        values[part.attribute] += part.value
    if not values["izz"] > 0.0:
        raise InputError(f"model '{model.name}': has no inertia, and a link of URDF needs one; add one")
    missed = np.sum([part.missed for part in parts], axis=0)
    turns = model.coordinate == "rotary"
    mass, inertia = (_LINK_KG, values["izz"]) if turns else (values["izz"], _LINK_KG_M2)
    angle = 1.0 if model.reach is None else model.reach[0]
    limit = (
        "" if turns else f'\n    <limit lower="{-angle!r}" upper="{angle!r}" effort="1000" velocity="10"/>'
    )
    lines = [
        '<?xml version="1.0"?>',
        *(f"<!-- {line.replace('--', '- -')} -->" for line in options.header),
        '<robot name="knob">',
        '  <link name="base"/>',
        '  <link name="knob">',
        "    <inertial>",
        f'      <mass value="{mass!r}"/>',
        f'      <inertia ixx="{inertia!r}" ixy="0" ixz="0" iyy="{inertia!r}" iyz="0" izz="{inertia!r}"/>',
        "    </inertial>",
        "  </link>",
        f'  <joint name="knob" type="{"continuous" if turns else "prismatic"}">',
        '    <parent link="base"/>',
        '    <child link="knob"/>',
        f'    <axis xyz="0 0 1"/>{limit}',
        f'    <dynamics damping="{values["damping"]!r}" friction="{values["friction"]!r}"/>',
        "  </joint>",
        "</robot>",
        "",
    ]
    remarks: tuple[str, ...] = (
        "How a simulator holds a joint still by its friction is its own: URDF does not say.",
    )
    if turns:
        remarks += (f"The mass of the link, {_LINK_KG:g} kg, is a placeholder.",)
    fates = tuple(_fate(term, options) for term in terms.values())
    return Form(fates, "\n".join(lines), float(np.sqrt(np.mean(missed**2))), remarks)


def measure(form: Form, model: Model, options: Options) -> FloatArray:
    """Return the torque that the written joint asks for along the motion, N m."""
    robot = ElementTree.fromstring(form.content)

    def number(path: str, name: str) -> float:
        found = robot.find(path)
        return 0.0 if found is None else float(found.get(name, "0"))

    turns = model.coordinate == "rotary"
    inertia = number(".//inertia", "izz") if turns else number(".//mass", "value")
    damping, friction = (number(".//dynamics", name) for name in ("damping", "friction"))
    motion = options.motion
    return inertia * motion.alpha + damping * motion.omega + friction * np.sign(motion.omega)


TARGET = Target(judge, write, measure)
