"""The cells of an obstacle map, and the window of the world they are."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..errors import InputError
from ..se2 import Array
from .map_cells import Cells, Origin, forget_lines, unknown_cells
from .map_options import MapOptions
from .surroundings import Cell

_ALL = (0.0, math.inf)


class MapMemory:
    """A square window of the world that moves in whole cells.

    Attributes:
        cells: What is known of each cell, as a ring.
        origin: World cell in the window's lower corner, shape (2,).
        cell: Edge of a cell [m].
        count: Number of cells along a side.
    """

    def __init__(self, options: MapOptions, place: Array) -> None:
        """Know nothing around a place of the world, shape (2,), [m]."""
        self.cell, self.count = options.cell, options.count
        self.cells: Cells = unknown_cells(
            self.count,
            np.array(options.bands, dtype=float),
            options.cell,
            options.hit,
            options.miss,
            options.most,
        )
        self.origin: Origin = self._corner(place)

    def follow(self, place: Array) -> None:
        """Move the middle to a place (2,) [m] within half a cell; forget what leaves the window."""
        corner = self._corner(place)
        moved = corner - self.origin
        if (np.abs(moved) >= self.count).any():
            self.forget()
        else:
            for axis in (0, 1):
                steps = int(moved[axis])
                first = self.origin[axis] if steps > 0 else corner[axis]
                if steps:
                    forget_lines(self.cells, int(first) % self.count, abs(steps), axis)
        self.origin = corner

    def forget(self) -> None:
        """Make every cell unknown."""
        forget_lines(self.cells, 0, self.count, 0)

    @property
    def extent(self) -> tuple[float, float, float, float]:
        """x_min, x_max, y_min, y_max of the window in the world [m]."""
        low = self.origin * self.cell
        high = low + self.count * self.cell
        return float(low[0]), float(high[0]), float(low[1]), float(high[1])

    def mask(self, heights: tuple[float, float]) -> np.uint32:
        """Return the bits of the bands that lie between two heights, in part is enough [m]."""
        low, high = heights
        edges = self.cells.edges
        bands = np.flatnonzero((edges[1:] > low) & (edges[:-1] < high))
        return np.uint32(sum(1 << int(band) for band in bands))

    def states(self, heights: tuple[float, float] = _ALL) -> NDArray[np.uint8]:
        """Return values of `Cell` seen from above, shape (n along world x, n along world y).

        Occupied: in one of the bands between the heights. Free: none is occupied and one is free.
        """
        mask = self.mask(heights)
        occupied = np.not_equal(self.cells.occupied & mask, 0)
        free = np.not_equal(self.cells.free & mask, 0)
        cells = np.where(occupied, Cell.OBSTACLE, np.where(free, Cell.FREE, Cell.UNKNOWN))
        return self._unrolled(cells.astype(np.uint8))

    def certainty(self, height: float) -> NDArray[np.int8]:
        """Return the certainty in the band that holds a height, shape (n, n).

        Raises:
            InputError: If no band holds it.
        """
        edges = self.cells.edges
        if not edges[0] <= height < edges[-1]:
            allowed = f"{edges[0]} to {edges[-1]} m"
            raise InputError("no band there", field="height", value=height, allowed=allowed)
        band = int(np.searchsorted(edges, height, side="right")) - 1
        return self._unrolled(self.cells.certainty[:, :, band])

    def are_free(self, places: Array, heights: tuple[float, float] = _ALL) -> NDArray[np.bool_]:
        """Return which places (N, 2) of the world [m] lie in free cells; outside none."""
        line = np.floor(places / self.cell) - self.origin
        inside = np.logical_and(line >= 0.0, line < self.count).all(axis=1)
        i, j = np.where(np.expand_dims(inside, 1), line, 0.0).astype(np.int64).T
        free: NDArray[np.bool_] = np.equal(self.states(heights)[i, j], Cell.FREE)
        return inside & free

    def _corner(self, place: Array) -> NDArray[np.int64]:
        return np.rint(place / self.cell).astype(np.int64) - self.count // 2

    def _unrolled(self, cells: NDArray[Any]) -> NDArray[Any]:
        """Return cells of the ring with the window's corner first."""
        i, j = (int(-corner % self.count) for corner in self.origin)
        return np.roll(cells, (i, j), axis=(0, 1))
