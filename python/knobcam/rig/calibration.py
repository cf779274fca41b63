"""What the sensor tests say of a rig (section 3.1 of the haptic-camera paper), kept with their date."""

from __future__ import annotations

import math
import os
from dataclasses import asdict, dataclass, field, replace
from datetime import UTC, datetime
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
import platformdirs

from ..base import showing
from ..base.reading import parse_toml, read_text
from ..base.tables import TextTable, text_table
from ..base.writing import make_folder, together, write
from ..capture.formats.wire import checked_c_cal
from ..errors import InputError

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    from ..base.arrays import FloatArray
    from ..base.showing import Figure
    from ..capture import Capture
    from ..capture.motions import MotionTrack

SCHEMA = "knobcam.calibration/1"
_MOST_BYTES = 100_000  # of a file that takes one
_FEWEST = 1000
_FOLLOWS = 0.02  # of the commanded motion may be left between it and the recorded one
_WHITE = 1.5  # times what neighbouring samples differ by: more is no noise


class Run(NamedTuple):
    """One sensor test: what was commanded, what was recorded (SI), and the C_cal behind its alpha."""

    commanded: MotionTrack
    recorded: Capture
    c_cal: float


@dataclass(frozen=True, repr=False)
class Calibration(showing.Tabled):
    """The sensors of one rig, by its serial number; what was not tested is None.

    `c_cal` is the mean over the runs, (rad/s^2)/V, and `c_cal_variance` the variance between them, as the
    paper prints them. The `_sd` are the standard deviations of recorded minus commanded (Table 4), `lag_s`
    is the phase lag, how much later the recorded motion is, `anchor_Nm_rad` the stiffness that the torque
    test found.
    """

    serial: str
    date: str
    c_cal: float | None = None
    c_cal_variance: float | None = None
    c_cal_runs: tuple[float, ...] = ()
    theta_sd_rad: float | None = None
    omega_sd_rad_s: float | None = None
    alpha_sd_rad_s2: float | None = None
    lag_s: float | None = None
    tau_sd_Nm: float | None = None
    anchor_Nm_rad: float | None = None
    torque_lag_s: float | None = None
    tests: tuple[Run, ...] = field(default=(), compare=False)

    @classmethod
    def load(cls, path: str | os.PathLike[str]) -> Calibration:
        """Read a calibration file. Raises InputError, one line, for what is none."""
        try:
            text = read_text(path, "calibration", _MOST_BYTES)
        except InputError as error:
            raise InputError(f"{error}, or run `knobcam calibrate` to make one") from None
        values = parse_toml(path, text, "calibration", "run `knobcam calibrate` again")
        if values.pop("schema", None) != SCHEMA:
            raise InputError(f"{path}: is no {SCHEMA}; run `knobcam calibrate` again")
        known = {name for name in cls.__dataclass_fields__ if name != "tests"}
        strange = sorted(values.keys() - known)
        if strange or not {"serial", "date"} <= values.keys():
            raise InputError(f"{path}: has {', '.join(strange) or 'no serial or date'}; calibrate again")
        for name, value in values.items():
            fits = isinstance(value, str) if name in ("serial", "date") else _numbers(value)
            if not fits:
                raise InputError(f"{path}: {name}={value!r} is no such value; run `knobcam calibrate` again")
        runs = tuple(values.get("c_cal_runs", ()))
        for c_cal in (*runs, *([values["c_cal"]] if "c_cal" in values else [])):
            checked_c_cal(c_cal, path)
        values["c_cal_runs"] = runs
        return cls(**values)

    def save(self, path: str | os.PathLike[str]) -> Path:
        """Write the calibration file; it appears whole or not at all."""
        values = {name: value for name, value in asdict(replace(self, tests=())).items() if name != "tests"}
        lines = [f'schema = "{SCHEMA}"']
        for name, value in values.items():
            if isinstance(value, str):
                lines.append(f"{name} = {_quoted(value)}")
            elif value is not None:
                lines.append(f"{name} = {list(value) if isinstance(value, tuple) else value!r}")
        with together():
            make_folder(Path(path).parent)
            return write(path, "\n".join(lines) + "\n")

    def merged(self, other: Calibration) -> Calibration:
        """Return this calibration with what the other one tested; the other's date."""
        own = {name: getattr(other, name) for name in self.__dataclass_fields__}
        told = {name: value for name, value in own.items() if value not in (None, ())}
        return replace(self, **told | {"tests": (*self.tests, *other.tests)})

    def document(self) -> dict[str, Any]:
        """Return it as JSON can keep it."""
        values = {name: getattr(self, name) for name in self.__dataclass_fields__ if name != "tests"}
        return {"schema": SCHEMA, **values, "c_cal_runs": list(self.c_cal_runs)}

    def plot(self) -> Figure:
        """Commanded and recorded signals, as in Figures 9 and 10 of the paper."""
        return showing.plot(self)

    def _rows(self) -> list[tuple[str, str, str]]:
        rows = [
            ("C_cal, mean over runs", self.c_cal, "(rad/s^2)/V"),
            ("C_cal, variance between runs", self.c_cal_variance, "((rad/s^2)/V)^2"),
            ("theta, standard deviation", self.theta_sd_rad, "rad"),
            ("omega", self.omega_sd_rad_s, "rad/s"),
            ("alpha", self.alpha_sd_rad_s2, "rad/s^2"),
            ("tau", self.tau_sd_Nm, "N m"),
            ("phase lag of theta", self.lag_s, "s"),
            ("phase lag of tau", self.torque_lag_s, "s"),
            ("stiffness of the anchor", self.anchor_Nm_rad, "N m/rad"),
        ]
        return [(name, f"{value:.4g}", unit) for name, value, unit in rows if value is not None]

    def __repr__(self) -> str:
        table = text_table(("figure", "value", "unit"), self._rows())
        return f"Calibration of {self.serial}, {self.date}\n{table}"

    def tables(self) -> tuple[TextTable, ...]:
        """What it says of itself, as text."""
        caption = f"Calibration of {self.serial}, {self.date}"
        return (TextTable(caption, ("figure", "value", "unit"), self._rows()),)


