"""Which points belong to solids that were planned for."""

from __future__ import annotations

import math

import numpy as np
import shapely
from numpy.typing import ArrayLike, NDArray

from ..se2 import Array
from ..world import World

_CELL = 0.05  # m: places are looked up by cells
_MOST = 4_000_000  # cells: of a larger world every cell is larger


class KnownSolids:
    """Tells the solids of a world from what is new, by where a point is seen from above.

    A cell of the floor is known if its middle is within the tolerance of a solid, half the cell's
    diagonal added; each is looked up once.

    Attributes:
        tolerance: How far from a solid its points may be seen [m].
    """

    def __init__(self, world: World, *, tolerance: float = 0.05) -> None:
        """Know the solids of a world that stand still.

        Args:
            world: What was planned for.
            tolerance: How far from a solid its points may be seen [m].
        """
        self.tolerance = tolerance
        grown = [solid.shape.buffer(solid.radius) for solid in world.solids]
        self._union = shapely.union_all(grown)
        shapely.prepare(self._union)
        low, high = np.zeros(2), np.zeros(2)
        if grown:
            bounds = np.array(self._union.bounds)
            low, high = bounds[:2] - 1.0, bounds[2:] + 1.0
        self._low = low
        area = float(np.prod(high - low))
        self._cell = max(_CELL, math.sqrt(area / _MOST))
        shape = np.maximum(np.ceil((high - low) / self._cell), 1).astype(int)
        self._known = np.full(shape, -1, dtype=np.int8)

    def __call__(self, points: ArrayLike) -> NDArray[np.bool_]:
        """Return which points (N, 2) or (N, 3) of the world frame are known, shape (N,)."""
        rows: Array = np.asarray(points, dtype=float)[:, :2]
        place = np.floor((rows - self._low) / self._cell).astype(int)
        inside = ((place >= 0) & (place < self._known.shape)).all(axis=1)
        i, j = np.where(inside[:, None], place, 0).T
        asked = np.unique(np.column_stack([i, j])[inside & (self._known[i, j] < 0)], axis=0)
        if len(asked):
            middle = self._low + (asked + 0.5) * self._cell
            reach = self.tolerance + self._cell / math.sqrt(2.0)
            near = shapely.dwithin(shapely.points(middle), self._union, reach)
            self._known[asked[:, 0], asked[:, 1]] = near
        found: NDArray[np.bool_] = inside & np.greater(self._known[i, j], 0)
        return found
