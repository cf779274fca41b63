"""Random knobs on a rig with the paper's sensors: is the fit down at the noise, and do its intervals hold?

Every knob is the base model and nothing else, so what a fit leaves beyond the torque sensor's noise, and
every interval that misses the truth, is the program's own doing.
"""

from collections.abc import Iterator
from typing import Any

import numpy as np
from knobs import model_of, phase_error, rig_like

import knobcam as kc
from knobcam import _core

# The sensors of the paper's rig (Tables 1 and 4), with the velocity at its resolution after decoding.
SENSORS = kc.SensorNoise(omega_sd=5e-3, alpha_sd=0.41, tau_sd=1.8e-3, theta_step=9.8e-6, tau_step=1.8e-4)
# How far above the noise an error may end, by motion.
AT_FLOOR = {"multisine": 1.02, "turns": 1.02, "hand": 1.03, "sweep": 1.02}
MOTIONS = tuple(AT_FLOOR)
SOS = _core.cheby2_sos(3, 20.0, 500.0, 5000.0)


def _track(name: str, rng: np.random.Generator) -> kc.MotionTrack:
    options: dict[str, float] = {}
    if name in ("multisine", "hand"):
        options = {"seed": int(rng.integers(1 << 30))}
    if name == "turns":
        options = {"speed": rng.uniform(3.0, 8.0)}
    return kc.motion(name, **options)


def one(name: str, seed: int) -> dict[str, Any]:
    """Fit one random knob and hold the result against the truth; every second knob has detents."""
    rng = np.random.default_rng([MOTIONS.index(name), seed])
    detents = seed % 2 == 0
    truth = rig_like(rng, detents)
    model, track = model_of(truth), _track(name, rng)
    capture = kc.simulate(model, track, noise=SENSORS, seed=seed)
    clean = kc.simulate(model, track, noise="none")
    fit = kc.fit(capture)
    used = fit.signals.used
    noise = _core.zero_phase((capture.tau - clean.tau)[None, :], SOS)[0]
    floor = float(np.sqrt(np.mean(noise[used] ** 2)))
    z = {}
    for parameter, estimate in fit.params.items():
        error = estimate.value - truth[parameter]
        if parameter == "detent.S":
            error = phase_error(estimate.value, truth[parameter])
        if detents or not parameter.startswith("detent"):
            z[parameter] = round(error / estimate.se, 3)
    return {
        "motion": name,
        "seed": seed,
        "detents": detents,
        "found": "detent" in fit.model.effects,
        "error": round(fit.rmse / floor, 4),
        "floor": round(fit.noise_floor / floor, 4),
        "z": z,
    }


def detents_of_a_spring(name: str, seed: int) -> dict[str, Any]:
    """Fit a knob with a return spring and no detents: a stretch of a long sine would fit it too."""
    rng = np.random.default_rng([len(MOTIONS) + MOTIONS.index(name), seed])
    stiffness = float(np.exp(rng.uniform(np.log(2e-4), np.log(2e-2))))
    model = model_of(rig_like(rng, False)).with_effect("return_spring")
    model = model.with_value("return_spring.k", stiffness)
    fit = kc.fit(kc.simulate(model, _track(name, rng), noise=SENSORS, seed=seed))
    found = "detent" in fit.model.effects
    phase = float(np.ptp(fit.signals.theta)) / fit.params["detent.P"].value if found else None
    return {"motion": name, "seed": seed, "found": found, "phase": phase}


def run(knobs: int, springs: int) -> dict[str, list[dict[str, Any]]]:
    """Fit `knobs` knobs of the base model and `springs` with a spring under each motion."""
    return {
        "base": [one(name, seed) for name in MOTIONS for seed in range(knobs)],
        "spring": [detents_of_a_spring(name, seed) for name in MOTIONS for seed in range(springs)],
    }


def _quantiles(values: list[float]) -> str:
    low, middle, high = np.quantile(values, [0.0, 0.5, 1.0])
    return f"{low:.3f} {middle:.3f} {high:.3f}"


def report(result: dict[str, list[dict[str, Any]]]) -> Iterator[str]:
    """Tables of what came out."""
    rows = result["base"]
    yield "motion     | error / floor           | estimated / true floor  | detents missed, invented | above"
    yield "           | least, median, most     | least, median, most     |                          |"
    for name in MOTIONS:
        own = [row for row in rows if row["motion"] == name]
        with_detents = [row for row in own if row["detents"]]
        without = [row for row in own if not row["detents"]]
        missed = f"{sum(not row['found'] for row in with_detents)} of {len(with_detents)}"
        invented = f"{sum(row['found'] for row in without)} of {len(without)}"
        yield (
            f"{name:10} | {_quantiles([row['error'] for row in own]):23} "
            f"| {_quantiles([row['floor'] for row in own]):23} | {missed + ', ' + invented:24} "
            f"| {sum(row['error'] > AT_FLOOR[name] for row in own)} of {len(own)}"
        )
    yield "coverage of the 95 % intervals, % (root mean square of error / standard error)"
    names = list(rig_like(np.random.default_rng(0), True))
    yield "motion     " + " ".join(f"{name:>14}" for name in names)
    for name in (*MOTIONS, "all"):
        own = [row for row in rows if name in ("all", row["motion"]) and row["found"] == row["detents"]]
        cells = []
        for parameter in names:
            z = np.array([row["z"][parameter] for row in own if parameter in row["z"]])
            cells.append(f"{100 * np.mean(np.abs(z) < 1.96):5.1f} ({np.sqrt(np.mean(z**2)):.2f})".rjust(14))
        yield f"{name:10} " + " ".join(cells)
    yield "detents invented for a return spring, and the most that they turn by in the capture, rad of phase"
    for name in MOTIONS:
        own = [row for row in result["spring"] if row["motion"] == name]
        phases = [row["phase"] for row in own if row["found"]]
        largest = f", {max(phases):.2f}" if phases else ""
        yield f"{name:10} {len(phases)} of {len(own)}{largest}"
