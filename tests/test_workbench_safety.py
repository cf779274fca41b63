"""The workbench's server: who may talk to it, and what it never lets through."""

from __future__ import annotations

import contextlib
import os
import pickle
import tempfile
import time
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any
from urllib.parse import quote

import httpx
import numpy as np
import pytest
from command import knobcam
from workbench_server import HOSTILE, TOKEN, UPLOAD_BYTES, wrong

import knobcam as kc
from knobcam.errors import InputError
from knobcam.workbench import server
from knobcam.workbench.bench import Bench
from knobcam.workbench.guard import HEADER


def test_the_page_is_for_those_who_have_the_token(client: httpx.Client):
    for headers in ({HEADER: ""}, {HEADER: "wrong"}, {HEADER: (TOKEN + "é").encode()}):
        for path in ("/", "/api/state", "/api/events", "/api/arrays"):
            wrong(client.get(path, headers=headers), 403, "token")
        wrong(client.post("/api/undo", headers=headers), 403, "token")
    assert client.get(f"/?token={TOKEN}", headers={HEADER: ""}).status_code == 200
    wrong(client.get("/?token=wrong&token=" + TOKEN, headers={HEADER: ""}), 403, "token")


def test_a_browser_is_led_to_the_page_by_a_file_and_no_command_line_has_the_token(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
):
    opened: list[str] = []
    folders: list[Path] = []

    def look(address: str) -> bool:
        opened.append(address)
        page = Path(address.removeprefix("file://"))
        assert f"url=http://127.0.0.1:1/?token={TOKEN}" in page.read_text()
        assert page.parent.stat().st_mode & 0o077 == 0
        folders.append(page.parent)
        return True

    def serve(bench: Bench, port: int, tell: Callable[[str], None]) -> None:
        tell(f"http://127.0.0.1:1/?token={TOKEN}")
        for _ in range(200):
            if folders:
                break
            time.sleep(0.05)

    monkeypatch.setattr("webbrowser.open", look)
    monkeypatch.setattr("knobcam.workbench.serving.serve", serve)
    monkeypatch.setattr(tempfile, "tempdir", str(tmp_path))
    assert knobcam("workbench").code == 0
    assert len(opened) == 1 and opened[0].startswith("file://") and TOKEN not in opened[0]
    assert folders and not folders[0].exists()


def test_two_servers_have_two_tokens():
    assert server.new_token() != server.new_token()
    assert len(server.new_token()) > 40


@pytest.mark.parametrize(
    "host",
    ["evil.example", "evil.example:{}", "127.0.0.1", "127.0.0.1:80", "", "0.0.0.0:{}", "LOCALHOST.:{}"],
)
def test_a_name_that_was_bound_to_this_machine_from_outside_is_refused(client: httpx.Client, host: str):
    headers = {"host": host.format(client.base_url.port)}
    wrong(client.get("/api/state", headers=headers), 403, "this machine alone")


@pytest.mark.parametrize(
    "origin",
    ["http://evil.example", "null", "https://127.0.0.1:{}", "http://localhost:{}", "http://127.0.0.1", ""],
)
def test_a_foreign_page_is_refused_even_with_the_token(client: httpx.Client, origin: str):
    headers = {"origin": origin.format(client.base_url.port)}
    wrong(client.post("/api/cancel", headers=headers), 403, "own page alone")


def test_the_own_page_is_answered_under_both_names_of_this_machine(client: httpx.Client):
    for host in (f"127.0.0.1:{client.base_url.port}", f"localhost:{client.base_url.port}"):
        headers = {"host": host, "origin": f"http://{host}"}
        assert client.get("/api/state", headers=headers).status_code == 200


def test_every_answer_forbids_the_browser_whatever_the_page_does_not_need(client: httpx.Client):
    for path in ("/", "/app.js", "/api/state", "/nowhere", "/api/arrays?node=x"):
        headers = client.get(path).headers
        assert headers["content-security-policy"].startswith("default-src 'self'")
        assert "unsafe" not in headers["content-security-policy"]
        assert headers["x-content-type-options"] == "nosniff"
        assert headers["referrer-policy"] == "no-referrer"
        assert headers["cache-control"] == "no-store"


@pytest.mark.parametrize(
    "path",
    [
        "/..%2fserver.py",
        "/../server.py",
        "/page",
        "/page/",
        "/api",
        "/api/",
        "/%2e%2e/guard.py",
        "//etc/passwd",
    ],
)
def test_no_path_leads_to_a_folder_or_to_another_file(client: httpx.Client, path: str):
    wrong(client.get(path), 404, "nothing of that name")


