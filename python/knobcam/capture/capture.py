"""A measurement of a mechanism: motion and torque over time, in SI, and what is wrong with them."""

from __future__ import annotations

import os
import warnings
from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from types import MappingProxyType
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike

from ..base import showing
from ..base.arrays import BoolArray, FloatArray, truths, vector
from ..base.door import check as check_kind
from ..base.door import checked
from ..base.renamed import renamed
from ..base.said import said
from ..base.tables import TextTable
from ..errors import InputError
from . import saved
from .finding import Finding, Rows
from .formats import DEFAULT_MAX_BYTES, Table, document, write_table
from .formats.clock import NO_CLOCK, between
from .formats.columnmap import ColumnMap
from .formats.resolve import contract, resolve
from .formats.units import SI, VOLTAGES, Coordinate, torque_unit_of
from .motor import as_torque
from .person import as_told, without
from .quality import check, check_size
from .quality.limits import check_limits
from .quality.ruled import Ruled
from .quality.torque import Limit, usual_limit
from .reading import PLAIN, Reading

if TYPE_CHECKING:
    from ..base.showing import Figure
    from .prepare import Prepared

_KINDS = {
    "coordinate": "str",
    "rate_hz": "float",
    "meta": "Mapping",
    "findings": "Sequence[Finding]",
    "torque_unit": "str",
}
_RATE_AGREEMENT = 0.01  # a given rate that differs more from the time stamps (relative) contradicts them


