"""A session survives its workbench: journalled as it changes, offered again, never with another file."""

from __future__ import annotations

import json
import os
import random
import signal
import stat
import time
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import asdict
from pathlib import Path
from typing import Any

import httpx
import pytest
from command import knobcam, refused
from workbench_server import served, started, wrong

import knobcam as kc
from knobcam.errors import InputError
from knobcam.workbench import challenge, journal, kept, saving
from knobcam.workbench.bench import Bench
from knobcam.workbench.journal import Journal
from knobcam.workbench.sources import Simulated
from knobcam.workbench.tell import quiet
from knobcam.workbench.tree import Start


@pytest.fixture
def root(tmp_path: Path) -> Path:
    return tmp_path / "sessions"


@pytest.fixture
def small(tmp_path: Path) -> Path:
    return kc.simulate("knob4", "sweep", duration_s=1.0).save(tmp_path / "small.npz")


def deeds(bench: Bench, path: Path) -> None:
    """A little of everything that a session can hold."""
    session = bench.session
    session.open(str(path), end=0.9)
    session.add("quadratic_drag")
    session.fork("aside")
    session.drop("quadratic_drag")
    session.undo()
    session.drag({"viscous.pos": 0.01})
    session.look({"view": {"isolated": True, "band": False, "held": True}, "beside": None, "brush": None})


def shown(bench: Bench) -> dict:
    """What a person sees of a session, without what goes on in it."""
    document = dict(bench.document())
    for name in ("revision", "job", "candidates", "verdict", "node", "left"):
        document.pop(name)
    return document


@contextmanager
def kept_in(root: Path, *opened: Path) -> Iterator[Bench]:
    """A workbench that keeps its session in a folder, with some captures open; closed at the end."""
    bench = Bench(kept_in=root)
    try:
        for path in opened:
            bench.session.open(str(path))
        yield bench
    finally:
        bench.close()


@contextmanager
def continued(root: Path, name: str = "000001") -> Iterator[Bench]:
    """A workbench in which a session that was left goes on."""
    with kept_in(root) as bench:
        bench.go_on(name, quiet)
        yield bench


def written(bench: Bench) -> None:
    """Wait until all that was done is in the journal."""
    assert bench.keeper is not None
    while bench.keeper._woken.is_set():
        time.sleep(0.0005)


def crashed(bench: Bench) -> None:
    """Let go of a session as a process does that is killed: nothing more is written."""
    keeper = bench.keeper
    assert keeper is not None
    bench.keeper = None
    keeper._closing = True
    keeper.wake()
    keeper._thread.join()
    assert keeper._journal is not None
    keeper._journal.close()
    bench.close()


def test_a_session_goes_on_as_it_was_left_to_the_last_bit(root: Path, small: Path) -> None:
    first = Bench(Start(options={"prepare": "paper"}), root)
    deeds(first, small)
    before, model = shown(first), first.session.view.model.text()
    crashed(first)
    second = Bench(kept_in=root)
    (left,) = second.document()["left"]
    assert (left["captures"], left["steps"], left["ended"]) == (["small.npz"], 3, False)
    second.go_on(left["id"], quiet)
    assert shown(second) == before
    assert second.session.view.model.text() == model
    assert second.document()["left"] == []
    second.session.redo()
    second.session.snap()
    second.session.add("stribeck")
    assert len({*second.session.nodes}) == len(second.session.nodes) == 4
    crashed(second)
    with continued(root, Bench(kept_in=root).document()["left"][0]["id"]) as third:
        assert third.session.node.fit.model.effects == second.session.node.fit.model.effects


def test_detents_that_came_along_are_there_in_a_session_that_goes_on(root: Path) -> None:
    knob, hidden, seed = next(one for one in challenge.levels()["hard"] if one[0] == "knob3")
    with kept_in(root) as first:
        simulated = Simulated(knob, hidden, "sweep", challenge.SECONDS, seed)
        first.session.take(simulated.capture(), "knob", simulated=asdict(simulated))
        for effect in hidden:
            first.session.add(effect)
        assert first.session.node.along == ("detent",)
        before = first.session.node.fit.model.text()
    with continued(root) as second:
        assert second.session.node.along == ("detent",)
        assert second.session.node.fit.model.text() == before