def test_the_page_is_served_with_types_that_are_no_guess(client: httpx.Client):
    assert client.get("/").headers["content-type"].startswith("text/html")
    assert client.get("/app.js").headers["content-type"].startswith("text/javascript")
    assert client.get("/app.css", headers={HEADER: ""}).headers["content-type"].startswith("text/css")


def test_a_file_that_is_too_large_is_refused_while_it_comes(
    client: httpx.Client, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
):
    monkeypatch.setattr(tempfile, "tempdir", str(tmp_path))
    kept = [0]

    def endless() -> Iterator[bytes]:
        for _ in range(300):
            with contextlib.suppress(FileNotFoundError):  # the server has just removed it
                kept.append(sum(file.stat().st_size for file in tmp_path.rglob("capture")))
            yield bytes(100_000)

    wrong(client.post("/api/upload", content=bytes(UPLOAD_BYTES + 1)), 413, "more than 2 MB")
    wrong(client.post("/api/upload", content=endless()), 413, "more than 2 MB")
    assert max(kept) <= UPLOAD_BYTES
    assert list(tmp_path.iterdir()) == []


class Bomb:
    def __reduce__(self) -> tuple[Any, ...]:
        return os.mkdir, ("unpickled",)


def test_what_is_handed_over_is_never_unpickled(
    client: httpx.Client, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
):
    monkeypatch.chdir(tmp_path)
    objects = np.array([Bomb()], dtype=object)
    np.savez(tmp_path / "bomb.npz", theta_rad=objects, tau_Nm=objects, allow_pickle=True)
    np.save(tmp_path / "bomb.npy", objects, allow_pickle=True)
    contents = [(tmp_path / name).read_bytes() for name in ("bomb.npz", "bomb.npy")]
    for content in [*contents, pickle.dumps(Bomb())]:
        wrong(client.post("/api/upload", content=content, headers={"x-filename": "bomb"}), 400, "bomb")
    assert not (tmp_path / "unpickled").exists()


def test_text_from_files_is_text_in_json_and_nowhere_else(client: httpx.Client, bench: Bench, tmp_path: Path):
    """Names, metadata and branches reach the page as strings of JSON that no browser takes for markup."""
    capture = kc.simulate("knob4", "sweep", duration_s=1.0)
    hostile = kc.Capture.from_arrays(
        t=capture.t, theta=capture.theta, tau=capture.tau, meta={"source": HOSTILE, HOSTILE: HOSTILE}
    )
    content = hostile.save(tmp_path / "x.npz").read_bytes()
    client.post("/api/upload", content=content, headers={"x-filename": quote(HOSTILE.replace("/", ""))})
    client.post("/api/branch", json={"name": HOSTILE})
    answer = client.get("/api/state")
    assert answer.headers["content-type"] == "application/json"
    assert answer.json()["branches"][1]["name"] == " ".join(HOSTILE.split())
    assert answer.json()["captures"][0]["name"].startswith("<img src=x")
    assert "<img" not in client.get("/").text
    report = client.get("/api/download?what=report")
    assert report.headers["content-type"] == "application/octet-stream"
    assert report.headers["content-disposition"] == 'attachment; filename="knobcam-report.html"'
    assert "<img src=x" not in report.text
    compile(client.get("/api/download?what=script").text, "session.py", "exec")
    assert bench.session.captures


def test_an_effect_of_somebody_elses_with_a_hostile_law_is_text(opened: httpx.Client, bench: Bench):
    own = kc.OwnParameter("N m/rad", linear=True, meaning=HOSTILE)

    @kc.own_effect("hostile", law=HOSTILE, source=HOSTILE, shows=HOSTILE, k=own)
    def hostile(motion: kc.OwnMotion, k: float) -> Any:
        return k * motion.theta**3

    with pytest.raises(InputError):
        kc.own_effect(HOSTILE, law="k", k=own)(hostile)
    bench.session.add("hostile")
    bench.session.weigh()
    answer = opened.get("/api/state")
    assert answer.headers["content-type"] == "application/json"
    row = next(row for row in answer.json()["params"] if row["name"] == "hostile.k")
    assert row["meaning"] == " ".join(HOSTILE.split())
    assert answer.json()["candidates"]["ready"]
