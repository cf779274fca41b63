"""Kept answers of decisions over all that they may be asked about, not only what a capture happens to ask.

Fits, candidates and captures are stand-ins here with numbers at random: see `test_kept.py`.
"""

from __future__ import annotations

import dataclasses
import math
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from answers import Answers
from small import RATE_HZ, WAVES, recorded

import knobcam as kc
from knobcam.errors import InputError
from knobcam.fit import doubts, plausible, power, refit, runs, zeros
from knobcam.fit.compare import Comparison, Figures, Region, Split
from knobcam.fit.estimate import Constants, Estimate
from knobcam.fit.rule import RULE
from knobcam.fit.stiction import Stiction
from knobcam.learn import (
    agreement,
    contenders,
    cut,
    exchanged,
    joints,
    ladder,
    motion_space,
    rivals,
    selection,
)
from knobcam.learn.limits import Limits
from knobcam.learn.telling import Rival, Telling, Told

Random = np.random.Generator


def about(rng: Random, size: float) -> float:
    """From a tenth to ten times as much."""
    return size * 10.0 ** float(rng.uniform(-1.0, 1.0))


def one_of(rng: Random, *values: Any) -> Any:
    return values[int(rng.integers(len(values)))]


def estimate(rng: Random, value: float | None = None, unit: str = "N m") -> Estimate:
    """Of a value that is known more or less well, or not at all, or fixed."""
    value = one_of(rng, -1.0, 1.0) * about(rng, 1e-2) if value is None else value
    se = one_of(rng, math.nan, 0.0, *(about(rng, 0.3 * abs(value)) for _ in range(6)))
    return Estimate(value, (value - 1.96 * se, value + 1.96 * se), unit, se)


def fitted(
    rng: Random, before: Any = None, names: tuple[str, ...] = ("inertia.M", "coulomb.pos", "detent.S")
) -> Any:
    """A fit that is better or worse than the one before."""
    noise = one_of(rng, 0.0, math.nan, *(1e-3,) * 6)
    rmse = (before.rmse if before else 4e-3) * float(
        rng.choice([0.3, 0.9, 0.97, 0.999, 1.0, 1.0 + 1e-12, 1.1])
    )
    unseen = rmse * float(rng.choice([1.0, 1.0 + 1e-12, 1.01, 1.2]))
    free = [*names, *(f"more.{i}" for i in range(int(rng.integers(4))))]
    return SimpleNamespace(
        rmse=rmse,
        rmse_heldout=unseen,
        noise_floor=noise,
        white_squares=1500.0,
        excess=max(rmse**2 - noise**2, 0.0) if noise > 0.0 else rmse**2,
        torque_unit="N m",
        core=SimpleNamespace(free=free),
        # A torque of many digits.
        prepared=[
            SimpleNamespace(
                core=SimpleNamespace(used=1500),
                capture=SimpleNamespace(tau=np.array([0.0, 1e-15]), mask=slice(None)),
            )
        ],
        params={name: estimate(rng, unit="rad" if name.endswith("S") else "N m") for name in names},
        model=SimpleNamespace(phases={name for name in names if name.endswith("S")}),
        before=before,
    )


def test_of_what_is_said_of_any_value() -> None:
    told, rng = Answers("values"), np.random.default_rng(31)
    for _ in range(60):
        one = estimate(rng)
        low = one_of(rng, 0.0, -1e-2, -math.inf, about(rng, 5e-3))
        high = one_of(rng, math.inf, low + about(rng, 1e-2), low)
        told.put("value", [plausible.out_of_range(one, (low, high)), one.interval, one.determined])
    for _ in range(40):
        late = one_of(rng, None, estimate(rng, one_of(rng, 2e-3, -1e-3)))
        constants = Constants(
            {"kt": estimate(rng)}, one_of(rng, {}, {"R": "it is not seen"}), {}, False, late
        )
        told.put("constants", constants.in_words())
        told.put("  document", constants.document())
    for _ in range(30):
        stuck = SimpleNamespace(
            rmse=about(rng, 1e-3),
            noise_floor=1e-3,
            prepared=[
                SimpleNamespace(
                    capture=SimpleNamespace(findings=[SimpleNamespace(kind=one_of(rng, "clipped", "unit"))])
                )
            ],
        )
        three = [
            one_of(rng, None, estimate(rng, 1e-2), Estimate(1e-2, (0.0, 2e-2), "rad/s", 1e-2))
            for _ in range(3)
        ]
        found = Stiction(stuck, *three, (int(rng.integers(5)), int(rng.integers(5))))
        told.put("stiction", [found.determined, *found.missing, *repr(found).splitlines()])
        told.put("  document", found.document())
        told.put("  table", [list(row) for row in found.tables()[0].rows])
    for _ in range(20):
        fit = SimpleNamespace(
            prepared=[SimpleNamespace(capture=SimpleNamespace(meta={"source": name})) for name in ("a", "")],
            params={"offset.b": estimate(rng), "offset.b@b": estimate(rng), "inertia.M": estimate(rng)},
        )
        every = runs.per_capture(fit)
        told.put("runs", runs.in_words(every))
        told.put("  document", runs.document(every))
        fit.white_squares = 1500.0
        fit.noise_floor, fit.rmse = one_of(rng, 0.0, math.nan, 1e-3), about(rng, 1.02e-3)
        told.put("  at floor", [doubts.at_floor(fit)])
    told.done()


