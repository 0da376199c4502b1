"""A differential-drive chair on the floor: wheels, motors, encoders, and what goes wrong."""

from __future__ import annotations

import math
from collections import deque
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import ArrayLike

from ..errors import ShapeError
from ..se2 import Array
from ..vehicle import Vehicle
from .noise import GaussMarkov


@dataclass(frozen=True)
class CastorFlip:
    """Castors swinging round after the chair turns from forward to reverse or back.

    While they swing they push the chair's front aside: the heading is turned by `angle` in all,
    to a side drawn by chance, over the next `distance` driven, smoothly (rate ~ sin^2).

    Attributes:
        angle: Heading disturbance of one flip [rad].
        distance: Distance driven while the castors swing [m], about half their trail's circle.
    """

    angle: float = math.radians(2.0)
    distance: float = 0.25

    def __post_init__(self) -> None:
        """Check the numbers."""
        if not (math.isfinite(self.angle) and 0.0 < self.distance < math.inf):
            raise ShapeError(f"a castor flip needs a positive distance, got {self.distance}")


@dataclass(frozen=True)
class PlantOptions:
    """How the chair differs from its commands. The defaults are a good chair on a good floor.

    Attributes:
        motor_lag: Time constant of the wheels' first-order answer [s]; 0 = at once.
        latency: Time from a command to its taking effect [s], rounded up to physics steps.
        wheel_speed: Limit of each wheel's rim speed [m/s].
        wheel_acceleration: Limit of its rate [m/s^2]; above what the default limits of a chair
            ask of a wheel, 0.6 + 2.0 x 0.3.
        tick: Rim travel of one encoder tick [m].
        slip: Standard deviation of the share of its travel a wheel loses or gains.
        slip_time: Time over which slip changes [s].
        left_radius_error: Relative error of the left wheel's radius: true / nominal - 1.
        right_radius_error: Likewise.
        track_error: Relative error of the track: true / nominal - 1.
        castor_flip: Push of the castors after reversing, or None.
    """

    motor_lag: float = 0.05
    latency: float = 0.0
    wheel_speed: float = 2.0
    wheel_acceleration: float = 3.0
    tick: float = 0.002
    slip: float = 0.0
    slip_time: float = 0.5
    left_radius_error: float = 0.0
    right_radius_error: float = 0.0
    track_error: float = 0.0
    castor_flip: CastorFlip | None = None

    def __post_init__(self) -> None:
        """Check the ranges."""
        for name in ("motor_lag", "latency", "slip"):
            value = getattr(self, name)
            if not (0.0 <= value < math.inf):
                raise ShapeError(f"{name} must be a finite number >= 0, got {value}")
        for name in ("wheel_speed", "wheel_acceleration", "tick", "slip_time"):
            value = getattr(self, name)
            if not value > 0.0:
                raise ShapeError(f"{name} must be positive, got {value}")
        for name in ("left_radius_error", "right_radius_error", "track_error"):
            value = getattr(self, name)
            if not (-0.5 < value < 0.5):
                raise ShapeError(f"{name} must lie between -0.5 and 0.5, got {value}")


@dataclass
class _Wheel:
    """One drive wheel: its rim speed by the nominal radius, and its travel over the floor."""

    scale: float  # true radius / nominal
    slip: GaussMarkov
    speed: float = 0.0  # m/s, by the nominal radius: what the encoder sees
    turned: float = field(default=0.0)  # m, rim travel by the nominal radius

    def step(self, target: float, dt: float, options: PlantOptions) -> float:
        """Turn for `dt` towards a target speed and return the travel over the floor [m]."""
        target = max(min(target, options.wheel_speed), -options.wheel_speed)
        self.speed, travel = wheel_motion(
            self.speed, target, dt, lag=options.motor_lag, acceleration=options.wheel_acceleration
        )
        self.turned += travel
        return travel * self.scale * (1.0 - self.slip.step(dt))


