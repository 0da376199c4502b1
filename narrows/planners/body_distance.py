"""Signed distances of a body at many poses from convex pieces, with the axes that show them.

The widest gap along a normal of an edge, of the body or of the solid, is the distance where the
corner it is measured to lies beside that edge, and minus the depth where the two overlap
(separating axis theorem); else two corners face each other, and every corner is measured to every
edge. The edges' normals are worked out once.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from functools import lru_cache
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from narrows.geometry import edge_normals, separation
from narrows.se2 import Array, transform
from narrows.vehicle import Layer
from narrows.world import ConvexPieces

_BESIDE = 1e-9  # m: a corner this far beyond an edge's end counts as beside it


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
        missing: 0, or -inf for an edge of no length, shape (P, B).
        radius: Distance of the body's furthest corner from its origin [m].
    """

    body: Array
    pieces: ConvexPieces
    own: Array
    normals: Array
    missing: Array
    radius: float

    @staticmethod
    @lru_cache(maxsize=64)
    def of(layer: Layer, pieces: ConvexPieces) -> BodyDistance:
        """Return the distances of a layer of a vehicle, worked out at the first call."""
        normals = edge_normals(pieces.corners)
        return BodyDistance(
            layer.polygon,
            pieces,
            edge_normals(layer.polygon),
            normals,
            np.where(normals.any(axis=2), 0.0, -np.inf),
            float(np.linalg.norm(layer.polygon, axis=1).max()),
        )

    def measure(self, poses: Array, piece: NDArray[np.int64], horizon: float) -> Measured:
        """Return the distances of poses (N, 3) from pieces (N,).

        Those that are more than the horizon [m] may be given as less than they are, but for more
        than the horizon.
        """
        rows = np.arange(len(piece))
        cosine, sine = np.cos(poses[:, 2]), np.sin(poses[:, 2])
        away = self.pieces.corners[piece] - poses[:, None, :2]
        solid = _turned(away, cosine, sine)  # (N, B) each: the solid as the body sees it
        facing = _turned(self.normals[piece], cosine, sine)
        mine = solid[0][:, :, None] * self.own[:, 0] + solid[1][:, :, None] * self.own[:, 1]
        gap = mine.min(axis=1) - np.einsum("ak,ak->a", self.own, self.body)
        edge = gap.argmax(axis=1)
        body_gap = gap[rows, edge]
        theirs = facing[0][:, :, None] * self.body[:, 0] + facing[1][:, :, None] * self.body[:, 1]
        gap = theirs.min(axis=2) - facing[0] * solid[0] - facing[1] * solid[1]
        side = (gap + self.missing[piece]).argmax(axis=1)
        solid_gap = gap[rows, side] + self.missing[piece, side]
        in_world = solid_gap >= body_gap
        distance = np.maximum(solid_gap, body_gap)
        own = self.own[edge]
        axis = np.where(
            in_world[:, None],
            -self.normals[piece, side],
            np.stack(_turned(own[:, None], cosine, -sine), axis=-1)[:, 0],
        )
        beside = np.where(
            in_world,
            self._is_beside_solid(solid, facing, side, theirs[rows, side].argmin(axis=1)),
            self._is_beside_body(solid, edge, mine[rows, :, edge].argmin(axis=1)),
        )
        check = ~beside & (distance > 0.0) & (distance - self.pieces.radius[piece] < horizon)
        between = np.flatnonzero(check)
        between_corners = np.full(len(piece), np.inf)
        if len(between):
            exact = separation(
                transform(poses[between], self.body), self.pieces.corners[piece[between]]
            )
            further = exact.distance > distance[between] + _BESIDE
            corners = between[further]
            distance[corners], axis[corners] = exact.distance[further], exact.axis[further]
            in_world[corners] = True
            between_corners[corners] = exact.distance[further]
        return Measured(distance - self.pieces.radius[piece], axis, in_world, between_corners)

    def _is_beside_body(
        self, solid: tuple[Array, Array], edge: NDArray[np.int64], corner: NDArray[np.int64]
    ) -> NDArray[np.bool_]:
        """Return whether a solid's corner lies between the ends of an edge of the body."""
        rows = np.arange(len(edge))
        x, y = solid[0][rows, corner], solid[1][rows, corner]
        normal, first = self.own[edge], self.body[edge]
        last = self.body[(edge + 1) % len(self.body)]
        along = -normal[:, 1] * (x - first[:, 0]) + normal[:, 0] * (y - first[:, 1])
        beyond = -normal[:, 1] * (x - last[:, 0]) + normal[:, 0] * (y - last[:, 1])
        return np.asarray((along >= -_BESIDE) & (beyond <= _BESIDE))

    def _is_beside_solid(
        self,
        solid: tuple[Array, Array],
        facing: tuple[Array, Array],
        side: NDArray[np.int64],
        corner: NDArray[np.int64],
    ) -> NDArray[np.bool_]:
        """Return whether a corner of the body lies between the ends of a solid's edge."""
        rows = np.arange(len(side))
        following = (side + 1) % self.normals.shape[1]
        x, y = self.body[corner].T
        n_x, n_y = facing[0][rows, side], facing[1][rows, side]
        along = -n_y * (x - solid[0][rows, side]) + n_x * (y - solid[1][rows, side])
        beyond = -n_y * (x - solid[0][rows, following]) + n_x * (y - solid[1][rows, following])
        return np.asarray((along >= -_BESIDE) & (beyond <= _BESIDE))


def _turned(vectors: Array, cosine: Array, sine: Array) -> tuple[Array, Array]:
    """Return x and y of vectors (N, K, 2) turned by minus the angle of cosine and sine (N,)."""
    x, y = vectors[..., 0], vectors[..., 1]
    cosine, sine = cosine[:, None], sine[:, None]
    return cosine * x + sine * y, cosine * y - sine * x
