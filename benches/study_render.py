"""What a rendered knob feels like, in figures: drift, breakaway, passivity, timing.

`python benches/study_render.py` writes `benches/results/render.json`.
"""

import json
import math
import warnings
from pathlib import Path

import numpy as np
import slipping

import knobcam as kc
from knobcam import _core

RATE_HZ, COUNT_RAD = 5000.0, 9.8e-6
KNOBS = [f"knob{n}" for n in range(1, 6)]
SECONDS, BLOCKS = 38.0, 190
OUT = Path(__file__).resolve().parent / "results" / "render.json"


def value(model: kc.Model, name: str) -> float:
    """A parameter, 0 where the model lacks it."""
    return {row[0]: row[1] for row in model.core.rows()}.get(name, 0.0)


def device(delay: int = 1) -> kc.Device:
    """A handle of a usual size with the paper's encoder."""
    return kc.Device(inertia_kg_m2=5e-5, damping_Nms_rad=1e-4, delay_samples=delay)


def groove(model: kc.Model) -> float:
    """Where its detents hold the knob, rad."""
    falling = math.pi if value(model, "detent.A") < 0.0 else 0.0
    return value(model, "detent.P") * (falling - value(model, "detent.S"))


def detent(model: kc.Model, theta: float) -> float:
    """Torque of the detents, N m."""
    a, p, s = (value(model, f"detent.{name}") for name in "APS")
    return a * math.sin(theta / p + s) if a != 0.0 else 0.0


def push(hold: float) -> np.ndarray:
    """The hand of the drift test: 0.2 of what holds, and 0.5 of it at 25 Hz."""
    t = np.arange(round(SECONDS * RATE_HZ)) / RATE_HZ
    return hold * (0.2 + 0.5 * np.sin(2.0 * np.pi * 25.0 * t))


def drift_of(theta: np.ndarray) -> float:
    """Counts from the fifth block of five periods to the last one, by their mean positions."""
    blocks = theta.reshape(BLOCKS, -1).mean(axis=1)
    return float(abs(blocks[-1] - blocks[4]) / COUNT_RAD)


def rendered_drift(model: kc.Model, measured: bool) -> float:
    """Drift of a stuck rendered knob, counts."""
    tau = push(value(model, "karnopp.D_pos"))
    renderer = kc.Renderer(model, RATE_HZ, device=device())
    handle = _core.Handle(device().row, RATE_HZ, groove(model))
    theta, before = np.empty(len(tau)), 0.0
    for i, hand in enumerate(tau.tolist()):
        answer = renderer.step(*handle.sensed(), before if measured else None)
        handle.push(-answer, before, hand)
        theta[i], before = handle.motion[0], hand
    return drift_of(theta)


def breakaway(model: kc.Model, sign: float, rate_hz: float, measured: bool) -> float:
    """Torque of a hand that pushes ever harder when the knob breaks away, less that of the detents, N m."""
    renderer = kc.Renderer(model, rate_hz, device=device(0))
    handle = _core.Handle(device(0).row, rate_hz, groove(model))
    hand = 0.0
    while not renderer.state["slipping"] and hand < 1.0:
        before, hand = hand, hand + 0.02 / rate_hz
        answer = renderer.step(*handle.sensed(), sign * before if measured else None)
        handle.push(-answer, sign * before, sign * hand)
    return hand - sign * detent(model, handle.motion[0])


def sliding_error(model: kc.Model, sign: float, rate_hz: float) -> float:
    """Share of friction by which the torque of a steady slow turn is off."""
    omega, way = 2.0 * sign, "pos" if sign > 0 else "neg"
    theta = omega * np.arange(round(0.5 * rate_hz)) / rate_hz
    tau = kc.Renderer(model, rate_hz).along(theta, np.full_like(theta, omega))[-1]
    friction = sign * value(model, f"coulomb.{way}") + value(model, f"viscous.{way}") * omega
    return abs((tau - detent(model, theta[-1])) / friction - 1.0)


def hand_of(seed: int) -> kc.MotionTrack:
    """A hand that follows a multisine for 30 s: twelve tones from 0.3 Hz to 26 Hz."""
    t = np.arange(round(30.0 * RATE_HZ)) / RATE_HZ
    phases = np.random.default_rng(seed).uniform(0.0, 2.0 * np.pi, 12)
    w = 2.0 * np.pi * 0.3 * 1.5 ** np.arange(12)
    theta, omega, alpha = np.zeros_like(t), np.zeros_like(t), np.zeros_like(t)
    for rate, phase in zip(w, phases, strict=True):
        size = 0.3 * 2.0 * np.pi / rate
        theta += size * (np.sin(rate * t + phase) - np.sin(phase))
        omega += size * rate * np.cos(rate * t + phase)
        alpha -= size * rate**2 * np.sin(rate * t + phase)
    return kc.MotionTrack(t, theta, omega, alpha)


def passivity(model: kc.Model, delay: int, track: kc.MotionTrack) -> float:
    """Work of the hand over 30 s, J: the least that it was whenever it was looked at."""
    handle = kc.EmulatedHandle(device(delay), track, theta=groove(model))
    renderer = kc.Renderer(model, RATE_HZ, device=device(delay))
    least = 0.0
    with kc.start_loop(renderer, handle, 30.0, time="virtual") as loop:
        while not loop.wait(0.002):
            least = min(least, handle.work_J)
    assert loop.report().well, loop.report()
    return min(least, handle.work_J)


