"""Following a motion leg by leg with a steering law: what steering laws have in common."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import NamedTuple, Protocol

import numpy as np
from numpy.typing import ArrayLike

from ..errors import ShapeError
from ..path import Path
from ..se2 import Array
from ..trajectory import Trajectory
from ..vehicle import Vehicle
from .clock import Clock
from .delay import DelayPrediction
from .legs import Leg, legs_of
from .pace import LimitedPace, Pace, TimedPace


@dataclass(frozen=True)
class FollowingOptions:
    """How a motion is followed, whatever the steering law.

    Attributes:
        speed: Cruising speed on a path without times [m/s].
        delay: Time from a command to its effect, latency plus motor lag [s]: the law steers the
            pose predicted for then.
        arrival: How near to a leg's end counts as arrived [m].
        arrival_turn: The same on the spot [rad].
        turn_gain: Yaw rate per heading error beyond the end of a turn on the spot [1/s].
    """

    speed: float = 0.4
    delay: float = 0.05
    arrival: float = 0.001
    arrival_turn: float = 0.002
    turn_gain: float = 3.0

    def __post_init__(self) -> None:
        """Check the numbers."""
        for name in ("speed", "arrival", "arrival_turn", "turn_gain"):
            value = getattr(self, name)
            if not (0.0 < value < math.inf):
                raise ShapeError(f"{name} must be a finite positive number, got {value}")
        if not (0.0 <= self.delay < math.inf):
            raise ShapeError(f"delay must be a finite number >= 0 [s], got {self.delay}")


class Place(NamedTuple):
    """The chair relative to a point of a leg, in the frame of the travel there.

    Attributes:
        progress: Progress of the point along the path.
        ahead: How far the chair is ahead of the point along the travel [m].
        left: How far it is to the left of it [m].
        angle: Direction the chair travels in less that of the leg, in (-pi, pi], [rad].
    """

    progress: float
    ahead: float
    left: float
    angle: float


class SteeringLaw(Protocol):
    """Turns a place relative to a driven leg into a command."""

    def begin(self, leg: Leg) -> None:
        """Start on a leg: forget the one before."""
        ...

    def locate(self, leg: Leg, x: float, y: float, heading: float) -> Place:
        """Return where a pose is, relative to the point of the leg the law steers by."""
        ...

    def steer(self, leg: Leg, place: Place, rate: float, period: float) -> tuple[float, float]:
        """Return speed along the travel and yaw rate for the coming period, [m/s, rad/s].

        Args:
            leg: The leg being driven.
            place: Where the chair is.
            rate: The speed the pace asks for, >= 0, [m/s].
            period: Length of the period [s].
        """
        ...


class LegFollower:
    """Follows a motion leg by leg with a steering law; turns on the spot by the heading.

    The speed comes from the pace: a trajectory's own times, or a cruising speed within the limits.
    A leg is left when its end is reached and its time is over; the command is then zero for one
    period. Commands keep the limits of speed, yaw rate and curvature.

    Attributes:
        place: Where the chair was at the last step on a driven leg, None before.
    """

    def __init__(
        self,
        motion: Path | Trajectory,
        vehicle: Vehicle,
        law: SteeringLaw,
        options: FollowingOptions,
    ) -> None:
        """Table the path.

        Args:
            motion: The path, driven at `options.speed`; or a trajectory, driven at its own.
            vehicle: Its limits bound the commands.
            law: Steers on driven legs.
            options: How.
        """
        self.place: Place | None = None
        self._law = law
        self._options = options
        self._limits = vehicle.limits
        self._legs = legs_of(motion.path if isinstance(motion, Trajectory) else motion)
        self._pace: Pace
        if isinstance(motion, Trajectory):
            self._pace = TimedPace(motion, self._legs)
        else:
            self._pace = LimitedPace(self._legs, vehicle, speed=options.speed)
        self._prediction = DelayPrediction(options.delay)
        self._clock = Clock()
        self._reached = 0.0
        self._begin(0)

    def _begin(self, index: int) -> None:
        """Start a leg, or finish behind the last."""
        self._index = index
        if index < len(self._legs):
            self._near = self._legs[index].start
            self._law.begin(self._legs[index])

    @property
    def progress(self) -> float:
        """Greatest progress along the path reached so far, [m] or [rad]."""
        return self._reached

    @property
    def finished(self) -> bool:
        """Whether the end of the path is reached or passed."""
        return self._index >= len(self._legs)

    def step(self, time: float, pose: ArrayLike) -> Array:
        """Return the command for the coming period; zero once finished. See `Tracker.step`."""
        x, y, heading = (float(value) for value in np.asarray(pose, dtype=float))
        period = self._clock.tick(time)
        v, omega = 0.0, 0.0
        if not self.finished:
            v, omega = self._command(*self._prediction.predict(time, x, y, heading), period)
        self._prediction.sent(time, v, omega)
        return np.array([v, omega])

    def _command(self, x: float, y: float, heading: float, period: float) -> tuple[float, float]:
        """Return [v, omega] at a pose, going on to the next leg where one ends."""
        leg, options, limits = self._legs[self._index], self._options, self._limits
        if leg.direction == 0:
            v, omega = 0.0, self._turn(leg, heading, period)
            close = options.arrival_turn
        else:
            self.place = self._law.locate(leg, x, y, heading)
            self._near = self.place.progress
            rate = self._pace.rate(self._index, self._near, period)
            speed, omega = self._law.steer(leg, self.place, rate, period)
            v = leg.direction * min(
                max(speed, 0.0), limits.speed if leg.direction > 0 else limits.reverse_speed
            )
            sharpest = math.inf if math.isinf(limits.curvature) else limits.curvature * abs(v)
            omega = max(min(omega, sharpest), -sharpest)
            close = options.arrival
        self._reached = max(self._reached, min(self._near, leg.end))
        if self._near >= leg.end - close and self._pace.is_due(self._index):
            self._reached = leg.end
            self._begin(self._index + 1)
            return 0.0, 0.0
        return v, max(min(omega, limits.yaw_rate), -limits.yaw_rate)

    def _turn(self, leg: Leg, heading: float, period: float) -> float:
        """Return the yaw rate on a turn on the spot."""
        sense = math.copysign(1.0, leg.turn)
        within = min(max(self._near, leg.start), leg.end)
        off = math.remainder(heading - leg.heading(within), 2.0 * math.pi)
        self._near = within + sense * off
        rate = self._pace.rate(self._index, self._near, period)
        if self._near > leg.end:
            rate = self._options.turn_gain * (leg.end - self._near)
        return sense * rate


class LawTracker:
    """A tracker that is a steering law and how it is followed; see `interfaces.Tracker`."""

    def __init__(
        self,
        motion: Path | Trajectory,
        vehicle: Vehicle,
        law: SteeringLaw,
        options: FollowingOptions,
    ) -> None:
        """Table the path; arguments as for `LegFollower`."""
        self._follower = LegFollower(motion, vehicle, law, options)

    @property
    def progress(self) -> float:
        """Greatest progress along the path reached so far, [m] or [rad]."""
        return self._follower.progress

    @property
    def finished(self) -> bool:
        """Whether the end of the path is reached or passed."""
        return self._follower.finished

    def step(self, time: float, pose: ArrayLike) -> Array:
        """Return the command for the coming period; zero once finished. See `Tracker.step`."""
        return self._follower.step(time, pose)


def travel_frame(leg: Leg, progress: float) -> tuple[float, float, float]:
    """Return x, y and the direction of travel of a driven leg at progress, [m, m, rad]."""
    x, y, heading = leg.pose(progress)
    return x, y, heading if leg.direction > 0 else heading + math.pi


def travel_angle(leg: Leg, progress: float, heading: float) -> float:
    """Return how far a chair's travel is turned from the leg's at progress, (-pi, pi], [rad]."""
    return math.remainder(heading - leg.heading(progress), 2.0 * math.pi)


def mean_curvature(leg: Leg, progress: float, reach: float) -> float:
    """Return the mean curvature of a driven leg over the next `reach` of progress [1/m].

    Taken over at least one row of the leg's table. In reverse too it is the heading's rate by
    progress: what the chair must turn per metre.
    """
    reach = max(reach, leg.step)
    return (leg.heading(progress + reach) - leg.heading(progress)) / reach
