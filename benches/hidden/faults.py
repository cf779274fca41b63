"""What real logs have beside noise: rows that repeat or are lost, clocks that restart, units and signs.

A fault changes the columns of a capture as a logger or a careless export does. `FAULTS` has each with what
may be said of it, in the words of the findings in JSON documents.
"""

from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from .motions import Floats

Rng = np.random.Generator
Columns = dict[str, Floats]
Put = Callable[[Rng, Columns], Columns]

LATE = 5  # rows that one column comes after the others


class Fault(NamedTuple):
    """How it is put on columns, and what is right to say of it.

    `said`: findings by kind, or kind and column, any of which names it; none where there is nothing to say.
    `effects`: ids that name it as well. `bars`: the log is no longer one of the knob, so that what no model
    explains of it accuses nobody. `keep`: the torque's noise is AR(1) with this coefficient.
    """

    put: Put
    said: frozenset[str] = frozenset()
    effects: frozenset[str] = frozenset()
    bars: bool = False
    keep: float = 0.0


def _nothing(rng: Rng, columns: Columns) -> Columns:
    return columns


def angle_only(rng: Rng, columns: Columns) -> Columns:
    return {name: columns[name] for name in ("t_s", "theta_rad", "tau_Nm")}


def counts(rng: Rng, columns: Columns) -> Columns:
    """An encoder of 16 384 counts a turn and no other motion sensor."""
    step = 2.0 * np.pi / 16384
    return angle_only(rng, columns) | {"theta_rad": step * np.floor(columns["theta_rad"] / step)}


def stale(rng: Rng, columns: Columns) -> Columns:
    """20 to 60 rows that repeat the one before, all but the clock."""
    at = _rows(rng, columns, int(rng.integers(20, 61)))
    columns = _copied(columns)
    for name, values in columns.items():
        if name != "t_s":
            values[at] = values[at - 1]
    return columns


def lost(rng: Rng, columns: Columns) -> Columns:
    """1 to 3 rows missing at 3 to 10 places, with a gap in the clock."""
    at = _rows(rng, columns, int(rng.integers(3, 11)))
    gone = np.concatenate([np.arange(row, row + rng.integers(1, 4)) for row in at])
    return {name: np.delete(values, gone) for name, values in columns.items()}


def lost_unseen(rng: Rng, columns: Columns) -> Columns:
    """The same under a clock that counts the rows that were written."""
    kept = lost(rng, columns)
    return kept | {"t_s": columns["t_s"][: len(kept["t_s"])]}


def torque_spikes(rng: Rng, columns: Columns) -> Columns:
    return _leaping(rng, columns, "tau_Nm", 6, 0.03, 0.1)


def angle_spikes(rng: Rng, columns: Columns) -> Columns:
    return _leaping(rng, columns, "theta_rad", 6, 0.02, 0.2)


def missed(rng: Rng, columns: Columns) -> Columns:
    """An encoder of 16 384 counts a turn that misses 4 to 40 of them at 5 to 20 places, where it is fast.

    At half of them it stands until the knob has gone as far, at the others they are gone at once.
    """
    step = 2.0 * np.pi / 16384
    theta = columns["theta_rad"]
    speed = np.abs(np.gradient(theta))
    fast = np.flatnonzero(speed[200:-400] > np.quantile(speed, 0.6)) + 200
    left = theta.copy()
    for row in np.sort(rng.choice(fast, int(rng.integers(5, 21)), replace=False)):
        size = 4.0 * step * float(rng.integers(1, 11))
        ahead = 1.0 if theta[row + 1] > theta[row - 1] else -1.0
        gone = np.minimum(ahead * (theta[row:] - theta[row]), size) if rng.random() < 0.5 else size
        gone = np.maximum.accumulate(gone) if np.ndim(gone) else gone
        left[row:] -= ahead * gone
    return angle_only(rng, columns) | {"theta_rad": step * np.floor(left / step)}