def swing(model: kc.Model, delay: int) -> float:
    """How far a knob still swings 3 s after a kick of 8 rad/s in no hand, counts."""
    handle = _core.Handle(device(delay).row, RATE_HZ, groove(model))
    renderer = kc.Renderer(model, RATE_HZ, device=device(delay))
    handle.kick(8.0)
    theta = np.empty(20_000)
    for i in range(len(theta)):
        handle.push(-renderer.step(*handle.sensed()), 0.0, 0.0)
        theta[i] = handle.motion[0]
    return float(np.ptp(theta[15_000:]) / COUNT_RAD)


def drift_rows() -> tuple[list[str], dict[str, object]]:
    """Drift of every knob, and of the textbook's friction on the same test."""
    rows = ["drift of a stuck knob in 38 s, encoder counts of 9.8 urad (to reach: 1)"]
    rows.append(f"  {'':8}{'rendered':>11}{'hand known':>12}{'Karnopp':>11}{'Dahl':>11}{'LuGre':>11}")
    figures: dict[str, object] = {}
    for name in KNOBS:
        model = kc.Model.load(name)
        hold = value(model, "karnopp.D_pos")
        mine = [rendered_drift(model, measured) for measured in (False, True)]
        slide = value(model, "coulomb.pos")
        peers = [drift_of(law(push(hold), hold, slide)) for law in slipping.LAWS.values()]
        figures[name] = {"rendered": mine, **dict(zip(slipping.LAWS, peers, strict=True))}
        cells = "".join(f"{x:>{w}.3g}" for x, w in zip([*mine, *peers], (11, 12, 11, 11, 11), strict=True))
        rows.append(f"  {name:8}{cells}")
    return rows, figures


def torque_rows() -> tuple[list[str], dict[str, object]]:
    """Breakaway and sliding torque, both directions, at three rates."""
    off, apart, slid = 0.0, 0.0, 0.0
    for name in KNOBS:
        model = kc.Model.load(name)
        model = model.with_value("karnopp.D_neg", 0.8 * value(model, "karnopp.D_pos"))
        for sign, way in ((1.0, "pos"), (-1.0, "neg")):
            for measured in (False, True):
                found = np.array([breakaway(model, sign, rate, measured) for rate in (1e4, 5e3, 2.5e3)])
                off = max(off, float(np.abs(found / value(model, f"karnopp.D_{way}") - 1.0).max()))
                apart = max(apart, float(np.ptp(found) / found[1]))
            slid = max(slid, *(sliding_error(model, sign, rate) for rate in (1e4, 5e3, 2.5e3)))
    rows = [
        "five knobs, both directions, steps of 100, 200, 400 us, hand known or not: worst",
        f"  breakaway torque off by, %           {100 * off:8.3f}  (to reach: 1)",
        f"  breakaway at one step and another, % {100 * apart:8.3f}  (to reach: 2)",
        f"  sliding torque off by, %             {100 * slid:8.3f}  (to reach: 1)",
    ]
    return rows, {"breakaway": off, "rates": apart, "sliding": slid}


def passivity_rows() -> tuple[list[str], dict[str, object]]:
    """Work of a hand, and swing after a kick, under delays of 0 to 10 samples."""
    track = hand_of(7)
    least = {n: min(passivity(kc.Model.load(n), d, track) for d in range(11)) for n in KNOBS}
    most = {n: max(swing(kc.Model.load(n), d) for d in range(11)) for n in KNOBS}
    rows = ["delays of 0 to 10 samples: least work of a multisine hand in 30 s, J (to reach: -1e-6),"]
    rows.append("swing 3 s after a kick of 8 rad/s, counts (to reach: 1)")
    rows += [f"  {name:8}{least[name]:12.3g}{most[name]:12.3g}" for name in KNOBS]
    return rows, {"work_J": least, "swing_counts": most}


def timing_rows() -> tuple[list[str], dict[str, object]]:
    """A loop in real time for 20 s, with real-time priority where the system grants it."""
    handle = kc.EmulatedHandle(device(), kc.motion("turns", 9.6, span=6.0, speed=4.0))
    renderer = kc.Renderer("knob4", RATE_HZ, device=device())
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", kc.KnobcamWarning)
        report = kc.run_loop(renderer, handle, 20.0)
    rows = ["render loop on the emulated handle, 20 s in real time", *repr(report).splitlines()]
    return rows, report.document()


def main() -> None:
    """Measure all and write it down."""
    lines: list[str] = []
    figures: dict[str, object] = {}
    parts = {"drift": drift_rows, "torque": torque_rows, "passivity": passivity_rows, "timing": timing_rows}
    for name, part in parts.items():
        rows, figures[name] = part()
        print("\n".join(rows), flush=True)
        lines += [*rows, ""]
    lines.append("allocations in 10^6 steps of every load and joint: 0 (crates/knobrig/tests/no_alloc.rs)")
    OUT.write_text(json.dumps({"report": lines, **figures}, indent=1) + "\n", "utf-8")


if __name__ == "__main__":
    main()
