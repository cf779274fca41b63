"""Logs with the faults that real ones have: what is said, and what it costs. `python benches/study_logs.py`.

The independent simulator makes knobs without and with a hidden effect, `hidden.FAULTS` spoils their logs, and
the program is given the file alone: some are learned, and more of them, with nothing hidden, fitted. Tables
are printed and written to `benches/results/logs.json`.
"""

import argparse
import json
import os
import sys
import time
from pathlib import Path
from typing import Any

# One thread each: the logs are examined beside one another.
THREADS = ("OPENBLAS_NUM_THREADS", "RAYON_NUM_THREADS")
RESULTS = Path(__file__).with_name("results") / "logs.json"
COMMAND = (
    "python benches/study_logs.py --seeds {seeds} --fits {fits} --first {first} --apart {apart} --cap {cap:g}"
)


def run(logs: list[Any], jobs: int) -> list[dict[str, Any]]:
    """Examine the logs."""
    from logs import examine
    from pooled import pooled

    return pooled(examine, logs, jobs, "fault")


def main() -> None:
    from hidden import FAULTS
    from logs import asked
    from marks_logs import failures, report

    parser = argparse.ArgumentParser(description="Examination on logs with the faults of real ones.")
    parser.add_argument(
        "--seeds", type=int, default=3, help="knobs that are learned: without, and with an effect"
    )
    parser.add_argument("--fits", type=int, default=40, help="knobs without an effect that are fitted")
    parser.add_argument("--first", type=int, default=0, help="the first seed")
    parser.add_argument("--only", nargs="+", choices=list(FAULTS), help="these faults, written nowhere")
    parser.add_argument("--apart", type=int, default=0, help="seeds from one fault to the next: other knobs")
    parser.add_argument("--jobs", type=int, default=2, help="processes")
    parser.add_argument(
        "--cap", type=float, default=60.0, help="seconds of the processor after which a log has no answer"
    )
    options = parser.parse_args()
    logs = [
        log
        for at, fault in enumerate(options.only or FAULTS)
        for log in asked(fault, options.seeds, options.fits, options.first + options.apart * at, options.cap)
    ]
    rows = run(logs, options.jobs)
    head = f"{time.strftime('%Y-%m-%d', time.gmtime())}: {COMMAND.format(**vars(options))}"
    text = [head, *(line.rstrip() for line in report(rows))]
    odd = list(failures(rows))
    print(*text, "", *odd, sep="\n")
    if not options.only:
        learned = len(text) - text[::-1].index("")  # a long table, that has a page of its own
        document = {"report": text[: learned - 1], "at_length": [*text[learned:], "", *odd], "result": rows}
        RESULTS.write_text(json.dumps(document) + "\n", "utf-8")


if __name__ == "__main__":
    if any(os.environ.get(name) != "1" for name in THREADS):
        os.environ.update(dict.fromkeys(THREADS, "1"))
        os.execv(sys.executable, [sys.executable, *sys.argv])  # they are read when the libraries are loaded
    main()
