"""Torque that a map computes with constants nobody knows: kt/R and the back-EMF of a motor."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest
from command import knobcam, refused

import knobcam as kc
from knobcam.errors import InputError

KT_R, KE, INERTIA, DRAG, DRY = 0.015, 0.03, 2e-4, 5e-5, 0.004  # N m/V, V s/rad, N m s^2/rad, N m s/rad, N m
FORMULA = "tau=kt/R*(duty*supply-ke*omega*on)"
MAP = ["t=t", "theta=pos [rad]"]
FREE = ["kt", "R", "ke"]


def motor(path: Path, seed: int, off: bool, held: bool = False) -> Path:
    """Log a motor on a supply that sags, a driver that lets go if it is to be off.

    `held`: its duty stands from one row to the next.
    """
    rng = np.random.default_rng(seed)
    rate, steps, seconds = 250.0, 32, 16.0
    time = np.arange(int(rate * seconds * steps) + steps) / rate / steps
    tones, phases = np.array([0.31, 0.73, 1.3, 2.9]), rng.uniform(0.0, 2.0 * np.pi, 4)
    duty = np.sin(2.0 * np.pi * tones * time[:, None] + phases) @ [0.3, 0.2, 0.15, 0.1]
    on = (time % 4.0 < 2.8) | (not off)
    if held:
        duty, on = (np.repeat(column[::steps], steps) for column in (duty, on))
    at, speed, rows = 0.0, 0.0, []
    h = 1.0 / rate / steps
    for k in range(int(rate * seconds) * steps):
        supply = 12.0 - 0.3 * duty[k] * (12.0 * duty[k] - KE * speed) / 2.0
        if k % steps == 0:
            rows.append((time[k], at, duty[k] * on[k], supply, float(on[k])))
        given = KT_R * (duty[k] * supply - KE * speed) if on[k] else 0.0
        friction = DRY * math.tanh(speed / 0.02) + DRAG * speed
        speed += h * (given - friction) / INERTIA
        at += h * speed
    log = np.array(rows)
    log[:, 1] += 2e-5 * rng.standard_normal(len(log))
    log[:, 2] += 0.003 * log[:, 4] * rng.standard_normal(len(log))
    np.savetxt(path, log, delimiter=",", header="t,pos,duty,supply,on", comments="")
    return path


@pytest.fixture(scope="module")
def let_go(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A motor that its driver lets go of now and then."""
    return motor(tmp_path_factory.mktemp("motor") / "off.csv", 1, off=True)


