"""Clocks that jump at a rig: those of the host, and the device's, in recordings and in logs that are read.

    python benches/faults_rig.py [--live 20] [--logs 500] [--seed N]

What must hold: within 30 s the run is a capture whose time goes on and whose samples are all in the books, or
one line; the rig gives no torque afterwards, and the log opens. `study_faults.py` counts it.
"""

from __future__ import annotations

import argparse
import random
import sys
import tempfile
import time
from collections import Counter
from collections.abc import Callable
from contextlib import ExitStack, suppress
from pathlib import Path
from unittest import mock

import numpy as np

import knobcam as kc
from knobcam import _core

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "tests"))
from peer import Peer

LONGEST_S = 30.0
_SAMPLES = 1500  # of a run
_LEAPS_S = (0.002, 0.3, 5.0, 3600.0, 3e8)
_MOST_US = 2**64 - 1

Clock = Callable[[int], int]
"""What a device says of its time, us, when it is so late."""


def strange(rng: random.Random) -> Clock:
    """Return a device's clock that leaps, stands, drifts, jitters or begins near the end of its numbers."""
    kind = rng.choice(("leap", "leap", "leap", "stand", "drift", "jitter", "end"))
    at, by = rng.randrange(400_000), round(1e6 * rng.choice((-1, 1)) * rng.choice(_LEAPS_S) * rng.random())
    rate, first = (
        1.0 + rng.choice((-1, 1)) * 10.0 ** rng.uniform(-5.0, 0.0),
        _MOST_US - rng.randrange(400_000),
    )

    def said(us: int) -> int:
        if kind == "leap":
            us += by if us > at else 0
        elif kind == "stand":
            us = min(us, at)
        elif kind == "drift":
            us = round(us * rate)
        elif kind == "jitter":
            us += round(rng.gauss(0.0, 1e3 * abs(by) ** 0.3))
        else:
            us += first
        return min(max(us, 0), _MOST_US)

    return said


def retimed(frame: bytes, clock: Clock) -> bytes:
    """Return a frame with another time in it; as it is where it is none."""
    for event in _core.WireDecoder().push(frame):
        if event["event"] == "frame":
            return _core.wire_encode(event["message"], event["sequence"], clock(event["time_us"]))
    return frame


class Leaping:
    """The host's clocks, as Python asks for them: they leap to and fro."""

    sleep = staticmethod(time.sleep)

    def __init__(self, rng: random.Random) -> None:
        self._rng, self._off = rng, 0.0

    def monotonic(self) -> float:
        """No system does this; one that slept for hours comes near it."""
        if self._rng.random() < 0.02:
            self._off += self._rng.uniform(-1.0, 1.0) * self._rng.choice(_LEAPS_S)
        return time.monotonic() + self._off

    def time(self) -> float:
        return time.time() + self._rng.uniform(-3e8, 3e8)


def wrong(capture: kc.Capture, samples: int | None = None) -> str | None:
    """Return what is wrong with a capture of which so many samples were asked for."""
    if not (np.isfinite(capture.t).all() and (np.diff(capture.t) > 0.0).all()):
        return "its time does not go on"
    missing = capture.meta["account"]["missing"]
    if samples is not None and capture.samples + missing != samples:
        return f"{capture.samples} samples, {missing} missing, of {samples}"
    return None


def live(seed: str, folder: Path) -> str | None:
    """Record a run while clocks jump; return what is wrong with how that ended."""
    rng = random.Random(seed)
    clock, motion = strange(rng), rng.choice(("hand", "micro"))
    whose = rng.choice(("device", "host", "both"))
    log = folder / "run.kcwire"

    def says(frame: bytes) -> bytes:
        return frame if whose == "host" else retimed(frame, clock)

    began, said = time.monotonic(), None
    with Peer(says=says, seed=rng.randrange(1000)) as peer, ExitStack() as stack:
        if whose != "device":
            host = Leaping(rng)
            for module in ("link", "record"):
                stack.enter_context(mock.patch(f"knobcam.rig.{module}.time", host))
        try:
            capture = kc.record(peer.port, motion, duration_s=_SAMPLES / 5000.0, output=log)
            planned = _SAMPLES if motion == "hand" else None  # else it is led in from rest
            said = wrong(capture, planned)
        except kc.InputError as error:
            said = None if str(error) and "\n" not in str(error) else f"no line: {error!r}"
        except BaseException as error:
            said = repr(error)
        if said is None and time.monotonic() - began > LONGEST_S:
            said = "took longer than 30 s"
        ends, state = time.monotonic() + 2.0, ""
        while state not in ("idle", "fault") and time.monotonic() < ends:
            time.sleep(0.01)
            with suppress(RuntimeError):  # it is being asked by its own thread
                state = peer.state
        if said is None and state not in ("idle", "fault"):
            said = f"the rig is {state} afterwards"
    if said is None and log.exists():
        said = opened(log)
    log.unlink(missing_ok=True)
    return said


def opened(log: Path) -> str | None:
    """Open a log; return what is wrong with what it holds."""
    try:
        return wrong(kc.load(log))
    except kc.InputError as error:
        return None if str(error) and "\n" not in str(error) else f"no line: {error!r}"
    except BaseException as error:
        return repr(error)


def played(seed: int, runs: int, logs: int) -> tuple[Counter[str], list[str]]:
    """Return how often all held, and each time that it did not."""
    found, failures = Counter[str](), []
    with tempfile.TemporaryDirectory() as scratch:
        folder = Path(scratch)
        with Peer(seed=seed % 1000) as peer:
            kc.record(peer.port, "hand", duration_s=_SAMPLES / 5000.0, output=folder / "sound.kcwire")
        head, schema, body = (folder / "sound.kcwire").read_bytes().split(b"\n", 2)
        frames = [frame + b"\0" for frame in body.split(b"\0") if frame]

        def note(what: str, why: str | None) -> None:
            found["well" if why is None else "failed"] += 1
            if why is not None:
                failures.append(f"clocks at a rig, seed {what}: {why}")

        for number in range(runs):
            note(f"{seed} live {number}", live(f"{seed} live {number}", folder))
        for number in range(logs):
            what = f"{seed} log {number}"
            clock = strange(random.Random(what))
            log = folder / "spoiled.kcwire"
            log.write_bytes(b"\n".join((head, schema, b"".join(retimed(frame, clock) for frame in frames))))
            note(what, opened(log))
    return found, failures


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    parser.add_argument("--live", type=int, default=20, help="runs")
    parser.add_argument("--logs", type=int, default=500)
    parser.add_argument("--seed", type=int, default=time.time_ns() % 2**32, help="default a new one")
    args = parser.parse_args()
    print(f"seed {args.seed}")
    found, failures = played(args.seed, args.live, args.logs)
    print(*failures, dict(found), sep="\n")


if __name__ == "__main__":
    main()
