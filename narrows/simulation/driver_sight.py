"""What a person in the chair sees: the surfaces around, as far as nothing hides them."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from ..errors import ShapeError
from ..perception.compiled import compiled
from ..se2 import Array
from ..world import World

_EYE_LEVELS = (0.0, 1.6)  # m: what stands between floor and a head's height is seen


@dataclass(frozen=True)
class SightOptions:
    """How a seated person sees.

    Attributes:
        reach: How far they care [m].
        spacing: Angle between two directions they notice something in [rad].
        field: Half of what they see by turning the head, eyes ahead or behind [rad].
        eye: How far ahead of the drive axle the eyes are [m].
    """

    reach: float = 4.0
    spacing: float = math.radians(3.0)
    field: float = math.radians(125.0)
    eye: float = 0.1

    def __post_init__(self) -> None:
        """Check the numbers."""
        if not (self.reach > 0.0 and 0.0 < self.spacing < 1.0 and 0.0 < self.field <= math.pi):
            raise ShapeError("sight needs a reach > 0, a spacing in (0, 1) and a field in (0, pi]")


class Sight:
    """The eyes of one driver in one world."""

    def __init__(self, world: World, options: SightOptions | None = None) -> None:
        """Look at a world.

        Args:
            world: The true one, people included.
            options: Default `SightOptions()`.
        """
        self._options = SightOptions() if options is None else options
        pieces = world.pieces_between(*_EYE_LEVELS)
        begin, end, circles = [], [], []
        for corners, radius in zip(pieces.corners, pieces.radius, strict=True):
            if radius > 0.0:
                circles.append([*corners[0], radius])
                continue
            begin.append(corners)
            end.append(np.roll(corners, -1, axis=0))
        self._begin = np.concatenate(begin) if begin else np.zeros((0, 2))
        self._end = np.concatenate(end) if end else np.zeros((0, 2))
        self._circles = np.array(circles).reshape(-1, 3)
        self._moving = world.moving
        count = math.ceil(2.0 * self._options.field / self._options.spacing) + 1
        self._fan = np.linspace(-self._options.field, self._options.field, count)

    def look(self, time: float, pose: ArrayLike, *, behind: bool = False) -> Array:
        """Return what is seen, as points in the body frame, shape (M, 2), [m].

        Args:
            time: When, for what moves [s].
            pose: True pose of the chair, shape (3,), [m, m, rad].
            behind: Look over the shoulder.
        """
        x, y, heading = (float(value) for value in np.asarray(pose, dtype=float))
        circles = self._circles
        if self._moving:
            people = [[*solid.position(time), solid.radius] for solid in self._moving]
            circles = np.concatenate([circles, np.array(people)])
        eye = self._options.eye
        x, y = x + eye * math.cos(heading), y + eye * math.sin(heading)
        fan = self._fan + (math.pi if behind else 0.0)
        ranges = ray_ranges(
            x, y, fan + heading, self._begin, self._end, circles, self._options.reach
        )
        seen = ranges < self._options.reach
        fan, ranges = fan[seen], ranges[seen]
        return np.column_stack([eye + ranges * np.cos(fan), ranges * np.sin(fan)])


@compiled
def ray_ranges(
    x: float, y: float, angles: Array, begin: Array, end: Array, circles: Array, reach: float
) -> Array:
    """Return how far rays go before they meet a wall or a round thing, shape (R,), [m].

    Args:
        x: Where they begin [m].
        y: Where they begin [m].
        angles: Their directions, shape (R,), [rad].
        begin: Where walls begin, shape (E, 2), [m].
        end: Where they end, shape (E, 2), [m].
        circles: Rows [x, y, radius], shape (C, 3), [m].
        reach: What a ray that meets nothing gets [m].
    """
    ranges = np.full(len(angles), reach)
    for ray in range(len(angles)):
        c, s = math.cos(angles[ray]), math.sin(angles[ray])
        best = reach
        for k in range(len(begin)):
            ex, ey = end[k, 0] - begin[k, 0], end[k, 1] - begin[k, 1]
            bx, by = begin[k, 0] - x, begin[k, 1] - y
            across = c * ey - s * ex
            if across == 0.0:
                continue
            distance = (bx * ey - by * ex) / across
            share = (bx * s - by * c) / across
            if 0.0 <= distance < best and 0.0 <= share <= 1.0:
                best = distance
        for k in range(len(circles)):
            bx, by, radius = circles[k, 0] - x, circles[k, 1] - y, circles[k, 2]
            foot = bx * c + by * s
            gap = radius * radius - (bx * bx + by * by - foot * foot)
            if gap > 0.0 and 0.0 <= foot - math.sqrt(gap) < best:
                best = foot - math.sqrt(gap)
        ranges[ray] = best
    return ranges


@compiled
def free_travel(points: Array, body: Array, twists: Array, step: float, steps: int) -> Array:
    """Return how far a rectangle goes along constant twists before a point is in it, shape (C,).

    Args:
        points: In its frame, shape (M, 2), [m].
        body: Its low x, high x, low y, high y, shape (4,), [m].
        twists: Rows [v, omega] per unit of travel, shape (C, 2).
        step: Travel between two looks.
        steps: Number of looks.
    """
    travel = np.full(len(twists), step * steps)
    for row in range(len(twists)):
        v, omega = twists[row, 0], twists[row, 1]
        hit = False
        for k in range(1, steps + 1):
            angle = omega * k * step
            half = 0.5 * angle
            chord = v * k * step
            if abs(half) > 1e-9:
                chord *= math.sin(half) / half
            px, py = chord * math.cos(half), chord * math.sin(half)
            c, s = math.cos(angle), math.sin(angle)
            for m in range(len(points)):
                dx, dy = points[m, 0] - px, points[m, 1] - py
                along, across = c * dx + s * dy, c * dy - s * dx
                if body[0] < along < body[1] and body[2] < across < body[3]:
                    hit = True
                    break
            if hit:
                travel[row] = (k - 1) * step
                break
    return travel
