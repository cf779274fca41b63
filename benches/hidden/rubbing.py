"""Friction with a memory, one step at a time: bristles, ageing contacts, slip elements, or none of them.

Bristles are bent one by one (Haessig & Friedland 1991): each holds until its own strength, breaks loose, and
takes hold again elsewhere with another strength. Ageing contacts follow Dieterich 1979 and Ruina 1983 in the
regularized form of Lapusta, Rice, Ben-Zion & Zheng 2000, with a state that tells nothing beyond a cut-off
speed (Okubo & Dieterich 1986).
"""

from typing import NamedTuple

import numpy as np
from scipy.special import ndtri

from .compiled import njit
from .motions import Floats

EMPTY = np.zeros(0)
# Weyl sequences of two dimensions (Roberts 2018): draws that leave no gaps, so that few bristles are smooth.
PHI, PSI = 0.7548776662466927, 0.5698402909980532

CREEP = 1e-6  # rad/s


class Bristles(NamedTuple):
    """Shares of the friction (their stiffness), quantiles of the strength in rad, and `anew`.

    A bristle takes hold with a strain of up to `anew` of its next strength, either way.
    """

    shares: Floats = EMPTY
    strengths: Floats = EMPTY
    anew: float = 0.0

    @staticmethod
    def spread(stiffness: Floats, reach: float, spread: float, anew: float) -> "Bristles":
        """Bristles whose strengths are log-normal about `reach` rad."""
        quantiles = (np.arange(256) + 0.5) / 256.0
        return Bristles(stiffness / stiffness.sum(), reach * np.exp(spread * ndtri(quantiles)), anew)

    @property
    def sliding(self) -> float:
        """Mean strain while all of them slide steadily, rad: by renewal, E[d^2 - s^2] / (2 E[d - s])."""
        held = np.mean(self.strengths**2) * (1.0 - self.anew**2 / 3.0)
        return float(held / (2.0 * np.mean(self.strengths)))


class Ageing(NamedTuple):
    """`direct` and `evolving` are the a and b of the law; speeds in rad/s, and the distance of its memory."""

    direct: float = 0.01
    evolving: float = 0.0
    speed: float = 1.0
    cutoff: float = 1.0
    way: float = 1e-3

    def steady(self, omega: Floats) -> Floats:
        """Friction over Coulomb's after long sliding at one velocity: the law's closed form."""
        state = 1.0 + self.evolving * np.log1p(self.cutoff / np.abs(omega))
        return self.direct * np.arcsinh(omega / (2.0 * self.speed) * np.exp(state / self.direct))


class Memory(NamedTuple):
    """What a rubbing contact remembers: strains and strengths of bristles, age in s and draws so far."""

    strains: Floats
    strengths: Floats
    age: Floats
    draws: Floats


def fresh(bristles: Bristles, ageing: Ageing, omega: float) -> Memory:
    """The memory of a contact that has slid on at `omega` for long."""
    count = len(bristles.shares)
    age = ageing.way / max(abs(omega), 1e-3)
    memory = Memory(np.zeros(count), np.zeros(count), np.array([age]), np.zeros(1))
    if count:
        memory.strengths[:] = bristles.strengths[np.arange(count) * 97 % len(bristles.strengths)]
        step = np.copysign(np.mean(bristles.strengths) / 10.0, omega)
        for _ in range(300):
            bent(step, bristles, memory)
    return memory


@njit
def bent(step, bristles, memory):  # type: ignore[no-untyped-def]
    """Move the surface by `step` rad; the mean strain of the bristles, weighted by their stiffness.

    Those who slide further than the mean strength at once slide steadily, and look the same all along.
    """
    many, mean = len(bristles.strengths), 0.0
    far = np.mean(bristles.strengths)
    step = min(max(step, -far), far)
    for j in range(len(bristles.shares)):
        strain = memory.strains[j] + step
        while abs(strain) > memory.strengths[j]:
            beyond = abs(strain) - memory.strengths[j]
            memory.draws[0] += 1.0
            strength = bristles.strengths[int(many * (memory.draws[0] * PHI % 1.0))]
            taken = bristles.anew * strength * (2.0 * (memory.draws[0] * PSI % 1.0) - 1.0)
            memory.strengths[j] = strength
            strain = taken + beyond if strain > 0.0 else taken - beyond
        memory.strains[j] = strain
        mean += bristles.shares[j] * strain
    return mean


@njit
def aged(speed, dt, ageing, memory):  # type: ignore[no-untyped-def]
    """Let the contact slide at `speed` for `dt`; its friction over Coulomb's, a magnitude.

    The age tends to way / speed: `d age/dt = 1 - age speed / way`, solved over the step.
    """
    slid = speed * dt / ageing.way
    # Beside rest both terms of the solution are small differences of large numbers.
    grown = dt if slid < 1e-9 else ageing.way / speed * -np.expm1(-slid)
    memory.age[0] = memory.age[0] * np.exp(-slid) + grown
    state = 1.0 + ageing.evolving * np.log1p(ageing.cutoff * memory.age[0] / ageing.way)
    # At rest it holds what it would hold while creeping.
    exponent = np.log(max(speed, CREEP) / (2.0 * ageing.speed)) + state / ageing.direct
    if exponent > 20.0:
        return ageing.direct * (exponent + np.log(2.0))
    return ageing.direct * np.arcsinh(np.exp(exponent))


@njit
def rubbed(theta, omega, dt, neg, pos, bristles, ageing, sliding, memory):  # type: ignore[no-untyped-def]
    """Friction of a motion that is known, from its levels each way, N m."""
    torque = np.zeros(len(theta))
    for i in range(len(theta)):
        if len(bristles.shares) > 0:
            share = bent(theta[i] - theta[i - 1] if i > 0 else 0.0, bristles, memory) / sliding
        else:
            share = np.sign(omega[i]) * aged(abs(omega[i]), dt, ageing, memory)
        torque[i] = share * (pos[i] if share > 0.0 else neg[i])
    return torque
