"""A batch as one HTML file, pictures first: verdicts, parameters over lots, curves, charts, what failed."""

from __future__ import annotations

import os
from html import escape
from importlib import resources
from pathlib import Path
from string import Template
from typing import TYPE_CHECKING

from .._core import __version__
from ..base.writing import write as write_file
from . import plot
from .markup import bullets, figure, paragraph, style, wide_table

if TYPE_CHECKING:
    from ..fleet import BatchResult

_MOST = 200
"""Captures of a table in a report; the table of the batch has all."""


def write(result: BatchResult, path: str | os.PathLike[str]) -> Path:
    """Write the report; it appears whole or not at all."""
    return write_file(path, html(result).encode("utf-8", "replace"))


def html(result: BatchResult) -> str:
    """Return the report."""
    page = resources.files("knobcam.show").joinpath("batch.html").read_text("utf-8")
    word, verdict = _verdict(result)
    said = [*result.study.said, *result.document()["mixed"]]
    return Template(page).substitute(
        title=escape(f"Captures in {result.folder}"),
        style=style(),
        verdict=verdict,
        word=word,
        headline=escape(result.headline),
        said=bullets(said) if said else "",
        pictures=_pictures(result),
        failed=_failed(result),
        lots=_lots(result),
        capable=_capable(result),
        gauge=_gauge(result),
        made=escape(f"Made by knobcam {__version__}. SI units."),
    )


def _verdict(result: BatchResult) -> tuple[str, str]:
    """Return the word on top and its colour."""
    if any(row["ok"] is False for row in result.counted):
        return "not all OK", "unexplained"
    if result.found or result.study.said:
        return "look at it", "missing"
    if any(row["error"] is not None for row in result.counted):
        return "not all read", "missing"
    return "all OK" if result.limits is not None else "all alike", "complete"


def _pictures(result: BatchResult) -> str:
    parts = [figure(plot.batch(result), "Verdicts by lot, and effects that were found missing.")]
    if result.study.held:
        said = "Bold: what is named. The first lot itself is held against chance, each other one against it."
        parts.append(figure(plot.batch_hints(result), said))
    if result.study.units:
        said = "Dots are captures, crosses those that are not OK, broken lines the limits; triangles at the "
        said += "edge are captures beyond it, by name and value."
        parts.append(figure(plot.batch_parameters(result), said))
        parts.append(
            figure(
                plot.batch_curves(result),
                "Red: not OK, or unlike its lot; triangles: beyond the edge. Broken: the band.",
            )
        )
    if result.study.charts:
        parts.append(figure(plot.batch_charts(result), "Red: the mean moved beyond chance."))
    return "\n".join(parts)


def _failed(result: BatchResult) -> str:
    rows = result.text_rows()
    if not rows:
        return paragraph("Nothing: every capture was read, is like its lot, and within its limits.")
    more = paragraph(f"And {len(rows) - _MOST} more in the table.") if len(rows) > _MOST else ""
    return wide_table("Captures to be looked at", result.HEAD, rows[:_MOST]) + more


def _lots(result: BatchResult) -> str:
    study = result.study
    if not study.said:
        return paragraph("No lot and no station differs from the others beyond chance.")
    rows = [
        (
            f"{one.by} {one.name}",
            one.parameter,
            f"{one.percent:+.2f} %",
            _ends(one.ci95),
            f"{one.p_value:.2g}",
        )
        for one in study.shifts
    ]
    head = ("lot or station", "parameter", "against the others", "95 % interval (%)", "p-value")
    told = bullets(study.said)
    told += wide_table("What differs (Welch's test, Holm's correction)", head, rows) if rows else ""
    return told + _hints(result)


def _hints(result: BatchResult) -> str:
    """What lots hint at beyond chance, effect by effect; nothing where that is nothing."""
    head = ("lot", "against", "effect", "standard errors", "captures", "p-value", "remark")
    rows = [
        (
            one.lot or "no lot",
            "chance" if one.against is None else one.against or "no lot",
            one.effect,
            f"{one.score:+.1f}",
            f"{one.captures[0]}" if one.against is None else f"{one.captures[0]} and {one.captures[1]}",
            f"{one.p_value:.2g}",
            "" if one.plausible else "no such effect has this sign",
        )
        for one in result.study.held
        if one.sure
    ]
    return wide_table("What lots hint at (ranks, Holm's correction)", head, rows) if rows else ""


def _capable(result: BatchResult) -> str:
    able = result.study.capability
    if not able:
        return paragraph("Cp and Cpk need limits on parameters, and five captures of a lot.")
    head = ("parameter", "unit", "lot", "captures", "mean", "deviation", "limits", "Cp", "Cpk")
    rows = [
        (
            one.parameter,
            result.study.units[one.parameter],
            one.lot or "no lot",
            str(one.captures),
            f"{one.mean:.4g}",
            f"{one.deviation:.3g}",
            _held(result, one.parameter),
            "" if one.cp is None else f"{one.cp[0]:.2f} ({_ends(one.cp[1:])})",
            f"{one.cpk[0]:.2f} ({_ends(one.cpk[1:])})",
        )
        for one in able
    ]
    return wide_table("Capability, with 95 % intervals; 1.33 and more is usually asked for", head, rows)


def _held(result: BatchResult, parameter: str) -> str:
    held = result.drawn.of(parameter) if result.drawn is not None else None
    return "" if held is None else f"{held.low:.4g} to {held.high:.4g}"


def _gauge(result: BatchResult) -> str:
    gauges = result.study.gauges
    if not gauges:
        return paragraph(
            "Repeatability needs three parts or more that were captured twice: folders or columns named part."
        )
    head = (
        "parameter",
        "unit",
        "captures",
        "repeats",
        "stations",
        "parts",
        "gauge of all",
        "classes told apart",
    )
    rows = [
        (
            one.parameter,
            result.study.units[one.parameter],
            str(one.captures),
            *(f"{value:.3g}" for value in (one.repeats, one.stations, one.parts)),
            f"{one.percent:.1f} %",
            str(one.distinct),
        )
        for one in gauges
    ]
    return wide_table("Gauge R&R by analysis of variance; standard deviations", head, rows)


def _ends(ends: tuple[float, ...]) -> str:
    return f"{ends[0]:.3g} to {ends[1]:.3g}"
