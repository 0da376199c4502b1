"""The chair's own body as the obstacle map needs it: half-planes, and the bands it is in."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ..geometry import edge_normals
from ..se2 import Array
from ..vehicle import Vehicle


@dataclass(frozen=True, eq=False)
class Slab:
    """A layer of the body.

    Attributes:
        normals: Outward normals of its sides, body frame, shape (E, 2).
        offsets: Of the sides along them, shape (E,), [m].
        low: Lowest point above the floor [m].
        high: Highest point [m].
        bands: Which bands it fills, shape (K,).
        reach: Distance of its furthest point from the body's origin [m].
    """

    normals: Array
    offsets: Array
    low: float
    high: float
    bands: NDArray[np.bool_]
    reach: float


def body_slabs(vehicle: Vehicle, edges: Array) -> list[Slab]:
    """Return the layers of a body, given the heights between the bands, shape (K + 1,), [m]."""
    slabs = []
    for layer in vehicle.layers:
        normals = edge_normals(layer.polygon)
        offsets = np.einsum("ed,ed->e", normals, layer.polygon)
        low, high = layer.z
        bands = (edges[:-1] >= low - 1e-9) & (edges[1:] <= high + 1e-9)
        reach = float(np.linalg.norm(layer.polygon, axis=1).max())
        slabs.append(Slab(normals, offsets, low, high, bands, reach))
    return slabs


def depth_in(slab: Slab, points: Array) -> Array:
    """Return how deep points (N, 2) of the body frame lie in a layer, shape (N,), [m]."""
    return np.asarray((slab.offsets - points @ slab.normals.T).min(axis=1))


def are_inside(slabs: list[Slab], points: Array, margin: float) -> NDArray[np.bool_]:
    """Return which points (N, 3) of the body frame lie deeper than a margin [m] in the body."""
    inside = np.zeros(len(points), dtype=bool)
    for slab in slabs:
        is_level = (points[:, 2] >= slab.low) & (points[:, 2] < slab.high)
        inside |= is_level & (depth_in(slab, points[:, :2]) > margin)
    return inside
