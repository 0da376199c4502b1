"""The compiled loops that put a depth image into the obstacle map.

Obstacles are hit pixel by pixel. Free space is asked for cell by cell: a cell is passed if its
middle lies before what its pixel sees, so that the cost does not grow with the image.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from ..se2 import Array
from .compiled import compiled
from .depth_kernels import Image
from .map_cells import Cells, Origin, band_of, line_beside, mark_hit, mark_passed_bands, ring_line
from .map_view_kernels import Optics, View, between, columns_of, sides_of_view


@compiled
def hit_pixels(
    cells: Cells,
    origin: Origin,
    view: View,
    image: Image,
    limits: Array,
    area: Array,
    seen: NDArray[np.uint8],
    obstacle: int,
    stride: int,
) -> None:
    """Hit the cells of pixels that rise above the floor where the view was judged an obstacle.

    Args:
        cells: The map's memory.
        origin: World cell in the window's corner.
        view: The camera.
        image: Depth image.
        limits: Height of the lowest obstacle at no depth [m], what that grows by with the depth.
        area: Lower corner of the judged grid in the body frame, and its cell, shape (3,), [m].
        seen: The judged grid, shape (columns, rows).
        obstacle: Its value of an obstacle.
        stride: Every how many pixels, along rows and columns, one is looked at.
    """
    size, scale, optics, pose = len(cells.free), 1.0 / cells.cell, view.optics, view.pose
    start_i, start_j = origin[0] % size, origin[1] % size
    cos, sin = math.cos(view.chair[2]), math.sin(view.chair[2])
    chair_x, chair_y = view.chair[0], view.chair[1]
    eye_x, eye_y, eye_z = pose[0, 3], pose[1, 3], pose[2, 3]
    area_x, area_y, each = area[0], area[1], 1.0 / area[2]
    least, growth = limits[0], limits[1]
    across = (np.arange(image.shape[1]) - optics.cx) / optics.fx
    aheads, lefts, ups = pose[0, 0] * across, pose[1, 0] * across, pose[2, 0] * across
    hits, band = np.empty((image.shape[1], 3), dtype=np.int64), 0
    for row in range(0, image.shape[0], stride):
        down = (row - optics.cy) / optics.fy
        ahead = pose[0, 1] * down + pose[0, 2]
        left = pose[1, 1] * down + pose[1, 2]
        up = pose[2, 1] * down + pose[2, 2]
        count = 0
        for column in range(0, image.shape[1], stride):
            z = float(np.float32(image[row, column]) / optics.per_metre)
            height = eye_z + z * (ups[column] + up)
            if z <= 0.0 or z > optics.furthest or height <= least + growth * z:
                continue
            x = eye_x + z * (aheads[column] + ahead)
            y = eye_y + z * (lefts[column] + left)
            k, m = (x - area_x) * each, (y - area_y) * each
            if not (0.0 <= k < seen.shape[0] and 0.0 <= m < seen.shape[1]):
                continue
            i = math.floor((chair_x + cos * x - sin * y) * scale) - origin[0]
            j = math.floor((chair_y + sin * x + cos * y) * scale) - origin[1]
            if not (0 <= i < size and 0 <= j < size):
                continue
            band = band_of(height, cells.edges, band)
            if band < 0:
                continue
            hits[count, 0], hits[count, 1], hits[count, 2] = i, j, band
            count += int(seen[int(k), int(m)] == obstacle)
        for hit in range(count):
            a = ring_line(hits[hit, 0], start_i, size)
            b = ring_line(hits[hit, 1], start_j, size)
            mark_hit(cells, a, b, hits[hit, 2])


@compiled
def pass_pixels(cells: Cells, origin: Origin, view: View, image: Image) -> None:
    """Clear the cells that lie before what their pixels see, four at a time.

    Asked at the height of each band's middle, at the left and the right end of what four cells
    span in the image.
    """
    size, cell, settled = cells.occupied.shape[0], cells.cell, cells.settled
    start_i, start_j = origin[0] % size, origin[1] % size
    columns = columns_of(view, 0.5 * (cells.edges[1:] + cells.edges[:-1]))
    sides = sides_of_view(view.optics, image, columns)
    every = np.uint32((1 << len(columns.rises)) - 1)
    east_of_eye, north_of_eye = columns.eye[0], columns.eye[1]
    to_x, to_y, to_z = columns.north[0], columns.north[1], columns.north[2]
    for i in range(origin[0] + origin[0] % 2, origin[0] + size - 1, 2):
        east = (i + 1) * cell - east_of_eye
        x0, y0, z0 = columns.east[0] * east, columns.east[1] * east, columns.east[2] * east
        south_end, north_end = between(sides, east)
        j_from = max(math.floor((south_end + north_of_eye) / cell) - 2, origin[1])
        j_to = min(math.floor((north_end + north_of_eye) / cell) + 1, origin[1] + size - 2)
        a = ring_line(i - origin[0], start_i, size)
        c = line_beside(a, 1, size)
        for j in range(j_from + j_from % 2, j_to + 1, 2):
            b = ring_line(j - origin[1], start_j, size)
            d = line_beside(b, 1, size)
            bands = every & ~(settled[a, b] & settled[a, d] & settled[c, b] & settled[c, d])
            if bands == 0:
                continue
            north = (j + 1) * cell - north_of_eye
            x, y, z = x0 + north * to_x, y0 + north * to_y, z0 + north * to_z
            bands = _bands_in_front(view.optics, image, columns.rises, x, y, z, cell, bands)
            if bands:
                mark_passed_bands(cells, a, b, bands)
                mark_passed_bands(cells, a, d, bands)
                mark_passed_bands(cells, c, b, bands)
                mark_passed_bands(cells, c, d, bands)


@compiled
def _bands_in_front(
    optics: Optics,
    image: Image,
    rises: Array,
    x0: float,
    y0: float,
    z0: float,
    cell: float,
    bands: np.uint32,
) -> np.uint32:
    """Return in which of the bands four cells lie before what their pixels see."""
    height, width = image.shape
    passed = np.uint32(0)
    for band in range(len(rises)):
        bit = np.uint32(1) << np.uint32(band)
        z = z0 + rises[band, 2]
        if not bands & bit or z <= 0.0 or z >= optics.furthest:
            continue
        each = 1.0 / z
        half = optics.fx * cell * each
        u = optics.fx * (x0 + rises[band, 0]) * each + optics.cx + 0.5
        v = optics.fy * (y0 + rises[band, 1]) * each + optics.cy + 0.5
        if not (half <= u < width - half and 0.0 <= v < height):
            continue
        seen = min(image[int(v), int(u - half)], image[int(v), int(u + half)])
        depth = float(np.float32(seen) / optics.per_metre)
        if depth > z + optics.short + optics.growth * z * z:
            passed |= bit
    return passed