@dataclass(frozen=True, eq=False, repr=False)
class Capture(showing.Tabled):
    """One recording, immutable: read-only float64 arrays of shape (samples,) in SI.

    `t` s; `theta` rad, `omega` rad/s, `alpha` rad/s^2 and `tau` N m on a rotary axis; m, m/s, m/s^2 and N on
    a linear one. `torque_unit` is another where nobody measured the torque and `tau` is what a motor was
    given: A, V or duty. `omega` and `alpha` are None when they were not measured. `mask` is True where a
    sample is usable; masked samples keep the values that were recorded. `rate_hz` is the usual sampling rate.
    `findings` says what the quality check found, `meta` where the numbers came from.
    """

    t: FloatArray
    theta: FloatArray
    omega: FloatArray | None
    alpha: FloatArray | None
    tau: FloatArray
    mask: BoolArray
    coordinate: Coordinate
    rate_hz: float
    meta: Mapping[str, Any] = field(default_factory=dict)
    findings: tuple[Finding, ...] = ()
    torque_unit: str = ""

    def __post_init__(self) -> None:
        for name, kind in _KINDS.items():
            check_kind(name, getattr(self, name), kind)
        if self.coordinate not in SI:
            raise InputError(f"coordinate={self.coordinate!r} is unknown; choose rotary or linear")
        object.__setattr__(self, "torque_unit", torque_unit_of(self.torque_unit, self.coordinate))
        for name in ("t", "theta", "omega", "alpha", "tau"):
            if getattr(self, name) is not None:
                self._freeze(name, vector(name, getattr(self, name)))
        self._freeze("mask", truths("mask", self.mask))
        object.__setattr__(self, "meta", MappingProxyType(dict(self.meta)))
        object.__setattr__(self, "findings", tuple(self.findings))

    def _freeze(self, name: str, given: FloatArray | BoolArray) -> None:
        values = given.copy()  # the caller's array stays writable
        if values.shape != (np.size(self.t),):
            raise InputError(
                f"columns of different length: t has {np.size(self.t)} samples, "
                f"{name} has shape {values.shape}"
            )
        values.flags.writeable = False
        object.__setattr__(self, name, values)

    def __reduce__(self) -> tuple[Any, ...]:
        arrays = (self.t, self.theta, self.omega, self.alpha, self.tau, self.mask)
        about = (self.coordinate, self.rate_hz, dict(self.meta), self.findings, self.torque_unit)
        return Capture, (*arrays, *about)

    @classmethod
    @renamed(axis="coordinate", rate="rate_hz")
    @checked
    def from_arrays(
        cls,
        *,
        theta: ArrayLike,
        tau: ArrayLike,
        t: ArrayLike | None = None,
        omega: ArrayLike | None = None,
        alpha: ArrayLike | None = None,
        coordinate: Coordinate = "rotary",
        rate_hz: float | None = None,
        meta: Mapping[str, Any] | None = None,
        torque_unit: str = "",
        limit: Limit | None = None,
        overrule: Collection[str] = (),
    ) -> Capture:
        """Return a checked capture from arrays in SI, shape (samples,) each; `rate_hz` stands in for `t`.

        `torque_unit` is A, V or duty where `tau` is what a motor was given, `limit` whose the torque's is,
        `overrule` the findings about which nothing is done (see `load`).
        Raises InputError for arrays of different length and for what leaves nothing to work with.
        """
        given = {"t": t, "theta": theta, "omega": omega, "alpha": alpha, "tau": tau}
        columns = {name: vector(name, values) for name, values in given.items() if values is not None}
        for name, values in columns.items():
            if len(values) != len(columns["theta"]):
                raise InputError(
                    f"columns of different length: theta has {len(columns['theta'])} samples, "
                    f"{name} has {len(values)}; cut them to one length"
                )
        rows = np.arange(1, len(columns["theta"]) + 1)
        checked_as = (limit, rate_hz, meta or {}, rows, "arrays", overrule)
        capture = _checked(columns, coordinate, torque_unit, *checked_as)
        return as_told(capture, "arrays", overrule)

    @property
    def axis(self) -> Coordinate:
        """The older name of `coordinate`."""
        warnings.warn("Capture.axis is now called coordinate", DeprecationWarning, stacklevel=2)
        return self.coordinate

    @property
    def clipped(self) -> bool:
        """Whether samples were masked because the torque sensor was at its limit."""
        return any(one.kind == "clipped" and one.severity == "masked" for one in self.findings)

    def where(self, finding: Finding) -> list[tuple[int, int]]:
        """Return the samples that a finding names, first and last of each run, from 0."""
        first_row = int(self.meta.get("first_row", 1))
        last_row = first_row + self.samples - 1
        inside = [span for span in finding.spans if span[1] >= first_row and span[0] <= last_row]
        return [(max(a, first_row) - first_row, min(b, last_row) - first_row) for a, b in inside]

    def named(self, finding: Finding) -> BoolArray:
        """Return the same as truths, shape (samples,)."""
        named = np.zeros(self.samples, dtype=np.bool_)
        for first, last in self.where(finding):
            named[first : last + 1] = True
        return named

    def overrules(self, kind: str, column: str) -> bool:
        """Whether a person has overruled what was found of this kind in a column."""
        return any(one.overruled and (one.kind, one.column) == (kind, column) for one in self.findings)

    def leave_out(self, *stretches: tuple[float, float]) -> Capture:
        """Return it with what lies in stretches of time masked, each from and to so many s."""
        return without(self, str(self.meta.get("source", "capture")), stretches)

    def with_clipped(self) -> Capture:
        """Return the capture with those samples counted at which the torque sensor was at its limit."""
        if not self.clipped:
            return self
        kept = [
            replace(one, severity="note", found=said("{found}; counted", found=one.found), advice=None)
            if one.kind == "clipped"
            else one
            for one in self.findings
        ]
        return replace(self, mask=self.mask | self.at_limit, findings=tuple(kept))

    @property
    def at_limit(self) -> BoolArray:
        """The samples that were masked because the torque sensor was at its limit, and for nothing else."""
        if not self.clipped:
            return np.zeros(self.samples, dtype=np.bool_)
        finite: BoolArray = np.all([np.isfinite(values) for values in self.columns.values()], axis=0)
        limits = (self.tau[finite].max(), self.tau[finite].min())
        others = [one for one in self.findings if one.severity == "masked" and one.kind != "clipped"]
        otherwise: BoolArray = np.any([self.named(one) for one in others], axis=0)
        return ~self.mask & finite & np.isin(self.tau, limits) & ~otherwise

    @property
    def samples(self) -> int:
        """Number of samples, masked ones included."""
        return len(self.t)

    @property
    def duration_s(self) -> float:
        """Time from the first to the last usable stamp (s)."""
        return float(np.ptp(self.t[self.mask])) if self.mask.any() else 0.0

    @property
    def units(self) -> Mapping[str, str]:
        """SI unit of each column; of the torque what it is in."""
        return MappingProxyType(SI[self.coordinate] | {"tau": self.torque_unit})

    @property
    def columns(self) -> Mapping[str, FloatArray]:
        """The measured columns by name, absent ones left out."""
        every = {"t": self.t, "theta": self.theta, "omega": self.omega, "alpha": self.alpha, "tau": self.tau}
        return {name: values for name, values in every.items() if values is not None}

    def prepare(self, method: str = "smooth", **options: float) -> Prepared:
        """Return the prepared signals of this capture (see `knobcam.prepare`)."""
        from .prepare import prepare

        return prepare(self, method, **options)

    def as_torque(self, *, kt: float | None, resistance_ohm: float | None = None) -> Capture:
        """Return the capture of a motor in A or V with its torque in N m, by its torque constant, N m/A.

        Of a voltage the resistance of the winding has to be known too, for the back-EMF, which is that of the
        smoothed velocity. On a linear axis N and N/A. InputError says what is missing or too much.
        """
        return as_torque(self, kt, resistance_ohm)

    def plot(self) -> Figure:
        """Return a figure of motion and torque over time."""
        return showing.plot(self)

    @checked
    def save(self, path: str | os.PathLike[str]) -> Path:
        """Write the capture and return the path: .csv(.gz), .parquet, .mat, .h5, .hdf5, else the native .npz.

        Numbers, mask, findings, coordinate and meta read back exactly. The file appears whole or not at all;
        InputError says why it cannot be written.
        """
        target = Path(path)
        names = contract(self.coordinate, self.torque_unit)
        content = document.build(
            self.coordinate, self.rate_hz, self.meta, self.columns, self.mask, self.findings
        )
        write_table(
            target, {names[name]: values for name, values in self.columns.items()}, self.mask, content
        )
        return target

    def _facts(self) -> list[tuple[str, str]]:
        masked = int(np.sum(~self.mask))
        source = str(self.meta.get("source", "arrays"))
        facts = [
            ("source", source),
            ("coordinate", self.coordinate),
            ("samples", f"{self.samples}, {masked} masked"),
            ("duration", f"{self.duration_s:.4g} s at {self.rate_hz:.6g} Hz"),
        ]
        for name, values in self.columns.items():
            good = values[self.mask]
            span = f"{good.min():.4g} to {good.max():.4g} {self.units[name]}" if good.size else "all masked"
            facts.append((name, span))
        return facts + [(finding.severity, finding.message) for finding in self.findings]

    def __repr__(self) -> str:
        return "Capture\n" + "\n".join(f"  {name:<9} {value}" for name, value in self._facts())

    def tables(self) -> tuple[TextTable, ...]:
        """What it says of itself, as text."""
        return (TextTable("Capture", (), self._facts()),)


