"""The last word on every command: the chair can stop before anything its body would sweep over.

At each control step the way to a stop is predicted, with the commands still under way, the lag of
the motors and the one period for which the command holds, and the body is swept along it. A
command passes only if no point comes nearer than a margin. If none passes, the chair brakes along
the way that was found free one period before. So in a world that stands still, where every
obstacle is among the points, it never touches anything while it moves.

What may walk is met with a margin that grows with time, so that it does not reach the moving
chair before the chair stands. Who cannot be told from furniture is not: see `trusted_after`.
"""

from __future__ import annotations

import math
from collections import deque
from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..errors import ShapeError
from ..geometry import edge_normals
from ..interfaces import Percept
from ..se2 import Array, transform
from ..vehicle import Vehicle

_CELL = 0.1  # m: places whose age is known
_RING = 128  # cells: 12.8 m across
_GONE = 0.5  # s: a place that was not seen for longer is empty
_STEP = 0.02  # s: of the predicted way
_APART = 0.03  # m: way of a body point between two looks


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
        trusted_after: A place that has been occupied for so long is taken to be furniture [s].
            Before, what is there may walk; also a wall just come into view.
        oldest: Age of the percept from which on the chair stops [s].
        margin_known: Distance kept from what was planned for [m]; negative: that much of it may
            seem to be in the body, by errors of the sensors.
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
    trusted_after: float = 4.0
    oldest: float = 0.3
    margin_known: float = -0.03
    shares: tuple[float, ...] = (1.0, 0.8, 0.6, 0.45, 0.3, 0.2, 0.1)

    def __post_init__(self) -> None:
        """Check the numbers."""
        for name in ("deceleration", "yaw_deceleration", "period"):
            if not 0.0 < getattr(self, name) < math.inf:
                raise ShapeError(f"{name} must be a positive number, got {getattr(self, name)}")
        for name in (
            "latency",
            "lag",
            "margin",
            "walking",
            "trusted_after",
            "oldest",
        ):
            if not 0.0 <= getattr(self, name) < math.inf:
                raise ShapeError(f"{name} must be a number >= 0, got {getattr(self, name)}")
        falling = all(a > b for a, b in zip(self.shares, (*self.shares[1:], 0.0), strict=True))
        if not self.shares or self.shares[0] > 1.0 or not falling:
            raise ShapeError(f"shares must fall from 1 at most to above 0, got {self.shares}")