def _numbers(value: object) -> bool:
    values = value if isinstance(value, list) else [value]
    return all(isinstance(x, (int, float)) and math.isfinite(x) for x in values)


def _quoted(text: str) -> str:
    return '"' + text.replace("\\", "\\\\").replace('"', '\\"') + '"'


def usual_path(serial: str) -> Path:
    """Return where the calibration of a rig is kept, so that captures find it."""
    name = "".join(letter if letter.isalnum() or letter in "-_." else "_" for letter in serial)
    return Path(platformdirs.user_data_dir("knobcam")) / "calibration" / f"{name}.toml"


def usual(serial: str) -> Calibration | None:
    """Return the calibration that is kept of a rig, if there is one."""
    path = usual_path(serial)
    return Calibration.load(path) if path.is_file() else None


def spatial(serial: str, runs: Sequence[Run]) -> Calibration:
    """Compare commanded and recorded motion of a free gripper: C_cal, Table 4's motion sensors, phase lag.

    C_cal is the least-squares factor between recorded volts and commanded acceleration (Equation 7), run by
    run. A free gripper feels no torque, so what the torque sensor says is its own; with a knob in it that is
    left out. Raises InputError for runs that are too short, or in which the accelerometer was silent.
    """
    factors, differences = [], []
    for number, run in enumerate(runs, 1):
        at = _usable(run, number)
        left = np.std(run.recorded.theta[at] - run.commanded.theta[at]) / np.std(run.commanded.theta[at])
        if left > _FOLLOWS:
            raise InputError(
                f"run {number}: the gripper did not follow the motion; free it for the spatial test, or run "
                "--test torque"
            )
        volts, wanted = run.recorded.columns["alpha"][at] / run.c_cal, run.commanded.alpha[at]
        if not np.any(volts):
            raise InputError(f"run {number}: the accelerometer says nothing; check its cable")
        if wanted @ volts == 0.0:
            raise InputError(f"run {number}: the accelerometer says nothing; check its cable")
        # The noise is in the volts: regressed the other way round it would pull the factor towards zero.
        factor = checked_c_cal(float(wanted @ wanted / (wanted @ volts)), f"run {number}")
        factors.append(factor)
        columns = run.recorded.columns
        start = columns["theta"][at][0] - run.commanded.theta[at][0]
        differences.append(
            (
                columns["theta"][at] - start - run.commanded.theta[at],
                columns["omega"][at] - run.commanded.omega[at],
                factor * volts - wanted,
                phase_lag(run.commanded.omega[at], columns["omega"][at], run.recorded.rate_hz),
            )
        )
    sds = [float(np.std(np.concatenate([run[i] for run in differences]))) for i in range(3)]
    return Calibration(
        serial,
        _now(),
        c_cal=float(np.mean(factors)),
        c_cal_variance=float(np.var(factors, ddof=1)) if len(factors) > 1 else None,
        c_cal_runs=tuple(factors),
        theta_sd_rad=sds[0],
        omega_sd_rad_s=sds[1],
        alpha_sd_rad_s2=sds[2],
        lag_s=float(np.mean([run[3] for run in differences])),
        tau_sd_Nm=_own_noise(np.concatenate([run.recorded.tau[_usable(run, 1)] for run in runs])),
        tests=tuple(runs),
    )


