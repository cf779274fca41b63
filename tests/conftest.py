"""What several files of tests start from."""

from collections.abc import Iterator

import pytest

import knobcam as kc


@pytest.fixture(scope="session")
def capture() -> kc.Capture:
    return kc.simulate(kc.Model.load("knob4"), "sweep")


@pytest.fixture(scope="session")
def fit(capture: kc.Capture) -> kc.Fit:
    return kc.fit(capture)


@pytest.fixture(autouse=True)
def _catalogue_as_it_was() -> Iterator[None]:
    """Effects that a test registers, or a page or an example in it, are gone after it."""
    before = set(kc.effects())
    yield
    for name in set(kc.effects()) - before:
        kc.forget_effect(name)
