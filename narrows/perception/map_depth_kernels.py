"""The compiled loops that put a depth image into the obstacle map.

Obstacles are hit pixel by pixel. Free space is asked for cell by cell: a cell is passed if its
middle lies before what its pixel sees, so that the cost does not grow with the image.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..se2 import Array
from .compiled import compiled
from .depth_kernels import Image
from .map_cells import Cells, Origin, band_of, line_beside, mark_hit, mark_passed_bands, ring_line


class View(NamedTuple):
    """A depth camera and what its pixels mean.

    Attributes:
        lens: fx, fy, cx, cy [px].
        pose: Rotation camera_to_body and position of the camera in the body frame, shape (3, 4).
        chair: Pose of the chair in the world, shape (3,).
        per_metre: What one metre is in the image.
        furthest: Depth beyond which returns are not used [m].
        short: How much before a return a cell must lie to be free, at no depth [m].
        growth: What that grows by with the square of the depth [1/m].
    """

    lens: Array
    pose: Array
    chair: Array
    per_metre: np.float32
    furthest: float
    short: float
    growth: float


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
    size, scale = cells.occupied.shape[0], 1.0 / cells.cell
    start_i, start_j = origin[0] % size, origin[1] % size
    band = 0
    cos, sin = math.cos(view.chair[2]), math.sin(view.chair[2])
    across = (np.arange(image.shape[1]) - view.lens[2]) / view.lens[0]
    pose = view.pose
    for row in range(0, image.shape[0], stride):
        down = (row - view.lens[3]) / view.lens[1]
        ahead = pose[0, 1] * down + pose[0, 2]
        left = pose[1, 1] * down + pose[1, 2]
        up = pose[2, 1] * down + pose[2, 2]
        for column in range(0, image.shape[1], stride):
            z = float(np.float32(image[row, column]) / view.per_metre)
            if z <= 0.0 or z > view.furthest:
                continue
            height = pose[2, 3] + z * (pose[2, 0] * across[column] + up)
            if height <= limits[0] + limits[1] * z:
                continue
            x = pose[0, 3] + z * (pose[0, 0] * across[column] + ahead)
            y = pose[1, 3] + z * (pose[1, 0] * across[column] + left)
            k, m = (x - area[0]) / area[2], (y - area[1]) / area[2]
            if not (0.0 <= k < seen.shape[0] and 0.0 <= m < seen.shape[1]):
                continue
            band = band_of(height, cells.edges, band)
            if band < 0 or seen[int(k), int(m)] != obstacle:
                continue
            i = math.floor((view.chair[0] + cos * x - sin * y) * scale) - origin[0]
            j = math.floor((view.chair[1] + sin * x + cos * y) * scale) - origin[1]
            if 0 <= i < size and 0 <= j < size:
                mark_hit(cells, ring_line(i, start_i, size), ring_line(j, start_j, size), band)


@compiled
def pass_pixels(cells: Cells, origin: Origin, view: View, image: Image) -> None:
    """Clear the cells that lie before what their pixels see, four at a time.

    Asked at the height of each band's middle, at the left and the right end of what four cells
    span in the image.
    """
    size, cell = cells.occupied.shape[0], cells.cell
    heights = 0.5 * (cells.edges[1:] + cells.edges[:-1])
    cos, sin = math.cos(view.chair[2]), math.sin(view.chair[2])
    pose, lens = view.pose, view.lens
    eye_x = view.chair[0] + cos * pose[0, 3] - sin * pose[1, 3]
    eye_y = view.chair[1] + sin * pose[0, 3] + cos * pose[1, 3]
    reach = math.hypot(view.furthest, view.furthest)
    i_from = max(math.floor((eye_x - reach) / cell), origin[0])
    i_to = min(math.floor((eye_x + reach) / cell), origin[0] + size - 2)
    j_from = max(math.floor((eye_y - reach) / cell), origin[1])
    j_to = min(math.floor((eye_y + reach) / cell), origin[1] + size - 2)
    start_i, start_j = origin[0] % size, origin[1] % size
    bands = np.uint32((1 << len(heights)) - 1)
    settled = cells.settled
    for i in range(i_from + i_from % 2, i_to + 1, 2):
        a = ring_line(i - origin[0], start_i, size)
        c = line_beside(a, 1, size)
        for j in range(j_from + j_from % 2, j_to + 1, 2):
            b = ring_line(j - origin[1], start_j, size)
            d = line_beside(b, 1, size)
            left_over = bands & ~(settled[a, b] & settled[a, d] & settled[c, b] & settled[c, d])
            if left_over == 0:
                continue
            east, north = (i + 1) * cell - eye_x, (j + 1) * cell - eye_y
            ahead, left = cos * east + sin * north, cos * north - sin * east
            # The column at the camera's height, in the camera frame; heights add a multiple of up.
            x0 = pose[0, 0] * ahead + pose[1, 0] * left
            y0 = pose[0, 1] * ahead + pose[1, 1] * left
            z0 = pose[0, 2] * ahead + pose[1, 2] * left
            if _is_beside_view(pose, lens[0], lens[2], image.shape[1], heights, x0, z0):
                continue
            passed = np.uint32(0)
            for band in range(len(heights)):
                bit = np.uint32(1) << np.uint32(band)
                if not left_over & bit:
                    continue
                rise = heights[band] - pose[2, 3]
                z = z0 + pose[2, 2] * rise
                if z <= 0.0 or z >= view.furthest:
                    continue
                each = 1.0 / z
                half = lens[0] * cell * each
                u = lens[0] * (x0 + pose[2, 0] * rise) * each + lens[2] + 0.5
                v = lens[1] * (y0 + pose[2, 1] * rise) * each + lens[3] + 0.5
                if not (half <= u < image.shape[1] - half and 0.0 <= v < image.shape[0]):
                    continue
                seen = min(image[int(v), int(u - half)], image[int(v), int(u + half)])
                depth = float(np.float32(seen) / view.per_metre)
                if depth > z + view.short + view.growth * z * z:
                    passed |= bit
            if passed:
                mark_passed_bands(cells, a, b, passed)
                mark_passed_bands(cells, a, d, passed)
                mark_passed_bands(cells, c, b, passed)
                mark_passed_bands(cells, c, d, passed)


@compiled
def _is_beside_view(
    pose: Array, focal: float, middle: float, width: int, heights: Array, x0: float, z0: float
) -> bool:
    """Return whether a column of cells lies behind the camera or beside its image, all of it."""
    below, above = heights[0] - pose[2, 3], heights[-1] - pose[2, 3]
    z_below, z_above = z0 + pose[2, 2] * below, z0 + pose[2, 2] * above
    if z_below <= 0.0 and z_above <= 0.0:
        return True
    # Left and right of the image are half-spaces through the camera; a line is in one if its ends
    # are.
    x_below, x_above = x0 + pose[2, 0] * below, x0 + pose[2, 0] * above
    left, right = -(middle + 0.5) / focal, (width - 0.5 - middle) / focal
    if x_below < left * z_below and x_above < left * z_above:
        return True
    return bool(x_below > right * z_below and x_above > right * z_above)
