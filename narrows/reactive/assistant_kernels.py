"""The compiled loops of a step of the assistant: points into cells, cells into speed limits."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from ..se2 import Array
from .braking_kernels import braking_poses
from .cell_kernels import Levels
from .compiled import compiled
from .safety_regions_kernels import NEVER

_POSES = 6  # along a braking manoeuvre looked at exactly; the first is the start
FRAMES = 2 * (_POSES - 1)  # of them kept for each error


@compiled
def _is_there(
    cells: NDArray[np.int32], where: Array, last: int, count: int, number: int, x: float, y: float
) -> bool:
    """Return whether the entry filled last for a cell is this cell's, and the same point [m]."""
    return (
        last < count
        and cells[last] == number
        and abs(where[last, 0] - x) + abs(where[last, 1] - y) < 1e-6
    )


@compiled
def _span(offset: float, grown: float, cell: float, count: int) -> range:
    """Return the rows, or columns, of the cells within `grown` of an offset from their edge."""
    first = max(0, math.floor((offset - grown) / cell))
    return range(first, min(count - 1, math.floor((offset + grown) / cell)) + 1)


@compiled
def place(
    points: Array,
    height: float,
    grown: float,
    is_unknown: bool,
    anyway: float,
    pose: Array,
    lower: Array,
    cell: float,
    rows: int,
    columns: int,
    edges: Array,
    cells: NDArray[np.int32],
    where: Array,
    latest: NDArray[np.int32],
    count: int,
) -> int:
    """Append the cells of points, as seen from a pose; return the new count.

    Points above each other in one cell count once.

    Args:
        points: Points in the body frame now, shape (N, 2) or (N, 3), [m].
        height: Points higher than that pass over the chair [m].
        grown: Half the edge of the square of cells a point counts for beyond its own [m].
        is_unknown: Whether they are unknown places: those the body stands on do not count.
        anyway: Speed norm allowed whatever is there [m/s].
        pose: Pose the cells are to be seen from, in the body frame now, shape (3,).
        lower: Corner of the grid [m], shape (2,).
        cell: Edge of a cell [m].
        rows: Cells along x.
        columns: Cells along y.
        edges: Edges of the outline as `edge_rows`, shape (K, 3).
        cells: Filled with cells, row x columns + column, shape (room,).
        where: Filled with x, y, distance and `anyway`, shape (room, 4).
        latest: Which of those filled was the last in each cell, shape (rows x columns,); what it
            holds of earlier steps does no harm.
        count: How many are filled.
    """
    cosine, sine = math.cos(pose[2]), math.sin(pose[2])
    for k in range(len(points)):
        if points.shape[1] == 3 and points[k, 2] > height:
            continue
        dx, dy = points[k, 0] - pose[0], points[k, 1] - pose[1]
        x, y = cosine * dx + sine * dy, cosine * dy - sine * dx
        distance = beyond(edges, x, y)
        if is_unknown and distance < 0.0:
            continue
        first = count
        for row in _span(x - lower[0], grown, cell, rows):
            for column in _span(y - lower[1], grown, cell, columns):
                number = row * columns + column
                if _is_there(cells, where, latest[number], count, number, x, y):
                    continue
                if count == len(cells):
                    return count
                latest[number] = count
                cells[count] = number
                count += 1
        where[first:count, 0], where[first:count, 1] = x, y
        where[first:count, 2], where[first:count, 3] = distance, anyway
    return count


