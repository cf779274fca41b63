"""Findings of the quality check that a person overrules: in a call, on the command line, at the workbench."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from command import knobcam, refused
from test_bands import pendulum
from test_logs_held import spoiled
from workbench_server import served, wrong

import knobcam as kc
from knobcam.errors import InputError
from knobcam.workbench import script, state
from knobcam.workbench.bench import Bench

SPIKE = 3000


@pytest.fixture(scope="module")
def log(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A log whose angle wraps, whose torque leaps for one row and is clipped."""
    rng = np.random.default_rng(1)
    t = np.arange(6000) / 1000.0
    theta = 3.0 + 4.0 * np.sin(2.0 * t) + 1e-4 * rng.standard_normal(len(t))
    omega, alpha = 8.0 * np.cos(2.0 * t), -16.0 * np.sin(2.0 * t)
    tau = 1e-3 * alpha + 0.01 * omega + 0.02 * np.sign(omega) + 1e-3 * rng.standard_normal(len(t))
    tau[SPIKE] += 1.0
    columns = np.c_[t, np.mod(theta, 2.0 * np.pi), tau]
    path = tmp_path_factory.mktemp("logs") / "log.csv"
    np.savetxt(path, columns, delimiter=",", header="t_s,theta_rad,tau_Nm", comments="")
    return path


def test_an_overruled_mask_counts_its_samples_and_an_overruled_mend_leaves_them_as_recorded(
    log: Path,
) -> None:
    plain = kc.load(log)
    assert [one.key for one in plain.findings] == ["wrap:theta", "spike:tau"]
    counted = kc.load(log, overrule=["spike:tau"])
    assert not plain.mask[SPIKE] and counted.mask.all()
    assert [one.severity for one in counted.findings] == ["mended", "note"]
    wrapped = kc.load(log, overrule=["wrap:theta"])
    assert np.ptp(plain.theta) > 7.9 and np.ptp(wrapped.theta) < 2.0 * np.pi
    spike = plain.findings[1]
    assert plain.where(spike) == [(SPIKE, SPIKE)]
    part = kc.load(log, start=1.0)
    assert part.where(part.findings[-1]) == [(SPIKE - 1000, SPIKE - 1000)]


def test_of_a_saved_capture_what_was_masked_can_be_overruled_and_what_was_mended_cannot(
    log: Path, tmp_path: Path
) -> None:
    saved = kc.load(log).save(tmp_path / "saved.npz")
    again = kc.load(saved, overrule=["spike:tau"])
    assert again.mask.all() and again.overrules("spike", "tau")
    assert kc.load(again.save(tmp_path / "again.npz")).overrules("spike", "tau")
    part = kc.load(saved, start=2.0, overrule=["spike:tau"])
    assert part.mask.all() and part.overrules("spike", "tau")
    later = kc.load(kc.load(log, start=1.0).save(tmp_path / "later.npz"), overrule=["spike:tau"])
    assert later.mask.all() and later.where(later.findings[-1]) == [(SPIKE - 1000, SPIKE - 1000)]
    with pytest.raises(InputError, match=r"wrap:theta was mended before .* --overrule wrap:theta"):
        kc.load(saved, overrule=["wrap:theta"])


def test_a_finding_that_is_not_there_or_stands_is_refused(log: Path, tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"'stale:tau' is not among .*: wrap:theta, spike:tau"):
        kc.load(log, overrule=["stale:tau"])
    lines = log.read_text().splitlines()
    lines[10] = lines[10].rsplit(",", 1)[0] + ",nan"
    holed = tmp_path / "holed.csv"
    holed.write_text("\n".join(lines))
    with pytest.raises(InputError, match="non-finite:tau cannot be overruled: what is no number"):
        kc.load(holed, overrule=["non-finite:tau"])