class Guard:
    """Lets commands pass that leave room to stop, less of them, or brakes.

    Attributes:
        options: What it reckons with.
        share: Share of the last wanted command that passed; 0: the chair brakes or stands.
        reason: Why the last command did not pass whole; empty if it did.
    """

    def __init__(
        self,
        vehicle: Vehicle,
        options: GuardOptions | None = None,
        *,
        known: Callable[[Array], NDArray[np.bool_]] | None = None,
    ) -> None:
        """Guard a chair that stands.

        Args:
            vehicle: The body, its layers by height.
            options: What the guard reckons with.
            known: Which points (N, 3) of the world frame belong to solids that were planned for:
                they stand, and `margin_known` is kept from them. None: nothing is known.
        """
        self.options = GuardOptions() if options is None else options
        self._known = known
        self.share, self.reason = 1.0, ""
        self._radius = vehicle.radius
        self._normals, self._offsets, self._heights = _half_planes(vehicle)
        self._command = np.zeros(2)  # sent last
        self._sent: deque[tuple[float, float, float]] = deque()  # taking effect at, v, omega
        self._twist, self._target = np.zeros(2), np.zeros(2)
        self._time = -math.inf
        self._watched, self._watched_at = 0.0, -math.inf  # s of seeing; when it was seen last
        self._index = np.full((_RING, _RING, 2), np.iinfo(np.int64).min, dtype=np.int64)
        self._since = np.zeros((_RING, _RING))
        self._seen = np.full((_RING, _RING), -math.inf)

    @property
    def twist(self) -> Array:
        """The [v, omega] the chair has by its own reckoning, shape (2,), [m/s, rad/s]."""
        return self._twist.copy()

    def stopping_distance(self, speed: float) -> float:
        """Return how far the chair goes until it stands, the period and the delays included [m].

        Args:
            speed: Now [m/s].
        """
        chosen = self.options
        delay = chosen.latency + chosen.lag + 1.5 * chosen.period
        return abs(speed) * delay + 0.5 * speed * speed / chosen.deceleration

    def limit(
        self,
        time: float,
        pose: ArrayLike,
        percept: Percept,
        wanted: ArrayLike,
        *,
        otherwise: Sequence[ArrayLike] = (),
    ) -> Array:
        """Return the greatest share of a command that leaves room to stop, or braking, (2,).

        Args:
            time: Now [s].
            pose: Pose the chair believes to have, shape (3,), [m, m, rad].
            percept: What it knows of its surroundings.
            wanted: Command [v, omega] to be judged, shape (2,), [m/s, rad/s].
            otherwise: Commands to try whole, in this order, where no share of it passes.
        """
        self._advance(time)
        goal = _command(wanted)
        age = time - percept.time
        self.share, self.reason = 0.0, ""
        if not age <= self.options.oldest:
            self.reason = (
                "nothing has been seen yet" if math.isinf(age) else "the sensors are silent"
            )
            return self._send(time, self._braked())
        obstacles = self._obstacles(time, pose, percept)
        blocked, tried = -1, np.full(2, math.nan)
        for share in self.options.shares:
            command = self._reachable(share * goal)
            if (command == tried).all():
                continue
            tried = command
            blocked = self._first_in_way(obstacles, command, max(age, 0.0))
            if blocked < 0:
                self.share = share
                self.reason = "" if share == 1.0 else "slower, so as to be able to stop"
                return self._send(time, command)
        x, y = obstacles[0][blocked, :2]
        self.reason = f"something is in the way, {x:.2f} m ahead, {y:+.2f} m to the left"
        for other in otherwise:
            command = self._reachable(_command(other))
            if self._first_in_way(obstacles, command, max(age, 0.0)) < 0:
                return self._send(time, command)
        return self._send(time, self._braked())

    def stop(self, time: float) -> Array:
        """Return the command of braking, whatever is perceived, shape (2,)."""
        self._advance(time)
        self.share = 0.0
        return self._send(time, self._braked())

    def _braked(self) -> Array:
        """Return the command sent last, faded by one period's braking."""
        v, omega = self._command
        chosen = self.options
        fade = math.inf
        if v:
            fade = chosen.deceleration * chosen.period / abs(v)
        if omega:
            fade = min(fade, chosen.yaw_deceleration * chosen.period / abs(omega))
        return np.asarray(max(0.0, 1.0 - fade) * self._command if fade < math.inf else np.zeros(2))

    def _send(self, time: float, command: Array) -> Array:
        self._command = np.array(command)
        v, omega = self._command.tolist()
        self._sent.append((time + self.options.latency, v, omega))
        return self._command.copy()

    def _advance(self, time: float) -> None:
        """Reckon the chair's twist up to now by the commands sent."""
        now = self._time if math.isfinite(self._time) else time
        self._time = time
        while now < time - 1e-9 or (self._sent and self._sent[0][0] <= time + 1e-9):
            until = min(time, self._sent[0][0]) if self._sent else time
            lag = self.options.lag
            decay = math.exp(-max(until - now, 0.0) / lag) if lag > 0.0 else 0.0
            self._twist = self._target + (self._twist - self._target) * decay
            now = max(until, now)
            if self._sent and self._sent[0][0] <= now + 1e-9:
                _, v, omega = self._sent.popleft()
                self._target = np.array([v, omega])

    def _pending(self) -> Array:
        """Return commands not yet in effect as rows [duration, v, omega], shape (Q, 3)."""
        rows, begin, current = [], self._time, self._target.tolist()
        for start, v, omega in self._sent:
            rows.append((max(start - begin, 0.0), *current))
            begin, current = max(start, begin), [v, omega]
        left = self._time + self.options.latency - begin
        if left > 1e-9:
            rows.append((left, *current))
        return np.array(rows).reshape(-1, 3)

    def _reachable(self, goal: Array) -> Array:
        """Return the command nearest to a wanted one that the rates allow after the last.

        Of its shares the greatest one, so that the curve stays; where none is allowed, v and
        omega are limited each by itself.
        """
        chosen = self.options
        rates = np.array([chosen.deceleration, chosen.yaw_deceleration]) * chosen.period
        low, high = self._command - rates, self._command + rates
        least, most = 0.0, 1.0
        for part in (0, 1):
            if goal[part] == 0.0:
                if not low[part] <= 0.0 <= high[part]:
                    return np.clip(goal, low, high)
                continue
            ends = sorted((low[part] / goal[part], high[part] / goal[part]))
            least, most = max(least, ends[0]), min(most, ends[1])
        return most * goal if least <= most else np.clip(goal, low, high)

    def _obstacles(
        self, time: float, pose: ArrayLike, percept: Percept
    ) -> tuple[Array, Array, Array]:
        """Return all points, unknown places too, how fast each may move, what to keep from it."""
        from .navigator_kernels import watch_cells

        chosen = self.options
        points, unknown = percept.points, percept.unknown
        world = transform(np.asarray(pose, dtype=float), points[:, :2])
        # Time in which nothing is seen makes nobody furniture, and furniture nobody.
        self._watched += min(time - self._watched_at, 2.0 * chosen.period)
        self._watched_at, now = time, self._watched
        since = watch_cells(
            np.ascontiguousarray(world),
            now,
            _CELL,
            _GONE,
            chosen.trusted_after,
            self._index,
            self._since,
            self._seen,
        )
        walking = np.where(now - since < chosen.trusted_after, chosen.walking, 0.0)
        margins = np.full(len(points), chosen.margin + percept.spread)
        if self._known is not None and len(points):
            planned = self._known(np.column_stack([world, points[:, 2]]))
            walking[planned] = 0.0
            margins[planned] = chosen.margin_known
        if len(unknown):
            low = np.full(len(unknown), self._heights[:, 0].min() + 1e-6)
            points = np.vstack([points, np.column_stack([unknown, low])])
            walking = np.concatenate([walking, np.zeros(len(low))])
            margins = np.concatenate([margins, np.full(len(low), chosen.margin + percept.spread)])
        return np.ascontiguousarray(points), walking, margins

    def _first_in_way(
        self, obstacles: tuple[Array, Array, Array], command: Array, age: float
    ) -> int:
        from .navigator_kernels import is_way_free, stopping_poses

        chosen = self.options
        points, walking, margins = obstacles
        rows, between = stopping_poses(
            self._twist,
            self._pending(),
            command,
            (chosen.deceleration, chosen.yaw_deceleration),
            chosen.period,
            chosen.period / math.ceil(chosen.period / _STEP),
            chosen.lag,
            self._radius,
            _APART,
        )
        rows = np.vstack([rows, rows[-1]])
        rows[-1, 0] += chosen.standing
        between = np.append(between, 0.0)
        planes = (self._normals, self._offsets, self._heights)
        return int(is_way_free(points, walking, rows, between, *planes, margins, age))


def _command(wanted: ArrayLike) -> Array:
    command = np.array(wanted, dtype=float)
    if command.shape != (2,) or not np.isfinite(command).all():
        raise ShapeError(f"a command is finite [v, omega], got {command}")
    return command


def _half_planes(vehicle: Vehicle) -> tuple[Array, Array, Array]:
    """Return the layers' edges: normals (L, E, 2), offsets (L, E), heights (L, 2)."""
    most = max(len(layer.polygon) for layer in vehicle.layers)
    normals = np.zeros((len(vehicle.layers), most, 2))
    offsets = np.zeros((len(vehicle.layers), most))
    for row, layer in enumerate(vehicle.layers):
        edges = edge_normals(layer.polygon)
        filled = np.vstack([edges, np.repeat(edges[-1:], most - len(edges), axis=0)])
        normals[row] = filled
        offsets[row, : len(edges)] = np.einsum("ed,ed->e", edges, layer.polygon)
        offsets[row, len(edges) :] = offsets[row, len(edges) - 1]
    return normals, offsets, np.array([layer.z for layer in vehicle.layers])
