"""An open hash table for compiled loops: 2^m slots that hold where an entry's key is kept."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from .compiled import compiled

Table = NDArray[np.int32]
Keys = NDArray[np.int64]

EMPTY = -1
"""What a slot without an entry holds."""


@compiled
def find_slot(table: Table, keys: Keys, key: int | np.int64) -> int:
    """Return the slot of the entry with a key, or the empty one it belongs in.

    Args:
        table: Number of the entry in each slot, shape (2^m,); at least one is empty.
        keys: Key of each entry.
        key: The key to look for, >= 0.
    """
    mask = len(table) - 1
    # Only the upper bits of the product depend on all of the key.
    slot = int((key * 0x2545F4914F6CDD1D) >> 40) & mask
    while table[slot] != EMPTY and keys[table[slot]] != key:
        slot = (slot + 1) & mask
    return slot


@compiled
def larger_table(table: Table, keys: Keys, count: int) -> Table:
    """Return a table four times as large that holds the same entries, the first `count`."""
    larger = np.full(4 * len(table), EMPTY, dtype=np.int32)
    for entry in range(count):
        larger[find_slot(larger, keys, keys[entry])] = entry
    return larger
