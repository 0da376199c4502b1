"""What the guard reckons with: the chair's brakes, people's steps, how old a percept may be."""

from __future__ import annotations

import math
from dataclasses import dataclass

from ..errors import ShapeError


@dataclass(frozen=True)
class GuardOptions:
    """What the guard reckons with.

    Attributes:
        deceleration: At which the chair can brake [m/s^2].
        yaw_deceleration: At which it can stop turning [rad/s^2].
        latency: Time from a command to its taking effect [s].
        lag: Time constant of the motors [s].
        period: Control period [s]: the next command comes that late.
        margin: Distance the swept body keeps from points [m]: errors of pose and of motion.
        walking: Speed of somebody who walks [m/s].
        standing: How long the chair stands before somebody who walks can be there [s].
        trusted_after: A place that has been occupied for so long is taken to be furniture [s]: long
            enough for two people who relieve each other on the spot, 3 s each.
            Before, what is there may walk; also a wall just come into view. 0: nobody walks.
        reach: Distance from the body's origin up to which percepts tell of everything [m]. From
            further away somebody may come: a chair that sees less far drives slower.
        oldest: Age of the percept from which on the chair stops [s].
        margin_known: Distance kept from what was planned for [m]; negative: that much of it may
            seem to be in the body, by errors of the sensors.
        berth: On a course the chair stands back that far before what was not planned for [m].
        shares: Shares of a wanted command that are tried, falling.
    """

    deceleration: float = 0.8
    yaw_deceleration: float = 2.0
    latency: float = 0.0
    lag: float = 0.05
    period: float = 0.05
    margin: float = 0.03
    walking: float = 1.4
    standing: float = 0.5
    trusted_after: float = 6.0
    reach: float = 3.0
    oldest: float = 0.3
    margin_known: float = -0.03
    berth: float = 0.5
    shares: tuple[float, ...] = (1.0, 0.8, 0.6, 0.45, 0.3, 0.2, 0.1)

    def __post_init__(self) -> None:
        """Check the numbers."""
        for name in ("deceleration", "yaw_deceleration", "period"):
            if not 0.0 < getattr(self, name) < math.inf:
                raise ShapeError(f"{name} must be a positive number, got {getattr(self, name)}")
        if not self.reach > 0.0:
            raise ShapeError(f"reach must be positive, infinite at most, got {self.reach}")
        for name in (
            "latency",
            "lag",
            "margin",
            "walking",
            "trusted_after",
            "oldest",
            "berth",
        ):
            if not 0.0 <= getattr(self, name) < math.inf:
                raise ShapeError(f"{name} must be a number >= 0, got {getattr(self, name)}")
        falling = all(a > b for a, b in zip(self.shares, (*self.shares[1:], 0.0), strict=True))
        if not self.shares or self.shares[0] > 1.0 or not falling:
            raise ShapeError(f"shares must fall from 1 at most to above 0, got {self.shares}")
