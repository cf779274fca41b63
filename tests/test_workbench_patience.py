"""Nothing at the workbench waits for what does not come, and nothing is done twice or for nobody."""

from __future__ import annotations

import asyncio
import os
import socket
import threading
import time
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from contextlib import ExitStack
from pathlib import Path
from typing import Any

import httpx
import pytest
from faults_page import is_over
from workbench_server import TOKEN, UPLOAD_BYTES, wrong

from knobcam.workbench import bodies, patience, saving, server
from knobcam.workbench.bench import Bench
from knobcam.workbench.guard import HEADER
from knobcam.workbench.jobs import Cancelled, Job, Worker

STALLS = [
    b"",
    b"GET / HT",
    b"POST /api/add HTTP/1.1\r\nhost: 127.0.0.1:{port}\r\n",
    b"POST /api/add HTTP/1.1\r\nhost: 127.0.0.1:{port}\r\n{token}\r\ncontent-length: 20\r\n\r\n",
    b"POST /api/undo HTTP/1.1\r\nhost: 127.0.0.1:{port}\r\n{token}\r\ncontent-length: 9\r\n\r\n{",
    b"POST /api/upload HTTP/1.1\r\nhost: 127.0.0.1:{port}\r\n{token}\r\n"
    b"transfer-encoding: chunked\r\n\r\n5\r\nabcde\r\n",
]


def stalled(port: int, kind: int) -> socket.socket:
    one = socket.create_connection(("127.0.0.1", port))
    one.settimeout(20.0)  # longer than any test should need
    raw = STALLS[kind % len(STALLS)].replace(b"{port}", str(port).encode())
    one.sendall(raw.replace(b"{token}", f"{HEADER}: {TOKEN}".encode()))
    return one


def eventually(holds: Callable[[], bool]) -> bool:
    deadline = time.monotonic() + 20.0
    while not holds() and time.monotonic() < deadline:
        time.sleep(0.01)
    return holds()


