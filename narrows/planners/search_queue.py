"""A priority queue and a table of cells for compiled searches, in plain arrays."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from ..se2 import Array
from .compiled import compiled


@compiled
def push(keys: Array, items: NDArray[np.int64], size: int, key: float, item: int) -> int:
    """Put an item on a binary heap of `size` entries; return the new size."""
    place = size
    while place > 0:
        above = (place - 1) // 2
        if keys[above] <= key:
            break
        keys[place], items[place] = keys[above], items[above]
        place = above
    keys[place], items[place] = key, item
    return size + 1


@compiled
def pop(keys: Array, items: NDArray[np.int64], size: int) -> tuple[float, int]:
    """Take the item of the least key off a heap of `size` > 0 entries; the size falls by one."""
    top_key, top = keys[0], items[0]
    last = size - 1
    key, item = keys[last], items[last]
    place = 0
    while True:
        below = 2 * place + 1
        if below >= last:
            break
        if below + 1 < last and keys[below + 1] < keys[below]:
            below += 1
        if keys[below] >= key:
            break
        keys[place], items[place] = keys[below], items[below]
        place = below
    keys[place], items[place] = key, item
    return top_key, top


@compiled
def slot_of(table: NDArray[np.int64], cell: int) -> int:
    """Return the row of a cell's key in a table, or the empty row (-1) where it belongs.

    Args:
        table: Open addressing, shape (2^m, 2): key and value; free rows hold -1. Never full.
        cell: The key, not negative.
    """
    mask = table.shape[0] - 1
    slot = (cell * 2654435761 ^ (cell >> 15)) & mask
    while table[slot, 0] != -1 and table[slot, 0] != cell:
        slot = (slot + 1) & mask
    return int(slot)


@compiled
def distances(
    is_blocked: NDArray[np.bool_],
    column: int,
    row: int,
    way: Array,
    keys: Array,
    items: NDArray[np.int64],
) -> None:
    """Write the length of the shortest 8-connected way from a cell over free cells, in cells.

    Args:
        is_blocked: Shape (columns, rows).
        column: Cell the ways lead from; it counts as free.
        row: The same.
        way: Infinite, shape (columns, rows); where no way leads it stays infinite.
        keys: Room for the queue, at least 8 times the number of cells.
        items: The same.
    """
    columns, rows = is_blocked.shape
    way[column, row] = 0.0
    size = push(keys, items, 0, 0.0, column * rows + row)
    while size > 0:
        here, item = pop(keys, items, size)
        size -= 1
        column, row = item // rows, item % rows
        if here > way[column, row]:
            continue
        for i in range(max(column - 1, 0), min(column + 2, columns)):
            for j in range(max(row - 1, 0), min(row + 2, rows)):
                length = here + (1.0 if i == column or j == row else math.sqrt(2.0))
                if not is_blocked[i, j] and length < way[i, j]:
                    way[i, j] = length
                    size = push(keys, items, size, length, i * rows + j)
