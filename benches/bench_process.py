"""A whole process, from the shell and back: read a capture, fit it, print the result as JSON.

Ours is `knobcam fit CAPTURE --json` without starting values; the peers are the scripts in `scripts/`, which
start at the right parameters with the period 2 % off. And `knobcam --help` beside `import numpy`.
"""

import json
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np
import pytest
from knobs import PAPER_KNOB, model_of
from ratio import Row, ratio, show

import knobcam as kc

SCRIPTS = Path(__file__).with_name("scripts")
PEERS = {"SciPy script": ("fit_by_scipy.py", 3.0), "lmfit script": ("fit_by_lmfit.py", 5.0)}
HELP_WITHIN = 2.0  # `knobcam --help` in less than this many times `python -c "import numpy"`


def run(*words: str) -> str:
    return subprocess.run([sys.executable, *words], check=True, capture_output=True, text=True).stdout


def capture_in(folder: str) -> str:
    capture = kc.simulate(model_of(PAPER_KNOB), "sweep", noise="paper", seed=1)
    path = Path(folder) / "table2.csv"
    columns = np.column_stack(list(capture.columns.values()))
    # Plain CSV, as any rig writes it and `numpy.loadtxt` reads it.
    header = "t_s,theta_rad,omega_rad_s,alpha_rad_s2,tau_Nm"
    np.savetxt(path, columns, "%.10g", delimiter=",", header=header, comments="")
    return str(path)


def ours(path: str) -> str:
    return run("-m", "knobcam", "fit", path, "--prepare", "none", "--json")


def peer(name: str, path: str) -> str:
    return run(str(SCRIPTS / PEERS[name][0]), path)


def check_answers(path: str) -> None:
    """Every process prints the same parameters."""
    fitted = json.loads(ours(path))["params"]
    for name in PEERS:
        other = json.loads(peer(name, path))["params"]
        values = [fitted[parameter]["value"] for parameter in PAPER_KNOB]
        assert [estimate["value"] for estimate in other.values()] == pytest.approx(values, rel=1e-4)


@pytest.mark.parametrize("name", ["knobcam", *PEERS])
def test_process(benchmark, name, tmp_path):
    path = capture_in(str(tmp_path))
    check_answers(path)
    benchmark.group = "a whole process: read, fit, print"
    benchmark(lambda: ours(path) if name == "knobcam" else peer(name, path))


def rows() -> Iterator[Row]:
    """Measured ratios, the answers checked first."""
    with TemporaryDirectory() as folder:
        path = capture_in(folder)
        check_answers(path)
        for name, (_, reach) in PEERS.items():
            times = ratio(lambda: ours(path), lambda: peer(name, path), 12)  # noqa: B023
            yield Row("a whole process: read, fit, print", name, *times, reach)
    times = ratio(lambda: run("-m", "knobcam", "--help"), lambda: run("-c", "import numpy"), 15)
    yield Row("knobcam --help", 'python -c "import numpy"', *times, 1.0 / HELP_WITHIN)


if __name__ == "__main__":
    show(rows())
