"""What several files of tests start from."""

import gc
import os
import signal
from collections.abc import Iterator
from pathlib import Path

# Before NumPy is there: threads of its linear algebra wait for one another and keep their processors busy,
# which takes thirty times as long where another test needs these. So do the processes that tests start.
os.environ["OPENBLAS_NUM_THREADS"] = "1"

import httpx
import pytest
from brake import braked_knob
from workbench_server import served

import knobcam as kc
from knobcam.workbench.bench import Bench

# A shell starts what runs in the background with Ctrl-C ignored, nohup with the terminal's end ignored, and
# their children with them: whoever waits for the end of one would wait forever.
signal.signal(signal.SIGINT, signal.default_int_handler)
signal.signal(signal.SIGHUP, signal.SIG_DFL)

# What these are about takes the time that it takes only where nothing else runs. Who merely starts processes
# or servers is not among them, nor who records from a rig that is faster than time: it waits for a host that
# is behind. Single tests of other files say so themselves.
ALONE = ("faults", "loop", "rig_safety", "workbench_patience")

# These take the longest, and a file is one worker's: whoever begins with them has none left at the end.
FIRST = ("browser", "docs", "workbench_designing")

# Of the captures that many tests share: they show the same as at 5 kHz, and a search costs a fraction.
RATE_HZ = 1000.0


def about(path: Path) -> str:
    """What a file of tests is about, by its name."""
    return path.stem.removeprefix("test_")


def pytest_ignore_collect(collection_path: Path, config: pytest.Config) -> bool | None:
    """Whoever asks for those alone needs no other file: to load them all takes longer than many tests."""
    if config.option.markexpr != "alone" or not collection_path.name.startswith("test_"):
        return None
    alone = about(collection_path) in ALONE or "pytest.mark.alone" in collection_path.read_text("utf-8")
    return None if alone else True


@pytest.hookimpl(tryfirst=True)
def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    for item in items:
        if about(item.path) in ALONE:
            item.add_marker(pytest.mark.alone)
    items.sort(key=lambda item: FIRST.index(about(item.path)) if about(item.path) in FIRST else len(FIRST))


def pytest_collection_finish() -> None:
    """What is loaded by now stays; who collects garbage, as statsmodels does at each call, leaves it out."""
    gc.freeze()


@pytest.fixture(scope="session")
def capture() -> kc.Capture:
    return kc.simulate(kc.Model.load("knob4"), "sweep", rate_hz=RATE_HZ)


@pytest.fixture(scope="session")
def fit(capture: kc.Capture) -> kc.Fit:
    return kc.fit(capture)


@pytest.fixture(scope="session")
def sprung() -> kc.Capture:
    """A knob with a return spring that the base model lacks."""
    knob = kc.Model.load("knob4").with_effect("return_spring").with_value("return_spring.k", 0.004)
    return kc.simulate(knob, "sweep", rate_hz=RATE_HZ)


@pytest.fixture(scope="session")
def recording(sprung: kc.Capture, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The same in a file."""
    return sprung.save(tmp_path_factory.mktemp("captures") / "sprung.npz")


@pytest.fixture(scope="session")
def story(sprung: kc.Capture) -> kc.LearningResult:
    return kc.learn(sprung)


@pytest.fixture(scope="session")
def alike() -> kc.LearningResult:
    """A spring that is felt through a small angle alone: other torques of position do nearly as well."""
    knob = kc.hiding("knob4", "return_spring", motion="multisine")
    return kc.learn(kc.simulate(knob, "multisine", noise=kc.SensorNoise(tau_sd=6e-3), duration_s=3.0, seed=3))


@pytest.fixture(scope="session")
def braked() -> kc.Capture:
    """A knob with a brake that no effect of the catalogue is."""
    return braked_knob(0.016, 1.3)


@pytest.fixture
def undrawn(monkeypatch: pytest.MonkeyPatch) -> None:
    """Reports in which only the words are as they are: pictures take seconds."""
    for kind in ("report", "batch_report"):
        monkeypatch.setattr(
            f"knobcam.show.{kind}.figure", lambda drawn, caption: f"<figure>{caption}</figure>"
        )


@pytest.fixture
def bench() -> Bench:
    """A workbench without its page."""
    return Bench()


@pytest.fixture
def client(bench: Bench) -> Iterator[httpx.Client]:
    """Who talks to the workbench's server, and has its token."""
    with served(bench) as client:
        yield client


@pytest.fixture
def opened(client: httpx.Client, bench: Bench, sprung: kc.Capture) -> httpx.Client:
    """The same where a capture is open."""
    bench.session.take(sprung, "sprung")
    return client


@pytest.fixture(autouse=True)
def _catalogue_as_it_was() -> Iterator[None]:
    """Effects that a test registers, or a page or an example in it, are gone after it."""
    before = set(kc.effects())
    yield
    for name in set(kc.effects()) - before:
        kc.forget_effect(name)


@pytest.fixture(autouse=True)
def _nothing_of_somebody_elses(
    tmp_path_factory: pytest.TempPathFactory, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Captures look for the calibration of their rig where the user keeps it: here nobody keeps one.

    Each test has the sessions of its own workbenches alone.
    """
    monkeypatch.setenv("XDG_STATE_HOME", str(tmp_path / "state"))
    monkeypatch.setenv("XDG_DATA_HOME", str(tmp_path_factory.getbasetemp() / "data"))