def test_of_what_is_said_of_any_richer_fit() -> None:
    told, rng = Answers("richer"), np.random.default_rng(32)
    for _ in range(80):
        before = fitted(rng)
        after = fitted(rng, before)
        told.put("worse", list(refit.worse(after)))
        if after.noise_floor > 0.0:
            told.put("  worth", [refit.unpaid(after, before), refit.needless(after, before)])
            told.put("  gain", [refit.gain(before, after, after), exchanged._score(after, before)])
            told.put("  joints", [joints._explains(after.rmse * float(f), before) for f in (0.3, 0.7, 1.0)])
        moves = refit.moved(before, after)
        told.put("  moved", {name: list(one) for name, one in moves.items()})
        step = ladder.LearningStep(after, "stribeck")
        told.put("  mainly", [selection._mainly(step), refit.error_fall(before, after)])
        told.put("  percent", [refit.percent(refit.error_fall(before, after))])
        told.put("  unseen", plausible._unseen(after, before))
    told.put("none", [refit.error_fall(SimpleNamespace(rmse=0.0), SimpleNamespace(rmse=1.0))])
    told.put("weights", [rivals.in_percent(one) for one in (None, 0.0, 0.5, 0.9989, 0.9991, 1.0)])
    told.done()


def candidate(rng: Random, effect: str, base: Any) -> Any:
    gain = about(rng, 40.0)
    return SimpleNamespace(
        effect=effect,
        gain=gain,
        score=gain - RULE.price * 2,
        charged=float(rng.choice([1.0, 1.5, 2.0])),
        p_value=float(rng.choice([1e-3, 0.02, 0.3])),
        rmse=float(rng.choice([0.9e-3, 1.1e-3, 2e-3])),
        equivalent=one_of(rng, (), ("stribeck",), ("offset", "unbalance")),
        place=one_of(rng, "load", "coupling"),
        beyond_chance=bool(rng.random() < 0.8),
        implausible=one_of(rng, (), (), ("no",)),
        fit=fitted(rng, base),
        row=SimpleNamespace(along=False, friction=False),
    )


def test_of_how_sure_names_are_among_any_rivals() -> None:
    told, rng = Answers("rivals"), np.random.default_rng(33)
    effects = ("stribeck", "offset", "unbalance", "return_spring", "quadratic_drag")
    for at in range(60):
        base = fitted(rng)
        could = [candidate(rng, one, base) for one in effects[: 1 + at % 5]]
        diagnosis: Any = SimpleNamespace(fit=base, could_be=could, candidates=could)
        added = one_of(rng, *effects[: 1 + at % 5])
        told.put("weights", rivals.weights(diagnosis, added))
        told.put("  chance", [joints.chance(took, diagnosis) for took in (0.0, 10.0, 40.0, 200.0)])
        steps: Any = [SimpleNamespace(diagnosis=diagnosis, added=added)]
        wider = rivals.with_choice(fitted(rng, base).params, steps)
        told.put("  wider", {name: [one.value, *one.ci95, one.se] for name, one in wider.items()})
        step = SimpleNamespace(
            added=added,
            weights=rivals.weights(diagnosis, added),
            equivalent=could[0].equivalent,
            fit=SimpleNamespace(model=SimpleNamespace(effects=(added,), coordinate="rotary")),
        )
        ladder: Any = [SimpleNamespace(added=None), step]
        untold = contenders.untold(ladder)
        told.put("  untold", [" for ".join(pair) for pair in untold])
        told.put("  instead", [" ".join(contenders._instead((*effects[:2],), *pair)) for pair in untold])
    told.put("nobody", rivals.weights(None, "stribeck"))
    every = ("stribeck",), ("stribeck", "offset"), ("unbalance",), ()
    said, prices = np.random.default_rng(7), np.random.default_rng(8)
    for _ in range(30):
        sets = [
            Rival(one, SimpleNamespace(core=SimpleNamespace(free=list(range(int(rng.integers(3, 6)))))))
            for one in every
        ]
        asks = Telling(tuple(sets))
        asks.__dict__["leads"] = np.full((4, 4), math.nan)
        left = np.array([[about(rng, 8.0) * one_of(rng, 1.0, 0.01) for _ in every] for _ in every])
        d = Told(left, np.zeros(4))
        told.put("pairs D", asks.pairs(d))
        told.put("  least D", [asks.least(d)])
        odds = said.uniform(-RULE.alike, RULE.alike, (4, 4))
        asks.__dict__["leads"] = 0.5 * (odds - odds.T)
        told.put("  with odds D", asks.pairs(d))
        told.put("  and prices D", asks.pairs(Told(left, prices.uniform(0.0, RULE.price, 4))))
    told.put("named", [one.name for one in sets])
    for _ in range(20):
        a, b = (estimate(rng, 1e-2) for _ in range(2))
        if a.se > 0.0 and b.se > 0.0:
            told.put("apart", [agreement._apart(a, b)])
    told.done()


