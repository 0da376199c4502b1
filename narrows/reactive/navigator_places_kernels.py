"""The compiled loop over places: since when each has been occupied.

Imported when first needed, compiled on the first call, kept on disk.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from ..se2 import Array
from .zone_kernels import compiled


@compiled
def watch_cells(
    places: Array,
    now: float,
    cell: float,
    gone: float,
    long: float,
    index: NDArray[np.int64],
    since: Array,
    seen: Array,
) -> Array:
    """Update a ring of cells by what is seen now, and return since when each place is occupied.

    Args:
        places: Points over the floor in the world, shape (N, 2), [m].
        now: Time [s].
        cell: Edge of a cell [m].
        gone: A place not seen occupied for longer is empty [s].
        long: A place occupied for longer needs no look about it [s].
        index: World index of each cell, shape (R, R, 2), R a power of 2.
        since: Since when it is occupied [s], shape (R, R).
        seen: When it was last seen occupied [s], shape (R, R).

    Returns:
        Shape (N,), [s]; of a place and the eight about it, the one occupied for longest: points on
        the edge of a cell are seen in one and in the other.
    """
    mask = len(since) - 1
    cells = np.empty((len(places), 2), dtype=np.int64)
    for n in range(len(places)):
        i, j = math.floor(places[n, 0] / cell), math.floor(places[n, 1] / cell)
        cells[n, 0], cells[n, 1] = i, j
        row, column = i & mask, j & mask
        stranger = index[row, column, 0] != i or index[row, column, 1] != j
        if stranger or seen[row, column] < now - gone:
            index[row, column, 0], index[row, column, 1] = i, j
            since[row, column] = now
        seen[row, column] = now
    found = np.empty(len(places))
    for n in range(len(places)):
        found[n] = since[cells[n, 0] & mask, cells[n, 1] & mask]
        if now - found[n] >= long:
            continue
        for i in range(cells[n, 0] - 1, cells[n, 0] + 2):
            row = i & mask
            for j in range(cells[n, 1] - 1, cells[n, 1] + 2):
                column = j & mask
                older = since[row, column] < found[n] and seen[row, column] >= now - gone
                if older and index[row, column, 0] == i and index[row, column, 1] == j:
                    found[n] = since[row, column]
    return found
