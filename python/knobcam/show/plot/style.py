"""How every picture looks: colours, sizes and the figure that carries them, without touching global state."""

from __future__ import annotations

import io
import os
from collections.abc import Callable, Sequence
from functools import cache, wraps
from pathlib import Path
from textwrap import fill
from typing import TYPE_CHECKING, Any, NamedTuple, ParamSpec, TypeVar

from matplotlib import rcParams
from matplotlib.figure import Figure
from matplotlib.font_manager import findfont, get_font
from matplotlib.lines import Line2D
from matplotlib.style import context

from ...base.writing import write
from ...capture.formats.units import GIVEN

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.backend_bases import RendererBase

    from ...capture import Capture

_P = ParamSpec("_P")
_R = TypeVar("_R")

# Okabe & Ito 2008, told apart by people of any colour vision.
BLACK, ORANGE, SKY, GREEN = "#000000", "#E69F00", "#56B4E9", "#009E73"
YELLOW, BLUE, VERMILLION, PURPLE = "#F0E442", "#0072B2", "#D55E00", "#CC79A7"
GREY, PALE = "#8A8A8A", "#D9D9D9"

# One meaning has one colour in every picture.
RAW, FITTED, BAND, WRONG = GREY, BLUE, SKY, VERMILLION
FORWARD, BACKWARD = BLUE, ORANGE

_FONT = "DejaVu Sans"  # comes with matplotlib, so pictures look alike on every machine
_LONGEST_NAME = 80
_LETTERS_PER_INCH = 10.0  # of a title
_RC: dict[str, Any] = {
    "font.family": _FONT,
    "font.size": 9.0,
    "axes.titlesize": 10.0,
    "axes.titlelocation": "left",
    "axes.titleweight": "normal",
    "axes.labelsize": 9.0,
    "axes.labelcolor": "#222222",
    "axes.edgecolor": "#444444",
    "axes.linewidth": 0.8,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "axes.grid": True,
    "axes.axisbelow": True,
    "axes.xmargin": 0.01,
    "axes.facecolor": "white",
    "axes.formatter.useoffset": False,
    "axes.formatter.limits": (-4, 5),
    "figure.facecolor": "white",
    "figure.titlesize": 11.5,
    "figure.dpi": 110.0,
    "savefig.facecolor": "white",
    "svg.hashsalt": "knobcam",  # the same picture is the same file
    "grid.color": "#E6E6E6",
    "grid.linewidth": 0.6,
    "legend.frameon": False,
    "legend.fontsize": 8.5,
    "legend.handlelength": 1.6,
    "legend.columnspacing": 1.4,
    "lines.linewidth": 1.2,
    "mathtext.fontset": "dejavusans",
    "text.usetex": False,
    "xtick.color": "#444444",
    "ytick.color": "#444444",
    "xtick.labelsize": 8.5,
    "ytick.labelsize": 8.5,
}


def styled(draw: Callable[_P, _R]) -> Callable[_P, _R]:
    """Make a drawing function work in the style, and leave the user's settings as they were."""

    @wraps(draw)
    def inside(*args: _P.args, **kwargs: _P.kwargs) -> _R:
        with context(["default", _RC]):
            return draw(*args, **kwargs)

    return inside


class Picture(Figure):
    """A matplotlib figure in this package's style, whatever the user's own settings are.

    It belongs to no window and no `pyplot` state; a notebook shows it, and `savefig` writes it.
    """

    def __init__(self, width: float, height: float, title: str) -> None:
        super().__init__(figsize=(width, height), layout="constrained")
        # Lines that are longer than the picture is wide break between words.
        lines = [
            # A number keeps its per cent.
            fill(
                line.replace(" %", "\N{NO-BREAK SPACE}%"),
                int(_LETTERS_PER_INCH * width),
                break_long_words=False,
            )
            for line in title.split("\n")
        ]
        self.suptitle("\n".join(lines), x=0.01, ha="left")

    @styled
    def draw(self, renderer: RendererBase) -> None:
        """Draw in the style: matplotlib makes ticks while it draws, from the settings of that moment."""
        super().draw(renderer)

    @styled
    def savefig(self, fname: Any, **kwargs: Any) -> None:
        """Write the picture; arguments as matplotlib takes them. A file appears whole or not at all."""
        if not isinstance(fname, str | os.PathLike):
            super().savefig(fname, **kwargs)
            return
        path = Path(fname)
        kind = kwargs.pop("format", None) or path.suffix[1:]
        if not kind:  # as matplotlib has it
            kind = rcParams["savefig.format"]
            path = path.with_name(f"{path.name}.{kind}")
        write(path, lambda file: super(Picture, self).savefig(file, format=kind, **kwargs))

    def _repr_png_(self) -> bytes:
        stream = io.BytesIO()
        self.savefig(stream, format="png")
        return stream.getvalue()


