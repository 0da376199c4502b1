"""Rows that keep the body clear along a horizon: one separating axis per pose and near solid."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ..geometry import separation
from ..se2 import Array, transform
from ..vehicle import Vehicle
from ..world import World

PIECES = 2
"""Nearest convex pieces looked at, per pose."""

VERTICES = 2
"""Corners of the body held back from each: two, so that it cannot swing the other one in."""

ROWS_PER_POSE = PIECES * VERTICES


@dataclass(frozen=True, eq=False)
class _Layer:
    """A slab of the body and the solids at its heights."""

    polygon: Array  # (K, 2), body frame
    corners: Array  # (P, C, 2)
    radius: Array  # (P,)
    low: Array  # (P, 2)
    high: Array  # (P, 2)


class SeparatingRows:
    """Picks, for poses along a horizon, half-planes the corners of the body must stay behind.

    A row (n, h, v) says n.(p + R(theta) v) <= h for the body origin p: no solid piece lies behind
    the line n.x = h, and v is the corner of the body furthest along n. With n the separating axis
    at the pose given it is exact there and safe nearby; the rows must be picked again as the poses
    move. Solids that stand still only.
    """

    def __init__(self, world: World, vehicle: Vehicle) -> None:
        """Take the solids each layer of the body can meet."""
        self._reach = vehicle.radius
        self._layers = []
        for layer in vehicle.layers:
            pieces = world.pieces_between(*layer.z)
            if len(pieces):
                self._layers.append(
                    _Layer(layer.polygon, pieces.corners, pieces.radius, pieces.low, pieces.high)
                )

    def pick(self, poses: Array, within: float) -> Array:
        """Return rows [n_x, n_y, h, v_x, v_y], shape (N, `ROWS_PER_POSE`, 5), [1, 1, m, m, m].

        A pose with fewer solids near it has rows 0 <= 1.

        Args:
            poses: Poses, shape (N, 3), [m, m, rad].
            within: Solids further from the body than this are left out [m].
        """
        rows = np.zeros((len(poses), ROWS_PER_POSE, 5))
        rows[..., 2] = 1.0
        found = [self._near(layer, poses, within) for layer in self._layers]
        if not found:
            return rows
        gap = np.concatenate([part[0] for part in found])  # (M,)
        pose = np.concatenate([part[1] for part in found])
        row = np.concatenate([part[2] for part in found])  # (M, VERTICES, 5)
        order = np.lexsort((gap, pose))
        starts = np.searchsorted(pose[order], np.arange(len(poses)))
        rank = np.arange(len(order)) - starts[pose[order]]
        kept = order[rank < PIECES]
        place = rank[rank < PIECES]
        for vertex in range(VERTICES):
            rows[pose[kept], VERTICES * place + vertex] = row[kept, vertex]
        return rows

    def _near(
        self, layer: _Layer, poses: Array, within: float
    ) -> tuple[Array, NDArray[np.int64], Array]:
        """Return distance, pose index and rows of each near pair of pose and piece."""
        offset = np.maximum(layer.low - poses[:, None, :2], poses[:, None, :2] - layer.high)
        near = np.hypot(*np.moveaxis(np.maximum(offset, 0.0), -1, 0)) < self._reach + within
        pose, piece = np.nonzero(near)
        if not len(pose):
            return np.empty(0), pose, np.empty((0, VERTICES, 5))
        body = transform(poses[pose], layer.polygon)  # (M, K, 2)
        corners = layer.corners[piece]
        found = separation(body, corners)
        gap = found.distance - layer.radius[piece]
        axis = found.axis
        edge = np.einsum("mk,mck->mc", axis, corners).min(axis=1) - layer.radius[piece]
        reach = np.einsum("mk,mck->mc", axis, body)
        furthest = np.argsort(-reach, axis=1)[:, :VERTICES]  # (M, VERTICES)
        rows = np.empty((len(pose), VERTICES, 5))
        rows[..., :2] = axis[:, None]
        rows[..., 2] = edge[:, None]
        rows[..., 3:] = layer.polygon[furthest]
        close = gap < within
        return gap[close], pose[close], rows[close]
