"""Thin a cloud: one point, the centroid, for every voxel that holds any [FuzzyDVZ, 3.2.2]."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ..errors import InputError
from .compiled import compiled
from .depth_image import Points
from .point_rows import point_rows
from .slots import EMPTY, Keys, Table, find_slot, larger_table

_BITS = 21  # of each index in a key: 20 km at 1 cm
_HALF = 1 << (_BITS - 1)
_SLOTS = 1 << 17  # of the table to begin with


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
    rows = point_rows(points)
    if not 0.0 < leaf < np.inf:
        raise InputError("voxels need a size", field="leaf", value=leaf, allowed="> 0 m")
    scale = np.float32(1.0) / np.float32(leaf)
    if len(rows) and float(max(rows.max(), -rows.min())) * float(scale) >= _HALF:
        raise InputError("too wide a cloud for voxels that small", field="leaf", value=leaf)
    return _centroids(rows, scale)


@compiled
def _centroids(rows: Points, scale: np.float32) -> Points:
    """Return the centroids (M, 3) of the voxels of edge 1 / scale."""
    table = np.full(_SLOTS, EMPTY, dtype=np.int32)
    keys = np.empty(len(rows), dtype=np.int64)
    sums = np.empty((len(rows), 4), dtype=np.float32)
    done, count = _fill(rows, scale, 0, 0, table, keys, sums)
    while done < len(rows):
        table = larger_table(table, keys, count)
        done, count = _fill(rows, scale, done, count, table, keys, sums)
    centroids = np.empty((count, 3), dtype=np.float32)
    for voxel in range(count):
        for axis in range(3):
            centroids[voxel, axis] = sums[voxel, axis] / sums[voxel, 3]
    return centroids


@compiled
def _fill(
    rows: Points,
    scale: np.float32,
    first: int,
    count: int,
    table: Table,
    keys: Keys,
    sums: NDArray[np.float32],
) -> tuple[int, int]:
    """Add points to the sums of their voxels until all are or the table is half full.

    Returns:
        The first point that is not added, and the number of voxels.
    """
    last_key, last, most = np.int64(EMPTY), np.int64(0), len(table) // 2
    for row in range(first, len(rows)):
        x, y, z = rows[row, 0], rows[row, 1], rows[row, 2]
        i = np.int64(np.floor(x * scale)) + _HALF
        j = np.int64(np.floor(y * scale)) + _HALF
        k = np.int64(np.floor(z * scale)) + _HALF
        key = (((k << _BITS) | j) << _BITS) | i
        if key != last_key:  # neighbours in the image mostly share a voxel
            slot = find_slot(table, keys, key)
            if table[slot] == EMPTY:
                if count >= most:
                    return row, count
                table[slot] = count
                keys[count] = key
                sums[count] = 0.0
                count += 1
            last_key, last = key, np.int64(table[slot])
        sums[last, 0] += x
        sums[last, 1] += y
        sums[last, 2] += z
        sums[last, 3] += np.float32(1.0)
    return len(rows), count
