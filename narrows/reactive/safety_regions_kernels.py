"""The compiled loops behind safety regions: braking poses, and the cells a braking body touches.

Imported where regions are computed or looked up, never at `import narrows`. Their machine code
is kept on disk and renewed when their own file changes: after editing this file, touch
`assistant_kernels.py`, which calls it.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import TypeVar, cast

import numba
import numpy as np
from numpy.typing import NDArray

from ..se2 import Array

Function = TypeVar("Function", bound=Callable[..., object])
Levels = NDArray[np.uint8]

NEVER = 255
"""Level of a cell that is not reached at any speed."""


def compiled(function: Function) -> Function:
    """Return the function compiled on its first call, kept on disk."""
    return cast(Function, numba.njit(cache=True, error_model="numpy")(function))


@compiled
def braking_poses(
    v: float, omega: float, duration: float, latency: float, castors: float, poses: Array
) -> None:
    """Write poses along a braking manoeuvre that begins at the origin.

    For `latency` the motion goes on as it is; then v falls linearly to zero in `duration`, and
    omega = omega0 (v / v0) max(0, 1 - t / Tc). [DrivingAssistant, Sec. III-B] in words; the
    formula is derived. Half a dozen poses lie on the first phase, the rest on the second, evenly
    in the distance driven.

    Args:
        v: Speed at its beginning [m/s].
        omega: Heading rate at its beginning [rad/s].
        duration: Time of the second phase [s].
        latency: Time of the first [s].
        castors: c = Tc / (Tc + duration): 0, the castors turn straight at once; 1, never.
        poses: Filled with poses, shape (P, 3), P >= 5; the first is the origin, the last the stop.
    """
    count = len(poses)
    before = 2 if count < 9 else 3  # poses after the origin on the first phase
    poses[0] = 0.0
    x, y, heading = 0.0, 0.0, 0.0
    for i in range(1, before + 1):
        step = latency / before
        half = 0.5 * omega * step
        chord = v * step * (math.sin(half) / half if abs(half) > 1e-9 else 1.0)
        x += chord * math.cos(heading + half)
        y += chord * math.sin(heading + half)
        heading += omega * step
        poses[i, 0], poses[i, 1], poses[i, 2] = x, y, heading
    start, after = heading, count - 1 - before
    ratio = math.inf if castors >= 1.0 else castors / (1.0 - castors)  # Tc / duration
    last = 0.0
    for i in range(1, after + 1):
        share = 1.0 - math.sqrt(1.0 - i / after)  # of the duration
        # Gauss's two points integrate the step's smooth curve to far below a millimetre.
        middle, half = 0.5 * (last + share), 0.5 * (share - last)
        for sign in (-1.0, 1.0):
            s = middle + sign * half / math.sqrt(3.0)
            angle = start + omega * duration * _turned(s, ratio)
            weight = half * duration * v * (1.0 - s)
            x += weight * math.cos(angle)
            y += weight * math.sin(angle)
        heading = start + omega * duration * _turned(share, ratio)
        poses[before + i, 0], poses[before + i, 1], poses[before + i, 2] = x, y, heading
        last = share


@compiled
def _turned(s: float, ratio: float) -> float:
    """Return the integral of (1 - s) max(0, 1 - s / ratio) from 0 to s, for s in [0, 1]."""
    if ratio <= 0.0:
        return 0.0
    s = min(s, ratio)
    straight = s - 0.5 * s * s
    return straight - (0.5 * s * s - s * s * s / 3.0) / ratio


@compiled
def hull_in_place(points: Array, count: int, ring: Array) -> int:
    """Write the convex hull of the first `count` points into `ring`; return its corners.

    Andrew's monotone chain; the points are sorted in place. Counter-clockwise.
    """
    gap = 1
    while gap < count // 3:
        gap = 3 * gap + 1
    while gap > 0:
        for i in range(gap, count):
            x, y = points[i, 0], points[i, 1]
            j = i
            while j >= gap and (
                points[j - gap, 0] > x or (points[j - gap, 0] == x and points[j - gap, 1] > y)
            ):
                points[j, 0], points[j, 1] = points[j - gap, 0], points[j - gap, 1]
                j -= gap
            points[j, 0], points[j, 1] = x, y
        gap //= 3
    size = 0
    for i in range(count):
        size = _push(points[i, 0], points[i, 1], ring, size, 2)
    upper = size + 1
    for i in range(count - 2, -1, -1):
        size = _push(points[i, 0], points[i, 1], ring, size, upper)
    return max(size - 1, 1)  # the last point is the first again


@compiled
def _push(x: float, y: float, ring: Array, size: int, least: int) -> int:
    """Add a point to a chain that turns left, drop those it makes dents; return the new size."""
    while size >= least:
        ax, ay = ring[size - 2, 0], ring[size - 2, 1]
        bx, by = ring[size - 1, 0], ring[size - 1, 1]
        if (bx - ax) * (y - ay) - (by - ay) * (x - ax) > 0.0:
            break
        size -= 1
    ring[size, 0], ring[size, 1] = x, y
    return size + 1


@compiled
def row_spans(
    ring: Array, size: int, slack: float, lower: Array, cell: float, low: Array, high: Array
) -> tuple[int, int]:
    """Write, for every row of cells, the y-range in which a convex ring meets it.

    Exact: a cell of the row meets the ring if and only if it meets this range, because the part
    of a convex figure inside a row is convex. Grown by `slack` to all sides.

    Args:
        ring: Corners, shape (>= size, 2), [m].
        size: Number of corners.
        slack: Growth [m].
        lower: Corner of the grid [m], shape (2,).
        cell: Edge of a cell [m].
        low: Least y of each row, shape (rows,), filled between the returned rows.
        high: Greatest y likewise.

    Returns:
        First row met and one past the last.
    """
    rows = len(low)
    least, most = ring[0, 0], ring[0, 0]
    for i in range(1, size):
        least, most = min(least, ring[i, 0]), max(most, ring[i, 0])
    first = max(0, math.floor((least - slack - lower[0]) / cell))
    end = min(rows, math.floor((most + slack - lower[0]) / cell) + 1)
    for row in range(first, end):
        low[row], high[row] = math.inf, -math.inf
    for i in range(size):
        j = i + 1 if i + 1 < size else 0
        ax, ay, bx, by = ring[i, 0], ring[i, 1], ring[j, 0], ring[j, 1]
        if ax > bx:
            ax, ay, bx, by = bx, by, ax, ay
        slope = (by - ay) / (bx - ax) if bx > ax else 0.0
        from_row = max(first, math.floor((ax - slack - lower[0]) / cell))
        to_row = min(end, math.floor((bx + slack - lower[0]) / cell) + 1)
        for row in range(from_row, to_row):
            left = lower[0] + row * cell - slack
            a = min(max(ax, left), bx)
            b = max(min(bx, left + cell + 2.0 * slack), ax)
            ya, yb = ay + slope * (a - ax), by - slope * (bx - b)
            if bx == ax:
                ya, yb = ay, by
            low[row] = min(low[row], min(ya, yb) - slack)
            high[row] = max(high[row], max(ya, yb) + slack)
    return first, end


@compiled
def paint(
    plane: Levels, ring: Array, size: int, slack: float, lower: Array, cell: float, level: int
) -> None:
    """Give all cells a convex ring meets a level."""
    rows, columns = plane.shape
    low, high = np.empty(rows), np.empty(rows)
    first, end = row_spans(ring, size, slack, lower, cell, low, high)
    for row in range(first, end):
        start = max(0, math.floor((low[row] - lower[1]) / cell))
        stop = min(columns, math.floor((high[row] - lower[1]) / cell) + 1)
        plane[row, start:stop] = level


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
        norm = norms[level]
        duration = 0.5 * norm / timing[1]
        turn = abs(motions[errors // 2, 1]) * norm * (timing[0] + 0.5 * duration)
        way = 0.5 * norm * (timing[0] + 0.5 * duration)
        ways = min(castor_samples, 2 + int(turn / 0.1))
        samples = min(pose_samples, 5 + int(way / 0.06 + turn / 0.08))
        for which in range(2):
            norm = norms[level - which]
            target = faster if which == 0 else slower
            duration = 0.5 * norm / timing[1]
            for e in range(errors):
                v, omega = motions[e, 0] * norm, motions[e, 1] * norm
                for c in range(ways):
                    poses = target[e, c, :samples]
                    braking_poses(v, omega, duration, timing[0], c / (ways - 1.0), poses)
        for c in range(ways - 1):
            for i in range(samples - 1):
                count, slack = _gather(faster, slower, c, i, body, radius, points)
                size = hull_in_place(points, count, ring)
                paint(plane, ring, size, slack, lower, cell, level)
    paint(plane, body, corners, 0.0, lower, cell, 0)


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


@compiled
def paint_parts(
    parts: Levels, poses: Array, body: Array, lower: Array, cell: float, scratch: Array
) -> None:
    """Give all cells a moving body meets the part of the body that meets them first.

    Args:
        parts: Codes as in `narrows.reactive.side_tables.PARTS`, shape (rows, columns).
        poses: Poses of the body in order, shape (P, 3).
        body: Corners, counter-clockwise, shape (K, 2), [m].
        lower: Corner of the grid [m], shape (2,).
        cell: Edge of a cell [m].
        scratch: Shape (K, 2).
    """
    rows, columns = parts.shape
    low, high = np.empty(rows), np.empty(rows)
    for i in range(len(poses) - 1, -1, -1):  # the earliest pose paints last
        x, y, heading = poses[i]
        cosine, sine = math.cos(heading), math.sin(heading)
        for k in range(len(body)):
            scratch[k, 0] = x + cosine * body[k, 0] - sine * body[k, 1]
            scratch[k, 1] = y + sine * body[k, 0] + cosine * body[k, 1]
        first, end = row_spans(scratch, len(body), 0.0, lower, cell, low, high)
        for row in range(first, end):
            start = max(0, math.floor((low[row] - lower[1]) / cell))
            stop = min(columns, math.floor((high[row] - lower[1]) / cell) + 1)
            for column in range(start, stop):
                dx = lower[0] + (row + 0.5) * cell - x
                dy = lower[1] + (column + 0.5) * cell - y
                parts[row, column] = part_met(
                    body, cosine * dx + sine * dy, cosine * dy - sine * dx
                )


@compiled
def part_met(body: Array, x: float, y: float) -> int:
    """Return which part of a body a point in its frame is nearest to, by the edge it is beyond.

    Front 0, 1; side ahead of the axle 2, 3; side behind it 4, 5; rear 6, 7: the even ones left.
    """
    best, normal_x, normal_y = -math.inf, 0.0, 0.0
    for k in range(len(body)):
        j = k + 1 if k + 1 < len(body) else 0
        ex, ey = body[j, 0] - body[k, 0], body[j, 1] - body[k, 1]
        length = math.hypot(ex, ey)
        nx, ny = ey / length, -ex / length
        distance = nx * (x - body[k, 0]) + ny * (y - body[k, 1])
        if distance > best:
            best, normal_x, normal_y = distance, nx, ny
    right = 1 if y < 0.0 else 0
    if abs(normal_x) >= abs(normal_y):
        return right if normal_x > 0.0 else 6 + right
    return (2 if x >= 0.0 else 4) + right
