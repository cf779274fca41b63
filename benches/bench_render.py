"""Rendering beside NumPy, Numba and plain Python: whole arrays, single steps, presliding with sensitivities.

`python benches/bench_render.py` prints the ratios; `pytest benches/bench_render.py` the groups.
"""

from collections.abc import Callable, Iterator

import maxwell
import numpy as np
import pytest
import stickslip
from ratio import Row, ratio, show

import knobcam as kc
from knobcam import _core
from knobcam.capture import motions

SAMPLES, RATE_HZ = 300_000, 5000.0
STEPS = 5000
PRESLIDING = 25_000


def knobs() -> dict[str, kc.Model]:
    """Knob 4 with its detents and static friction, and the same with a Stribeck effect."""
    knob = kc.Model.load("knob4")
    rise = knob.with_effect("stribeck").with_value("stribeck.rise", 0.5).with_value("stribeck.vs", 0.3)
    return {"knob 4": knob, "knob 4 with stribeck": rise}


def sweep() -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """A minute of the paper's swept sine, slowed down to it."""
    track = motions.sweep(np.arange(1, SAMPLES + 1) / RATE_HZ, d=30.0)
    return track.theta, track.omega, track.alpha


def array_works(model: kc.Model) -> tuple[Callable[[], np.ndarray], dict[str, Callable[[], np.ndarray]]]:
    """Ours and the peers' rendering of the sweep."""
    motion = sweep()
    p, s = stickslip.parameters(model), stickslip.stribeck_of(model)
    renderer = kc.Renderer(model, RATE_HZ)

    def ours() -> np.ndarray:
        renderer.reset()
        return renderer.along(*motion)

    def numba() -> np.ndarray:
        out = np.empty(SAMPLES)
        stickslip.numba_step(p, s, *motion, out)
        return out

    return ours, {
        "NumPy, without anchor": lambda: stickslip.numpy_law(p, s, *motion),
        "numba loop": numba,
    }


def check_array(model: kc.Model) -> None:
    """Where the knob slides fast, all agree; near rest each has its own way to stick."""
    ours, peers = array_works(model)
    mine, fast = ours(), np.abs(sweep()[1]) > 0.5
    scale = np.abs(mine).max()
    for peer in peers.values():
        assert np.abs(peer() - mine)[fast].max() < 1e-9 * scale


def step_works(model: kc.Model) -> tuple[Callable[[], float], Callable[[], float]]:
    """Single steps from Python: ours and plain Python."""
    rows = list(zip(*(column[100_000 : 100_000 + STEPS].tolist() for column in sweep()), strict=True))
    renderer, plain = kc.Renderer(model, RATE_HZ), stickslip.PurePython(stickslip.parameters(model))
    mine, theirs = renderer.step, plain.step

    def ours() -> float:
        renderer.reset()
        for theta, omega, alpha in rows:
            tau = mine(theta, omega, alpha)
        return tau

    def python() -> float:
        for theta, omega, alpha in rows:
            tau = theirs(theta, omega, alpha)
        return tau

    return ours, python


def formula_works() -> dict[str, Callable[[], np.ndarray]]:
    """The sweep of knob 4 with a drag that is written as a formula, and with the same of the catalogue."""
    motion, knob = sweep(), kc.Model.load("knob4")
    kc.own_law("drag_by_formula", "d omega |omega|")
    drags = {"as a formula": "drag_by_formula", "of the catalogue": "quadratic_drag"}

    def work(name: str) -> Callable[[], np.ndarray]:
        renderer = kc.Renderer(knob.with_effect(name).with_value(f"{name}.d", 1e-4), RATE_HZ)

        def along() -> np.ndarray:
            renderer.reset()
            return renderer.along(*motion)

        return along

    works = {said: work(name) for said, name in drags.items()}
    np.testing.assert_allclose(works["as a formula"](), works["of the catalogue"](), rtol=1e-9, atol=1e-15)
    return works


SHARES = {"presliding.w1": 0.3, "presliding.w3": 0.2, "presliding.w5": 0.1, "presliding.s": 0.05}


