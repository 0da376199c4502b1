"""How a driver steers by what they see: on along a curve, round on the spot, or back."""

from __future__ import annotations

import math

import numpy as np

from ..se2 import Array
from ..vehicle import Vehicle
from .driver_sight import free_travel
from .driver_traits import Traits

_STEP, _STEPS = 0.06, 24  # m, -: how finely and far they imagine a curve
_SWERVES = np.array([0.0, 0.15, -0.15, 0.35, -0.35, 0.6, -0.6, 1.0, -1.0, 1.6, -1.6])  # 1/m
_WANTED = 0.5  # m of free way wanted ahead at least; with less they look for another curve
_TIGHT = 0.25  # m beside the chair from which on narrowness slows nobody


class Steering:
    """Chooses how the chair shall move among what is seen; remembers nothing."""

    def __init__(self, traits: Traits, vehicle: Vehicle) -> None:
        """Take the wheel.

        Args:
            traits: Of the driver.
            vehicle: The chair: its size as they know it, its speeds.
        """
        self._traits = traits
        low, high = vehicle.outline.min(axis=0), vehicle.outline.max(axis=0)
        self._body = np.array([low[0], high[0], low[1], high[1]])
        self._top, self._spin = vehicle.limits.speed, vehicle.limits.yaw_rate

    def drive(self, points: Array, wanted: float, target: float) -> tuple[float, float]:
        """Go on along the way, or along the nearest curve that is free as far as they judge.

        Args:
            points: What is seen, body frame, shape (M, 2), [m].
            wanted: Curvature that leads back to the way [1/m].
            target: Direction of the way ahead [rad].

        Returns:
            [v, omega], [m/s, rad/s].
        """
        traits = self._traits
        curves = np.clip(wanted + _SWERVES, -3.0, 3.0)
        body, clear = self._grown(points, 0.02)
        twists = np.column_stack([np.ones_like(curves), curves])
        free = free_travel(clear, body, twists, _STEP, _STEPS)
        short = np.maximum(_WANTED - free, 0.0)
        best = int(np.argmin(3.0 * short + 0.35 * np.abs(_SWERVES)))
        curve, ahead = float(curves[best]), float(free[best])
        speed = min(
            traits.pace * self._top * self._narrowness(points),
            0.7 / max(abs(curve), 0.1),
            max(ahead - 0.05, 0.0) / traits.headway,
        )
        if ahead < 0.12:  # in front of something: turn towards the way, do not push
            side = math.copysign(1.0, target)
            return 0.0, 0.35 * side * self._spin if abs(target) > math.radians(8.0) else 0.0
        return speed, traits.over_steer * curve * speed

    def turn(self, points: Array, target: float, side: float) -> tuple[float, float]:
        """Turn on the spot towards a direction, the other way round if this one is blocked.

        Args:
            points: What is seen, body frame, shape (M, 2), [m].
            target: The direction [rad].
            side: To which side the turn has begun, 1 left, -1 right; 0: not begun.

        Returns:
            The side, and the heading rate to it [rad/s].
        """
        side = math.copysign(1.0, target) if side == 0.0 else side
        body, points = self._grown(points, 0.0)
        free = free_travel(points, body, np.array([[0.0, side], [0.0, -side]]), 0.06, 30)
        if free[0] < 0.1 and free[1] > 0.4:
            side = -side
        rate = min(1.0, 0.25 + abs(target) / 1.2) * 0.8 * self._traits.pace
        return side, rate * self._spin

    def back(self, points: Array) -> tuple[float, float] | None:
        """Drive straight back, or as straight as is free; None: nothing is.

        Args:
            points: What is seen over the shoulder, body frame, shape (M, 2), [m].
        """
        curves = np.clip(_SWERVES, -1.5, 1.5)
        body, clear = self._grown(points, 0.02)
        twists = np.column_stack([-np.ones_like(curves), -curves])
        free = free_travel(clear, body, twists, _STEP, 12)
        best = int(np.argmin(3.0 * np.maximum(0.5 - free, 0.0) + 0.35 * np.abs(_SWERVES)))
        if free[best] < 0.1:
            return None
        speed = 0.5 * self._traits.pace * self._top * min(1.0, free[best] / 0.5)
        return -speed, -speed * float(curves[best])

    def _narrowness(self, points: Array) -> float:
        """Return the share of their pace they dare between what is beside the way."""
        x, y = points[:, 0], np.abs(points[:, 1]) - self._body[3]
        beside = (x > self._body[0]) & (x < self._body[1] + 0.6) & (y > -0.1)
        gap = float(y[beside].min(initial=_TIGHT))
        return 0.5 + 0.5 * max(gap, 0.0) / _TIGHT

    def _grown(self, points: Array, margin: float) -> tuple[Array, Array]:
        """Return the body with what they want around it, and the points not yet within that."""
        body = self._body + margin * np.array([-1.0, 1.0, -1.0, 1.0])
        x, y = points[:, 0], points[:, 1]
        inside = (x > body[0]) & (x < body[1]) & (y > body[2]) & (y < body[3])
        return body, points[~inside]
