"""The wire log of a rig: what came over the port, byte for byte, behind one line that says when and why.

The line before is `MAGIC`; the header is one line of JSON. Columns are worked out from the raw numbers each
time that the log is read.
"""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, cast

import numpy as np

from ... import _core
from ...base.arrays import BoolArray, FloatArray
from ...base.said import Advice, said
from ...base.writing import RECORDING
from ...errors import InputError
from ..finding import Finding
from .table import Table

MAGIC = RECORDING
SCHEMA = "knobcam.wirelog/1"
RATE_TOLERANCE = 0.01
"""A device whose clock and index differ by more from the rate that it claims (relative) lies."""

_SPAN_S = 0.05  # of the device's clock, before its rate is judged
_NO_READING = -32768
_HEADER = 1 << 20
_FIRMWARE = Advice("correct the firmware")
_SENSITIVITIES = (1e-3, 1e7)  # of accelerometers, (rad/s^2)/V; that of the paper has 1148


@dataclass(frozen=True)
class Content:
    """What a wire log holds: its header, the last DESCRIPTOR, the runs, and all else as the core reads it."""

    source: str
    header: Mapping[str, Any]
    device: Mapping[str, Any] | None
    runs: Sequence[Mapping[str, Any]]
    read: Mapping[str, Any]


def header_line(header: Mapping[str, Any]) -> bytes:
    """Return the bytes with which a log begins."""
    return MAGIC + json.dumps({"schema": SCHEMA, **header}).encode() + b"\n"


def parse(source: str, raw: bytes) -> Content:
    """Return the content of a log, whole or cut off anywhere behind its header.

    Raises InputError for what is no log, or one of a later version.
    """
    end = raw.find(b"\n", len(MAGIC), _HEADER)
    if not raw.startswith(MAGIC) or end < 0:
        raise InputError(f"{source}: is no whole wire log: its header is missing; capture again")
    try:
        header = json.loads(raw[len(MAGIC) : end])
    except (ValueError, RecursionError) as error:
        raise InputError(f"{source}: the header of the wire log is damaged ({error})") from error
    if not isinstance(header, dict) or header.get("schema") != SCHEMA:
        raise InputError(f"{source}: is no {SCHEMA}, which this version reads; update knobcam")
    read = _core.wire_log(raw[end + 1 :])
    said = [frame["message"] for frame in read["said"]]
    devices = [message["device"] for message in said if message["type"] == "DESCRIPTOR"]
    if len({device["serial"] for device in devices}) > 1:
        raise InputError(f"{source}: two rigs speak in it, and nobody knows whose samples these are")
    return Content(source, header, devices[-1] if devices else None, read["runs"], read)


def read_wire(path: Path) -> Table:
    """Return the columns of the last run of a wire log."""
    return table(parse(str(path), path.read_bytes()))


def table(content: Content, run: int = -1, c_cal: float | None = None) -> Table:
    """Return the columns of a run (by its place, -1 the last), alpha by `c_cal` or the one of the recording.

    A sample that did not come has no row, a channel without a reading is NaN. Raises InputError where there
    is nothing to work with.
    """
    source, device = content.source, content.device
    if device is None:
        raise InputError(f"{source}: no rig says in it what it is (no DESCRIPTOR); capture again")
    _core.wire_check({"type": "DESCRIPTOR", "device": device})
    runs = content.runs
    if not -len(runs) <= run < len(runs):
        raise InputError(f"{source}: holds {len(runs)} runs, there is no run {run}; capture again")
    raw = runs[run]
    if len(raw["index"]) == 0:
        raise InputError(f"{source}: no sample came in this run; check the rig and capture again")
    rate, notes = _rate(raw, device["rate_hz"])
    calibration = _calibration(content, device, c_cal)
    columns, limits = in_si(raw, device, rate, calibration["c_cal"])
    if "tau_Nm" not in columns:
        raise InputError(
            f"{source}: the rig {device['serial']} has no torque sensor; there is nothing to fit"
        )
    meta = {
        "source": source,
        "format": "wire log",
        "date": content.header.get("date", ""),
        "motion": content.header.get("motion"),
        "serial": device["serial"],
        "firmware": f"{device['firmware_major']}.{device['firmware_minor']}",
        "run": raw["run"],
        "calibration": calibration,
        "account": dict(raw["account"]),
        "notes": "",
    }
    notes += [*_losses(raw, _planned(content)), *_damage(content.read, raw["account"])]
    return Table(source, "wire log", columns, meta=meta, limits=limits, notes=tuple(notes))


def in_si(
    raw: Mapping[str, Any], device: Mapping[str, Any], rate_hz: float, c_cal: float
) -> tuple[dict[str, FloatArray], dict[str, BoolArray]]:
    """Return the columns of raw samples in SI, NaN where there is no reading, and which were at a limit."""
    columns = {"t_s": raw["index"] / rate_hz, "theta_rad": raw["count"] / device["counts_per_rad"]}
    limits: dict[str, BoolArray] = {}
    for name, key in (("omega_rad_s", "omega"), ("alpha_rad_s2", "alpha"), ("tau_Nm", "tau")):
        channel = device[key]
        if channel["unit"] != "absent":
            factor = c_cal if key == "alpha" else 1.0
            columns[name] = factor * _values(raw[key], channel)
            limits[key] = _clipped(raw[key], channel)
    return columns, limits


def _values(raw: np.ndarray, channel: Mapping[str, Any]) -> FloatArray:
    values: FloatArray = channel["scale"] * raw.astype(np.float64) + channel["offset"]
    values[raw == _NO_READING] = np.nan
    return values


