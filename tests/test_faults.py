"""A short part of the table of faults, with a new seed each time; `benches/study_faults.py` has all of it."""

from __future__ import annotations

import time

import faults_rig
from faults_page import played


def test_random_commands_stalls_cuts_and_clocks_harm_no_session() -> None:
    seed = time.time_ns() % 2**32
    print(f"seed {seed}")
    found, failures = played(seed, 4, 40, 100)
    assert failures == [], f"seed {seed}"
    assert {name: counts["failed"] for name, counts in found.items()} == dict.fromkeys(found, 0)
    assert all(counts["well"] > 10 for counts in found.values())


def test_clocks_that_jump_at_a_rig_spoil_no_recording() -> None:
    seed = time.time_ns() % 2**32
    print(f"seed {seed}")
    found, failures = faults_rig.played(seed, 6, 100)
    assert failures == [], f"seed {seed}"
    assert found == {"well": 106}
