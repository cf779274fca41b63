"""A model's laws by themselves: friction over velocity (Figure 2) and torque over position (Figure 3)."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

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
    plain,
    styled,
    torque_scale,
)

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from ..formats.table import FloatArray
    from ..model import Model

# Speeds that a hand or the rig reaches, and how far position laws are drawn when no detent sets a length.
_FASTEST = {"rotary": 6.0, "linear": 0.5}
_FARTHEST = {"rotary": 1.0, "linear": 0.2}


@styled
def model(model: Model) -> Picture:
    """Friction over velocity with C, B, D and dv (Figure 2), torque over position with A, P and S (Figure 3)."""
    shown = [part for part in ("velocity", "position") if effects_of(model, part)]
    figure = Picture(5.6 * max(1, len(shown)), 4.4, _title(model))
    for i, part in enumerate(shown):
        axes = figure.add_subplot(1, len(shown), i + 1)
        (friction if part == "velocity" else detents)(axes, model)
    return figure


def friction(axes: Axes, model: Model) -> None:
    """Draw friction over velocity; close to zero, where stiction holds, in an inset."""
    fastest = _FASTEST[model.axis]
    omega = _both_sides(fastest)
    tau = curve(model, "velocity", omega)
    values = {name: p.value for name, p in model.params.items()}
    sticking = [abs(values.get(f"karnopp.{name}", 0.0)) for name in ("D_neg", "D_pos")]
    scale = torque_scale(model.axis, float(np.max(np.abs(tau))))
    unit = motion_units(model.axis)["omega"]
    top = 1.15 * scale.factor * max(float(np.max(np.abs(tau))), *sticking) or 1.0
    axes.plot(omega, tau * scale.factor, color=BLUE, lw=1.8)
    _origin(axes)
    axes.set(xlim=(-1.05 * fastest, 1.05 * fastest), ylim=(-top, top))
    axes.set_title("Friction over velocity")
    axes.set_xlabel(f"velocity ({unit})")
    axes.set_ylabel(
        f"friction torque ({scale.unit})" if model.axis == "rotary" else f"friction ({scale.unit})"
    )
    _name_friction(axes, model, values, scale)
    if values.get("karnopp.dv", 0.0) > 0.0:
        _stick_band(axes, values, scale, unit)


def _name_friction(axes: Axes, model: Model, values: dict[str, float], scale: Scale) -> None:
    """Write C at the step and B at the slope of each direction."""
    fastest = _FASTEST[model.axis]
    slope_unit = f"{scale.unit} s/{motion_units(model.axis)['theta']}"
    lines = []
    for sign, side, mark in ((1.0, "pos", "+"), (-1.0, "neg", "−")):
        for effect, letter, unit, color in (
            ("coulomb", "C", scale.unit, ORANGE),
            ("viscous", "B", slope_unit, GREEN),
        ):
            name = f"{effect}.{side}"
            if name in values:
                lines.append((f"{letter}{mark} = {values[name] * scale.factor:.3g} {unit}", color))
        outside, inside = ("bottom", "top") if sign > 0.0 else ("top", "bottom")
        if f"coulomb.{side}" in values:
            height = sign * values[f"coulomb.{side}"] * scale.factor
            axes.plot([0.0, sign * fastest], [height, height], "--", color=ORANGE, lw=1.0)
            axes.plot([0.0], [height], "o", color=ORANGE, ms=5)
            axes.text(sign * 0.93 * fastest, height, f"C{mark}\n", color=ORANGE, ha="center", va=inside)
        if f"viscous.{side}" in values:
            at = sign * 0.6 * fastest
            height = float(np.interp(at, *axes.lines[0].get_data()))
            axes.text(at, height, f"B{mark}\n", color=GREEN, ha="center", va=outside)
    for i, (text, color) in enumerate(lines):
        axes.text(0.02, 0.98 - 0.065 * i, text, transform=axes.transAxes, va="top", color=color)


def _stick_band(axes: Axes, values: dict[str, float], scale: Scale, unit: str) -> None:
    """Draw what happens within dv, where the knob is stuck: any torque from -D_neg to D_pos is answered."""
    dv = values["karnopp.dv"]
    low, high = -values["karnopp.D_neg"] * scale.factor, values["karnopp.D_pos"] * scale.factor
    axes.plot([0.0, 0.0], [low, high], color=PURPLE, lw=1.8)
    inset = axes.inset_axes((0.62, 0.12, 0.37, 0.32))
    for line in axes.lines[:1]:
        x, y = np.asarray(line.get_xdata()), np.asarray(line.get_ydata())
        moving = np.where(np.abs(x) < dv, np.nan, y)
        inset.plot(x, moving, color=BLUE, lw=1.6)
    inset.fill_between([-dv, dv], low, high, color=PURPLE, alpha=0.25, lw=0)
    for border in (-dv, dv):
        inset.axvline(border, color=GREY, ls=":", lw=1.0)
    for height in (low, high):
        inset.plot([-dv, dv], [height, height], color=PURPLE, lw=1.4)
    reach = 1.25 * max(abs(low), abs(high), 1e-30)
    inset.set(xlim=(-2.5 * dv, 2.5 * dv), ylim=(-reach, reach))
    inset.set_xticks([-dv, 0.0, dv], [f"−{dv:g}", "0", f"{dv:g}"])
    inset.set_yticks([low, 0.0, high], [f"{low:.3g}".replace("-", "−"), "0", f"{high:.3g}"])
    inset.tick_params(labelsize=7)
    inset.set_title(f"stuck within ±dv = {dv:g} {unit}", fontsize=7.5, color="#444444")
    inset.text(1.1 * dv, high, "D+", color=PURPLE, va="center", fontsize=8)
    inset.text(-1.1 * dv, low, "D−", color=PURPLE, va="center", ha="right", fontsize=8)


def detents(axes: Axes, model: Model) -> None:
    """Draw the position part, with the detent's amplitude, length and shift where it has one."""
    values = {name: p.value for name, p in model.params.items()}
    length = 2.0 * np.pi * abs(values["detent.P"]) if "detent.P" in values else 0.0
    reach = 1.6 * length if length else _FARTHEST[model.axis]
    theta = np.linspace(-reach, reach, 1200)
    tau = curve(model, "position", theta)
    peak = float(np.max(np.abs(tau)))
    scale = torque_scale(model.axis, peak)
    top = 1.75 * peak * scale.factor or 1.0
    axes.plot(theta, tau * scale.factor, color=BLUE, lw=1.8)
    _origin(axes)
    axes.set(xlim=(-reach, reach), ylim=(-top, top))
    axes.set_title("Torque over position")
    axes.set_xlabel(f"position ({motion_units(model.axis)['theta']})")
    axes.set_ylabel(f"torque ({scale.unit})" if model.axis == "rotary" else f"force ({scale.unit})")
    if length:
        _name_detent(axes, model, values, scale, theta, tau)