def split(rng: Random, axis: str) -> Split:
    bins = 6
    mean = 1e-3 * rng.standard_normal(bins)
    regions = tuple(
        Region(float(i), i + 1.0, one_of(rng, -1, 0, 1), float(mean[i]), about(rng, 0.1))
        for i in range(int(rng.integers(axis == "frequency", 3)))
    )
    columns = [np.arange(bins, dtype=float), np.arange(bins) + 1.0]
    return Split(
        axis,
        "s",
        *columns,
        np.zeros(bins, np.int8),
        rng.integers(0, 9, bins) * 1.0,
        mean,
        np.abs(mean) * (1.0 + rng.random(bins)),
        1e-3 * np.ones(bins),
        about(rng, 0.1),
        float(rng.uniform(0.0, 0.1)),
        float(rng.uniform(0.0, 0.2)),
        regions,
    )


def test_of_where_any_error_is() -> None:
    told, rng = Answers("errors"), np.random.default_rng(34)
    for _ in range(60):
        fit = fitted(rng)
        splits = tuple(split(rng, axis) for axis in ("position", "velocity", "time", "frequency"))
        comparison: Any = Comparison(fit, splits)
        comparison.__dict__["torque_rms"] = one_of(rng, 0.02, 1e9)
        comparison.__dict__["figures"] = Figures(fit.rmse, float(rng.uniform()), about(rng, 0.1))
        told.put("fails", [one.fails for one in splits])
        told.put("  held", [one.mean_share for one in splits])
        told.put("  where", [one.where() for one in splits])
        told.put(
            "  worst",
            [comparison.worst.axis if comparison.worst else None, comparison.exact, comparison.complete],
        )
        if not math.isnan(fit.noise_floor):
            told.put("  summary", comparison.summary)
        told.put("  rows", [list(row) for row in comparison._rows()])
        unexplained = selection._unexplained(comparison)
        told.put("  unexplained", list(unexplained) if unexplained else None)
    for _ in range(12):
        torque = one_of(rng, 0.0, 1.0) * (rng.standard_normal(50) + one_of(rng, 0.0, 2.0))
        told.put("figures", Figures.of(0.1 * rng.standard_normal(50), torque).document())
    told.done()


def test_of_logs_whose_friction_may_give() -> None:
    told, rng = Answers("gives_back"), np.random.default_rng(35)
    for at in range(40):
        rate = float(rng.choice([200.0, 1000.0, 4000.0]))
        count = int(rng.choice([900, 2500, 6000]))
        t = np.arange(count) / rate
        theta = sum(a * np.sin(0.7 * w * t + a) for a, w in WAVES)
        omega, alpha = np.gradient(theta, t), np.gradient(np.gradient(theta, t), t)
        inertia, dry = one_of(rng, 1.0, -1.0, -0.02, 0.0) * 1e-4, one_of(rng, 1.0, -1.0, -0.05) * 8e-3
        noise = one_of(rng, 1e-3, 4e-3, 2e-2) * rng.standard_normal(count)
        tau = inertia * alpha + dry * np.sign(omega) + one_of(rng, 0.0, 0.3) * theta + noise
        one: Any = SimpleNamespace(
            core=SimpleNamespace(rate_hz=rate),
            used=rng.random(count) < one_of(rng, 1.0, 0.6),
            theta=theta,
            omega=omega,
            alpha=alpha,
            tau=tau,
        )
        told.put(f"log {at}", [power.gives_back([one]), power.gives_back([one, one])])
        told.put("  like a spring", [doubts._moves_like_a_spring(one)])
    told.done()


