"""What several files of tests start from."""

import pytest

import knobcam as kc


@pytest.fixture(scope="session")
def capture() -> kc.Capture:
    return kc.simulate(kc.Model.load("knob4"), "sweep")


@pytest.fixture(scope="session")
def fit(capture: kc.Capture) -> kc.Fit:
    return kc.fit(capture)