def _name_detent(
    axes: Axes, model: Model, values: dict[str, float], scale: Scale, theta: FloatArray, tau: FloatArray
) -> None:
    """Mark A at a crest, one detent between two crests, and S by where the sine starts."""
    amplitude, p, s = values["detent.A"], values["detent.P"], values["detent.S"]
    length, unit = 2.0 * np.pi * abs(p), motion_units(model.axis)["theta"]
    height = abs(amplitude) * scale.factor
    level = 1.25 * float(np.max(np.abs(tau))) * scale.factor
    # Crests: theta / P + S = pi/2 for a positive amplitude, -pi/2 for a negative one, and every turn from there.
    crest = p * (np.copysign(0.5 * np.pi, amplitude) - s)
    left = crest - length * np.ceil((crest + 0.5 * length) / length)
    right = left + length
    arrow = {"arrowstyle": "<->", "lw": 1.2, "shrinkA": 0, "shrinkB": 0}
    axes.annotate("", (left, level), (right, level), arrowprops=arrow | {"color": GREEN})
    each = f", {1.0 / abs(p):.3g} a turn" if model.axis == "rotary" else ""
    text = f"one detent: 2πP = {length:.3g} {unit}{each}"
    axes.text(0.5 * (left + right), 1.06 * level, text, color=GREEN, ha="center", va="bottom")
    for x in (left, right):
        axes.plot([x, x], [height, level], ":", color=GREEN, lw=0.9)
    axes.annotate("", (right, 0.0), (right, height), arrowprops=arrow | {"color": ORANGE})
    text = f" A = {amplitude * scale.factor:.3g} {scale.unit}"
    axes.text(right, 0.35 * height, text, color=ORANGE, va="center", bbox=_BEHIND)
    start = -s * p
    start -= length * np.round(start / length)
    floor = -level
    axes.plot([start, start], [0.0, floor], ":", color=VERMILLION, lw=0.9)
    axes.plot([0.0, 0.0], [0.0, floor], ":", color=VERMILLION, lw=0.9)
    axes.annotate("", (0.0, floor), (start, floor), arrowprops=arrow | {"color": VERMILLION})
    text = f"S = {s:.3g} rad of phase shifts it by −S·P = {-s * p:.3g} {unit}"
    axes.text(0.0, 1.06 * floor, text, color=VERMILLION, ha="center", va="top")


_BEHIND = {"boxstyle": "square,pad=0.1", "facecolor": "white", "edgecolor": "none", "alpha": 0.8}


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
    more = ", ".join(f"{p.name} = {p.value:.3g} {p.unit}" for p in rest)
    return plain(model.name or "model") + (f"\nalso {plain(more)}" if more else "")
