"""Real measurements, where they are there: a test whose file is absent skips, and says so."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from measurements import ROOT, SHARED, real

from knobcam.capture import load


def test_the_emps_axis_reads_from_its_matlab_file() -> None:
    path = real(SHARED / "emps" / "DATA_EMPS.mat")
    capture = load(path, map="t=t, theta=qm, tau=35.1507*vir", coordinate="linear")
    assert capture.samples == 24841
    assert capture.rate_hz == 1000.0
    assert capture.coordinate == "linear"
    assert capture.findings == ()
    by_name = load(path, map="t=t, theta=qm [m], tau=gtau*vir [N]")
    np.testing.assert_allclose(by_name.tau, capture.tau, rtol=1e-5)  # the file has 35.15065


def test_the_odrive_motor_reads_from_its_array_and_its_uneven_clock_is_noted() -> None:
    path = real(SHARED / "odrive_cogging" / "slow2_slower_nocomp_0.npy")
    capture = load(path, map="t=c0, theta=c1/8192 [turn], tau=0.0551*c2", start=1.0)
    assert capture.t[0] >= 1.0
    assert [finding.kind for finding in capture.findings] == ["jitter"]
    speed = np.polyfit(capture.t, capture.theta, 1)[0]
    assert speed == pytest.approx(0.19, rel=0.03)
    assert capture.mask.all()


@pytest.mark.parametrize("number", range(26))
def test_every_practice_capture_reads_at_its_rate(number: int) -> None:
    capture = load(real(SHARED.parent / "practice" / f"knob-{number:02d}.csv.gz"))
    assert capture.samples == 30_000
    assert capture.rate_hz == 5000.0
    assert {finding.kind for finding in capture.findings} <= {"clipped"}


def test_importing_and_reading_csv_imports_nothing_heavy(tmp_path: Path) -> None:
    script = (
        "import sys, pathlib, knobcam.capture as c\n"
        # Long enough for every look at it, with a leap of the angle and one of the torque.
        "rows = [f'{i},{0.1 * i * i + 50 * (i == 60)},{i % 7 + 500 * (i == 80)}\\n' for i in range(200)]\n"
        "p = pathlib.Path(sys.argv[1]); p.write_text('t_s,theta_m,tau_N\\n' + ''.join(rows))\n"
        "c.load(p)\n"
        "print(sorted({m.partition('.')[0] for m in sys.modules}"
        " & {'scipy', 'h5py', 'pyarrow', 'pint', 'matplotlib'}), 'numpy.ma' in sys.modules)\n"
    )
    environment = os.environ | {"PYTHONPATH": str(ROOT / "python")}
    result = subprocess.run(
        [sys.executable, "-c", script, str(tmp_path / "run.csv")],
        capture_output=True,
        text=True,
        env=environment,
        check=True,
    )
    assert result.stdout.strip() == "[] False"
