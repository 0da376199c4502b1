"""Occupancy grid maps of ROS, as map_server reads and writes them, as worlds of solids."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import shapely

from ..errors import SceneError
from ..se2 import Array
from ..world import Solid, World
from .cells import Mask, raggedness, regions
from .occupancy_image import Occupancy, read_occupancy
from .settings import Settings, read_settings

MOST_BORDERS = 300_000  # a few seconds; the most ragged office map at hand has 73,000
_TURNED = 1e-6  # m: a corner nearer to the box's corner is there but for rounding


def read_ros_map(file: Path, *, unknown_is_occupied: bool = True) -> World:
    """Read a map_server map: the solids cover exactly the occupied cells, and unknown ones.

    Each connected region of occupied cells is a solid named `wall`, of unknown cells `unknown`,
    from floor to ceiling, with the rectangles that tile it for parts. Nothing may leave the map:
    the world's bounds are its rectangle; where that is turned, they are the box around it, and
    solids named `outside the map` fill the box's corners.

    Modes `trinary` and `scale` are read. Cells between the thresholds count as unknown in both,
    as nothing proves them free. `raw` is refused: what its values mean is not in the file.

    Args:
        file: The YAML file; the picture it names is relative to its folder.
        unknown_is_occupied: Whether unknown cells are solid; else they are free, at the risk of
            whoever says so.

    Raises:
        SceneError: If the map cannot be used; says where and why.
    """
    settings = read_settings(file)
    occupancy = _read_picture(settings)
    grid = _Grid(settings.resolution, settings.origin)
    solids = list(_solids(occupancy.occupied, grid, "wall"))
    if unknown_is_occupied:
        solids += _solids(occupancy.unknown, grid, "unknown")
    rows, columns = occupancy.occupied.shape
    corners = grid.to_world(np.array([[0, 0], [columns, 0], [columns, rows], [0, rows]]))
    low, high = corners.min(axis=0), corners.max(axis=0)
    solids += _frame(corners, low, high)
    return World(tuple(solids), (float(low[0]), float(low[1]), float(high[0]), float(high[1])))


@dataclass(frozen=True)
class _Grid:
    """Where a map's cells lie in the world.

    Attributes:
        resolution: Side of a cell [m].
        origin: Pose of the lower left corner of the lower left cell [m, m, rad].
    """

    resolution: float
    origin: tuple[float, float, float]

    def to_world(self, points: Array) -> Array:
        """Return grid points (..., 2), counted in cells, as points of the world [m].

        The same grid point always gives the same numbers, so neighbours leave no gap.
        """
        x, y, yaw = self.origin
        along = points[..., 0] * self.resolution
        across = points[..., 1] * self.resolution
        cosine, sine = math.cos(yaw), math.sin(yaw)
        turned = [cosine * along - sine * across, sine * along + cosine * across]
        return np.stack([x + turned[0], y + turned[1]], axis=-1)


def _read_picture(settings: Settings) -> Occupancy:
    """Return what the map's picture says; refuse noise that would be solids without number."""
    occupancy = read_occupancy(
        settings.image,
        negate=settings.negate,
        occupied_threshold=settings.occupied_threshold,
        free_threshold=settings.free_threshold,
        transparent_is_unknown=settings.mode == "scale",
    )
    borders = sum(raggedness(cells) for cells in occupancy)
    if borders > MOST_BORDERS:
        raise SceneError(
            "the picture is noise, not walls",
            file=str(settings.image),
            field="image",
            value=f"{borders} changes along its rows",
            allowed=f"at most {MOST_BORDERS}",
        )
    return occupancy


def _solids(cells: Mask, grid: _Grid, name: str) -> Iterator[Solid]:
    """Yield one solid for each connected region of cells."""
    found = regions(cells)
    outlines = shapely.transform(found.outlines, grid.to_world)
    x_low, y_low, x_high, y_high = found.rectangles.T
    corners = np.stack([x_low, y_low, x_high, y_low, x_high, y_high, x_low, y_high], axis=1)
    parts = grid.to_world(corners.reshape(-1, 4, 2))  # (R, 4, 2)
    parts.setflags(write=False)
    ends = np.searchsorted(found.owner, np.arange(len(outlines) + 1))
    for k, outline in enumerate(outlines):
        yield Solid(outline, name=name, parts=tuple(parts[ends[k] : ends[k + 1]]))


def _frame(corners: Array, low: Array, high: Array) -> Iterator[Solid]:
    """Yield the triangles between the map's turned rectangle and the box around it.

    Args:
        corners: Corners of the map's rectangle counter-clockwise, shape (4, 2), [m].
        low: Lower left corner of the box [m].
        high: Upper right corner of the box [m].
    """
    box = np.array([low, [high[0], low[1]], high, [low[0], high[1]]])
    touching = np.roll(
        corners, -int(corners[:, 1].argmin()), axis=0
    )  # the box's lower, right, upper and left side
    for k in range(4):
        triangle = np.array([touching[k], box[(k + 1) % 4], touching[(k + 1) % 4]])
        legs = np.linalg.norm(np.diff(triangle, axis=0), axis=1)
        if legs.min() > _TURNED:
            yield Solid(shapely.Polygon(triangle), name="outside the map", parts=(triangle,))
