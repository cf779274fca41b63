"""Knobs with something hidden in them: does the program find it? `python benches/study_hidden.py`.

The program is given each capture's file alone. Tables are printed and written to
`benches/results/hidden.json`, with every capture that was not answered as it should be.
"""

import argparse
import json
import os
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any

# One thread each: the captures are examined beside one another.
THREADS = ("OPENBLAS_NUM_THREADS", "RAYON_NUM_THREADS")
HERE = Path(__file__).resolve().parent
PROGRAM = HERE.parent / "python" / "knobcam"
RESULTS = HERE / "results"
KEPT = RESULTS / "hidden.jsonl"  # a run of an hour that was killed goes on where it stopped
CAP_S = 600.0  # of the processor, for a capture


def run(seeds: int, first: int, jobs: int, only: str = "") -> list[dict[str, Any]]:
    """Examine `seeds` knobs per effect, from seed `first` on; `only` a sitting, or a sitting/effect."""
    from examiner import SILENT, cases, sit
    from resumed import resumed, version

    chosen = [case for case in cases(seeds, first) if only in ("", case.sitting, case.kind)]
    if not chosen:
        raise SystemExit(f"--only {only}: no such sitting; there are {', '.join(sittings())}")
    about = {"program": version(PROGRAM), "knobs": version(HERE / "examiner.py", HERE / "hidden")}
    # Compiled once, here, and not in each process that starts from this one.
    for first_of_kind in {case.kind: case for case in chosen}.values():
        first_of_kind.make()
    return resumed(sit, chosen, KEPT, about, jobs, CAP_S, SILENT | {"seconds": CAP_S})


def sittings() -> list[str]:
    """What `only` takes."""
    from examiner import cases

    return list(dict.fromkeys(case.kind for case in cases(1, 0)))


def one(name: str) -> Iterator[str]:
    """Examine one case and show the ladder of its answer beside the truth."""
    from examiner import Case, ask

    case = Case.parse(name)
    knob = case.make()
    yield f"{case}: {knob.motion}, hidden {list(knob.effects)}, strength {knob.strength:.2f}"
    yield f"strengths {[round(strength, 2) for strength in knob.strengths]}, truth {knob.truth}"
    yield f"knob {knob.knob}"
    document = ask(knob, case.without)
    floor = document["noise_floor"] / knob.noise_floor
    yield f"{document['verdict']}: found {document['found']}, unexplained {document['unexplained']}"
    yield f"noise floor {knob.noise_floor:.4g}, reported / true {floor:.3f}; errors over the true one"
    for step in document["ladder"]:
        moved = {key: step[key] for key in ("p_value", "equivalent") if key in step}
        seen, unseen = step["rmse"] / knob.noise_floor, step["rmse_heldout"] / knob.noise_floor
        yield f"  {step['added'] or 'base':20} {seen:8.4f} ({unseen:.4f} unseen) {moved}"
        for parameter, estimate in step["params"].items():
            true = knob.knob.get(parameter)
            beside = "" if true is None else f"  true {true:.5g}"
            yield f"    {parameter:28} {estimate['value']:12.5g} {estimate['ci95']}{beside}"


def main() -> None:
    parser = argparse.ArgumentParser(description="Examination on knobs with something hidden.")
    parser.add_argument("--seeds", type=int, default=20, help="knobs per effect")
    parser.add_argument("--first", type=int, default=0, help="the first seed")
    parser.add_argument("--only", default="", metavar="SITTING[/EFFECT]", help="these alone, written nowhere")
    parser.add_argument("--jobs", type=int, default=2, help="processes")
    parser.add_argument("--one", metavar="CASE", help="one capture, as 'single/stribeck:7', with its ladder")
    options = parser.parse_args()
    if options.one:
        print(*one(options.one), sep="\n")
        return
    from marks import report

    rows = run(options.seeds, options.first, options.jobs, options.only)
    text = list(report(rows))
    print(*text, sep="\n")
    if not options.only:
        RESULTS.mkdir(exist_ok=True)
        document = json.dumps({"report": text, "result": rows}, indent=0)
        (RESULTS / "hidden.json").write_text(document + "\n", "utf-8")


if __name__ == "__main__":
    if any(os.environ.get(name) != "1" for name in THREADS):
        os.environ.update(dict.fromkeys(THREADS, "1"))
        os.execv(sys.executable, [sys.executable, *sys.argv])  # they are read when the libraries are loaded
    main()
