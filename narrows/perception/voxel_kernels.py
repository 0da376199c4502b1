"""The compiled loops that sum up the points of each voxel.

Voxels are found by their keys in an open hash table: 2^m slots that hold the number of a voxel, in
the order in which they are first met.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from .compiled import compiled
from .depth_image import Points

BITS = 21  # of each index in a key: 20 km at 1 cm
HALF = 1 << (BITS - 1)
_EMPTY = -1

Table = NDArray[np.int32]
Keys = NDArray[np.int64]


@compiled
def find_slot(table: Table, keys: Keys, key: int | np.int64) -> int:
    """Return the slot of the voxel with a key, or the empty one it belongs in.

    Args:
        table: Number of the voxel in each slot, shape (2^m,); at least one is empty.
        keys: Key of each voxel.
        key: The key to look for, >= 0.
    """
    mask = len(table) - 1
    # Only the upper bits of the product depend on all of the key.
    slot = int((key * 0x2545F4914F6CDD1D) >> 40) & mask
    while table[slot] != _EMPTY and keys[table[slot]] != key:
        slot = (slot + 1) & mask
    return slot


@compiled
def enter_all(table: Table, keys: Keys, count: int) -> None:
    """Make a table hold the first `count` voxels, and nothing else."""
    table[:] = _EMPTY
    for voxel in range(count):
        table[find_slot(table, keys, keys[voxel])] = voxel


@compiled
def add_points(
    rows: Points,
    scale: np.float32,
    first: int,
    count: int,
    table: Table,
    keys: Keys,
    sums: Points,
    points: NDArray[np.float32],
) -> tuple[int, int]:
    """Add points to the sums of their voxels until all are or the table is half full.

    Args:
        rows: The points.
        scale: Voxels a metre.
        first: The point to begin with.
        count: Number of voxels so far.
        table: Where they are found.
        keys: Their keys, room for one a point.
        sums: Sums of the coordinates, likewise.
        points: How many points they hold, likewise.

    Returns:
        The first point that is not added, and the number of voxels.
    """
    most, voxel, last = len(table) // 2, 0, np.int64(-1)
    x = y = z = n = np.float32(0.0)
    for row in range(first, len(rows)):
        i = np.int64(np.floor(rows[row, 0] * scale)) + HALF
        j = np.int64(np.floor(rows[row, 1] * scale)) + HALF
        k = np.int64(np.floor(rows[row, 2] * scale)) + HALF
        key = (((k << BITS) | j) << BITS) | i
        if key != last:  # neighbours in the image mostly share a voxel
            if last >= 0:
                sums[voxel, 0], sums[voxel, 1], sums[voxel, 2], points[voxel] = x, y, z, n
            slot = find_slot(table, keys, key)
            voxel = int(table[slot])
            if voxel == _EMPTY:
                if count >= most:
                    return row, count
                voxel = count
                table[slot] = voxel
                keys[voxel] = key
                count += 1
                x = y = z = n = np.float32(0.0)
            else:
                x, y, z, n = sums[voxel, 0], sums[voxel, 1], sums[voxel, 2], points[voxel]
            last = key
        x += rows[row, 0]
        y += rows[row, 1]
        z += rows[row, 2]
        n += np.float32(1.0)
    if last >= 0:
        sums[voxel, 0], sums[voxel, 1], sums[voxel, 2], points[voxel] = x, y, z, n
    return len(rows), count
