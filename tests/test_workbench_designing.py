"""The next experiment at the workbench: designed, recorded from the same knob, told, and kept."""

from __future__ import annotations

import json
import runpy
import threading
import time
from pathlib import Path
from typing import Any

import httpx
import numpy as np
import pytest
from workbench_server import served, wrong

import knobcam as kc
from knobcam.base.said import Said
from knobcam.capture.motion_plan import MotionPlan
from knobcam.workbench import designed as designing
from knobcam.workbench import sources
from knobcam.workbench.bench import Bench
from knobcam.workbench.guard import HEADER

RIVALS = ["return_spring", "unbalance"]
SPRUNG = {"knob": "knob4", "effects": ["return_spring"], "motion": "sweep", "duration_s": 3.0}


@pytest.fixture(autouse=True)
def _quick(monkeypatch: pytest.MonkeyPatch) -> None:
    """A search of half a second is enough to be tested, and a fifth of the samples says the same."""

    def simulated(*knob: Any, **how: Any) -> kc.Capture:
        return kc.simulate(*knob, **({"rate_hz": 1000.0} if "duration_s" in how else {}) | how)

    searched(monkeypatch, 0.5)
    monkeypatch.setattr(sources, "simulate", simulated)


def searched(monkeypatch: pytest.MonkeyPatch, seconds: float) -> None:
    def searching(*given: Any, **options: Any) -> kc.Experiment:
        return kc.next_experiment(*given, search_s=seconds, **options)

    monkeypatch.setattr(designing, "next_experiment", searching)


def shown(client: httpx.Client) -> dict[str, Any]:
    state: dict[str, Any] = client.get("/api/state").json()
    return state


