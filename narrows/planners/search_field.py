"""What a manoeuvre search knows of a scene before it starts: packed solids, the way left."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from ..geometry import edge_normals
from ..scene import Scene
from ..se2 import Array
from ..vehicle import Vehicle
from ..world import World
from .search_collision import Solids
from .search_kernel import Field
from .search_queue import distances

OCTILE = 1.0 / math.cos(math.pi / 8.0)
"""How much longer than straight a way over an 8-connected grid can be."""


def pack_solids(scene: Scene, region: Array, span: float, care: float, cell: float) -> Solids:
    """Return the scene's body and solids for the compiled loops.

    The world's bounds become four slabs outside them.

    Args:
        scene: The scene.
        region: Box the body origin may be in, shape (4,), [m].
        span: Longest arc checked at once [m].
        care: Gaps above are not told apart [m].
        cell: Size of the cells candidates are listed for [m].
    """
    vehicle, world = scene.vehicle, scene.world
    rows: list[tuple[Array, float, int]] = []
    for index, layer in enumerate(vehicle.layers):
        met = world.pieces_between(*layer.z)
        rows += [(c, float(r), index) for c, r in zip(met.corners, met.radius, strict=True)]
        rows += [(slab, 0.0, index) for slab in _bounding_slabs(world, vehicle)]
    pieces, sides = _padded([polygon for polygon, _, _ in rows])
    radius = np.array([r for _, r, _ in rows], dtype=float)
    corners = pieces[..., :2]
    box = np.concatenate(
        [corners.min(axis=1) - radius[:, None], corners.max(axis=1) + radius[:, None]], axis=1
    )
    layer_of = np.array([i for _, _, i in rows], dtype=np.int64)
    body, _ = _padded([layer.polygon for layer in vehicle.layers])
    reach = np.hypot(body[..., 0], body[..., 1]).max(axis=1)
    columns, lines = (int(n) for n in np.ceil((region[2:] - region[:2]) / cell))
    first, candidates = _candidates(
        box, reach[layer_of] + span + care, region[:2].copy(), cell, max(columns, 1), max(lines, 1)
    )
    return Solids(
        body,
        reach,
        pieces,
        sides,
        radius,
        box,
        layer_of,
        region[:2].copy(),
        cell,
        first,
        candidates,
        span,
    )


def _padded(polygons: list[Array]) -> tuple[Array, NDArray[np.int64]]:
    """Return corners and edge normals, shape (P, K, 4), and the number of corners, shape (P,).

    Short polygons repeat their last corner, with normals of 0.
    """
    distinct = [polygon[: _different(polygon)] for polygon in polygons]
    rows = np.zeros((len(polygons), max((len(p) for p in distinct), default=1), 4))
    for row, polygon in zip(rows, distinct, strict=True):
        row[:, :2] = polygon[-1]
        row[: len(polygon), :2] = polygon
        row[: len(polygon), 2:] = edge_normals(polygon)
    return rows, np.array([len(p) for p in distinct], dtype=np.int64)


def _different(polygon: Array) -> int:
    """Return the number of corners before the last one is repeated."""
    count = len(polygon)
    while count > 1 and (polygon[count - 1] == polygon[count - 2]).all():
        count -= 1
    return count


def _bounding_slabs(world: World, vehicle: Vehicle) -> list[Array]:
    """Return slabs around the world's bounds, thicker than the body is long."""
    if world.bounds is None:
        return []
    x_min, y_min, x_max, y_max = world.bounds
    far = 2.0 * vehicle.radius
    boxes = (
        (x_min - far, y_min - far, x_min, y_max + far),
        (x_max, y_min - far, x_max + far, y_max + far),
        (x_min - far, y_min - far, x_max + far, y_min),
        (x_min - far, y_max, x_max + far, y_max + far),
    )
    return [np.array([[a, b], [c, b], [c, d], [a, d]]) for a, b, c, d in boxes]


