"""The fast route for control: obstacles, drop-offs, free floor and the unknown from one frame.

The floor is found near where the mounting says it is (`narrows.perception.floor`); every pixel is
then judged by its height above it. The chain of [FuzzyDVZ, 3.2] instead removes the largest plane,
whatever that is (`narrows.perception.cloud`).
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..errors import InputError
from ..se2 import Array
from .camera import DepthCamera
from .depth_image import DepthFrame, depth_frame
from .floor import Floor, FloorPrior, find_floor
from .obstacle_kernels import connect, sort_pixels
from .surroundings import Cell, Grid, Obstacle, Sight, Surroundings, nothing_known


@dataclass(frozen=True)
class ObstacleOptions:
    """What counts as an obstacle.

    A pixel at depth z rises above the floor if it is higher than
    least_height + z (steps * step * camera height + slope): the quantisation of a floor pixel's
    depth z, in height, grows with z, and so does what the floor may lean or sag.

    Attributes:
        least_height: Height of the lowest obstacle, close by [m].
        steps: Steps of quantisation a floor pixel may be off.
        slope: What the floor may lean or sag by, a metre [-].
        top: Height of the chair with who sits in it; what is higher is no obstacle [m].
        free_pixels: Fewest floor pixels of a free cell.
        object_pixels: Fewest pixels of an obstacle or a drop-off; the cells of smaller ones are
            unknown.
        least_returns: Least share of the image with a return; below it the camera is blind.
    """

    least_height: float = 0.025
    steps: float = 2.5
    slope: float = 0.006
    top: float = 1.4
    free_pixels: int = 3
    object_pixels: int = 8
    least_returns: float = 0.005

    def __post_init__(self) -> None:
        """Refuse heights and shares that are not positive."""
        for name, value in vars(self).items():
            if not (math.isfinite(value) and value > 0.0):
                raise InputError("must be positive", field=name, value=value, allowed="> 0")
        if self.top <= self.least_height:
            raise InputError("below the lowest obstacle", field="top", value=self.top)


@dataclass(frozen=True)
class ObstacleFinder:
    """Finds what is around the chair in the frames of one depth camera.

    Attributes:
        camera: The camera and how it is meant to be mounted.
        grid: Cells of the floor.
        options: What counts as an obstacle.
        prior: How far the mounting may be off.
    """

    camera: DepthCamera
    grid: Grid = field(default_factory=Grid)
    options: ObstacleOptions = field(default_factory=ObstacleOptions)
    prior: FloorPrior = field(default_factory=FloorPrior)

    def see(self, depth: Any | None, time: float = 0.0) -> Surroundings:
        """Return what a frame shows.

        Args:
            depth: As `narrows.perception.depth_image.depth_frame` takes it; None if none came.
            time: When it was taken [s].

        Raises:
            ShapeError: If the image is not of the camera's size.
            InputError: If its values are of another type.
        """
        if depth is None:
            return nothing_known(self.grid, time, Sight.SILENT, "no frame")
        frame = depth_frame(depth, self.camera.intrinsics)
        returns = np.count_nonzero(frame.image) / frame.image.size
        if returns < self.options.least_returns:
            reason = f"{100.0 * returns:.1f} % of the image"
            return nothing_known(self.grid, time, Sight.BLIND, reason)
        floor = find_floor(frame, self.camera, self.prior)
        counts, boxes = self._sort(frame, floor)
        cells = np.where(counts[0] >= self.options.free_pixels, Cell.FREE, Cell.UNKNOWN)
        if not floor.is_seen:
            cells[:] = Cell.UNKNOWN
        drop_offs = self._mark(cells, counts[2], boxes[1], Cell.DROP)
        obstacles = self._mark(cells, counts[1], boxes[0], Cell.OBSTACLE)
        sight = Sight.SEEN if floor.is_seen else Sight.FLOOR_ASSUMED
        reason = f"{sight.value} ({floor.reason})"
        kept = cells.astype(np.uint8)
        return Surroundings(sight, reason, time, self.grid, kept, floor, obstacles, drop_offs)

    def thresholds(self, floor: Floor) -> Array:
        """Return the height of the lowest obstacle at no depth [m] and its growth with the depth.

        Shape (2,). Both are larger where the floor is only assumed.
        """
        base = self.options.least_height
        growth = self.options.steps * self.camera.step * floor.mounting.height + self.options.slope
        if floor.is_seen:
            return np.array([base, growth])
        slope = math.tan(self.prior.angle_tolerance)
        return np.array([base + self.prior.height_tolerance, growth + slope])

    def _sort(self, frame: DepthFrame, floor: Floor) -> tuple[NDArray[np.int32], Array]:
        """Return pixels per cell (3, columns, rows) and boxes (2, columns, rows, 10)."""
        lens, grid, chosen = self.camera.intrinsics, self.grid, self.options
        mounting = floor.mounting
        geometry = np.array([lens.fx, lens.fy, lens.cx, lens.cy])
        pose = np.column_stack([mounting.camera_to_body, mounting.position])
        limits = np.array([*self.thresholds(floor), chosen.top, self.camera.furthest])
        area = np.array([grid.x_from, grid.y_from, grid.cell])
        result: tuple[NDArray[np.int32], Array] = sort_pixels(
            frame.image, frame.per_metre, geometry, pose, limits, area, *grid.shape
        )
        return result

    def _mark(
        self, cells: NDArray[np.int64], count: NDArray[np.int32], boxes: Array, kind: Cell
    ) -> tuple[Obstacle, ...]:
        """Mark the cells of connected obstacles, and return them, the nearest first."""
        label, rows = connect(count, boxes, self.options.object_pixels)
        cells[label > 0] = kind
        cells[label < 0] = Cell.UNKNOWN  # too few pixels to be something, too many to be nothing
        rows = rows[np.argsort(np.hypot(rows[:, 6], rows[:, 7]), kind="stable")]
        return tuple(Obstacle(row[:3], row[3:6], row[6:9], int(row[9])) for row in rows)
