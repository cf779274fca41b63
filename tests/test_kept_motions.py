"""Kept answers of what motions cannot tell and of what others would: see `test_kept.py`."""

from __future__ import annotations

import dataclasses
from types import SimpleNamespace

import numpy as np
import pytest
from answers import Answers
from small import COUPLINGS, detents, recorded, rises
from test_kept import without

import knobcam as kc
from knobcam.errors import InputError
from knobcam.learn import designing, motion_space
from knobcam.learn.contenders import contenders
from knobcam.learn.limitations import limitations
from knobcam.learn.limits import Limits
from knobcam.learn.telling import Telling, Told, wrong_choice

MOTIONS = {
    "never slow": ((40.0, 0.1), (0.2, 4.1)),
    "one speed": ((400.0, 0.005),),
    "slow": ((0.3, 0.6),),
    "even and slow": ((3.0, 0.02),),
    "small": ((0.004, 40.0),),
    "fast": ((0.02, 150.0),),
}


def test_of_what_motions_cannot_tell() -> None:
    told = Answers("limitations")
    for count in (700, 2500):
        for name, waves in MOTIONS.items():
            fit = kc.fit(recorded(23, detents, count=count, waves=waves), detents="no")
            told.put(
                f"{name} {count}", [[part for part in one if part is not None] for one in limitations(fit)]
            )
            told.put("  doubts", list(fit.warnings))
    hum = recorded(24, lambda t, theta, *_: rises(t, theta, *_) + 2e-3 * np.sin(50.0 * 2.0 * np.pi * t))
    comparison = kc.fit(hum).compare()
    for share in np.arange(0.05, 1.0, 0.1):
        for axis in ("time", "frequency", "position", "velocity", "load"):
            splits = tuple(
                dataclasses.replace(one, share=share if one.axis == axis else 0.4, chance=0.01)
                for one in comparison.splits
            )
            worst = dataclasses.replace(comparison, splits=splits).worst
            told.put(f"{axis} of {share:.2f} leads", worst.axis if worst else None)
    told.done()


LIMITS = Limits(0.1, 6.0, 80.0, -1.0, 2.0, duration_s=3.0, sample_rate_hz=1000.0)


def test_of_motions_and_what_they_would_tell(monkeypatch: pytest.MonkeyPatch) -> None:
    told = Answers("motions")
    rng = np.random.default_rng(18)
    motions = motion_space.bank()
    motions += [motion_space.changed(motions[at % len(motions)], rng, 0.3) for at in range(12)]
    for pieces in motions[::3]:
        made = motion_space.plan(pieces, LIMITS, 0.9)
        track = made.track(1000.0)
        told.put(" ".join(piece.kind for piece in pieces), [made.about, made.seconds, LIMITS.hold(track)])
        told.put("  theta", track.theta)
        told.put("  omega", track.omega)
    for name in ("sweep", "multisine"):
        told.put(name, motion_space.standard(name, LIMITS, 1000.0, 0.7).theta)
    weak = recorded(19, lambda t, theta, omega, _: 4e-3 * np.sign(omega) * np.exp(-np.abs(omega) / 0.8))
    story = kc.learn(weak, without=COUPLINGS)
    rivals = contenders(story, ["base", "stribeck"])
    asks = Telling(rivals, 3)
    told.put("asks", [asks.white, asks.edge_hz or 0.0, asks.omega_sd, *(one.name for one in rivals)])
    for pieces in motions[:6]:
        track = motion_space.plan(pieces, LIMITS).track(1000.0)
        try:
            evidence = asks.evidence(track)
        except InputError as error:
            told.put("evidence", str(error))
            continue
        told.put("evidence D", [*evidence.d.ravel(), *evidence.dearer])
        told.put("  pairs D", [*asks.pairs(evidence), asks.least(evidence)])
        told.put("  peaks", [asks.peak(track, draws=False), asks.peak(track, draws=True)])
        told.put("  errors", list(asks.errors(track).values()))
    told.put("alone", [Telling(rivals[1:], 3).least(Told(np.zeros((1, 1)), np.zeros(1)))])
    told.put("wrong choices", [wrong_choice(d) for d in (0.0, 1.0, 10.8, 40.0)])
    told.put("limits", [list(Limits.reached(story.fit.prepared).numbers.values())])
    seconds = iter(range(10**6))
    clock = SimpleNamespace(monotonic=lambda: 0.1 * next(seconds))
    monkeypatch.setattr(designing, "time", clock)
    for name, few, sharpen in (
        ("parts", rivals, None),
        ("sharpens", rivals[1:2], None),
        ("narrow", rivals, None),
    ):
        within = dataclasses.replace(LIMITS, duration_s=0.8, torque_Nm=0.03) if name == "narrow" else LIMITS
        designed = designing.design(few, within, sharpen, 2.0, 4)
        told.put(name, without(designed.document(), "motion", "seconds", "took_s"))
        told.put("  motion", designed.track.theta)
        told.put("  says", [designed.headline, designed.separable, designed.useful])
        told.put("  rows", [list(row) for row in designed.rows()])
    told.done()
