"""The scheduler and workers of a batch; where something else answers, or nothing: one line, soon."""

from __future__ import annotations

import gc
import socket
import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import pytest
from command import process, refused
from small import recorded

from knobcam.fleet import cluster


@contextmanager
def listening(answer: bytes) -> Iterator[str]:
    """Give the address of what takes every call, answers the same to it, and keeps it."""
    kept = []
    with socket.create_server(("127.0.0.1", 0)) as server:

        def take() -> None:
            while True:
                try:
                    call, _ = server.accept()
                    kept.append(call)
                    call.sendall(answer)
                except OSError:
                    return

        thread = threading.Thread(target=take, daemon=True)
        thread.start()
        try:
            yield f"tcp://127.0.0.1:{server.getsockname()[1]}"
        finally:
            server.shutdown(socket.SHUT_RDWR)
            thread.join(5.0)
            for one in kept:
                one.close()


@pytest.fixture
def capture(tmp_path: Path) -> Path:
    return recorded(1, count=1200).save(tmp_path / "k.npz")


@pytest.mark.parametrize("answer", [b"", b"HTTP/1.1 400 Bad Request\r\n\r\n", b"\x08" + bytes(40)])
def test_what_is_no_scheduler_is_refused_in_one_line_and_soon(answer: bytes, capture: Path, tmp_path: Path):
    with listening(answer) as address:
        begun = time.monotonic()
        ended = process("batch", capture, "-o", tmp_path / "r", "--scheduler", address)
    refused(ended, f"--scheduler {address}: no scheduler answers there", "dask scheduler")
    assert time.monotonic() - begun < 40.0  # of ten seconds; the rest is what a busy machine takes to start


@pytest.mark.parametrize("address", ["foo:bar", "tcp://", "nothing://127.0.0.1:1"])
def test_an_address_that_is_none_is_refused_in_one_line(address: str, capture: Path, tmp_path: Path):
    ended = process("batch", capture, "-o", tmp_path / "r", "--scheduler", address)
    refused(ended, f"--scheduler {address}: no scheduler answers there")


def test_workers_never_go_through_what_was_loaded_before_them():
    with cluster.workers(None) as client:
        assert min(client.run(gc.get_freeze_count).values()) > 10_000


def test_the_address_of_a_worker_is_refused_as_one(capture: Path, tmp_path: Path):
    with cluster.workers(None) as client:
        address = next(iter(client.nthreads()))
        ended = process("batch", capture, "-o", tmp_path / "r", "--scheduler", address)
    refused(ended, "a worker answers there; give its scheduler's address")
