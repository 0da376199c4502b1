"""Whether a path for a reactive chair plausibly exists: a disc's way through a grid."""

from __future__ import annotations

import math

import numpy as np
import shapely
from scipy.sparse import csr_array
from scipy.sparse.csgraph import dijkstra

from ..scene import Scene

CELL = 0.1
"""Edge of a cell [m]."""

DETOUR = 1.3
"""A way longer than this share of the straight line is not one a reactive chair should find."""

AROUND = 1.5
"""How far beyond start and goal ways are looked for [m]."""


def holding_disc(scene: Scene) -> float:
    """Return the radius of the disc about its middle that holds the chair seen from above [m]."""
    outline = scene.vehicle.outline
    middle = 0.5 * (outline.min(axis=0) + outline.max(axis=0))
    return float(np.hypot(*(outline - middle).T).max())


def disc_way(scene: Scene, radius: float) -> float:
    """Return the length of the shortest way of a disc from start to goal, in straight lines.

    Ways go from cell to cell in eight directions, so they are up to 8 % too long. Solids the chair
    passes under do not count. Start and goal count as free.

    Args:
        scene: World, start, goal.
        radius: Of the disc [m].

    Returns:
        Length over the straight line from start to goal; infinite: there is none.
    """
    first, last = scene.start[:2], scene.goal.pose[:2]
    straight = float(np.hypot(*(last - first)))
    low = np.minimum(first, last) - AROUND - 3.0
    high = np.maximum(first, last) + AROUND + 3.0
    count = np.ceil((high - low) / CELL).astype(int)
    axes = [low[k] + CELL * (np.arange(count[k]) + 0.5) for k in (0, 1)]
    x, y = np.meshgrid(*axes, indexing="ij")
    top = scene.vehicle.height
    met = [s for s in scene.world.solids if s.z[0] < top and s.z[1] > 0.0]
    free = np.ones(x.shape, dtype=bool)
    if met:
        union = shapely.union_all([solid.shape.buffer(solid.radius) for solid in met])
        shapely.prepare(union)
        free = np.asarray(shapely.distance(shapely.points(x, y), union)) >= radius
    for place in (first, last):
        free[np.hypot(x - place[0], y - place[1]) < 1.5 * CELL] = True
    index = np.arange(x.size).reshape(x.shape)
    parts = []
    for dx, dy in ((1, 0), (0, 1), (1, 1), (1, -1)):
        a = (slice(0, x.shape[0] - dx), slice(max(0, -dy), x.shape[1] - max(0, dy)))
        b = (slice(dx, None), slice(max(0, dy), x.shape[1] - max(0, -dy)))
        both = free[a] & free[b]
        steps = np.full(int(both.sum()), CELL * math.hypot(dx, dy))
        parts.append((index[a][both], index[b][both], steps))
    rows, columns, lengths = (np.concatenate(part) for part in zip(*parts, strict=True))
    graph = csr_array((lengths, (rows, columns)), shape=(x.size, x.size))
    ends = [
        int(index[tuple(np.minimum((place - low) / CELL, count - 1).astype(int))])
        for place in (first, last)
    ]
    found = np.asarray(dijkstra(graph, directed=False, indices=np.array(ends[:1])))
    return float(found[0, ends[1]]) / straight


def is_plausible(scene: Scene) -> bool:
    """Return whether the disc that holds the chair finds a way at most `DETOUR` times straight."""
    return disc_way(scene, holding_disc(scene)) <= DETOUR
