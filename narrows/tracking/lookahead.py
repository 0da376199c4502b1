"""Look-ahead tracking: a PID on the error of a point ahead of the chair [DoorBezier, Eq. (13)]."""

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
from .clock import Clock
from .legs import Leg, legs_of
from .pace import ConstantPace, LimitedPace, Pace, TimedPace

_REACH = 0.15  # m: how far from its last place a foot is looked for, several periods of travel
_OFFSET_STEP = 0.01  # m: rows of the table of the look-ahead point's own offset


@dataclass(frozen=True)
class LookaheadGains:
    """Gains of Eq. (13).

    The paper's kp = 0.01, ki = kd = 0.001 fit errors in millimetres and rates in rad/s only; the
    defaults are these in SI.

    Attributes:
        kp: Proportional [rad / (s m)].
        ki: Integral [rad / (s^2 m)].
        kd: Derivative [rad / m].
    """

    kp: float = 10.0
    ki: float = 1.0
    kd: float = 1.0

    def __post_init__(self) -> None:
        """Check that no gain is negative."""
        for name, value in self.__dict__.items():
            if not (0.0 <= value < math.inf):
                raise ShapeError(f"gain {name} must be a finite number >= 0, got {value}")


@dataclass(frozen=True)
class LookaheadOptions:
    """How the look-ahead tracker drives. The defaults are for use; `paper` gives the paper's law.

    Attributes:
        gains: Gains at `speed`.
        lookahead: Distance of the point F ahead of the body origin along the travel [m].
        speed: Cruising speed on a path without times [m/s]; also the speed the gains hold at.
        feed_forward: Beyond the paper: add the path's own yaw rate, and take from the error what
            a chair exactly on the path would have (F is off the path wherever it bends).
        by_distance: Beyond the paper: scale the gains by speed, so that errors decay over the
            same distance at every speed and nothing turns a chair that stands.
        constant_speed: Drive at `speed` from the first moment to the end of the path, as the
            paper does; else within the limits, stopping wherever the direction changes.
        integral_limit: Largest yaw rate the integral term may ask for [rad/s]. It also rests
            while the command is limited (conditional integration).
        delay: Time by which the drive answers late [s]: the feed-forward is that much ahead.
        arrival: How near to a leg's end counts as arrived [m].
        arrival_turn: The same on the spot [rad].
        turn_gain: Yaw rate per heading error on the spot [1/s].
    """

    gains: LookaheadGains = field(default_factory=lambda: LookaheadGains(10.0, 0.0, 0.0))
    lookahead: float = 0.30
    speed: float = 0.4
    feed_forward: bool = True
    by_distance: bool = True
    constant_speed: bool = False
    integral_limit: float = 0.3
    delay: float = 0.05
    arrival: float = 0.001
    arrival_turn: float = 0.002
    turn_gain: float = 3.0

    def __post_init__(self) -> None:
        """Check the numbers."""
        for name in ("lookahead", "speed", "arrival", "arrival_turn", "turn_gain"):
            value = getattr(self, name)
            if not (0.0 < value < math.inf):
                raise ShapeError(f"{name} must be a finite positive number, got {value}")
        for name in ("integral_limit", "delay"):
            value = getattr(self, name)
            if not (0.0 <= value < math.inf):
                raise ShapeError(f"{name} must be a finite number >= 0, got {value}")

    @classmethod
    def paper(cls, *, lookahead: float = 0.28, speed: float = 0.4) -> LookaheadOptions:
        """Return the paper's law: Eq. (13) alone, at a constant speed.

        The paper prints neither look-ahead nor speed; the defaults give its figure of about
        55 mm. l = sqrt(2 V / kp) = 0.28 m makes the error decay with a damping of 0.7.
        """
        return cls(
            gains=LookaheadGains(),
            lookahead=lookahead,
            speed=speed,
            feed_forward=False,
            by_distance=False,
            constant_speed=True,
            integral_limit=math.pi,
            delay=0.0,
        )


