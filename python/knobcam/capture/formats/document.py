"""What a capture says about itself, as the JSON that travels inside every file knobcam writes."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Mapping
from datetime import UTC, datetime
from pathlib import Path
from typing import Any, get_args

import numpy as np

from ...base.arrays import BoolArray, FloatArray, runs
from ...base.door import check
from ...base.pages_said import Way
from ...base.said import Advice, Said
from ...errors import InputError
from ..finding import OVERRULED, Finding, Severity
from .clock import FASTEST_HZ, SLOWEST_HZ
from .table import Table

SCHEMA = "knobcam.capture/1"


def build(
    coordinate: str,
    rate_hz: float,
    meta: Mapping[str, Any],
    columns: Mapping[str, FloatArray],
    mask: BoolArray,
    findings: tuple[Finding, ...],
) -> dict[str, Any]:
    """Return the document; InputError when `meta` holds what JSON cannot."""
    document = {
        "schema": SCHEMA,
        "axis": coordinate,
        "rate_hz": rate_hz,
        "samples": len(mask),
        "sha256": digest(columns),
        "masked_rows": [[int(a) + 1, int(b)] for a, b in zip(*runs(~mask), strict=True)],
        "findings": [finding.document() for finding in findings],
        "meta": dict(meta),
    }
    try:
        if json.loads(json.dumps(document)) != document:
            raise InputError("meta: holds keys or values that JSON would change; use text, numbers and lists")
    except (TypeError, ValueError, RecursionError) as error:
        raise InputError(f"meta: cannot be saved ({error}); use text, numbers, lists and dicts") from error
    return document


def provenance(file: Path, kind: str, entries: Mapping[str, object], rate_hz: float | None) -> dict[str, Any]:
    """Return where the numbers of a capture come from: its file, and what each column was taken to be."""
    modified = datetime.fromtimestamp(file.stat().st_mtime, UTC)
    meta: dict[str, Any] = {
        "source": str(file),
        "format": kind,
        "calibration": {name: str(entry) for name, entry in entries.items()},
        "date": modified.isoformat(timespec="seconds"),
        "notes": "",
    }
    if rate_hz is not None:
        meta["rate_hz"] = rate_hz
    return meta


def digest(columns: Mapping[str, FloatArray]) -> str:
    """Return a fingerprint of numbers, by which a file that was changed since is known."""
    total = hashlib.sha256()
    for name, values in columns.items():
        # A NaN has many forms, of which text keeps one.
        plain = np.where(np.isnan(values), np.nan, values)
        total.update(f"{name} {len(values)} ".encode() + plain.astype("<f8").tobytes())
    return total.hexdigest()


def check_schema(table: Table) -> Mapping[str, Any] | None:
    """Return the document of a file that knobcam wrote, None for any other; InputError for a newer one."""
    document = table.document
    if document is None:
        return None
    if document.get("schema") != SCHEMA:
        raise InputError(
            f"{table.source}: schema {document.get('schema')!r} is unknown, this version reads {SCHEMA}; "
            f"update knobcam"
        )
    if document.get("axis") not in ("rotary", "linear") or not isinstance(document.get("meta"), dict):
        raise InputError(
            f"{table.source}: its description names no axis or no meta; export the capture again"
        )
    return document


def stored_mask(document: Mapping[str, Any], table: Table, samples: int) -> BoolArray:
    """Return which samples the document calls usable; all are when rows were added or removed since."""
    if table.mask is not None and len(table.mask) == samples:
        return table.mask
    mask = np.ones(samples, dtype=np.bool_)
    if document.get("samples") == samples:
        for first, last in document.get("masked_rows", ()):
            mask[int(first) - 1 : int(last)] = False
    return mask


def stored_rate(document: Mapping[str, Any]) -> float:
    """Return the rate of the document, Hz."""
    rate = float(document["rate_hz"])
    if not SLOWEST_HZ <= rate <= FASTEST_HZ:
        raise ValueError(f"rate_hz {rate}")
    return rate


def stored_findings(document: Mapping[str, Any]) -> tuple[Finding, ...]:
    """Return the findings of the document."""
    return tuple(_finding(entry) for entry in document.get("findings", ()))


def _finding(entry: Mapping[str, Any]) -> Finding:
    # Versions before had single rows.
    spans = ((row, row) if isinstance(row, int) else (int(row[0]), int(row[1])) for row in entry["rows"])
    said = {name: entry[name] for name in ("kind", "column", "count", "severity")}
    for name, value in said.items():
        check(name, value, "int" if name == "count" else "str")
    if said["severity"] not in get_args(Severity):
        raise ValueError(f"severity {said['severity']!r}")
    found, advice = _said(entry)
    overruled = entry.get("overruled", False) is True
    return Finding(spans=tuple(spans), **said, found=found, advice=advice, overruled=overruled)


def _said(entry: Mapping[str, Any]) -> tuple[Said, Advice | None]:
    """What was found and what could be done about it; versions before had one sentence of both."""
    if "found" not in entry:
        check("message", entry["message"], "str")
        whole = entry["message"].removeprefix(OVERRULED[True]).removeprefix(OVERRULED[False])
        found, _, advice = whole.partition("; masked")
        return Said(found), Advice(advice.lstrip(",; ")) if advice else None
    check("advice", entry["advice"], "str")
    if entry["way"] not in get_args(Way):
        raise ValueError(f"way {entry['way']!r}")
    return Said.of(entry["found"]), Advice(entry["advice"], entry["way"]) if entry["advice"] else None
