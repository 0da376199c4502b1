"""The compiled loops that find connected points.

Points are sorted into cells, and cells by their keys, so that a row of neighbours is a run of keys:
one walk along all cells for each row beside them finds who is next to whom.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from ..se2 import Array
from .compiled import compiled
from .depth_image import Points

_BITS = 21
_HALF = 1 << (_BITS - 1)
_REACH = 2  # cells further apart than this are more than their diagonal apart

Keys = NDArray[np.int64]
Numbers = NDArray[np.int64]


def component_of_each(points: Points, tolerance: float) -> Numbers:
    """Return the number of each point's component, numbered by their first points, shape (N,)."""
    # A hair smaller than tolerance / sqrt(3): the diagonal stays below it in rounding too.
    keys = _cell_keys(points, 0.999 * tolerance / math.sqrt(3.0))
    order = np.argsort(keys)
    cells, starts = _runs(keys, order)
    parent = np.arange(len(cells))
    _join_rows(points[order].astype(float), cells, starts, tolerance * tolerance, parent)
    return _numbered(order, starts, parent)


@compiled
def _cell_keys(points: Points, size: float) -> Keys:
    """Return the key of each point's cell: neighbours along x differ by one."""
    keys = np.empty(len(points), dtype=np.int64)
    for point in range(len(points)):
        i = np.int64(np.floor(points[point, 0] / size)) + _HALF
        j = np.int64(np.floor(points[point, 1] / size)) + _HALF
        k = np.int64(np.floor(points[point, 2] / size)) + _HALF
        keys[point] = (((k << _BITS) | j) << _BITS) | i
    return keys


@compiled
def _runs(keys: Keys, order: Numbers) -> tuple[Keys, Numbers]:
    """Return the keys of the cells (C,), ascending, and where in the order each begins (C + 1,)."""
    cells, starts = np.empty(len(keys), dtype=np.int64), np.empty(len(keys) + 1, dtype=np.int64)
    count = 0
    for place in range(len(order)):
        key = keys[order[place]]
        if count == 0 or key != cells[count - 1]:
            cells[count], starts[count] = key, place
            count += 1
    starts[count] = len(order)
    return cells[:count], starts[: count + 1]


@compiled
def _join_rows(points: Array, cells: Keys, starts: Numbers, square: float, parent: Numbers) -> None:
    """Join each cell with those of half its surroundings that hold a point near enough.

    Args:
        points: Sorted by cell, shape (N, 3), [m].
        cells: Keys of the cells, ascending.
        starts: Where the points of each cell begin.
        square: Of the tolerance [m²].
        parent: A cell of the same component, or itself; changed.
    """
    for dk in range(_REACH + 1):
        for dj in range(-_REACH if dk else 0, _REACH + 1):
            # Corner to corner they are further apart than the tolerance.
            reach = _REACH - 1 if dk == _REACH and abs(dj) == _REACH else _REACH
            offset, first = ((dk << _BITS) + dj) << _BITS, 0
            for cell in range(len(cells)):
                beside = cells[cell] + offset
                from_key = beside - reach if dk or dj else beside + 1
                while first < len(cells) and cells[first] < from_key:
                    first += 1
                other = first
                while other < len(cells) and cells[other] <= beside + reach:
                    mine, its = _root(parent, cell), _root(parent, other)
                    if mine != its and _touch(points, starts, cell, other, square):
                        parent[max(mine, its)] = min(mine, its)
                    other += 1


@compiled
def _touch(points: Array, starts: Numbers, first: int, second: int, square: float) -> bool:
    """Return whether points of two cells are within the tolerance of each other."""
    for one in range(starts[first], starts[first + 1]):
        for other in range(starts[second], starts[second + 1]):
            dx = points[one, 0] - points[other, 0]
            dy = points[one, 1] - points[other, 1]
            dz = points[one, 2] - points[other, 2]
            if dx * dx + dy * dy + dz * dz <= square:
                return True
    return False


@compiled
def _root(parent: NDArray[np.int64], cell: int) -> int:
    """Return the cell that stands for a component, shortening the way to it."""
    while parent[cell] != cell:
        parent[cell] = parent[parent[cell]]
        cell = parent[cell]
    return cell


@compiled
def _numbered(order: Numbers, starts: Numbers, parent: Numbers) -> Numbers:
    """Return each point's component, numbered in the order of their first points."""
    component = np.empty(len(order), dtype=np.int64)
    for cell in range(len(parent)):
        root = _root(parent, cell)
        for place in range(starts[cell], starts[cell + 1]):
            component[order[place]] = root
    number, count = np.full(len(parent), -1), 0
    for point in range(len(component)):
        root = component[point]
        if number[root] < 0:
            number[root] = count
            count += 1
        component[point] = number[root]
    return component
