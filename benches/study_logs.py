"""Logs with the faults that real ones have: what is said, and what it costs. `python benches/study_logs.py`.

The independent simulator makes knobs without and with a hidden effect, `hidden.FAULTS` spoils their logs, and
the program is given the file alone: `knobcam learn`, and of more knobs without an effect `knobcam fit`. Tables are printed and written to `benches/results/logs.json`.
"""

import argparse
import json
import math
import os
import statistics
import sys
import tempfile
import time
import zlib
from collections import Counter
from collections.abc import Callable, Iterator
from multiprocessing import Pool
from pathlib import Path
from typing import Any, NamedTuple

# One thread each: the logs are examined beside one another.
THREADS = ("OPENBLAS_NUM_THREADS", "RAYON_NUM_THREADS")
RESULTS = Path(__file__).with_name("results") / "logs.json"
# Strengths of the hidden effects, RMS over white noise: findable under coloured noise as well, whose floor is
# three times as high.
WEAKEST, STRONGEST = 3.0, 12.0

STRIDE = 12  # through the effects, so that a few seeds have unlike ones
WIDTH = 37  # of a fault's name
COMMAND = "python benches/study_logs.py --seeds {seeds} --fits {fits} --first {first} --cap {cap:g}"
SAID = (
    "said: the fault is named by a finding, or as an effect; M off: the inertia from the true one, % (learned:",
    "the most); holds: its 95 % interval does; besides: findings of what is not there; accused: an effect is",
    "named that is not there, or none is and the rest called unexplained (which is right of logs marked *: no",
    "model of them is one of the knob); floor: noise floor over the true one, the median and the worst",
)

Row = dict[str, Any]


class Log(NamedTuple):
    """A log to be examined: a fault, on knob `seed` with a hidden effect or without; learned or fitted."""

    fault: str
    seed: int
    hides: bool = False
    learned: bool = True
    cap_s: float = 60.0

    @property
    def effects(self) -> list[str]:
        """What is hidden: another effect with each seed."""
        from hidden import NAMED

        return [list(NAMED)[STRIDE * self.seed % len(NAMED)]] if self.hides else []

    def make(self) -> tuple[Any, dict[str, Any]]:
        """The knob, which is the same for all faults, and the columns of its log with the fault."""
        import numpy as np
        from hidden import FAULTS, MOTIONS, make

        own = FAULTS[self.fault]
        rng = np.random.default_rng([self.seed, zlib.crc32(self.fault.encode())])
        drawn = np.random.default_rng([self.seed, 7])
        motion = list(MOTIONS)[(self.seed + self.hides) % len(MOTIONS)]
        strength = float(np.exp(drawn.uniform(np.log(WEAKEST), np.log(STRONGEST))))
        keep = max(fault.keep for fault in own)
        knob = make(self.seed, self.effects, motion, strength if self.hides else None, keep=keep)
        columns = {name: values.copy() for name, values in knob.capture.items()}
        for fault in own:
            columns = fault.put(rng, columns)
        return knob, columns


def examine(log: Log) -> Row:
    """What is said of one log, beside the truth."""
    import numpy as np

    import knobcam as kc

    knob, columns = log.make()
    start = time.monotonic()

    def watch(_: str) -> None:
        if time.monotonic() - start > log.cap_s:
            raise TimeoutError(f"not done in {log.cap_s:g} s")

    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "log.npz"
        np.savez(path, **columns)
        capture = kc.load(path)
        try:
            told = kc.learn(capture, progress=watch) if log.learned else kc.fit(capture)
            document = told.document()
        except Exception as error:  # a program that fails has not answered, and the others go on
            findings = [finding.document() for finding in capture.findings]
            failed = {"verdict": f"{type(error).__name__}: {error}", "found": [], "ladder": []}
            document = failed | {"findings": findings, "noise_floor": None}
    about = {"fault": log.fault, "seed": log.seed, "motion": knob.motion, "hid": list(knob.effects)}
    about |= {"learned": log.learned, "seconds": round(time.monotonic() - start, 1)}
    return (
        about
        | judged(log.fault, knob, document)
        | (answered(log.fault, knob, document) if log.learned else {})
    )