def presliding_works() -> tuple[Callable[[], np.ndarray], dict[str, Callable[[], np.ndarray]]]:
    """Torque and all derivatives of a model with presliding, shape (13, samples)."""
    model = kc.Model.of(["inertia", "coulomb", "viscous", "presliding"])
    values = {"inertia.M": 5e-5, "coulomb.neg": 0.01, "coulomb.pos": 0.012}
    for name, value in {**values, "viscous.neg": 5e-4, "viscous.pos": 6e-4, **SHARES}.items():
        model = model.with_value(name, value)
    track = motions.sweep(np.arange(1, PRESLIDING + 1) / RATE_HZ)
    motion = (track.theta, track.omega, track.alpha)
    gaps = np.zeros(PRESLIDING, dtype=bool)
    signals = _core.prepare(
        "rotary", RATE_HZ, track.t, *motion, np.zeros(PRESLIDING), gaps, ~gaps, "none", {}
    )
    p = np.array([value for name, value, _, _ in model.core.rows() if name != "presliding.s"])
    p, s = np.concatenate([p[:5], [SHARES["presliding.s"]], p[5:]]), SHARES["presliding.s"]

    def ours() -> np.ndarray:
        torque, slopes = model.core.sensitivities(signals)
        return np.stack([torque, *slopes])

    def loop() -> np.ndarray:
        return maxwell.torque_and_slopes(p, motion, maxwell.by_loop(s, track.theta))

    def ode() -> np.ndarray:
        return maxwell.torque_and_slopes(p, motion, maxwell.by_odeint(s, RATE_HZ, track.omega))

    return ours, {"odeint, numba right-hand side": ode, "numba loop": loop}


def check_presliding() -> dict[str, float]:
    """Largest error of each, as a share of the torque, measured against the exact loop."""
    ours, peers = presliding_works()
    exact = peers["numba loop"]()
    scale = np.abs(exact[0]).max()
    errors = {name: float(np.abs(work()[0] - exact[0]).max() / scale) for name, work in peers.items()}
    mine = ours()
    errors["knobcam"] = float(np.abs(mine[0] - exact[0]).max() / scale)
    slopes = np.abs(mine[1:] - exact[1:]).max(axis=1)
    assert (slopes <= 1e-3 * np.abs(exact[1:]).max(axis=1)).all(), slopes
    assert errors["knobcam"] <= 1e-3
    return errors


@pytest.mark.parametrize("name", ["knobcam", "NumPy, without anchor", "numba loop"])
@pytest.mark.parametrize("knob", ["knob 4", "knob 4 with stribeck"])
def test_whole_array(benchmark, knob, name):
    model = knobs()[knob]
    check_array(model)
    ours, peers = array_works(model)
    benchmark.group = f"render {SAMPLES} samples of {knob}"
    benchmark(ours if name == "knobcam" else peers[name])


@pytest.mark.parametrize("name", ["knobcam", "plain Python"])
def test_single_steps(benchmark, name):
    ours, python = step_works(knobs()["knob 4"])
    benchmark.group = f"{STEPS} single steps from Python"
    benchmark(ours if name == "knobcam" else python)


@pytest.mark.parametrize("name", ["as a formula", "of the catalogue"])
def test_formula(benchmark, name):
    benchmark.group = f"render {SAMPLES} samples with a drag"
    benchmark(formula_works()[name])


@pytest.mark.parametrize("name", ["knobcam", "odeint, numba right-hand side", "numba loop"])
def test_presliding(benchmark, name):
    check_presliding()
    ours, peers = presliding_works()
    benchmark.group = f"presliding with derivatives, {PRESLIDING}"
    benchmark(ours if name == "knobcam" else peers[name])


REACH = {"NumPy, without anchor": 5.0, "numba loop": 4.0}


def rows() -> Iterator[Row]:
    """Measured ratios, the answers checked first."""
    for knob, model in knobs().items():
        check_array(model)
        ours, peers = array_works(model)
        for name, peer in peers.items():
            yield Row(f"render {SAMPLES:,} samples of {knob}", name, *ratio(ours, peer, 40), REACH[name])
    ours_steps, python = step_works(knobs()["knob 4"])
    work = f"{STEPS:,} single steps from Python"
    yield Row(work, "plain Python", *ratio(ours_steps, python, 30), 2.0)
    formula, catalogued = formula_works().values()
    work = f"render {SAMPLES:,} samples with a drag as a formula"
    yield Row(work, "the same of the catalogue", *ratio(formula, catalogued, 30), 0.5)
    check_presliding()
    ours, peers = presliding_works()
    reach = {"odeint, numba right-hand side": 30.0, "numba loop": 2.0}
    for name, peer in peers.items():
        work = f"presliding, torque and 12 derivatives, {PRESLIDING:,}"
        yield Row(work, name, *ratio(ours, peer, 5 if "ode" in name else 30), reach[name])


if __name__ == "__main__":
    show(rows())
