"""The tables of the examination in strata: the program's answers and its peers', over the same knobs."""

from collections.abc import Iterator
from functools import partial
from typing import Any

import numpy as np
from hidden import KINDS
from marks import said
from strata import BANDS, NOISES, Stratum

Row = dict[str, Any]
Rows = dict[str, list[Row]]

PEERS = ("stepwise", "stlsq", "bam")
WIDTH = 38
HEAD = f"{'':{WIDTH}} |   n | exact wrong silent % | s: median  95 % | holds % | p > 0.05 % | " + " | ".join(
    f"{peer:>17}" for peer in PEERS
)
LEGEND = (
    "exact: what was hidden is named, nothing else, and the rest is said to be chance where it is no more;",
    "wrong: a clean verdict with a name that is not right; silent: neither; holds: 95 % intervals of base",
    "parameters, whatever was answered; p: of the first effect added. Peers: n: exact/wrong/silent, %.",
    "bristles, impact_gap and rate_and_state are presliding, backlash and stribeck by other physics than",
    "the core's; each was held on as many knobs as n says. s: of the processor, in one thread.",
)


def report(rows: Rows) -> Iterator[str]:
    """By stratum."""
    yield from LEGEND
    ours = rows["knobcam"]
    late = [_seconds(row) for row in ours if row["verdict"] == "no answer"]
    yield f"Stopped without an answer: {len(late)} of {len(ours)}, after {max(late, default=0.0):.0f} s."
    yield ""
    yield HEAD
    for name, among in _STRATA.items():
        some = _of(rows, among)
        if some["knobcam"]:
            yield _line(name, some)


def at_length(rows: Rows) -> Iterator[str]:
    """By effect and by pair, and every capture that was not answered as it should be."""
    yield HEAD
    for sitting in ("one", "pair"):
        topics = [row["topic"] for row in rows["knobcam"] if row["sitting"] == sitting]
        for topic in dict.fromkeys(topics if sitting == "one" else sorted(topics)):
            yield _line(topic, _of(rows, partial(_is, sitting, topic)))
    yield ""
    yield "not answered as it should be: case, motion, strengths over the noise, what was said"
    for row in rows["knobcam"]:
        if not row["exact"]:
            strengths = " ".join(f"{strength:.2f}" for strength in row.get("strengths", []))
            axis = f", axis {row['axis']}" if row["axis"] else ""
            verdict = f"{row['verdict']}: {said(row)}" if row["found"] else row["verdict"]
            strange = f", misfit {row['misfit']:.2f}" if row.get("misfit") else ""
            yield (
                f"{row['case']:{WIDTH}} {row.get('motion', ''):9} {strengths:11} {verdict}{axis}, "
                f"error {_number(row['error'])}{strange}"
            )


def shares(rows: list[Row]) -> tuple[float, float, float]:
    """Exact, wrong and silent, %."""
    exact = 100.0 * float(np.mean([row["exact"] for row in rows]))
    wrong = 100.0 * float(np.mean([row["wrong"] and not row["exact"] for row in rows]))
    return exact, wrong, max(100.0 - exact - wrong, 0.0)


def _line(name: str, rows: Rows) -> str:
    ours = rows["knobcam"]
    exact, wrong, silent = shares(ours)
    spent = [_seconds(row) for row in ours if "processor_s" in row]
    middle, most = np.quantile(spent or [np.nan], [0.5, 0.95])
    held = [hold for row in ours for name, hold in row["covered"].items() if not _without_a_truth(row, name)]
    first = [row["p_value"] > 0.05 for row in ours if row["p_value"] is not None]
    cells = [
        f"{name:{WIDTH}}",
        f"{len(ours):3}",
        f"{exact:5.0f} {wrong:5.0f} {silent:8.0f}",
        f"{middle:9.1f} {most:5.1f}" if spent else " " * 15,
        f"{100.0 * np.mean(held):7.1f}" if held else " " * 7,
        f"{100.0 * np.mean(first):10.0f}" if first else " " * 10,
        *(_peer(rows[peer]) for peer in PEERS),
    ]
    return " | ".join(cells)


def _without_a_truth(row: Row, parameter: str) -> bool:
    """Contacts that age have no Coulomb level and no viscous part: their law knows one logarithm of speed."""
    friction = parameter.startswith(("coulomb.", "viscous."))
    return friction and "rate_and_state" in row["topic"]


def _peer(rows: list[Row]) -> str:
    if not rows:
        return " " * 17
    counts = "/".join(f"{share:.0f}" for share in shares(rows))
    return f"{len(rows):3}: {counts:>12}"


def _of(rows: Rows, among: Any) -> Rows:
    """The rows of each of whom the knobs are among these; peers' where the program's are too."""
    ours = [row for row in rows["knobcam"] if among(row)]
    cases = {row["case"] for row in ours}
    return {who: [row for row in own if row["case"] in cases] for who, own in rows.items()}


def _is(sitting: str, topic: str, row: Row) -> bool:
    return bool(row["sitting"] == sitting and row["topic"] == topic)


def _banded(band: tuple[float, float]) -> Any:
    return lambda row: row["sitting"] == "one" and Stratum.parse(row["case"]).band == band


def _coupled(row: Row) -> bool:
    return row["sitting"] == "pair" and any(KINDS[name].order == 0 for name in row["topic"].split("+"))


_STRATA = {
    "one effect": lambda row: row["sitting"] == "one",
    **{f"  {band[0]:g} to {band[1]:g} times the noise": _banded(band) for band in BANDS},
    "two effects": lambda row: row["sitting"] == "pair",
    "  no coupling": lambda row: row["sitting"] == "pair" and not _coupled(row),
    "  behind a coupling": lambda row: _coupled(row) and not Stratum.parse(row["case"]).at_shaft,
    "  at the shaft before a coupling": lambda row: _coupled(row) and Stratum.parse(row["case"]).at_shaft,
    **{f"nothing hidden, {noise} noise": partial(_is, "none", noise) for noise in NOISES},
}


def _seconds(row: Row) -> float:
    """Of the processor; what the clock said beside other work would say little."""
    return float(row.get("processor_s", np.nan))


def _number(value: float | None) -> str:
    return "none" if value is None or not np.isfinite(value) else f"{value:.3f}"
