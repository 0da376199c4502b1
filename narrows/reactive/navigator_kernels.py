"""The compiled loops of the guard: the way to a stop, and what is in it.

Imported when first needed, compiled on the first call, kept on disk.
"""

from __future__ import annotations

import math

import numpy as np

from ..se2 import Array
from .zone_kernels import compiled


@compiled
def _goal(
    time: float,
    pending: Array,
    under_way: float,
    command: Array,
    period: float,
    fade: float,
) -> tuple[float, float]:
    """Return the v and omega asked for at a time [s] on the way to a stop.

    Args:
        time: From now [s].
        pending: Rows [duration, v, omega] of commands under way, shape (Q, 3).
        under_way: Sum of their durations [s].
        command: v, omega to be judged, shape (2,).
        period: Control period [s].
        fade: Share of the command by which it fades each period; infinite: at once.
    """
    if time < under_way:
        start, row = 0.0, 0
        while start + pending[row, 0] < time:
            start += pending[row, 0]
            row += 1
        return pending[row, 1], pending[row, 2]
    stage = math.floor((time - under_way) / period)
    share = 1.0 if stage == 0 else max(0.0, 1.0 - stage * fade) if fade < np.inf else 0.0
    return share * command[0], share * command[1]


@compiled
def stopping_poses(
    twist: Array,
    pending: Array,
    command: Array,
    rates: tuple[float, float],
    period: float,
    step: float,
    lag: float,
    radius: float,
    apart: float,
) -> tuple[Array, Array]:
    """Return poses on the way to a stop, body frame of now, and a bound on what lies between.

    The commands still on their way come first, then the given one for a period, then it fades,
    both parts alike, period by period. The chair answers each with a first-order lag.

    Args:
        twist: v, omega the chair has now, shape (2,).
        pending: Rows [duration, v, omega] of commands under way, shape (Q, 3).
        command: v, omega to be judged, shape (2,).
        rates: Greatest rates of v and omega while braking [m/s^2, rad/s^2].
        period: Control period [s].
        step: Step of the integration [s], a fraction of the period.
        lag: Time constant [s]; 0: at once.
        radius: Of the body about its origin [m].
        apart: Greatest way of a body point between poses that are returned [m].

    Returns:
        Rows [t, x, y, heading], shape (P, 4), and how far a body point is from its place at the
        nearer of the rows beside it, at most, shape (P,).
    """
    fade = _fade(command, rates, period)
    stages = 1 if fade == np.inf else 1 + math.ceil(1.0 / fade)
    under_way = pending[:, 0].sum()
    count = math.ceil((under_way + stages * period + 4.0 * lag) / step) + 1
    rows = np.zeros((count + 1, 4))
    between = np.zeros(count + 1)
    # The mean over a step of an exponential answer is for its way; its end, for the next step.
    decay = math.exp(-step / lag) if lag > 0.0 else 0.0
    mean = (1.0 - decay) * lag / step
    v, omega = twist[0], twist[1]
    x = y = heading = 0.0
    kept, moved = 1, 0.0
    for k in range(1, count + 1):
        goal_v, goal_omega = _goal((k - 0.5) * step, pending, under_way, command, period, fade)
        way = (goal_v + (v - goal_v) * mean) * step
        turn = (goal_omega + (omega - goal_omega) * mean) * step
        v = goal_v + (v - goal_v) * decay
        omega = goal_omega + (omega - goal_omega) * decay
        x += way * math.cos(heading + 0.5 * turn)
        y += way * math.sin(heading + 0.5 * turn)
        heading += turn
        moved += abs(way) + radius * abs(turn)
        if moved > apart or k == count or k % 5 == 0:
            rows[kept] = (k * step, x, y, heading)
            between[kept] = 0.5 * moved
            between[kept - 1] = max(between[kept - 1], 0.5 * moved)
            kept += 1
            moved = 0.0
    return rows[:kept], between[:kept]


@compiled
def _fade(command: Array, rates: tuple[float, float], period: float) -> float:
    """Return the share of a command by which braking fades it each period; infinite: at once."""
    fade = np.inf
    if abs(command[0]) > 0.0:
        fade = rates[0] * period / abs(command[0])
    if abs(command[1]) > 0.0:
        fade = min(fade, rates[1] * period / abs(command[1]))
    return fade


