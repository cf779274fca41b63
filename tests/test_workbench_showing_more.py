"""At the workbench: the motion that shows more of what has no name, recorded, and what is left then."""

from __future__ import annotations

from typing import Any

import pytest
from brake import braked, braked_knob
from small import COUPLINGS
from workbench_server import served

import knobcam as kc
from knobcam.base.said import Said
from knobcam.learn import designing
from knobcam.workbench import adding, trying
from knobcam.workbench.bench import Bench
from knobcam.workbench.tell import quiet


def test_a_motion_shows_more_of_what_has_no_name_and_its_recording_says_what_is_left(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    def search(first: kc.Fit, without: set[str], *more: Any, **how: Any) -> Any:
        return whole(first, without | set(COUPLINGS), *more, **how)

    whole = adding.Search
    monkeypatch.setattr(adding, "Search", search)
    # For a limit that would do; one is too narrow in any case.
    monkeypatch.setattr(designing, "_CHANGE_S", 0.5)
    bench = Bench()
    with served(bench) as client:
        bench.session.take(braked_knob(0.016, 1.3), "braked")
        bench.session.search()
        state = client.get("/api/state").json()
        assert state["record"] and state["shown_along"] and state["concluded"]
        assert client.post("/api/design", json={"effects": []}).status_code == 200
        found = client.get("/api/state").json()["experiment"]
        assert found["pairs"] == [] and len(found["rivals"]) == 1
        assert f"show more of what is left along {state['shown_along']}" in Said.of(found["promises"])
        design = bench.session.experiment
        assert design is not None
        track = design.track()
        trying.tried(
            bench.session, design, braked(kc.simulate("knob4", track), track, 0.016, 1.3), "2", quiet
        )
        state = client.get("/api/state").json()
        assert Said.of(state["experiment"]["verdict"]).startswith("With it: RMS error ")
        assert len(state["active"]) == 2
        answer = client.post("/api/design", json={"effects": [], "limits": {"duration_s": 0.1}})
        assert answer.status_code == 400 and "duration_s" in answer.json()["error"]