def torque_held(rng: Rng, columns: Columns) -> Columns:
    """A torque that is new every tenth row."""
    tau = columns["tau_Nm"]
    return columns | {"tau_Nm": tau[np.arange(len(tau)) // 10 * 10]}


def outliers(rng: Rng, columns: Columns) -> Columns:
    """5 % of the torques are anything."""
    return _leaping(rng, columns, "tau_Nm", len(columns["t_s"]) // 20, 0.03, 0.1)


def garbage(rng: Rng, columns: Columns) -> Columns:
    """3 times for 12 to 60 rows a torque that is anything."""
    tau = columns["tau_Nm"].copy()
    for row in 500 * (1 + rng.choice(len(tau) // 500 - 2, 3, replace=False)):
        many = int(rng.integers(12, 61))
        tau[row : row + many] = rng.uniform(-1.0, 1.0, many) * rng.uniform(0.03, 0.3)
    return columns | {"tau_Nm": tau}


def acceleration_spikes(rng: Rng, columns: Columns) -> Columns:
    return _leaping(rng, columns, "alpha_rad_s2", 6, 300.0, 2000.0)


def wild_velocities(rng: Rng, columns: Columns) -> Columns:
    """8 runs of 2 to 6 velocities that are anything."""
    omega = columns["omega_rad_s"].copy()
    for row in 20 * (1 + rng.choice(len(omega) // 20 - 4, 8, replace=False)):
        many = int(rng.integers(2, 7))
        omega[row : row + many] += rng.choice([-1.0, 1.0], many) * rng.uniform(3.0, 20.0, many)
    return columns | {"omega_rad_s": omega}


def wild_accelerations(rng: Rng, columns: Columns) -> Columns:
    """3 times for 20 to 60 rows an acceleration that is anything."""
    alpha = columns["alpha_rad_s2"].copy()
    for row in 500 * (1 + rng.choice(len(alpha) // 500 - 2, 3, replace=False)):
        many = int(rng.integers(20, 61))
        alpha[row : row + many] += rng.choice([-1.0, 1.0]) * rng.uniform(100.0, 1000.0, many)
    return columns | {"alpha_rad_s2": alpha}


def angle_away(rng: Rng, columns: Columns) -> Columns:
    """3 times for 5 to 60 rows an angle that is elsewhere."""
    theta = columns["theta_rad"].copy()
    for row in 500 * (1 + rng.choice(len(theta) // 500 - 2, 3, replace=False)):
        theta[row : row + int(rng.integers(5, 61))] += rng.choice([-1.0, 1.0]) * rng.uniform(0.2, 1.0)
    return columns | {"theta_rad": theta}


def wrap(rng: Rng, columns: Columns) -> Columns:
    """An angle that is kept within a turn, whose end lies where the knob passes."""
    theta = columns["theta_rad"]
    at = np.quantile(theta, rng.uniform(0.3, 0.7))
    return columns | {"theta_rad": np.mod(theta - at, 2.0 * np.pi)}


def missing(rng: Rng, columns: Columns) -> Columns:
    """1 % of the rows have no number in one of their columns."""
    columns = _copied(columns)
    names = [name for name in columns if name != "t_s"]
    for row in np.flatnonzero(rng.random(len(columns["t_s"])) < 0.01):
        columns[names[rng.integers(len(names))]][row] = np.nan
    return columns


def repeated_stamps(rng: Rng, columns: Columns) -> Columns:
    """2 % of the rows have the stamp of the row before."""
    t = columns["t_s"]
    fresh = np.where(rng.random(len(t)) < 0.02, 0, np.arange(len(t)))
    return columns | {"t_s": t[np.maximum.accumulate(fresh)]}


def jitter(rng: Rng, columns: Columns) -> Columns:
    """Stamps that are up to a fifth of an interval early or late; the samples are not."""
    t = columns["t_s"]
    return columns | {"t_s": t + rng.uniform(-0.2, 0.2, len(t)) * (t[1] - t[0])}


def restart(rng: Rng, columns: Columns) -> Columns:
    """A clock that begins anew in the middle."""
    t = columns["t_s"].copy()
    t[len(t) // 2 :] -= t[len(t) // 2]
    return columns | {"t_s": t}


def dead_torque(rng: Rng, columns: Columns) -> Columns:
    """A torque sensor that is switched on in the middle."""
    tau = columns["tau_Nm"].copy()
    tau[: len(tau) // 2] = 0.0
    return columns | {"tau_Nm": tau}


def held(rng: Rng, columns: Columns) -> Columns:
    """An angle that is new every tenth row, and no other motion sensor."""
    theta = columns["theta_rad"]
    return angle_only(rng, columns) | {"theta_rad": theta[np.arange(len(theta)) // 10 * 10]}


def torque_sign(rng: Rng, columns: Columns) -> Columns:
    return columns | {"tau_Nm": -columns["tau_Nm"]}


def sprung_sign(rng: Rng, columns: Columns) -> Columns:
    """The torque of the knob with a return spring as strong as all else, counted the other way."""
    theta, tau = columns["theta_rad"], columns["tau_Nm"]
    spring = rng.uniform(0.5, 2.0) * np.std(tau) / np.std(theta)
    return columns | {"tau_Nm": -(tau + spring * (theta - np.median(theta)))}


def alpha_sign(rng: Rng, columns: Columns) -> Columns:
    return columns | {"alpha_rad_s2": -columns["alpha_rad_s2"]}


def thousandths(rng: Rng, columns: Columns) -> Columns:
    """Torque in mN m under a header that says N m."""
    return columns | {"tau_Nm": 1e3 * columns["tau_Nm"]}


def degrees(rng: Rng, columns: Columns) -> Columns:
    """An angle in degrees under a header that says rad, and no other motion sensor."""
    return angle_only(rng, columns) | {"theta_rad": np.rad2deg(columns["theta_rad"])}


def milliseconds(rng: Rng, columns: Columns) -> Columns:
    """Times in ms under a header that says s."""
    return columns | {"t_s": 1e3 * columns["t_s"]}


def turns_a_minute(rng: Rng, columns: Columns) -> Columns:
    """Velocity in turns a minute under a header that says rad/s."""
    return columns | {"omega_rad_s": columns["omega_rad_s"] * 60.0 / (2.0 * np.pi)}


def gravities(rng: Rng, columns: Columns) -> Columns:
    """Acceleration in units of g."""
    return columns | {"alpha_rad_s2": columns["alpha_rad_s2"] / 9.80665}


def swapped(rng: Rng, columns: Columns) -> Columns:
    """The columns of acceleration and torque in each other's place."""
    return columns | {"alpha_rad_s2": columns["tau_Nm"], "tau_Nm": columns["alpha_rad_s2"]}


def late_angle(rng: Rng, columns: Columns) -> Columns:
    later = {name: values[LATE:] for name, values in columns.items()}
    return later | {"theta_rad": columns["theta_rad"][:-LATE]}


def late_velocity(rng: Rng, columns: Columns) -> Columns:
    omega = columns["omega_rad_s"]
    return columns | {"omega_rad_s": np.concatenate([np.full(LATE, omega[0]), omega[:-LATE]])}


def commanded(rng: Rng, columns: Columns) -> Columns:
    """Torque as it was commanded, which acts later."""
    early = {name: values[:-LATE] for name, values in columns.items()}
    return early | {"tau_Nm": columns["tau_Nm"][LATE:]}


def read_late(rng: Rng, columns: Columns) -> Columns:
    """Torque that is read late, as over a slow bus."""
    later = {name: values[LATE:] for name, values in columns.items()}
    return later | {"tau_Nm": columns["tau_Nm"][:-LATE]}


def joined(rng: Rng, columns: Columns) -> Columns:
    """Two stretches one after the other under one clock, the second with another zero of the angle."""
    n, cut = len(columns["t_s"]), int(rng.integers(500, 2000))
    at = int(rng.uniform(0.4, 0.6) * n)
    kept = {name: np.delete(values, np.arange(at, at + cut)) for name, values in columns.items()}
    kept["theta_rad"][at:] += rng.choice([-1.0, 1.0]) * rng.uniform(0.5, 1.5)
    return kept | {"t_s": columns["t_s"][: n - cut]}


def _copied(columns: Columns) -> Columns:
    return {name: values.copy() for name, values in columns.items()}


def _rows(rng: Rng, columns: Columns, many: int) -> np.ndarray[tuple[int], np.dtype[np.int64]]:
    """Rows anywhere but at the ends, a few apart from each other."""
    return 10 + 10 * np.sort(rng.choice(len(columns["t_s"]) // 10 - 2, many, replace=False))


def _leaping(rng: Rng, columns: Columns, name: str, many: int, least: float, most: float) -> Columns:
    """The columns with single readings of one that are off by `least` to `most`, either way."""
    values = columns[name].copy()
    at = 10 + rng.choice(len(values) - 20, many, replace=False)
    values[at] += rng.choice([-1.0, 1.0], many) * rng.uniform(least, most, many)
    return columns | {name: values}


_SPIKES, _OFF = frozenset({"spike tau"}), frozenset({"spike theta"})

_SINGLE = {
    "clean": Fault(_nothing),
    "angle only": Fault(angle_only),
    "16384 counts, angle only": Fault(counts),
    "stale rows": Fault(stale, frozenset({"stale"})),
    "lost rows, clock too": Fault(lost, frozenset({"gap", "lost"})),
    "lost rows, clock not": Fault(lost_unseen, frozenset({"lost"})),
    "torque spikes": Fault(torque_spikes, _SPIKES),
    "angle spikes": Fault(angle_spikes, _OFF),
    "alpha spikes": Fault(acceleration_spikes, frozenset({"spike alpha"})),
    "angle away for ms": Fault(angle_away, frozenset({"spike theta"})),
    "wild runs of omega": Fault(wild_velocities, frozenset({"spike omega"})),
    "wild runs of alpha": Fault(wild_accelerations, frozenset({"spike alpha"})),
    "missed counts": Fault(missed, frozenset({"missed theta"})),
    "wrap": Fault(wrap, frozenset({"wrap"})),
    "1 % NaN": Fault(missing, frozenset({"non-finite"})),
    "2 % repeated stamps": Fault(repeated_stamps, frozenset({"duplicate"})),
    "clock jitters": Fault(jitter, frozenset({"uneven", "jitter"})),
    "clock restarts": Fault(restart, frozenset({"backward", "restart"})),
    "torque off, first half": Fault(dead_torque, frozenset({"dead tau"})),
    "angle held 10 rows": Fault(held, frozenset({"held theta"})),
    "torque held 10 rows": Fault(torque_held, frozenset({"held tau"})),
    "torque's sign": Fault(torque_sign, frozenset({"sign"}), bars=True),
    "torque in mN m": Fault(thousandths, frozenset({"unit tau"}), bars=True),
    "angle in degrees": Fault(degrees, frozenset({"unit theta"}), bars=True),
    "torque's sign, a spring": Fault(sprung_sign, frozenset({"sign"}), bars=True),
    "alpha's sign": Fault(alpha_sign, frozenset({"scale alpha", "sign alpha"}), bars=True),
    "t in ms": Fault(milliseconds, frozenset({"unit t", "rate"}), bars=True),
    "omega in rpm": Fault(turns_a_minute, frozenset({"unit omega"})),
    "alpha in g": Fault(gravities, frozenset({"unit alpha"})),
    "alpha and tau swapped": Fault(swapped, frozenset({"swapped", "unit tau"}), bars=True),
    "theta late 5 rows": Fault(late_angle, frozenset({"late", "late_column"})),
    "omega late 5 rows": Fault(late_velocity, frozenset({"late", "late_column"})),
    "torque ahead 5 rows": Fault(
        commanded, frozenset({"late", "late_column"}), effects=frozenset({"actuation_delay"})
    ),
    "torque late 5 rows": Fault(
        read_late, frozenset({"late", "late_column"}), effects=frozenset({"torque_lag"})
    ),
    "AR(1) noise 0.9": Fault(_nothing, keep=0.9),
    "AR(1) noise 0.97": Fault(_nothing, keep=0.97),
    "two joined, step": Fault(joined, frozenset({"jump"}), bars=True),
    "5 % torque outliers": Fault(outliers, _SPIKES),
    "garbage torque": Fault(garbage, _SPIKES),
}
_PAIRS = [
    ("angle only", "stale rows"),
    ("angle only", "lost rows, clock not"),
    ("16384 counts, angle only", "stale rows"),
    ("16384 counts, angle only", "wrap"),
    ("stale rows", "lost rows, clock not"),
    ("torque spikes", "wrap"),
]
# The faults of a log, by name, in the order in which they came about.
FAULTS: dict[str, tuple[Fault, ...]] = {name: (fault,) for name, fault in _SINGLE.items()}
FAULTS |= {f"{one} + {other}": (_SINGLE[one], _SINGLE[other]) for one, other in _PAIRS}
