"""Effects that a person adds one by one end where a search for all ends, and come again as they came."""

from __future__ import annotations

import functools
import json
import runpy
from pathlib import Path

import pytest
from small import COUPLINGS

import knobcam as kc
from knobcam.base.strict_json import as_json
from knobcam.workbench import challenge, kept, saving, sources, state
from knobcam.workbench.session import Session
from knobcam.workbench.sources import Simulated
from knobcam.workbench.tell import quiet


@pytest.fixture(autouse=True)
def _fewer_samples(monkeypatch: pytest.MonkeyPatch) -> None:
    """At 2 kHz the same shows."""
    monkeypatch.setattr(sources, "simulate", functools.partial(kc.simulate, rate_hz=2000.0))


def test_two_hidden_effects_leave_the_noise_alone_whichever_is_added_first(tmp_path: Path) -> None:
    # Alone, friction that rises towards standstill takes the shape of the drag over all speeds.
    _, hidden, seed = next(one for one in challenge.levels()["hard"] if "stribeck" in one[1])
    capture = Simulated("knob4", hidden, "sweep", challenge.SECONDS, seed).capture()
    path = capture.save(tmp_path / "knob.npz")
    for first, then in (hidden, hidden[::-1]):
        session = Session()
        session.open(str(path))
        session.add(first)
        session.add(then)
        fit = session.node.fit
        assert fit.compare().complete and fit.rmse < 1.01 * fit.noise_floor, first
        script = saving.save(session, "script", tmp_path / f"{first}.py", quiet)
        assert runpy.run_path(str(script))["fit"].model.text() == fit.model.text()
        record = kept.of_node(session.node, None)["node"]
        assert record["again"] == (first if first == "stribeck" else None)


def test_detents_that_show_beside_two_effects_alone_come_along_as_they_do_in_a_search(tmp_path: Path) -> None:
    knob, hidden, seed = next(one for one in challenge.levels()["hard"] if one[0] == "knob3")
    path = Simulated(knob, hidden, "sweep", challenge.SECONDS, seed).capture().save(tmp_path / "knob.npz")
    at_once = kc.learn(path, without=COUPLINGS).fit
    assert "detent" in at_once.model.effects
    for order in (hidden, hidden[::-1]):
        session = Session()
        session.open(str(path))
        session.add(order[0])
        assert "detent" not in session.node.fit.model.effects
        session.add(order[1])
        fit = session.node.fit
        assert fit.rmse == pytest.approx(at_once.rmse, rel=1e-6) and fit.compare().complete
        (*_, step) = json.loads(as_json(state.document(session)))["branches"][0]["steps"]
        assert (step["added"], step["along"]) == (order[1], ["detent"])
        script = saving.save(session, "script", tmp_path / f"{order[0]}.py", quiet)
        assert runpy.run_path(str(script))["fit"].model.text() == fit.model.text()
    # Whoever takes them out has no detents, whatever comes in next.
    session.drop("detent")
    session.add("offset")
    assert "detent" not in session.node.fit.model.effects