class Scale(NamedTuple):
    """A unit for the eye: `shown = factor * SI`."""

    factor: float
    unit: str


def torque_scale(unit: str, peak: float = 0.0) -> Scale:
    """Return the unit in which a torque is shown: mNm as in the paper, N m far beyond knobs, others as is."""
    return Scale(1.0, unit) if unit != "N m" or peak > _STRONG_N_M else Scale(1000.0, "mNm")


_STRONG_N_M = 2.0  # ten times what the rig of the paper measures


def torque_symbol(unit: str) -> str:
    """Return the symbol of what is in such a unit, for the inside of a formula."""
    return {"N m": "\\tau", "N": "F", "A": "I", "V": "U"}.get(unit, "d")


def torque_word(unit: str) -> str:
    """Return what is in such a unit and moves the knob."""
    return {"N m": "torque", "N": "force"}.get(unit) or GIVEN[unit]


def motion_units(coordinate: str) -> dict[str, str]:
    """Return the units of theta, omega and alpha as they are printed."""
    length = "m" if coordinate == "linear" else "rad"
    return {"theta": length, "omega": f"{length}/s", "alpha": f"{length}/s²"}


@cache
def _glyphs() -> frozenset[int]:
    return frozenset(get_font(findfont(_FONT)).get_charmap())


def plain(text: object, longest: int = _LONGEST_NAME) -> str:
    """Return foreign text (a file or model name) so that it prints as it is.

    `$` starts no formula, line breaks and characters without a glyph become `?`, and what is longer than
    `longest` characters loses its middle.
    """
    known = "".join(c if c.isprintable() and ord(c) in _glyphs() else "?" for c in str(text))
    if len(known) > longest:
        half = longest // 2
        known = known[: half - 1] + "…" + known[-half:]
    return known.replace("$", r"\$")


def number(value: float, digits: int = 3) -> str:
    """Return a number for a label, with a true minus."""
    return f"{value:.{digits}g}".replace("-", "−")


def name_of(capture: Capture) -> str:
    """Return what a capture came from: the name of its file, not where that lies, or what made it."""
    source = str(capture.meta.get("source", "")) or "capture"
    return Path(source).name if "format" in capture.meta else source


def source_of(capture: Capture) -> str:
    """Return the same for a label."""
    return plain(name_of(capture))


def legend_above(axes: Axes) -> None:
    """Put the legend in one row above the axes on the right, where it hides nothing."""
    handles, labels = axes.get_legend_handles_labels()
    if not handles:
        return
    legend = axes.legend(
        handles,
        labels,
        loc="lower right",
        bbox_to_anchor=(1.0, 1.0),
        borderaxespad=0.1,
        ncols=len(labels),
    )
    for handle in legend.legend_handles:
        if isinstance(handle, Line2D) and handle.get_marker() != "None":
            handle.set(alpha=1.0, markersize=7.0)  # the dots of a cloud are too small to name a colour


def legend_below(axes: Axes, title: str, columns: int) -> None:
    """Put the legend between the axes and their title, where there is no room beside that."""
    handles, labels = axes.get_legend_handles_labels()
    lines = -(-len(labels) // columns)
    axes.set_title(title, fontweight="bold", pad=8.0 + 13.0 * lines)
    if handles:
        axes.legend(loc="lower left", bbox_to_anchor=(0.0, 1.0), borderaxespad=0.1, ncols=columns)


def shade(axes: Axes, runs: Sequence[tuple[float, float]], label: str) -> None:
    """Shade stretches (start, length) over the whole height; short ones stay visible by their edge."""
    axes.broken_barh(
        runs,
        (0.0, 1.0),
        transform=axes.get_xaxis_transform(),
        facecolor=WRONG,
        edgecolor=WRONG,
        lw=0.7,
        alpha=0.35,
        zorder=0.5,
        label=label,
    )
