"""The compiled loops that put points and rays into the obstacle map."""

from __future__ import annotations

import math

import numpy as np

from ..se2 import Array
from .compiled import compiled
from .map_cells import Cells, Origin, band_of, line_beside, mark_hit, mark_passed, ring_line


@compiled
def hit_points(cells: Cells, origin: Origin, points: Array) -> None:
    """Hit the cells of points (N, 3) of the world; what is outside the window or bands is not."""
    size, cell = cells.occupied.shape[0], cells.cell
    start_i, start_j = origin[0] % size, origin[1] % size
    band = 0
    for row in range(len(points)):
        x, y = points[row, 0] / cell, points[row, 1] / cell
        band = band_of(points[row, 2], cells.edges, band)
        if band < 0 or not (abs(x) < 1e15 and abs(y) < 1e15):
            continue
        i, j = np.int64(math.floor(x)) - origin[0], np.int64(math.floor(y)) - origin[1]
        if 0 <= i < size and 0 <= j < size:
            mark_hit(cells, ring_line(i, start_i, size), ring_line(j, start_j, size), band)


@compiled
def pass_rays(cells: Cells, origin: Origin, start: Array, ends: Array) -> None:
    """Clear the cells along rays of the world from a place (3,) to ends (N, 3).

    A cell is passed in the bands at which the ray enters and leaves it.
    """
    size, cell = cells.occupied.shape[0], cells.cell
    x0, y0 = start[0] / cell - origin[0], start[1] / cell - origin[1]
    if not (0.0 <= x0 < size and 0.0 <= y0 < size):
        return
    for row in range(len(ends)):
        dx = ends[row, 0] / cell - origin[0] - x0
        dy = ends[row, 1] / cell - origin[1] - y0
        rise = ends[row, 2] - start[2]
        if not (abs(dx) < 1e9 and abs(dy) < 1e9):
            continue
        i, j = math.floor(x0), math.floor(y0)
        a, b = (i + origin[0]) % size, (j + origin[1]) % size  # where the cell is in the ring
        step_i, step_j = (1 if dx > 0.0 else -1), (1 if dy > 0.0 else -1)
        each_i, each_j = abs(1.0 / dx), abs(1.0 / dy)
        next_i = ((i + 1 - x0) if dx > 0.0 else (x0 - i)) * each_i if dx != 0.0 else np.inf
        next_j = ((j + 1 - y0) if dy > 0.0 else (y0 - j)) * each_j if dy != 0.0 else np.inf
        band = band_of(start[2], cells.edges)
        while True:
            share = min(next_i, next_j)
            if band >= 0:
                mark_passed(cells, a, b, band)
            if rise != 0.0:
                leaving = band_of(start[2] + min(share, 1.0) * rise, cells.edges, band)
                if leaving >= 0 and leaving != band:
                    mark_passed(cells, a, b, leaving)
                band = leaving
            if share >= 1.0:
                break
            if next_i < next_j:
                i += step_i
                next_i += each_i
                a = line_beside(a, step_i, size)
            else:
                j += step_j
                next_j += each_j
                b = line_beside(b, step_j, size)
            if not (0 <= i < size and 0 <= j < size):
                break
