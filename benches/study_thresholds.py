"""What each threshold does to an examination, halved and doubled: `python benches/study_thresholds.py`.

Of every threshold of the table (`knobcam.fit.rule.thresholds`) a process of its own is started with
`KNOBCAM_RULE=name=value`, and examined on the same few captures as one with the rule as it is. What each
answered is kept in `benches/results/thresholds.jsonl`, so that a run goes on where the last one stopped;
`thresholds.json` beside it has, of each threshold and factor, which answers changed. `docs/thresholds.md` is
made of that and of the table: `--page` writes it.
"""

import argparse
import json
import os
import pickle
import re
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

HERE = Path(__file__).parent
KEPT = HERE / "results" / "thresholds.jsonl"
TABLE = KEPT.with_suffix(".json")
PAGE = HERE.parent / "docs" / "thresholds.md"
PROGRAM = HERE.parent / "python" / "knobcam"
FACTORS = (0.5, 2.0)
# Nothing missing under both noises, two effects at once, weak effects (seeds 0, 5, ...), and such as stand
# out of the noise clearly; without couplings, whose searches take a hundred times as long.
CASES = (
    *("none/white:0", "none/white:1", "none/ar1:2", "pair/quadratic_drag+unbalance:2"),
    *("one/quadratic_drag:0", "one/return_spring:5", "one/torque_drift:10", "one/second_detent:15"),
    *("one/stribeck:1", "one/unbalance:2", "one/position_friction:1", "one/torque_lag:2"),
)
HEAD = """# Thresholds

Every number that decides what is said to be missing, in one table: `crates/knobcore/src/rule.rs`. The core
decides by it, and Python has it by `knobcam.fit.rule.thresholds()`. Constants of methods (steps, windows, how
many starts are looked at) stand where they are used; what values an effect may have, in the effect's file;
what makes a log doubtful, with the checks of captures.

A source that begins with "judgement" is no measurement: somebody thought it right, and the examination was
passed with it. The last column is measured by `benches/study_thresholds.py`: the threshold halved and
doubled, all others as they are, and {cases} captures of the second simulator judged again: nothing missing,
weak and plain effects, two at once. It says how many answers (verdict and names) changed, and how many of all
were right then; as the rule is, {right} are. So few captures show what a threshold does to ordinary answers,
not how rare errors become rarer, and none of them has a coupling. "-" is not measured yet.

For such a study, and for nothing else, `KNOBCAM_RULE=price=24,worth=0.03` in the environment changes
thresholds of a process, when the library is loaded.
"""


_EDGE = (
    "judgement: a spike or two; a stretch that is wrong, or a peak that the motion makes, has more samples"
)


def asked(changes: str, knobs: Path) -> dict[str, Any]:
    """What a program with a changed rule answers of every capture."""
    with tempfile.TemporaryDirectory() as folder:
        told = Path(folder) / "told.json"
        command = [sys.executable, str(Path(__file__)), "--answer", str(knobs), str(told)]
        subprocess.run(command, env=os.environ | {"KNOBCAM_RULE": changes}, check=True)
        answers: dict[str, Any] = json.loads(told.read_text("utf-8"))
    return answers


def answer(knobs: Path, told: Path) -> None:
    """Answer in this process, by its rule."""
    from examiner import marked

    answers = {}
    for case, knob in pickle.loads(knobs.read_bytes()).items():
        marks = marked(knob)
        answers[case] = {name: marks[name] for name in ("verdict", "found", "exact", "wrong", "seconds")}
    told.write_text(json.dumps(answers), "utf-8")


def changes() -> Iterator[tuple[str, float, str]]:
    """Every threshold with a factor, and how the changed rule is written; the rule as it is first."""
    from knobcam.fit.rule import thresholds

    yield "", 1.0, ""
    for one in thresholds():
        for factor in FACTORS:
            yield one.name, factor, f"{one.name}={one.value * factor!r}"


def run(only: list[str], minutes: float) -> None:
    """Ask what was not asked yet, as long as there is time."""
    from resumed import kept
    from strata import Stratum

    end = time.monotonic() + 60.0 * minutes
    known = {(row["threshold"], row["factor"]) for row in kept(KEPT, about())}
    knobs = {case: Stratum.parse(case).make() for case in CASES}
    with tempfile.TemporaryDirectory() as folder, KEPT.open("a", encoding="utf-8") as file:
        path = Path(folder) / "knobs"
        path.write_bytes(pickle.dumps(knobs))
        for name, factor, written in changes():
            if (name, factor) in known or (name and only and name not in only):
                continue
            if time.monotonic() > end:
                break
            row = about() | {"threshold": name, "factor": factor, "answers": asked(written, path)}
            file.write(json.dumps(row) + "\n")
            file.flush()
            print(written or "as it is", file=sys.stderr, flush=True)