@renamed(axis="coordinate", rate="rate_hz")
@checked
def load(
    path: str | os.PathLike[str],
    *,
    map: ColumnMap | None = None,
    coordinate: Coordinate | None = None,
    rate_hz: float | None = None,
    start: float | None = None,
    end: float | None = None,
    joint: str | None = None,
    kt: float | None = None,
    resistance_ohm: float | None = None,
    limit: Limit | None = None,
    overrule: Collection[str] = (),
    leave_out: Sequence[Sequence[float]] = (),
    max_bytes: int = DEFAULT_MAX_BYTES,
) -> Capture:
    """Read a capture: the native file, a wire log, CSV, JSON, .mat, .npy, .npz, HDF5, Parquet or a ROS 2 bag.

    A file is known by its content. Of a wire log the last run is read, of several joints the one `joint`.

    Columns t_s, theta_rad, omega_rad_s, alpha_rad_s2, tau_Nm (or theta_m, omega_m_s, alpha_m_s2, tau_N; of a
    motor tau_A, tau_V, tau_duty) are understood, and others whose names are plain and unique, with their
    units (`pos_deg`, `Velocity (rpm)`): a finding says what was taken for what. Any others by `map`, for
    example `"t=c0, theta=c1/8192 [turn], tau=c2 [A]"`. `rate_hz` numbers the samples of a file without times.
    `start` and `end` (s, on the capture's own clock) keep a part; what lies in a stretch to `leave_out`, from
    and to so many s, is masked. `kt` and `resistance_ohm` make a torque of what a motor was given, as
    `Capture.as_torque` does. A torque that sits at its extreme is at the `limit` of its "sensor" and masked,
    or of the "actuator" and real, by default where it is in A, V or duty.

    What is wrong with the samples is masked and listed in `findings`; what leaves no capture raises
    InputError. Nothing is done about those to `overrule`, by kind and column: `overrule=["wrap:theta"]`. Row
    numbers count the file's rows of data from 1. Files, and what they inflate to, may have up to `max_bytes`.
    """
    person = (tuple(overrule), tuple(leave_out))
    reading = Reading(map, coordinate, rate_hz, start, end, joint, limit, max_bytes, *person)
    file = Path(path)
    capture = of_table(file, reading.table(file), reading)
    given = kt is not None or resistance_ohm is not None
    return capture.as_torque(kt=kt, resistance_ohm=resistance_ohm) if given else capture


