"""Feedback linearisation: the path as a level function f(x, y) = 0 [NarrowArcs, Section 4]."""

from __future__ import annotations

import math
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import ArrayLike

from ..errors import ShapeError
from ..path import Path
from ..se2 import Array
from ..trajectory import Trajectory
from ..vehicle import Vehicle
from .following import (
    FollowingOptions,
    LawTracker,
    Place,
    mean_curvature,
    travel_angle,
)
from .legs import Leg
from .level import Jet, LevelFunction

_REACH = 0.15  # m: how far from its last place a foot is looked for, several periods of travel
_LEAST_SCALE = 0.2  # 1 - kappa f near the centre of the path's curvature, where f has no gradient


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


class _Law:
    """Eqs. (4.3), (4.4) made fit for use: large errors, the singular case, the travel chosen."""

    def __init__(self, vehicle: Vehicle, options: LinearizingOptions) -> None:
        self._options = options
        self._may_spin = vehicle.may_turn_on_the_spot
        self._sharpest = vehicle.limits.curvature
        self._spin = 0.5 * vehicle.limits.yaw_rate
        self._turning = False

    def reset(self) -> None:
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


class _Projection:
    """The law on a leg: f is the signed distance to the leg, found by projection."""

    def __init__(self, law: _Law) -> None:
        self._law = law
        self._near = 0.0

    def begin(self, leg: Leg) -> None:
        """See `SteeringLaw`."""
        self._near = leg.start
        self._law.reset()

    def locate(self, leg: Leg, x: float, y: float, heading: float) -> Place:
        """See `SteeringLaw`; the point is the foot of the chair."""
        foot = leg.project(x, y, near=self._near, reach=_REACH)
        self._near = foot.progress
        angle = travel_angle(leg, foot.progress, heading)
        return Place(foot.progress, 0.0, foot.offset, angle)

    def steer(self, leg: Leg, place: Place, rate: float, period: float) -> tuple[float, float]:
        """See `SteeringLaw`. Seen from the travel the path runs along x, its left along y."""
        kappa = mean_curvature(leg, place.progress, rate * period)
        # The Hessian of a signed distance is -kappa / (1 - kappa f) along the path, 0 across.
        scale = max(1.0 - kappa * place.left, _LEAST_SCALE)
        jet = Jet(place.left, 0.0, 1.0, -kappa / scale, 0.0, 0.0)
        return self._law.steer(jet, place.angle, place.angle, rate)


class LinearizingTracker(LawTracker):
    """Feedback linearisation of the distance to the path [NarrowArcs, Eqs. (4.3), (4.4)].

    With critical gains and no delay the distance f to the path decays as (1 + s/d) exp(-s/d) over
    the way s, the curvature fed forward exactly. Beyond the paper: gains follow the speed, so that
    errors decay over the same distance at every speed; large f is held to what an approach at
    `approach` corrects; where the chair heads across the path or backward along it (Delta <= 0)
    it first turns, on the spot if it may; the travel of each leg is the one planned.

    It assumes poses at least every 0.1 s, a start within 0.15 m along the path of where it begins,
    and errors smaller than the path's radius: at the centre of curvature the distance has no
    gradient.
    """

    def __init__(
        self,
        motion: Path | Trajectory,
        vehicle: Vehicle,
        options: LinearizingOptions | None = None,
    ) -> None:
        """Table the path.

        Args:
            motion: The path, driven at the cruising speed; or a trajectory, driven at its own.
            vehicle: Its limits bound the commands.
            options: Default `LinearizingOptions()`.
        """
        self.options = LinearizingOptions() if options is None else options
        law = _Projection(_Law(vehicle, self.options))
        super().__init__(motion, vehicle, law, self.options.following)


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
        self._law = _Law(vehicle, self.options)
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
