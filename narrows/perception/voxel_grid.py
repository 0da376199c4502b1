"""Thin a cloud: one point, the centroid, for every voxel that holds any [FuzzyDVZ, 3.2.2]."""

from __future__ import annotations

import numpy as np

from ..errors import InputError
from .depth_image import Points
from .point_rows import rows_and_reach
from .scratch import Scratch
from .voxel_kernels import HALF, add_points, enter_all

_SLOTS = 1 << 17  # of the table to begin with
_SCRATCH = Scratch()


def voxel_grid(points: Points, leaf: float = 0.01) -> Points:
    """Return the centroid of the points in each voxel.

    Voxel (i, j, k) holds the points with floor(p / leaf) = (i, j, k), computed in single precision
    as p * (1 / leaf), as the Point Cloud Library does: its faces are at whole multiples of the
    leaf. That library returns the cloud unchanged when its voxels cannot be numbered in 32 bits;
    here they are numbered in 63.

    Args:
        points: Shape (N, 3), [m], finite.
        leaf: Edge of a voxel [m].

    Returns:
        Shape (M, 3), [m], in the order in which the voxels are first met; (0, 3) for no points.

    Raises:
        ShapeError: If the points are not (N, 3) or not finite.
        InputError: If the leaf is not positive, or the cloud is a million leaves wide.
    """
    rows, furthest = rows_and_reach(points)
    if not 0.0 < leaf < np.inf:
        raise InputError("voxels need a size", field="leaf", value=leaf, allowed="> 0 m")
    scale = np.float32(1.0) / np.float32(leaf)
    if furthest * float(scale) >= HALF:
        raise InputError("too wide a cloud for voxels that small", field="leaf", value=leaf)
    return _centroids(rows, scale)


def _centroids(rows: Points, scale: np.float32) -> Points:
    """Return the centroids (M, 3) of the voxels of edge 1 / scale."""
    keys = _SCRATCH.array("keys", (len(rows),), np.int64)
    sums = _SCRATCH.array("sums", (len(rows), 3), np.float32)
    points = _SCRATCH.array("points", (len(rows),), np.float32)
    done, count, slots = 0, 0, _SLOTS
    while done < len(rows):
        table = _SCRATCH.array("table", (slots,), np.int32)
        enter_all(table, keys, count)
        done, count = add_points(rows, scale, done, count, table, keys, sums, points)
        slots *= 4
    centroids: Points = sums[:count] / points[:count, None]
    return centroids
