"""Doors and corridors in a scan, so that a plan can begin with what is sensed.

What is called a door here:
- beams pass through a wall's plane and go on for `beyond`, side by side;
- on each side the opening ends at the wall, at its reveal, or at a door leaf that meets it; on
  one side at least `long_side` of wall is seen within 0.6 m, on the other `short_side`;
- no wall runs through the plane at its side, and nothing stands in it;
- it is neither narrower nor wider than a door is.

So no door is the gap between a cupboard and a side wall, or between chair legs (no wall beside
them), or before a recess (not deep enough), or one of which a side is hidden by what stands before
it: half a door is no door yet. A gap between two cupboards in line is one, for who wants to drive
through.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np

from ..errors import InputError
from ..se2 import Array
from .door_edges import crossing_of, edge_of, is_crossed, passages, side_length
from .ranges import LaserScan
from .walls import SortedScan, Wall, WallOptions, find_walls

_CLEAR = 0.3  # m: nothing stands in the opening that near to the wall's plane


@dataclass(frozen=True)
class OpeningOptions:
    """What counts as a door and as a corridor.

    Attributes:
        walls: What counts as a wall.
        narrowest: Of a door [m].
        widest: Of a door [m].
        beyond: How far behind the wall's plane beams must go on [m].
        long_side: Wall seen on the better side of a door [m].
        short_side: Wall seen on the other [m].
        corridor_width: Least and greatest width of a corridor [m].
        corridor_shape: Length both walls are seen along, least, in widths.
        parallel: Greatest angle between the walls of a corridor [rad].
    """

    walls: WallOptions = field(default_factory=WallOptions)
    narrowest: float = 0.6
    widest: float = 1.4
    beyond: float = 0.8
    long_side: float = 0.3
    short_side: float = 0.1
    corridor_width: tuple[float, float] = (0.7, 2.5)
    corridor_shape: float = 1.5
    parallel: float = math.radians(4.0)

    def __post_init__(self) -> None:
        """Refuse what leaves no door or corridor."""
        if not 0.0 < self.narrowest < self.widest < math.inf:
            sizes = f"{self.narrowest}..{self.widest} m"
            raise InputError("no door", field="narrowest, widest", value=sizes)
        if not 0.0 < self.corridor_width[0] < self.corridor_width[1] < math.inf:
            raise InputError("no corridor", field="corridor_width", value=self.corridor_width)
        for name in ("beyond", "long_side", "short_side", "corridor_shape", "parallel"):
            value = getattr(self, name)
            if not (math.isfinite(value) and value > 0.0):
                raise InputError("must be positive", field=name, value=value, allowed="> 0")


@dataclass(frozen=True, eq=False)
class SensedDoor:
    """A doorway seen, in the body frame.

    Attributes:
        center: Middle of the clear opening on the near face of the wall, shape (2,), [m].
        width: Clear width between jambs, or between a jamb and an open leaf [m].
        heading: Direction of driving through, away from the sensor [rad].
        uncertainty: How far each jamb may be off along the wall: half the way between the beams
            on either side of an edge, the sensor's error where a face is seen [m].
        depth: How far behind the wall's near face jambs or an open leaf are seen to go [m].
        beams: Number of beams that pass.
    """

    center: Array
    width: float
    heading: float
    uncertainty: float
    depth: float
    beams: int

    @property
    def jambs(self) -> Array:
        """The edges, right and left of one who drives through, shape (2, 2), [m]."""
        left = np.array([-math.sin(self.heading), math.cos(self.heading)])
        return self.center + 0.5 * self.width * np.array([-left, left])


@dataclass(frozen=True, eq=False)
class SensedCorridor:
    """Two parallel walls with the sensor between them, in the body frame.

    Attributes:
        width: Distance between them [m].
        direction: Of the corridor, the way nearer to the chair's heading, in (-pi/2, pi/2] [rad].
        offset: Of the body's origin to the left of the middle line [m].
        length: Length both walls are seen along [m].
    """

    width: float
    direction: float
    offset: float
    length: float


def find_doors(scan: LaserScan, options: OpeningOptions | None = None) -> tuple[SensedDoor, ...]:
    """Return the doors in a scan, the nearest first; none in a scan without answers.

    Args:
        scan: A scan, or what a map makes of itself (`narrows.perception.map_scan`).
        options: What counts as a door.
    """
    chosen = options or OpeningOptions()
    seen = SortedScan.of(scan, chosen.walls.reach)
    found: list[SensedDoor] = []
    walls = find_walls(seen, chosen.walls)
    for wall in walls:
        found += _doors_in(seen, wall, walls, chosen)
    found.sort(key=lambda door: -door.beams)
    kept: list[SensedDoor] = []
    for door in found:  # both faces of a thick wall show the same door
        if all(np.linalg.norm(door.center - other.center) > 0.5 for other in kept):
            kept.append(door)
    return tuple(sorted(kept, key=lambda door: float(np.hypot(*door.center))))


def find_corridor(scan: LaserScan, options: OpeningOptions | None = None) -> SensedCorridor | None:
    """Return the corridor the sensor is in, the one seen furthest, or None."""
    chosen = options or OpeningOptions()
    seen = SortedScan.of(scan, chosen.walls.reach)
    walls = find_walls(seen, chosen.walls)
    best: SensedCorridor | None = None
    for index, one in enumerate(walls):
        for other in walls[index + 1 :]:
            found = _corridor(seen, one, other, chosen)
            if found is not None and (best is None or found.length > best.length):
                best = found
    return best


def _corridor(
    scan: SortedScan, one: Wall, other: Wall, options: OpeningOptions
) -> SensedCorridor | None:
    """Return the corridor between two walls; None if they make none."""
    if math.acos(min(1.0, max(-1.0, -float(one.normal @ other.normal)))) > options.parallel:
        return None
    weights = len(one.along) * one.tangent - len(other.along) * other.tangent
    direction = math.atan2(weights[1], weights[0])
    if abs(direction) > 0.5 * math.pi:
        direction -= math.copysign(math.pi, direction)
    way = np.array([math.cos(direction), math.sin(direction)])
    left = np.array([-way[1], way[0]])
    spans, sides = [], []
    for wall in (one, other):
        points = wall.distance * wall.normal + wall.along[:, None] * wall.tangent
        spans.append(points @ way)
        sides.append(float((points @ left).mean()))
    low, high = sorted(sides)
    begin, end = max(span.min() for span in spans), min(span.max() for span in spans)
    width, length = high - low, float(end - begin)
    least, most = options.corridor_width
    seen = min(one.length, other.length, length)
    if not (low < 0.0 < high and least <= width <= most and seen >= options.corridor_shape * width):
        return None
    offset = -0.5 * (low + high) - float(scan.place @ left)
    return SensedCorridor(width, direction, offset, length)


def _doors_in(
    scan: SortedScan, wall: Wall, walls: Sequence[Wall], options: OpeningOptions
) -> list[SensedDoor]:
    """Return the doors in a wall."""
    cross = crossing_of(scan, wall)
    tolerance = options.walls.tolerance
    passing = (cross.depth > options.beyond) & ~np.isnan(cross.along)
    silent = np.isnan(cross.depth) & ~np.isnan(cross.along)
    doors = []
    for first, last in passages(passing, silent):
        right = edge_of(cross, first, -1, widest=options.widest, walls=options.walls)
        left = edge_of(cross, last, +1, widest=options.widest, walls=options.walls)
        if right is None or left is None:
            continue
        width = left.place - right.place
        beside = (side_length(cross, right, -1, tolerance), side_length(cross, left, +1, tolerance))
        sides = sorted(beside)
        if not options.narrowest <= width <= options.widest:
            continue
        if sides[0] < options.short_side or sides[1] < options.long_side:
            continue
        if is_crossed(wall, right, walls) or is_crossed(wall, left, walls):
            continue
        inside = (cross.place > right.place + 0.06) & (cross.place < left.place - 0.06)
        if np.count_nonzero(inside & (np.abs(cross.depth) < _CLEAR)) > 2:
            continue
        middle = 0.5 * (left.place + right.place)
        center = scan.place + wall.distance * wall.normal + middle * wall.tangent
        heading = math.atan2(wall.normal[1], wall.normal[0])
        error = max(left.error, right.error, options.walls.error)
        depth = max(left.depth, right.depth)
        count = int(np.count_nonzero(passing[first : last + 1]))
        doors.append(SensedDoor(center, width, heading, error, depth, count))
    return doors
