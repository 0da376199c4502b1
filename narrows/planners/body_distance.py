"""Signed distances of a body at many poses from convex pieces, with the axes that show them.

The widest gap along a normal of an edge, of the body or of the solid, is minus the depth where the
two overlap (separating axis theorem), and the distance where a corner that is nearest along it
lies beside that edge: were the distance between an edge and a corner, its normal would have the
widest gap. Else two corners face each other. The edges' normals are worked out once.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from functools import lru_cache
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from narrows.geometry import edge_normals
from narrows.se2 import Array
from narrows.vehicle import Layer
from narrows.world import ConvexPieces

_BESIDE = 1e-9  # m: a corner this far beyond an edge's end counts as beside it
_EVEN = 1e-9  # m: corners as near along an axis as this are equally near


class Measured(NamedTuple):
    """Distances of N pairs of a pose and a piece.

    Attributes:
        distance: Signed distance, shape (N,), [m].
        axis: Unit vector from body to solid, world frame, shape (N, 2).
        in_world: Whether the axis stays with the solid when the body turns: the normal of an edge
            of the solid, or from corner to corner; shape (N,).
        between_corners: Distance of the two corners that face each other, infinite where a corner
            faces an edge or the two overlap; shape (N,), [m].
    """

    distance: Array
    axis: Array
    in_world: NDArray[np.bool_]
    between_corners: Array

    def take(self, rows: NDArray[np.int64]) -> Measured:
        """Return some of the pairs."""
        columns: tuple[Any, ...] = self
        return Measured(*(values[rows] for values in columns))

    def and_also(self, other: Measured) -> Measured:
        """Return the pairs of both."""
        pairs: Iterable[tuple[Any, Any]] = zip(self, other, strict=True)
        return Measured(*(np.concatenate(pair) for pair in pairs))


@dataclass(frozen=True, eq=False)
class BodyDistance:
    """One convex body and the pieces it can meet.

    Attributes:
        body: Corners in the body frame, counter-clockwise, shape (A, 2), [m].
        pieces: The pieces.
        own: Outward normals of the body's edges, shape (A, 2).
        normals: Outward normals of the pieces' edges, shape (P, B, 2).
        offsets: Distance of the body's edges from its origin, shape (A,), [m].
        reach: Where along itself each edge begins and ends, shape (A, 2), [m].
        missing: 0, or -inf for an edge of no length, shape (P, B).
        radius: Distance of the body's furthest corner from its origin [m].
    """

    body: Array
    pieces: ConvexPieces
    own: Array
    normals: Array
    offsets: Array
    reach: Array
    missing: Array
    radius: float

    @staticmethod
    @lru_cache(maxsize=64)
    def of(layer: Layer, pieces: ConvexPieces) -> BodyDistance:
        """Return the distances of a layer of a vehicle, worked out at the first call."""
        normals, body = edge_normals(pieces.corners), layer.polygon
        own = edge_normals(body)
        ends = np.stack([body, np.roll(body, -1, axis=0)], axis=1)  # (A, 2, 2)
        return BodyDistance(
            body,
            pieces,
            own,
            normals,
            np.einsum("ak,ak->a", own, body),
            own[:, None, 0] * ends[..., 1] - own[:, None, 1] * ends[..., 0],
            np.where(normals.any(axis=2), 0.0, -np.inf),
            float(np.linalg.norm(body, axis=1).max()),
        )

    def measure(self, poses: Array, piece: NDArray[np.int64], horizon: float) -> Measured:
        """Return the distances of poses (N, 3) from pieces (N,).

        Those that are more than the horizon [m] may be given as less than they are, but for more
        than the horizon.
        """
        cosine, sine = np.cos(poses[:, 2])[:, None], np.sin(poses[:, 2])[:, None]
        grown = self.pieces.radius[piece]
        away = self.pieces.corners[piece] - poses[:, None, :2]
        solid = _turned(away, cosine, sine)  # (N, B) each: the solid as the body sees it
        normals = self.normals[piece]
        facing = _turned(normals, cosine, sine)
        body = self._body_edges(solid)
        side = self._solid_edges(solid, facing, self.missing[piece])
        in_world = side.gap >= body.gap
        distance = np.where(in_world, side.gap, body.gap)
        beside = np.where(in_world, side.is_beside, body.is_beside)
        x, y = self.own[body.edge].T
        own = np.stack([cosine[:, 0] * x - sine[:, 0] * y, sine[:, 0] * x + cosine[:, 0] * y], 1)
        axis = np.where(in_world[:, None], -normals[np.arange(len(piece)), side.edge], own)
        between = np.full(len(piece), np.inf)
        facing_corners = np.flatnonzero(~beside & (distance > 0.0) & (distance - grown < horizon))
        if len(facing_corners):
            rows = facing_corners
            x = solid[0][rows, :, None] - self.body[:, 0]
            y = solid[1][rows, :, None] - self.body[:, 1]
            squared = (x * x + y * y).reshape(len(rows), -1)
            nearest = squared.argmin(axis=1)
            first = np.arange(len(rows))
            apart = np.sqrt(squared[first, nearest])
            x = x.reshape(len(rows), -1)[first, nearest] / apart
            y = y.reshape(len(rows), -1)[first, nearest] / apart
            c, s = cosine[rows, 0], sine[rows, 0]
            distance[rows] = between[rows] = apart
            axis[rows, 0], axis[rows, 1] = c * x - s * y, s * x + c * y
            in_world[rows] = True
        return Measured(distance - grown, axis, in_world, between)

    def _body_edges(self, solid: tuple[Array, Array]) -> _Widest:
        """Return the widest gap along a normal of the body, solids given in its frame."""
        x, y = solid[0][:, :, None], solid[1][:, :, None]
        along = x * self.own[:, 0] + y * self.own[:, 1]  # (N, B, A)
        least = along.min(axis=1)
        gap = least - self.offsets
        edge = gap.argmax(axis=1)
        rows = np.arange(len(edge))
        deepest = along[rows, :, edge] <= least[rows, edge][:, None] + _EVEN
        normal = self.own[edge]
        across = normal[:, :1] * solid[1] - normal[:, 1:] * solid[0]
        low, high = self.reach[edge].T
        return _Widest(gap[rows, edge], edge, _overlaps(across, deepest, low, high))

    def _solid_edges(
        self, solid: tuple[Array, Array], facing: tuple[Array, Array], missing: Array
    ) -> _Widest:
        """Return the widest gap along a normal of the solids, as the body sees them."""
        n_x, n_y = facing
        along = n_x[:, :, None] * self.body[:, 0] + n_y[:, :, None] * self.body[:, 1]  # (N, B, A)
        least = along.min(axis=2)
        gap = least - n_x * solid[0] - n_y * solid[1] + missing
        edge = gap.argmax(axis=1)
        rows = np.arange(len(edge))
        deepest = along[rows, edge] <= least[rows, edge][:, None] + _EVEN
        x, y = n_x[rows, edge], n_y[rows, edge]
        following = (edge + 1) % n_x.shape[1]
        low = x * solid[1][rows, edge] - y * solid[0][rows, edge]
        high = x * solid[1][rows, following] - y * solid[0][rows, following]
        across = x[:, None] * self.body[:, 1] - y[:, None] * self.body[:, 0]
        return _Widest(gap[rows, edge], edge, _overlaps(across, deepest, low, high))


class _Widest(NamedTuple):
    """The widest gap along the normals of one side's edges, N times.

    Attributes:
        gap: How wide, shape (N,), [m].
        edge: Along which edge's normal, shape (N,).
        is_beside: Whether a corner that is nearest along it lies beside the edge, shape (N,).
    """

    gap: Array
    edge: NDArray[np.int64]
    is_beside: NDArray[np.bool_]


def _overlaps(
    across: Array, deepest: NDArray[np.bool_], low: Array, high: Array
) -> NDArray[np.bool_]:
    """Return whether the span of the deepest of places (N, K) meets the span low to high (N,)."""
    first = np.where(deepest, across, np.inf).min(axis=1)
    last = np.where(deepest, across, -np.inf).max(axis=1)
    return np.asarray((first <= high + _BESIDE) & (last >= low - _BESIDE))


def _turned(vectors: Array, cosine: Array, sine: Array) -> tuple[Array, Array]:
    """Return x and y of vectors (N, K, 2) turned by minus the angle of cosine and sine (N, 1)."""
    x, y = vectors[..., 0], vectors[..., 1]
    return cosine * x + sine * y, cosine * y - sine * x
