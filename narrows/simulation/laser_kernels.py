"""The compiled loops of the simulated laser scanner: an angular z-buffer of inverse ranges.

In the sensor's frame the inverse range of a straight wall is (n . e) / d, with e the beam's
direction, n the wall's outward normal and d its distance: a product for each beam it spans. The
greatest inverse range of a beam is what it meets first, exactly.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from ..perception.compiled import compiled
from ..se2 import Array

_EDGE_ON = 1e-9  # m: nearer than this to a wall's line the sensor looks along it
_SLACK = 1e-9  # of a beam: a corner hit to rounding is hit


@compiled
def scan_level(
    inverse: Array,
    beams: Array,
    first: float,
    step: float,
    pose: Array,
    height: float,
    reach: float,
    corners: Array,
    counts: NDArray[np.int64],
    heights: Array,
    rounds: Array,
) -> bool:
    """Fill in the inverse range of what each beam of a level scanner meets; 0 where it is nothing.

    Args:
        inverse: Shape (B,), [1/m]; overwritten.
        beams: Directions of the beams in the sensor's frame, shape (B, 2).
        first: Angle of the first beam, in [-pi, pi], [rad].
        step: Angle from beam to beam [rad]; any if there is only one.
        pose: The sensor in the world, shape (3,), [m, m, rad].
        height: Above the floor [m].
        reach: What is further is left out [m].
        corners: As in `Surfaces`.
        counts: As in `Surfaces`.
        heights: As in `Surfaces`.
        rounds: As in `Surfaces`.

    Returns:
        False if the sensor is inside a solid or on it; the ranges are then of no use.
    """
    inverse[:] = 0.0
    local = np.empty((corners.shape[1], 2))
    c, s = math.cos(pose[2]), math.sin(pose[2])
    for piece in range(len(corners)):
        if heights[piece, 0] > height or heights[piece, 1] < height:
            continue
        count = counts[piece]
        low_x, low_y, high_x, high_y = np.inf, np.inf, -np.inf, -np.inf
        for k in range(count):
            dx, dy = corners[piece, k, 0] - pose[0], corners[piece, k, 1] - pose[1]
            low_x, high_x = min(low_x, dx), max(high_x, dx)
            low_y, high_y = min(low_y, dy), max(high_y, dy)
            local[k, 0], local[k, 1] = c * dx + s * dy, c * dy - s * dx
        gap_x, gap_y = max(low_x, -high_x, 0.0), max(low_y, -high_y, 0.0)
        if gap_x * gap_x + gap_y * gap_y > reach * reach:
            continue
        if not _scan_piece(inverse, beams, first, step, local[:count]):
            return False
    for row in range(len(rounds)):
        solid = rounds[row]
        if solid[3] > height or solid[4] < height:
            continue
        dx, dy = solid[0] - pose[0], solid[1] - pose[1]
        if math.hypot(dx, dy) - solid[2] > reach:
            continue
        if not _scan_round(inverse, beams, first, step, c * dx + s * dy, c * dy - s * dx, solid[2]):
            return False
    return True


@compiled
def _scan_piece(inverse: Array, beams: Array, first: float, step: float, corners: Array) -> bool:
    """Scan a convex polygon of the sensor's frame; return False from inside."""
    outside = False
    for k in range(len(corners)):
        a = corners[k]
        b = corners[k + 1 if k + 1 < len(corners) else 0]
        ex, ey = b[0] - a[0], b[1] - a[1]
        length = math.hypot(ex, ey)
        if length == 0.0:
            continue
        nx, ny = ey / length, -ex / length
        distance = nx * a[0] + ny * a[1]  # < 0: the sensor is on the outer side
        if distance > -_EDGE_ON:
            continue
        outside = True
        # Seen from outside, a counter-clockwise polygon's edges run clockwise: from b to a.
        begin = math.atan2(b[1], b[0])
        span = math.atan2(b[0] * a[1] - b[1] * a[0], b[0] * a[0] + b[1] * a[1])
        nx, ny = nx / distance, ny / distance
        for turn in range(-1, 2):
            low, high = _beams(begin + turn * 2.0 * math.pi, span, first, step, len(inverse))
            for beam in range(low, high + 1):
                w = nx * beams[beam, 0] + ny * beams[beam, 1]
                inverse[beam] = max(inverse[beam], w)
    return outside


@compiled
def _scan_round(
    inverse: Array, beams: Array, first: float, step: float, cx: float, cy: float, radius: float
) -> bool:
    """Scan a circle of the sensor's frame; return False from inside."""
    outside = cx * cx + cy * cy - radius * radius
    if outside < _EDGE_ON:
        return False
    half = math.asin(radius / math.hypot(cx, cy))
    begin = math.atan2(cy, cx) - half
    for turn in range(-1, 2):
        low, high = _beams(begin + turn * 2.0 * math.pi, 2.0 * half, first, step, len(inverse))
        for beam in range(low, high + 1):
            along = cx * beams[beam, 0] + cy * beams[beam, 1]
            w = (along + math.sqrt(max(along * along - outside, 0.0))) / outside
            inverse[beam] = max(inverse[beam], w)
    return True


@compiled
def _beams(begin: float, span: float, first: float, step: float, count: int) -> tuple[int, int]:
    """Return the first and the last beam between two angles."""
    low = math.ceil((begin - first) / step - _SLACK)
    high = math.floor((begin + span - first) / step + _SLACK)
    return max(low, 0), min(high, count - 1)
