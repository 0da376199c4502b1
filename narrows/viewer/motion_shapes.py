"""What is drawn of a motion in 3-D: its points, the floor it sweeps, its narrowest place."""

from __future__ import annotations

import math

import numpy as np
import shapely

from narrows.clearance import Certificate
from narrows.path import Path
from narrows.scene import Scene
from narrows.se2 import Array, transform

_STEP = 0.02  # m between the points of a drawn line
_STEP_TURN = math.radians(2.0)


def spread(path: Path) -> Array:
    """Return poses along a path, at most 2 cm of progress apart, (N, 3)."""
    return path(np.linspace(0.0, path.span, max(2, math.ceil(path.span / _STEP) + 1)))


def thinned(poses: Array) -> Array:
    """Return the rows of a motion that are 2 cm or 2 degrees apart, the last among them, (M, 3)."""
    scaled = poses * [1.0 / _STEP, 1.0 / _STEP, 1.0 / _STEP_TURN]
    travelled = np.concatenate([[0.0], np.cumsum(np.abs(np.diff(scaled, axis=0)).max(axis=1))])
    kept = np.unique(np.concatenate([[True], np.diff(np.floor(travelled)) > 0.0]).nonzero()[0])
    rows = np.union1d(kept, [0, len(poses) - 1])
    return np.asarray(poses[rows])


def swept_floor(outline: Array, poses: Array) -> shapely.MultiPolygon:
    """Return the area an outline (K, 2) passes over: hulls of neighbouring bodies, joined."""
    bodies = transform(poses, outline)
    pairs = np.concatenate([bodies[:-1], bodies[1:]], axis=1)
    owners = np.repeat(np.arange(len(pairs)), pairs.shape[1])
    hulls = shapely.convex_hull(shapely.multipoints(pairs.reshape(-1, 2), indices=owners))
    return shapely.MultiPolygon(shapely.get_parts(shapely.union_all(hulls).simplify(2e-3)))


def nearest_place(scene: Scene, path: Path, certificate: Certificate) -> tuple[Array | None, str]:
    """Return where a certified motion is nearest to what it must not touch, and the words there.

    The place lies midway between body and solid; where the solid has no area here, such as one
    that moves, it is the drive axle's.
    """
    if not math.isfinite(certificate.clearance):
        return None, ""
    text = f"{math.floor(1e3 * certificate.clearance + 1e-9)} mm"
    if certificate.against:
        text += f" to {certificate.against}"
    pose = path(certificate.at[0])
    found: list[tuple[float, Array]] = []
    for layer in scene.vehicle.layers:
        body = shapely.Polygon(transform(pose, layer.polygon))
        for solid in scene.world.solids:
            meets = solid.z[0] < layer.z[1] and layer.z[0] < solid.z[1]
            if meets and solid.name == certificate.against:
                line = shapely.shortest_line(body, solid.shape.buffer(solid.radius))
                found.append((line.length, shapely.get_coordinates(line).mean(axis=0)))
    place = min(found, key=lambda pair: pair[0])[1] if found else np.asarray(pose[:2])
    return place, text
