"""The compiled loops that find connected points."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from .compiled import compiled
from .depth_image import Points
from .slots import EMPTY, Keys, Table, find_slot

_BITS = 21
_HALF = 1 << (_BITS - 1)
_REACH = 2  # cells further apart than this are more than their diagonal apart


@compiled
def component_of_each(points: Points, tolerance: float) -> NDArray[np.int64]:
    """Return the number of each point's component, numbered by their first points, shape (N,)."""
    slots = 1 << 4
    while slots < 2 * len(points) + 1:
        slots *= 2
    table = np.full(slots, EMPTY, dtype=np.int32)
    keys = np.empty(len(points), dtype=np.int64)
    cell_of = np.empty(len(points), dtype=np.int32)
    following = np.empty(len(points), dtype=np.int32)  # next point of the same cell
    head = np.empty(len(points), dtype=np.int32)
    # A hair smaller than tolerance / sqrt(3): the diagonal stays below it in rounding too.
    count = _sort_into_cells(points, 0.999 * tolerance / math.sqrt(3.0), table, keys, cell_of)
    head[:count] = EMPTY
    for point in range(len(points) - 1, -1, -1):
        following[point] = head[cell_of[point]]
        head[cell_of[point]] = point
    parent = np.arange(count)
    for cell in range(count):
        _join_neighbours(cell, points, tolerance * tolerance, table, keys, head, following, parent)
    return _numbered(cell_of, parent)


@compiled
def _sort_into_cells(
    points: Points, size: float, table: Table, keys: Keys, cell_of: NDArray[np.int32]
) -> int:
    """Number the cells that hold points, note each point's, and return how many there are."""
    count = 0
    for point in range(len(points)):
        i = np.int64(np.floor(points[point, 0] / size)) + _HALF
        j = np.int64(np.floor(points[point, 1] / size)) + _HALF
        k = np.int64(np.floor(points[point, 2] / size)) + _HALF
        key = (((k << _BITS) | j) << _BITS) | i
        slot = find_slot(table, keys, key)
        if table[slot] == EMPTY:
            table[slot] = count
            keys[count] = key
            count += 1
        cell_of[point] = table[slot]
    return count


@compiled
def _join_neighbours(
    cell: int,
    points: Points,
    square: float,
    table: Table,
    keys: Keys,
    head: NDArray[np.int32],
    following: NDArray[np.int32],
    parent: NDArray[np.int64],
) -> None:
    """Join a cell with those of half its surroundings that hold a point near enough."""
    for dk in range(_REACH + 1):
        for dj in range(-_REACH if dk else 0, _REACH + 1):
            for di in range(-_REACH if dk or dj else 1, _REACH + 1):
                if abs(di) + abs(dj) + abs(dk) == 3 * _REACH:
                    continue  # corner to corner they are further apart than the tolerance
                key = keys[cell] + (((dk << _BITS) + dj) << _BITS) + di
                other = table[find_slot(table, keys, key)]
                if other == EMPTY:
                    continue
                mine, its = _root(parent, cell), _root(parent, other)
                if mine != its and _touch(points, head[cell], head[other], following, square):
                    parent[max(mine, its)] = min(mine, its)


@compiled
def _touch(
    points: Points, first: int, second: int, following: NDArray[np.int32], square: float
) -> bool:
    """Return whether points of two cells are within the tolerance of each other."""
    one = first
    while one != EMPTY:
        other = second
        while other != EMPTY:
            dx = float(points[one, 0]) - points[other, 0]
            dy = float(points[one, 1]) - points[other, 1]
            dz = float(points[one, 2]) - points[other, 2]
            if dx * dx + dy * dy + dz * dz <= square:
                return True
            other = following[other]
        one = following[one]
    return False


@compiled
def _root(parent: NDArray[np.int64], cell: int) -> int:
    """Return the cell that stands for a component, shortening the way to it."""
    while parent[cell] != cell:
        parent[cell] = parent[parent[cell]]
        cell = parent[cell]
    return cell


@compiled
def _numbered(cell_of: NDArray[np.int32], parent: NDArray[np.int64]) -> NDArray[np.int64]:
    """Return each point's component, numbered in the order of their first points."""
    number = np.full(len(parent), EMPTY)
    component = np.empty(len(cell_of), dtype=np.int64)
    count = 0
    for point in range(len(cell_of)):
        root = _root(parent, cell_of[point])
        if number[root] == EMPTY:
            number[root] = count
            count += 1
        component[point] = number[root]
    return component
