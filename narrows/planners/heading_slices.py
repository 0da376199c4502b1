"""Where a body's pivot may stand at given headings: the plane minus obstacles grown by the body.

For a heading, or a heading interval, every convex piece of the obstacles is summed with the
mirrored body (Minkowski), the sums are united, and the parts of what is left are the free cells.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import shapely
from numpy.typing import NDArray

from ..se2 import Array
from .swept_body import TurningBody

CIRCLE_TOLERANCE = 1e-4  # a circle's polygon strays from it by at most this [m]


@dataclass(frozen=True, eq=False)
class ObstaclePieces:
    """Convex polygons one body must not meet, circles bracketed by polygons.

    Attributes:
        inside: Corners counter-clockwise of polygons inside the solids, (P, K, 2), [m]; short
            ones repeat their last corner.
        around: Polygons that hold the solids, shape (P, K, 2), [m]; the same ones but for
            circles.
    """

    inside: Array
    around: Array

    @classmethod
    def bracket(cls, corners: Array, radius: Array) -> ObstaclePieces:
        """Return the pieces of convex corners (P, K, 2), each grown by a radius (P,), [m]."""
        round_ones = radius > 0.0
        if not round_ones.any():
            return cls(corners, corners)
        count = _polygon_order(float(radius.max()))
        unit = 2.0 * np.pi * np.arange(count) / count
        ring = np.stack([np.cos(unit), np.sin(unit)], axis=-1)  # (C, 2)
        # The outer polygon touches the circle in the middle of its edges.
        apex = unit + np.pi / count
        outer = np.stack([np.cos(apex), np.sin(apex)], axis=-1) / math.cos(np.pi / count)
        both = []
        for shape in (ring, outer):
            grown = np.zeros((len(corners), max(count, corners.shape[1]), 2))
            grown[:, : corners.shape[1]] = corners
            grown[:, corners.shape[1] :] = corners[:, -1:]
            centre = corners[round_ones, :1]
            grown[round_ones, :count] = centre + radius[round_ones, None, None] * shape
            grown[round_ones, count:] = grown[round_ones, count - 1 : count]
            both.append(grown)
        return cls(both[0], both[1])

    def near(self, box: Array, reach: float) -> ObstaclePieces:
        """Return the pieces whose box comes within `reach` of a box [x0, y0, x1, y1], [m]."""
        low, high = self.around.min(axis=1), self.around.max(axis=1)
        keep = ((low <= box[2:] + reach) & (high >= box[:2] - reach)).all(axis=1)
        return ObstaclePieces(self.inside[keep], self.around[keep])


def _polygon_order(radius: float) -> int:
    sharp = math.acos(max(0.0, 1.0 - CIRCLE_TOLERANCE / max(radius, 2.0 * CIRCLE_TOLERANCE)))
    return max(8, math.ceil(math.pi / sharp))


def minkowski_sums(first: Array, second: Array) -> Array:
    """Return the Minkowski sum of every convex polygon of one block with each of another.

    Edges of both are merged by direction from the lowest corner on.

    Args:
        first: Counter-clockwise corners, shape (A, K, 2), [m]; corners may repeat.
        second: The same, shape (B, M, 2), [m].

    Returns:
        Corners counter-clockwise, shape (A, B, K + M, 2), [m].
    """
    base_first, edges_first, angles_first = _edges_from_lowest(first)
    base_second, edges_second, angles_second = _edges_from_lowest(second)
    a, b = len(first), len(second)
    k, m = first.shape[1], second.shape[1]
    edges = np.empty((a, b, k + m, 2))
    edges[:, :, :k], edges[:, :, k:] = edges_first[:, None], edges_second[None]
    angles = np.empty((a, b, k + m))
    angles[:, :, :k], angles[:, :, k:] = angles_first[:, None], angles_second[None]
    order = angles.argsort(axis=-1, kind="stable")
    steps = np.take_along_axis(edges, order[..., None], axis=2)
    corners = np.cumsum(steps, axis=2) - steps  # start of each edge
    return np.asarray(corners + (base_first[:, None] + base_second[None])[:, :, None])


def _edges_from_lowest(polygons: Array) -> tuple[Array, Array, Array]:
    lowest = np.lexsort((polygons[..., 0], polygons[..., 1]), axis=-1)[:, 0]
    base = polygons[np.arange(len(polygons)), lowest]
    edges = np.roll(polygons, -1, axis=1) - polygons
    angles = np.mod(np.arctan2(edges[..., 1], edges[..., 0]), 2.0 * np.pi)
    return base, edges, angles


def pack(polygons: Sequence[Array]) -> Array:
    """Return polygons of different corner counts as one block (N, K, 2), the last repeated."""
    most = max(len(p) for p in polygons)
    return np.stack(
        [np.concatenate([p, np.repeat(p[-1:], most - len(p), axis=0)]) for p in polygons]
    )


def free_cells(
    bodies: Sequence[Sequence[Array | None]],
    pieces: Sequence[Array],
    box: Array,
    reach_box: Array | None,
) -> tuple[NDArray[np.object_], NDArray[np.int64]]:
    """Return the free cells of the pivot for many placements of the body.

    Args:
        bodies: For each placement, the convex polygon of each layer about the pivot and turned
            to its heading, shape (K, 2), [m]; None: the layer blocks nothing.
        pieces: For each layer the obstacle pieces it can meet, shape (P, C, 2), [m].
        box: x0, y0, x1, y1 the pivot is looked for in [m].
        reach_box: Bounds the whole body must stay in [m], or None.

    Returns:
        The cells, polygons in a flat array (C,), and the placement of each, shape (C,).
    """
    sums = [_sums_of_layer([b[i] for b in bodies], pieces[i]) for i in range(len(pieces))]
    together = np.concatenate(sums, axis=1) if sums else np.empty((len(bodies), 0), dtype=object)
    room = _rooms(bodies, box, reach_box)
    free = _without(room, together) if together.shape[1] else room
    parts, owner = shapely.get_parts(free, return_index=True)
    keep = shapely.area(parts) > 0.0
    return parts[keep], owner[keep].astype(np.int64)


def _without(room: NDArray[np.object_], blocked: NDArray[np.object_]) -> NDArray[np.object_]:
    """Return each room (I,) less all its blocked areas (I, P)."""
    try:
        free = shapely.difference(room, shapely.union_all(blocked, axis=1))
    except shapely.GEOSException:
        # Snapping to a grid always succeeds, at four times the cost; 1e-8 m is far below the
        # allowance for rounding (`heading_graph.EPSILON`).
        union = shapely.union_all(blocked, axis=1, grid_size=1e-8)
        free = shapely.difference(room, union, grid_size=1e-8)
    return np.asarray(free, dtype=object)


def _sums_of_layer(bodies: Sequence[Array | None], pieces: Array) -> NDArray[np.object_]:
    grown: NDArray[np.object_] = np.full((len(bodies), len(pieces)), None, dtype=object)
    there = [i for i, body in enumerate(bodies) if body is not None]
    if there and len(pieces):
        block = -pack([body for body in bodies if body is not None])
        grown[there] = shapely.polygons(minkowski_sums(block, pieces))
    return grown


def _rooms(
    bodies: Sequence[Sequence[Array | None]], box: Array, reach_box: Array | None
) -> NDArray[np.object_]:
    rooms = np.tile(box, (len(bodies), 1))
    if reach_box is not None:
        for row, layers in enumerate(bodies):
            corners = [layer for layer in layers if layer is not None]
            if corners:
                points = np.concatenate(corners)
                rooms[row, :2] = np.maximum(rooms[row, :2], reach_box[:2] - points.min(axis=0))
                rooms[row, 2:] = np.minimum(rooms[row, 2:], reach_box[2:] - points.max(axis=0))
    cells: NDArray[np.object_] = np.asarray(shapely.box(*rooms.T), dtype=object)
    cells[(rooms[:, 2:] <= rooms[:, :2]).any(axis=1)] = shapely.Polygon()
    return cells


def turned_layers(
    layers: Sequence[TurningBody], heading: float, half_angle: float, *, cover: bool
) -> list[Array | None]:
    """Return each layer's sweep (`cover`) or core over heading +- half_angle, (K, 2), [m]."""
    c, s = math.cos(heading), math.sin(heading)
    turn = np.array([[c, s], [-s, c]])
    shapes = [b.sweep(half_angle) if cover else b.core(half_angle) for b in layers]
    return [None if shape is None else shape @ turn for shape in shapes]
