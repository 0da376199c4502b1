"""Driving along any level function f(x, y) = 0, without a table of the path."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import ArrayLike

from ..errors import ShapeError
from ..se2 import Array
from ..vehicle import Vehicle
from .level import Jet, LevelFunction
from .linearizing_law import LinearizingLaw, LinearizingOptions


class LevelTracker:
    """Drives along the zeros of a level function, without end or until a length is driven.

    Attributes:
        cross_track_error: f at the last step, positive: the chair is on the side of f > 0 [m].
    """

    def __init__(
        self,
        level: LevelFunction,
        vehicle: Vehicle,
        options: LinearizingOptions | None = None,
        *,
        direction: int = 1,
        left: int = 1,
        length: float = math.inf,
    ) -> None:
        """Choose the direction of travel, which the law itself leaves open.

        Args:
            level: The path; a distance [m].
            vehicle: Its limits bound the commands.
            options: Default `LinearizingOptions()`.
            direction: +1 to drive forward, -1 in reverse.
            left: +1 to travel with f > 0 on the left, -1 on the right.
            length: Way after which it has finished [m].
        """
        for name, value in (("direction", direction), ("left", left)):
            if value not in (1, -1):
                raise ShapeError(f"{name} must be +1 or -1, got {value}")
        self.options = LinearizingOptions() if options is None else options
        self.cross_track_error = 0.0
        self._level = level
        self._limits = vehicle.limits
        self._law = LinearizingLaw(vehicle, self.options)
        self._direction, self._left = direction, left
        self._length = length
        self._driven = 0.0
        self._last: tuple[float, float] | None = None

    @property
    def progress(self) -> float:
        """Way driven so far [m]."""
        return self._driven

    @property
    def finished(self) -> bool:
        """Whether the length is driven."""
        return self._driven >= self._length

    def step(self, time: float, pose: ArrayLike) -> Array:
        """Return the command for the coming period; zero once finished. See `Tracker.step`."""
        x, y, heading = (float(value) for value in np.asarray(pose, dtype=float))
        if self._last is not None:
            self._driven += math.hypot(x - self._last[0], y - self._last[1])
        self._last = (x, y)
        if self.finished:
            return np.zeros(2)
        jet = self._level(x, y)
        self.cross_track_error = jet.value
        jet = Jet(*(self._left * part for part in jet))
        along = math.atan2(-jet.fx, jet.fy)  # the direction with f growing to its left
        travel = heading if self._direction > 0 else heading + math.pi
        angle = math.remainder(travel - along, 2.0 * math.pi)
        top = self._limits.speed if self._direction > 0 else self._limits.reverse_speed
        speed = self._direction * min(self.options.following.speed, top)
        v, omega = self._law.steer(jet, angle, heading, speed)
        most = self._limits.yaw_rate
        if math.isfinite(self._limits.curvature):
            most = min(most, self._limits.curvature * abs(v))
        return np.array([v, max(min(omega, most), -most)])
