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
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from ..errors import InputError
from ..se2 import Array
from .ranges import Beam, LaserScan
from .walls import SortedScan, Wall, WallOptions, find_walls

_NEIGHBOUR = 0.6  # m: wall beside an opening within this is its side
_CORNER = 0.05  # m: an edge lies that far inside the last beam that passes, at most
_LEAF = 1.0  # m: length of a door leaf
_BEGIN = 0.25  # m: a face begins that near to the wall's plane
_THICKEST = 0.45  # m: wall
_SLANT = math.radians(20.0)  # between what stands across a wall and what slants to it
_GAP = 0.2  # m: what is further apart is not one side
_CLEAR = 0.3  # m: nothing stands in the opening that near to the wall's plane
_ROUND = 0.01  # m: returns of a corner seen from the side lie within this across
_STRIP = 0.03  # m: returns of a reveal or a leaf lie within this across


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


@dataclass(frozen=True, eq=False)
class _Crossing:
    """Where the beams of a scan meet a wall's plane.

    Attributes:
        along: Where a beam crosses the plane, shape (N,), [m]; NaN where it does not.
        depth: How far behind the plane its return lies, shape (N,), [m]; infinite: clear, NaN: no
            answer.
        place: Where its return lies along the wall, shape (N,), [m].
        foot: Distance of the sensor from the plane [m].
    """

    along: Array
    depth: Array
    place: Array
    foot: float


def _crossing(scan: SortedScan, wall: Wall) -> _Crossing:
    facing = scan.directions @ wall.normal
    with np.errstate(divide="ignore", invalid="ignore"):
        reach = np.where(facing > 0.03, wall.distance / facing, np.nan)
        along = reach * (scan.directions @ wall.tangent)
    returned = scan.beams == Beam.RETURN
    depth = np.where(returned, scan.ranges * facing - wall.distance, np.nan)
    depth[scan.beams == Beam.CLEAR] = np.inf
    place = np.where(returned, scan.ranges * (scan.directions @ wall.tangent), np.nan)
    return _Crossing(along, depth, place, wall.distance)


def _doors_in(
    scan: SortedScan, wall: Wall, walls: Sequence[Wall], options: OpeningOptions
) -> list[SensedDoor]:
    """Return the doors in a wall."""
    cross = _crossing(scan, wall)
    tolerance = options.walls.tolerance
    passing = (cross.depth > options.beyond) & ~np.isnan(cross.along)
    silent = np.isnan(cross.depth) & ~np.isnan(cross.along)
    doors = []
    for first, last in _runs(passing, silent):
        right = _edge(cross, first, -1, options)
        left = _edge(cross, last, +1, options)
        if right is None or left is None:
            continue
        width = left.place - right.place
        sides = sorted((_side(cross, right, -1, tolerance), _side(cross, left, +1, tolerance)))
        if not options.narrowest <= width <= options.widest:
            continue
        if sides[0] < options.short_side or sides[1] < options.long_side:
            continue
        if _is_crossed(wall, right, walls) or _is_crossed(wall, left, walls):
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


def _runs(passing: NDArray[np.bool_], silent: NDArray[np.bool_]) -> list[tuple[int, int]]:
    """Return first and last beam of each run that passes, up to two silent ones bridged."""
    beams = np.flatnonzero(passing)
    if len(beams) < 3:
        return []
    breaks = np.flatnonzero(np.diff(beams) > 1)
    ends = [-1]
    for k in breaks.tolist():
        between = silent[beams[k] + 1 : beams[k + 1]]
        if len(between) > 2 or not between.all():
            ends.append(k)
    ends.append(len(beams) - 1)
    return [
        (int(beams[before + 1]), int(beams[last]))
        for before, last in pairwise(ends)
        if last - before >= 3
    ]


@dataclass(frozen=True)
class _Edge:
    """One side of an opening: place along the wall, its error, depth of its face [m]."""

    place: float
    error: float
    depth: float