def judged(name: str, knob: Any, document: dict[str, Any]) -> Row:
    """How what was found and fitted compares with the fault `name` of a log and with its knob."""
    from hidden import FAULTS

    faults = FAULTS[name]
    kinds = [(finding["kind"], f"{finding['kind']} {finding['column']}") for finding in document["findings"]]
    wanted = frozenset().union(*(fault.said for fault in faults))
    # A fit names no effect.
    found = set(document.get("found", []))
    sayable = [fault for fault in faults if fault.said and not (fault.effects and "found" not in document)]
    last = document["ladder"][-1:] if "ladder" in document else [document]
    estimate = last[0]["params"].get("inertia.M") if last else None
    true, floor = knob.knob["inertia.M"], document["noise_floor"]
    interval = estimate and estimate["ci95"]
    named = [
        any(fault.said & set(kind) for kind in kinds) or bool(fault.effects & found) for fault in sayable
    ]
    return {
        "said": all(named) if named else None,
        "besides": sorted({kind[1] for kind in kinds if not wanted & set(kind)}),
        "off_percent": None if estimate is None else round(100.0 * (estimate["value"] / true - 1.0), 3),
        "holds": bool(interval and interval[0] <= true <= interval[1]),
        "floor": None if not floor else round(floor / knob.noise_floor, 4),
    }


def answered(name: str, knob: Any, document: dict[str, Any]) -> Row:
    """How the verdict and the effects that were named compare with what is hidden in the knob."""
    from hidden import FAULTS

    found, verdict = document["found"], document["verdict"]
    accepted = set().union(*knob.accepted)
    named = [effect for effect in found if not any(effect in fault.effects for fault in FAULTS[name])]
    unexplained = not named and not accepted and verdict not in ("complete", "missing")
    return {
        "verdict": verdict,
        "found": found,
        "complete": verdict == "complete",
        "first": bool(named) and named[0] in accepted,
        "exact": verdict == "missing" and len(named) == 1 and named[0] in accepted,
        "accused": bool(set(named) - accepted) or (unexplained and not barred(name)),
    }


def barred(name: str) -> bool:
    """Whether a log with that fault is no longer one of the knob."""
    from hidden import FAULTS

    return any(fault.bars for fault in FAULTS[name])


def run(logs: list[Log], jobs: int) -> list[Row]:
    """Examine the logs."""
    rows = []
    with Pool(jobs) as pool:
        for count, row in enumerate(pool.imap(examine, logs), 1):
            rows.append(row)
            print(f"\r{count} of {len(logs)}: {row['fault']:40}", end="", file=sys.stderr, flush=True)
    print(file=sys.stderr)
    return rows


def report(rows: list[Row], head: str) -> Iterator[str]:
    """Both tables."""
    yield head
    yield from SAID
    yield ""
    yield from _fitted([row for row in rows if not row["learned"]])
    yield ""
    yield from _learned([row for row in rows if row["learned"]])


def failures(rows: list[Row]) -> Iterator[str]:
    """Every log that was not answered as it should be."""
    odd = [row for row in rows if not right(row)]
    yield f"not answered as it should be: {len(odd)} of {len(rows)}"
    for row in odd:
        said = ["fault not said"] if row["said"] is False else []
        said += [f"said {kind}" for kind in row["besides"]]
        if row["learned"]:
            said += [row["verdict"], " + ".join(row["found"]) or "no effect", f"{row['seconds']:.0f} s"]
        off = "?" if row["off_percent"] is None else f"{row['off_percent']:+.3g}"
        hid = f"hid {' + '.join(row['hid'])}" if row["hid"] else "nothing hidden"
        how = "learned" if row["learned"] else "fitted"
        yield f"{row['fault']:{WIDTH}} {row['seed']:3} {row['motion']:9} {hid}, {how}: M {off} %, {', '.join(said)}"


def right(row: Row) -> bool:
    """Whether the fault is said and nothing false; where an effect is hidden, whether it comes first."""
    good = row["said"] is not False and not row["besides"]
    if not row["learned"]:
        return good
    if barred(row["fault"]):
        return good and not row["accused"] and not row["complete"]
    return good and not row["accused"] and (row["first"] or not row["hid"])


def _fitted(rows: list[Row]) -> Iterator[str]:
    yield f"{'fitted, nothing hidden':{WIDTH}} |  n | said % | M off, %: median, most | holds % | floor | besides"
    for fault, own in _by_fault(rows):
        besides = Counter(kind for row in own for kind in row["besides"])
        yield (
            f"{fault:{WIDTH}} | {len(own):2} | {_said(own):>6} | {_off(own, statistics.median):14} {_off(own, max):>7} "
            f"| {_percent(own, 'holds'):>7} | {_floor(own)} "
            f"| {', '.join(f'{kind} {count}' for kind, count in besides.most_common(3))}"
        )


