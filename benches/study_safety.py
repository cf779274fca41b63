"""Whether limits hold: `python benches/study_safety.py [--sequences 100000] [--seed N]`, some minutes.

Random models, commands and stops at the emulated rig, each sample of its motor held against ARM's limits,
the speed limit, the watchdog and the energy that a model may give out; then every state that commands and
silences lead to, held against the tables of the wire protocol. Prints what came out and writes
`benches/results/safety.json`. `crates/knobrig/tests/sequences.rs` and `states.rs` are what is run; a short
part of them runs in the tests.
"""

import argparse
import json
import os
import re
import subprocess
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

ROOT = Path(__file__).resolve().parents[1]
RESULT = Path(__file__).with_name("results") / "safety.json"
SEED = 20261123


def tested(name: str, **variables: str) -> str:
    """What a test of the rig prints; one that fails says why and ends this."""
    words = ["cargo", "test", "--profile", "develop", "--locked", "--package", "knobrig", "--test", name]
    ended = subprocess.run(
        [*words, "--", "--nocapture"],
        cwd=ROOT,
        env=os.environ | variables,
        stdout=subprocess.PIPE,
        text=True,
        check=False,
    )
    print(ended.stdout, end="")
    if ended.returncode:
        raise SystemExit(f"study_safety: {name}: see above what was exceeded")
    return ended.stdout


def sequences(count: int, seed: int) -> dict[str, Any]:
    """Random sequences."""
    start = time.monotonic()
    said = tested("sequences", KNOBCAM_SEQUENCES=str(count), KNOBCAM_SEED=str(seed))
    [line] = [line for line in said.splitlines() if line.startswith("{")]
    return {**json.loads(line), "seconds": round(time.monotonic() - start, 1)}


def states() -> dict[str, int]:
    """Every state."""
    found = re.search(r"(\d+) states, (\d+) ways into them", tested("states"))
    assert found is not None
    return {"states": int(found[1]), "transitions": int(found[2]), "against_the_protocol": 0}


def report(result: dict[str, Any]) -> Iterator[str]:
    """What came out, in lines."""
    s, m = result["sequences"], result["state_machine"]
    yield (
        f"{s['sequences']} random sequences of models, commands and stops (seed {s['seed']}): "
        f"{s['limits_exceeded']} exceeded a limit"
    )
    yield (
        f"{s['samples']} samples looked at, {s['samples_with_torque']} with torque, in {s['renderings']} "
        f"runs; at most {s['most_torque_of_limit']:g} of the torque limit and {s['fastest_rad_s']:g} rad/s"
    )
    yield (
        f"{s['models_refused']} models refused, {s['models_forced']} forced, {s['tanks_emptied']} ended by "
        f"their tank; at most {s['most_energy_of_limit']:g} of the energy that one may give out (what its "
        "places hold, and 0.1 J)"
    )
    yield f"{s['watchdog_faults']} times silence was noticed in time, {s['other_faults']} other faults"
    yield (
        f"every state that commands and silences lead to: {m['states']}, {m['transitions']} ways into them, "
        f"{m['against_the_protocol']} against the tables of the protocol"
    )


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--sequences", type=int, default=100_000)
    parser.add_argument("--seed", type=int, default=SEED)
    args = parser.parse_args()
    result = {"sequences": sequences(args.sequences, args.seed), "state_machine": states()}
    lines = list(report(result))
    RESULT.write_text(json.dumps({"report": lines, **result}) + "\n")
    print(*lines, sep="\n")


if __name__ == "__main__":
    main()
