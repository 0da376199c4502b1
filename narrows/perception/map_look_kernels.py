"""The compiled loops that read the obstacle map, and that note where the chair itself stands."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from ..se2 import Array
from .compiled import compiled
from .map_cells import Cells, Origin, judge, line_beside


@compiled
def stand_on(
    cells: Cells,
    origin: Origin,
    pose: Array,
    normals: Array,
    offsets: Array,
    bands: NDArray[np.bool_],
    reach: float,
    deep: float,
) -> None:
    """Note that the chair stands where it stands: nothing else does.

    Unknown cells under the body become free; occupied ones only deep in it, where no error of the
    pose can have put the wall beside it.

    Args:
        cells: The map's memory.
        origin: World cell in the window's corner.
        pose: Of the chair.
        normals: Outward normals of the body's sides, body frame, shape (E, 2).
        offsets: Of the sides along them, shape (E,), [m].
        bands: Which bands the body is in, shape (K,).
        reach: Distance of the body's furthest point from its origin [m].
        deep: How deep in the body nothing else can be [m].
    """
    size, cell = cells.occupied.shape[0], cells.cell
    cos, sin = math.cos(pose[2]), math.sin(pose[2])
    i_from = max(np.int64(math.floor((pose[0] - reach) / cell)), origin[0])
    j_from = max(np.int64(math.floor((pose[1] - reach) / cell)), origin[1])
    i_to = min(np.int64(math.floor((pose[0] + reach) / cell)) + 1, origin[0] + size)
    j_to = min(np.int64(math.floor((pose[1] + reach) / cell)) + 1, origin[1] + size)
    for i in range(i_from, i_to):
        for j in range(j_from, j_to):
            x, y = (i + 0.5) * cell - pose[0], (j + 0.5) * cell - pose[1]
            ahead, left = cos * x + sin * y, cos * y - sin * x
            depth = np.inf
            for side in range(len(offsets)):
                inside = offsets[side] - normals[side, 0] * ahead - normals[side, 1] * left
                depth = min(depth, inside)
            if depth < 0.0:
                continue
            a, b = i % size, j % size
            for band in range(len(bands)):
                value = np.int64(cells.certainty[a, b, band])
                if bands[band] and value >= 0 and (value < cells.hit or depth >= deep):
                    judge(cells, a, b, band, -1)


@compiled
def look_around(
    cells: Cells, origin: Origin, pose: Array, reach: float, mask: np.uint32
) -> tuple[Array, Array]:
    """Return occupied cells (N, 3) and the unknown ones beside free ones (M, 2), body frame.

    Args:
        cells: The map's memory.
        origin: World cell in the window's corner.
        pose: Of the chair.
        reach: Distance from its origin up to which cells are looked at [m].
        mask: Bits of the bands asked for.
    """
    cell, occupied, free = cells.cell, cells.occupied, cells.free
    heights = 0.5 * (cells.edges[1:] + cells.edges[:-1])
    size = occupied.shape[0]
    cos, sin = math.cos(pose[2]), math.sin(pose[2])
    points, unknown = np.empty((1024, 3)), np.empty((1024, 2))
    found = edge = 0
    i_from = max(math.floor((pose[0] - reach) / cell), origin[0])
    j_from = max(math.floor((pose[1] - reach) / cell), origin[1])
    i_to = min(math.floor((pose[0] + reach) / cell) + 1, origin[0] + size)
    j_to = min(math.floor((pose[1] + reach) / cell) + 1, origin[1] + size)
    for i in range(i_from, i_to):
        a, b = i % size, line_beside(j_from % size, -1, size)
        line, up, down = free[a], free[line_beside(a, 1, size)], free[line_beside(a, -1, size)]
        here = line[b]
        for j in range(j_from, j_to):
            b = line_beside(b, 1, size)
            last, here, coming = here, line[b], line[line_beside(b, 1, size)]
            bits = occupied[a, b] & mask
            # At the window's border the ring joins what is apart: a border cell more, no less.
            near = (last | coming | up[b] | down[b]) & mask
            if bits == 0 and ((here & mask) != 0 or near == 0):
                continue
            x, y = (i + 0.5) * cell - pose[0], (j + 0.5) * cell - pose[1]
            if x * x + y * y > reach * reach:
                continue
            ahead, left = cos * x + sin * y, cos * y - sin * x
            if bits == 0:
                if edge == len(unknown):
                    unknown = np.concatenate((unknown, np.empty_like(unknown)))
                unknown[edge, 0], unknown[edge, 1] = ahead, left
                edge += 1
                continue
            band = 0
            while bits != 0:
                if bits & np.uint32(1):
                    if found == len(points):
                        points = np.concatenate((points, np.empty_like(points)))
                    points[found, 0], points[found, 1] = ahead, left
                    points[found, 2] = heights[band]
                    found += 1
                bits >>= np.uint32(1)
                band += 1
    return points[:found].copy(), unknown[:edge].copy()
