"""Random commands to the workbench, sessions that are cut, connections that stall, clocks that jump.

    python benches/faults_page.py [--sequences 20] [--commands 100] [--stalls 500] [--seed N]

What must hold: every answer comes in time and is a document or one line, never 500; a session that is cut
wherever a process can be killed goes on, without its last actions at most; whoever stalls goes; the clock on
the wall decides nothing. `study_faults.py` counts it.
"""

from __future__ import annotations

import argparse
import json
import os
import random
import shutil
import socket
import tempfile
import threading
import time
from collections import Counter
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager, suppress
from pathlib import Path
from typing import Any, NamedTuple
from unittest import mock

import httpx
import numpy as np

import knobcam as kc
from knobcam.workbench import journal, patience
from knobcam.workbench.bench import Bench
from knobcam.workbench.guard import HEADER
from knobcam.workbench.kept import Told
from knobcam.workbench.server import application
from knobcam.workbench.serving import listen, web_server

LONGEST_S = 30.0
_TOKEN = "nobody-guesses-this"
_CODES = {200, 400, 403, 404, 405, 413, 503}
_EFFECTS = (
    "quadratic_drag",
    "return_spring",
    "stribeck",
    "coulomb",
    "detent",
    "nonsense",
    "offset",
    "viscous",
)
_VALUES = (
    None,
    True,
    -1,
    0,
    3,
    1e308,
    float("nan"),
    "",
    "x",
    "a\0b",
    "<b>",
    "é" * 300,
    [],
    [1],
    {},
    {"a": {}},
)
_VERBS = (
    "add",
    "drop",
    "undo",
    "redo",
    "branch",
    "switch",
    "params",
    "snap",
    "cancel",
    "share",
    "use",
    "open",
    "overrule",
    "typed",
    "hint",
)
_ALL = (*_VERBS, *_VERBS, "look", "look", "simulate", "record", "stop", "save", "anew", "continue", "nothing")
_GETS = (
    *("state", "arrays", "signature", "download", "hidden", "live", "sources", "finding", "challenge"),
    "picture",
)


class Place(NamedTuple):
    """Files that a person may name, sound and other."""

    folder: Path
    paths: list[str]

    @classmethod
    def made(cls, folder: Path) -> Place:
        """Make them."""
        sound = kc.simulate("knob4", "sweep", duration_s=0.6, seed=1).save(folder / "a.npz")
        other = kc.simulate("knob4", "multisine", duration_s=0.6, seed=2)
        other.save(folder / "b.csv")
        tau = other.tau.copy()
        tau[1500] += 5.0 * np.ptp(tau)
        columns = np.column_stack([other.t, other.theta, tau])
        head = {"delimiter": ",", "header": "t_s,theta_rad,tau_Nm", "comments": ""}
        np.savetxt(folder / "spoiled.csv", columns, **head)
        (folder / "cut.npz").write_bytes(sound.read_bytes()[:5000])
        (folder / "empty.csv").write_bytes(b"")
        os.mkfifo(folder / "pipe")
        names = (
            "a.npz",
            "a.npz",
            "b.csv",
            "spoiled.csv",
            "spoiled.csv",
            "cut.npz",
            "empty.csv",
            "pipe",
            "none.csv",
            ".",
            "x" * 5000,
        )
        return cls(folder, [*(str(folder / name) for name in names), "/dev/zero", "/", "a\0b", ""])


@contextmanager
def served(root: Path) -> Iterator[tuple[Bench, httpx.Client]]:
    """A workbench that keeps its session in a folder, and who talks to it."""
    bench = Bench(kept_in=root)
    with listen(0) as listening:
        port = listening.getsockname()[1]
        serving = web_server(application(bench, _TOKEN, port, upload_bytes=1_000_000))
        thread = threading.Thread(target=serving.run, args=([listening],))
        thread.start()
        try:
            base = f"http://127.0.0.1:{port}"
            with httpx.Client(base_url=base, headers={HEADER: _TOKEN}, timeout=LONGEST_S) as client:
                yield bench, client
        finally:
            serving.should_exit = True
            thread.join()
            bench.close()


