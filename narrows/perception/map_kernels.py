"""The compiled loops of the obstacle map: hits, what rays pass through, what leaves, what is near.

The map is a ring: world cell (i, j) lives at (i mod n, j mod n), so that a move of the chair costs
only the lines that leave. `origin` is the world cell in the window's lower corner. Heights are
bands; `certainty` has one layer for each, and a bit for each in `occupied` and `free` repeats what
it says, so that a glance at a column of cells is one comparison.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..se2 import Array
from .compiled import compiled

_LAST_MARK = 254


class Cells(NamedTuple):
    """The map's memory, n by n cells and K bands of height.

    Attributes:
        certainty: Of each cell and band, shape (K, n, n): `hit` and more is occupied, less than 0
            is free, anything between is not known.
        touched: Mark of the update that touched each last, shape (K, n, n): `mark` if a ray of it
            passed, mark + 1 if it was hit.
        mark: Mark of the update at work, even, shape (1,).
        occupied: Bit k: band k is occupied, shape (n, n).
        free: Bit k: band k is free, shape (n, n).
        edges: Heights between the bands, shape (K + 1,), [m].
        cell: Edge of a cell [m].
        hit: What a hit adds.
        miss: What a ray that passes takes away.
        most: The greatest certainty.
    """

    certainty: NDArray[np.int8]
    touched: NDArray[np.uint8]
    mark: NDArray[np.uint8]
    occupied: NDArray[np.uint32]
    free: NDArray[np.uint32]
    edges: Array
    cell: float
    hit: int
    miss: int
    most: int


Origin = NDArray[np.int64]


@compiled
def judge(cells: Cells, band: int, i: int, j: int, value: int) -> None:
    """Give a cell of the ring a certainty, and its bits what follows from it."""
    cells.certainty[band, i, j] = value
    bit = np.uint32(1) << np.uint32(band)
    if value >= cells.hit:
        cells.occupied[i, j] |= bit
    else:
        cells.occupied[i, j] &= ~bit
    if value < 0:
        cells.free[i, j] |= bit
    else:
        cells.free[i, j] &= ~bit


def begin_update(cells: Cells) -> None:
    """Let every cell be touched anew."""
    if cells.mark[0] >= _LAST_MARK:
        cells.touched[:] = 0
        cells.mark[0] = 0
    cells.mark[0] += 2


@compiled
def mark_hit(cells: Cells, band: int, i: int, j: int) -> None:
    """Make a cell surer to be occupied, once an update; what seemed free is forgotten at once."""
    hit = int(cells.mark[0]) + 1
    if cells.touched[band, i, j] != hit:
        cells.touched[band, i, j] = hit
        value = int(cells.certainty[band, i, j])
        judge(cells, band, i, j, min((value if value > 0 else 0) + cells.hit, cells.most))


@compiled
def mark_passed(cells: Cells, band: int, i: int, j: int) -> None:
    """Make a cell surer to be free, once an update, unless it was hit in the same."""
    value = int(cells.certainty[band, i, j])
    if value <= -cells.hit:
        return
    mark, last = int(cells.mark[0]), int(cells.touched[band, i, j])
    if last != mark and last != mark + 1:
        cells.touched[band, i, j] = mark
        judge(cells, band, i, j, max(value - cells.miss, -cells.hit))


@compiled
def band_of(z: float, edges: Array) -> int:
    """Return the band that holds a height, or -1."""
    if not (edges[0] <= z < edges[-1]):
        return -1
    band = 0
    while z >= edges[band + 1]:
        band += 1
    return band


@compiled
def forget_lines(cells: Cells, first: int, count: int, axis: int) -> None:
    """Make lines of the ring unknown: rows for axis 0, columns for axis 1."""
    size = cells.occupied.shape[0]
    for k in range(count):
        line = (first + k) % size
        if axis == 0:
            cells.certainty[:, line, :] = 0
            cells.occupied[line, :] = 0
            cells.free[line, :] = 0
        else:
            cells.certainty[:, :, line] = 0
            cells.occupied[:, line] = 0
            cells.free[:, line] = 0


@compiled
def hit_points(cells: Cells, origin: Origin, points: Array) -> None:
    """Hit the cells of points (N, 3) of the world; what is outside the window or bands is not."""
    size, cell = cells.occupied.shape[0], cells.cell
    for row in range(len(points)):
        x, y, z = points[row, 0] / cell, points[row, 1] / cell, points[row, 2]
        band = band_of(z, cells.edges)
        if band < 0 or not (abs(x) < 1e15 and abs(y) < 1e15):
            continue
        i, j = np.int64(math.floor(x)), np.int64(math.floor(y))
        if 0 <= i - origin[0] < size and 0 <= j - origin[1] < size:
            mark_hit(cells, band, i % size, j % size)


@compiled
def pass_rays(cells: Cells, origin: Origin, start: Array, ends: Array) -> None:
    """Clear the cells along rays of the world from a place (3,) to ends (N, 3).

    A cell is passed in the bands at which the ray enters and leaves it.
    """
    size, cell = cells.occupied.shape[0], cells.cell
    x0, y0 = start[0] / cell - origin[0], start[1] / cell - origin[1]
    for row in range(len(ends)):
        dx = ends[row, 0] / cell - origin[0] - x0
        dy = ends[row, 1] / cell - origin[1] - y0
        rise = ends[row, 2] - start[2]
        if not (abs(dx) < 1e9 and abs(dy) < 1e9):
            continue
        i, j = math.floor(x0), math.floor(y0)
        if not (0 <= i < size and 0 <= j < size):
            continue
        a, b = (i + origin[0]) % size, (j + origin[1]) % size  # where the cell is in the ring
        step_i, step_j = (1 if dx > 0.0 else -1), (1 if dy > 0.0 else -1)
        each_i, each_j = abs(1.0 / dx), abs(1.0 / dy)
        next_i = ((i + 1 - x0) if dx > 0.0 else (x0 - i)) * each_i if dx != 0.0 else np.inf
        next_j = ((j + 1 - y0) if dy > 0.0 else (y0 - j)) * each_j if dy != 0.0 else np.inf
        band = band_of(start[2], cells.edges)
        while True:
            share = min(next_i, next_j)
            if band >= 0:
                mark_passed(cells, band, a, b)
            if rise != 0.0:
                leaving = band_of(start[2] + min(share, 1.0) * rise, cells.edges)
                if leaving >= 0 and leaving != band:
                    mark_passed(cells, leaving, a, b)
                band = leaving
            if share >= 1.0:
                break
            if next_i < next_j:
                i += step_i
                next_i += each_i
                a = _beside(a, step_i, size)
            else:
                j += step_j
                next_j += each_j
                b = _beside(b, step_j, size)
            if not (0 <= i < size and 0 <= j < size):
                break


@compiled
def _beside(line: int, step: int, size: int) -> int:
    """Return the line of the ring before or after one."""
    following = line + step
    if following == size:
        return 0
    return size - 1 if following < 0 else following


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
                value = np.int64(cells.certainty[band, a, b])
                if bands[band] and value >= 0 and (value < cells.hit or depth >= deep):
                    judge(cells, band, a, b, -1)


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
        a, b = i % size, _beside(j_from % size, -1, size)
        line, up, down = free[a], free[_beside(a, 1, size)], free[_beside(a, -1, size)]
        here = line[b]
        for j in range(j_from, j_to):
            b = _beside(b, 1, size)
            last, here, coming = here, line[b], line[_beside(b, 1, size)]
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
