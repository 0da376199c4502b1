"""Help through a sensed door: the user's steering blended with that along a certified path."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from ..errors import ShapeError
from ..se2 import Array, compose, invert, wrap
from .door_ahead import DoorAhead, PathSource, checked_path


@dataclass(frozen=True)
class DoorBlendOptions:
    """When a user is taken to want through a door, and how strongly they are helped.

    Attributes:
        reach: Distance of the door from which on help may begin [m].
        enter: Angle between the indicated way and the bearing of the door at which it begins [rad].
        leave: Angle at which it ends [rad].
        askew: Greatest angle between chair and door at which it begins [rad].
        rise: Time in which the blend grows from nothing to all [s]; it falls as fast.
        share: Share of the path's steering in the full blend; the rest stays the user's.
        pace: Fastest speed along the path [m/s].
        look_ahead: Distance of the point steered for, along the path [m].
        off: Deviation from the path at which a new one is asked for [m].
        retry: Least time between questions for a path [s].
        trust: Share of a newly sensed door's pose in the pose remembered, 0 to 1.
        lost: Way a door that is no longer sensed is remembered [m].
    """

    reach: float = 3.0
    enter: float = math.radians(30.0)
    leave: float = math.radians(60.0)
    askew: float = math.radians(75.0)
    rise: float = 0.6
    share: float = 0.9
    pace: float = 0.45
    look_ahead: float = 0.3
    off: float = 0.15
    retry: float = 1.0
    trust: float = 0.2
    lost: float = 4.0

    def __post_init__(self) -> None:
        """Check the numbers."""
        for name, value in self.__dict__.items():
            if not (0.0 < value < math.inf):
                raise ShapeError(f"{name} must be a finite positive number, got {value}")
        for name in ("share", "trust"):
            if getattr(self, name) > 1.0:
                raise ShapeError(f"{name} must be a share up to 1, got {getattr(self, name)}")


class DoorBlend:
    """Blends the user's heading rate towards that of a path through the door they head for.

    Beyond [DrivingAssistant]. It only changes the direction the assistant takes for indicated: the
    speed stays the user's, and the assistant checks the result as it checks the user's own wish. A
    user who lets go stops; who backs off, or steers well away from the door, drives alone.

    Attributes:
        weight: Share of the path's steering now, 0 to `share`.
        door: The door remembered, in the body frame now, or None.
    """

    def __init__(self, source: PathSource, options: DoorBlendOptions | None = None) -> None:
        """Begin without a door.

        Args:
            source: Finds certified paths.
            options: Default `DoorBlendOptions()`.
        """
        self._source = source
        self._options = DoorBlendOptions() if options is None else options
        self.door: DoorAhead | None = None
        self._unseen = 0.0  # m driven since the door was sensed
        self._path = np.zeros((0, 3))  # in the door's frame
        self._progress = 0
        self._asked_at = -math.inf
        self.weight = 0.0

    def steer(
        self,
        time: float,
        dt: float,
        asked: tuple[float, float],
        moved: Array,
        door: DoorAhead | None,
    ) -> tuple[float, float]:
        """Return the user's command with the heading rate blended, [v, omega].

        Args:
            time: Now [s].
            dt: Control period [s].
            asked: Command of the user [m/s, rad/s].
            moved: Pose of the chair in its frame at the last call, shape (3,).
            door: The door sensed now, or None.
        """
        self._carry(moved, door)
        wish = self._wish(time, asked)
        step = self._options.share * dt / self._options.rise
        goal = 0.0 if wish is None else self._options.share
        self.weight += min(max(goal - self.weight, -step), step)
        if wish is None or asked[0] <= 0.0:
            return asked
        slower = min(asked[0], self._options.pace)
        v = (1.0 - self.weight) * asked[0] + self.weight * slower
        own = asked[1] * v / asked[0]
        return v, (1.0 - self.weight) * own + self.weight * wish * v

    def _carry(self, moved: Array, door: DoorAhead | None) -> None:
        """Bring the remembered door into the body frame now, corrected by what is sensed."""
        if self.door is not None:
            pose = compose(invert(moved), self.door.pose)
            self._unseen += abs(float(moved[0]))
            x, y, heading = (float(value) for value in pose)
            self.door = DoorAhead(x, y, heading, self.door.width)
        if door is None:
            if self._unseen > self._options.lost:
                self._forget()
            return
        if self.door is None or math.hypot(door.x - self.door.x, door.y - self.door.y) > 0.5:
            if self.door is None or self.weight == 0.0:
                self._forget()
                self.door = door
            return
        share, known = self._options.trust, self.door
        self._unseen = 0.0
        turn = float(wrap(door.heading - known.heading))
        self.door = DoorAhead(
            known.x + share * (door.x - known.x),
            known.y + share * (door.y - known.y),
            known.heading + share * turn,
            door.width,
        )

    def _forget(self) -> None:
        self.door, self._path, self._progress, self._unseen = None, np.zeros((0, 3)), 0, 0.0

    def _wish(self, time: float, asked: tuple[float, float]) -> float | None:
        """Return the curvature [1/m] towards the path; None: the user drives alone."""
        options, door = self._options, self.door
        if door is None or asked[0] <= 0.0:
            return None
        curvature = asked[1] / asked[0]
        if len(self._path):
            wish = self._curvature_along(door)
            if wish is None or self._turns_away(door, curvature):
                self._forget()
                return None
            if self._off_path(door) <= options.off:
                return wish
        elif not self._heads_for(door, curvature):
            return None
        if time - self._asked_at >= options.retry:
            self._asked_at = time
            found = self._source(door)
            self._path, self._progress = np.zeros((0, 3)), 0
            if found is not None:
                self._path = np.asarray(compose(invert(door.pose), checked_path(found)))
                return self._curvature_along(door)
        return None

    def _heads_for(self, door: DoorAhead, curvature: float) -> bool:
        """Return whether the user's way leads to the door."""
        options = self._options
        distance = math.hypot(door.x, door.y)
        if (
            door.x <= 0.0
            or distance > options.reach
            or abs(float(wrap(door.heading))) > options.askew
        ):
            return False
        return abs(self._miss(door, curvature)) <= options.enter

    def _turns_away(self, door: DoorAhead, curvature: float) -> bool:
        """Return whether the user now steers well away from a door still ahead."""
        return door.x > 0.3 and abs(self._miss(door, curvature)) > self._options.leave

    def _miss(self, door: DoorAhead, curvature: float) -> float:
        """Return the angle between the bearing of a door and the chord of the indicated arc."""
        chord = 0.5 * curvature * math.hypot(door.x, door.y)
        return float(wrap(math.atan2(door.y, door.x) - chord))

    def _curvature_along(self, door: DoorAhead) -> float | None:
        """Return the curvature of the arc to the point steered for; None: past the path's end."""
        path = compose(door.pose, self._path)
        distance = np.hypot(path[:, 0], path[:, 1])
        window = distance[self._progress : self._progress + 20]
        self._progress += int(np.argmin(window))
        ahead = np.flatnonzero(distance[self._progress :] >= self._options.look_ahead)
        if not len(ahead):
            return None
        x, y = path[self._progress + ahead[0], :2]
        return float(2.0 * y / (x * x + y * y))

    def _off_path(self, door: DoorAhead) -> float:
        """Return the distance to the nearest pose of the path [m]."""
        near = compose(door.pose, self._path[self._progress : self._progress + 20])
        return float(np.hypot(near[:, 0], near[:, 1]).min())