def _clipped(raw: np.ndarray, channel: Mapping[str, Any]) -> BoolArray:
    at = (raw <= channel["lower"]) | (raw >= channel["upper"])
    return np.asarray(at & (raw != _NO_READING), dtype=np.bool_)


def _calibration(content: Content, device: Mapping[str, Any], c_cal: float | None) -> dict[str, Any]:
    """Return the C_cal to use and where it comes from."""
    if c_cal is not None:
        return {"c_cal": checked_c_cal(c_cal, content.source), "from": "given"}
    kept = content.header.get("calibration") or {}
    if kept.get("c_cal") is not None:
        checked_c_cal(kept["c_cal"], content.source)
        return {"c_cal": float(kept["c_cal"]), "from": f"calibration of {kept.get('date', 'an unknown day')}"}
    return {"c_cal": device["c_cal"], "from": "descriptor"}


def checked_c_cal(c_cal: object, source: object) -> float:
    """Return a sensitivity of an accelerometer, (rad/s^2)/V. Raises InputError for one that no sensor has."""
    least, most = _SENSITIVITIES
    fits = isinstance(c_cal, int | float) and not isinstance(c_cal, bool) and least <= c_cal <= most
    if not fits:
        raise InputError(
            f"{source}: c_cal={c_cal!r} (rad/s^2)/V is no sensitivity of an accelerometer, which is "
            f"{least:g} to {most:g}; check its cable and its direction, and run `knobcam calibrate` again"
        )
    return float(cast("float", c_cal))


def _planned(content: Content) -> int | None:
    """Samples that the run was to have, as the header says."""
    motion = content.header.get("motion")
    samples = motion.get("samples") if isinstance(motion, dict) else None
    return samples if isinstance(samples, int) and samples > 0 else None


def _rate(raw: Mapping[str, Any], claimed: float) -> tuple[float, list[Finding]]:
    """Return the rate of the samples, Hz: the claimed one, unless the device's own clock contradicts it.

    A clock that leaps, stands or jitters contradicts nothing but itself: the count of samples goes on.
    """
    index, stamp = raw["frame_index"], raw["frame_time_us"]
    passed = 1e-6 * (stamp - stamp[0]).astype(np.int64)  # exact, however large the numbers are
    if len(index) < 2 or abs(passed[-1]) <= _SPAN_S:
        return claimed, []
    # Over an eighth of the run: a leap is in few of these, and what a frame is late by is little beside them.
    far = max(1, len(index) // 8)
    period = np.sort((passed[far:] - passed[:-far]) / (index[far:] - index[:-far]))
    low, usual, high = (float(period[round(share * (len(period) - 1))]) for share in (0.25, 0.5, 0.75))
    steady = usual > 0.0 and high - low <= RATE_TOLERANCE * usual
    count = len(raw["index"])
    if steady and abs(1.0 / usual / claimed - 1.0) > RATE_TOLERANCE:
        found = said(
            "{t}: the rig says {claimed:.6g} Hz, its clock says {ticks:.6g} Hz; the clock is believed",
            claimed=claimed,
            ticks=1.0 / usual,
        )
        return 1.0 / usual, [Finding("rate", "t", count, (), found, "warning", _FIRMWARE)]
    off = passed[-1] - (index[-1] - index[0]) / claimed
    if steady and abs(off) <= RATE_TOLERANCE * passed[-1]:
        return claimed, []
    found = said(
        "{t}: the rig's clock does not go on evenly, at the end it is off by {off:.3g} s; the samples are "
        "counted, at the {claimed:.6g} Hz that it says",
        off=off,
        claimed=claimed,
    )
    return claimed, [Finding("clock", "t", count, (), found, "warning", _FIRMWARE)]


def _losses(raw: Mapping[str, Any], planned: int | None) -> list[Finding]:
    """What is missing at the ends, which no gap between two samples shows."""
    account, found = raw["account"], []
    for end, key in (("before the first", "missing_head"), ("after the last", "missing_tail")):
        if account[key]:
            lost = said(
                "{t}: {count} samples {end} did not arrive; nothing is filled in", count=account[key], end=end
            )
            found.append(Finding("gap", "t", account[key], (), lost, "warning"))
    if account["produced"] is None:
        of = (
            ""
            if planned is None
            else f" ({len(raw['index'])} of the {planned} samples that were planned came)"
        )
        end = said(
            "{t}: the rig did not say how the run ended{of}; what is missing at its end is unknown", of=of
        )
        found.append(Finding("cut", "t", 1, (), end, "note"))
    elif planned is not None and account["produced"] < planned:
        early = said(
            "{t}: the run was ended after {produced} of the {planned} samples that were planned",
            produced=account["produced"],
            planned=planned,
        )
        found.append(Finding("cut", "t", planned - account["produced"], (), early, "note"))
    return found


def _damage(read: Mapping[str, Any], account: Mapping[str, Any]) -> list[Finding]:
    """What came over the port and is no frame, or says of one sample what another frame says otherwise."""
    found = []
    if read["corrupt"]:
        lost = said(
            "{corrupt} stretches of the log ({size} bytes) are no frames and were left out",
            corrupt=read["corrupt"],
            size=read["corrupt_bytes"],
        )
        found.append(Finding("corrupt", "t", read["corrupt"], (), lost, "warning", Advice("check the cable")))
    if account["contradicted"]:
        twice = said(
            "{count} samples came twice with different content; the first is kept, and nobody knows which is "
            "right",
            count=account["contradicted"],
        )
        found.append(Finding("contradicted", "t", account["contradicted"], (), twice, "warning", _FIRMWARE))
    return found
