"""The compiled loops of the search for a plane: points in three columns, single precision."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from ..se2 import Array
from .compiled import compiled, compiled_sums

Columns = NDArray[np.float32]
"""Points, shape (3, N), [m]."""


@compiled_sums
def inlier_count(
    xs: Columns,
    ys: Columns,
    zs: Columns,
    a: np.float32,
    b: np.float32,
    c: np.float32,
    d: np.float32,
    tolerance: np.float32,
) -> int:
    """Return how many points have |a x + b y + c z + d| below the tolerance."""
    count = np.int32(0)
    for point in range(len(xs)):
        distance = abs(a * xs[point] + b * ys[point] + c * zs[point] + d)
        count += np.int32(distance < tolerance)
    return int(count)


@compiled
def best_sample(
    columns: Columns,
    samples: NDArray[np.int64],
    tolerance: np.float32,
    probability: float,
) -> tuple[NDArray[np.float32], int, int]:
    """Return the plane (4,) of the best sample, its number of inliers, and the samples drawn.

    Args:
        columns: Points.
        samples: Three points each, shape (K, 3).
        tolerance: Distance below which a point is an inlier [m].
        probability: That one sample among those drawn held inliers only.
    """
    best, best_count = np.zeros(4, dtype=np.float32), 0
    needed, drawn = float(len(samples)), 0
    total = columns.shape[1]
    while drawn < len(samples) and drawn < needed:
        i, j, k = samples[drawn]
        drawn += 1
        xs, ys, zs = columns[0], columns[1], columns[2]
        ux, uy, uz = xs[j] - xs[i], ys[j] - ys[i], zs[j] - zs[i]
        vx, vy, vz = xs[k] - xs[i], ys[k] - ys[i], zs[k] - zs[i]
        a, b, c = uy * vz - uz * vy, uz * vx - ux * vz, ux * vy - uy * vx
        length = math.sqrt(a * a + b * b + c * c)
        if length < 1e-9:  # twice the triangle's area [m²]: on a line, or the same point twice
            continue
        a, b, c = np.float32(a / length), np.float32(b / length), np.float32(c / length)
        d = -(a * xs[i] + b * ys[i] + c * zs[i])
        count = inlier_count(xs, ys, zs, a, b, c, d, tolerance)
        if count > best_count:
            best_count = count
            best[0], best[1], best[2], best[3] = a, b, c, d
            outlier = 1.0 - (count / total) ** 3
            needed = math.log(1.0 - probability) / math.log(outlier) if outlier > 0.0 else 0.0
    return best, best_count, drawn


@compiled_sums
def moments(
    columns: Columns, plane: NDArray[np.float32], tolerance: np.float32
) -> tuple[Array, Array]:
    """Return the centre (3,) and the covariance (3, 3) of a plane's inliers; there must be one."""
    a, b, c, d = plane
    xs, ys, zs = columns[0], columns[1], columns[2]
    # About the first inlier's place, so that nothing is lost to a far origin.
    x0, y0, z0 = xs[0], ys[0], zs[0]
    n = sx = sy = sz = sxx = sxy = sxz = syy = syz = szz = 0.0
    for point in range(len(xs)):
        distance = abs(a * xs[point] + b * ys[point] + c * zs[point] + d)
        one = 1.0 if distance < tolerance else 0.0
        x, y, z = float(xs[point] - x0), float(ys[point] - y0), float(zs[point] - z0)
        n += one
        sx += one * x
        sy += one * y
        sz += one * z
        sxx += one * x * x
        sxy += one * x * y
        sxz += one * x * z
        syy += one * y * y
        syz += one * y * z
        szz += one * z * z
    mx, my, mz = sx / n, sy / n, sz / n
    covariance = np.empty((3, 3))
    covariance[0, 0] = sxx / n - mx * mx
    covariance[1, 1] = syy / n - my * my
    covariance[2, 2] = szz / n - mz * mz
    covariance[0, 1] = covariance[1, 0] = sxy / n - mx * my
    covariance[0, 2] = covariance[2, 0] = sxz / n - mx * mz
    covariance[1, 2] = covariance[2, 1] = syz / n - my * mz
    return np.array([mx + x0, my + y0, mz + z0]), covariance


@compiled_sums
def distances(columns: Columns, plane: NDArray[np.float32]) -> NDArray[np.float32]:
    """Return the signed distance of each point from a plane, shape (N,), [m]."""
    a, b, c, d = plane
    result = np.empty(columns.shape[1], dtype=np.float32)
    for point in range(columns.shape[1]):
        x, y, z = columns[0, point], columns[1, point], columns[2, point]
        result[point] = a * x + b * y + c * z + d
    return result
