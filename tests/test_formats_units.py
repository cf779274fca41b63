"""Units that a header or a map says, beyond SI: inches, pounds, what is of a mass and what is of none."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from command import knobcam, refused
from test_formats_names import OMEGA, TAU, THETA, T, assert_taken, log

import knobcam as kc
from knobcam.capture.formats.header import Label, read_label


@pytest.mark.parametrize(
    ("name", "label"),
    [
        ("displacement [in]", Label("theta", "inch", True)),
        ("torque (in)", Label("tau", None)),  # what comes in, and not its unit
        ("velocity (in/s)", Label("omega", "inch/s", True)),
        ("torque_in_lb", Label("tau", "lbf inch", True)),
        ("Torque [oz-in]", Label("tau", "ozf inch", True)),
        ("torque (lb·ft)", Label("tau", "lbf ft", True)),
        ("force [lbf]", Label("tau", "lbf", True)),
    ],
)
def test_a_header_may_be_in_us_units(name: str, label: Label) -> None:
    read = read_label(name)
    assert (read.quantity, read.unit) == (label.quantity, label.unit)
    assert read.plain is label.plain


def test_a_log_in_inches_and_pounds_is_one_in_metres_and_newtons(tmp_path: Path) -> None:
    columns = (T, THETA / 0.0254, OMEGA / 0.0254, TAU / 4.4482216152605)
    path = log(tmp_path, "time [s],displacement [in],velocity [in/s],force [lbf]", *columns)
    assert "[inch]" in assert_taken(path, "linear")


def test_a_torque_in_ounce_inches_is_known_to_a_map_and_to_a_header(tmp_path: Path) -> None:
    path = log(tmp_path, "time,angle [rad],torque [oz-in]", T, THETA, TAU / 7.0615518e-3)
    assert_taken(path)
    mapped = kc.load(path, map="t=time, theta=angle, tau=`torque [oz-in]` [in oz]")
    np.testing.assert_allclose(mapped.tau, TAU, atol=1e-9)


def test_a_pound_of_mass_is_told_from_one_of_force(tmp_path: Path) -> None:
    path = log(tmp_path, "time,x [m],pull", T, THETA, TAU)
    for unit in ("lb", "kg cm"):
        result = knobcam(
            "import", path, "-o", tmp_path / "x.npz", "--map", f"t=time, theta=`x [m]`, tau=pull [{unit}]"
        )
        refused(result, "write lbf for lb and kgf for kg")


@pytest.mark.parametrize(
    ("name", "parts", "unit"),
    [
        ("torque [%]", 100, "N m"),
        ("torque_permille", 1000, "N m"),
        ("current [%]", 100, "A"),
        ("torque (‰)", 1000, "N m"),
    ],
)
def test_a_torque_in_parts_of_the_rated_one_is_no_duty_cycle(
    tmp_path: Path, name: str, parts: int, unit: str
) -> None:
    """A map that named the column was taken for a share of the supply, or for N m, without a word."""
    path = log(tmp_path, f"time,angle [rad],{name}", T, THETA, parts * TAU / 2.4)
    with pytest.raises(kc.InputError, match="in parts of what the drive is rated for") as asked:
        kc.load(path)
    quoted = name if name.isidentifier() else f"`{name}`"
    told = f"tau={quoted}/{parts}*RATED [{unit}]"
    assert told in str(asked.value)
    with pytest.raises(kc.InputError, match=r"is in parts .*\*RATED"):
        kc.load(path, map=f"t=time, theta=`angle [rad]`, tau={quoted}")
    made = kc.load(path, map=f"t=time, theta=`angle [rad]`, {told.replace('RATED', '2.4')}")
    np.testing.assert_allclose(made.tau, TAU, atol=1e-9)
    duty = kc.load(path, map=f"t=time, theta=`angle [rad]`, tau={quoted} [%]")
    assert duty.torque_unit == "duty"


def test_a_map_takes_the_unit_that_stands_in_a_name_and_says_where_it_could_not(tmp_path: Path) -> None:
    """A name in inches was taken for radians, without a word."""
    path = log(tmp_path, "time,q [grad],pull [lb],push [raw]", T, THETA / (np.pi / 200.0), TAU, TAU)
    capture = kc.load(path, map="t=time, theta=`q [grad]`, tau=`pull [lb]`")
    np.testing.assert_allclose(capture.theta, THETA, atol=1e-9)
    (warning,) = [one.message for one in capture.findings if one.kind == "header"]
    assert "pull [lb] names another unit" in warning
    capture = kc.load(path, map="t=time, theta=`q [grad]`, tau=`push [raw]`")
    assert not [one for one in capture.findings if one.kind == "header"]
