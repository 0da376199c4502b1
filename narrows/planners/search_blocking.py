"""Which cells of a grid are too near to a solid for a disc, compiled."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from ..se2 import Array
from .compiled import compiled
from .search_collision import Solids


@compiled
def distance_to(piece: Array, count: int, x: float, y: float) -> float:
    """Return the distance of a point to a convex piece, 0 inside, [m].

    Args:
        piece: Corners and outward edge normals, shape (K, 4), [m].
        count: Number of different corners.
        x: The point [m].
        y: The same.
    """
    best, beyond = math.inf, -math.inf
    for i in range(count):
        k = i + 1 if i + 1 < count else 0
        dx, dy = x - piece[i, 0], y - piece[i, 1]
        ex, ey = piece[k, 0] - piece[i, 0], piece[k, 1] - piece[i, 1]
        squared = ex * ex + ey * ey
        if squared > 0.0:
            t = min(max((dx * ex + dy * ey) / squared, 0.0), 1.0)
            best = min(best, (dx - t * ex) ** 2 + (dy - t * ey) ** 2)
        else:
            best = min(best, dx * dx + dy * dy)
        beyond = max(beyond, dx * piece[i, 2] + dy * piece[i, 3])
    return 0.0 if count > 2 and beyond <= 0.0 else math.sqrt(best)


@compiled
def block(
    solids: Solids, room: Array, origin: Array, cell: float, blocked: NDArray[np.bool_]
) -> None:
    """Mark the cells whose centre is within `room` of a solid.

    Args:
        solids: The solids.
        room: Distance for each layer, shape (L,), [m]; layers with none block nothing.
        origin: Lower corner of the grid, shape (2,), [m].
        cell: Size of its cells [m].
        blocked: Written to, shape (columns, rows).
    """
    columns, rows = blocked.shape
    for k in range(len(solids.sides)):
        reach = room[solids.layer[k]]
        if reach <= 0.0:
            continue
        first = max(math.floor((solids.box[k, 0] - reach - origin[0]) / cell), 0)
        last = min(math.ceil((solids.box[k, 2] + reach - origin[0]) / cell), columns)
        low = max(math.floor((solids.box[k, 1] - reach - origin[1]) / cell), 0)
        high = min(math.ceil((solids.box[k, 3] + reach - origin[1]) / cell), rows)
        for i in range(first, last):
            for j in range(low, high):
                if blocked[i, j]:
                    continue
                x, y = origin[0] + cell * (i + 0.5), origin[1] + cell * (j + 0.5)
                away = distance_to(solids.pieces[k], solids.sides[k], x, y)
                blocked[i, j] = away < reach + solids.radius[k]
