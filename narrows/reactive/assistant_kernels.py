"""The compiled loops of a step of the assistant: points into cells, cells into speed limits."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from ..se2 import Array
from .safety_regions_kernels import NEVER, Levels, braking_poses, compiled, signed_distance

_POSES = 6  # along a braking manoeuvre looked at exactly; the first is the start


@compiled
def place(
    points: Array,
    height: float,
    keep: float,
    grown: float,
    is_unknown: bool,
    pose: Array,
    lower: Array,
    cell: float,
    rows: int,
    columns: int,
    body: Array,
    cells: NDArray[np.int32],
    where: Array,
    count: int,
) -> int:
    """Append the cells of points, as seen from a pose; return the new count.

    Args:
        points: Points in the body frame now, shape (N, 2) or (N, 3), [m].
        height: Points higher than that pass over the chair [m].
        keep: Distance to be kept from a point [m].
        grown: Half the edge of the square of cells a point counts for beyond its own [m].
        is_unknown: Whether they are unknown places: those the body stands on do not count.
        pose: Pose the cells are to be seen from, in the body frame now, shape (3,).
        lower: Corner of the grid [m], shape (2,).
        cell: Edge of a cell [m].
        rows: Cells along x.
        columns: Cells along y.
        body: The outline, shape (K, 2), [m].
        cells: Filled with cells, row x columns + column, shape (room,).
        where: Filled with x, y and the distance to be kept, shape (room, 3): `keep`, or less if
            the point already is nearer than that.
        count: How many are filled.
    """
    cosine, sine = math.cos(pose[2]), math.sin(pose[2])
    for k in range(len(points)):
        if points.shape[1] == 3 and points[k, 2] > height:
            continue
        dx, dy = points[k, 0] - pose[0], points[k, 1] - pose[1]
        x, y = cosine * dx + sine * dy, cosine * dy - sine * dx
        first_row = max(0, math.floor((x - grown - lower[0]) / cell))
        last_row = min(rows - 1, math.floor((x + grown - lower[0]) / cell))
        first_column = max(0, math.floor((y - grown - lower[1]) / cell))
        last_column = min(columns - 1, math.floor((y + grown - lower[1]) / cell))
        if first_row > last_row or first_column > last_column:
            continue
        distance = signed_distance(body, x, y)
        if is_unknown and distance < 0.0:
            continue
        for row in range(first_row, last_row + 1):
            for column in range(first_column, last_column + 1):
                if count == len(cells):
                    return count
                cells[count] = row * columns + column
                where[count, 0], where[count, 1] = x, y
                where[count, 2] = min(keep, distance)
                count += 1
    return count


@compiled
def speed_limit(
    plane: Levels,
    parts: Levels,
    cells: NDArray[np.int32],
    where: Array,
    norms: Array,
    near: Array,
    motions: Array,
    timing: Array,
    body: Array,
    part_limits: Array,
) -> float:
    """Return the greatest speed norm at which a direction's region holds no point.

    Where the table would allow less than the speeds looked at exactly, the point is tried against
    the braking body itself: cells are coarse beside a chair in a doorway.

    Args:
        plane: Levels of the direction's region, shape (rows, columns).
        parts: Parts of the body met first, likewise.
        cells: Cells of the points, shape (N,).
        where: Their places and the distances to be kept, shape (N, 3).
        norms: Speed norm of each level, shape (L,), [m/s].
        near: Speed norms looked at exactly, increasing, shape (P,), [m/s].
        motions: v and omega per unit of speed norm that are looked at, shape (E, 2).
        timing: Latency [s] and rim deceleration [m/s^2].
        body: The outline, shape (K, 2), [m].
        part_limits: Filled with the limit set by each part of the body, shape (8,); or empty:
            not wanted.
    """
    flat_levels, flat_parts = plane.ravel(), parts.ravel()
    poses = np.empty((len(near), 2 * len(motions), _POSES, 3))
    ready = 0  # number of speeds whose poses are there
    detailed = len(part_limits) > 0
    part_limits[:] = math.inf
    limit = math.inf
    for k in range(len(cells)):
        level = flat_levels[cells[k]]
        if level == NEVER:
            continue
        own = norms[level - 1] if level > 0 else 0.0
        if not detailed and own >= limit:
            continue
        if own < near[-1]:
            for q in range(len(near)):
                if near[q] <= own:
                    continue
                if not detailed and own >= limit:
                    break
                if q >= ready:
                    for r in range(ready, q + 1):
                        _braking(near[r], motions, timing, poses[r])
                    ready = q + 1
                if not _stays_clear(poses[q], where[k], body):
                    break
                own = near[q]
        limit = min(limit, own)
        if detailed:
            part = flat_parts[cells[k]]
            part_limits[part] = min(part_limits[part], own)
    return limit


@compiled
def _braking(norm: float, motions: Array, timing: Array, poses: Array) -> None:
    """Write the poses of full brakings from a speed: all errors, castors kept and straightened."""
    duration = 0.5 * norm / timing[1]
    for e in range(len(motions)):
        v, omega = motions[e, 0] * norm, motions[e, 1] * norm
        braking_poses(v, omega, duration, timing[0], 1.0, poses[2 * e])
        braking_poses(v, omega, duration, timing[0], 0.0, poses[2 * e + 1])


@compiled
def _stays_clear(poses: Array, point: Array, body: Array) -> bool:
    """Return whether a body on its way never comes nearer to a point than is to be kept."""
    least = point[2] - 1e-6  # m: rounding
    for m in range(len(poses)):
        for i in range(1, poses.shape[1]):
            x, y, heading = poses[m, i]
            cosine, sine = math.cos(heading), math.sin(heading)
            dx, dy = point[0] - x, point[1] - y
            if signed_distance(body, cosine * dx + sine * dy, cosine * dy - sine * dx) < least:
                return False
    return True