@compiled
def speed_limit(
    plane: Levels,
    parts: Levels,
    cells: NDArray[np.int32],
    where: Array,
    norms: Array,
    near: Array,
    keeps: Array,
    brakings: Array,
    edges: Array,
    part_limits: Array,
) -> float:
    """Return the greatest speed norm at which a direction's region holds no point.

    Where the table would allow less than the speeds looked at exactly, the point is tried against
    the braking body itself: cells are coarse beside a chair in a doorway.

    Args:
        plane: Levels of the direction's region, shape (rows, columns).
        parts: Parts of the body met first, likewise.
        cells: Cells of the points, shape (N,).
        where: Their places, distances now and speeds allowed anyway, shape (N, 4).
        norms: Speed norm of each level, shape (L,), [m/s].
        near: Speed norms looked at exactly, increasing, shape (P,), [m/s].
        keeps: Distance to be kept from a point at each of them, shape (P,), [m].
        brakings: Poses of the body in full brakings from them, as `braking_frames`.
        edges: Edges of the outline as `edge_rows`, shape (K, 3).
        part_limits: Filled with the limit set by each part of the body, shape (8,); or empty:
            not wanted.
    """
    flat_levels, flat_parts = plane.ravel(), parts.ravel()
    detailed = len(part_limits) > 0
    part_limits[:] = math.inf
    limit = math.inf
    for k in range(len(cells)):
        level = flat_levels[cells[k]]
        if level == NEVER:
            continue
        own = max(norms[level - 1] if level > 0 else 0.0, where[k, 3])
        if not detailed and own >= limit:
            continue
        for q in range(len(near)):
            if near[q] <= own:
                continue
            if not detailed and own >= limit:
                break
            if not _stays_clear(brakings[q], where[k], keeps[q], edges):
                break
            own = near[q]
        limit = min(limit, own)
        if detailed:
            part = flat_parts[cells[k]]
            part_limits[part] = min(part_limits[part], own)
    return limit


@compiled
def _stays_clear(frames: Array, point: Array, keep: float, edges: Array) -> bool:
    """Return whether a body on its way keeps its distance from a point.

    From a point that is nearer already it must not come nearer still, wheels without errors: with
    them, not even a motion along a wall could be told from one into it.
    """
    first, end, least = 0, len(frames), keep
    if point[2] < keep:
        first, end, least = FRAMES, 2 * FRAMES, point[2] - 1e-6  # m: rounding
    for i in range(first, end):
        dx, dy = point[0] - frames[i, 0], point[1] - frames[i, 1]
        x = frames[i, 2] * dx + frames[i, 3] * dy
        y = frames[i, 2] * dy - frames[i, 3] * dx
        if beyond(edges, x, y) < least:
            return False
    return True


@compiled
def beyond(edges: Array, x: float, y: float) -> float:
    """Return how far a point is beyond the edge of a body it is furthest beyond [m].

    Negative: inside. Never more than the distance from the body, less only off its corners.
    """
    best = -math.inf
    for k in range(len(edges)):
        best = max(best, edges[k, 0] * x + edges[k, 1] * y - edges[k, 2])
    return best


@compiled
def braking_frames(motions: Array, near: Array, timing: Array, frames: Array) -> None:
    """Write where the body is in full brakings: all errors, castors that keep a curve or do not.

    Args:
        motions: v and omega per unit of speed norm, one row for each error, the middle one none,
            shape (3, 2).
        near: Speed norms, shape (P,), [m/s].
        timing: Latency [s] and deceleration [m/s^2].
        frames: Filled with x, y, cosine and sine of the heading, shape (P, 3 FRAMES, 4).
    """
    poses = np.empty((_POSES, 3))
    for q in range(len(near)):
        filled = 0
        for e in range(len(motions)):
            for castors in range(2):
                v, omega = motions[e, 0] * near[q], motions[e, 1] * near[q]
                braking_poses(v, omega, 0.5 * near[q] / timing[1], timing[0], castors, poses)
                for i in range(_POSES - 1, 0, -1):  # the last is the likeliest to be too near
                    frames[q, filled, 0], frames[q, filled, 1] = poses[i, 0], poses[i, 1]
                    frames[q, filled, 2] = math.cos(poses[i, 2])
                    frames[q, filled, 3] = math.sin(poses[i, 2])
                    filled += 1
