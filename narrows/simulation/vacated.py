"""Forgets what stood on the floor and has left it, where the camera that saw it cannot look again.

A depth camera sees a narrow field; what leaves it stays in the map, so that nothing is forgotten
that is still there. But somebody who stood there and walked on stays too, from the scanners' height
upwards, and bars the way for ever. Scanners see the floor all around: what stood in their band of
heights when the camera saw it, and does so no more, has gone. What hangs, so that the floor below
it was free while it was seen, is never forgotten so; nor is a table top, whose legs still stand.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import uniform_filter

from ..interfaces import Percept
from ..perception.camera import DepthCamera
from ..perception.obstacle_map import ObstacleMap
from ..se2 import Array, invert, transform
from .chair_senses import ChairSenses

_RING = 512  # cells across, a power of 2
_NEAR = (0.05, 0.15)  # m: a thing stands that near below what is seen of it; nearer by a wall
_LEFT = 0.5  # a smaller share of what stood there, seen by the scanners, is another thing
_LEAST = 4  # cells: fewer come and go by the scanners' noise, such as those of a table leg
_HANGS = 0.5  # s seen above a free floor: it hangs
_SAME = 0.06  # m: a return that near in depth is of the thing itself
_LONGEST = 1.0  # s: a frame is on its way no longer


class Vacated:
    """Senses that leave out what has gone; what they remember themselves is not changed."""

    def __init__(
        self, senses: ChairSenses, camera: DepthCamera, band: tuple[float, float], name: str
    ) -> None:
        """Watch senses that have scanners and a camera.

        Args:
            senses: The senses.
            camera: What sees above and below the scanners' band.
            band: Heights of the band of the map in which the scanners look [m].
            name: The camera's, among the sensors.
        """
        self._senses, self._camera, self._band, self._name = senses, camera, band, name
        self._cell = senses.map.options.cell
        self._places = np.zeros((_RING, _RING, 2), dtype=np.int64)
        self._known_at = np.full((_RING, _RING), -math.inf)
        self._is_seen = np.zeros((_RING, _RING), dtype=bool)  # in the frame that came last
        self._stood = np.zeros((len(_NEAR), _RING, _RING))  # what `_standing` was when it was seen
        self._hung = np.zeros((_RING, _RING))  # s
        self._poses: dict[float, Array] = {}  # believed, by time
        self._frame_time = self._time = -math.inf

    @property
    def map(self) -> ObstacleMap:
        """What is known around the chair, what has gone included."""
        return self._senses.map

    @property
    def answers(self) -> Mapping[str, Any]:
        """The answer of each sensor that was entered last, by its name."""
        return self._senses.answers

    def perceive(self, time: float, true_pose: Array, believed_pose: Array) -> Percept:
        """Return what is perceived, without what has gone."""
        percept = self._senses.perceive(time, true_pose, believed_pose)
        self._poses = {at: pose for at, pose in self._poses.items() if at > time - _LONGEST}
        self._poses[time] = np.array(believed_pose)
        points = percept.points
        above = np.flatnonzero((points[:, 2] < self._band[0]) | (points[:, 2] >= self._band[1]))
        if not len(above):
            return percept
        world = transform(believed_pose, points[:, :2])
        cells = np.floor(world / self._cell + 1e-6).astype(np.int64)
        standing = self._standing(cells, above)
        i, j = (cells[above] & (_RING - 1)).T
        new = self._take_over(cells[above], i, j, time)
        self._raise(i[new], j[new], standing[:, new])
        self._look(np.column_stack([world, points[:, 2]])[above], i, j, standing)
        gone = self._has_gone(standing, i, j) & ~self._is_seen[i, j]
        gone[gone] = self._senses.map.is_free(points[above[gone], :2], self._band)
        kept = np.delete(points, above[gone], axis=0)
        return Percept(percept.time, kept, percept.spread, percept.unknown)

    def _look(
        self,
        places: Array,
        i: NDArray[np.int64],
        j: NDArray[np.int64],
        standing: Array,
    ) -> None:
        """Note what a new frame shows of places (N, 3) in the world, and what stands there."""
        answer = self._senses.answers.get(self._name)
        if answer is None or answer.seen.time <= self._frame_time:
            return
        passed = min(answer.seen.time - self._frame_time, _LONGEST)
        self._frame_time = answer.seen.time
        pose = self._poses.get(self._frame_time)
        self._is_seen[:] = False
        if pose is None:
            return
        back = invert(pose)
        body = np.column_stack([transform(back, places[:, :2]), places[:, 2]])
        seen = self._are_returns(answer.image, body)
        self._is_seen[i[seen], j[seen]] = True
        self._raise(i[seen], j[seen], standing[:, seen])
        gone = self._has_gone(standing, i, j)
        self._hung[i[~gone], j[~gone]] = 0.0
        hangs = np.unique(np.column_stack([i, j])[seen & gone], axis=0).T
        self._hung[hangs[0], hangs[1]] += passed
        self._stood[:, self._hung >= _HANGS] = 0.0

    def _raise(self, i: NDArray[np.int64], j: NDArray[np.int64], standing: Array) -> None:
        for stood, now in zip(self._stood, standing, strict=True):
            np.maximum.at(stood, (i, j), now)

    def _has_gone(
        self, standing: Array, i: NDArray[np.int64], j: NDArray[np.int64]
    ) -> NDArray[np.bool_]:
        """Return below which cells less stands than when they were seen."""
        stood = self._stood[:, i, j]
        return np.asarray(((stood >= _LEAST) & (standing < _LEFT * stood)).any(axis=0))

    def _are_returns(self, image: NDArray[np.uint16], points: Array) -> NDArray[np.bool_]:
        """Return which points (N, 3) of the body frame a depth image has a return of."""
        lens = self._camera.intrinsics
        x, y, depth = self._camera.mounting.to_camera(points).T
        away = np.maximum(depth, 1e-3)
        column = np.round(lens.fx * x / away + lens.cx).astype(np.int64)
        row = np.round(lens.fy * y / away + lens.cy).astype(np.int64)
        inside = (column >= 0) & (column < lens.width) & (row >= 0) & (row < lens.height)
        inside &= depth > _SAME
        found = np.zeros(len(points), dtype=bool)
        returned = 1e-3 * image[row[inside], column[inside]]
        found[inside] = np.abs(returned - depth[inside]) < _SAME
        return found

    def _standing(self, cells: NDArray[np.int64], above: NDArray[np.int64]) -> Array:
        """Return how many cells of the scanners' band are occupied about N points, by `_NEAR`."""
        reaches = [math.ceil(near / self._cell) for near in _NEAR]
        low = cells.min(axis=0) - reaches[-1]
        grid = np.zeros(cells.max(axis=0) - low + 1 + reaches[-1])
        band = np.delete(cells, above, axis=0) - low
        grid[band[:, 0], band[:, 1]] = 1.0
        i, j = (cells[above] - low).T
        return np.array(
            [
                np.round((2 * r + 1) ** 2 * uniform_filter(grid, 2 * r + 1, mode="constant")[i, j])
                for r in reaches
            ]
        )

    def _take_over(
        self, cells: NDArray[np.int64], i: NDArray[np.int64], j: NDArray[np.int64], time: float
    ) -> NDArray[np.bool_]:
        """Return in which cells there was nothing a look before; forget what had been there."""
        new = (self._places[i, j] != cells).any(axis=1) | (self._known_at[i, j] < self._time)
        self._known_at[i, j], self._time = time, time
        i, j = i[new], j[new]
        self._places[i, j] = cells[new]
        self._is_seen[i, j], self._stood[:, i, j], self._hung[i, j] = False, 0.0, 0.0
        return np.asarray(new)