def _own_noise(tau: FloatArray) -> float | None:
    """Standard deviation of a torque that is noise alone; None for one that is not."""
    sd, quick = float(np.std(tau)), float(np.std(np.diff(tau)) / math.sqrt(2.0))
    return sd if sd < _WHITE * quick else None


def anchored(serial: str, runs: Sequence[Run]) -> Calibration:
    """Compare commanded position and recorded torque of an anchored gripper: the torque sensor of Table 4.

    The theoretical torque is the commanded angle times the stiffness of the anchored rig, which is fitted.
    Raises InputError where the gripper moved: it is not anchored.
    """
    wanted, tau, lags = [], [], []
    for number, run in enumerate(runs, 1):
        at = _usable(run, number)
        span = np.ptp(run.recorded.theta[at])
        if span > 0.1 * np.ptp(run.commanded.theta[at]):
            raise InputError(
                f"run {number}: the gripper turned by {span:.3g} rad; anchor it for the torque test, or run "
                "--test spatial"
            )
        wanted.append(run.commanded.theta[at])
        tau.append(run.recorded.tau[at])
        lags.append(phase_lag(wanted[-1], tau[-1], run.recorded.rate_hz))
    x, y = np.concatenate(wanted), np.concatenate(tau)
    stiffness = float(x @ y / (x @ x))
    return Calibration(
        serial,
        _now(),
        tau_sd_Nm=float(np.std(y - stiffness * x)),
        anchor_Nm_rad=stiffness,
        torque_lag_s=float(np.mean(lags)),
        tests=tuple(runs),
    )


def phase_lag(wanted: FloatArray, recorded: FloatArray, rate_hz: float) -> float:
    """Return how much later `recorded` is, s: the shift that least squares finds, shape (samples,) both.

    Linear in a small shift: recorded = gain (wanted - lag d wanted/dt).
    """
    slope = np.gradient(wanted) * rate_hz
    basis = np.stack([wanted, slope], axis=1)
    gain, shift = np.linalg.lstsq(basis, recorded, rcond=None)[0]
    return float(-shift / gain) if gain != 0.0 else math.nan


def _usable(run: Run, number: int) -> NDArray[np.intp]:
    """Indices of the samples that were recorded, in the run and in what was commanded."""
    rate = run.recorded.rate_hz
    index = np.round((run.recorded.t - run.recorded.t[0]) * rate).astype(int)
    good = run.recorded.mask & (index < len(run.commanded.t))
    if not np.array_equal(index[good], np.flatnonzero(good)) or good.sum() < _FEWEST:
        raise InputError(f"run {number}: samples are missing in it; check the cable and run the test again")
    return np.flatnonzero(good)


def _now() -> str:
    return datetime.now(UTC).isoformat(timespec="seconds")
