"""Arguments and attributes that have another name now: for one version the old one is taken too."""

from __future__ import annotations

from pathlib import Path

import pytest

import knobcam as kc


def old(words: str) -> pytest.WarningsRecorder:
    return pytest.warns(DeprecationWarning, match=words)


def test_a_rate_is_called_rate_hz_and_taken_as_rate_too(tmp_path: Path) -> None:
    path = tmp_path / "log.csv"
    path.write_text("theta_rad,tau_Nm\n0,0\n0.1,0\n0.3,0\n")
    with old("rate=...") as said:
        assert kc.load(path, rate=100.0).rate_hz == kc.load(path, rate_hz=100.0).rate_hz == 100.0
    assert said[0].filename == __file__
    with old("rate=..."):
        assert kc.Capture.from_arrays(theta=[0, 1], tau=[0, 1], rate=10.0).rate_hz == 10.0
    with old("rate=..."):
        assert kc.check_stability("knob4", rate=1000.0).rate_hz == 1000.0


def test_a_renderer_takes_both_names_of_its_rate() -> None:
    assert kc.Renderer("knob4", rate=2500.0).rate_hz == kc.Renderer("knob4", rate_hz=2500.0).rate_hz == 2500.0


def test_rotary_or_linear_is_the_coordinate_and_taken_as_axis_too() -> None:
    columns = {"theta": [0, 1], "tau": [0, 1], "rate_hz": 10.0}
    with old("axis=..."):
        capture = kc.Capture.from_arrays(axis="linear", **columns)
    with old("axis=..."):
        model = kc.Model.of(["inertia"], axis="linear")
    with old("axis=..."):
        assert kc.effects(axis="linear") == kc.effects("linear")
    for thing in (capture, model):
        with old("axis is now called coordinate"):
            assert thing.axis == thing.coordinate == "linear"


def test_an_argument_is_not_taken_under_both_names() -> None:
    with pytest.raises(TypeError, match="rate, which is now called rate_hz, and rate_hz"):
        kc.check_stability("knob4", rate=1000.0, rate_hz=1000.0)
