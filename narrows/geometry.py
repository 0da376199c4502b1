"""Convex polygons: checks, signed distances with their axes, decomposition of the others."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import shapely
from numpy.typing import ArrayLike

from .errors import ShapeError
from .se2 import Array


def convex_polygon(vertices: ArrayLike) -> Array:
    """Return the vertices of a convex polygon counter-clockwise, repeated points removed.

    So are dents of less than 1e-9 of its size, which rounding leaves on straight edges.

    >>> convex_polygon([[0, 0], [0, 1], [1, 1], [1, 0]])
    array([[1., 0.],
           [1., 1.],
           [0., 1.],
           [0., 0.]])

    Args:
        vertices: Corners in order, either way round, not closed, shape (M, 2), [m].

    Returns:
        Corners counter-clockwise, shape (K, 2), 3 <= K <= M, [m].

    Raises:
        ShapeError: If the corners are fewer than three, not finite, of no area, or not convex.
    """
    points = np.array(vertices, dtype=float)
    if points.ndim != 2 or points.shape[1] != 2 or len(points) < 3:
        raise ShapeError(f"a polygon needs at least 3 corners [x, y], got shape {points.shape}")
    if not np.isfinite(points).all():
        raise ShapeError("a polygon's corners must be finite numbers")
    size = float(np.ptp(points, axis=0).max())
    points = points[np.linalg.norm(points - np.roll(points, 1, axis=0), axis=1) > 1e-9 * size]
    if len(points) < 3 or size == 0.0:
        raise ShapeError("a polygon needs at least 3 different corners")
    area = _signed_area(points)
    if abs(area) <= 1e-9 * size**2:
        raise ShapeError("the polygon has no area")
    if area < 0.0:
        points = points[::-1].copy()
    edge = np.roll(points, -1, axis=0) - points
    following = np.roll(edge, -1, axis=0)
    turn = edge[:, 0] * following[:, 1] - edge[:, 1] * following[:, 0]
    total = float(np.sum(np.arctan2(turn, np.sum(edge * following, axis=1))))
    if turn.min() < -1e-9 * size**2 or abs(total - 2.0 * np.pi) > 1e-6:
        raise ShapeError("the polygon is not convex")
    return points if turn.min() >= 0.0 else _without_dents(points, 1e-9 * size)


def _without_dents(points: Array, depth: float) -> Array:
    """Return the convex hull of a counter-clockwise polygon whose dents are a hair deep.

    The sides of the shallowest dent may be steep, and every edge of a convex polygon counts as a
    separating axis: a dent that stays would part the polygon from what overlaps it elsewhere.

    Raises:
        ShapeError: If a dent is deeper than allowed.
    """
    outline = shapely.get_exterior_ring(shapely.MultiPoint(points).convex_hull)
    if (shapely.distance(shapely.points(points), outline) > depth).any():
        raise ShapeError("the polygon is not convex")
    ring = shapely.get_coordinates(outline)[:-1]
    return ring if shapely.is_ccw(outline) else ring[::-1].copy()


def _signed_area(points: Array) -> float:
    """Return the area inside the corners (M, 2), positive if they run counter-clockwise [m^2]."""
    x, y = (points - points[0]).T
    return 0.5 * float(np.sum(x * np.roll(y, -1) - np.roll(x, -1) * y))


def offset_polygon(polygon: Array, distance: float) -> Array:
    """Return a convex polygon with every edge moved outward by a distance, corners mitred.

    >>> offset_polygon(np.array([[0.0, 0], [2, 0], [2, 1], [0, 1]]), -0.25)[0]
    array([0.25, 0.25])

    Args:
        polygon: Counter-clockwise corners, shape (K, 2), [m].
        distance: Outward distance [m]; negative: inward.

    Raises:
        ShapeError: If an edge vanishes on the way inward.
    """
    normals = edge_normals(polygon)
    before = np.roll(normals, 1, axis=0)
    corner_sine = 1.0 + np.einsum("kd,kd->k", before, normals)
    moved = np.asarray(polygon + distance * (before + normals) / corner_sine[:, None])
    edge, new = np.roll(polygon, -1, axis=0) - polygon, np.roll(moved, -1, axis=0) - moved
    if (np.einsum("kd,kd->k", edge, new) <= 0.0).any():
        raise ShapeError(f"moved inward by {-distance:.3g} m, an edge of the polygon vanishes")
    return moved


def edge_normals(polygons: Array) -> Array:
    """Return the outward unit normals of counter-clockwise polygons.

    Args:
        polygons: Corners, shape (..., M, 2), [m]. Edges of no length get the normal (0, 0).

    Returns:
        Normal of the edge from corner i to i + 1, shape (..., M, 2).
    """
    edge = np.roll(polygons, -1, axis=-2) - polygons
    length = np.linalg.norm(edge, axis=-1, keepdims=True)
    edge = np.divide(edge, length, out=np.zeros_like(edge), where=length > 0.0)
    return np.asarray(np.stack([edge[..., 1], -edge[..., 0]], axis=-1), dtype=float)


class Separation(NamedTuple):
    """Signed distance between pairs of convex polygons, and the axis that proves it.

    Attributes:
        distance: Distance, shape (N,), [m]; negative: the depth of the overlap, the shortest
            translation that parts the two.
        axis: Unit vector from the first to the second polygon, shape (N, 2). The gap between the
            two supports along it equals `distance`.
    """

    distance: Array
    axis: Array


def _corner_to_edge(corners: Array, polygon: Array) -> tuple[Array, Array]:
    """Return the shortest vector from any corner to any edge of the other polygon.

    Args:
        corners: Shape (N, A, 2).
        polygon: Shape (N, B, 2).

    Returns:
        Squared length, shape (N,), and vector, shape (N, 2).
    """
    edge = np.roll(polygon, -1, axis=1) - polygon  # (N, B, 2)
    squared = np.einsum("nbk,nbk->nb", edge, edge)
    inverse = np.divide(1.0, squared, out=np.zeros_like(squared), where=squared > 0.0)
    offset_x = corners[:, :, None, 0] - polygon[:, None, :, 0]  # (N, A, B)
    offset_y = corners[:, :, None, 1] - polygon[:, None, :, 1]
    along = (offset_x * edge[:, None, :, 0] + offset_y * edge[:, None, :, 1]) * inverse[:, None, :]
    along = np.clip(along, 0.0, 1.0)
    dx = along * edge[:, None, :, 0] - offset_x
    dy = along * edge[:, None, :, 1] - offset_y
    length = (dx * dx + dy * dy).reshape(len(corners), -1)
    best = length.argmin(axis=1)
    rows = np.arange(len(corners))
    vector = np.stack(
        [dx.reshape(len(corners), -1)[rows, best], dy.reshape(len(corners), -1)[rows, best]],
        axis=-1,
    )
    return length[rows, best], vector


def separation(first: Array, second: Array) -> Separation:
    """Return the signed distance between pairs of convex polygons.

    Apart: the Euclidean distance, found between corners and edges. Overlapping: minus the least
    overlap over all edge normals (separating axis theorem), exact for convex polygons.

    >>> square = np.array([[[0.0, 0], [1, 0], [1, 1], [0, 1]]])
    >>> separation(square, square + [3.0, 0.0]).distance
    array([2.])
    >>> separation(square, square + [0.75, 0.0]).distance
    array([-0.25])

    Args:
        first: Counter-clockwise corners, shape (N, A, 2), [m]. A polygon with fewer corners
            repeats its last one; a point is one corner repeated.
        second: The same for the other one of each pair, shape (N, B, 2), [m].

    Returns:
        Distance and axis of each pair.
    """
    gap = np.full(len(first), -np.inf)
    axis = np.zeros((len(first), 2))
    for polygon, other, sign in ((first, second, 1.0), (second, first, -1.0)):
        normals = edge_normals(polygon)  # (N, A, 2)
        own = np.einsum("nak,nak->na", normals, polygon)
        reach = np.einsum("nak,nbk->nab", normals, other).min(axis=2) - own
        reach[~normals.any(axis=2)] = -np.inf
        best = reach.argmax(axis=1)
        rows = np.arange(len(first))
        better = reach[rows, best] > gap
        gap = np.where(better, reach[rows, best], gap)
        axis = np.where(better[:, None], sign * normals[rows, best], axis)
    apart = gap > 0.0
    pick = np.flatnonzero(apart)
    if len(pick):
        a_squared, a_vector = _corner_to_edge(first[pick], second[pick])
        b_squared, b_vector = _corner_to_edge(second[pick], first[pick])
        nearer = a_squared <= b_squared
        length = np.sqrt(np.where(nearer, a_squared, b_squared))
        vector = np.where(nearer[:, None], a_vector, -b_vector)
        # A hair's breadth apart the vector's direction is rounding noise: keep the edge normal.
        sure = length > 1e-9
        gap[pick] = np.where(sure, length, gap[pick])
        axis[pick] = np.where(
            sure[:, None], vector / np.where(sure, length, 1.0)[:, None], axis[pick]
        )
    return Separation(gap, axis)


def convex_pieces(polygon: shapely.Polygon) -> list[Array]:
    """Return convex polygons whose union is the polygon, holes respected.

    A constrained Delaunay triangulation whose triangles are merged while they stay convex.

    Args:
        polygon: A valid polygon, [m].

    Returns:
        Counter-clockwise corners of each piece, shapes (K, 2).
    """
    outline = shapely.remove_repeated_points(shapely.Polygon(polygon), 1e-9)
    if not outline.interiors and _is_convex(np.asarray(outline.exterior.coords)[:-1]):
        return [convex_polygon(np.asarray(outline.exterior.coords)[:-1])]
    triangles = shapely.get_parts(shapely.constrained_delaunay_triangles(outline))
    return _merge_convex([np.asarray(t.exterior.coords)[:-1] for t in triangles if t.area > 1e-12])


def _is_convex(points: Array) -> bool:
    try:
        convex_polygon(points)
    except ShapeError:
        return False
    return True


def _merge_convex(triangles: list[Array]) -> list[Array]:
    """Return the triangles with neighbours merged across shared edges while convex."""
    # No check of the triangles: slivers beside nearly straight edges are pieces like the others.
    pieces = {i: t if _signed_area(t) > 0.0 else t[::-1] for i, t in enumerate(triangles)}
    owner: dict[tuple[tuple[float, float], tuple[float, float]], int] = {}
    for key, piece in pieces.items():
        for start, end in _edges(piece):
            owner[start, end] = key
    for start, end in list(owner):
        here = owner.get((start, end))
        there = owner.get((end, start))
        if here is None or there is None or here == there:
            continue
        joined = _join(pieces[here], pieces[there], start, end)
        if joined is None:
            continue
        del pieces[there]
        pieces[here] = joined
        del owner[start, end], owner[end, start]
        for edge in _edges(joined):
            owner[edge] = here
    return [_without_straight_corners(piece) for piece in pieces.values()]


def _edges(piece: Array) -> list[tuple[tuple[float, float], tuple[float, float]]]:
    corners = [(float(x), float(y)) for x, y in piece]
    return list(zip(corners, corners[1:] + corners[:1], strict=True))


def _join(
    first: Array, second: Array, start: tuple[float, float], end: tuple[float, float]
) -> Array | None:
    """Return the two pieces as one across the edge start-end of `first`, or None if not convex."""
    a = [(float(x), float(y)) for x, y in first]
    b = [(float(x), float(y)) for x, y in second]
    i, j = a.index(end), b.index(start)
    outline = np.array(a[i:] + a[:i] + (b[j:] + b[:j])[1:-1])
    edge = np.roll(outline, -1, axis=0) - outline
    following = np.roll(edge, -1, axis=0)
    turn = edge[:, 0] * following[:, 1] - edge[:, 1] * following[:, 0]
    return outline if turn.min() >= 0.0 else None


def _without_straight_corners(piece: Array) -> Array:
    before = piece - np.roll(piece, 1, axis=0)
    after = np.roll(piece, -1, axis=0) - piece
    turn = before[:, 0] * after[:, 1] - before[:, 1] * after[:, 0]
    return piece[turn > 0.0] if int(np.sum(turn > 0.0)) >= 3 else piece
