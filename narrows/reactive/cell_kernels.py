"""Convex figures and the cells of a grid they meet; compiled."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from ..se2 import Array
from .compiled import compiled

Levels = NDArray[np.uint8]


@compiled
def hull_in_place(points: Array, count: int, ring: Array) -> int:
    """Write the convex hull of the first `count` points into `ring`; return its corners.

    Andrew's monotone chain; the points are sorted in place. Counter-clockwise.
    """
    gap = 1
    while gap < count // 3:
        gap = 3 * gap + 1
    while gap > 0:
        for i in range(gap, count):
            x, y = points[i, 0], points[i, 1]
            j = i
            while j >= gap and (
                points[j - gap, 0] > x or (points[j - gap, 0] == x and points[j - gap, 1] > y)
            ):
                points[j, 0], points[j, 1] = points[j - gap, 0], points[j - gap, 1]
                j -= gap
            points[j, 0], points[j, 1] = x, y
        gap //= 3
    size = 0
    for i in range(count):
        size = _push(points[i, 0], points[i, 1], ring, size, 2)
    upper = size + 1
    for i in range(count - 2, -1, -1):
        size = _push(points[i, 0], points[i, 1], ring, size, upper)
    return max(size - 1, 1)  # the last point is the first again


@compiled
def _push(x: float, y: float, ring: Array, size: int, least: int) -> int:
    """Add a point to a chain that turns left, drop those it makes dents; return the new size."""
    while size >= least:
        ax, ay = ring[size - 2, 0], ring[size - 2, 1]
        bx, by = ring[size - 1, 0], ring[size - 1, 1]
        if (bx - ax) * (y - ay) - (by - ay) * (x - ax) > 0.0:
            break
        size -= 1
    ring[size, 0], ring[size, 1] = x, y
    return size + 1


@compiled
def row_spans(
    ring: Array, size: int, slack: float, lower: Array, cell: float, low: Array, high: Array
) -> tuple[int, int]:
    """Write, for every row of cells, the y-range in which a convex ring meets it.

    Exact: a cell of the row meets the ring if and only if it meets this range, because the part
    of a convex figure inside a row is convex. Grown by `slack` to all sides.

    Args:
        ring: Corners, shape (>= size, 2), [m].
        size: Number of corners.
        slack: Growth [m].
        lower: Corner of the grid [m], shape (2,).
        cell: Edge of a cell [m].
        low: Least y of each row, shape (rows,), filled between the returned rows.
        high: Greatest y likewise.

    Returns:
        First row met and one past the last.
    """
    rows = len(low)
    least, most = ring[0, 0], ring[0, 0]
    for i in range(1, size):
        least, most = min(least, ring[i, 0]), max(most, ring[i, 0])
    first = max(0, math.floor((least - slack - lower[0]) / cell))
    end = min(rows, math.floor((most + slack - lower[0]) / cell) + 1)
    for row in range(first, end):
        low[row], high[row] = math.inf, -math.inf
    for i in range(size):
        j = i + 1 if i + 1 < size else 0
        ax, ay, bx, by = ring[i, 0], ring[i, 1], ring[j, 0], ring[j, 1]
        if ax > bx:
            ax, ay, bx, by = bx, by, ax, ay
        slope = (by - ay) / (bx - ax) if bx > ax else 0.0
        from_row = max(first, math.floor((ax - slack - lower[0]) / cell))
        to_row = min(end, math.floor((bx + slack - lower[0]) / cell) + 1)
        for row in range(from_row, to_row):
            left = lower[0] + row * cell - slack
            a = min(max(ax, left), bx)
            b = max(min(bx, left + cell + 2.0 * slack), ax)
            ya, yb = ay + slope * (a - ax), by - slope * (bx - b)
            if bx == ax:
                ya, yb = ay, by
            low[row] = min(low[row], min(ya, yb) - slack)
            high[row] = max(high[row], max(ya, yb) + slack)
    return first, end


@compiled
def paint(
    plane: Levels, ring: Array, size: int, slack: float, lower: Array, cell: float, level: int
) -> None:
    """Give all cells a convex ring meets a level."""
    rows, columns = plane.shape
    low, high = np.empty(rows), np.empty(rows)
    first, end = row_spans(ring, size, slack, lower, cell, low, high)
    for row in range(first, end):
        start = max(0, math.floor((low[row] - lower[1]) / cell))
        stop = min(columns, math.floor((high[row] - lower[1]) / cell) + 1)
        plane[row, start:stop] = level