class Plant:
    """The chair's true motion, step by step. Each step is an exact arc.

    Attributes:
        time: Time since the start [s].
    """

    def __init__(
        self, vehicle: Vehicle, pose: ArrayLike, options: PlantOptions, rng: np.random.Generator
    ) -> None:
        """Put the chair at rest at a pose.

        Args:
            vehicle: Its nominal track.
            pose: True pose at the start, shape (3,), [m, m, rad].
            options: How it differs from its commands.
            rng: Source of slip and of the castors' side.
        """
        self.time = 0.0
        self._options = options
        self._rng = rng
        self._track = vehicle.track
        self._x, self._y, self._heading = (float(v) for v in np.asarray(pose, dtype=float))
        self._left, self._right = (
            _Wheel(1.0 + error, GaussMarkov(options.slip, options.slip_time, rng))
            for error in (options.left_radius_error, options.right_radius_error)
        )
        self._target = (0.0, 0.0)
        self._queue: deque[tuple[float, float, float]] = deque()
        self._driving = 0  # last direction of travel
        self._flipped = math.inf  # distance driven since the castors began to swing
        self._side = 1.0

    @property
    def pose(self) -> Array:
        """True pose, shape (3,), [m, m, rad]; the heading is not wrapped."""
        return np.array([self._x, self._y, self._heading])

    @property
    def wheel_speeds(self) -> tuple[float, float]:
        """Rim speeds [v_left, v_right] by the nominal radius [m/s]."""
        return self._left.speed, self._right.speed

    @property
    def ticks(self) -> tuple[int, int]:
        """Encoder counts of the left and the right wheel since the start."""
        tick = self._options.tick
        return math.floor(self._left.turned / tick), math.floor(self._right.turned / tick)

    def command(self, v: float, omega: float) -> None:
        """Send a command; it takes effect after the latency and holds until the next."""
        turn = 0.5 * omega * self._track
        self._queue.append((self.time + self._options.latency, v - turn, v + turn))

    def step(self, dt: float) -> None:
        """Let `dt` seconds pass."""
        while self._queue and self._queue[0][0] <= self.time + 1e-9:
            _, left, right = self._queue.popleft()
            self._target = (left, right)
        left = self._left.step(self._target[0], dt, self._options)
        right = self._right.step(self._target[1], dt, self._options)
        travel = 0.5 * (left + right)
        angle = (right - left) / (self._track * (1.0 + self._options.track_error))
        angle += self._castor_push(travel)
        # An arc's chord is travel * sin(angle / 2) / (angle / 2), along the mean heading.
        half = 0.5 * angle
        chord = travel * (math.sin(half) / half if abs(half) > 1e-9 else 1.0)
        self._x += chord * math.cos(self._heading + half)
        self._y += chord * math.sin(self._heading + half)
        self._heading += angle
        self.time += dt

    def _castor_push(self, travel: float) -> float:
        """Return the angle by which swinging castors turn the chair in a step [rad]."""
        flip = self._options.castor_flip
        if flip is None or travel == 0.0:
            return 0.0
        direction = 1 if travel > 0.0 else -1
        if self._driving == -direction:
            self._flipped = 0.0
            self._side = 1.0 if self._rng.random() < 0.5 else -1.0
        self._driving = direction
        before = min(self._flipped, flip.distance)
        self._flipped += abs(travel)
        after = min(self._flipped, flip.distance)
        return self._side * flip.angle * (_swung(after, flip) - _swung(before, flip))


def _swung(distance: float, flip: CastorFlip) -> float:
    """Return the share of a flip done after a distance: the integral of 2 sin^2."""
    share = distance / flip.distance
    return share - math.sin(2.0 * math.pi * share) / (2.0 * math.pi)


def wheel_motion(
    speed: float, target: float, dt: float, *, lag: float, acceleration: float
) -> tuple[float, float]:
    """Return a wheel's speed and travel after a step towards a target, exactly.

    The wheel obeys speed' = (target - speed) / lag, its rate limited: it ramps while the target
    is more than `acceleration` x `lag` away, then closes in exponentially.

    >>> wheel_motion(0.0, 1.0, 0.5, lag=0.0, acceleration=4.0)
    (1.0, 0.375)

    Args:
        speed: Rim speed now [m/s].
        target: Rim speed asked for [m/s].
        dt: Length of the step [s].
        lag: Time constant [s], 0 or more.
        acceleration: Largest rate of the speed [m/s^2]; may be infinite.

    Returns:
        Speed [m/s] and travel [m].
    """
    gap = target - speed
    ramp, travel = 0.0, 0.0
    if abs(gap) > acceleration * lag and math.isfinite(acceleration):
        ramp = min((abs(gap) - acceleration * lag) / acceleration, dt)
        change = math.copysign(acceleration * ramp, gap)
        travel = (speed + 0.5 * change) * ramp
        speed += change
        gap = target - speed
    rest = dt - ramp
    if lag == 0.0:
        return (target if rest > 0.0 else speed), travel + target * rest
    decay = math.exp(-rest / lag)
    return target - gap * decay, travel + target * rest - gap * lag * (1.0 - decay)
