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
from .search_blocking import block
from .search_collision import Solids
from .search_queue import distances
from .search_tables import Field

OCTILE = 1.0 / math.cos(math.pi / 8.0)
"""How much longer than straight a way over an 8-connected grid can be."""

_POINT = 1e-300  # m: edges shorter than this have no normal


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
    blocks: list[Array] = []
    radii: list[Array] = []
    counted: list[int] = []
    slabs = _bounding_slabs(world, vehicle)
    for layer in vehicle.layers:
        met = world.pieces_between(*layer.z)
        blocks += [met.corners, slabs]
        radii += [met.radius, np.zeros(len(slabs))]
        counted.append(len(met) + len(slabs))
    pieces, sides = _padded(blocks)
    radius = np.concatenate(radii)
    corners = pieces[..., :2]
    box = np.concatenate(
        [corners.min(axis=1) - radius[:, None], corners.max(axis=1) + radius[:, None]], axis=1
    )
    layer_of = np.repeat(np.arange(len(counted)), counted)
    body, _ = _padded([layer.polygon[None] for layer in vehicle.layers])
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


def _padded(blocks: list[Array]) -> tuple[Array, NDArray[np.int64]]:
    """Return corners and edge normals, shape (P, K, 4), and the number of corners, shape (P,).

    Short polygons repeat their last corner, with normals of 0.

    Args:
        blocks: Blocks of polygons (P_i, K_i, 2) that repeat their last corner, [m].
    """
    most = max((block.shape[1] for block in blocks), default=1)
    corners = np.concatenate(
        [np.zeros((0, most, 2))]
        + [np.pad(b, ((0, 0), (0, most - b.shape[1]), (0, 0)), mode="edge") for b in blocks]
    )
    repeated = (corners == corners[:, -1:]).all(axis=2)
    # The corners after the last one that differs from the last corner, but for one, repeat it.
    sides = most - np.cumprod(repeated[:, ::-1], axis=1).sum(axis=1) + 1
    rows = np.zeros((len(corners), most, 4))
    rows[..., :2] = corners
    for count in np.unique(sides):
        chosen = np.flatnonzero(sides == count)
        edge = np.roll(corners[chosen, :count], -1, axis=1) - corners[chosen, :count]
        length = np.maximum(np.hypot(edge[..., 0], edge[..., 1]), _POINT)
        rows[chosen, :count, 2] = edge[..., 1] / length
        rows[chosen, :count, 3] = -edge[..., 0] / length
    return rows, sides


def _bounding_slabs(world: World, vehicle: Vehicle) -> Array:
    """Return slabs around the world's bounds, thicker than the body is long, (0 or 4, 4, 2)."""
    if world.bounds is None:
        return np.zeros((0, 4, 2))
    x_min, y_min, x_max, y_max = world.bounds
    far = 2.0 * vehicle.radius
    boxes = (
        (x_min - far, y_min - far, x_min, y_max + far),
        (x_max, y_min - far, x_max + far, y_max + far),
        (x_min - far, y_min - far, x_max + far, y_min),
        (x_min - far, y_max, x_max + far, y_max + far),
    )
    return np.array([[[a, b], [c, b], [c, d], [a, d]] for a, b, c, d in boxes])


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


def inscribed_radius(polygon: Array) -> float:
    """Return the radius of the largest disc about the body origin inside a layer [m], or 0."""
    return max(float(np.einsum("ij,ij->i", edge_normals(polygon), polygon).min()), 0.0)


def blocked_cells(scene: Scene, solids: Solids, region: Array, cell: float) -> NDArray[np.bool_]:
    """Return the cells of a region no point of which keeps the inscribed disc clear."""
    inner = np.array([inscribed_radius(layer.polygon) for layer in scene.vehicle.layers])
    columns, rows = (max(int(n), 1) for n in np.ceil((region[2:] - region[:2]) / cell))
    blocked = np.zeros((columns, rows), dtype=np.bool_)
    block(solids, inner - cell * math.sqrt(0.5), region[:2], cell, blocked)
    return blocked


def way_field(blocked: NDArray[np.bool_], region: Array, target: Array, cell: float) -> Field:
    """Return a lower bound on the way of the body origin to a target."""
    columns, rows = blocked.shape
    at = np.floor((target[:2] - region[:2]) / cell).astype(int)
    i, j = min(max(int(at[0]), 0), columns - 1), min(max(int(at[1]), 0), rows - 1)
    cells = np.full((columns, rows), np.inf)
    room = 8 * columns * rows
    distances(blocked, i, j, cells, np.empty(room), np.empty(room, dtype=np.int64))
    return Field(np.maximum(cells / OCTILE - 2.0, 0.0) * cell, region[:2].copy(), cell)
