"""The compiled loops of the fast route: pixels into cells of the floor, cells into obstacles."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from ..se2 import Array
from .compiled import compiled
from .depth_kernels import Image

_FLOOR, _RISE, _DROP = 0, 1, 2
# Where a box's figures stand in its row; last the square of the
# nearest point's distance, for a cell, or the number of pixels, for an obstacle.
_BELOW, _ABOVE, _NEAREST, _PIXELS = 0, 3, 6, 9


@compiled
def sort_pixels(
    image: Image,
    per_metre: np.float32,
    lens: Array,
    pose: Array,
    limits: Array,
    area: Array,
    columns: int,
    rows: int,
) -> tuple[NDArray[np.int32], Array]:
    """Judge every return by its height above the floor and count it in its cell.

    A return below the floor counts where its ray should have met the floor.

    Args:
        image: Depth image.
        per_metre: What one metre is in it.
        lens: fx, fy, cx, cy [px].
        pose: Rotation and position of the camera in the body frame, shape (3, 4).
        limits: Height of the lowest obstacle at no depth [m], what that grows by with the depth,
            height of the highest [m], furthest depth [m].
        area: Lower corner of the grid and its cell [m], shape (3,).
        columns: Cells along x.
        rows: Cells along y.

    Returns:
        Pixels of floor, obstacle and drop-off in each cell, shape (3, columns, rows); and of
        obstacles and drop-offs the box, the nearest point and the square of its distance, shape
        (2, columns, rows, 10).
    """
    total, width = columns * rows, image.shape[1]
    counts = np.zeros(3 * total, dtype=np.int32)
    boxes = np.empty((2 * total, 10))  # rows are written when they are first needed
    across = (np.arange(width) - lens[2]) / lens[0]
    # Where a pixel is in units of cells, without its depth: ahead, left and up of the camera.
    scale = 1.0 / area[2]
    x0, y0 = (pose[0, 3] - area[0]) * scale, (pose[1, 3] - area[1]) * scale
    aheads, lefts, ups = pose[0, 0] * across, pose[1, 0] * across, pose[2, 0] * across
    height, lowest, growth = pose[2, 3], limits[0], limits[1]
    highest, furthest = limits[2], limits[3]
    places, points = np.empty(width, dtype=np.int32), np.empty((3, width))
    for v in range(image.shape[0]):
        down = (v - lens[3]) / lens[1]
        ahead = pose[0, 1] * down + pose[0, 2]
        left = pose[1, 1] * down + pose[1, 2]
        up = pose[2, 1] * down + pose[2, 2]
        for u in range(width):  # without a branch: several pixels at a time
            z = np.float32(image[v, u]) / per_metre
            rise = z * (ups[u] + up)
            above, least = height + rise, lowest + growth * z
            drops = above < -least
            kind = _RISE if above > least else (_DROP if drops else _FLOOR)
            reach = -z * height / rise if drops else np.float64(z)
            x = x0 + scale * reach * (aheads[u] + ahead)
            y = y0 + scale * reach * (lefts[u] + left)
            counts_here = (z > 0.0) & (z <= furthest) & (above <= highest)
            counts_here &= (x >= 0.0) & (x < columns) & (y >= 0.0) & (y < rows)
            cell = np.int32(x) * rows + np.int32(y) if counts_here else 0
            places[u] = kind * total + cell if counts_here else -1
            points[0, u], points[1, u], points[2, u] = x, y, above
        _count_row(places, points, area, total, counts, boxes)
    return counts.reshape(3, columns, rows), boxes.reshape(2, columns, rows, 10)


@compiled
def _count_row(
    places: NDArray[np.int32],
    points: Array,
    area: Array,
    total: int,
    counts: NDArray[np.int32],
    boxes: Array,
) -> None:
    """Count a row's pixels where they belong, and make the boxes of what is no floor hold them.

    Args:
        places: Of each pixel the kind times the number of cells, and its cell; -1: nowhere.
        points: Place in cells from the grid's corner, height [m], shape (3, width).
        area: Lower corner of the grid and its cell [m].
        total: Number of cells.
        counts: Pixels of each kind and cell, shape (3 total,).
        boxes: Of obstacles and drop-offs, shape (2 total, 10).
    """
    x0, y0, cell = area[0], area[1], area[2]
    for u in range(len(places)):
        place = places[u]
        if place < 0:
            continue
        counts[place] += 1
        if place >= total:
            box = boxes[place - total]
            if counts[place] == 1:
                _empty(box)
            _widen(box, x0 + points[0, u] * cell, y0 + points[1, u] * cell, points[2, u])


@compiled
def _empty(box: Array) -> None:
    """Make a cell's box one without a point."""
    box[_BELOW:_ABOVE], box[_ABOVE:_NEAREST], box[_NEAREST:] = math.inf, -math.inf, math.inf


