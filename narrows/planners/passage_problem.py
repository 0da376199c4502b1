"""A scene as the question that passage.py answers: a body about a pivot, obstacles, two ends."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np
import shapely

from ..scene import Scene
from ..se2 import Array, rotate
from .heading_slices import ObstaclePieces
from .swept_body import TurningBody

_COARSE = 36  # headings before refinement
_MERGED = math.radians(1.0)  # even headings closer than this to a critical one are dropped
_CRITICAL = 6  # directions of walls whose parallels are tried
_HAIR = 1e-7  # headings closer than this are one [rad]


@dataclass(frozen=True, eq=False)
class PassageProblem:
    """Where a turning body may go, from a pose to a region of poses.

    World coordinates are taken relative to `origin`, so that rounding does not depend on where
    the map lies. A pose of the body here is the place of its *pivot* and its heading; how places
    hang together does not depend on the choice of the pivot, but a pivot in the middle of the
    body makes it sweep least while it turns.

    Attributes:
        layers: The body's layers about the pivot, without growth.
        pieces: For each layer, the obstacles between its heights.
        pivot: The pivot in the body frame, shape (2,), [m].
        origin: World coordinates that are zero here, shape (2,), [m].
        bounds: x0, y0, x1, y1 the whole body stays in, shape (4,), [m], or None.
        start: Pivot and heading at the start, shape (3,), [m, m, rad].
        goal: The body frame's pose at the goal, shape (3,), [m, m, rad].
        position_tolerance: Radius of the goal region for the body frame's origin [m].
        heading_tolerance: Half the range of goal headings [rad].
        headings: Headings to cut the circle at first, in [0, 2 pi), increasing [rad].
    """

    layers: tuple[TurningBody, ...]
    pieces: tuple[ObstaclePieces, ...]
    pivot: Array
    origin: Array
    bounds: Array | None
    start: Array
    goal: Array
    position_tolerance: float
    heading_tolerance: float
    headings: tuple[float, ...]

    @classmethod
    def from_scene(cls, scene: Scene) -> PassageProblem:
        """Return the question a scene asks; solids that move are left out."""
        vehicle, world = scene.vehicle, scene.world
        circle = shapely.minimum_bounding_circle(shapely.Polygon(vehicle.outline))
        pivot = np.array([circle.centroid.x, circle.centroid.y])
        start = np.array(scene.start, dtype=float)
        goal = np.array(scene.goal.pose, dtype=float)
        origin = start[:2].copy()
        pieces = []
        for layer in vehicle.layers:
            found = world.pieces_between(*layer.z)
            pieces.append(ObstaclePieces.bracket(found.corners - origin, found.radius))
        start_pivot = np.append(rotate(start[2], pivot), start[2])
        goal[:2] -= origin
        problem = cls(
            layers=tuple(TurningBody.about(pivot, layer.polygon) for layer in vehicle.layers),
            pieces=tuple(pieces),
            pivot=pivot,
            origin=origin,
            bounds=None if world.bounds is None else np.array(world.bounds) - np.tile(origin, 2),
            start=start_pivot,
            goal=goal,
            position_tolerance=float(scene.goal.position_tolerance),
            heading_tolerance=float(scene.goal.heading_tolerance),
            headings=(),
        )
        return replace(problem, headings=_first_headings(problem))

    @property
    def smallest_growth(self) -> float:
        """Growth, negative, that leaves nothing of the body but a millimetre [m]."""
        depths = []
        for layer in self.layers:
            shape = shapely.Polygon(layer.corners)
            depths.append(shapely.maximum_inscribed_circle(shape, 1e-3).length)
        return 5e-4 - max(depths)

    def reach(self, growth: float) -> float:
        """Return how far the body grown by `growth` reaches from the pivot, mitres included [m]."""
        corners = [layer.grown(growth).corners for layer in self.layers]
        return max((float(np.hypot(*c.T).max()) for c in corners if c is not None), default=0.0)

    def goal_pivot(self, heading: float) -> Array:
        """Return where the pivot is in the middle of the goal region at a heading, (2,), [m]."""
        return self.goal[:2] + rotate(heading, self.pivot)

    def goal_heading_offset(self, heading: float) -> float:
        """Return how far a heading is from the goal's, 0..pi [rad]."""
        return abs(math.remainder(heading - self.goal[2], 2.0 * math.pi))

    def whole_window(self, growth: float) -> Array:
        """Return a box for the pivot that no way around anything leaves, shape (4,), [m]."""
        ends = [self.start[:2], self.goal_pivot(float(self.goal[2]))]
        low, high = np.min(ends, axis=0), np.max(ends, axis=0)
        if self.bounds is not None:
            low, high = np.minimum(low, self.bounds[:2]), np.maximum(high, self.bounds[2:])
        else:
            for pieces in self.pieces:
                if len(pieces.around):
                    low = np.minimum(low, pieces.around.min(axis=(0, 1)))
                    high = np.maximum(high, pieces.around.max(axis=(0, 1)))
        reach = 4.0 * self.reach(max(growth, 0.0)) + self.position_tolerance + 0.1
        return np.concatenate([low - reach, high + reach])


def _first_headings(problem: PassageProblem) -> tuple[float, ...]:
    """Return start, goal range, headings parallel to long walls, and an even spread."""
    tolerance = problem.heading_tolerance
    goal = float(problem.goal[2])
    ends = [goal, goal - tolerance, goal + tolerance] if tolerance < math.pi else [goal]
    fixed = _distinct([float(problem.start[2]), *ends], [], _HAIR)
    fixed = _distinct(_parallel_headings(problem), fixed, 1e-4)
    even = [2.0 * math.pi * k / _COARSE for k in range(_COARSE)]
    return tuple(sorted(_distinct(even, fixed, _MERGED)))


def _distinct(candidates: list[float], known: list[float], gap: float) -> list[float]:
    """Return the known headings and those candidates that are no closer than `gap` to any."""
    kept = list(known)
    for candidate in candidates:
        if all(abs(math.remainder(candidate - k, 2.0 * math.pi)) > gap for k in kept):
            kept.append(candidate % (2.0 * math.pi))
    return kept


def _parallel_headings(problem: PassageProblem) -> list[float]:
    """Return the headings at which an edge of the body is parallel to a long wall.

    There a body fits most tightly between parallel walls; a cut exactly there finds it.
    """
    lengths: dict[int, float] = {}
    exact: dict[int, float] = {}
    for pieces in problem.pieces:
        edges = (np.roll(pieces.inside, -1, axis=1) - pieces.inside).reshape(-1, 2)
        size = np.hypot(edges[:, 0], edges[:, 1])
        for edge, length in zip(edges[size > 0.05], size[size > 0.05], strict=True):
            angle = math.atan2(edge[1], edge[0]) % math.pi
            key = round(math.degrees(angle) * 10.0) % 1800
            lengths[key] = lengths.get(key, 0.0) + float(length)
            exact[key] = angle
    longest = sorted(lengths, key=lambda key: (-lengths[key], key))[:_CRITICAL]
    headings = []
    for key in longest:
        for layer in problem.layers:
            across = np.arctan2(layer.normals[:, 1], layer.normals[:, 0])
            headings += [
                exact[key] + math.pi / 2 - float(a) + k * math.pi for a in across for k in (0, 1)
            ]
    return headings
