"""Logs with the faults that real ones have: what is said, and what it costs. `python benches/study_logs.py`.

The independent simulator makes knobs without and with a hidden effect, `hidden.FAULTS` spoils their logs, and
the program is given the file alone. Tables are printed and written to `benches/results/logs.json`.
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
from collections.abc import Iterator
from multiprocessing import Pool
from pathlib import Path
from typing import Any, NamedTuple

# One thread each: the logs are examined beside one another.
THREADS = ("OPENBLAS_NUM_THREADS", "RAYON_NUM_THREADS")
RESULTS = Path(__file__).with_name("results") / "logs.json"
# Strengths of the hidden effects, RMS over white noise: findable under coloured noise as well, whose floor is
# three times as high.
WEAKEST, STRONGEST = 3.0, 12.0

WIDTH = 37  # of a fault's name
SAID = (
    "said: the fault is named by a finding, or as an effect; M off: the inertia from the true one; holds:",
    "its 95 % interval does; accused: an effect is named that is not there, or none and the rest is",
    "unexplained (which is right of logs marked *: no model of them is one of the knob); floor: the noise",
    "floor over the true one, and in how many logs it stays unknown; besides: findings of what is not there",
)

Row = dict[str, Any]


class Log(NamedTuple):
    """A log to be examined: a fault, on knob `seed` with a hidden effect or without."""

    fault: str
    hides: bool
    seed: int
    cap_s: float

    @property
    def effects(self) -> list[str]:
        """What is hidden: another effect with each seed."""
        from hidden import NAMED

        return [list(NAMED)[self.seed % len(NAMED)]] if self.hides else []

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
    """What `knobcam learn` says of one log, beside the truth."""
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
            document = kc.learn(capture, progress=watch).document()
        except Exception as error:  # a program that fails has not answered, and the others go on
            findings = [finding.document() for finding in capture.findings]
            document = {
                "verdict": f"{type(error).__name__}: {error}",
                "found": [],
                "ladder": [],
                "findings": findings,
                "noise_floor": None,
            }
    about = {"fault": log.fault, "seed": log.seed, "motion": knob.motion, "hid": list(knob.effects)}
    return about | {"seconds": round(time.monotonic() - start, 1)} | judged(log.fault, knob, document)


def judged(name: str, knob: Any, document: dict[str, Any]) -> Row:
    """How the document of a log compares with the fault `name` that it has and with the knob."""
    from hidden import FAULTS

    faults = FAULTS[name]
    found, verdict = document["found"], document["verdict"]
    kinds = [(finding["kind"], f"{finding['kind']} {finding['column']}") for finding in document["findings"]]
    own = frozenset().union(*(fault.effects for fault in faults))
    wanted = frozenset().union(*(fault.said for fault in faults))
    told = [
        any(fault.said & set(kind) for kind in kinds) or bool(fault.effects & set(found))
        for fault in faults
        if fault.said | fault.effects
    ]
    foreign = [effect for effect in found if effect not in own]
    accepted = set().union(*knob.accepted)
    barred = any(fault.bars for fault in faults)
    floor = document["noise_floor"]
    estimate = (document["ladder"][-1]["params"] if document["ladder"] else {}).get("inertia.M")
    true = knob.knob["inertia.M"]
    interval = estimate and estimate["ci95"]
    return {
        "said": all(told) if told else None,
        "besides": sorted({kind[1] for kind in kinds if not wanted & set(kind)}),
        "verdict": verdict,
        "found": found,
        "complete": verdict == "complete",
        "first": bool(foreign) and foreign[0] in accepted,
        "exact": verdict == "missing" and len(foreign) == 1 and foreign[0] in accepted,
        "accused": bool(set(foreign) - accepted)
        or not (accepted or barred or verdict in ("complete", "missing")),
        "off_percent": None if estimate is None else round(100.0 * (estimate["value"] / true - 1.0), 3),
        "holds": bool(interval and interval[0] <= true <= interval[1]),
        "floor": None if not floor else round(floor / knob.noise_floor, 4),
    }


def run(faults: list[str], seeds: int, first: int, jobs: int, cap_s: float) -> list[Row]:
    """Examine `seeds` knobs without and as many with a hidden effect under each fault, from seed `first`."""
    # By seed: what is there when time is over is whole tables of fewer knobs.
    logs = [
        Log(fault, hides, seed, cap_s)
        for seed in range(first, first + seeds)
        for fault in faults
        for hides in (False, True)
    ]
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
    for hides in (False, True):
        own = [row for row in rows if bool(row["hid"]) is hides]
        if own:
            yield ""
            yield from _table(own, hides)


def failures(rows: list[Row]) -> Iterator[str]:
    """Every log that was not answered as it should be."""
    odd = [row for row in rows if not right(row)]
    yield f"not answered as it should be: {len(odd)} of {len(rows)}"
    for row in odd:
        hid = " + ".join(row["hid"]) or "nothing"
        besides = f", besides {', '.join(row['besides'])}" if row["besides"] else ""
        off = "?" if row["off_percent"] is None else f"{row['off_percent']:+.3g}"
        yield (
            f"{row['fault']:{WIDTH}} {row['seed']:3} {row['motion']:9} hid {hid}: {row['verdict']}, "
            f"{' + '.join(row['found']) or '-'}, M {off} %, "
            f"{'fault not said' if row['said'] is False else 'said'}{besides}, {row['seconds']:.0f} s"
        )


def right(row: Row) -> bool:
    """Whether the fault is said and nothing false; where an effect is hidden, whether it comes first."""
    good = row["said"] is not False and not row["accused"] and not row["besides"]
    return good and (row["verdict"] != "complete" if barred(row) else row["first"] or not row["hid"])


def barred(row: Row) -> bool:
    """Whether the log is no longer one of the knob."""
    from hidden import FAULTS

    return any(fault.bars for fault in FAULTS[row["fault"]])


def _table(rows: list[Row], hides: bool) -> Iterator[str]:
    name = "one effect hidden" if hides else "nothing hidden"
    ends = {"first": "first %", "exact": "exact %"} if hides else {"complete": "complete %"}
    ends |= {"accused": "accused %"}
    columns = [
        "said %",
        "M off, %: median, most",
        "holds %",
        *ends.values(),
        "floor: median, most, not",
        "besides",
    ]
    yield f"{name:{WIDTH}} |  n | {' | '.join(columns)}"
    for fault in dict.fromkeys(row["fault"] for row in rows):
        own = [row for row in rows if row["fault"] == fault]
        off = [abs(row["off_percent"]) for row in own if row["off_percent"] is not None]
        floors = [row["floor"] for row in own if row["floor"] is not None]
        worst = max(floors, key=lambda floor: abs(math.log(floor)), default=math.nan)
        besides = Counter(kind for row in own for kind in row["besides"])
        cells = [
            "" if own[0]["said"] is None else _percent(own, "said"),
            f"{_median(off):14.3g} {max(off, default=math.nan):7.3g}",
            _percent(own, "holds"),
            *(_percent(own, end) for end in ends),
            f"{_median(floors):13.3f} {worst:6.3f} {len(own) - len(floors):3}",
            ", ".join(f"{kind} {count}" for kind, count in besides.most_common(3)),
        ]
        cells = [f"{cell:>{len(column)}}" for cell, column in zip(cells[:-1], columns, strict=False)] + cells[
            -1:
        ]
        yield f"{fault + ' *' * barred(own[0]):{WIDTH}} | {len(own):2} | {' | '.join(cells)}"


def _percent(rows: list[Row], mark: str) -> str:
    return f"{100.0 * sum(row[mark] for row in rows) / len(rows):.0f}"


def _median(values: list[float]) -> float:
    return statistics.median(values) if values else math.nan


def main() -> None:
    from hidden import FAULTS

    parser = argparse.ArgumentParser(description="Examination on logs with the faults of real ones.")
    parser.add_argument(
        "--seeds", type=int, default=3, help="knobs without, and as many with a hidden effect"
    )
    parser.add_argument("--first", type=int, default=0, help="the first seed")
    parser.add_argument("--only", choices=list(FAULTS), help="this fault alone, written nowhere")
    parser.add_argument("--jobs", type=int, default=2, help="processes")
    parser.add_argument("--cap", type=float, default=60.0, help="seconds after which a log has no answer")
    options = parser.parse_args()
    faults = [options.only] if options.only else list(FAULTS)
    rows = run(faults, options.seeds, options.first, options.jobs, options.cap)
    took = sum(row["seconds"] for row in rows)
    head = (
        f"{time.strftime('%Y-%m-%d', time.gmtime())}, python benches/study_logs.py --seeds {options.seeds} "
        f"--first {options.first} --cap {options.cap:g}: {len(rows)} logs, {took / 60.0:.0f} min"
    )
    text = [line.rstrip() for line in report(rows, head)]
    odd = list(failures(rows))
    print(*text, "", *odd, sep="\n")
    if not options.only:
        document = {"report": text, "at_length": odd, "result": rows}
        RESULTS.write_text(json.dumps(document, indent=0) + "\n", "utf-8")


if __name__ == "__main__":
    if any(os.environ.get(name) != "1" for name in THREADS):
        os.environ.update(dict.fromkeys(THREADS, "1"))
        os.execv(sys.executable, [sys.executable, *sys.argv])  # they are read when the libraries are loaded
    main()
