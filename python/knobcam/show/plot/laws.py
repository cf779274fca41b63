"""A model's laws by themselves: friction over velocity (Figure 2) and torque over position (Figure 3)."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from ...model.effects import base_effects_shown, effects
from ..words import unit_word
from .components import curve, effects_of
from .style import (
    BLACK,
    BLUE,
    GREEN,
    GREY,
    ORANGE,
    PURPLE,
    VERMILLION,
    Picture,
    Scale,
    motion_units,
    number,
    plain,
    styled,
    torque_scale,
    torque_word,
)

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from ...base.arrays import FloatArray
    from ...model import Model

# Speeds that a hand or the rig reaches, and how far position laws are drawn when no detent sets a length.
_FASTEST = {"rotary": 6.0, "linear": 0.5}
_FARTHEST = {"rotary": 1.0, "linear": 0.2}


@styled
def model(model: Model) -> Picture:
    """Friction over velocity (Figure 2) and torque over position (Figure 3), with the parameters marked."""
    shown = [part for part in ("velocity", "position") if effects_of(model, part)]
    figure = Picture(11.2 if len(shown) > 1 else 8.0, 4.8, _title(model))
    for i, part in enumerate(shown):
        axes = figure.add_subplot(1, len(shown), i + 1)
        (friction if part == "velocity" else detents)(axes, model)
    return figure


def friction(axes: Axes, model: Model) -> None:
    """Draw friction over velocity; close to zero, where stiction holds, in an inset."""
    fastest = _FASTEST[model.coordinate]
    omega = _both_sides(fastest)
    tau = curve(model, "velocity", omega)
    scale = torque_scale(model.torque_unit, float(np.max(np.abs(tau))))
    # Breakaway can be far above sliding friction: it leaves the panel, and the inset shows where it ends.
    top = 1.3 * scale.factor * float(np.max(np.abs(tau))) or 1.0
    axes.plot(omega, tau * scale.factor, color=BLUE, lw=1.8)
    _origin(axes)
    axes.set(xlim=(-1.05 * fastest, 1.05 * fastest), ylim=(-top, top))
    axes.set_title("Friction over velocity")
    axes.set_xlabel(f"velocity ({motion_units(model.coordinate)['omega']})")
    axes.set_ylabel(f"friction ({scale.unit})")
    _name_friction(axes, model, scale)
    if model.core.at_rest()[3] > 0.0:
        _stick_band(axes, model, scale)


def _name_friction(axes: Axes, model: Model, scale: Scale) -> None:
    """Mark C at the step and B at the slope of each direction; their values stand in the empty corner."""
    fastest = _FASTEST[model.coordinate]
    slope_unit = f"{scale.unit} s/{motion_units(model.coordinate)['theta']}"
    omega, friction = (np.asarray(values) for values in axes.lines[0].get_data())
    texts = []
    _, dry, held, band = model.core.at_rest()
    for at_rest, sign, side, mark in ((1, 1.0, "pos", "₊"), (0, -1.0, "neg", "₋")):
        if dry[at_rest] != 0.0:
            height = sign * dry[at_rest] * scale.factor
            axes.plot([0.0, sign * fastest], [height, height], "--", color=ORANGE, lw=1.0)
            axes.plot([0.0], [height], "o", color=ORANGE, ms=5)
            _beside(axes, f"C{mark}", (sign * 0.93 * fastest, height), -sign, ORANGE)
            texts.append((f"C{mark} = {number(abs(height))} {scale.unit}", ORANGE))
        viscous = model.params.get(f"viscous.{side}")
        if viscous is not None:
            at = sign * 0.6 * fastest
            _beside(axes, f"B{mark}", (at, float(np.interp(at, omega, friction))), sign, GREEN)
            slope = viscous.value * scale.factor
            texts.append((f"B{mark} = {number(slope)} {slope_unit}", GREEN))
        if band > 0.0:
            breakaway = held[at_rest] * scale.factor
            texts.append((f"D{mark} = {number(breakaway)} {scale.unit}", PURPLE))
    _listed(axes, texts)


def _stick_band(axes: Axes, model: Model, scale: Scale) -> None:
    """Draw what happens within dv, where the knob is stuck: any torque from -D_neg to D_pos is answered."""
    _, _, (back, forth), dv = model.core.at_rest()
    unit = motion_units(model.coordinate)["omega"]
    low, high = -back * scale.factor, forth * scale.factor
    axes.plot([0.0, 0.0], [low, high], color=PURPLE, lw=1.8)
    inset = axes.inset_axes((0.64, 0.09, 0.35, 0.28))
    moving = np.linspace(dv, 2.5 * dv, 50)
    for side in (moving, -moving):
        inset.plot(side, curve(model, "velocity", side) * scale.factor, color=BLUE, lw=1.6)
    inset.fill_between([-dv, dv], low, high, color=PURPLE, alpha=0.25, lw=0)
    for border in (-dv, dv):
        inset.axvline(border, color=GREY, ls=":", lw=1.0)
    for height in (low, high):
        inset.plot([-dv, dv], [height, height], color=PURPLE, lw=1.4)
    reach = 1.25 * max(abs(low), abs(high), 1e-30)
    inset.set(xlim=(-2.5 * dv, 2.5 * dv), ylim=(-reach, reach))
    inset.set_xticks([-dv, 0.0, dv], [number(-dv), "0", number(dv)])
    inset.set_yticks([low, 0.0, high], [number(low), "0", number(high)])
    inset.tick_params(labelsize=7)
    inset.set_title(f"stuck within ±Δv = {number(dv)} {unit}", fontsize=7.5, color="#444444")
    inset.text(1.1 * dv, high, "D₊", color=PURPLE, va="center", fontsize=8)
    inset.text(-1.1 * dv, low, "D₋", color=PURPLE, va="center", ha="right", fontsize=8)


def detents(axes: Axes, model: Model) -> None:
    """Draw the position part, with the detent's amplitude, length and shift where it has one."""
    length = 2.0 * np.pi * abs(model.period or 0.0)
    reach = 1.6 * length if length else _FARTHEST[model.coordinate]
    theta = np.linspace(-reach, reach, 1200)
    tau = curve(model, "position", theta)
    peak = float(np.max(np.abs(tau)))
    scale = torque_scale(model.torque_unit, peak)
    top = 2.5 * peak * scale.factor or 1.0
    axes.plot(theta, tau * scale.factor, color=BLUE, lw=1.8)
    _origin(axes)
    axes.set(xlim=(-reach, reach), ylim=(-top, top))
    axes.set_title(f"{torque_word(model.torque_unit).capitalize()} over position")
    axes.set_xlabel(f"position ({motion_units(model.coordinate)['theta']})")
    axes.set_ylabel(f"{torque_word(model.torque_unit)} ({scale.unit})")
    if length:
        _name_detent(axes, model, scale, peak)