def test_of_captures_that_count_from_elsewhere() -> None:
    told = Answers("elsewhere")

    def bumps(by: float, size: float) -> Any:
        return lambda t, theta, *_: (
            size * (np.sin(3.0 * (theta + by)) + np.exp(-np.square(4.0 * (theta + by) - 1.0)))
        )

    for by in (0.0, 0.004, 0.05, 0.3, -0.4):
        for size in (0.0, 5e-4, 2e-3, 1e-2):
            one, other = (
                recorded(41, bumps(0.0, size)),
                recorded(42, bumps(0.0, size), waves=((0.7, 4.3), (0.35, 11.0))),
            )
            other = dataclasses.replace(other, theta=other.theta + by, omega=None, alpha=None)
            if by == 0.3:
                other = dataclasses.replace(other, theta=1.0 * other.theta, tau=np.roll(other.tau, 12))
            prepared = [kc.prepare(capture) for capture in (one, other)]
            found = zeros.aligned(prepared)
            told.put(
                f"{by} of {size}",
                [float(np.mean(a.theta - b.theta)) for a, b in zip(found, prepared, strict=True)],
            )
    short = [kc.prepare(recorded(43 + i, count=400)) for i in range(2)]
    told.put("short", [len(zeros.aligned(short)), len(zeros.aligned(short[:1]))])
    told.done()


def test_of_motions_of_any_pieces_within_any_limits() -> None:
    told, rng = Answers("pieces"), np.random.default_rng(36)
    for at in range(50):
        low = float(rng.uniform(-3.0, 1.0))
        limits = Limits(
            0.1,
            about(rng, 6.0),
            about(rng, 80.0),
            low,
            low + about(rng, 1.0),
            float(rng.uniform(0.2, 4.0)),
            400.0,
        )
        kinds = list(motion_space._KINDS)
        pieces = tuple(
            motion_space.Piece(kinds[(at + i) % 5], tuple(rng.random(5).tolist()), 0.2 + float(rng.random()))
            for i in range(1 + at % 3)
        )
        pieces = motion_space.changed(pieces, rng, 0.3)
        told.put(f"{at} numbers", [x for one in pieces for x in (*one.numbers, one.share)])
        made = motion_space.plan(pieces, limits, float(rng.choice([1.0, 0.5])))
        told.put("  about", [made.about, len(made.parts)])
        track = made.track(400.0)
        told.put("  holds", [limits.hold(track), limits.middle, limits.half, len(track.t)])
        for column in (track.theta, track.omega, track.alpha):
            told.put("  along", column)
        for name in ("omega_rad_s", "alpha_rad_s2", "duration_s"):
            most = {
                "omega_rad_s": np.abs(track.omega),
                "alpha_rad_s2": np.abs(track.alpha),
                "duration_s": track.t,
            }[name].max()
            for times in (1.0 - 1e-6, 1.0, 1.1):
                less = dataclasses.replace(limits, **{name: max(times * float(most), 1e-6)})
                told.put(f"  {name}", [less.hold(track)])
    for bad in (
        {"torque_Nm": 0.0},
        {"theta_min_rad": 5.0},
        {"duration_s": 600.0},
        {"duration_s": 601.0},
        {"sample_rate_hz": 9.0},
        {"sample_rate_hz": 1e6},
        {"omega_rad_s": math.inf},
        {"torque_Nm": True},
        {"nothing": 1.0},
    ):
        try:
            told.put(str(bad), list(Limits(0.1, 6.0, 80.0, -1.0, 2.0).with_some(bad).numbers.values()))
        except InputError as error:
            told.put(str(bad), str(error))
    told.done()


def test_of_a_search_that_may_be_cut_anywhere(monkeypatch: pytest.MonkeyPatch) -> None:
    told = Answers("cuts")
    clock = SimpleNamespace(now=5.0)
    monkeypatch.setattr(cut, "time", SimpleNamespace(monotonic=lambda: clock.now))
    for left in range(9):
        deadline = cut.Deadline.of(2.0 if left % 2 else None)
        deadline.weighing = [f"effect {i}" for i in range(left)]
        for after in (0.0, 2.0, 2.1):
            clock.now += after
            try:
                deadline()
                ended = "goes on"
            except cut.OutOfTime as over:
                ended = deadline.cut(over).words
            told.put(f"{left} {after}", ended)
        told.put("  asked", [deadline.cut(KeyboardInterrupt()).words, deadline.cut(KeyboardInterrupt()).by])
    for budget in (0.0, -1.0, 1e-9, math.nan):
        try:
            told.put("budget", cut.Deadline(budget).budget_s)
        except InputError as error:
            told.put("budget", str(error))
    told.put("rate", RATE_HZ)
    told.done()