def columns(answer: httpx.Response) -> dict[str, np.ndarray]:
    line = answer.content.split(b"\n")[0]
    head = json.loads(line)
    floats = np.frombuffer(answer.content[-(-(len(line) + 1) // 4) * 4 :], dtype="<f4")
    return dict(zip(head["names"], floats.reshape(len(head["names"]), head["n"]), strict=True))


def post(client: httpx.Client, verb: str, **body: Any) -> httpx.Response:
    answer = client.post(f"/api/{verb}", json=body)
    assert answer.status_code == 200, answer.text
    return answer


def test_what_cannot_be_told_is_designed_for_recorded_from_the_same_knob_and_told(
    client: httpx.Client, bench: Bench, tmp_path: Path
) -> None:
    post(client, "simulate", **SPRUNG)
    assert shown(client)["experiment"] is None
    post(client, "design", effects=RIVALS)
    found = shown(client)["experiment"]
    assert (
        found["rivals"] == [[{"effect": one}] for one in RIVALS]
        and found["separable"]
        and found["source"] == "the simulated knob4"
    )
    assert found["seconds"] <= found["limits"]["duration_s"] and found["capture"] is None
    (pair,) = found["pairs"]
    assert pair["names"] == found["rivals"] and pair["d"] > 10.8 and pair["came"] is None
    assert sum(step["seconds"] for step in found["steps"]) == pytest.approx(found["seconds"])

    motion = columns(client.get("/api/motion", params={"experiment": found["id"]}))
    assert set(motion) == {"t", "theta", "omega", "rival 0", "rival 1"} and len(motion["t"]) <= 4000
    assert np.abs(motion["omega"]).max() <= found["limits"]["omega_rad_s"] * 1.001
    np.testing.assert_allclose(motion["rival 0"], -motion["rival 1"], atol=1e-8)
    assert np.abs(motion["rival 0"]).max() > 0.0

    file = client.get("/api/motion-file", params={"experiment": found["id"]})
    assert "motion.toml" in file.headers["content-disposition"]
    assert MotionPlan.parse(file.text).seconds == pytest.approx(found["seconds"])

    post(client, "try", experiment=found["id"])
    state = shown(client)
    assert [one["name"] for one in state["captures"]][1] == "knob4, simulated designed motion"
    assert state["active"] == ["c1", state["captures"][1]["id"]]
    assert "return_spring.k" in {one["name"] for one in state["params"]}
    told = state["experiment"]
    assert told["id"] == found["id"] and told["capture"] == "knob4, simulated designed motion"
    assert Said.of(told["verdict"]).startswith("return_spring explains all captures best; unbalance leaves ")
    assert told["pairs"][0]["came"] > 100.0

    script = tmp_path / "session.py"
    script.write_bytes(client.get("/api/download", params={"what": "script"}).content)
    made = runpy.run_path(str(script))["capture_2"]
    kept = bench.session.captures[state["captures"][1]["id"]].capture
    np.testing.assert_array_equal(made.tau, kept.tau)

    post(client, "use", captures=["c1"])
    assert shown(client)["experiment"]["id"] == found["id"]  # it was recorded of that knob
    post(client, "simulate", **{**SPRUNG, "knob": "knob3"})
    assert shown(client)["experiment"] is None


def test_the_model_becomes_that_of_who_was_right_and_can_be_taken_back(
    client: httpx.Client, bench: Bench
) -> None:
    post(client, "simulate", **SPRUNG)
    post(client, "add", effect="unbalance")
    before = shown(client)
    post(client, "design", effects=RIVALS)
    post(client, "try", experiment=shown(client)["experiment"]["id"])
    fit = bench.session.node.fit
    assert "return_spring" in fit.model.effects and "unbalance" not in fit.model.effects
    assert len(fit.prepared) == 2 and fit.rmse < 1.05 * fit.noise_floor
    assert bench.session.weigh().best is None
    for _ in range(3):
        post(client, "undo")
    assert shown(client)["node"] == before["node"] and shown(client)["params"] == before["params"]


def test_who_is_best_while_something_else_is_missing_too_is_not_taken_for_right(
    client: httpx.Client, bench: Bench
) -> None:
    hidden = ["return_spring", "quadratic_drag"]
    post(client, "simulate", knob="knob3", effects=hidden, motion="sweep", duration_s=3.0)
    post(client, "design", effects=RIVALS)
    post(client, "try", experiment=shown(client)["experiment"]["id"])
    state = shown(client)
    assert "something else is missing too, so add one" in Said.of(state["experiment"]["verdict"])
    assert not {"return_spring", "unbalance"} & set(bench.session.node.fit.model.effects)
    assert len(state["active"]) == 2


def test_a_motion_for_a_model_that_has_something_else_in_it_by_now_is_not_shown(client: httpx.Client) -> None:
    post(client, "simulate", **SPRUNG)
    post(client, "design", effects=RIVALS)
    found = shown(client)["experiment"]
    post(client, "add", effect="return_spring")
    assert shown(client)["experiment"] is None
    post(client, "undo")
    assert shown(client)["experiment"]["id"] == found["id"]


def test_where_nothing_is_tied_the_next_motion_is_for_what_is_known_least(
    client: httpx.Client, bench: Bench, tmp_path: Path
) -> None:
    post(client, "simulate", knob="knob2", effects=[], motion="sweep", duration_s=3.0)
    post(client, "design", effects=[])
    found = shown(client)["experiment"]
    assert found["pairs"] == [] and len(found["rivals"]) == 1
    assert "would be known" in Said.of(found["headline"])
    known = bench.session.node.fit.params
    param = next(word for word in Said.of(found["headline"]).split() if word in known)
    before = known[param].se
    motion = columns(client.get("/api/motion", params={"experiment": found["id"]}))
    assert np.abs(motion["rival 0"]).max() > 0.0
    post(client, "try", experiment=found["id"])
    state = shown(client)
    assert Said.of(state["experiment"]["verdict"]).startswith(f"{param} is known ")
    assert len(state["active"]) == 2 and bench.session.node.fit.params[param].se < before
    post(client, "undo")
    assert shown(client)["experiment"] is None and bench.session.node.fit.params[param].se == before
    post(client, "redo")
    assert shown(client)["experiment"] == state["experiment"]
    design = bench.session.designed(found["id"])
    again = designing.Designed.again(json.loads(json.dumps(design.record())))
    assert again.known == design.known and again.verdict == design.verdict
    assert again.verdict is not None and design.verdict is not None
    assert again.verdict.parts == design.verdict.parts
    # A journal of before has sentences as text.
    told = design.record() | {"headline": str(design.headline), "names": list(map(str, design.names))}
    del told["promise"]
    older = designing.Designed.again(json.loads(json.dumps(told)))
    assert older.headline == design.headline and older.names == design.names


@pytest.mark.usefixtures("undrawn")
def test_what_came_in_and_is_needless_beside_what_came_in_since_is_told_and_goes_by_a_button(
    client: httpx.Client, bench: Bench, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(sources, "simulate", kc.simulate)  # which others do as well takes all samples
    post(client, "simulate", **SPRUNG)
    for effect in ("unbalance", "return_spring"):
        post(client, "add", effect=effect)
        bench.session.weigh()
    both = shown(client)
    assert both["needless"] == ["unbalance"]
    # It is still in the model, but what is needless was not missing.
    said = "return_spring (or position_polynomial) was missing; with it the rest is chance."
    assert Said.of(both["concluded"]) == said and both["added"] == []
    report = client.get("/api/download", params={"what": "report"}).text.partition("<figure")[0]
    assert "was missing; with it the rest is chance." in report and "nbalance" not in report
    post(client, "drop", effect="unbalance")
    bench.session.weigh()
    state = shown(client)
    assert state["needless"] == [] and state["concluded"]
    assert [one["label"] for one in state["ladder"]][-1] == "+ return_spring"


def test_a_parameter_that_is_known_together_with_another_has_a_motion_of_its_own(
    client: httpx.Client,
) -> None:
    post(client, "simulate", **SPRUNG)
    post(client, "design", effects=[], sharpen="inertia.M", limits={"duration_s": 6.0})
    design = shown(client)["experiment"]
    assert design["promises"][0] == {"param": "inertia.M"} and design["pairs"] == []
    wrong(client.post("/api/design", json={"sharpen": "spring.k"}), 400, "is no parameter that was fitted")


def test_an_emulated_rig_is_recorded_from_with_the_same_knob_in_it(
    client: httpx.Client, bench: Bench, tmp_path: Path
) -> None:
    body = {"source": "emulated", "speed": 8.0, "folder": str(tmp_path), **SPRUNG}
    post(client, "record", **body)
    assert bench.recorder.live is not None and bench.recorder.live.ended.wait(60.0)
    post(client, "design", effects=RIVALS)
    found = shown(client)["experiment"]
    assert found["source"] == "an emulated rig with knob4"
    answer = post(client, "try", experiment=found["id"], folder=str(tmp_path), speed=8.0)
    log = Path(answer.json()["log"])
    assert log.name == "knob4-designed-1.kcwire" and bench.recorder.live.ended.wait(60.0)
    told = shown(client)["experiment"]
    assert told["capture"] == log.name and Said.of(told["verdict"]).startswith("return_spring explains all")
    motion = bench.session.designed(found["id"]).track()
    np.testing.assert_allclose(kc.load(log).theta[-len(motion.t) :], motion.theta, atol=1e-3)
    # By hand it is recorded for as long as a hand is led, and some more.
    again = post(client, "try", experiment=found["id"], folder=str(tmp_path), speed=8.0, by_hand=True)
    assert bench.recorder.live.ended.wait(60.0) and bench.recorder.live.failure is None
    by_hand = kc.load(again.json()["log"])
    assert by_hand.duration_s == pytest.approx(found["seconds"] + 6.0, abs=0.01)
    assert by_hand.meta["motion"]["name"] == "hand"
    assert by_hand.theta.max() == pytest.approx(motion.theta.max(), abs=2e-3)


def test_a_design_and_what_came_of_it_go_on_with_the_session(tmp_path: Path) -> None:
    root = tmp_path / "sessions"

    def as_kept(bench: Bench) -> dict[str, Any]:
        design = bench.session.experiment
        assert design is not None
        return design.record() | {"columns": {name: one.tolist() for name, one in design.columns().items()}}

    first = Bench(kept_in=root)
    with served(first) as client:
        post(client, "simulate", **SPRUNG)
        post(client, "design", effects=RIVALS)
        before = as_kept(first)
    second = Bench(kept_in=root)
    with served(second) as client:
        post(client, "continue", session="000001")
        assert as_kept(second) == before
        post(client, "try", experiment=before["id"])
        after, captures = as_kept(second), shown(client)["captures"]
        assert after["verdict"] is not None
    third = Bench(kept_in=root)
    with served(third) as client:
        post(client, "continue", session="000001")
        assert as_kept(third) == after and shown(client)["captures"] == captures


def test_a_design_is_cancelled_while_it_says_how_far_it_is(
    client: httpx.Client, bench: Bench, monkeypatch: pytest.MonkeyPatch
) -> None:
    post(client, "simulate", **SPRUNG)
    bench.session.weigh()
    searched(monkeypatch, 60.0)
    seen = []

    with httpx.Client(base_url=client.base_url, headers={HEADER: client.headers[HEADER]}) as other:

        def asks() -> None:
            answer = other.post("/api/design", json={"effects": RIVALS}, timeout=60.0)
            seen.append(answer)

        thread = threading.Thread(target=asks)
        thread.start()
        until = time.monotonic() + 30.0
        shares: list[float] = []
        while len(set(shares)) < 3 and time.monotonic() < until:
            told = shown(client)["job"]
            if told and told["what"] == ["looking for the motion"] and told["done"] is not None:
                shares.append(told["done"])
            time.sleep(0.05)
        assert post(client, "cancel").json()["cancelled"] is True
        thread.join(10.0)
        # Nor does it go on computing what nobody wants.
        until = time.monotonic() + 10.0
        while bench.work.busy and time.monotonic() < until:
            time.sleep(0.01)
        assert not bench.work.busy
    assert shares == sorted(shares) and len(set(shares)) == 3
    wrong(seen[0], 400, "cancelled; nothing was changed")
    assert shown(client)["experiment"] is None


@pytest.mark.parametrize(
    ("body", "words"),
    [
        ({"effects": "unbalance"}, "give a list"),
        ({"effects": ["unbalance"]}, "are not two"),
        ({"effects": ["unbalance", "nothing"]}, "nothing"),
        ({"effects": ["unbalance", "detent"]}, "part of the base model"),
        ({"effects": RIVALS, "limits": {"omega": 1.0}}, "is no limit"),
        ({"effects": RIVALS, "limits": {"omega_rad_s": "fast"}}, "give a number"),
        ({"effects": RIVALS, "limits": {"omega_rad_s": -1.0}}, "give a number above 0"),
        ({"effects": RIVALS, "limits": {"torque_Nm": 1e-7, "duration_s": 2.0}}, "torque_Nm"),
        ({"effects": RIVALS, "limits": [1]}, "give an object"),
    ],
)
def test_what_cannot_be_designed_is_one_line_and_changes_nothing(
    body: dict[str, Any], words: str, sprung_bench: tuple[httpx.Client, Bench]
) -> None:
    client, _ = sprung_bench
    before = shown(client)["experiment"]
    wrong(client.post("/api/design", json=body), 400, words)
    assert shown(client)["experiment"] == before


@pytest.fixture(scope="module")
def sprung_bench() -> Any:
    """A session with a capture that came as a file."""
    bench = Bench()
    with served(bench) as client:
        knob = kc.Model.load("knob4").with_effect("return_spring").with_value("return_spring.k", 0.004)
        bench.session.take(kc.simulate(knob, "sweep", duration_s=2.0, rate_hz=1000.0, seed=3), "sprung")
        yield client, bench


@pytest.mark.alone  # each wider limit has a part of three seconds to show what it is worth
def test_limits_that_are_too_narrow_are_answered_with_the_one_that_would_do(
    sprung_bench: tuple[httpx.Client, Bench], monkeypatch: pytest.MonkeyPatch
) -> None:
    client, _ = sprung_bench
    reached = shown(client)["limits"]
    assert reached["omega_rad_s"] == pytest.approx(0.93, rel=0.01) and reached["sample_rate_hz"] == 1000.0
    for given, named in ((0.0024, RIVALS), (0.0016, [])):
        refused = client.post("/api/design", json={"effects": named, "limits": {"torque_Nm": given}})
        assert refused.status_code == 400 and "limits, torque_Nm: " in refused.json()["error"]
        enough = refused.json()["enough"]
        assert enough["limit"] == "torque_Nm" and 2.0 * given < enough["to"] < 0.013
        post(client, "design", effects=named, limits={enough["limit"]: enough["to"]})
    # Over so short a way a larger unbalance is a spring: more torque alone tells nothing.
    post(client, "design", effects=RIVALS, limits={"torque_Nm": 0.024})
    found = shown(client)["experiment"]
    assert not found["separable"] and found["change"]["limit"] == "theta_max_rad"
    end = found["change"]["to"]
    wider = {"theta_min_rad": reached["theta_min_rad"] + reached["theta_max_rad"] - end, "theta_max_rad": end}
    searched(monkeypatch, 10.0)  # it ends where it has enough; half a second may not do on a busy machine
    post(client, "design", effects=RIVALS, limits={"torque_Nm": 0.024, **wider})
    again = shown(client)["experiment"]
    assert again["separable"] and again["change"] is None


def test_of_a_file_nobody_knows_the_knob_and_a_port_is_asked_for(
    sprung_bench: tuple[httpx.Client, Bench], tmp_path: Path
) -> None:
    client, _ = sprung_bench
    post(client, "design", effects=RIVALS)
    found = shown(client)["experiment"]
    assert found["source"] is None
    wrong(client.post("/api/try", json={"experiment": found["id"]}), 400, "name the port of the rig")
    wrong(client.post("/api/try", json={"experiment": "e999"}), 400, "is not in this session")
    body = {"experiment": found["id"], "port": "/dev/no_such_rig", "folder": str(tmp_path)}
    wrong(client.post("/api/try", json=body), 400, "no such port")
    assert len(shown(client)["captures"]) == 1
    wrong(client.get("/api/motion", params={"experiment": "e999"}), 400, "is not in this session")
    body = {"effects": RIVALS, "limits": {"duration_s": 3.0, "omega_rad_s": 1.5}}
    post(client, "design", **body)
    again = shown(client)["experiment"]
    assert again["seconds"] <= 3.0 and again["limits"]["omega_rad_s"] == 1.5
