"""Sets of grid cells as polygons: exact outlines, and rectangles that tile them."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
import shapely
from numpy.typing import NDArray

Mask = NDArray[np.bool_]
Lines = NDArray[np.int64]


@dataclass(frozen=True, eq=False)
class Regions:
    """The connected regions of a set of cells. Cells that touch at a corner only are apart.

    Grid lines are counted from the mask's first row and column: cell [row, column] is the square
    from (column, row) to (column + 1, row + 1). All corners are whole numbers, so nothing is
    rounded.

    Attributes:
        outlines: One polygon a region, holes where it has them, straight corners left out, shape
            (N,). Its area is exactly the region's cells.
        rectangles: x_low, y_low, x_high, y_high of rectangles that tile the regions without
            overlap or gap, shape (R, 4).
        owner: Region of each rectangle, shape (R,), rising.
    """

    outlines: NDArray[Any]
    rectangles: Lines
    owner: NDArray[np.int64]


def regions(cells: Mask) -> Regions:
    """Return the connected regions of the cells that are True, each with outline and tiling.

    >>> found = regions(np.array([[True, True, False], [True, False, True]]))
    >>> [outline.area for outline in found.outlines]
    [3.0, 1.0]

    Args:
        cells: Which cells belong to the set, shape (rows, columns).
    """
    from scipy import ndimage  # 0.15 s to import: only those who read a grid map pay for it

    labels, count = ndimage.label(cells)
    rectangles = _tiles(cells, labels, int(count))
    owner = labels[rectangles[:, 1], rectangles[:, 0]].astype(np.int64) - 1
    order = np.argsort(owner, kind="stable")
    return Regions(_outlines(cells, labels), rectangles[order], owner[order])


def raggedness(cells: Mask) -> int:
    """Return how often a set of cells starts or ends along the rows."""
    return int(np.count_nonzero(cells[:, 1:] != cells[:, :-1]))


def _tiles(cells: Mask, labels: NDArray[np.signedinteger[Any]], count: int) -> Lines:
    """Tile each region along its rows or along its columns, whichever takes fewer rectangles."""
    by_rows = _row_tiles(cells)
    by_columns = _row_tiles(cells.T)[:, [1, 0, 3, 2]]
    row_label = labels[by_rows[:, 1], by_rows[:, 0]]
    column_label = labels[by_columns[:, 1], by_columns[:, 0]]
    fewer_rows = np.bincount(row_label, minlength=count + 1) <= np.bincount(
        column_label, minlength=count + 1
    )
    return np.concatenate([by_rows[fewer_rows[row_label]], by_columns[~fewer_rows[column_label]]])


def _row_tiles(cells: Mask) -> Lines:
    """Return the runs of cells along the rows, equal runs of neighbouring rows joined, (R, 4)."""
    edge = np.diff(np.pad(cells, ((0, 0), (1, 1))).astype(np.int8), axis=1)
    row, start = np.nonzero(edge == 1)
    end = np.nonzero(edge == -1)[1]  # runs end in the order they start
    order = np.lexsort((row, end, start))
    row, start, end = row[order], start[order], end[order]
    follows = (np.diff(start) == 0) & (np.diff(end) == 0) & (np.diff(row) == 1)
    first = np.flatnonzero(np.concatenate([[True], ~follows])) if len(row) else row
    last = np.append(first[1:], len(row)) - 1 if len(row) else row
    return np.stack([start[first], row[first], end[first], row[last] + 1], axis=1)


def _outlines(cells: Mask, labels: NDArray[np.signedinteger[Any]]) -> NDArray[Any]:
    """Return the outline of each region, in the order of the labels.

    The borders between cells of the set and others, cut only where they turn, are put together
    to the faces of the plane; a face is a region where the cell in its lowest left corner is.
    """
    padded = np.pad(cells, 1)
    level = padded[1:, 1:-1] != padded[:-1, 1:-1]  # (rows + 1, columns)
    upright = padded[1:-1, 1:] != padded[1:-1, :-1]  # (rows, columns + 1)
    borders = np.concatenate(
        [_straights(level, upright), _straights(upright.T, level.T)[..., ::-1]]
    )
    lines = np.asarray(shapely.linestrings(borders.astype(float)))
    faces = shapely.get_parts(shapely.polygonize(lines))
    points, face = shapely.get_coordinates(shapely.get_exterior_ring(faces), return_index=True)
    order = np.lexsort((points[:, 1], points[:, 0], face))
    lowest = order[np.flatnonzero(np.diff(face[order], prepend=-1))]
    corner = points[lowest].astype(np.int64)  # (F, 2)
    label = labels[corner[:, 1], corner[:, 0]]
    return np.asarray(faces[label > 0][np.argsort(label[label > 0])])


def _straights(border: Mask, crossing: Mask) -> Lines:
    """Return the straight stretches of borders that run along the rows of grid lines.

    Args:
        border: Whether there is border between grid points k and k + 1 of each grid line, shape
            (lines, K).
        crossing: Whether there is border between each grid line and the next one at each grid
            point, shape (lines - 1, K + 1). A stretch ends where border crosses it.

    Returns:
        Both ends of each stretch as (point, line), shape (S, 2, 2).
    """
    crossing = np.pad(crossing, ((1, 1), (0, 0)))
    corner = crossing[1:] | crossing[:-1]  # (lines, K + 1)
    framed = np.pad(border, ((0, 0), (1, 1)))
    line, start = np.nonzero(border & (~framed[:, :-2] | corner[:, :-1]))
    end = np.nonzero(border & (~framed[:, 2:] | corner[:, 1:]))[1] + 1
    ends = np.stack([np.stack([start, line], axis=1), np.stack([end, line], axis=1)], axis=1)
    return np.asarray(ends)