def command(rng: random.Random, state: dict[str, Any], place: Place) -> tuple[str, str, Any]:
    """Return a command: method, path with its query, body; sensible mostly, anything now and then."""
    branch = next((one for one in state["branches"] if one["id"] == state["branch"]), None)
    captures = [one["id"] for one in state["captures"]] or ["c1"]
    names = [one["name"] for one in state["params"]] or ["viscous.pos"]
    if rng.random() < 0.25:
        query = {"node": state["node"] or "n1", "capture": rng.choice(captures), "names": "theta,residual"}
        query |= {"effect": rng.choice(_EFFECTS), "what": rng.choice(("model", "script", "x")), "since": "0"}
        if rng.random() < 0.3:
            query[rng.choice(list(query))] = str(rng.choice(_VALUES))
        words = str(httpx.QueryParams(query))
        return "GET", f"/api/{rng.choice(_GETS[:-1] if rng.random() < 0.98 else _GETS)}?{words}", None
    verb = "open" if branch is None and rng.random() < 0.7 else rng.choice(_ALL)
    body: dict[str, Any] = {
        **{
            "effect": rng.choice(_EFFECTS),
            "name": f"branch {rng.random():.2f}",
            "path": rng.choice(place.paths),
        },
        **{
            "branch": rng.choice([one["id"] for one in state["branches"]] or ["b1"]),
            "together": rng.random() < 0.5,
        },
        **{"captures": rng.sample(captures, rng.randint(1, len(captures))), "capture": rng.choice(captures)},
        **{"indices": "AAAAAAEAAAA=", "session": "000001", "keep": False, "knob": "knob4", "duration_s": 0.5},
    }
    body |= {"motion": "multisine", "source": "port", "port": str(place.folder / "a.npz"), "what": "model"}
    body |= {"finding": "spike:tau", "on": rng.random() < 0.7, "law": rng.choice(("k*theta", "a*sin("))}
    body["view"] = {"isolated": rng.random() < 0.5}
    body["brush"] = {"plot": rng.randrange(9), "x": [0.0, rng.random()], "y": [-1.0, 1.0]}
    if verb == "save":
        body["path"] = str(place.folder / f"saved-{rng.randrange(10**9)}")
    if verb == "params":
        body = {rng.choice(names): rng.uniform(-0.01, 0.01)}
    if rng.random() < 0.25 and body:
        body[rng.choice(list(body))] = rng.choice(_VALUES)
    if rng.random() < 0.05:
        return "POST", f"/api/{verb}", rng.choice((b"", b"{", b"[1]", b"\xff", b"[" * 10_000, b"null"))
    return "POST", f"/api/{verb}", json.dumps(body).encode()


def wrong(client: httpx.Client, method: str, path: str, body: Any) -> str | None:
    """Send a command; return what is wrong with its answer."""
    try:
        answer = client.request(method, path, content=body)
    except httpx.HTTPError as error:
        return f"{type(error).__name__}"
    if answer.status_code not in _CODES:
        return f"{answer.status_code} {answer.text[:200]}"
    if not answer.is_success:
        said = answer.json().get("error", "")
        return None if said and "\n" not in said else f"no line: {answer.text[:200]}"
    return None


def shown(bench: Bench) -> list[Any]:
    """What a session is: its fits, to the last bit, and where it is."""
    session = bench.session
    told = [
        [one.name for one in session.captures.values()],
        [
            (
                one.name,
                one.at,
                [node.fit.model.text() for node in one.steps],
                dict(one.dragged.dragged if one.dragged else {}),
            )
            for one in session.branches.values()
        ],
        session.branch_id,
        session.looked,
    ]
    return list(json.loads(json.dumps(told)))


def difference(one: Any, other: Any) -> str:
    """Say where two sessions first differ."""
    if isinstance(one, list | tuple) and isinstance(other, list | tuple) and len(one) == len(other):
        return next((difference(a, b) for a, b in zip(one, other, strict=True) if a != b), "nowhere")
    return f"{str(one)[:300]!r} for {str(other)[:300]!r}"


def goes_on(root: Path, rng: random.Random, scratch: Path, whole: list[Any] | None) -> str | None:
    """Continue a copy of a session, cut somewhere unless it is to be `whole`; say what is wrong with that."""
    copy = scratch / "copy"
    shutil.copytree(root, copy)
    try:
        folder = journal.sessions(copy)[0]
        path = folder / "journal"
        if whole is None:
            lines = path.read_bytes().splitlines(keepends=True)
            kept = b"".join(lines[: rng.randint(1, len(lines))])
            path.write_bytes(kept[: rng.randint(len(lines[0]), len(kept))])
        steps = Told.of(folder).steps
        bench = Bench(kept_in=copy)
        try:
            if steps:
                bench.go_on(folder.name, lambda *_, **__: None)
                notes = bench.document()["notes"]
                if notes:
                    return f"notes {notes}"
                if whole is not None and shown(bench) != whole:
                    return f"another session: {difference(shown(bench), whole)}"
        finally:
            bench.close()
    except BaseException as error:
        return repr(error)[:300]
    finally:
        shutil.rmtree(copy, ignore_errors=True)
    return None


