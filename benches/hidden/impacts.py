"""A real gap: two bodies that fly free between impacts with restitution, and move as one while they lean.

The shaft moves as it is driven and the knob is simulated forward; no spring stands for the contact.
"""

from typing import NamedTuple

import numpy as np

from .bodies import slowed
from .compiled import njit
from .loads import Loads, push
from .motions import Floats, Track
from .rubbing import fresh

# Closing slower than this the bodies stay together, rad/s; real ones stop bouncing at such speeds too.
SETTLED = 0.02


class Gap(NamedTuple):
    """A play of +-gap rad; what a bounce keeps of the speed; how long a knock takes, s; the knob's share."""

    gap: float
    restitution: float
    lasts_s: float
    share: float


class Flight(NamedTuple):
    """What is pressed through the contact, N m, and knocked, N m s, at each sample; the knob's motion.

    Of what is knocked from a sample to the next, `later` is the next one's by when it is.
    """

    pressed: Floats
    knocked: Floats
    later: Floats
    theta: Floats
    omega: Floats


def gapped(track: Track, p: Loads, gap: Gap, substeps: int = 40) -> Floats:
    """Torque on a shaft that knocks its knob to and fro, N m."""
    flight = fly(track, p, gap, (track.theta[0], track.omega[0]), max(substeps // 4, 2))
    dt = track.t[1] - track.t[0]
    # A knock is half a sine of that length (Hertz is close to it): the same impulse, no longer at once.
    knock = np.sin(
        np.pi * (np.arange(max(round(gap.lasts_s / dt), 1)) + 0.5) / max(round(gap.lasts_s / dt), 1)
    )
    # Told by the samples on either side, so that a knock begins when it does.
    told = flight.knocked - flight.later + np.append(0.0, flight.later[:-1])
    spread = np.convolve(told, knock / knock.sum())[: len(track.t)] / dt
    return (1.0 - gap.share) * p.inertia * track.alpha + flight.pressed + spread


def fly(track: Track, p: Loads, gap: Gap, start: tuple[float, float], substeps: int) -> Flight:
    """Simulate the knob from its angle and velocity at the start."""
    memory = fresh(p.bristles, p.ageing, track.omega[0])
    sliding = p.bristles.sliding if len(p.bristles.shares) else 1.0
    many = len(track.t)
    flight = Flight(*np.zeros((5, many)))
    _fly(*track, p, gap, start, substeps, sliding, np.zeros(len(p.weights)), memory, flight)
    return flight


@njit
def _fly(t, theta, omega, alpha, p, gap, start, substeps, sliding, slips, memory, flight):  # type: ignore[no-untyped-def]
    inertia = gap.share * p.inertia
    x, v = start
    side = 0  # the wall that the bodies lean on: 1 where the shaft pushes forward
    dt = t[1] - t[0]
    h = dt / substeps
    for i in range(len(t) - 1):
        flight.theta[i], flight.omega[i] = x, v
        for s in range(substeps):
            u = s / substeps
            now = t[i] + u * dt
            if side != 0:
                # As one with the shaft: what that takes is the torque through the contact.
                faster = omega[i] + (u * dt + h) * (alpha[i] + alpha[i + 1]) / 2.0
                free = slowed(now, x, v, -push(x, v, p), h, inertia, p, sliding, slips, memory)
                # The impulse that brings the knob from where it would go free to the shaft's velocity.
                torque = inertia * (faster - free) / h
                if torque * side < 0.0:
                    side = 0
                    v = free
                    x += h * v
                else:
                    v = faster
                    if s == 0:
                        flight.pressed[i] = torque
            else:
                v = slowed(now, x, v, -push(x, v, p), h, inertia, p, sliding, slips, memory)
                x += h * v
            w = u + 1.0 / substeps
            shaft = theta[i] * (1.0 + 2.0 * w) * (1.0 - w) ** 2 + theta[i + 1] * w**2 * (3.0 - 2.0 * w)
            shaft += dt * w * (1.0 - w) * (omega[i] * (1.0 - w) - omega[i + 1] * w)
            speed = omega[i] + w * dt * (alpha[i] + alpha[i + 1]) / 2.0
            if side != 0:
                x, v = shaft - side * gap.gap, speed
            elif abs(shaft - x) >= gap.gap:
                wall = 1 if shaft > x else -1
                closing = (speed - v) * wall
                if closing > 0.0:
                    kept = gap.restitution * closing if closing > SETTLED else 0.0
                    knock = wall * inertia * (closing + kept)
                    flight.knocked[i] += knock
                    flight.later[i] += w * knock
                    v = speed + wall * kept
                    x = shaft - wall * gap.gap
                    if kept == 0.0:
                        side = wall
    flight.theta[-1], flight.omega[-1] = x, v
    flight.pressed[-1] = flight.pressed[-2]
