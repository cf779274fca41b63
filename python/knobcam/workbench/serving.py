"""The workbench as a process: a port on the loopback interface, until it is interrupted."""

from __future__ import annotations

import asyncio
import contextlib
import os
import socket
import threading
from collections.abc import Callable
from typing import TYPE_CHECKING

import uvicorn
from starlette.concurrency import run_in_threadpool

from ..errors import InputError
from .bench import Bench
from .patience import Patient
from .server import application, new_token

if TYPE_CHECKING:
    from starlette.types import ASGIApp

HOST = "127.0.0.1"


def serve(bench: Bench, port: int, tell: Callable[[str], None]) -> None:
    """Serve a bench on a port of this machine (0: any that is free) and tell its address; ends by Ctrl-C.

    SIGTERM and SIGHUP end it as they end every command (see `base.ended`), when the port is closed.

    Raises InputError where the port cannot be had.
    """
    token = new_token()
    with listen(port) as listening, contextlib.suppress(KeyboardInterrupt):
        at = listening.getsockname()[1]
        server = web_server(application(bench, token, at))
        tell(f"http://{HOST}:{at}/?token={token}")
        threading.Thread(target=_ready, args=(bench,), daemon=True).start()
        server.run([listening])


def _ready(bench: Bench) -> None:
    """Do what the first page would wait for while its browser starts: the state, and threads to answer."""
    asyncio.run(run_in_threadpool(bench.document))


def listen(port: int) -> socket.socket:
    """Return a socket that is bound on the loopback interface alone. Raises InputError where it cannot be."""
    # With its protocol named: asyncio sends small answers without delay on sockets that are surely TCP.
    listening = socket.socket(socket.AF_INET, socket.SOCK_STREAM, socket.IPPROTO_TCP)
    try:
        if os.name == "posix":  # elsewhere it would let two programs share the port
            listening.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        listening.bind((HOST, port))
        listening.listen()
    except (OSError, OverflowError) as error:
        listening.close()
        why = getattr(error, "strerror", None) or error
        raise InputError(f"--port {port}: cannot be had ({why}); choose another, or leave it out") from error
    return listening


def web_server(app: ASGIApp) -> uvicorn.Server:
    """Return what serves the application: plain HTTP, silent, and not for ever."""
    config = uvicorn.Config(
        app,
        http=Patient,
        log_level="critical",
        access_log=False,
        server_header=False,
        proxy_headers=False,
        lifespan="off",
        ws="none",
        timeout_graceful_shutdown=1,  # pages that listen for events never hang up by themselves
    )
    return uvicorn.Server(config)
