"""An examination in strata, of the program and of its peers: `python benches/study_strata.py`.

Effects alone from weak to strong, every pair of them, faultless knobs; what the core shares a formula with
is made by other physics. Answers are kept in `benches/results/strata.jsonl` by case, by who answered and by
which version, so that a run goes on where the last one stopped; tables go to `strata.json` beside it.
Of the peers `--who stlsq` needs pysindy (MIT; 500 MB with what it needs), which nothing else here does:
install it beside this for that sitting, which asks nothing of knobcam.
"""

import argparse
import json
import os
import sys
import time
from pathlib import Path
from typing import Any

# One thread each: the captures are examined beside one another.
THREADS = ("OPENBLAS_NUM_THREADS", "RAYON_NUM_THREADS")
HERE = Path(__file__).parent
KEPT = HERE / "results" / "strata.jsonl"
TABLES = KEPT.with_suffix(".json")
PROGRAM = HERE.parent / "python" / "knobcam"
# Who may sit, each with what its answers depend on.
WHO = {
    "knobcam": [HERE / "examiner.py", PROGRAM],
    **{peer: [HERE / "sitters.py", HERE / "terms.py"] for peer in ("stepwise", "stlsq", "bam")},
}
KNOBS = [HERE / "strata.py", HERE / "hidden"]


def about(who: str) -> dict[str, str]:
    """What tells these answers from those of others, and of other versions on other knobs."""
    from resumed import version

    return {"who": who, "version": version(*WHO[who]), "knobs": version(*KNOBS)}


def run(who: str, chosen: list[Any], jobs: int, cap_s: float) -> list[dict[str, Any]]:
    """Let one sit the examination."""
    from resumed import resumed

    if who == "knobcam":
        from examiner import SILENT
        from examiner import sit as examine
    else:
        from functools import partial

        from sitters import SILENT, sat

        examine = partial(sat, who)
    # Compiled once, here, and not in each process that starts from this one.
    for case in ("one/bristles:0", "one/rate_and_state:1", "one/impact_gap:2", "one/compliance:2"):
        type(chosen[0]).parse(case).make()
    return resumed(examine, chosen, KEPT, about(who), jobs, cap_s, SILENT)


def tabled(names: list[str]) -> dict[str, list[dict[str, Any]]]:
    """The rows of those who sat, of the knobs and versions as they stand."""
    from resumed import kept

    return {who: kept(KEPT, about(who)) for who in names}


def main() -> None:
    from marks_strata import at_length, report
    from strata import strata

    parser = argparse.ArgumentParser(description="Examination in strata.")
    parser.add_argument("--seeds", type=int, default=20, help="knobs per effect, per pair, per noise")
    parser.add_argument("--first", type=int, default=0, help="the first seed")
    parser.add_argument(
        "--only", default="", metavar="KIND", help="cases whose name begins so: one, pair/backl"
    )
    parser.add_argument("--jobs", type=int, default=2, help="processes")
    parser.add_argument("--cap", type=float, default=120.0, help="seconds of the processor for a capture")
    parser.add_argument(
        "--who", choices=list(WHO), default="knobcam", help="who sits; peers need their packages"
    )
    parser.add_argument("--table", action="store_true", help="no examination: tables of what is kept")
    options = parser.parse_args()
    if not options.table:
        chosen = [case for case in strata(options.seeds, options.first) if str(case).startswith(options.only)]
        if not chosen:
            raise SystemExit(f"--only {options.only}: no case begins so")
        run(options.who, chosen, options.jobs, options.cap)
    rows = tabled(list(WHO))
    today = time.strftime("%Y-%m-%d", time.gmtime())
    version = about("knobcam")["version"]
    head = f"{today}: python benches/study_strata.py, program {version}; n: as many as were held"
    text, long = [head, *report(rows)], list(at_length(rows))
    print(*text, *long, sep="\n")
    TABLES.write_text(json.dumps({"report": text, "at_length": long}, indent=0) + "\n", "utf-8")


if __name__ == "__main__":
    if any(os.environ.get(name) != "1" for name in THREADS):
        os.environ.update(dict.fromkeys(THREADS, "1"))
        os.execv(sys.executable, [sys.executable, *sys.argv])  # they are read when the libraries are loaded
    main()