def _candidates(
    box: Array, reach: Array, origin: Array, cell: float, columns: int, rows: int
) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """Return for each cell the pieces whose box comes within reach (P,) of it."""
    counts = np.zeros((columns, rows), dtype=np.int64)
    found = []
    y = origin[1] + cell * np.arange(rows)[:, None]
    for i in range(columns):
        x = origin[0] + i * cell
        dx = np.maximum(np.maximum(box[:, 0] - x - cell, x - box[:, 2]), 0.0)
        near = np.flatnonzero(dx <= reach)
        dy = np.maximum(np.maximum(box[near, 1] - y - cell, y - box[near, 3]), 0.0)
        row, piece = np.nonzero(dy * dy + dx[near] ** 2 <= reach[near] ** 2)
        counts[i] = np.bincount(row, minlength=rows)
        found.append(near[piece])
    ends = np.cumsum(counts).reshape(columns, rows)
    first = np.concatenate([(ends - counts)[:, :1], ends], axis=1)
    return first, np.concatenate(found)


def _blocked(
    solids: Solids, inner: Array, origin: Array, cell: float, columns: int, rows: int
) -> NDArray[np.bool_]:
    """Return the cells no point of which keeps the inscribed disc (L,) clear."""
    blocked = np.zeros((columns, rows), dtype=np.bool_)
    half = cell * math.sqrt(0.5)
    for k in range(len(solids.sides)):
        room = inner[solids.layer[k]] - half
        if room <= 0.0:
            continue
        low = np.floor((solids.box[k, :2] - room - origin) / cell).astype(int)
        high = np.ceil((solids.box[k, 2:] + room - origin) / cell).astype(int)
        low, high = np.maximum(low, 0), np.minimum(high, (columns, rows))
        if (low >= high).any():
            continue
        x = origin[0] + cell * (np.arange(low[0], high[0]) + 0.5)
        y = origin[1] + cell * (np.arange(low[1], high[1]) + 0.5)
        away = _distance_to(solids.pieces[k, : solids.sides[k]], x[:, None], y[None, :])
        blocked[low[0] : high[0], low[1] : high[1]] |= away < room + solids.radius[k]
    return blocked


def _distance_to(piece: Array, x: Array, y: Array) -> Array:
    """Return the distance of points to a convex piece (K, 4), 0 inside, [m]."""
    best: Array = np.array(np.inf)
    beyond: Array = np.array(-np.inf if len(piece) > 2 else np.inf)
    for here, there in zip(piece, np.roll(piece, -1, axis=0), strict=True):
        dx, dy = x - here[0], y - here[1]
        ex, ey = there[:2] - here[:2]
        t = np.clip((dx * ex + dy * ey) / max(ex * ex + ey * ey, 1e-300), 0.0, 1.0)
        best = np.minimum(best, np.hypot(dx - t * ex, dy - t * ey))
        beyond = np.maximum(beyond, dx * here[2] + dy * here[3])
    return np.where(beyond <= 0.0, 0.0, best)


def inscribed_radius(polygon: Array) -> float:
    """Return the radius of the largest disc about the body origin inside a layer [m], or 0."""
    return max(float(np.einsum("ij,ij->i", edge_normals(polygon), polygon).min()), 0.0)


def way_field(scene: Scene, solids: Solids, region: Array, target: Array, cell: float) -> Field:
    """Return a lower bound on the way of the body origin to a target."""
    inner = np.array([inscribed_radius(layer.polygon) for layer in scene.vehicle.layers])
    columns, rows = (max(int(n), 1) for n in np.ceil((region[2:] - region[:2]) / cell))
    origin = region[:2].copy()
    blocked = _blocked(solids, inner, origin, cell, columns, rows)
    at = np.floor((target[:2] - origin) / cell).astype(int)
    i, j = min(max(int(at[0]), 0), columns - 1), min(max(int(at[1]), 0), rows - 1)
    cells = np.full((columns, rows), np.inf)
    room = 8 * columns * rows
    distances(blocked, i, j, cells, np.empty(room), np.empty(room, dtype=np.int64))
    return Field(np.maximum(cells / OCTILE - 2.0, 0.0) * cell, origin, cell)