def about() -> dict[str, str]:
    """What the answers depend on beside the rule."""
    from resumed import version

    knobs = version(HERE / "strata.py", HERE / "hidden", HERE / "examiner.py")
    return {"version": version(PROGRAM), "knobs": knobs, "captures": " ".join(CASES)}


def tabled() -> dict[str, Any]:
    """Of each threshold and factor which answers changed, and how many were right."""
    from resumed import kept

    rows = {(row["threshold"], row["factor"]): row["answers"] for row in kept(KEPT, about())}
    usual = rows[("", 1.0)]
    table: dict[str, Any] = {
        **about(),
        "cases": len(usual),
        "right": sum(one["exact"] for one in usual.values()),
        "usual": {case: [one["verdict"], *one["found"]] for case, one in usual.items()},
        "thresholds": {},
    }
    for (name, factor), answers in rows.items():
        if not name:
            continue
        changed = {
            case: [one["verdict"], *one["found"]]
            for case, one in answers.items()
            if (one["verdict"], one["found"]) != (usual[case]["verdict"], usual[case]["found"])
        }
        right = sum(one["exact"] for one in answers.values())
        wrong = sum(one["wrong"] for one in answers.values())
        entry = {"changed": changed, "right": right, "wrong": wrong}
        table["thresholds"].setdefault(name, {})[str(factor)] = entry
    return table


def page(table: dict[str, Any]) -> str:
    """The page of the documentation: the table of thresholds, each with what was measured of it."""
    from knobcam.fit.rule import thresholds

    head = HEAD.format(cases=table["cases"], right=table["right"])
    lines = [head]
    title = {
        "verdict": "What is missing, and whether anything is",
        "words": "What is said beside it",
        "noise": "The noise that all is held against",
        "search": "Where the search goes",
    }
    for decides, words in title.items():
        lines += [
            f"## {words}",
            "",
            "| name | value | meaning | source | halved; doubled |",
            "|---|---|---|---|---|",
        ]
        for one in thresholds():
            if one.decides == decides:
                measured = table["thresholds"].get(one.name, {})
                said = "; ".join(_measured(measured.get(str(factor))) for factor in FACTORS)
                value = f"{one.value:g} {one.unit}"
                lines.append(f"| `{one.name}` | {value} | {one.meaning} | {one.source} | {said} |")
        lines.append("")
    return "\n".join([*lines, *pictures()])


def pictures() -> list[str]:
    """What decides which samples the axes of the page's plots are made for, of the file that says it."""
    told = (HERE.parent / "web" / "src" / "outliers.js").read_text("utf-8")
    value = {name: float(number) for name, number in re.findall(r"^const (\w+) = ([\d.]+);", told, re.M)}
    rows = [
        (
            "TIMES",
            "times the others",
            "How much farther than all others samples reach that no axis is made for.",
        ),
        ("SHARE", "share of the samples", "How many those may be at most, at either end of a torque's axis."),
        ("FEW", "samples", "The same of a capture in which that would be fewer."),
    ]
    return [
        "## What the workbench draws at the edge of a plot",
        "",
        "It decides nothing but what is seen: such samples stand at the edge, counted beside the axis.",
        "",
        "| name | value | meaning | source |",
        "|---|---|---|---|",
        *(f"| `{name}` | {value[name]:g} {unit} | {meaning} | {_EDGE} |" for name, unit, meaning in rows),
        "",
    ]


def _measured(entry: dict[str, Any] | None) -> str:
    if entry is None:
        return "-"
    changed = len(entry["changed"])
    wrong = f", {entry['wrong']} wrong names" if entry["wrong"] else ""
    return f"{changed} changed, {entry['right']} right{wrong}" if changed else "none changed"


def main() -> None:
    parser = argparse.ArgumentParser(description="Thresholds halved and doubled.")
    parser.add_argument("--only", nargs="+", default=[], metavar="NAME", help="thresholds to be studied")
    parser.add_argument("--minutes", type=float, default=600.0, help="time after which no more are asked")
    parser.add_argument("--page", action="store_true", help="no study: the page of what is kept")
    parser.add_argument("--answer", nargs=2, type=Path, metavar=("KNOBS", "TOLD"), help=argparse.SUPPRESS)
    options = parser.parse_args()
    if options.answer:
        answer(*options.answer)
        return
    if not options.page:
        run(options.only, options.minutes)
        TABLE.write_text(json.dumps(tabled(), indent=1) + "\n", "utf-8")
    PAGE.write_text(page(json.loads(TABLE.read_text("utf-8"))), "utf-8")


if __name__ == "__main__":
    main()