@compiled
def is_way_free(
    points: Array,
    walking: Array,
    rows: Array,
    between: Array,
    normals: Array,
    offsets: Array,
    heights: Array,
    margins: Array,
    blind: float,
) -> int:
    """Return the first point in the way of a stopping body, or -1.

    A point is in the way if it may come nearer than its margin. One that stands and is that near
    already must not come nearer; one in the body already forbids any motion (one whose margin is
    negative: if it is that deep). Distances to a
    polygon are those to the furthest of its edges' lines: never more than the true ones.

    Args:
        points: Body frame of now, shape (N, 3), [m].
        walking: How fast each point may move [m/s], shape (N,).
        rows: Poses [t, x, y, heading], shape (P, 4), the first one now.
        between: Bound on body points' ways from the nearer row, shape (P,), [m].
        normals: Outward normals of each layer's edges, shape (L, E, 2).
        offsets: Of the edges' lines, shape (L, E), [m].
        heights: Lowest and highest point of each layer, shape (L, 2), [m].
        margins: Distance to keep from each point, shape (N,), [m].
        blind: Age of the points [s].
    """
    fastest = walking.max() if len(walking) else 0.0
    widest = margins.max() if len(margins) else 0.0
    slack = widest + between.max() + fastest * (rows[-1, 0] + blind)
    low_x, high_x, low_y, high_y = _swept_box(rows, normals, offsets)
    for n in range(len(points)):
        x, y, z = points[n, 0], points[n, 1], points[n, 2]
        if x < low_x - slack or x > high_x + slack or y < low_y - slack or y > high_y + slack:
            continue
        for layer in range(len(offsets)):
            if not heights[layer, 0] < z < heights[layer, 1]:
                continue
            first = _distance(x, y, normals[layer], offsets[layer])
            if first <= min(margins[n], 0.0):
                return n
            for k in range(len(rows)):
                needed = margins[n] + between[k] + walking[n] * (rows[k, 0] + blind)
                distance = _distance_from(rows[k], x, y, normals[layer], offsets[layer])
                if distance < needed and (walking[n] > 0.0 or distance < first - 1e-6):
                    return n
    return -1


@compiled
def _distance_from(row: Array, x: float, y: float, normals: Array, offsets: Array) -> float:
    """Return `_distance` of a point from the polygon of a body at a row [t, x, y, heading]."""
    cos, sin = math.cos(row[3]), math.sin(row[3])
    x, y = x - row[1], y - row[2]
    return _distance(cos * x + sin * y, cos * y - sin * x, normals, offsets)


@compiled
def _swept_box(rows: Array, normals: Array, offsets: Array) -> tuple[float, float, float, float]:
    """Return x_min, x_max, y_min, y_max of a body at all its poses; a corner joins two edges."""
    low_x, high_x, low_y, high_y = np.inf, -np.inf, np.inf, -np.inf
    for layer in range(len(offsets)):
        for edge in range(offsets.shape[1]):
            follow = (edge + 1) % offsets.shape[1]
            a, b = normals[layer, edge], normals[layer, follow]
            cross = a[0] * b[1] - a[1] * b[0]
            if abs(cross) < 1e-12:
                continue
            corner_x = (offsets[layer, edge] * b[1] - offsets[layer, follow] * a[1]) / cross
            corner_y = (offsets[layer, follow] * a[0] - offsets[layer, edge] * b[0]) / cross
            for row in rows:
                cos, sin = math.cos(row[3]), math.sin(row[3])
                x = row[1] + cos * corner_x - sin * corner_y
                y = row[2] + sin * corner_x + cos * corner_y
                low_x, high_x = min(low_x, x), max(high_x, x)
                low_y, high_y = min(low_y, y), max(high_y, y)
    return low_x, high_x, low_y, high_y


@compiled
def _distance(x: float, y: float, normals: Array, offsets: Array) -> float:
    """Return a lower bound on a point's distance from a convex polygon, negative inside."""
    furthest = -np.inf
    for edge in range(len(offsets)):
        furthest = max(furthest, normals[edge, 0] * x + normals[edge, 1] * y - offsets[edge])
    return furthest
