"""What a recording tells of itself while it goes on."""

from __future__ import annotations

from typing import NamedTuple


class Figures(NamedTuple):
    """A recording at one moment; what follows `run` belongs to that run alone.

    `rate_hz` is how many samples came in the last second of this computer, `device_rate_hz` what the clock of
    the rig says, over `device_span_s`. `peak_torque` in N m, `clipped` samples of omega, alpha and tau,
    `temperature` in degrees Celsius.
    """

    bytes: int
    logged: int
    frames: int
    corrupt: int
    forgotten: int
    foreign_version: int | None
    state: str | None
    temperature: float | None
    log_error: str | None
    ended: str | None
    run: int | None
    received: int
    missing: int
    complete: bool
    rate_hz: float
    device_rate_hz: float | None
    device_span_s: float
    peak_torque: float | None
    clipped: tuple[int, int, int]

    def __str__(self) -> str:
        parts = [f"{self.received} samples", f"{self.rate_hz:.0f} Hz", f"{self.missing} lost"]
        if self.corrupt:
            parts.append(f"{self.corrupt} corrupt")
        if self.peak_torque is not None:
            parts.append(f"peak {1e3 * self.peak_torque:.1f} mN m")
        parts += [
            f"{name} saturated {count} times"
            for name, count in zip(("omega", "alpha", "tau"), self.clipped, strict=True)
            if count
        ]
        if self.temperature is not None:
            parts.append(f"{self.temperature:.0f} degC")
        return ", ".join(parts)
