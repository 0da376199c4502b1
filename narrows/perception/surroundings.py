"""What a sensor has shown of the floor around the chair: obstacles, drop-offs, free, unknown.

Unknown is the state of every place of which nothing has been seen. It is never free: neither
where the view is blocked, nor where a surface sends nothing back, nor when a sensor is silent.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from enum import Enum, IntEnum

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..errors import InputError, ShapeError
from ..se2 import Array
from .floor import Floor


class Sight(Enum):
    """What a frame was good for."""

    SEEN = "the floor is seen"
    FLOOR_ASSUMED = "the floor is not seen where it should be: obstacles only, nothing is free"
    BLIND = "hardly a return: nothing is known"
    SILENT = "no frame, or one too old: nothing is known"


class Cell(IntEnum):
    """What is known of a cell of the floor."""

    UNKNOWN = 0
    FREE = 1
    OBSTACLE = 2
    DROP = 3


@dataclass(frozen=True)
class Grid:
    """Square cells on the floor, in the body frame.

    Attributes:
        x_from: Edge behind [m].
        x_to: Edge ahead [m].
        y_from: Edge on the right [m].
        y_to: Edge on the left [m].
        cell: Edge of a cell [m].
    """

    x_from: float = 0.0
    x_to: float = 4.0
    y_from: float = -2.0
    y_to: float = 2.0
    cell: float = 0.05

    def __post_init__(self) -> None:
        """Refuse a grid without cells and one with millions."""
        if not all(math.isfinite(value) for value in vars(self).values()):
            raise InputError("a grid has finite edges", value=vars(self))
        if not (self.x_from < self.x_to and self.y_from < self.y_to and self.cell > 0.0):
            raise InputError("a grid without area", value=vars(self), allowed="from < to, cell > 0")
        if (self.x_to - self.x_from) * (self.y_to - self.y_from) > 1e6 * self.cell**2:
            raise InputError("too many cells", value=vars(self), allowed="a million")

    @property
    def shape(self) -> tuple[int, int]:
        """Number of cells along x and along y."""
        spans = (self.x_to - self.x_from, self.y_to - self.y_from)
        columns, rows = (max(1, math.ceil(span / self.cell - 1e-9)) for span in spans)
        return columns, rows

    def index(self, points: ArrayLike) -> tuple[NDArray[np.int64], NDArray[np.bool_]]:
        """Return the cells (N, 2) of points (N, 2), and which of them are in the grid (N,).

        Raises:
            ShapeError: If the points are not (N, 2).
        """
        rows = np.asarray(points, dtype=float)
        if rows.ndim != 2 or rows.shape[1] != 2:
            raise ShapeError(f"points on the floor must be (N, 2), got {rows.shape}")
        place = np.floor((rows - [self.x_from, self.y_from]) / self.cell)
        columns, rows_across = self.shape
        i, j = place[:, 0], place[:, 1]
        inside = (i >= 0.0) & (i < columns) & (j >= 0.0) & (j < rows_across)
        cells = np.where(inside[:, None], place, 0.0).astype(np.int64)
        return cells, inside

    def spots(self, chosen: NDArray[np.bool_], spacing: float) -> Array:
        """Return points that fill the chosen cells, shape (N, 2), [m].

        Args:
            chosen: Which cells, shape (columns, rows).
            spacing: Greatest distance between neighbouring points along an axis [m].
        """
        count = max(1, math.ceil(self.cell / spacing))
        share = (np.arange(count) + 0.5) / count
        inner = np.stack(np.meshgrid(share, share), axis=-1).reshape(1, -1, 2)
        place = np.argwhere(chosen)[:, None] + inner
        return np.asarray(place.reshape(-1, 2) * self.cell + [self.x_from, self.y_from])


@dataclass(frozen=True, eq=False)
class Obstacle:
    """Something connected that the chair must not meet: it rises from the floor, or falls from it.

    Attributes:
        low: Lower corner of its box, body frame, z from the floor, shape (3,), [m].
        high: Upper corner, shape (3,), [m].
        nearest: Its point nearest to the body's origin as seen from above, shape (3,), [m].
        pixels: Number of pixels it was seen in.
    """

    low: Array
    high: Array
    nearest: Array
    pixels: int

    @property
    def distance(self) -> float:
        """Distance of its nearest point from the body's origin, seen from above [m]."""
        return float(np.hypot(self.nearest[0], self.nearest[1]))


@dataclass(frozen=True, eq=False)
class Surroundings:
    """What is known from one frame.

    Attributes:
        sight: What the frame was good for.
        reason: The same in words, with what is wrong.
        time: When the frame was taken [s].
        grid: The cells.
        cells: Values of `Cell`, shape (columns along x, rows along y), read-only.
        floor: The floor found or assumed; None without a return.
        obstacles: What rises above the floor, the nearest first.
        drop_offs: Where the floor is missing and the view goes below it, the nearest first: boxes
            on the floor where it should be, z how far below it the returns are.
    """

    sight: Sight
    reason: str
    time: float
    grid: Grid
    cells: NDArray[np.uint8]
    floor: Floor | None = None
    obstacles: tuple[Obstacle, ...] = ()
    drop_offs: tuple[Obstacle, ...] = ()

    def __post_init__(self) -> None:
        """Keep the cells as they are."""
        self.cells.setflags(write=False)

    def is_free(self, points: ArrayLike) -> NDArray[np.bool_]:
        """Return which points (N, 2) of the body frame lie on floor that was seen and is free.

        Outside the grid nothing is. Free says that floor was seen and nothing on it, nothing of
        what may hang above the height that is looked at.
        """
        cells, inside = self.grid.index(points)
        state = self.cells[cells[:, 0], cells[:, 1]]
        result: NDArray[np.bool_] = inside & (state == Cell.FREE)
        return result

    def at(self, now: float, *, most_age: float = 0.2) -> Surroundings:
        """Return what of this is still known at a time: all of it, or nothing if it is too old.

        Args:
            now: Time on the frame's clock [s]; not a number or before the frame: nothing is known.
            most_age: Age a frame may have [s].
        """
        if 0.0 <= now - self.time <= most_age:
            return self
        reason = f"the last frame is {now - self.time:.2f} s old"
        return nothing_known(self.grid, self.time, Sight.SILENT, reason)


def nothing_known(grid: Grid, time: float, sight: Sight, reason: str) -> Surroundings:
    """Return surroundings of which every cell is unknown."""
    cells = np.full(grid.shape, Cell.UNKNOWN, dtype=np.uint8)
    return Surroundings(sight, f"{sight.value} ({reason})", time, grid, cells)
