"""Two ways to brake: fully, which the safety regions are computed for, and comfortably."""

from __future__ import annotations

import math
from dataclasses import dataclass

from ..errors import ShapeError
from .safety_regions import RegionOptions
from .smooth_motion import MotionLimits


@dataclass(frozen=True)
class ComfortBraking:
    """Speeds from which a comfortable braking stops as soon as a full one from a higher speed.

    A rim at speed r runs on by r latency + r^2 / (2 deceleration). Comfortable braking builds its
    deceleration up at the jerk limit, which costs as much way as half that time of latency.

    Attributes:
        latency: Of a full braking [s].
        deceleration: Of a full braking [m/s^2].
        gentle_latency: Latency of comfortable braking, the time to build it up counted [s].
        gentle_deceleration: Deceleration of comfortable braking [m/s^2].
        jerk: Rate at which an acceleration is taken back [m/s^3].
    """

    latency: float
    deceleration: float
    gentle_latency: float
    gentle_deceleration: float
    jerk: float

    @classmethod
    def of(cls, options: RegionOptions, limits: MotionLimits, share: float) -> ComfortBraking:
        """Return the braking that uses a share of the acceleration limit.

        Raises:
            ShapeError: If that would be harder than a full braking.
        """
        gentle = share * limits.acceleration
        if gentle > options.deceleration:
            raise ShapeError(
                f"comfortable braking at {gentle:.3g} m/s^2 is harder than the full braking of the "
                f"safety regions, {options.deceleration:.3g} m/s^2: compute them for a harder one"
            )
        latency = options.latency + 0.5 * gentle / limits.jerk
        return cls(options.latency, options.deceleration, latency, gentle, limits.jerk)

    def comfortable(self, norm: float, rate: float = 0.0) -> float:
        """Return the comfortable speed norm of a full braking's [m/s].

        Args:
            norm: Greatest speed norm of a full braking [m/s]; may be infinite.
            rate: Acceleration of the rims that must be taken back first [m/s^2].
        """
        rim = 0.5 * norm
        way = rim * self.latency + rim * rim / (2.0 * self.deceleration)
        rising = max(rate, 0.0)
        lost = self.gentle_deceleration * (self.gentle_latency + rising / self.jerk)
        gentle = math.sqrt(lost * lost + 2.0 * self.gentle_deceleration * way) - lost
        return 2.0 * max(0.0, gentle - 0.5 * rising * rising / self.jerk)

    def full(self, norm: float) -> float:
        """Return the speed norm of a full braking whose comfortable one this is [m/s].

        Args:
            norm: Comfortable speed norm [m/s].
        """
        rim = 0.5 * norm
        way = rim * self.gentle_latency + rim * rim / (2.0 * self.gentle_deceleration)
        lost = self.deceleration * self.latency
        return 2.0 * (math.sqrt(lost * lost + 2.0 * self.deceleration * way) - lost)
