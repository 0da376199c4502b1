"""A map of a place learned from laser scans and odometry: where everything is put into one frame.

[DrivingAssistant, Section V-B] learned a grid of 2 cm cells with GMapping (Grisetti, Stachniss,
Burgard, 2007). This is the small part of that which a course of rooms needs: one hypothesis, each
scan aligned to the map so far before it is added. The gradient of the distance to the nearest
occupied cell pulls the scan's points onto the walls (Gauss-Newton, outliers weighted down), the
odometry says where to begin and holds what the walls leave open, such as the way along a corridor.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy import ndimage

from ..errors import ShapeError
from ..perception.compiled import compiled
from ..perception.ranges import LaserScan
from ..se2 import Array, compose, invert, transform, wrap

_HIT, _MISS, _MOST = 3, -1, 24  # evidence of a return, of a ray passing, its bound
_NEAR = 0.4  # m: points further from the map than that do not pull
_ROUNDS = 15


@dataclass(frozen=True, eq=False)
class GridMap:
    """Cells of a place, occupied or not.

    Attributes:
        occupied: Whether a cell is, shape (columns along x, rows along y).
        lower: Corner of the map with the least x and y, shape (2,), [m].
        cell: Edge of a cell [m].
    """

    occupied: NDArray[np.bool_]
    lower: Array
    cell: float

    def __post_init__(self) -> None:
        """Check the shapes."""
        if np.ndim(self.occupied) != 2 or np.shape(self.lower) != (2,) or not self.cell > 0.0:
            raise ShapeError("a grid map needs cells (A, B), a corner (2,) and an edge > 0")

    @cached_property
    def field(self) -> Array:
        """Distance of each cell's middle to the nearest occupied one's [m], at most 0.4."""
        if not self.occupied.any():
            return np.full(self.occupied.shape, _NEAR)
        distance = ndimage.distance_transform_edt(~self.occupied, sampling=self.cell)
        return np.minimum(np.asarray(distance), _NEAR)

    @property
    def points(self) -> Array:
        """Middles of the occupied cells, shape (N, 2), [m]."""
        return (np.argwhere(self.occupied) + 0.5) * self.cell + self.lower

    def distance(self, points: ArrayLike) -> Array:
        """Return how far points are from the nearest occupied cell, shape (...), [m], at most 0.4.

        Args:
            points: In the map's frame, shape (..., 2), [m]; outside of it: 0.4.
        """
        places = (np.asarray(points, dtype=float) - self.lower) / self.cell - 0.5
        flat = places.reshape(-1, 2).T
        values = ndimage.map_coordinates(self.field, flat, order=1, mode="constant", cval=_NEAR)
        return np.asarray(values).reshape(places.shape[:-1])


class GridMapper:
    """Learns a map from scans, and where it is in it.

    Attributes:
        pose: Where the chair is in the map, shape (3,), [m, m, rad].
    """

    def __init__(
        self,
        bounds: tuple[float, float, float, float],
        pose: ArrayLike,
        *,
        cell: float = 0.02,
        odometry: tuple[float, float] = (0.1, 0.1),
    ) -> None:
        """Begin an empty map.

        Args:
            bounds: x_min, y_min, x_max, y_max of the map [m].
            pose: Where the chair begins, shape (3,), [m, m, rad]: it defines the map's frame.
            cell: Edge of a cell [m].
            odometry: How far odometry may be wrong between two scans: share of the distance and
                of the angle.
        """
        count = [math.ceil((bounds[k + 2] - bounds[k]) / cell - 1e-9) for k in (0, 1)]
        self._lower = np.array(bounds[:2], dtype=float)
        self._cell = cell
        self._odometry = odometry
        self._evidence = np.zeros(count, dtype=np.int8)
        self._before: Array | None = None
        self.pose = np.array(pose, dtype=float)

    @property
    def map(self) -> GridMap:
        """The map so far."""
        return GridMap(self._evidence > 0, self._lower, self._cell)

    def add(self, odometry: ArrayLike, scans: Sequence[LaserScan]) -> Array:
        """Add scans taken together and return where the chair is, shape (3,), [m, m, rad].

        Args:
            odometry: Pose by the wheels alone, in a frame of its own, shape (3,), [m, m, rad].
            scans: What the scanners measured there.
        """
        now = np.asarray(odometry, dtype=float)
        if self._before is not None:
            step = compose(invert(self._before), now)
            self.pose = compose(self.pose, step)
            points = np.concatenate([scan.points[:, :2] for scan in scans])
            spread = (
                0.005 + self._odometry[0] * math.hypot(step[0], step[1]),
                0.003 + self._odometry[1] * abs(math.remainder(float(step[2]), 2.0 * math.pi)),
            )
            self.pose = aligned(self.map, self.pose, points, spread)
        self._before = now
        for scan in scans:
            eye = compose(self.pose, scan.mounting.pose)[:2]
            ends = transform(self.pose, scan.points[:, :2])
            add_rays(self._evidence, (eye - self._lower) / self._cell, self._scaled(ends))
        return self.pose

    def _scaled(self, points: Array) -> Array:
        return np.asarray((points - self._lower) / self._cell)


def aligned(
    grid: GridMap, pose: Array, points: Array, spread: tuple[float, float], noise: float = 0.02
) -> Array:
    """Return the pose that puts a scan's points onto a map's walls, shape (3,), [m, m, rad].

    Minimises sum w_i d(p_i)^2 / noise^2 + (shift / spread)^2, the weights w = 1 / (1 + (d/noise)^2)
    of the round before, by Gauss-Newton on the map's distance field.

    Args:
        grid: The map.
        pose: Where to begin, shape (3,), [m, m, rad].
        points: The scan in the body frame, shape (M, 2), [m].
        spread: Standard deviations of the pose to begin with, of the place [m] and heading [rad].
        noise: Distance of a point to its wall that is not unusual [m].
    """
    first = pose.copy()
    holds = np.diag(1.0 / np.array([spread[0], spread[0], spread[1]]) ** 2)
    around = 0.5 * grid.cell
    share = min(1.0, 100.0 / len(points))  # neighbouring beams err alike: all count as 100
    for _ in range(_ROUNDS):
        places = transform(pose, points)  # (M, 2)
        distance = grid.distance(places)
        near = distance < _NEAR - 1e-9
        if near.sum() < 10:
            return first
        places, distance = places[near], distance[near]
        slope = [
            (grid.distance(places + step) - grid.distance(places - step)) / (2.0 * around)
            for step in around * np.eye(2)
        ]
        arm = places - pose[:2]
        jacobian = np.column_stack([*slope, slope[1] * arm[:, 0] - slope[0] * arm[:, 1]])
        weight = share / (noise**2 + distance**2)
        shift = np.append(pose[:2] - first[:2], wrap(pose[2] - first[2]))
        gradient = jacobian.T @ (weight * distance) + holds @ shift
        step = np.linalg.solve((jacobian.T * weight) @ jacobian + holds, -gradient)
        pose = pose + step
        if np.abs(step).max() < 1e-5:
            break
    return np.asarray(pose)


@compiled
def add_rays(evidence: NDArray[np.int8], eye: Array, ends: Array) -> None:
    """Add the evidence of rays: what they pass is free, where they end is not.

    Args:
        evidence: Of each cell, changed in place.
        eye: Where the rays begin [cells].
        ends: Where they end, shape (M, 2), [cells].
    """
    for row in range(len(ends)):
        dx, dy = ends[row, 0] - eye[0], ends[row, 1] - eye[1]
        length = math.sqrt(dx * dx + dy * dy)
        if length == 0.0:
            continue
        last_x, last_y = -1, -1
        for k in range(int(length - 2.5) + 1):
            x = math.floor(eye[0] + dx * k / length)
            y = math.floor(eye[1] + dy * k / length)
            if (x, y) == (last_x, last_y):
                continue
            last_x, last_y = x, y
            if 0 <= x < evidence.shape[0] and 0 <= y < evidence.shape[1]:
                evidence[x, y] = max(evidence[x, y] + _MISS, -_MOST)
    for row in range(len(ends)):
        x, y = math.floor(ends[row, 0]), math.floor(ends[row, 1])
        if 0 <= x < evidence.shape[0] and 0 <= y < evidence.shape[1]:
            evidence[x, y] = min(evidence[x, y] + _HIT, _MOST)