def _learned(rows: list[Row]) -> Iterator[str]:
    yield f"{'':{WIDTH}} |    |        | nothing hidden                         | one effect hidden"
    columns = "complete % | accused % |  M off | holds %"
    yield f"{'learned':{WIDTH}} |  n | said % | {columns} | {columns.replace('complete %', 'first % | exact %')} | floor"
    for fault, own in _by_fault(rows):
        without, hiding = ([row for row in own if bool(row["hid"]) is hides] for hides in (False, True))
        ends = [
            f"{_percent(part, 'accused'):>9} | {_off(part, max):>6} | {_percent(part, 'holds'):>7}"
            for part in (without, hiding)
        ]
        yield (
            f"{fault:{WIDTH}} | {len(own):2} | {_said(own):>6} | {_percent(without, 'complete'):>10} | {ends[0]} "
            f"| {_percent(hiding, 'first'):>7} | {_percent(hiding, 'exact'):>7} | {ends[1]} | {_floor(own)}"
        )


def _by_fault(rows: list[Row]) -> Iterator[tuple[str, list[Row]]]:
    for fault in dict.fromkeys(row["fault"] for row in rows):
        yield fault + " *" * barred(fault), [row for row in rows if row["fault"] == fault]


def _percent(rows: list[Row], mark: str) -> str:
    return f"{100.0 * sum(row[mark] for row in rows) / len(rows):.0f}" if rows else ""


def _said(rows: list[Row]) -> str:
    return _percent([row for row in rows if row["said"] is not None], "said")


def _off(rows: list[Row], of: Callable[[list[float]], float]) -> str:
    values = [abs(row["off_percent"]) for row in rows if row["off_percent"] is not None]
    return f"{of(values):.2g}" if values else "?"


def _floor(rows: list[Row]) -> str:
    """The median, the one farthest from 1, and how many are unknown, where some are."""
    floors = [row["floor"] for row in rows if row["floor"] is not None]
    unknown = f", {len(rows) - len(floors)} unknown" if len(floors) < len(rows) else ""
    if not floors:
        return unknown.removeprefix(", ")
    return (
        f"{statistics.median(floors):.3g} {max(floors, key=lambda floor: abs(math.log(floor))):.3g}{unknown}"
    )


def main() -> None:
    from hidden import FAULTS

    parser = argparse.ArgumentParser(description="Examination on logs with the faults of real ones.")
    parser.add_argument(
        "--seeds", type=int, default=4, help="knobs that are learned: without, and with an effect"
    )
    parser.add_argument("--fits", type=int, default=20, help="knobs without an effect that are fitted")
    parser.add_argument("--first", type=int, default=0, help="the first seed")
    parser.add_argument("--only", choices=list(FAULTS), help="this fault alone, written nowhere")
    parser.add_argument("--jobs", type=int, default=2, help="processes")
    parser.add_argument("--cap", type=float, default=60.0, help="seconds after which a log has no answer")
    options = parser.parse_args()
    logs = [
        log
        for fault in ([options.only] if options.only else FAULTS)
        for log in asked(fault, options.seeds, options.fits, options.first, options.cap)
    ]
    rows = run(logs, options.jobs)
    text = [line.rstrip() for line in report(rows, " ".join([date(), COMMAND.format(**vars(options))]))]
    odd = list(failures(rows))
    print(*text, "", *odd, sep="\n")
    if not options.only:
        document = {"report": text, "at_length": odd, "result": rows}
        RESULTS.write_text(json.dumps(document, indent=0) + "\n", "utf-8")


def asked(fault: str, seeds: int, fits: int, first: int, cap_s: float = 60.0) -> list[Log]:
    """The logs of a fault: knobs that are learned without and with an effect, and those that are fitted."""
    learned = [
        Log(fault, seed, hides, True, cap_s)
        for seed in range(first, first + seeds)
        for hides in (False, True)
    ]
    return learned + [Log(fault, seed, False, False) for seed in range(first, first + fits)]


def date() -> str:
    return time.strftime("%Y-%m-%d", time.gmtime())


if __name__ == "__main__":
    if any(os.environ.get(name) != "1" for name in THREADS):
        os.environ.update(dict.fromkeys(THREADS, "1"))
        os.execv(sys.executable, [sys.executable, *sys.argv])  # they are read when the libraries are loaded
    main()