def test_what_was_simulated_or_handed_over_goes_on_without_a_file(root: Path, small: Path) -> None:
    first = Bench(kept_in=root)
    with served(first) as client:
        client.post("/api/upload", content=small.read_bytes(), headers={"x-filename": "mine.npz"})
        body = {
            "knob": "knob4",
            "duration_s": 4.0,
            "seed": 3,
            "surprise": False,
            "effects": ["return_spring"],
        }
        assert client.post("/api/simulate", json=body).status_code == 200
        before = shown(first)
    small.unlink()
    with kept_in(root) as second:
        assert second.document()["left"][0]["ended"]
        second.go_on(second.document()["left"][0]["id"], quiet)
        assert shown(second) == before
        assert [one.hidden for one in second.session.captures.values()] == [(), ("return_spring",)]


def test_a_challenge_that_goes_on_has_the_score_that_it_had(root: Path) -> None:
    with kept_in(root) as first:
        hidden = Simulated("knob4", ("return_spring",), "sweep", 2.0, 3, level="easy")
        origin = {"simulated": asdict(hidden), "hidden": hidden.hidden}
        capture = first.session.take(hidden.capture(), "a knob", **origin)
        challenge.hint(first.session, capture, whole=False)
        first.session.add("quadratic_drag")  # is not there, and nothing of it stays in the branch
        first.session.undo()
        first.session.add("return_spring")
        before = challenge.standing(first.session, capture)
        assert (len(before["hints"]), before["wrong"], before["score"]) == (1, ["quadratic_drag"], 75)
    with continued(root) as second:
        assert challenge.standing(second.session, capture) == before


@pytest.mark.parametrize("change", ["gone", "another"])
def test_a_file_that_is_gone_or_another_is_said_and_its_model_is_kept(
    root: Path, small: Path, change: str
) -> None:
    other = kc.simulate("knob3", "sweep", duration_s=1.0).save(small.with_name("other.npz"))
    with kept_in(root, small) as first:
        first.session.add("quadratic_drag")
        first.session.fork("aside")
        first.session.open(str(other), together=False)
        lost = first.session.node.fit.model.text()
    there = other.read_bytes()
    other.unlink() if change == "gone" else other.write_bytes(small.read_bytes())
    with continued(root) as second:
        assert [one.name for one in second.session.captures.values()] == ["small.npz"]
        said = second.document()["notes"]
        assert "other.npz" in said[0] and ("not there" if change == "gone" else "has changed") in said[0]
        assert (root / "000001" / "model-b5.toml").read_text() == lost
        assert all("model-b5.toml" in one for one in said[1:]) and len(said) == 2
    other.write_bytes(there)
    with continued(root) as third:
        assert len(third.session.captures) == 2 and third.document()["notes"] == []


def test_of_a_session_whose_only_file_is_gone_nothing_goes_on(root: Path, small: Path) -> None:
    with kept_in(root, small):
        pass
    small.unlink()
    with kept_in(root) as second:
        with pytest.raises(InputError, match=r"small\.npz: is not there any more; put it back"):
            second.go_on("000001", quiet)
        assert [one["id"] for one in second.document()["left"]] == ["000001"]


