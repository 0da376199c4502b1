"""The compiled loops of the search for the floor, in x/z, y/z and inverse depth."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from ..se2 import Array
from .compiled import compiled, compiled_sums
from .depth_kernels import Image

Columns = NDArray[np.float32]
"""Pixels as x/z, y/z and 1/z, shape (3, N), [-, -, 1/m]."""


@compiled
def floor_candidates(
    image: Image, per_metre: np.float32, lens: Array, plane: Array, slack: Array, stride: int
) -> Columns:
    """Return the pixels that may be floor, one in `stride` of the columns and of the rows.

    Args:
        image: Depth image.
        per_metre: What one metre is in it.
        lens: fx, fy, cx, cy [px].
        plane: Normal and height of the camera where the floor should be, shape (4,).
        slack: Height it may be off [m], slope it may be off, and the furthest depth [m].
        stride: Pixels between samples.
    """
    rows, columns = image.shape[0] // stride, image.shape[1] // stride
    found = np.empty((3, rows * columns), dtype=np.float32)
    count = 0
    for row in range(rows):
        v = row * stride + stride // 2
        y = (v - lens[3]) / lens[1]
        for column in range(columns):
            u = column * stride + stride // 2
            z = np.float32(image[v, u]) / per_metre
            x = (u - lens[2]) / lens[0]
            height = z * (plane[0] * x + plane[1] * y + plane[2]) + plane[3]
            near = abs(height) <= slack[0] + slack[1] * z * math.sqrt(1.0 + x * x + y * y)
            if z > 0.0 and z <= slack[2] and near:
                found[0, count], found[1, count], found[2, count] = x, y, 1.0 / z
                count += 1
    result = np.empty((3, count), dtype=np.float32)
    for axis in range(3):
        result[axis] = found[axis, :count]
    return result


@compiled_sums
def _count(
    xs: Columns,
    ys: Columns,
    ws: Columns,
    a: np.float32,
    b: np.float32,
    c: np.float32,
    tolerance: np.float32,
) -> int:
    """Return how many pixels are within the tolerance of 1/z = a x/z + b y/z + c."""
    count = np.int32(0)
    for pixel in range(len(xs)):
        count += np.int32(abs(a * xs[pixel] + b * ys[pixel] + c - ws[pixel]) < tolerance)
    return int(count)


@compiled
def best_floor(
    columns: Columns, draws: NDArray[np.int64], up: Array, limits: Array, tolerance: np.float32
) -> tuple[Array, int]:
    """Return a, b, c of the plane with most pixels that can be the floor, and how many; or zeros.

    Args:
        columns: Pixels.
        draws: Three pixels each, shape (K, 3).
        up: Normal the floor should have, camera frame, shape (3,).
        limits: Least cosine to it, height the camera should have [m], how far that may be off [m].
        tolerance: Greatest difference of a floor pixel [1/m].
    """
    xs, ys, ws = columns[0], columns[1], columns[2]
    best, best_count = np.zeros(3), 0
    for draw in range(len(draws)):
        i, j, k = draws[draw]
        ux, uy, uw = float(xs[j] - xs[i]), float(ys[j] - ys[i]), float(ws[j] - ws[i])
        vx, vy, vw = float(xs[k] - xs[i]), float(ys[k] - ys[i]), float(ws[k] - ws[i])
        area = ux * vy - uy * vx
        if abs(area) < 1e-6:
            continue
        a, b = (uw * vy - uy * vw) / area, (ux * vw - uw * vx) / area
        c = ws[i] - a * xs[i] - b * ys[i]
        size = math.sqrt(a * a + b * b + c * c)
        cosine = -(a * up[0] + b * up[1] + c * up[2]) / size
        if not (cosine >= limits[0] and abs(1.0 / size - limits[1]) <= limits[2]):
            continue
        count = _count(xs, ys, ws, np.float32(a), np.float32(b), np.float32(c), tolerance)
        if count > best_count:
            best_count = count
            best[0], best[1], best[2] = a, b, c
    return best, best_count


@compiled_sums
def floor_moments(
    columns: Columns, plane: NDArray[np.float32], tolerance: np.float32
) -> tuple[int, Array, Array, Array]:
    """Return the inliers' number, their centre (3,) and covariance (3, 3), and that of the points.

    The first covariance is that of (x/z, y/z, 1/z), the second that of (x, y, z) [m²].
    """
    count = 0.0
    first, second = np.zeros(3), np.zeros((3, 3))
    first_point, second_point = np.zeros(3), np.zeros((3, 3))
    for pixel in range(columns.shape[1]):
        x = np.float64(columns[0, pixel])
        y = np.float64(columns[1, pixel])
        w = np.float64(columns[2, pixel])
        if abs(plane[0] * x + plane[1] * y + plane[2] - w) < tolerance:
            count += 1.0
            row = (x, y, w)
            point = (x / w, y / w, 1.0 / w)
            for i in range(3):
                first[i] += row[i]
                first_point[i] += point[i]
                for j in range(3):
                    second[i, j] += row[i] * row[j]
                    second_point[i, j] += point[i] * point[j]
    total = max(count, 1.0)
    first /= total
    first_point /= total
    for i in range(3):
        for j in range(3):
            second[i, j] = second[i, j] / total - first[i] * first[j]
            second_point[i, j] = second_point[i, j] / total - first_point[i] * first_point[j]
    return int(count), first, second, second_point
