"""The signature of an effect: what it adds to the torque of a small knob, over time and where it shows."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from matplotlib.lines import Line2D

from ...capture.motions import MotionTrack
from ...model.simulate import simulate
from ...model.typical import CARRIER, of_values, pictured, with_typical
from ..words import effect_word, unit_word
from .laws import friction
from .style import (
    BACKWARD,
    BLACK,
    FORWARD,
    GREY,
    RAW,
    WRONG,
    Picture,
    Scale,
    legend_above,
    motion_units,
    number,
    plain,
    styled,
    torque_scale,
)
from .thin import envelope, some

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from ...base.arrays import FloatArray
    from ...model import Model
    from ...model.effects import Effect
    from ...model.typical import Carrier

_BINS = 60
# Whatever is smooth follows time as well; it is said of time only where no other axis does nearly as much.
_TIME = 0.9


class _Added(NamedTuple):
    """What an effect adds on a motion to the torque of the plain knob, N m, shape (samples,)."""

    track: MotionTrack
    tau: FloatArray
    plain: FloatArray

    @property
    def since_reversal(self) -> FloatArray:
        """Distance since the direction last changed, rad."""
        way = np.concatenate([[0.0], np.cumsum(np.abs(np.diff(self.track.theta)))])
        forward = self.track.omega >= 0.0
        turned = np.flatnonzero(forward[1:] != forward[:-1]) + 1
        start = np.zeros(len(way))
        start[turned] = np.diff(way[np.concatenate([[0], turned])])
        return way - np.cumsum(start)


@styled
def effect(effect: Effect) -> Picture:
    """The torque that an effect adds to a small knob for typical values, over time and over each axis.

    The knob is simulated with and without it on the same motion, so couplings, sensors and effects with a
    memory show as they would in a capture. The axis that it follows, if it follows any, is framed.
    """
    carried = pictured()
    values = carried.typical(effect)
    carrier = {name: value for name, value in CARRIER.items() if not name.startswith(f"{effect.id}.")}
    if effect.unsearched is not None:
        return _standing(effect, of_values({**carrier, **values}))
    added = _added(of_values(carrier), effect, carried)
    scale = torque_scale("N m", float(np.max(np.abs(added.tau), initial=0.0)))
    figure = Picture(13.0, 6.6, _title(effect, values))
    units = motion_units("rotary")
    axes_of = {
        f"position ({units['theta']})": added.track.theta,
        f"velocity ({units['omega']})": added.track.omega,
        f"acceleration ({units['alpha']})": added.track.alpha,
        f"torque of the plain knob ({scale.unit})": added.plain * scale.factor,
        f"distance since reversal ({units['theta']})": added.since_reversal,
    }
    shares = {label: _share(x, added) for label, x in axes_of.items()}
    over_time = _TIME * _share(added.track.t, added)
    grid = figure.add_gridspec(2, len(axes_of), height_ratios=[0.8, 1.0])
    whole = figure.add_subplot(grid[0, :])
    _over_time(whole, added, scale)
    best = max(over_time, *shares.values())
    if best == over_time > 0.5:
        _frame(whole)
    for column, (label, x) in enumerate(axes_of.items()):
        axes = figure.add_subplot(grid[1, column])
        _cloud(axes, x, added, scale, label, shares[label], shares[label] == best > 0.5)
        if column == 0:
            axes.set_ylabel(f"added torque ({scale.unit})")
    _legend(figure)
    return figure


def _added(bare: Model, effect: Effect, carried: Carrier) -> _Added:
    """Simulate the knob with and without the effect, without sensor noise."""
    with_it, without = (
        simulate(model, carried.track, noise="none").tau
        for model in (with_typical(bare, effect, carried), bare)
    )
    return _Added(carried.track, np.nan_to_num(with_it - without), without)


def _share(x: FloatArray, added: _Added) -> float:
    """Return the part of the added torque's square that is a line over `x`, one for each direction."""
    total = float(np.sum(added.tau**2))
    if total == 0.0:
        return 0.0
    explained = 0.0
    for side in (added.track.omega >= 0.0, added.track.omega < 0.0):
        borders = np.quantile(x[side], np.linspace(0.0, 1.0, _BINS + 1)[1:-1])
        cell = np.digitize(x[side], borders)
        count = np.bincount(cell, minlength=_BINS)
        sums = np.bincount(cell, added.tau[side], minlength=_BINS)
        explained += float(np.sum(sums[count > 0] ** 2 / count[count > 0]))
    return explained / total