class LookaheadTracker:
    """Steers a point ahead of the chair onto the path.

    With D the signed distance from the point F to its foot S on the path, omega = kp D
    + ki Ts sum D + (kd / Ts) (D_k - D_{k-1}) [DoorBezier, Eq. (13), as corrected]. D is positive
    where the path lies to the left of F, seen along the travel; in reverse F lies behind the chair
    and the same law holds. The sum and the last error start anew on each leg, the derivative at
    zero. Near a path: D' = V e - l omega' with heading error e, damping l sqrt(kp / V) / 2.

    F and the chair are projected near where they last were, so the tracker cannot jump to another
    branch. Beyond a leg's ends the path goes on straight. Turns on the spot are driven by the
    heading error. It assumes poses more often than every 0.1 s and a start within about 0.3 m and
    60 degrees of the path.

    Attributes:
        lookahead_error: D_err, the last error of F [m], positive: the path lies left of F.
        cross_track_error: C_err, the same of the body origin [m].
        heading_error: Path's heading less the chair's at the last step [rad].
    """

    def __init__(
        self,
        motion: Path | Trajectory,
        vehicle: Vehicle,
        options: LookaheadOptions | None = None,
    ) -> None:
        """Table the path.

        Args:
            motion: The path, driven at `options.speed`; or a trajectory, driven at its own.
            vehicle: Its limits bound the commands.
            options: Default `LookaheadOptions()`.
        """
        self.options = LookaheadOptions() if options is None else options
        self.lookahead_error = 0.0
        self.cross_track_error = 0.0
        self.heading_error = 0.0
        path = motion.path if isinstance(motion, Trajectory) else motion
        self._limits = vehicle.limits
        self._legs = legs_of(path)
        self._pace = self._pace_for(motion, vehicle)
        self._offsets = [self._own_offsets(leg) for leg in self._legs]
        self._clock = Clock()
        self._reached = 0.0
        self._begin(0)

    def _pace_for(self, motion: Path | Trajectory, vehicle: Vehicle) -> Pace:
        options = self.options
        if options.constant_speed:
            return ConstantPace(options.speed)
        if isinstance(motion, Trajectory):
            return TimedPace(motion, self._legs, delay=options.delay)
        return LimitedPace(self._legs, vehicle, speed=options.speed, delay=options.delay)

    def _begin(self, leg: int) -> None:
        """Start a leg, or finish behind the last."""
        self._index = leg
        self._sum = 0.0  # integral of the error [m s]
        self._last: float | None = None
        if leg < len(self._legs):
            self._near = self._legs[leg].start
            self._near_ahead = self._near + self.options.lookahead

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
        if self.finished:
            return np.zeros(2)
        leg = self._legs[self._index]
        if leg.direction == 0:
            v, omega = self._turn(leg, heading, period)
        else:
            v, omega = self._drive(leg, x, y, heading, period)
        self._reached = max(self._reached, min(self._near, leg.end))
        close = self.options.arrival_turn if leg.direction == 0 else self.options.arrival
        if self._near >= leg.end - close and self._pace.is_due(self._index):
            self._reached = leg.end
            self._begin(self._index + 1)
            return np.zeros(2)
        most = self._limits.speed if v > 0.0 else self._limits.reverse_speed
        return np.array([max(min(v, most), -most), omega])

    def _drive(
        self, leg: Leg, x: float, y: float, heading: float, period: float
    ) -> tuple[float, float]:
        """Return [v, omega] on a driven leg."""
        options, ahead = self.options, self.options.lookahead * leg.direction
        foot = leg.project(x, y, near=self._near, reach=_REACH)
        point_x, point_y = x + ahead * math.cos(heading), y + ahead * math.sin(heading)
        point = leg.project(
            point_x, point_y, near=self._near_ahead, reach=_REACH + options.lookahead
        )
        self._near, self._near_ahead = foot.progress, point.progress
        self.lookahead_error, self.cross_track_error = -point.offset, -foot.offset
        self.heading_error = _wrapped(leg.heading(foot.progress) - heading)
        rate = self._pace.rate(self._index, foot.progress, period)
        error, omega = self.lookahead_error, 0.0
        if options.feed_forward:
            error -= self._own_error(leg, foot.progress)
            place = foot.progress + rate * options.delay
            bend = leg.heading(place + rate * period) - leg.heading(place)
            omega = bend / period
        scale = rate / options.speed if options.by_distance else 1.0
        return leg.direction * rate, self._pid(error, omega, scale, period)

    def _pid(self, error: float, omega: float, scale: float, period: float) -> float:
        """Return the yaw rate of Eq. (13) on top of a feed-forward, limited, [rad/s]."""
        gains, most = self.options.gains, self._limits.yaw_rate
        last = error if self._last is None else self._last
        self._last = error
        total = self._sum + period * error
        if gains.ki > 0.0:
            bound = self.options.integral_limit / gains.ki
            total = max(min(total, bound), -bound)
        terms = gains.kp * error + gains.ki * total + gains.kd * (error - last) / period
        wanted = omega + scale * terms
        limited = max(min(wanted, most), -most)
        if limited == wanted or abs(total) < abs(self._sum):
            self._sum = total
        return limited

    def _turn(self, leg: Leg, heading: float, period: float) -> tuple[float, float]:
        """Return [v, omega] on a turn on the spot."""
        sense = math.copysign(1.0, leg.turn)
        within = min(max(self._near, leg.start), leg.end)
        self._near = within + sense * _wrapped(heading - leg.heading(within))
        rate = self._pace.rate(self._index, self._near, period)
        self.heading_error = sense * (leg.end - self._near)
        self.lookahead_error = self.cross_track_error = 0.0
        if self._near > leg.end:
            rate = self.options.turn_gain * (leg.end - self._near)
        most = self._limits.yaw_rate
        return 0.0, max(min(sense * rate, most), -most)

    def _own_offsets(self, leg: Leg) -> tuple[Array, Array]:
        """Return progress and the error D of F of a chair exactly on the leg there, each (K,)."""
        if leg.direction == 0 or not self.options.feed_forward:
            return np.zeros(1), np.zeros(1)
        ahead = self.options.lookahead
        count = max(2, math.ceil((leg.end - leg.start) / _OFFSET_STEP) + 1)
        progress = np.linspace(leg.start, leg.end, count)
        offsets, near = np.empty(count), leg.start + ahead
        for k, s in enumerate(progress.tolist()):
            x, y, heading = leg.pose(s)
            reach = leg.direction * ahead
            x, y = x + reach * math.cos(heading), y + reach * math.sin(heading)
            foot = leg.project(x, y, near=near, reach=_REACH + ahead)
            near, offsets[k] = foot.progress, -foot.offset
        return progress, offsets

    def _own_error(self, leg: Leg, progress: float) -> float:
        """Return D of a chair exactly on the leg at progress [m]."""
        rows, offsets = self._offsets[self._index]
        return float(np.interp(progress, rows, offsets))


def _wrapped(angle: float) -> float:
    """Return the angle in [-pi, pi]."""
    return math.remainder(angle, 2.0 * math.pi)