@pytest.fixture(scope="module")
def driven(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A motor that is driven throughout."""
    return motor(tmp_path_factory.mktemp("motor") / "on.csv", 2, off=False)


def told(estimate: kc.Estimate, true: float, share: float) -> bool:
    """Whether the truth is found, to a share that the log's 250 Hz leave, and an interval is as narrow."""
    low, high = estimate.ci95
    return abs(estimate.value / true - 1.0) < share and 0.0 < high - low < 2.0 * share * true


def test_runs_with_the_motor_off_tell_the_back_emf_from_friction(let_go: Path) -> None:
    fitted = kc.fit_constants(let_go, map=[*MAP, FORMULA], free=FREE, known={"inertia.M": INERTIA})
    assert fitted.constants is not None and not fitted.constants.undetermined
    assert told(fitted.constants.found["kt/R"], KT_R, 0.005)
    assert told(fitted.constants.found["ke"], KE, 0.005)
    assert fitted.params["inertia.M"].value == INERTIA and fitted.params["inertia.M"].interval == "fixed"
    assert told(fitted.params["viscous.pos"], DRAG, 0.1)
    assert told(fitted.params["viscous.neg"], DRAG, 0.1)
    assert fitted.torque_unit == "N m"


def test_a_duty_that_stands_until_the_next_row_is_half_a_row_late_and_costs_the_constants_nothing(
    tmp_path: Path,
) -> None:
    path = motor(tmp_path / "held.csv", 1, off=True, held=True)
    fitted = kc.fit_constants(path, map=[*MAP, FORMULA], free=FREE, known={"inertia.M": INERTIA})
    assert fitted.constants is not None and fitted.constants.delay is not None
    low, high = fitted.constants.delay.ci95
    assert low > 0.0 and fitted.constants.delay.value == pytest.approx(0.5 / 250.0, rel=0.3)
    # Without it all damping of half a row, 0.45 % of the inertia, is missing from both.
    assert told(fitted.constants.found["kt/R"], KT_R, 0.002)
    assert told(fitted.constants.found["ke"], KE, 0.003)
    assert "later than it is logged" in repr(fitted)
    assert fitted.document()["constants"]["delay_s"]["ci95"] == [low, high]


def test_a_motor_that_is_always_driven_does_not_tell_its_back_emf(driven: Path) -> None:
    fitted = kc.fit_constants(driven, map=[*MAP, FORMULA], free=FREE, known={"inertia.M": INERTIA})
    assert fitted.constants is not None and list(fitted.constants.found) == ["kt/R"]
    assert told(fitted.constants.found["kt/R"], KT_R, 0.005)
    assert "stays in viscous.neg and viscous.pos" in fitted.constants.undetermined["ke"]
    assert fitted.params["viscous.pos"].value == pytest.approx(DRAG + KT_R * KE, rel=0.03)


def test_friction_that_is_known_tells_the_back_emf(driven: Path) -> None:
    known = {"inertia.M": INERTIA, "viscous.pos": DRAG, "viscous.neg": DRAG}
    fitted = kc.fit_constants(driven, map=[*MAP, FORMULA], free=FREE, known=known)
    assert fitted.constants is not None
    assert told(fitted.constants.found["kt/R"], KT_R, 0.005)
    assert told(fitted.constants.found["ke"], KE, 0.005)
    assert fitted.params["viscous.neg"].value == DRAG
    with pytest.raises(InputError, match=r"'viscous.neg' cannot give the scale.*give another one first"):
        kc.fit_constants(driven, map=[*MAP, FORMULA], free=FREE, known=dict(reversed(known.items())))


def test_nothing_known_leaves_the_scale_open_and_the_back_emf_in_volts(let_go: Path, tmp_path: Path) -> None:
    answer = knobcam("fit", let_go, "--map", *MAP, FORMULA, "--free", *FREE, "--json")
    constants = answer.document["constants"]
    assert constants["kt/R"]["value"] is None and "--known inertia.M=VALUE" in constants["kt/R"]["why"]
    low, high = constants["ke"]["ci95"]
    assert abs(0.5 * (low + high) - KE) < high - low  # one in 20 lies just outside
    in_volts = kc.fit_constants(let_go, map=[*MAP, "tau=duty*supply-ke*omega*on [V]"], free="ke")
    assert in_volts.torque_unit == "V" and in_volts.constants is not None
    assert in_volts.constants.found["ke"].value == pytest.approx(constants["ke"]["value"], rel=1e-6)
    assert not any("back-EMF" in one for one in in_volts.warnings)
    model = tmp_path / "motor.toml"
    ended = knobcam("fit", let_go, "--map", *MAP, FORMULA, "--free", *FREE, "-o", model)
    refused(ended, "what scales the torque is not determined", "--known inertia.M=VALUE")
    assert not model.exists()


def test_a_current_is_scaled_by_what_is_known(let_go: Path) -> None:
    """One scale alone, as the kt of a current is, converts all that is a torque and no more."""
    bare = kc.fit(kc.load(let_go, map=[*MAP, "tau=duty*supply"]))
    fitted = kc.fit_constants(
        let_go, map=[*MAP, "tau=kt*duty*supply"], free="kt", known={"inertia.M": INERTIA}
    )
    assert fitted.constants is not None
    scale = INERTIA / bare.params["inertia.M"].value
    assert fitted.constants.found["kt"].value == pytest.approx(scale, rel=1e-6)
    assert fitted.params["coulomb.pos"].value == pytest.approx(
        scale * bare.params["coulomb.pos"].value, rel=1e-6
    )


@pytest.mark.parametrize(
    ("formula", "free", "known", "said"),
    [
        ("tau=kt*(duty*supply-kt*omega)", ["kt"], {}, "'kt'.*neither is in proportion"),
        ("tau=duty*supply", ["ke"], {}, "'ke' is not in tau"),
        ("tau=duty*supply-on*omega", ["on"], {}, "'on' is a column"),
        ("tau=duty*supply-ke*omega", ["ke", "ke"], {}, "'ke' is named twice"),
        ("tau=duty*supply-ke*gate", ["ke"], {}, "no column 'gate'"),
        (FORMULA, FREE, {"inertia.J": 1.0}, "'inertia.J' is none of the model, which has inertia.M"),
    ],
)
def test_what_is_no_such_formula_is_refused(
    formula: str, free: list[str], known: dict[str, float], said: str, let_go: Path
) -> None:
    with pytest.raises(InputError, match=said):
        kc.fit_constants(let_go, map=[*MAP, formula], free=free, known=known)


def test_what_is_known_needs_constants_that_are_free(let_go: Path) -> None:
    refused(
        knobcam("fit", let_go, "--map", *MAP, "tau=duty*supply", "--known", "inertia.M=1"),
        "--known: is of --free",
    )
    refused(knobcam("fit", let_go, "--free", "ke"), "there is no --map")


def test_a_motor_that_lets_go_is_no_sensor_that_was_off(tmp_path: Path) -> None:
    """A pendulum is lifted, by what friction holds as well, and swings free for the rest of the log."""
    rng = np.random.default_rng(5)
    t = np.arange(1600) / 250.0
    swing = np.maximum(t - 1.6, 0.0)
    pos = np.where(t < 1.6, -0.5 * np.sin(np.pi * t / 3.2), -0.5 * np.exp(-swing) * np.cos(8.0 * swing))
    volts = np.where(t < 1.6, 2.0 * pos + np.sin(9.0 * t**2) + 0.3 * rng.standard_normal(1600), 0.0)
    log = np.column_stack([t, pos + 1e-3 * rng.standard_normal(1600), volts])
    np.savetxt(tmp_path / "swing.csv", log, delimiter=",", header="t,pos,u", comments="")
    capture = kc.load(tmp_path / "swing.csv", map="t=t theta=pos [rad] tau=u [V]")
    assert capture.mask.all() and not capture.findings
    # Of a torque sensor it would be said: it read nothing while the knob moved.
    sensor = kc.load(tmp_path / "swing.csv", map="t=t theta=pos [rad] tau=u")
    assert [one.kind for one in sensor.findings] == ["dead"] and not sensor.mask[500:].any()


@pytest.mark.parametrize("let_go", [True, False])
def test_rows_of_a_motor_without_back_emf_are_no_volts_of_the_others(tmp_path: Path, let_go: bool) -> None:
    """A pendulum is driven, then its motor is let go, or shorted: only where it is open is no back-EMF."""
    step, off = 2e-4, 500
    theta = omega = 0.0
    log = []
    for row in range(1600):
        t = row / 250.0
        wanted = 0.5 * np.sin(4.0 * t) + 0.2 * np.sin(11.0 * t)
        volts = 25.0 * (wanted - theta) if row < off else 0.0
        log.append((t, theta, volts))
        for _ in range(20):
            back = 0.0 if let_go and row >= off else 0.3 * omega
            rubs = 0.005 * np.tanh(omega / 0.02)
            omega += step * (0.1 * (volts - back) - 0.4 * np.sin(theta) - rubs) / 0.006
            theta += step * omega
    table = np.array(log)
    table[:, 1] = np.round(table[:, 1] / 1.5e-3) * 1.5e-3  # rad, a count of the encoder
    np.savetxt(tmp_path / "servo.csv", table, delimiter=",", header="t,pos,u", comments="")
    capture = kc.load(tmp_path / "servo.csv", map="t=t theta=pos [rad] tau=u [V]")
    said = [one.key for one in capture.findings if one.severity == "masked"]
    assert said == (["let_go:tau"] if let_go else [])
    assert not let_go or not capture.mask[off + 20 :].any()
    # A constant that says when it was off is told by those very rows.
    formula = {"map": "t=t theta=pos [rad] tau=u-ke*omega [V]", "free": "ke"}
    assert kc.fit_constants(tmp_path / "servo.csv", **formula).prepared[0].capture.mask.all()
