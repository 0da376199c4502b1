"""What a turning convex body surely covers, and what it covers at most, over a heading interval.

Two convex polygons bracket the body while its heading runs through an interval about a pivot:
the *core*, inside the body at every heading of the interval, and the *sweep*, which holds the
body at every heading. Obstacles grown by the core leave every place that could be free;
obstacles grown by the sweep leave only places that surely are.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field

import numpy as np

from ..geometry import convex_polygon, edge_normals
from ..se2 import Array

_WIDE = 0.25 * math.pi  # half angles beyond this are treated as a full turn
_SIDES = 32  # of the polygons that stand for discs
_FAR = 1e3  # half side of the square that half planes are cut from [m]


def cut_by_half_planes(normals: Array, offsets: Array) -> Array | None:
    """Return the convex polygon {x : normals x <= offsets}, or None where it is empty.

    >>> corners = cut_by_half_planes(np.array([[0.0, 1.0], [-1, 0], [0.6, -0.8]]), np.ones(3))
    >>> sorted(corners.round(9).tolist())
    [[-1.0, -2.0], [-1.0, 1.0], [3.0, 1.0]]

    Args:
        normals: Outward unit normals, shape (K, 2).
        offsets: Signed distance of each line from the origin, shape (K,), [m].

    Returns:
        Corners counter-clockwise, shape (M, 2), [m].
    """
    corners = [(-_FAR, -_FAR), (_FAR, -_FAR), (_FAR, _FAR), (-_FAR, _FAR)]
    for (nx, ny), offset in zip(normals.tolist(), offsets.tolist(), strict=True):
        depth = [nx * x + ny * y - offset for x, y in corners]
        kept: list[tuple[float, float]] = []
        for i, here in enumerate(depth):
            before = depth[i - 1]
            if (here <= 0.0) != (before <= 0.0):
                share = before / (before - here)
                (x0, y0), (x1, y1) = corners[i - 1], corners[i]
                kept.append((x0 + share * (x1 - x0), y0 + share * (y1 - y0)))
            if here <= 0.0:
                kept.append(corners[i])
        corners = kept
        if len(corners) < 3:
            return None
    return np.array(corners)


def convex_hull(points: Array) -> Array:
    """Return the corners of the convex hull counter-clockwise, shape (M, 2), of (N, 2) points."""
    order = sorted({(float(x), float(y)) for x, y in points})
    chains: list[list[tuple[float, float]]] = []
    for run in (order, order[::-1]):
        chain: list[tuple[float, float]] = []
        for p in run:
            while len(chain) > 1 and _turn(chain[-2], chain[-1], p) <= 0.0:
                chain.pop()
            chain.append(p)
        chains.append(chain[:-1])
    return np.array(chains[0] + chains[1])


def _turn(a: tuple[float, float], b: tuple[float, float], c: tuple[float, float]) -> float:
    return (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])


@dataclass(frozen=True, eq=False)
class TurningBody:
    """A convex body about a pivot, each edge moved outward by a growth.

    Attributes:
        normals: Outward unit normals of the edges, shape (K, 2).
        offsets: Distance of each edge's line from the pivot, growth included, shape (K,), [m].
    """

    normals: Array
    offsets: Array
    _cores: dict[float, Array | None] = field(default_factory=dict, init=False, repr=False)
    _sweeps: dict[float, Array | None] = field(default_factory=dict, init=False, repr=False)

    @classmethod
    def about(cls, pivot: Array, polygon: Array, growth: float = 0.0) -> TurningBody:
        """Return the body of a polygon (K, 2) in the body frame, about a point of that frame."""
        corners = convex_polygon(polygon) - pivot
        normals = edge_normals(corners)
        return cls(normals, np.einsum("kc,kc->k", normals, corners) + growth)

    def grown(self, growth: float) -> TurningBody:
        """Return the body with every edge moved outward by `growth` [m], corners mitred."""
        return TurningBody(self.normals, self.offsets + growth)

    @property
    def corners(self) -> Array | None:
        """Corners about the pivot, shape (M, 2), [m]; None where shrinking left nothing."""
        return self.core(0.0)

    def core(self, half_angle: float) -> Array | None:
        """Return a polygon inside the body at every heading within +-half_angle, or None.

        An edge at distance h turned through the interval envelops an arc of radius h. Its two
        end positions and, for h > 0, the chord between their contact points cut off everything
        the arc does: the polygon lies inside the exact intersection, and misses no more than
        h (1 - cos half_angle) of it. Over half a turn and more it is a disc's polygon.

        Args:
            half_angle: Half the width of the heading interval, from 0 [rad].
        """
        if half_angle not in self._cores:
            if half_angle == 0.0:
                normals, offsets = self.normals, self.offsets
            elif half_angle > _WIDE:
                normals, offsets = _disc(float(self.offsets.min()) * math.cos(math.pi / _SIDES))
            else:
                turned = [_turned(self.normals, a) for a in (-half_angle, 0.0, half_angle)]
                chord = self.offsets * math.cos(half_angle)
                normals = np.concatenate(turned)
                offsets = np.concatenate([self.offsets, chord, self.offsets])
            self._cores[half_angle] = cut_by_half_planes(normals, offsets)
        return self._cores[half_angle]

    def sweep(self, half_angle: float) -> Array | None:
        """Return a convex polygon around the body at every heading within +-half_angle.

        Each corner's arc is held by its two ends and the crossing of the tangents there. Over
        half a turn and more it is a disc's polygon.

        Args:
            half_angle: Half the width of the heading interval, from 0 [rad].
        """
        if half_angle not in self._sweeps:
            corners = self.corners
            if corners is None or half_angle == 0.0:
                swept = corners
            elif half_angle > _WIDE:
                swept = cut_by_half_planes(*_disc(float(np.hypot(*corners.T).max())))
            else:
                ends = [_turned(corners, a) for a in (-half_angle, half_angle)]
                swept = convex_hull(np.concatenate([*ends, corners / math.cos(half_angle)]))
            self._sweeps[half_angle] = swept
        return self._sweeps[half_angle]


def _disc(radius: float) -> tuple[Array, Array]:
    """Return the half planes of a regular polygon whose sides are `radius` from its middle."""
    angle = 2.0 * np.pi * np.arange(_SIDES) / _SIDES
    return np.stack([np.cos(angle), np.sin(angle)], axis=-1), np.full(_SIDES, radius)


def _turned(vectors: Array, angle: float) -> Array:
    c, s = math.cos(angle), math.sin(angle)
    return np.asarray(vectors @ np.array([[c, s], [-s, c]]))