def test_wherever_a_journal_is_cut_its_session_goes_on_without_the_last_action_at_most(
    root: Path, small: Path
) -> None:
    with kept_in(root, small) as bench:
        for name in ("one", "two", "three"):
            bench.session.fork(name)
            written(bench)
    path = root / "000001" / "journal"
    whole = path.read_bytes()
    lines = whole.splitlines(keepends=True)
    rng = random.Random(time.time_ns())
    for _ in range(30):
        cut = rng.randrange(len(lines[0]) + 1, len(whole))
        path.write_bytes(whole[:cut])
        there = len(whole[:cut].splitlines(keepends=True)) - (whole[cut - 1 : cut] != b"\n")
        assert journal.read(path.parent) == [json.loads(line[9:]) for line in lines[:there]]
        with Journal.taken(path.parent) as again:
            again.append([{"ended": True}])
        assert journal.read(path.parent)[-1] == {"ended": True}
        assert len(journal.read(path.parent)) == there + 1


@pytest.mark.parametrize(
    "content",
    [
        b"",
        b"\n",
        b"not a journal at all",
        b"\x00" * 5000,
        journal.line({"schema": "knobcam.session/99"}),
        journal.line({"schema": journal.SCHEMA}),
        journal.line({"schema": journal.SCHEMA, "start": 3}) + journal.line({"place": {"branches": [3]}}),
        journal.line({"schema": journal.SCHEMA, "start": {}})
        + b"00000000 {}\n"
        + journal.line({"ended": True}),
    ],
)
def test_a_journal_that_is_damaged_or_foreign_is_one_line(root: Path, small: Path, content: bytes) -> None:
    folder = root / "000007"
    folder.mkdir(parents=True)
    (folder / "journal").write_bytes(content)
    with kept_in(root) as bench:
        (left,) = bench.document()["left"]
        assert left["wrong"] is not None and "\n" not in left["wrong"] and str(folder) in left["wrong"]
        with pytest.raises(InputError, match="000007"):
            bench.go_on("000007", quiet)
        for name in ("000008", "../000007", "", "\0"):
            with pytest.raises(InputError, match="there is none"):
                bench.go_on(name, quiet)
        bench.session.open(str(small))
    assert (root / "000008" / "journal").exists()


def test_two_workbenches_never_share_a_journal(root: Path, small: Path) -> None:
    one = Bench(kept_in=root)
    with kept_in(root) as other, kept_in(root) as third:
        for bench in (one, other):
            bench.session.open(str(small))
        while len(journal.sessions(root)) < 2:
            time.sleep(0.01)
        assert third.document()["left"] == []
        with pytest.raises(InputError, match="goes on in another workbench"):
            third.go_on("000001", quiet)
        one.close()
        third.go_on("000001", quiet)


def test_a_session_that_has_begun_is_not_replaced_by_another(root: Path, small: Path) -> None:
    with kept_in(root, small):
        pass
    with kept_in(root, small) as second:
        node = second.session.node
        with pytest.raises(InputError, match="open here already"):
            second.go_on("000001", quiet)
        assert second.session.node is node


def test_what_is_kept_is_for_its_user_alone_and_old_sessions_go(root: Path, small: Path) -> None:
    os.umask(os.umask(0o022))
    for _ in range(12):
        with kept_in(root, small):
            pass
    kept_there = journal.sessions(root)
    assert [one.name for one in kept_there] == [f"{number:06d}" for number in range(12, 3, -1)]
    for path in (root, *root.rglob("*")):
        private = 0o700 if path.is_dir() else 0o600
        assert stat.S_IMODE(path.stat().st_mode) == private, path