def _standing(effect: Effect, model: Model) -> Picture:
    """Stiction adds nothing while the knob moves: its signature is the stick band beside sliding friction."""
    figure = Picture(8.0, 4.8, _title(effect, {}))
    friction(figure.add_subplot(), model)
    return figure


def _title(effect: Effect, values: dict[str, float]) -> str:
    units = {f"{effect.id}.{one.name}": unit_word(one.unit) for one in effect.params}
    # What is zero, as waves of a series that this knob has not, says nothing of it.
    given = [(name.split(".", 1)[1], value, units.get(name, "")) for name, value in values.items() if value]
    short = ", ".join(f"{own} = {number(value)} {unit}".rstrip() for own, value, unit in given)
    lines = [f"{effect.title}: {effect.name}", f"shows {effect.shows}"]
    if effect.confused:
        confused = (effect_word(one, "rotary") for one in effect.confused)
        lines.append(f"easily confused with {', '.join(confused)}")
    here = f"here on a small knob, with {short}" if short else "here on a small knob"
    return "\n".join(plain(line, 200) for line in (*lines, here))


def _over_time(axes: Axes, added: _Added, scale: Scale) -> None:
    """Draw the torque of the knob without the effect, and what the effect adds to it."""
    t = added.track.t
    axes.plot(*envelope(t, added.plain * scale.factor), color=RAW, lw=0.7, label="the knob without it")
    axes.plot(*envelope(t, added.tau * scale.factor), color=WRONG, lw=1.2, label="what it adds")
    axes.axhline(0.0, color=BLACK, lw=0.6, zorder=1)
    axes.set_title("Over time")
    axes.set_xlabel("time (s)")
    axes.set_ylabel(f"torque ({scale.unit})")
    legend_above(axes)


def _cloud(
    axes: Axes, x: FloatArray, added: _Added, scale: Scale, label: str, share: float, best: bool
) -> None:
    """Draw the added torque in the colour of the direction of motion."""
    # Where both directions feel the same, the thin one lies within the wide one.
    for forward, color, size, name in (
        (True, FORWARD, 5.0, "moving forward"),
        (False, BACKWARD, 1.8, "moving backward"),
    ):
        rows = some((added.track.omega >= 0.0) == forward)
        tau = added.tau[rows] * scale.factor
        axes.plot(x[rows], tau, ".", ms=size, mew=0, color=color, rasterized=True, label=name)
    axes.axhline(0.0, color=BLACK, lw=0.6, zorder=1)
    axes.set_title(
        f"{100.0 * share:.0f} % follows {label.split(' ')[0]}",
        color=BLACK if best else GREY,
        fontweight="bold" if best else "normal",
    )
    axes.set_xlabel(label)
    if label.startswith("distance"):
        axes.set(xscale="log", xlim=(1e-4, float(np.max(x))))
    if best:
        _frame(axes)
    # A few impacts must not flatten all the rest.
    reach = 1.2 * scale.factor * float(np.quantile(np.abs(added.tau), 0.998))
    axes.set_ylim(-reach or -1.0, reach or 1.0)


def _frame(axes: Axes) -> None:
    for side in ("left", "right", "top", "bottom"):
        axes.spines[side].set(visible=True, color=WRONG, linewidth=1.8)


def _legend(figure: Figure) -> None:
    """Name the colours of the directions once, for all panels."""
    dots = {"moving forward": FORWARD, "moving backward": BACKWARD}
    handles = [
        Line2D([], [], ls="", marker=".", ms=9.0, color=color, label=name) for name, color in dots.items()
    ]
    figure.legend(handles=handles, loc="upper right", ncols=2)
