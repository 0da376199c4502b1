"""The law of feedback linearisation: the path as a level function f(x, y) = 0 [NarrowArcs]."""

from __future__ import annotations

import math
from dataclasses import dataclass, field

import numpy as np

from ..errors import ShapeError
from ..se2 import Array
from ..vehicle import Vehicle
from .following import FollowingOptions
from .level import Jet


@dataclass(frozen=True)
class LinearizingGains:
    """Gains of Eq. (4.4), at the speed they are used with.

    The error obeys f'' + k1 f' + k2 f = 0; it is critically damped for k1 = 2 sqrt(k2).

    Attributes:
        k1: Of the rate of f [1/s].
        k2: Of f [1/s^2].
    """

    k1: float
    k2: float

    def __post_init__(self) -> None:
        """Check that both are positive."""
        for name, value in self.__dict__.items():
            if not (0.0 < value < math.inf):
                raise ShapeError(f"gain {name} must be a finite positive number, got {value}")

    @classmethod
    def critical(cls, speed: float, distance: float) -> LinearizingGains:
        """Return critical gains: errors decay as (1 + s/d) exp(-s/d) over the way s.

        Args:
            speed: Speed [m/s], positive.
            distance: d [m]; k2 = (speed / d)^2.
        """
        return cls(2.0 * speed / distance, (speed / distance) ** 2)


def linearizing_yaw_rate(jet: Jet, heading: float, v: float, gains: LinearizingGains) -> float:
    """Return the yaw rate that gives the error its linear dynamics [rad/s].

    omega = (-v^2 (fxx cos^2 + 2 fxy sin cos + fyy sin^2) + mu) / Delta with
    Delta = v (fy cos - fx sin), mu = -k1 f' - k2 f, f' = v (fx cos + fy sin)
    [NarrowArcs, Eqs. (4.3), (4.4)]. Delta = 0 is singular: the chair stands or heads straight
    across the path. Its sign says which way along the path the chair travels; the law keeps it.

    Raises:
        ShapeError: If Delta is zero.
    """
    c, s = math.cos(heading), math.sin(heading)
    delta = v * (jet.fy * c - jet.fx * s)
    if delta == 0.0:
        raise ShapeError("heading straight across the path, or standing, no yaw rate is defined")
    bend = v * v * (jet.fxx * c * c + 2.0 * jet.fxy * s * c + jet.fyy * s * s)
    rate = v * (jet.fx * c + jet.fy * s)
    return (-bend - gains.k1 * rate - gains.k2 * jet.value) / delta


def wheel_rates(vehicle: Vehicle, v: float, omega: float) -> Array:
    """Return the wheels' angular velocities [left, right], shape (2,), [rad/s].

    omega_l,r = (v -+ omega track / 2) / r_c: [NarrowArcs, Eq. (4.5)] with the wheel radius under
    the second term too, as (4.2) needs it; without it the chair turns at r_c of what is asked.
    """
    return np.asarray(vehicle.wheel_speeds([v, omega]) / vehicle.wheel_radius)


@dataclass(frozen=True)
class LinearizingOptions:
    """How the linearising tracker drives.

    Attributes:
        distance: d: errors decay as (1 + s/d) exp(-s/d) over the way s [m]: critical gains
            k1 = 2 v / d [1/s], k2 = (v / d)^2 [1/s^2] at every speed v.
        approach: Steepest angle to the path at which large errors are driven down [rad]: f is
            held to 2 d sin(approach) in Eq. (4.4).
        singular: Angle to the path from which the law rests and the chair first turns [rad]; it
            resumes 0.1 rad below. Above `approach`, below pi / 2.
        following: Speed, delay, arrival.
    """

    distance: float = 0.2
    approach: float = math.radians(50.0)
    singular: float = math.radians(75.0)
    following: FollowingOptions = field(default_factory=FollowingOptions)

    def __post_init__(self) -> None:
        """Check the numbers."""
        if not (0.0 < self.distance < math.inf):
            raise ShapeError(f"distance must be a finite positive number [m], got {self.distance}")
        if not (0.0 < self.approach < self.singular - 0.1 < math.pi / 2.0 - 0.1):
            raise ShapeError(
                "angles must keep 0 < approach < singular - 0.1 rad, singular < pi / 2, got "
                f"{self.approach:.3g}, {self.singular:.3g}"
            )


class LinearizingLaw:
    """Eqs. (4.3), (4.4) made fit for use: large errors, the singular case, the travel chosen."""

    def __init__(self, vehicle: Vehicle, options: LinearizingOptions) -> None:
        """Begin with a chair that follows the path."""
        self._options = options
        self._may_spin = vehicle.may_turn_on_the_spot
        self._sharpest = vehicle.limits.curvature
        self._spin = 0.5 * vehicle.limits.yaw_rate
        self._turning = False

    def reset(self) -> None:
        """Forget that the chair was turning."""
        self._turning = False

    def steer(self, jet: Jet, angle: float, heading: float, v: float) -> tuple[float, float]:
        """Return [v, omega] for a wanted signed speed.

        Args:
            jet: Level function, a distance, positive on the left of the travel.
            angle: Direction of travel to the path's, (-pi, pi], [rad].
            heading: Heading of the chair [rad].
            v: Speed wanted, negative in reverse [m/s].
        """
        options = self._options
        edge = options.singular - (0.1 if self._turning else 0.0)
        self._turning = abs(angle) > edge
        if self._turning:
            return self._turn(jet, angle, v)
        if v == 0.0:
            return 0.0, 0.0
        most = 2.0 * options.distance * math.sin(options.approach)
        held = jet._replace(value=max(min(jet.value, most), -most))
        gains = LinearizingGains.critical(abs(v), options.distance)
        return v, linearizing_yaw_rate(held, heading, v, gains)

    def _turn(self, jet: Jet, angle: float, v: float) -> tuple[float, float]:
        """Return the command that turns the travel towards the path's, the side the error asks."""
        share = max(min(jet.value / self._options.distance, 1.0), -1.0)
        off = math.remainder(angle + share * self._options.approach, 2.0 * math.pi)
        sense = -math.copysign(1.0, off)
        if self._may_spin:
            return 0.0, sense * self._spin
        return v, sense * self._sharpest * abs(v)