def test_a_long_session_has_no_long_journal(root: Path, small: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(journal, "_COMPACT_BYTES", 20_000)
    with kept_in(root, small) as bench:
        for turn in range(400):
            bench.session.drag({"viscous.pos": 0.001 * (turn + 1)})
            written(bench)
    path = root / "000001" / "journal"
    assert path.stat().st_size < 60_000
    assert stat.S_IMODE(path.stat().st_mode) == 0o600
    told = kept.Told.of(path.parent)
    assert told.place["branches"][0]["dragged"] == {"viscous.pos": 0.4} and told.ended


def test_where_nothing_can_be_written_the_session_goes_on_and_says_so(tmp_path: Path, small: Path) -> None:
    (tmp_path / "taken").write_text("a file")
    with kept_in(tmp_path / "taken" / "sessions", small) as bench:
        deadline = time.monotonic() + 10.0
        while not bench.document()["notes"] and time.monotonic() < deadline:
            time.sleep(0.01)
        (said,) = bench.document()["notes"]
        assert "so the session is not kept" in said
        bench.session.add("quadratic_drag")


def test_whoever_starts_anew_is_not_asked_again(root: Path, small: Path) -> None:
    with kept_in(root, small):
        pass
    second = Bench(kept_in=root)
    with served(second) as client:
        (left,) = client.get("/api/state").json()["left"]
        assert client.post("/api/anew").status_code == 200
        assert client.get("/api/state").json()["left"] == []
        wrong(client.post("/api/continue", json={"session": "../x"}), 400, "there is none")
    with kept_in(root) as third:
        assert third.document()["left"] == []
        third.go_on(left["id"], quiet)  # it is there all the same
    assert len(Bench(kept_in=root).document()["left"]) == 1


def test_the_page_is_told_how_it_looked(client: httpx.Client) -> None:
    view = {"axes": ["history", "velocity", "load"], "isolated": True, "band": True, "held": False}
    looked: dict[str, Any] = {"view": view, "beside": "b2"}
    looked["brush"] = {"plot": 3, "x": [0.0, 1.5], "y": [-1.0, 1.0]}
    assert client.post("/api/look", json=looked).status_code == 200
    assert client.get("/api/state").json()["looked"] == looked
    for spoiled in (
        {"view": 3},
        *(
            {"view": view | {"axes": axes}}
            for axes in ("time", ["time"], ["time", "mass", "load"], [1, 2, 3])
        ),
        {"brush": {"plot": -1}},
        {"brush": {"plot": 0, "x": [1], "y": [0, 1]}},
        {"beside": 3},
    ):
        wrong(client.post("/api/look", json=looked | spoiled), 400, "")
    assert client.get("/api/state").json()["looked"] == looked
    # A session of before there were axes to choose.
    assert client.post("/api/look", json=looked | {"view": {"band": True}}).status_code == 200
    usual = {"axes": ["position", "velocity", "time"], "isolated": False, "band": True, "held": True}
    assert client.get("/api/state").json()["looked"]["view"] == usual


def test_a_session_survives_kill_9(small: Path) -> None:
    with started(small) as (client, process):
        client.post("/api/add", json={"effect": "quadratic_drag"})
        client.post("/api/branch", json={"name": "last"})
        before = client.get("/api/state").json()
        process.send_signal(signal.SIGKILL)
    with started() as (client, process):
        (left,) = client.get("/api/state").json()["left"]
        assert (left["ended"], left["captures"]) == (False, ["small.npz"])
        process.send_signal(signal.SIGINT)
        assert process.wait(20.0) == 0
        assert (
            process.stderr is not None and "a session broke off (small.npz; fits: 2)" in process.stderr.read()
        )
    with started("--continue") as (client, process):
        after = client.get("/api/state").json()
        assert after["params"] == before["params"]
        assert after["branches"] == before["branches"]
        process.send_signal(signal.SIGTERM)
        assert process.wait(20.0) == 143
        assert process.stderr is not None and process.stderr.read() == "knobcam: ended by SIGTERM\n"


def test_the_command_says_what_cannot_be_continued(small: Path) -> None:
    refused(knobcam("workbench", "--no-browser", "--continue"), "no session that was left")
    refused(knobcam("workbench", "--no-browser", "--continue", small), "leave others out")


def test_the_script_of_a_session_that_goes_on_is_what_it_was(root: Path, small: Path, tmp_path: Path) -> None:
    with kept_in(root) as first:
        deeds(first, small)
        before = saving.save(first.session, "script", tmp_path / "before.py", quiet).read_text()
    with continued(root) as second:
        assert saving.save(second.session, "script", tmp_path / "after.py", quiet).read_text() == before
