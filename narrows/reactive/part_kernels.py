"""Which part of a moving body meets a cell first; compiled."""

from __future__ import annotations

import math

import numpy as np

from ..se2 import Array
from .cell_kernels import Levels, row_spans
from .compiled import compiled


@compiled
def paint_parts(
    parts: Levels, poses: Array, body: Array, lower: Array, cell: float, scratch: Array
) -> None:
    """Give all cells a moving body meets the part of the body that meets them first.

    Args:
        parts: Codes as in `narrows.reactive.side_tables.PARTS`, shape (rows, columns).
        poses: Poses of the body in order, shape (P, 3).
        body: Corners, counter-clockwise, shape (K, 2), [m].
        lower: Corner of the grid [m], shape (2,).
        cell: Edge of a cell [m].
        scratch: Shape (K, 2).
    """
    rows, columns = parts.shape
    low, high = np.empty(rows), np.empty(rows)
    for i in range(len(poses) - 1, -1, -1):  # the earliest pose paints last
        x, y, heading = poses[i]
        cosine, sine = math.cos(heading), math.sin(heading)
        for k in range(len(body)):
            scratch[k, 0] = x + cosine * body[k, 0] - sine * body[k, 1]
            scratch[k, 1] = y + sine * body[k, 0] + cosine * body[k, 1]
        first, end = row_spans(scratch, len(body), 0.0, lower, cell, low, high)
        for row in range(first, end):
            start = max(0, math.floor((low[row] - lower[1]) / cell))
            stop = min(columns, math.floor((high[row] - lower[1]) / cell) + 1)
            for column in range(start, stop):
                dx = lower[0] + (row + 0.5) * cell - x
                dy = lower[1] + (column + 0.5) * cell - y
                parts[row, column] = part_met(
                    body, cosine * dx + sine * dy, cosine * dy - sine * dx
                )


@compiled
def part_met(body: Array, x: float, y: float) -> int:
    """Return which part of a body a point in its frame is nearest to, by the edge it is beyond.

    Front 0, 1; side ahead of the axle 2, 3; side behind it 4, 5; rear 6, 7: the even ones left.
    """
    best, normal_x, normal_y = -math.inf, 0.0, 0.0
    for k in range(len(body)):
        j = k + 1 if k + 1 < len(body) else 0
        ex, ey = body[j, 0] - body[k, 0], body[j, 1] - body[k, 1]
        length = math.hypot(ex, ey)
        nx, ny = ey / length, -ex / length
        distance = nx * (x - body[k, 0]) + ny * (y - body[k, 1])
        if distance > best:
            best, normal_x, normal_y = distance, nx, ny
    right = 1 if y < 0.0 else 0
    if abs(normal_x) >= abs(normal_y):
        return right if normal_x > 0.0 else 6 + right
    return (2 if x >= 0.0 else 4) + right
