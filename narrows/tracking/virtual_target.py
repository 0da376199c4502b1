"""Following a virtual target that moves along the path [Lapierre2007]."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import NamedTuple

from ..errors import ShapeError
from ..path import Path
from ..trajectory import Trajectory
from ..vehicle import Vehicle
from .following import (
    FollowingOptions,
    LawTracker,
    Place,
    mean_curvature,
    travel_angle,
    travel_frame,
)
from .legs import Leg


@dataclass(frozen=True)
class VirtualTargetGains:
    """Gains per metre driven: the law's own, k1 and k2 [1/s], are these times the speed.

    Near the path the error left of it obeys y'' + (a + turn) y' + (a turn + pull) y = 0 over the
    way, with a = approach / width. The defaults have the double root -1 / 0.2 m.

    Attributes:
        along: k1 / u: how fast the target comes back to the chair's side [1/m].
        turn: k2 / u: how fast the chair turns to the approach angle [1/m].
        pull: g: weight of the error beside the path [1/m^2].
        approach: theta_a: the angle at which a chair far away approaches, below pi / 2 [rad].
        width: Error at which the approach angle is 76 % (tanh 1) of that [m].
    """

    along: float = 5.0
    turn: float = 7.5
    pull: float = 6.25
    approach: float = math.radians(50.0)
    width: float = math.radians(50.0) / 2.5

    def __post_init__(self) -> None:
        """Check the signs, and that the approach is no retreat."""
        for name, value in self.__dict__.items():
            if not (0.0 < value < math.inf):
                raise ShapeError(f"gain {name} must be a finite positive number, got {value}")
        if not self.approach < math.pi / 2.0:
            raise ShapeError(f"approach must be below pi / 2 [rad], got {self.approach}")

    def angle(self, left: float) -> float:
        """Return delta, the angle wanted at a distance left of the path [rad]."""
        return -self.approach * math.tanh(left / self.width)


class TargetMotion(NamedTuple):
    """What the law asks for.

    Attributes:
        target_speed: Speed of the virtual target along the path [m/s], negative: it goes back.
        yaw_rate: Yaw rate of the chair [rad/s].
    """

    target_speed: float
    yaw_rate: float


def follow_target(
    ahead: float,
    left: float,
    angle: float,
    *,
    speed: float,
    curvature: float,
    gains: VirtualTargetGains,
) -> TargetMotion:
    """Return the law of [Lapierre2007], with s = ahead, y = left, th = angle.

    With u the speed, c the curvature at the target, delta(y) the approach angle:
    s_dot = u cos th + k1 s,
    r = delta_dot - g y u (sin th - sin delta) / (th - delta) - k2 (th - delta) + c s_dot.

    Args:
        ahead: Chair's distance ahead of the target along the path [m].
        left: Distance left of it [m].
        angle: Direction of travel less the path's there [rad].
        speed: u, >= 0 [m/s].
        curvature: c [1/m].
        gains: Gains.
    """
    delta = gains.angle(left)
    off = angle - delta
    target_speed = speed * (math.cos(angle) + gains.along * ahead)
    left_rate = speed * math.sin(angle) - curvature * target_speed * ahead
    steepness = 1.0 - math.tanh(left / gains.width) ** 2
    delta_rate = -gains.approach / gains.width * steepness * left_rate
    # (sin a - sin b) / (a - b) = cos((a + b) / 2) sinc((a - b) / 2), finite at a = b.
    half = 0.5 * off
    quotient = math.cos(0.5 * (angle + delta)) * (math.sin(half) / half if half else 1.0)
    yaw_rate = (
        delta_rate
        - gains.pull * left * speed * quotient
        - gains.turn * speed * off
        + curvature * target_speed
    )
    return TargetMotion(target_speed, yaw_rate)


@dataclass(frozen=True)
class VirtualTargetOptions:
    """How the tracker drives.

    Attributes:
        gains: Gains.
        following: Speed, delay, arrival.
    """

    gains: VirtualTargetGains = field(default_factory=VirtualTargetGains)
    following: FollowingOptions = field(default_factory=FollowingOptions)


class _Law:
    """The virtual target on a leg."""

    def __init__(self, gains: VirtualTargetGains) -> None:
        self._gains = gains
        self._target = 0.0

    def begin(self, leg: Leg) -> None:
        """See `SteeringLaw`: the target starts where the leg does."""
        self._target = leg.start

    def locate(self, leg: Leg, x: float, y: float, heading: float) -> Place:
        """See `SteeringLaw`; the point is the target."""
        target_x, target_y, direction = travel_frame(leg, self._target)
        dx, dy = x - target_x, y - target_y
        c, s = math.cos(direction), math.sin(direction)
        angle = travel_angle(leg, self._target, heading)
        return Place(self._target, c * dx + s * dy, c * dy - s * dx, angle)

    def steer(self, leg: Leg, place: Place, rate: float, period: float) -> tuple[float, float]:
        """See `SteeringLaw`; also moves the target by one period."""
        asked = follow_target(
            place.ahead,
            place.left,
            place.angle,
            speed=rate,
            curvature=mean_curvature(leg, place.progress, rate * period),
            gains=self._gains,
        )
        self._target += asked.target_speed * period
        return rate, asked.yaw_rate


class VirtualTargetTracker(LawTracker):
    """Follows a target that runs along the path at a speed the law chooses.

    The target need not be the point nearest to the chair, so there is no closest-point
    singularity: the law is defined at the centre of curvature and far from the path alike.

    Convergence: for V = (s^2 + y^2) / 2 + (th - delta)^2 / (2 g), with s, y the chair's place in
    the target's frame and th its angle,

        V' = -k1 s^2 + u y sin(delta(y)) - k2 (th - delta)^2 / g <= 0,

    because delta has the sign of -y and |delta| < pi / 2. While u > 0, V' = 0 only at s = y = 0,
    th = delta(0) = 0: on the path, along it. So the errors never grow in the norm sqrt(V), and
    decay, from any start. Near the path they do over 1 / 5 m^-1 = 0.2 m with the default gains.
    The identity holds for a chair that obeys at once and a curvature that is known; limits of the
    yaw rate and the delay left over by the prediction break it.

    It assumes poses at least every 0.1 s. A start ahead of the path's beginning is met by the
    target, not by the chair.
    """

    def __init__(
        self,
        motion: Path | Trajectory,
        vehicle: Vehicle,
        options: VirtualTargetOptions | None = None,
    ) -> None:
        """Table the path.

        Args:
            motion: The path, driven at the cruising speed; or a trajectory, driven at its own.
            vehicle: Its limits bound the commands.
            options: Default `VirtualTargetOptions()`.
        """
        self.options = VirtualTargetOptions() if options is None else options
        law = _Law(self.options.gains)
        super().__init__(motion, vehicle, law, self.options.following)