def test_a_reading_that_stands_counts_anew_where_a_person_says_so() -> None:
    capture = kc.simulate("knob4", "sweep", duration_s=1.0)
    held = capture.tau[np.arange(capture.samples) // 4 * 4]
    columns = {"t": capture.t, "theta": capture.theta, "omega": capture.omega, "tau": held}
    slow = kc.Capture.from_arrays(**columns)
    assert [one.key for one in slow.findings] == ["held:tau"]
    anew = kc.Capture.from_arrays(**columns, overrule=["held:tau"])
    assert len(anew.prepare().rows) > 3 * len(slow.prepare().rows)


def arrays(capture: kc.Capture) -> dict[str, object]:
    names = [name for name in ("t", "theta", "omega", "alpha", "tau") if name in capture.columns]
    return {name: capture.columns[name] for name in names}


def test_what_the_preparation_finds_is_told_and_left_as_it_is_where_a_person_overrules_it() -> None:
    shaken = pendulum(0.02)
    (band,) = [one for one in shaken.prepare().findings if one.key == "band:theta"]
    assert band.severity == "mended"
    trusted = kc.Capture.from_arrays(**arrays(shaken), overrule=["band:theta"])
    (told,) = [one for one in trusted.prepare().findings if one.key == "band:theta"]
    assert told.overruled and told.severity == "note" and told.count > band.count
    edges = [one.prepare().core.edge_hz for one in (shaken, trusted)]
    assert edges[1] > 1.5 * edges[0]
    # What is not there after all is said not to be looked for, and changes nothing.
    calm = kc.Capture.from_arrays(**arrays(pendulum()), overrule=["band:theta"])
    assert [one.key for one in calm.findings if one.overruled] == ["band:theta"]
    np.testing.assert_array_equal(calm.prepare().theta, pendulum().prepare().theta)


def test_a_reading_that_all_others_contradict_counts_where_a_person_says_so() -> None:
    capture = kc.simulate("knob4", "sweep", duration_s=1.0)
    theta = capture.theta.copy()
    theta[2500] += 0.004
    columns = {**arrays(capture), "theta": theta}
    key = "spike:theta"
    found = [one for one in kc.Capture.from_arrays(**columns).prepare().findings if one.key == key]
    assert len(found) == 1
    assert kc.Capture.from_arrays(**columns).where(found[0]) == [(2500, 2500)]
    trusted = kc.Capture.from_arrays(**columns, overrule=[key])
    told = [one for one in trusted.prepare().findings if one.key == key]
    assert [one.overruled for one in told] == [True]
    away = [abs(one.prepare().theta[2500] - capture.theta[2500]) for one in (trusted, capture)]
    assert away[0] > 3.0 * away[1]


def test_a_torque_that_is_ahead_keeps_its_time_where_a_person_overrules_that(tmp_path: Path) -> None:
    ahead = spoiled("torque ahead 5 rows", "multisine")
    assert "actuation_delay" in kc.fit(ahead).model.effects
    saved = ahead.save(tmp_path / "ahead.npz")
    kept = kc.load(saved, overrule=["late_column:tau"])
    fit = kc.fit(kept)
    assert "actuation_delay" not in fit.model.effects and fit.ahead is not None
    assert fit.ahead.overruled and fit.ahead.message not in fit.warnings
    with served(Bench()) as client:
        client.post("/api/open", json={"path": str(saved)})
        (first,) = client.get("/api/state").json()["captures"]
        told = {one["key"]: one for one in first["findings"]}["late_column:tau"]
        assert not told["overruled"] and told["severity"] == "mended" and told["stands"] == ""
        asked = {"capture": first["id"], "finding": "late_column:tau", "on": True}
        assert client.post("/api/overrule", json=asked).is_success
        state = client.get("/api/state").json()
        (second,) = state["captures"]
        keys = [one["key"] for one in second["findings"] if one["overruled"]]
        assert keys == ["late_column:tau"]
        assert not any(one["name"].startswith("actuation_delay") for one in state["params"])
        client.post("/api/overrule", json={**asked, "capture": second["id"], "on": False})
        state = client.get("/api/state").json()
        assert any(one["name"].startswith("actuation_delay") for one in state["params"])


def test_the_command_line_overrules_what_the_call_does(log: Path, tmp_path: Path) -> None:
    told = knobcam("import", log, "-o", tmp_path / "c.npz", "--overrule", "spike:tau", "--json").document
    found = {one["kind"]: one for one in told["findings"]}
    assert found["spike"]["overruled"] and found["spike"]["done"] == "none"
    assert found["wrap"]["done"] == "mended" and not found["wrap"]["overruled"]
    assert kc.load(tmp_path / "c.npz").mask.all()
    refused(knobcam("fit", log, "--overrule", "wrap:tau"), "is not among what was found")


def test_the_session_refits_undo_finds_the_fit_before_and_it_goes_on_so(log: Path, tmp_path: Path) -> None:
    own = tmp_path / "own.csv"
    own.write_bytes(log.read_bytes())
    bench = Bench(kept_in=tmp_path / "sessions")
    with served(bench) as client:
        client.post("/api/open", json={"path": str(own)})
        before = client.get("/api/state").json()
        (first,) = before["captures"]
        assert [(one["key"], one["overruled"]) for one in first["findings"]] == [
            *{"wrap:theta": False, "spike:tau": False}.items()
        ]
        found = client.get("/api/finding", params={"capture": first["id"], "finding": "spike:tau"})
        assert found.json() == {"runs": [[SPIKE, SPIKE]]}
        asked = {"capture": first["id"], "finding": "spike:tau", "on": True}
        assert client.post("/api/overrule", json=asked).is_success
        after = client.get("/api/state").json()
        (second,) = after["captures"]
        assert second["name"] == first["name"] and second["id"] != first["id"]
        assert {one["key"]: one["overruled"] for one in second["findings"]}["spike:tau"]
        assert after["rmse"] > 2.0 * before["rmse"]
        client.post("/api/undo")
        back = client.get("/api/state").json()
        assert (back["rmse"], back["captures"]) == (before["rmse"], before["captures"])
        client.post("/api/redo")
        client.post("/api/overrule", json={"capture": second["id"], "finding": "spike:tau", "on": False})
        again = client.get("/api/state").json()
        assert again["rmse"] == before["rmse"] and len(again["captures"]) == 1
        wrong(
            client.post("/api/overrule", json={**asked, "finding": "x:t"}), 400, "is not among what was found"
        )
        wrong(
            client.get("/api/finding", params={"capture": "c9", "finding": "x"}), 400, "not in this session"
        )
        client.post("/api/undo")
        own.write_bytes(log.read_bytes() + b"\n")
        wrong(client.post("/api/overrule", json=asked), 400, "has changed since it was read")
        own.write_bytes(log.read_bytes())
        made = script.script(bench.session.branch.done, bench.session.captures, bench.session.start)
        assert "overrule=['spike:tau']" in made
    bench = Bench(kept_in=tmp_path / "sessions")
    try:
        bench.go_on("000001", lambda *_, **__: None)
        told = state.document(bench.session)
        assert len(told["captures"]) == 1 and told["rmse"] == after["rmse"]
    finally:
        bench.close()


def test_what_the_browser_handed_over_is_read_again_from_where_it_is_kept(log: Path, tmp_path: Path) -> None:
    bench = Bench(kept_in=tmp_path / "sessions")
    with served(bench) as client:
        client.post("/api/upload", content=log.read_bytes(), headers={"x-filename": "log.csv"})
        (only,) = client.get("/api/state").json()["captures"]
        asked = {"capture": only["id"], "finding": "wrap:theta"}
        assert client.post("/api/overrule", json=asked).is_success
        assert len(client.get("/api/state").json()["captures"]) == 1
    with served(Bench()) as client:
        client.post("/api/upload", content=log.read_bytes(), headers={"x-filename": "log.csv"})
        (only,) = client.get("/api/state").json()["captures"]
        wrong(client.post("/api/overrule", json={**asked, "capture": only["id"]}), 400, "open it by its path")
