"""The next door for the assistant: sensed in the front scan, and a certified path through it."""

from __future__ import annotations

import math
from bisect import bisect_right
from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import ArrayLike

from ..interfaces import PlanStatus
from ..perception.openings import find_doors
from ..perception.ranges import LaserScan
from ..planners import plan
from ..reactive.door_ahead import DoorAhead
from ..scene import Goal, Scene
from ..se2 import Array, compose, invert, transform
from ..vehicle import Vehicle
from ..world import Solid, World
from .chair_senses import ChairSenses

_ASKEW = math.radians(80.0)  # a door further off the chair's heading is not ahead
_WALL = 3.0  # m of wall assumed beside a sensed door
_THICKNESS = 0.15  # m of it
_ENOUGH = 0.08  # m of clearance; more is not aimed at
_KEPT = 1.0  # s: how long poses are remembered to carry a scan's doors to now


class DoorSense:
    """Finds the door ahead in the newest scan, carried to where the chair is now."""

    def __init__(self, senses: ChairSenses, scanner: str = "front", reach: float = 3.5) -> None:
        """Look for doors.

        Args:
            senses: The chair's.
            scanner: Name of the scanner that looks ahead.
            reach: Distance up to which doors count [m].
        """
        self._senses, self._scanner, self._reach = senses, scanner, reach
        self._times: list[float] = []
        self._poses: list[Array] = []
        self._looked_at = -math.inf

    def ahead(self, time: float, pose: ArrayLike) -> DoorAhead | None:
        """Return the nearest door ahead if a new scan shows one, in the body frame now.

        Args:
            time: Now [s].
            pose: Pose the chair believes to have, shape (3,), [m, m, rad].
        """
        now = np.array(pose, dtype=float)
        self._times, self._poses = [*self._times, time], [*self._poses, now]
        while self._times[0] < time - _KEPT:
            self._times, self._poses = self._times[1:], self._poses[1:]
        scan = self._senses.answers.get(self._scanner)
        if not isinstance(scan, LaserScan) or scan.time <= self._looked_at:
            return None
        self._looked_at = scan.time
        then = self._poses[max(bisect_right(self._times, scan.time + 1e-6) - 1, 0)]
        moved = compose(invert(now), then)  # the body's frame then, seen from now
        for door in find_doors(scan):
            x, y, heading = compose(moved, [*door.center, door.heading]).tolist()
            heading = math.remainder(heading, 2.0 * math.pi)
            if x > 0.0 and math.hypot(x, y) < self._reach and abs(heading) < _ASKEW:
                return DoorAhead(x, y, heading, door.width)
        return None


class CertifiedDoorPaths:
    """Plans forward through a sensed door, far from its posts if that can be; certified or not.

    Attributes:
        asked: How often a path was asked for.
        found: How often there was one.
    """

    def __init__(
        self,
        vehicle: Vehicle,
        *,
        beyond: float = 0.6,
        shares: Sequence[float] = (0.6, 0.4),
    ) -> None:
        """Plan for a chair.

        Args:
            vehicle: The chair; the paths only drive forward.
            beyond: How far behind the door a path ends [m].
            shares: Clearances aimed at, one after the other until there is a path, as shares of
                what the door leaves on either side. With more the path swings far out before the
                door, with less the assistant stops beside a post.
        """
        self._vehicle = vehicle.with_limits(reverse_speed=0.0)
        self._beyond, self._shares = beyond, tuple(shares)
        self.asked, self.found = 0, 0

    def __call__(self, door: DoorAhead) -> Array | None:
        """Return poses of a path in the body frame now, shape (N, 3), or None."""
        self.asked += 1
        half = 0.5 * door.width
        walls = [_wall(door, half, half + _WALL), _wall(door, -half - _WALL, -half)]
        goal = Goal(compose(door.pose, [_THICKNESS + self._beyond, 0.0, 0.0]))
        scene = Scene(self._vehicle, World(tuple(walls)), np.zeros(3), goal)
        spare = half - 0.5 * self._vehicle.width
        for share in self._shares if spare > 0.0 else ():
            margin = min(share * spare, _ENOUGH)
            answer = plan(replace(scene, margin=margin), planner="manoeuvre")
            path = answer.path if answer.status is PlanStatus.CERTIFIED else None
            if path is not None and not path.direction_changes:
                self.found += 1
                count = max(2, math.ceil(path.span / 0.05) + 1)
                return path(np.linspace(0.0, path.span, count))
        return None


def _wall(door: DoorAhead, low: float, high: float) -> Solid:
    """Return the wall beside a door between two distances to its left; its near face is sensed."""
    corners = [[0.0, low], [_THICKNESS, low], [_THICKNESS, high], [0.0, high]]
    return Solid.polygon(transform(door.pose, corners), name="wall beside the door")