def _name_detent(axes: Axes, model: Model, scale: Scale, peak: float) -> None:
    """Mark A at a crest, one detent between two crests, and S by how far it shifts the start of the sine."""
    (detent,) = (effects(model.coordinate)[one] for one in base_effects_shown(model.coordinate))
    amplitude, p, s = (model.params[f"{detent.id}.{row.name}"].value for row in detent.params)
    length, unit = 2.0 * np.pi * abs(p), motion_units(model.coordinate)["theta"]
    height, level = abs(amplitude) * scale.factor, 1.25 * peak * scale.factor
    # A crest lies where theta / P + S is pi/2, or -pi/2 for a negative A.
    crest = p * (np.copysign(0.5 * np.pi, amplitude) - s)
    left = crest - length * np.ceil((crest + 0.5 * length) / length)
    right = left + length
    for x in (left, right):
        axes.plot([x, x], [height, level], ":", color=GREEN, lw=0.9)
    _arrow(axes, (left, level), (right, level), GREEN)
    _beside(axes, "2πP", (0.5 * (left + right), level), 1.0, GREEN)
    _arrow(axes, (right, 0.0), (right, height), ORANGE)
    axes.annotate("A", (right, 0.5 * height), (4, 0), textcoords="offset points", color=ORANGE, va="center")
    start = -s * p - length * np.round(-s * p / length)
    for x in (0.0, start):
        axes.plot([x, x], [0.0, -level], ":", color=VERMILLION, lw=0.9)
    _arrow(axes, (0.0, -level), (start, -level), VERMILLION)
    right_end = (max(0.0, start), -level)
    axes.annotate("−S·P", right_end, (5, 0), textcoords="offset points", color=VERMILLION, va="center")
    each = f": {number(1.0 / abs(p), 4)} detents a turn" if model.coordinate == "rotary" else ""
    _listed(
        axes,
        [
            (f"A = {number(amplitude * scale.factor)} {scale.unit}", ORANGE),
            (f"2πP = {number(length)} {unit}{each}", GREEN),
            (f"S = {number(s)} rad", VERMILLION),
        ],
    )


def _arrow(axes: Axes, start: tuple[float, float], end: tuple[float, float], color: str) -> None:
    style = {"arrowstyle": "<->", "lw": 1.2, "shrinkA": 0, "shrinkB": 0, "color": color}
    axes.annotate("", start, end, arrowprops=style)


def _beside(axes: Axes, text: str, at: tuple[float, float], side: float, color: str) -> None:
    """Write above a point (`side` positive) or below it."""
    va = "bottom" if side > 0.0 else "top"
    axes.annotate(text, at, (0, 4 * side), textcoords="offset points", color=color, ha="center", va=va)


def _listed(axes: Axes, texts: list[tuple[str, str]]) -> None:
    for i, (text, color) in enumerate(texts):
        axes.text(0.02, 0.98 - 0.065 * i, text, transform=axes.transAxes, va="top", color=color)


def _origin(axes: Axes) -> None:
    axes.axhline(0.0, color=BLACK, lw=0.6, zorder=1)
    axes.axvline(0.0, color=BLACK, lw=0.6, zorder=1)


def _both_sides(fastest: float) -> FloatArray:
    """Return velocities with a step exactly at zero."""
    side = np.concatenate([np.geomspace(1e-9, 1e-3, 50), np.linspace(1e-3, 1.0, 400)[1:]]) * fastest
    return np.concatenate([-side[::-1], side])


def _title(model: Model) -> str:
    drawn = {*effects_of(model, "velocity"), *effects_of(model, "position")}
    rest = [p for name, p in model.params.items() if name.split(".")[0] not in drawn]
    more = ", ".join(f"{p.name} = {number(p.value)} {unit_word(p.unit)}".rstrip() for p in rest)
    return plain(model.name or "Model") + (f"\nbeside what is drawn: {plain(more, 200)}" if more else "")
