"""Paints the cells a braking body may touch, from one direction of motion; compiled."""

from __future__ import annotations

import math

import numpy as np

from ..se2 import Array
from .braking_kernels import braking_poses
from .cell_kernels import Levels, hull_in_place, paint
from .compiled import compiled

NEVER = 255
"""Level of a cell that is not reached at any speed."""


@compiled
def paint_direction(
    plane: Levels,
    motions: Array,
    norms: Array,
    timing: Array,
    body: Array,
    lower: Array,
    cell: float,
    castor_samples: int,
    pose_samples: int,
) -> None:
    """Paint one direction's region: the least level that reaches each cell.

    From the highest level down, each paints over those above. Between neighbouring samples of
    level, castors and time, and over all measurement errors, a body point moves within the hull of
    where it is at the samples, but for curvature, which is added as slack: step x turn / 8. So
    slow motions, which turn little, need fewer samples.

    Args:
        plane: Levels, shape (rows along x, columns along y), all `NEVER` before.
        motions: v and omega per unit of the speed norm, one row for each error, shape (E, 2).
        norms: Speed norm of each level, from 0, shape (L,), [m/s].
        timing: Latency [s] and deceleration [m/s^2].
        body: Corners of the body with all it must keep around it, shape (K, 2), [m].
        lower: Corner of the grid [m], shape (2,).
        cell: Edge of a cell [m].
        castor_samples: Most samples of the castors' c as in `braking_poses`, over 0 to 1.
        pose_samples: Most poses on each braking manoeuvre.
    """
    errors, corners = len(motions), len(body)
    radius = 0.0
    for k in range(corners):
        radius = max(radius, math.hypot(body[k, 0], body[k, 1]))
    faster = np.empty((errors, castor_samples, pose_samples, 3))
    slower = np.empty((errors, castor_samples, pose_samples, 3))
    points = np.empty((8 * errors * corners, 2))
    ring = np.empty((2 * len(points) + 2, 2))
    for level in range(len(norms) - 1, 0, -1):
        time = timing[0] + 0.25 * norms[level] / timing[1]
        turn = abs(motions[errors // 2, 1]) * norms[level] * time
        way = 0.5 * norms[level] * time
        ways = min(castor_samples, 2 + int(turn / 0.1))
        samples = min(pose_samples, 5 + int(way / 0.06 + turn / 0.08))
        _sample(motions, norms[level], timing, faster[:, :ways, :samples])
        _sample(motions, norms[level - 1], timing, slower[:, :ways, :samples])
        for c in range(ways - 1):
            for i in range(samples - 1):
                count, slack = _gather(faster, slower, c, i, body, radius, points)
                size = hull_in_place(points, count, ring)
                paint(plane, ring, size, slack, lower, cell, level)
    paint(plane, body, corners, 0.0, lower, cell, 0)


@compiled
def _sample(motions: Array, norm: float, timing: Array, poses: Array) -> None:
    """Write the brakings from a speed norm: a row for each error, for each of the castors' c."""
    duration = 0.5 * norm / timing[1]
    errors, ways = poses.shape[:2]
    for e in range(errors):
        v, omega = motions[e, 0] * norm, motions[e, 1] * norm
        for c in range(ways):
            braking_poses(v, omega, duration, timing[0], c / (ways - 1.0), poses[e, c])


@compiled
def _gather(
    faster: Array, slower: Array, c: int, i: int, body: Array, radius: float, points: Array
) -> tuple[int, float]:
    """Write the body's corners at the samples around one cell of parameters; return the slack."""
    count = 0
    least_x, most_x, least_y, most_y = math.inf, -math.inf, math.inf, -math.inf
    least_turn, most_turn = math.inf, -math.inf
    for e in range(len(faster)):
        for which in range(2):
            poses = faster if which == 0 else slower
            for a in range(2):
                for b in range(2):
                    x, y, heading = poses[e, c + a, i + b]
                    least_x, most_x = min(least_x, x), max(most_x, x)
                    least_y, most_y = min(least_y, y), max(most_y, y)
                    least_turn, most_turn = min(least_turn, heading), max(most_turn, heading)
                    cosine, sine = math.cos(heading), math.sin(heading)
                    for k in range(len(body)):
                        points[count, 0] = x + cosine * body[k, 0] - sine * body[k, 1]
                        points[count, 1] = y + sine * body[k, 0] + cosine * body[k, 1]
                        count += 1
    turn = most_turn - least_turn
    step = math.hypot(most_x - least_x, most_y - least_y) + radius * turn
    return count, 0.125 * step * turn
