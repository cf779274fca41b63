"""Several captures of one knob: the physics is shared, and what belongs to a run is each one's own."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from command import knobcam

import knobcam as kc

RATE_HZ = 1000.0
TRUE = {"inertia.M": 6e-5, "viscous.neg": 4e-4, "viscous.pos": 4e-4}
COULOMB = 0.0021


def recorded(seed: int, zero: float = 0.0, drift: float = 0.0) -> kc.Capture:
    """One run of a knob, made without the simulator; `zero` and `drift` (N m) are its torque sensor's."""
    random = np.random.default_rng(seed)
    t = np.arange(8000) / RATE_HZ
    theta, omega, alpha = np.zeros((3, len(t)))
    for size, hz in ((2.0, 0.31), (0.8, 0.73), (0.25, 1.7)):
        rate, phase = 2.0 * np.pi * hz * random.uniform(0.85, 1.15), random.uniform(0.0, 2.0 * np.pi)
        theta += size * np.sin(rate * t + phase)
        omega += size * rate * np.cos(rate * t + phase)
        alpha -= size * rate**2 * np.sin(rate * t + phase)
    tau = TRUE["inertia.M"] * alpha + COULOMB * np.sign(omega) + TRUE["viscous.pos"] * omega
    tau += zero + drift * t / t[-1] + 6e-4 * random.standard_normal(len(t))
    return kc.Capture.from_arrays(t=t, theta=theta + 2e-5 * random.standard_normal(len(t)), tau=tau)


ZEROS = (0.001, -0.002, 0.004)


@pytest.fixture(scope="module")
def captures() -> list[kc.Capture]:
    return [recorded(seed, zero) for seed, zero in enumerate(ZEROS)]


@pytest.fixture(scope="module")
def fitted(captures: list[kc.Capture]) -> kc.Fit:
    return kc.fit(captures)


def test_the_zero_of_the_sensor_is_each_captures_own_and_nothing_is_accused(captures: list[kc.Capture]):
    story = kc.learn(captures)
    assert (story.verdict, story.found) == ("complete", ())
    assert story.disagreements == ()
    params = story.fit.params
    for name, true in TRUE.items():
        assert abs(params[name].value - true) < 4.0 * params[name].se, name
    (zeros,) = story.fit.per_capture.values()
    for one, zero in zip(zeros, ZEROS, strict=True):
        # Counted from the first, whose own the Coulomb levels hold.
        assert one.estimate.value == pytest.approx(zero - ZEROS[0], abs=4.0 * one.estimate.se)
    assert "differs between the captures" in repr(story)
    assert len(story.document()["per_capture"]) == len(captures)


def test_zeros_that_are_equal_stay_one():
    together = kc.fit([recorded(seed, 0.003) for seed in range(10, 13)])
    assert together.per_capture == {}
    assert together.document()["per_capture"] == []
    assert "differs" not in repr(together)
    assert not any("@" in name for name in together.params)


def test_a_drift_is_each_captures_own():
    drifting = [recorded(20, 0.0, 0.004), recorded(21, 0.002, -0.006)]
    story = kc.learn(drifting)
    assert (story.verdict, story.found) == ("missing", ("torque_drift",))
    assert any(name.startswith("torque_drift") for name in story.fit.per_capture)
    for name, true in TRUE.items():
        assert abs(story.fit.params[name].value - true) < 4.0 * story.fit.params[name].se, name


def test_a_model_file_keeps_what_belongs_to_each_capture(
    captures: list[kc.Capture], fitted: kc.Fit, tmp_path: Path
):
    path = fitted.model.save(tmp_path / "model.toml")
    model = kc.Model.load(path)
    assert model == fitted.model
    alone = kc.fit(captures[2], model.frozen())
    assert alone.rmse == pytest.approx(float(np.sqrt(np.nanmean(fitted.residuals[2] ** 2))))
    # A capture that the model does not know has the zero of the first.
    new = kc.fit(recorded(0, ZEROS[2], drift=1e-9), model.frozen())
    assert float(np.nanmean(new.residual)) == pytest.approx(ZEROS[2] - ZEROS[0], abs=1e-4)


def test_a_fit_predicts_each_capture_with_its_own_zero(captures: list[kc.Capture], fitted: kc.Fit):
    for capture, residual in zip(captures, fitted.residuals, strict=True):
        assert abs(float(np.nanmean(residual))) < 1e-4
        assert abs(float(np.nanmean(capture.tau - fitted.predict(capture)))) < 1e-4


def test_a_model_of_three_captures_is_fitted_to_two_of_them(captures: list[kc.Capture], fitted: kc.Fit):
    two = kc.fit(captures[1:], fitted.model)
    (zeros,) = two.per_capture.values()
    assert zeros[1].estimate.value - zeros[0].estimate.value == pytest.approx(ZEROS[2] - ZEROS[1], abs=1e-4)


def test_what_a_user_fixed_is_no_captures_own(captures: list[kc.Capture]):
    model = kc.Model.of(["inertia", "coulomb", "viscous", "offset"]).with_value("offset.tau0", 0.001)
    fixed = kc.fit(captures, model.with_fixed("offset.tau0"))
    assert fixed.per_capture == {}
    tied = kc.fit(captures, model.with_tie("coulomb.neg", "coulomb.pos"))
    (zeros,) = tied.per_capture.values()
    for one, zero in zip(zeros, ZEROS, strict=True):
        assert one.estimate.value == pytest.approx(zero, abs=4.0 * one.estimate.se)


def test_captures_of_one_name_are_told_apart(captures: list[kc.Capture]):
    same = [
        replace(one, meta={"source": f"{folder}/run.npz"})
        for folder, one in zip("abc", captures, strict=True)
    ]
    names = [one.name for one in kc.fit(same).per_capture["offset.tau0"]]
    assert names == ["offset.tau0", "offset.tau0@run.npz (2)", "offset.tau0@run.npz (3)"]


def test_the_commands_say_what_the_captures_do_not_share(captures: list[kc.Capture], tmp_path: Path):
    files = [str(one.save(tmp_path / f"{name}.npz")) for name, one in zip("abc", captures, strict=True)]
    model = str(tmp_path / "model.toml")
    assert "offset.tau0@b.npz" in knobcam("fit", *files, "-o", model).out
    compared = knobcam("compare", files[1], files[2], model).out
    assert "differs between the captures" in compared
