"""Triangle meshes of extruded areas: walls, furniture, bodies, swept floors."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass

import numpy as np
import shapely
from numpy.typing import ArrayLike, NDArray

from narrows.geometry import convex_pieces
from narrows.se2 import Array
from narrows.world import Solid

_ROUND = 32  # corners of a circle


@dataclass(frozen=True, eq=False)
class Mesh:
    """Triangles.

    Attributes:
        vertices: Corners, shape (N, 3), [m].
        faces: Rows of three corners, counter-clockwise seen from outside, shape (M, 3).
    """

    vertices: Array
    faces: NDArray[np.int64]


def joined(meshes: Iterable[Mesh]) -> Mesh:
    """Return several meshes as one."""
    parts = list(meshes)
    starts = np.cumsum([0, *(len(part.vertices) for part in parts)])
    return Mesh(
        np.concatenate([np.zeros((0, 3)), *(part.vertices for part in parts)]),
        np.concatenate(
            [
                np.zeros((0, 3), dtype=np.int64),
                *(part.faces + start for part, start in zip(parts, starts, strict=False)),
            ]
        ),
    )


def solid_mesh(solid: Solid, low: float, high: float) -> Mesh:
    """Return a solid between two heights [m]."""
    if isinstance(solid.shape, shapely.Point):
        disc = solid.shape.buffer(solid.radius, quad_segs=_ROUND // 4)
        return area_mesh(disc, low, high)
    return area_mesh(solid.shape, low, high, solid.pieces)


def area_mesh(
    area: shapely.Polygon | shapely.MultiPolygon,
    low: float,
    high: float,
    pieces: Sequence[Array] | None = None,
) -> Mesh:
    """Return an area extruded between two heights [m].

    >>> mesh = area_mesh(shapely.box(0, 0, 1, 2), 0.0, 3.0)
    >>> mesh.vertices.max(axis=0)
    array([1., 2., 3.])

    Args:
        area: What is seen from above.
        low: Underside.
        high: Top.
        pieces: Convex polygons (K, 2), counter-clockwise, whose union is the area; default: found.
    """
    polygons = shapely.get_parts(area).tolist()
    if pieces is None:
        pieces = [piece for polygon in polygons for piece in convex_pieces(polygon)]
    parts = [_cap(piece, high, up=True) for piece in pieces]
    parts += [_cap(piece, low, up=False) for piece in pieces]
    for polygon in polygons:
        turned = shapely.geometry.polygon.orient(polygon)  # outside to the right of every ring
        for ring in (turned.exterior, *turned.interiors):
            parts.append(_sides(np.array(ring.coords), low, high))
    return joined(parts)


def flat_mesh(area: shapely.Polygon | shapely.MultiPolygon, height: float) -> Mesh:
    """Return an area at one height [m], seen from above."""
    triangles = shapely.get_parts(shapely.constrained_delaunay_triangles(area))
    corners = shapely.get_coordinates([shapely.orient_polygons(t) for t in triangles])
    corners = corners.reshape(-1, 4, 2)[:, :3].reshape(-1, 2)
    vertices = np.column_stack([corners, np.full(len(corners), height)])
    return Mesh(vertices, np.arange(len(corners), dtype=np.int64).reshape(-1, 3))


def box_mesh(low: ArrayLike, high: ArrayLike) -> Mesh:
    """Return the box between two corners (3,), [m]."""
    (x0, y0, z0), (x1, y1, z1) = np.asarray(low).tolist(), np.asarray(high).tolist()
    corners = np.array([[x0, y0], [x1, y0], [x1, y1], [x0, y1]])
    closed = np.concatenate([corners, corners[:1]])
    caps = [_cap(corners, z1, up=True), _cap(corners, z0, up=False)]
    return joined([*caps, _sides(closed, z0, z1)])


def wheel_mesh(center: ArrayLike, radius: float, thickness: float, corners: int = 24) -> Mesh:
    """Return a disc that stands and rolls along x, about its centre (3,), [m]."""
    angle = np.linspace(0.0, 2.0 * np.pi, corners, endpoint=False)
    ring = radius * np.column_stack([np.cos(angle), np.sin(angle)])
    lying = area_mesh(shapely.Polygon(ring), -0.5 * thickness, 0.5 * thickness, [ring])
    standing = lying.vertices[:, [0, 2, 1]] * [1.0, -1.0, 1.0]  # a turn about x: stays outside out
    return Mesh(standing + np.asarray(center), lying.faces)


def ball_mesh(center: ArrayLike, radius: float, rings: int = 8) -> Mesh:
    """Return a ball about its centre (3,), [m]."""
    around = 2 * rings
    polar = np.linspace(0.0, np.pi, rings + 1)
    angle = np.linspace(0.0, 2.0 * np.pi, around, endpoint=False)
    x = np.sin(polar)[:, None] * np.cos(angle)
    y = np.sin(polar)[:, None] * np.sin(angle)
    z = np.repeat(np.cos(polar)[:, None], around, axis=1)
    vertices = radius * np.stack([x, y, z], axis=-1).reshape(-1, 3)
    row, column = np.divmod(np.arange(rings * around), around)
    here, beside = row * around + column, row * around + (column + 1) % around
    faces = np.concatenate(
        [
            np.column_stack([here, here + around, beside]),
            np.column_stack([beside, here + around, beside + around]),
        ]
    )
    return Mesh(vertices + np.asarray(center), faces)


def edges_of(corners: Array, low: float, high: float) -> Array:
    """Return the edges of a prism as segments, shape (S, 2, 3), [m]."""
    count = len(corners)
    bottom = np.column_stack([corners, np.full(count, low)])
    top = np.column_stack([corners, np.full(count, high)])
    around = [np.stack([ring, np.roll(ring, -1, axis=0)], axis=1) for ring in (bottom, top)]
    return np.concatenate([*around, np.stack([bottom, top], axis=1)])


def _cap(corners: Array, height: float, *, up: bool) -> Mesh:
    """Return a convex polygon at a height as a fan."""
    count = len(corners)
    vertices = np.column_stack([corners, np.full(count, height)])
    second = np.arange(1, count - 1)
    fan = np.column_stack([np.zeros_like(second), second, second + 1])
    return Mesh(vertices, fan if up else fan[:, ::-1])


def _sides(ring: Array, low: float, high: float) -> Mesh:
    """Return the walls over a closed ring, (K + 1, 2), that has the inside to its left."""
    count = len(ring) - 1
    bottom = np.column_stack([ring, np.full(count + 1, low)])
    top = np.column_stack([ring, np.full(count + 1, high)])
    here = np.arange(count)
    over = here + count + 1
    faces = np.concatenate(
        [
            np.column_stack([here, here + 1, over + 1]),
            np.column_stack([here, over + 1, over]),
        ]
    )
    return Mesh(np.concatenate([bottom, top]), faces)