@compiled
def _widen(box: Array, x: float, y: float, z: float) -> None:
    """Make a cell's box hold a point, and keep the point if it is the nearest."""
    box[0], box[1], box[2] = min(box[0], x), min(box[1], y), min(box[2], z)
    box[3], box[4], box[5] = max(box[3], x), max(box[4], y), max(box[5], z)
    square = x * x + y * y
    if square < box[_PIXELS]:
        box[6], box[7], box[8], box[_PIXELS] = x, y, z, square


@compiled
def connect(count: NDArray[np.int32], boxes: Array, least: int) -> tuple[NDArray[np.int32], Array]:
    """Join cells that touch, also at a corner.

    Args:
        count: Pixels in each cell, shape (columns, rows).
        boxes: Box, nearest point and its distance squared of each, shape (columns, rows, 10).
        least: Fewest pixels of what is kept.

    Returns:
        The number, from 1, of what each cell belongs to, 0 where there is nothing and -1 where
        there are too few pixels, shape (columns, rows); and box, nearest point and pixels of each,
        shape (K, 10).
    """
    columns, rows = count.shape
    label = np.zeros((columns, rows), dtype=np.int32)
    found = np.empty((columns * rows, 10))
    waiting = np.empty((columns * rows, 2), dtype=np.int32)
    kept = 0
    for i in range(columns):
        for j in range(rows):
            if count[i, j] == 0 or label[i, j] != 0:
                continue
            cells = _gather(i, j, kept + 1, count, label, waiting)
            _join(waiting[:cells], count, boxes, found[kept])
            if found[kept, _PIXELS] >= least:
                kept += 1
            else:
                for cell in range(cells):
                    label[waiting[cell, 0], waiting[cell, 1]] = -1
    return label, found[:kept].copy()


@compiled
def _gather(
    i: int,
    j: int,
    number: int,
    count: NDArray[np.int32],
    label: NDArray[np.int32],
    waiting: NDArray[np.int32],
) -> int:
    """Label all cells connected to one, list them, and return how many there are."""
    waiting[0, 0], waiting[0, 1] = i, j
    label[i, j] = number
    done, total = 0, 1
    while done < total:
        a, b = waiting[done]
        done += 1
        for c in range(max(a - 1, 0), min(a + 2, count.shape[0])):
            for d in range(max(b - 1, 0), min(b + 2, count.shape[1])):
                if count[c, d] > 0 and label[c, d] == 0:
                    label[c, d] = number
                    waiting[total, 0], waiting[total, 1] = c, d
                    total += 1
    return total


@compiled
def _join(cells: NDArray[np.int32], count: NDArray[np.int32], boxes: Array, result: Array) -> None:
    """Write box, nearest point and pixels of cells together into a row (10,)."""
    result[:3], result[3:6], result[_PIXELS] = math.inf, -math.inf, 0.0
    least = math.inf
    for number in range(len(cells)):
        i, j = cells[number]
        box = boxes[i, j]
        result[_PIXELS] += count[i, j]
        for axis in range(3):
            result[_BELOW + axis] = min(result[_BELOW + axis], box[_BELOW + axis])
            result[_ABOVE + axis] = max(result[_ABOVE + axis], box[_ABOVE + axis])
        if box[_PIXELS] < least:
            least = box[_PIXELS]
            result[_NEAREST:_PIXELS] = box[_NEAREST:_PIXELS]