def _edge(cross: _Crossing, beam: int, side: int, options: OpeningOptions) -> _Edge | None:
    """Return the edge beside the outermost beam that passes; None if nothing marks it.

    Where returns lie on a face that leads away from the wall, of the jamb or of a leaf: that face.
    Where a jamb is seen from the side and its innermost returns lie behind the plane: those.
    Else the middle between the last beam that passes and the innermost return of the wall.
    """
    inward = side * (cross.along[beam] - cross.place)  # how far inside that beam a return lies
    near = (inward < _CORNER) & (inward > -options.widest) & (np.abs(cross.depth) < _LEAF)
    seeds = inward[near & (np.abs(cross.depth) < _BEGIN)]
    if not len(seeds) or not _is_next(cross, beam, side, options):
        return None
    innermost = float(seeds.max())
    within = near & (inward <= innermost)
    face, corner = (within & (inward >= innermost - width) for width in (_STRIP, _ROUND))
    depth = max(float(cross.depth[face].max()), 0.0)
    error = options.walls.error
    away = face & (np.abs(cross.depth) > options.walls.tolerance)
    if away.any() and np.count_nonzero(face) >= 3 and float(cross.depth[face].std()) > 2.0 * error:
        count, place = int(np.count_nonzero(away)), float(np.median(cross.place[away]))
        return _Edge(place, error / math.sqrt(count), depth)
    count = int(np.count_nonzero(corner))
    behind = float(cross.depth[corner].mean()) > 1.5 * error / math.sqrt(count)
    if behind and side * cross.along[beam] > 0.2 * cross.foot:
        return _Edge(float(np.median(cross.place[corner])), error, depth)
    half = 0.5 * innermost
    return _Edge(float(cross.along[beam] - side * half), abs(half), depth)


def _is_next(cross: _Crossing, beam: int, side: int, options: OpeningOptions) -> bool:
    """Return whether the next beam that answers ends behind the wall's plane, or at it, or a leaf.

    If it ends before it, further from any face than a leaf is thick, something hides the edge.
    """
    following = beam + side
    while 0 <= following < len(cross.depth) and np.isnan(cross.depth[following]):
        following += side
    if not 0 <= following < len(cross.depth):
        return False
    return bool(cross.depth[following] > -_LEAF)


def _side(cross: _Crossing, edge: _Edge, side: int, tolerance: float) -> float:
    """Return how much of the wall is seen beside an edge, or the length of a leaf there [m]."""
    outward = side * (cross.place - edge.place)
    flat = (np.abs(cross.depth) <= tolerance) & (outward > -_STRIP) & (outward < _NEIGHBOUR)
    face = (np.abs(outward) <= _STRIP) & (np.abs(cross.depth) < _LEAF)
    before, behind = _span(-cross.depth[face]), _span(cross.depth[face])
    return max(_span(outward[flat]), before, behind)


def _is_crossed(wall: Wall, edge: _Edge, others: Sequence[Wall]) -> bool:
    """Return whether another wall runs through the plane at an edge, or meets it at a slant.

    A jamb or a leaf stands across the plane and ends.
    """
    for other in others:
        sine = float(wall.normal[0] * other.normal[1] - wall.normal[1] * other.normal[0])
        if other is wall or abs(sine) < math.sin(_SLANT):
            continue
        points = other.distance * other.normal + other.along[:, None] * other.tangent
        depth = points @ wall.normal - wall.distance
        place = (other.distance - wall.distance * float(wall.normal @ other.normal)) / sine
        if abs(place - edge.place) > _BEGIN or np.abs(depth).min() > _BEGIN:
            continue
        before, behind = _span(-depth), _span(depth)
        if abs(sine) < math.cos(_SLANT) or min(before, behind) > _THICKEST:
            return True
        if before > 1.1 * _LEAF or behind > 1.1 * _LEAF + _THICKEST:
            return True
    return False


def _span(places: Array) -> float:
    """Return how far rows of at least four places go on from 0 without a wide gap [m]."""
    rows = np.sort(places[places > -_STRIP])
    if len(rows) < 4 or rows[0] > _BEGIN:
        return 0.0
    gaps = np.flatnonzero(np.diff(rows) > _GAP)
    last = int(gaps[0]) if len(gaps) else len(rows) - 1
    return float(rows[last]) if last >= 3 else 0.0