def test_600_connections_that_never_send_their_body_go_and_keep_nobody_waiting(
    opened: httpx.Client, monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    monkeypatch.setattr(patience, "HEAD_S", 1.0)
    port = opened.base_url.port
    assert port is not None
    with ExitStack() as stack:
        waiting = [stack.enter_context(stalled(port, kind)) for kind in range(600)]
        assert opened.post("/api/add", json={"effect": "return_spring"}).status_code == 200
        saved = opened.post("/api/save", json={"what": "model", "path": str(tmp_path / "m.toml")})
        assert saved.status_code == 200
        assert all(is_over(one) for one in waiting)


def test_a_body_that_drips_is_not_waited_for(client: httpx.Client, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(patience, "HEAD_S", 0.5)
    port = client.base_url.port
    assert port is not None
    with stalled(port, 3) as one:
        one.settimeout(0.2)
        for _ in range(100):
            try:
                one.sendall(b" ")
                if not one.recv(100):
                    break
            except TimeoutError:
                continue
            except OSError:
                break
        else:
            pytest.fail("a byte now and then keeps a connection for ever")


def test_of_too_many_connections_the_one_goes_that_was_waited_for_longest(
    opened: httpx.Client, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(patience, "MOST", 8)
    port = opened.base_url.port
    assert port is not None
    with ExitStack() as stack:
        waiting = [stack.enter_context(stalled(port, 3)) for _ in range(30)]
        assert opened.get("/api/state").status_code == 200
        assert all(is_over(one) for one in waiting[:20])


def test_equal_pictures_are_drawn_once_while_work_goes_on(
    opened: httpx.Client, bench: Bench, monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    drawn, go_on = [], threading.Event()

    def draw(effect: Any, tell: Any) -> bytes:
        drawn.append(effect.id)
        go_on.wait(30.0)
        return b"picture"

    monkeypatch.setattr(saving, "drawn", draw)
    with ThreadPoolExecutor(100) as pool:
        asked = [
            pool.submit(opened.get, "/api/picture", params={"effect": "coulomb"}, timeout=60.0)
            for _ in range(90)
        ]
        assert eventually(lambda: drawn == ["coulomb"])
        assert opened.post("/api/add", json={"effect": "return_spring"}).status_code == 200
        path = str(tmp_path / "m.toml")
        assert opened.post("/api/save", json={"what": "model", "path": path}).status_code == 200
        go_on.set()
        assert {one.result().content for one in asked} == {b"picture"}
    assert opened.get("/api/picture", params={"effect": "coulomb"}).content == b"picture"
    assert drawn == ["coulomb"]


def test_nothing_is_drawn_for_those_who_left(
    opened: httpx.Client, bench: Bench, monkeypatch: pytest.MonkeyPatch
) -> None:
    drawn, go_on = [], threading.Event()

    def draw(effect: Any, tell: Any) -> bytes:
        drawn.append(effect.id)
        go_on.wait(30.0)
        tell("drawing")
        return b"picture"

    monkeypatch.setattr(saving, "drawn", draw)
    headers, base = dict(opened.headers), str(opened.base_url)

    async def ask(effect: str) -> None:
        async with httpx.AsyncClient(base_url=base, headers=headers) as client:
            await asyncio.wait_for(client.get("/api/picture", params={"effect": effect}, timeout=60.0), 0.5)

    async def all_of_them() -> list[Any]:
        effects = ["coulomb", "stribeck", "viscous", "detent"] * 5
        return await asyncio.gather(*map(ask, effects), return_exceptions=True)

    assert {type(one) for one in asyncio.run(all_of_them())} == {TimeoutError}
    assert eventually(lambda: bench.drawing.current is None)
    go_on.set()
    assert eventually(lambda: not bench.drawing.busy)
    assert len(drawn) == 1
    assert opened.get("/api/picture", params={"effect": "detent"}).content == b"picture"


def test_work_that_does_not_notice_that_it_was_given_up_keeps_nobody_waiting(
    opened: httpx.Client, bench: Bench
) -> None:
    deaf, begun = threading.Event(), threading.Event()
    before = bench.session.node

    def work(job: Job) -> None:
        begun.set()
        deaf.wait(60.0)
        bench.session.add("return_spring", job.tell)

    try:
        jobs = []
        for _ in range(3):
            begun.clear()
            jobs.append(bench.work.start("deaf", work))
            assert begun.wait(10.0)
            assert opened.post("/api/cancel").json()["cancelled"]
            with pytest.raises(Cancelled):
                jobs[-1].result.result(1.0)
        assert opened.get("/api/state").json()["job"] is None or bench.work.current is None
        assert opened.post("/api/add", json={"effect": "quadratic_drag"}).status_code == 200
    finally:
        deaf.set()
    assert eventually(lambda: not bench.work.busy)
    assert bench.session.branch.steps[0] is before
    assert [one.effect for one in bench.session.branch.steps] == [None, "quadratic_drag"]


def test_of_abandoned_threads_there_are_few() -> None:
    deaf, running = threading.Event(), []
    worker = Worker("test", lambda _: None)

    def work(job: Job) -> None:
        running.append(job)
        deaf.wait(60.0)

    before = threading.active_count()
    for _ in range(12):
        worker.start("deaf", work)
        time.sleep(0.01)
        worker.cancel()
    last = worker.start("last", lambda _: "done")
    time.sleep(1.5)
    assert threading.active_count() - before <= 5
    deaf.set()
    assert last.result.result(10.0) == "done"
    worker.close()
    assert eventually(lambda: threading.active_count() < before)


def test_what_can_no_longer_be_given_up_is_not_said_to_be(opened: httpx.Client, bench: Bench) -> None:
    assert opened.post("/api/cancel").json()["cancelled"] in (True, False)  # the weighing, or nothing
    go_on, settled = threading.Event(), threading.Event()

    def work(job: Job) -> str:
        job.tell("putting it in place", last=True)
        settled.set()
        go_on.wait(10.0)
        return "done"

    job = bench.work.start("settling", work)
    assert settled.wait(10.0)
    assert not opened.post("/api/cancel").json()["cancelled"]
    go_on.set()
    assert job.result.result(10.0) == "done"


def test_a_pipe_or_a_device_is_refused_at_once(opened: httpx.Client, tmp_path: Path) -> None:
    os.mkfifo(tmp_path / "pipe")
    for path, what in ((tmp_path / "pipe", "is a pipe"), (Path("/dev/zero"), "is a device")):
        wrong(opened.post("/api/open", json={"path": str(path)}, timeout=10.0), 400, what)


def test_bodies_have_room_together_and_not_more(
    client: httpx.Client, monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    monkeypatch.setattr(bodies, "_ALL_BYTES", 1000)
    wrong(client.post("/api/add", content=b" " * 2000), 503, "too much is being handed over")
    wrong(client.post("/api/add", content=b"{}"), 400, "effect")
    monkeypatch.setattr(server, "_UPLOADS", 0)
    wrong(client.post("/api/upload", content=b"x"), 503, "are being handed over")
    monkeypatch.setattr(server, "_UPLOADS", 1)
    wrong(client.post("/api/upload", content=bytes(UPLOAD_BYTES + 1)), 413, "more than 2 MB")
    wrong(client.post("/api/upload", content=b"x"), 400, "capture")


def test_who_listens_slowly_hears_the_last_and_nothing_grows(client: httpx.Client, bench: Bench) -> None:
    with client.stream("GET", "/api/events") as events:
        lines = events.iter_lines()
        assert next(lines) == "event: state"
        for turn in range(20_000):
            bench._say(
                "progress", {"id": "j0", "what": "x" * 1000, "done": turn / 20_000, "recording": False}
            )
        bench._say("progress", {"id": "last", "what": "", "done": None, "recording": False})
        heard = 0
        for line in lines:
            heard += line.startswith("data:")
            if '"last"' in line:
                break
        assert heard < 20_000


def test_a_connection_that_is_closed_is_looked_at_no_more(
    opened: httpx.Client, monkeypatch: pytest.MonkeyPatch, caplog: pytest.LogCaptureFixture
) -> None:
    monkeypatch.setattr(patience, "_LOOKS_S", 0.05)
    assert opened.get("/api/state", headers={"connection": "close"}).status_code == 200
    time.sleep(0.3)
    assert opened.get("/api/state").status_code == 200
    assert not [one for one in caplog.records if one.name == "asyncio"]
