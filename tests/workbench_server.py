"""A workbench's server on a port of its own, as a test talks to it."""

from __future__ import annotations

import json
import subprocess
import sys
import threading
from collections.abc import Iterator
from contextlib import contextmanager

import httpx
import told

from knobcam.base import pages, pages_sources
from knobcam.workbench.bench import Bench
from knobcam.workbench.guard import HEADER
from knobcam.workbench.server import application
from knobcam.workbench.serving import listen, web_server

TOKEN = "a-token-that-nobody-guesses"
HOSTILE = "<img src=x onerror=alert(1)>\"'&\u2028"
UPLOAD_BYTES = 2_000_000


@contextmanager
def served(bench: Bench) -> Iterator[httpx.Client]:
    """Serve a bench and give the client that has its token."""
    with listen(0) as listening:
        port = listening.getsockname()[1]
        serving = web_server(application(bench, TOKEN, port, upload_bytes=UPLOAD_BYTES))
        thread = threading.Thread(target=serving.run, args=([listening],))
        thread.start()
        with httpx.Client(
            base_url=f"http://127.0.0.1:{port}",
            headers={HEADER: TOKEN},
            timeout=60.0,
            event_hooks={"response": [as_the_schema_says]},
        ) as client:
            try:
                yield client
            finally:
                serving.should_exit = True
                thread.join()
                bench.close()


@contextmanager
def started(*given: object) -> Iterator[tuple[httpx.Client, subprocess.Popen[str]]]:
    """Start the command, and give a client of its page and its process."""
    words = [sys.executable, "-m", "knobcam", "workbench", "--no-browser", *map(str, given)]
    with subprocess.Popen(words, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True) as process:
        try:
            assert process.stdout is not None
            base, token = process.stdout.readline().strip().split("/?token=")
            with httpx.Client(base_url=base, headers={HEADER: token}, timeout=60.0) as client:
                yield client, process
        finally:
            process.kill()


def as_the_schema_says(answer: httpx.Response) -> None:
    """Assert that an answer is what the pages are told to expect."""
    kind = answer.headers.get("content-type", "")
    if kind == "application/json":
        shapes = {"/api/state": pages.State, "/api/sources": pages_sources.Sources} | {
            "/api/splits": pages.Splits,
            "/api/finding": pages_sources.Found,
            "/api/challenge": pages_sources.Challenge,
        }
        shape = shapes.get(answer.url.path, pages.Answer)
        answer.read()
        told.check(answer.json(), shape if answer.is_success else pages_sources.Refused)
    elif kind == "application/octet-stream" and "content-disposition" not in answer.headers:
        told.check(json.loads(answer.read().partition(b"\n")[0]), pages_sources.ColumnsHead)


def wrong(answer: httpx.Response, status: int, words: str) -> None:
    """Assert that the answer is JSON with one line that says what is wrong."""
    assert answer.status_code == status, answer.text
    assert answer.headers["content-type"] == "application/json"
    said = answer.json()["error"]
    assert words in said
    assert "\n" not in said
