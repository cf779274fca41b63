"""Do 95 % intervals of base parameters hold where something is hidden? `python benches/study_intervals.py`.

The search is left out: knobs are fitted with what is hidden in them or, where that is in no catalogue, with
the base model, which is what `learn` ends with there. A capture whose fit ends above the floor of what was
hidden is counted apart: another optimum is no matter of intervals. So are kinds that err along the base
(a skin that creeps is viscous too): no interval about another definition can hold.
"""

import argparse
import tempfile
from collections import defaultdict
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import hidden
import numpy as np
from examiner import WITH_A_CONSTANT, Case
from pooled import pooled

import knobcam as kc

AT_FLOOR = 1.03
# What is missing has a part that a base parameter is: added friction, viscosity or inertia.
ALONG = ("creep", "friction_step", "memory", "surge")


def cases(seeds: int, first: int) -> list[Case]:
    """So many knobs of each kind."""
    kinds = [("faultless", "knob")] + [("several", "effects")] * 3
    kinds += [("single", name) for name in hidden.NAMED | hidden.SERIES]
    kinds += [("strange", name) for name in hidden.STRANGE]
    return [Case(*kind, first + i * seeds + seed) for i, kind in enumerate(kinds) for seed in range(seeds)]


def examine(case: Case) -> dict[str, Any]:
    """Errors of the base parameters and their standard errors."""
    empty = {"case": str(case), "stratum": "not fitted", "kind": case.kind, "z": {}}
    try:
        knob = case.make()
        with tempfile.TemporaryDirectory() as folder:
            path = Path(folder) / "capture.npz"
            np.savez(path, **knob.capture)
            fit = kc.fit(kc.load(path), detents="yes" if knob.knob["detent.A"] else "no")
        for effect in knob.effects:
            fit = fit if effect in hidden.STRANGE else fit.add(effect)
    except (ValueError, kc.InputError):
        return empty
    strange = case.sitting == "strange"
    if not strange and fit.rmse > AT_FLOOR * knob.noise_floor:
        return empty
    along = " along the base" if case.topic in ALONG else ""
    return empty | {"stratum": case.sitting + along, "z": dict(_errors(fit, knob))}


def _errors(fit: kc.Fit, knob: hidden.Hidden) -> Iterator[tuple[str, float]]:
    """Error over standard error of each parameter whose truth is no convention."""
    for name, true in knob.knob.items():
        effect, estimate = name.split(".")[0], fit.params.get(name)
        if effect == "coulomb" and WITH_A_CONSTANT & set(knob.effects):
            continue
        if estimate is None or not estimate.determined:
            continue
        off = estimate.value - true
        yield (
            name,
            float(np.remainder(off + np.pi, 2.0 * np.pi) - np.pi if name == "detent.S" else off)
            / (estimate.se),
        )


def report(rows: list[dict[str, Any]]) -> Iterator[str]:
    """Coverage by stratum, by kind and by parameter."""
    for by in ("stratum", "kind", "parameter"):
        errors: dict[str, list[float]] = defaultdict(list)
        for row in rows:
            for name, z in row["z"].items():
                errors[name if by == "parameter" else row[by]].append(z)
        yield f"{by:30} | intervals | hold, % | root mean square of error / standard error, at most 9 each"
        for name, own in sorted(errors.items()):
            z = np.minimum(np.abs(own), 9.0)
            hold = 100.0 * np.mean(z < 1.96)
            yield f"{name:30} | {len(z):9} | {hold:7.1f} | {np.sqrt(np.mean(z**2)):.2f}"
        yield ""
    lost = sum(row["stratum"] == "not fitted" for row in rows)
    yield f"{lost} of {len(rows)} captures could not be made, or their fit ended above the floor"


def main() -> None:
    parser = argparse.ArgumentParser(description="Coverage of 95 % intervals where something is hidden.")
    parser.add_argument("--seeds", type=int, default=20, help="knobs per kind")
    parser.add_argument("--first", type=int, default=1000, help="the first seed")
    parser.add_argument("--jobs", type=int, default=1, help="processes")
    options = parser.parse_args()
    print(*report(pooled(examine, cases(options.seeds, options.first), options.jobs, "case")), sep="\n")


if __name__ == "__main__":
    main()
