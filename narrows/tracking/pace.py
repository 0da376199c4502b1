"""How fast to drive along a leg: by the limits of the chair, or by a trajectory's own times."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Protocol

import numpy as np

from ..se2 import Array
from ..trajectory import Trajectory
from ..vehicle import Vehicle
from .legs import Leg

CREEP = 0.02
"""Rate of progress towards a leg's end once its time is over [m/s], a tenth of a hurry."""

CREEP_TURN = 0.1
"""The same on the spot [rad/s]."""

LONGEST_WAIT = 0.15
"""How far the chair may fall behind a trajectory before its clock waits, [m] or [rad]."""


class Pace(Protocol):
    """Where along the motion to be in a moment, and when a leg is done."""

    def rate(self, leg: int, progress: float, period: float) -> float:
        """Return the mean rate of progress for the coming period, [m/s] or [rad/s], >= 0.

        Args:
            leg: Index of the leg being driven.
            progress: Progress of the chair's foot on that leg.
            period: Length of the coming period [s].
        """
        ...

    def is_due(self, leg: int) -> bool:
        """Return whether a leg may end now, as far as time is concerned."""
        ...


class ConstantPace:
    """The paper's: one speed from the first moment to the last; a leg ends where it ends."""

    def __init__(self, speed: float) -> None:
        """Keep the speed [m/s], and [rad/s] on the spot."""
        self._speed = speed

    def rate(self, leg: int, progress: float, period: float) -> float:
        """Return the speed."""
        return self._speed

    def is_due(self, leg: int) -> bool:
        """Return true."""
        return True


class LimitedPace:
    """As fast as a cruising speed and the chair's limits allow, stopping at each leg's end.

    The speed stays below the yaw rate and the lateral acceleration the path's bend allows, it
    rises and falls with the acceleration limit (times `share`), and at every moment the chair can
    still stop at the leg's end.
    """

    def __init__(
        self,
        legs: Sequence[Leg],
        vehicle: Vehicle,
        *,
        speed: float,
        delay: float = 0.0,
        share: float = 0.8,
    ) -> None:
        """Table the speeds allowed by bends and braking.

        Args:
            legs: The legs to drive.
            vehicle: Its limits are kept.
            speed: Cruising speed [m/s].
            delay: Time by which the drive answers late [s].
            share: Fraction of the acceleration limits used; the rest is left to the corrections.
        """
        self._legs = legs
        self._delay = delay
        limits = vehicle.limits
        self._acceleration = [
            share * (limits.yaw_acceleration if leg.direction == 0 else limits.acceleration)
            for leg in legs
        ]
        self._table = [
            _allowed(leg, vehicle, speed, most)
            for leg, most in zip(legs, self._acceleration, strict=True)
        ]
        self._now = 0.0
        self._leg = 0

    def rate(self, leg: int, progress: float, period: float) -> float:
        """Return the speed; see `Pace.rate`."""
        if leg != self._leg:
            self._leg, self._now = leg, 0.0
        part, most = self._legs[leg], self._acceleration[leg]
        ahead = progress + self._now * (self._delay + period)
        row = int(min(max((ahead - part.origin) / part.step, 0.0), len(part.poses) - 1.0))
        rest = max(part.end - progress - self._now * self._delay, 0.0)
        # v^2 / (2 a) + v period <= rest: the chair can stop after driving one more period.
        braking = math.sqrt((most * period) ** 2 + 2.0 * most * rest) - most * period
        self._now = min(self._now + most * period, self._table[leg][row], braking)
        return self._now

    def is_due(self, leg: int) -> bool:
        """Return true: it has no clock."""
        return True


def _allowed(leg: Leg, vehicle: Vehicle, speed: float, most: float) -> list[float]:
    """Return the speed from which every bend ahead can be met by braking, one a row."""
    limits = vehicle.limits
    if leg.direction == 0:
        return [0.8 * limits.yaw_rate] * len(leg.poses)
    top = min(speed, limits.speed if leg.direction > 0 else limits.reverse_speed)
    bend = np.abs(np.gradient(leg.poses[:, 2], leg.step)) + 1e-9
    by_bend = np.minimum(limits.yaw_rate / bend, np.sqrt(limits.lateral_acceleration / bend))
    square: Array = np.minimum(by_bend, top) ** 2
    # v(s)^2 <= min over s' >= s of v(s')^2 + 2 a (s' - s): a running minimum from the end.
    slope = 2.0 * most * leg.step * np.arange(len(square))
    reachable = np.minimum.accumulate((square + slope)[::-1])[::-1] - slope
    return np.sqrt(reachable).tolist()  # type: ignore[no-any-return]


class TimedPace:
    """A trajectory's own speed, corrected by how far ahead or behind the chair is.

    The trajectory's clock stops at a leg's end until the chair has arrived there, and waits
    while the chair is far behind, so that a late chair never skips a leg.
    """

    def __init__(
        self, trajectory: Trajectory, legs: Sequence[Leg], *, gain: float = 2.0, delay: float = 0.0
    ) -> None:
        """Find the times at which legs end.

        Args:
            trajectory: The motion.
            legs: Its path's legs.
            gain: Correction of the speed per lag [1/s].
            delay: Time by which the drive answers late [s]; the speed is looked up that much ahead.
        """
        self._trajectory = trajectory
        self._legs = legs
        self._gain = gain
        self._delay = delay
        self._ends = [float(trajectory.profile.time_at(leg.end)) for leg in legs]
        self._ends[-1] = trajectory.duration
        self._clock = 0.0
        times = np.arange(0.0, trajectory.duration + 0.01, 0.005)
        self._progress = trajectory.progress(times).tolist()

    def _at(self, time: float) -> float:
        """Return the reference's progress at a time, from a table every 5 ms."""
        place = max(time, 0.0) / 0.005
        k = min(int(place), len(self._progress) - 2)
        share = min(place - k, 1.0)
        return float(self._progress[k] + share * (self._progress[k + 1] - self._progress[k]))

    def rate(self, leg: int, progress: float, period: float) -> float:
        """Return the reference's mean rate plus the correction; see `Pace.rate`."""
        part, end = self._legs[leg], self._ends[leg]
        behind = min(self._at(self._clock), part.end) - progress
        soon = min(self._clock + self._delay, end)
        later = min(self._clock + self._delay + period, end)
        step = min(self._at(later), part.end) - min(self._at(soon), part.end)
        rate = step / period + self._gain * behind
        if self.is_due(leg):
            creep = CREEP_TURN if part.direction == 0 else CREEP
            rest = part.end - progress
            rate = min(max(rate, creep), max(rest, 0.0) / period)
        if behind < LONGEST_WAIT:
            self._clock = min(self._clock + period, end)
        return max(rate, 0.0)

    def is_due(self, leg: int) -> bool:
        """Return whether the trajectory's clock has reached the leg's end."""
        return self._clock >= self._ends[leg] - 1e-9
