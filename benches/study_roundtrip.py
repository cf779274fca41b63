"""Round trip by the command alone: emulate, capture, learn, render on the device, capture again, learn again.

    python benches/study_roundtrip.py [--knobs 1 2 3 4 5] [--effects stribeck ...] [--speed 10]

Every knob of the paper with every effect hidden in it. A parameter has come back if the last value is within
5 % of the one before, or the 95 % interval holds it: of the learned model that the device rendered, and of
the emulated knob itself. What no capture determines (a fit says so) is not compared. Writes
benches/results/roundtrip.json.
"""

from __future__ import annotations

import argparse
import json
import math
import subprocess
import sys
import tempfile
import time
from pathlib import Path
from typing import Any

from knobcam.rig.emulator import EmulatedRig, Emulation

EFFECTS = ("stribeck", "presliding", "quadratic_drag", "return_spring", "position_friction")
RESULTS = Path(__file__).parent / "results" / "roundtrip.json"
_CLOSE = 0.05


def knobcam(*words: object) -> dict[str, Any]:
    """Run a command of its own process and return its document."""
    ended = subprocess.run(
        [sys.executable, "-m", "knobcam", *map(str, words), "--json"],
        capture_output=True,
        text=True,
        check=False,
    )
    if ended.returncode:
        sys.exit(f"knobcam {' '.join(map(str, words))}: {ended.stderr}")
    document: dict[str, Any] = json.loads(ended.stdout)
    return document


def back(name: str, was: float, now: dict[str, Any]) -> bool:
    """Whether a parameter has come back; phases and signs of a sinusoid are the same a turn further."""
    if now["ci95"] is None:
        return True
    value, (low, high) = now["value"], now["ci95"]
    turns = (0.0, math.tau, -math.tau) if name.split(".")[1].startswith("S") else (0.0,)
    return any(abs(value - was - turn) <= _CLOSE * abs(was) or low <= was + turn <= high for turn in turns)


def positive(values: dict[str, float]) -> dict[str, float]:
    """The detents as a fit writes them: -A sin(x + S) is A sin(x + S + pi)."""
    values = dict(values)
    if values.get("detent.A", 0.0) < 0.0:
        values["detent.A"] *= -1.0
        values["detent.S"] += math.pi if values["detent.S"] <= 0.0 else -math.pi
    return values


def trip(knob: str, effect: str, speed: float, folder: Path) -> dict[str, Any]:
    """Go round once and say what has not come back."""
    start = time.monotonic()
    model = Emulation(knob, (effect,)).model()
    if effect == "return_spring":
        # No capture tells a rest angle elsewhere from a difference of the Coulomb levels.
        model = model.with_value("return_spring.theta0", 0.0)
    with EmulatedRig(model, seed=11, speed=speed) as rig:
        knobcam("capture", "--port", rig.port, "-o", folder / "knob.npz")
        learned = knobcam("learn", folder / "knob.npz", "-o", folder / "learned.toml")
        felt = ("-o", folder / "felt.npz", "--force")  # two of the paper's knobs feed the hand at some speed
        knobcam("capture", "--port", rig.port, "--model", folder / "learned.toml", *felt)
        again = knobcam("learn", folder / "felt.npz")
    before, after = learned["ladder"][-1]["params"], again["ladder"][-1]["params"]
    true = positive({name: p.value for name, p in model.params.items()})
    return {
        "knob": knob,
        "effect": effect,
        "found": learned["found"],
        "found_again": again["found"],
        "seconds": time.monotonic() - start,
        "parameters": len(after),
        "not_as_rendered": [n for n in after if n not in before or not back(n, before[n]["value"], after[n])],
        "not_as_emulated": [n for n in after if n not in true or not back(n, true[n], after[n])],
    }


def report(rows: list[dict[str, Any]]) -> list[str]:
    """The trips as a table, and how many came back."""

    def names(row: dict[str, Any], key: str) -> str:
        missing = row[key]
        return ", ".join(missing) if len(missing) < 4 else f"{len(missing)} of {row['parameters']}"

    lines = [
        f"{row['knob']} {row['effect']:<18} {row['seconds']:5.1f} s  "
        f"learned {', '.join(row['found']) or '-'}; again {', '.join(row['found_again']) or '-'}; "
        f"not as emulated: {names(row, 'not_as_emulated') or 'none'}; "
        f"not as rendered: {names(row, 'not_as_rendered') or 'none'}"
        for row in rows
    ]
    for kind in ("emulated", "rendered"):
        whole = sum(not row[f"not_as_{kind}"] for row in rows)
        count = sum(len(row[f"not_as_{kind}"]) for row in rows)
        of = sum(row["parameters"] for row in rows)
        lines.append(
            f"as {kind}: all parameters back in {whole} of {len(rows)} trips; {of - count} of {of} parameters"
        )
    slowest = max(row["seconds"] for row in rows)
    return [
        *lines,
        f"slowest trip {slowest:.0f} s; all by knobcam emulate, capture, learn, capture --model, learn",
    ]


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    parser.add_argument("--knobs", nargs="+", default=["1", "2", "3", "4", "5"])
    parser.add_argument("--effects", nargs="+", default=EFFECTS)
    parser.add_argument("--speed", type=float, default=10.0, help="times real time of the emulated rig")
    args = parser.parse_args()
    # Trips of other knobs and effects, if any were made before, are kept.
    known = json.loads(RESULTS.read_text())["trips"] if RESULTS.is_file() else []
    asked = {(f"knob{knob}", effect) for knob in args.knobs for effect in args.effects}
    rows = [row for row in known if (row["knob"], row["effect"]) not in asked]
    for knob in args.knobs:
        for effect in args.effects:
            with tempfile.TemporaryDirectory() as folder:
                rows.append(trip(f"knob{knob}", effect, args.speed, Path(folder)))
            print(json.dumps(rows[-1]), flush=True)
    rows.sort(key=lambda row: row["knob"])
    RESULTS.write_text(json.dumps({"report": report(rows), "trips": rows}, indent=1) + "\n")


if __name__ == "__main__":
    main()
