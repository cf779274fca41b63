"""The tables of logs with faults."""

import math
import statistics
from collections import Counter
from collections.abc import Callable, Iterator

from logs import Row, barred

WIDTH = 37  # of a fault's name
SAID = (
    "said: the fault is named by a finding or effect; M off: the inertia from the true one, %, median and",
    "most, of what was learned the most; holds: its 95 % interval does; besides: findings of what is not",
    "there; accused: an effect is named that is not there, or none and the rest called unexplained (right of",
    "logs marked *: no model of them is of the knob); floor: noise floor over the true one, median and worst",
)


def report(rows: list[Row]) -> Iterator[str]:
    """Both tables."""
    yield from SAID
    yield ""
    yield from _fitted([row for row in rows if not row["learned"]])
    yield ""
    yield from _learned([row for row in rows if row["learned"]])


def failures(rows: list[Row]) -> Iterator[str]:
    """Every log that was not answered as it should be; those that were fitted together, by what is wrong."""
    odd = [row for row in rows if not right(row)]
    yield f"not answered as they should be: {len(odd)} of {len(rows)}"
    yield ""
    fitted: dict[tuple[str, str], list[str]] = {}
    for row in odd:
        wrong = ["not said"] if row["said"] is False else []
        wrong += [f"said {kind}" for kind in row["besides"]]
        if not row["learned"]:
            fitted.setdefault((row["fault"], ", ".join(wrong)), []).append(str(row["seed"]))
            continue
        said = [row["verdict"], " + ".join(row["found"]) or "no effect", *wrong]
        off = "?" if row["off_percent"] is None else f"{row['off_percent']:+.3g}"
        hid = f"hid {' + '.join(row['hid'])}" if row["hid"] else "nothing hidden"
        about = f"{row['fault']:{WIDTH}} {row['seed']:3} {row['motion']:9} {hid}"
        yield f"{about}: M {off} %, {', '.join(said)}, {row['seconds']:.0f} s"
    yield ""
    for (fault, what), seeds in fitted.items():
        yield f"{fault:{WIDTH}} fitted: {what}: {len(seeds)}, seeds {' '.join(seeds)}"


def right(row: Row) -> bool:
    """Whether the fault is said and nothing false; where an effect is hidden, whether it comes first."""
    good = row["said"] is not False and not row["besides"]
    if not row["learned"]:
        return good
    if barred(row["fault"]):
        # All is well where the fault does not matter to this knob.
        return good and not row["accused"] and (row["holds"] or not row["complete"])
    return good and not row["accused"] and (row["first"] or not row["hid"])


def _fitted(rows: list[Row]) -> Iterator[str]:
    yield f"{'fitted, nothing hidden':{WIDTH}} |  n | said % |  M off, % | holds % | floor       | besides"
    for fault, own in _by_fault(rows):
        besides = Counter(kind for row in own for kind in row["besides"])
        cells = [
            f"{len(own):2}",
            f"{_said(own):>6}",
            f"{_off(own, statistics.median):4} {_off(own, max):>4}",
            f"{_percent(own, 'holds'):>7}",
            f"{_floor(own):11}",
            ", ".join(f"{kind} {count}" for kind, count in besides.most_common(3)),
        ]
        yield f"{fault:{WIDTH}} | {' | '.join(cells)}"


def _learned(rows: list[Row]) -> Iterator[str]:
    yield f"{'':{WIDTH}} |     |        | nothing hidden                        | one effect hidden"
    without = "complete % | accused % | M off | holds %"
    hiding = without.replace("complete %", "first % | exact %")
    yield f"{'learned':{WIDTH}} |   n | said % | {without} | {hiding} | floor"
    together = [("all but *", [row for row in rows if not barred(row["fault"])])] if rows else []
    for fault, own in [*_by_fault(rows), *together]:
        bare, rich = ([row for row in own if bool(row["hid"]) is hides] for hides in (False, True))
        cells = [
            f"{len(bare)}+{len(rich)}",
            f"{_said(own):>6}",
            f"{_percent(bare, 'complete'):>10}",
            *_ends(bare),
        ]
        cells += [f"{_percent(rich, name):>7}" for name in ("first", "exact")]
        yield f"{fault:{WIDTH}} | {' | '.join([*cells, *_ends(rich), _floor(own)])}"


def _ends(rows: list[Row]) -> Iterator[str]:
    yield f"{_percent(rows, 'accused'):>9}"
    yield f"{_off(rows, max):>5}"
    yield f"{_percent(rows, 'holds'):>7}"


def _by_fault(rows: list[Row]) -> Iterator[tuple[str, list[Row]]]:
    for fault in dict.fromkeys(row["fault"] for row in rows):
        yield fault + " *" * barred(fault), [row for row in rows if row["fault"] == fault]


def _percent(rows: list[Row], mark: str) -> str:
    return f"{100.0 * sum(row[mark] for row in rows) / len(rows):.0f}" if rows else ""


def _said(rows: list[Row]) -> str:
    return _percent([row for row in rows if row["said"] is not None], "said")


def _off(rows: list[Row], of: Callable[[list[float]], float]) -> str:
    values = [abs(row["off_percent"]) for row in rows if row["off_percent"] is not None]
    return _short(of(values)) if values else "?"


def _short(value: float) -> str:
    """Two digits, or all of a whole number."""
    return f"{value:.2g}" if value < 99.5 else f"{value:.0f}" if value < 9999.5 else ">9999"


def _floor(rows: list[Row]) -> str:
    """The median, the one farthest from 1, and how many are unknown, where some are."""
    floors = [row["floor"] for row in rows if row["floor"] is not None]
    unknown = f", {len(rows) - len(floors)} unknown" if len(floors) < len(rows) else ""
    if not floors:
        return unknown.removeprefix(", ")
    return (
        f"{statistics.median(floors):.3g} {max(floors, key=lambda floor: abs(math.log(floor))):.3g}{unknown}"
    )