def sequence(
    seed: str, commands: int, jumps: bool, found: dict[str, Counter[str]], failures: list[str]
) -> None:
    """Give a workbench random commands, then continue copies of its session; count what held."""
    rng, clock = random.Random(seed), time.time

    def jumping() -> float:
        return clock() + rng.uniform(-3e8, 3e8)

    def note(row: str, why: str | None) -> None:
        found[row]["well" if why is None else "failed"] += 1
        if why is not None:
            failures.append(f"{row}, seed {seed}: {why}")

    row = "clocks that jump" if jumps else "commands to the page"
    with ExitStack() as stack:
        scratch = Path(stack.enter_context(tempfile.TemporaryDirectory()))
        place = Place.made(scratch)
        if jumps:
            stack.enter_context(mock.patch("time.time", jumping))
        with served(scratch / "sessions") as (bench, client):
            for number in range(commands):
                state = client.get("/api/state").json()
                method, path, body = command(rng, state, place)
                if path == "/api/continue" and number:
                    continue
                why = wrong(client, method, path, body)
                note(row, None if why is None else f"{method} {path} {str(body)[:300]}: {why}")
            with suppress(httpx.HTTPError):
                client.post("/api/cancel")
            whole = shown(bench)
        if not journal.sessions(scratch / "sessions"):
            return
        note("sessions that go on", goes_on(scratch / "sessions", rng, scratch, whole))
        for _ in range(3):
            note("sessions that go on", goes_on(scratch / "sessions", rng, scratch, None))


def stalled(seed: str, count: int, failures: list[str]) -> Counter[str]:
    """Open connections that stop anywhere in a request; they go in time, others are answered."""
    rng, found = random.Random(seed), Counter[str]()
    head = f"POST /api/add HTTP/1.1\r\nhost: 127.0.0.1:%d\r\n{HEADER}: {_TOKEN}\r\ncontent-length: 30\r\n\r\n"
    with (
        ExitStack() as stack,
        tempfile.TemporaryDirectory() as scratch,
        mock.patch.object(patience, "HEAD_S", 1.0),
        served(Path(scratch) / "sessions") as (_, client),
    ):
        raw = (head % client.base_url.port).encode() + b'{"effect": "quadratic_drag"   '
        waiting = []
        for _ in range(count):
            one = stack.enter_context(socket.create_connection(("127.0.0.1", client.base_url.port or 0)))
            one.settimeout(LONGEST_S)
            with suppress(OSError):  # of too many, some are gone already
                one.sendall(raw[: rng.randrange(len(raw) - 1)])
            waiting.append(one)
        for _ in range(10):
            if why := wrong(client, "GET", "/api/state", None):
                failures.append(f"connections that stall, seed {seed}: {why}")
                found["failed"] += 1
        for one in waiting:
            found["well" if is_over(one) else "failed"] += 1
    return found


def is_over(one: socket.socket) -> bool:
    """Whether the server has let go of a connection, within the socket's own time."""
    try:
        while one.recv(4096):
            pass
    except TimeoutError:
        return False
    except OSError:
        pass
    return True


def played(
    seed: int, sequences: int, commands: int, stalls: int
) -> tuple[dict[str, Counter[str]], list[str]]:
    """Return how often all held, by row, and each time that it did not."""
    found: dict[str, Counter[str]] = {
        row: Counter() for row in ("commands to the page", "clocks that jump", "sessions that go on")
    }
    failures: list[str] = []
    for number in range(sequences):
        sequence(f"{seed} {number}", commands, number % 4 == 3, found, failures)
    found["connections that stall"] = Counter()
    for number in range(0, stalls, 500):
        found["connections that stall"] += stalled(f"{seed} {number}", min(500, stalls - number), failures)
    return found, failures


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    parser.add_argument("--sequences", type=int, default=20)
    parser.add_argument("--commands", type=int, default=100, help="of each sequence")
    parser.add_argument("--stalls", type=int, default=500)
    parser.add_argument("--seed", type=int, default=time.time_ns() % 2**32, help="default a new one")
    args = parser.parse_args()
    print(f"seed {args.seed}")
    found, failures = played(args.seed, args.sequences, args.commands, args.stalls)
    print(*failures, *(f"{row}: {dict(counts)}" for row, counts in found.items()), sep="\n")


if __name__ == "__main__":
    main()
