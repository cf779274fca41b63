"""Logs with the faults that real ones have: what is said, and what it costs. `python benches/study_logs.py`.

The independent simulator makes each knob once without and once with a hidden effect, `hidden.FAULTS` spoils its
log, and the program is given the file alone. Tables are printed and written to `benches/results/logs.json`.
"""

import argparse
import json
import os
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
        """The knob and its clean capture's truth, and the columns with the fault; the same knob for all faults."""
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
        "first": bool(foreign) and foreign[0] in accepted,
        "exact": verdict == "missing" and len(foreign) == 1 and foreign[0] in accepted,
        "accused": bool(set(foreign) - accepted) or not (accepted or barred or verdict in ("complete", "missing")),
        "off_percent": None if estimate is None else round(100.0 * (estimate["value"] / true - 1.0), 3),
        "holds": bool(interval and interval[0] <= true <= interval[1]),
        "floor": None if not floor else round(floor / knob.noise_floor, 4),
    }


def run(faults: list[str], seeds: int, first: int, jobs: int, cap_s: float) -> list[Row]:
    """Examine `seeds` knobs without and as many with a hidden effect, from seed `first` on, under each fault."""
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
    """Both tables, and below them every log that was not answered as it should be."""
    yield head
    yield "said: logs whose findings (or effects) name the fault; M off: of the inertia against the true one; holds:"
    yield "its 95 % interval does; complete: that verdict; accused: an effect is named that is not there, or none is"
    yield "and the rest called unexplained (right where the fault leaves no log of the knob: marked *); floor: the"
    yield "noise floor over the true one; not: logs where it stays unknown; besides: findings of what was not put there"
    for hides in (False, True):
        own = [row for row in rows if bool(row["hid"]) is hides]
        if own:
            yield ""
            yield from _table(own, hides)
    odd = [row for row in rows if not right(row)]
    yield ""
    yield f"not answered as it should be: {len(odd)} of {len(rows)}"
    for row in odd:
        hid = " + ".join(row["hid"]) or "nothing"
        yield (
            f"{row['fault']:40} {row['seed']:3} {row['motion']:9} hid {hid}: {row['verdict']}, "
            f"{' + '.join(row['found']) or '-'}, M {_number(row['off_percent'])} %, "
            f"{'said' if row['said'] in (True, None) else 'NOT SAID'}, {row['seconds']:.0f} s"
        )


def right(row: Row) -> bool:
    """Whether the fault is said and nothing false of the knob; with an effect hidden, whether that comes first."""
    good = row["said"] in (True, None) and not row["accused"] and not row["besides"]
    return good and (row["first"] or not row["hid"] or barred(row))


def barred(row: Row) -> bool:
    """Whether the log is no longer one of the knob."""
    from hidden import FAULTS

    return any(fault.bars for fault in FAULTS[row["fault"]])


def _table(rows: list[Row], hides: bool) -> Iterator[str]:
    name = "one effect hidden" if hides else "nothing hidden"
    ends = "first % | exact %" if hides else "complete % | accused %"
    yield f"{name:40} |  n | said % | M off, %: median, most | holds % | {ends} | floor: median, most, not | besides"
    for fault in dict.fromkeys(row["fault"] for row in rows):
        own = [row for row in rows if row["fault"] == fault]
        said = "       " if own[0]["said"] is None else f"{_percent([row['said'] for row in own]):6.0f} "
        off = sorted(abs(row["off_percent"]) for row in own if row["off_percent"] is not None)
        floors = sorted(row["floor"] for row in own if row["floor"] is not None)
        worst = max(floors, key=lambda floor: abs(floor - 1.0), default=float("nan"))
        if hides:
            ends = f"{_percent([row['first'] for row in own]):7.0f} | {_percent([row['exact'] for row in own]):7.0f}"
        else:
            complete = _percent([row["verdict"] == "complete" for row in own])
            ends = f"{complete:10.0f} | {_percent([row['accused'] for row in own]):9.0f}"
        besides = Counter(kind for row in own for kind in row["besides"])
        yield (
            f"{fault + ' *' * barred(own[0]):40} | {len(own):2} | {said}| {_middle(off):10.3g} {off[-1] if off else float('nan'):11.3g} "
            f"| {_percent([row['holds'] for row in own]):7.0f} | {ends} "
            f"| {_middle(floors):8.3f} {worst:8.3f} {len(own) - len(floors):6} "
            f"| {', '.join(f'{kind} {count}' for kind, count in besides.most_common(3))}"
        )


def _percent(marks: list[bool]) -> float:
    return 100.0 * sum(marks) / len(marks)


def _middle(ranked: list[float]) -> float:
    """The median of sorted values; NaN of none."""
    return (ranked[(len(ranked) - 1) // 2] + ranked[len(ranked) // 2]) / 2.0 if ranked else float("nan")


def _number(value: float | None) -> str:
    return "?" if value is None else f"{value:+.3g}"


def main() -> None:
    from hidden import FAULTS

    parser = argparse.ArgumentParser(description="Examination on logs with the faults of real ones.")
    parser.add_argument("--seeds", type=int, default=3, help="knobs without, and as many with a hidden effect")
    parser.add_argument("--first", type=int, default=0, help="the first seed")
    parser.add_argument("--only", choices=list(FAULTS), help="this fault alone, written nowhere")
    parser.add_argument("--jobs", type=int, default=2, help="processes")
    parser.add_argument("--cap", type=float, default=60.0, help="seconds after which a log has no answer")
    options = parser.parse_args()
    faults = [options.only] if options.only else list(FAULTS)
    rows = run(faults, options.seeds, options.first, options.jobs, options.cap)
    head = (
        f"{time.strftime('%Y-%m-%d', time.gmtime())}, python benches/study_logs.py --seeds {options.seeds} "
        f"--first {options.first} --cap {options.cap:g}: {sum(row['seconds'] for row in rows) / 60.0:.0f} min of one processor"
    )
    text = [line.rstrip() for line in report(rows, head)]
    print(*text, sep="\n")
    if not options.only:
        RESULTS.write_text(json.dumps({"report": text, "result": rows}, indent=0) + "\n", "utf-8")


if __name__ == "__main__":
    if any(os.environ.get(name) != "1" for name in THREADS):
        os.environ.update(dict.fromkeys(THREADS, "1"))
        os.execv(sys.executable, [sys.executable, *sys.argv])  # they are read when the libraries are loaded
    main()