def of_table(file: Path, table: Table, reading: Reading = PLAIN) -> Capture:
    """Return the capture in the content of a file."""
    map, coordinate, rate_hz, limit = reading.map, reading.coordinate, reading.rate_hz, reading.limit
    native = document.check_schema(table) if map is None else None
    if native is not None:
        if coordinate is not None and coordinate != native["axis"]:
            raise InputError(
                f"{file}: the capture has a {native['axis']} axis, not {coordinate}; leave coordinate out"
            )
        coordinate = native["axis"]
    resolved = resolve(table, map, coordinate)
    columns = resolved.columns
    if "t" not in columns and rate_hz is None:
        raise InputError(f"{file}: {NO_CLOCK}; the file has {table.listing()}")
    beside = Ruled(reading.overrule)
    beside.lets((*table.notes, *resolved.notes))
    keep = reading.kept(str(file), columns, beside if native is None else None)
    rows = np.arange(1, len(columns["theta"]) + 1)
    if table.meta is not None:
        meta = dict(table.meta)
    elif native is None:
        meta = document.provenance(file, table.kind, resolved.entries, rate_hz)
    else:
        meta = native["meta"]
    if rows[keep][0] > 1:
        meta = {**meta, "first_row": int(rows[keep][0])}
    part = {name: values[keep] for name, values in columns.items()}
    checked_as = (limit, rate_hz, meta, rows[keep], str(file), reading.overrule)
    capture = _checked(part, resolved.coordinate, resolved.torque_unit, *checked_as)
    if native is not None:
        untouched = isinstance(keep, slice) and native.get("sha256") == document.digest(columns)
        capture = saved.restored(capture, native, table, keep, untouched)
        capture = capture if limit is None else saved.limited(capture, limit, rows[keep])
        capture = saved.ruled(capture, reading.overrule)
        return as_told(capture, str(file), reading.overrule, reading.leave_out)
    limits = {name: at[keep] for name, at in table.limits.items() if name in capture.columns}
    ruled = Ruled(reading.overrule)
    clipped, found = check_limits(limits, capture.mask, rows[keep])
    clipped = ruled.masks(clipped, found, rows[keep])
    # Who states a unit, or computes with the column, knows what it is in; a motor is faster than hands.
    taken = {name for name, entry in resolved.entries.items() if entry.unit is None and entry.plain}
    if not resolved.torque_unit:
        ruled.lets(check_size(capture.columns, capture.mask, capture.coordinate, taken))
    said = (*beside.findings, *capture.findings, *ruled.findings)
    capture = replace(capture, mask=capture.mask & ~clipped, findings=said)
    return as_told(capture, str(file), reading.overrule, reading.leave_out)


def _checked(
    columns: dict[str, FloatArray],
    coordinate: Coordinate,
    torque_unit: str,
    limit: Limit | None,
    rate_hz: float | None,
    meta: Mapping[str, Any],
    rows: Rows,
    source: str,
    overrule: Collection[str] = (),
) -> Capture:
    between(source, columns, rate_hz, None, None)
    whose = limit or usual_limit(torque_unit)
    voltage = torque_unit in VOLTAGES
    verdict = check(columns, coordinate, rows, source, whose, overrule, voltage=voltage)
    if rate_hz is not None and abs(rate_hz / verdict.rate_hz - 1.0) > _RATE_AGREEMENT:
        raise InputError(
            f"{source}: the time stamps run at {verdict.rate_hz:.6g} Hz, a rate of {rate_hz:.6g} was given; "
            f"leave it out, or leave t out of the map"
        )
    found = verdict.columns
    return Capture(
        t=found["t"],
        theta=found["theta"],
        omega=found.get("omega"),
        alpha=found.get("alpha"),
        tau=found["tau"],
        mask=verdict.mask,
        coordinate=coordinate,
        rate_hz=verdict.rate_hz,
        meta=meta,
        findings=verdict.findings,
        torque_unit=torque_unit,
    )
