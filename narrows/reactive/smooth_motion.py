"""Smooth motion: the limits of speed, acceleration, jerk and yaw that all drives share."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from ..errors import ShapeError
from ..se2 import Array
from ..vehicle import Vehicle


@dataclass(frozen=True)
class MotionLimits:
    """How fast a command may be, and how fast it may change.

    Attributes:
        speed: Forward [m/s].
        reverse_speed: Backward [m/s].
        acceleration: Rate of the speed [m/s^2].
        jerk: Rate of that [m/s^3].
        yaw_rate: Heading rate [rad/s].
        yaw_acceleration: Its rate [rad/s^2].
        yaw_jerk: Rate of that [rad/s^3].
        lateral_acceleration: v omega [m/s^2]: the heading rate is lowered at speed.
    """

    speed: float = 0.8
    reverse_speed: float = 0.4
    acceleration: float = 0.6
    jerk: float = 1.5
    yaw_rate: float = 1.2
    yaw_acceleration: float = 2.0
    yaw_jerk: float = 10.0
    lateral_acceleration: float = 0.5

    def __post_init__(self) -> None:
        """Check that all are positive (reverse speed may be 0)."""
        for name, value in self.__dict__.items():
            least_ok = value >= 0.0 if name == "reverse_speed" else value > 0.0
            if not (least_ok and math.isfinite(value)):
                raise ShapeError(f"{name} must be a finite positive number, got {value}")

    @classmethod
    def of(cls, vehicle: Vehicle, *, yaw_jerk: float = 10.0) -> MotionLimits:
        """Return a chair's own limits; it has none for the yaw's jerk."""
        limits = vehicle.limits
        return cls(
            limits.speed,
            limits.reverse_speed,
            limits.acceleration,
            limits.jerk,
            limits.yaw_rate,
            limits.yaw_acceleration,
            yaw_jerk,
            limits.lateral_acceleration,
        )

    def clipped(self, v: float, omega: float) -> tuple[float, float]:
        """Return a command within the limits of speed, yaw rate and lateral acceleration."""
        v = min(max(v, -self.reverse_speed), self.speed)
        most = self.yaw_rate
        if abs(v) * most > self.lateral_acceleration:
            most = self.lateral_acceleration / abs(v)
        return v, min(max(omega, -most), most)


@dataclass(frozen=True)
class Smooth:
    """A quantity and its rate."""

    value: float = 0.0
    rate: float = 0.0

    def towards(self, target: float, limit: float, jerk: float, dt: float) -> Smooth:
        """Return the next value on the way to a target, without overshooting a target that stays.

        The rate is the greatest, within jerk x dt of the last and the limit, from which it can
        still be brought to zero before the target: rate dt + rate^2 / (2 jerk) <= way to go,
        which the discrete sum of the following steps never exceeds. A target that comes nearer
        while the value goes to it may be overshot, but zero is not: there the value stops.

        Args:
            target: Where to.
            limit: Greatest rate.
            jerk: Greatest rate of the rate.
            dt: Time of a step [s].
        """
        way = target - self.value
        best = jerk * (math.sqrt(dt * dt + 2.0 * abs(way) / jerk) - dt)
        best = math.copysign(min(best, limit), way)
        step = jerk * dt
        rate = min(max(best, self.rate - step), self.rate + step)
        # A step that would cross a near target ends on it, if that keeps the jerk.
        if abs(way) <= abs(rate) * dt and rate * way > 0.0:
            exact = way / dt
            rate = min(max(exact, self.rate - step), self.rate + step)
        value = target if abs(way - rate * dt) < 1e-12 else self.value + rate * dt
        if value * self.value <= 0.0 and value != 0.0 and target * value <= 0.0:
            return Smooth()
        return Smooth(value, rate)


class SmoothMotion:
    """Turns sudden commands into motions within the limits, common to assisted and free drives.

    Stands for the SmoothMotionController of [DrivingAssistant, Sec. V-B], whose law is not
    printed; this one is ours.
    """

    def __init__(self, limits: MotionLimits, *, period: float = 0.02) -> None:
        """Begin at rest.

        Args:
            limits: What to keep.
            period: Control period [s].
        """
        if not (0.0 < period < math.inf):
            raise ShapeError(f"period must be a finite positive number [s], got {period}")
        self.limits = limits
        self.period = period
        self._v = Smooth()
        self._omega = Smooth()

    @property
    def command(self) -> tuple[float, float]:
        """The last command [v, omega]."""
        return self._v.value, self._omega.value

    @property
    def rates(self) -> tuple[float, float]:
        """Its rates [m/s^2, rad/s^2]."""
        return self._v.rate, self._omega.rate

    def proposed(self, v: float, omega: float) -> tuple[Smooth, Smooth]:
        """Return the next step towards a command without taking it."""
        limits, dt = self.limits, self.period
        v, omega = limits.clipped(v, omega)
        return (
            self._v.towards(v, limits.acceleration, limits.jerk, dt),
            self._omega.towards(omega, limits.yaw_acceleration, limits.yaw_jerk, dt),
        )

    def level_off(self) -> bool:
        """Stop accelerating at once, whatever the jerk; return whether anything did."""
        rising = self._v.value * self._v.rate > 0.0
        turning = self._omega.value * self._omega.rate > 0.0
        self._v = Smooth(self._v.value, 0.0) if rising else self._v
        self._omega = Smooth(self._omega.value, 0.0) if turning else self._omega
        return rising or turning

    def take(self, v: Smooth, omega: Smooth) -> tuple[float, float]:
        """Take a proposed step and return its command."""
        self._v, self._omega = v, omega
        return v.value, omega.value

    def force(self, v: float, omega: float) -> tuple[float, float]:
        """Take a command that need not keep the limits: a full braking. Return it.

        What follows continues from a rate within the limits.
        """
        limits, dt = self.limits, self.period
        rate = 0.0 if v == 0.0 else (v - self._v.value) / dt
        yaw = 0.0 if omega == 0.0 else (omega - self._omega.value) / dt
        most, most_yaw = limits.acceleration, limits.yaw_acceleration
        self._v = Smooth(v, min(max(rate, -most), most))
        self._omega = Smooth(omega, min(max(yaw, -most_yaw), most_yaw))
        return v, omega

    def step(self, command: ArrayLike) -> Array:
        """Return the next command [v, omega], shape (2,), on the way to the one asked for.

        Args:
            command: [v, omega] asked for, shape (2,), [m/s, rad/s]; what is not finite counts
                as zero.
        """
        asked = np.asarray(command, dtype=float)
        if asked.shape != (2,):
            raise ShapeError(f"a command must be [v, omega], got shape {asked.shape}")
        v, omega = (float(value) if math.isfinite(value) else 0.0 for value in asked)
        return np.array(self.take(*self.proposed(v, omega)))
