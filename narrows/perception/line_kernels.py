"""The compiled loops that find straight pieces in the returns of a scan."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from ..se2 import Array
from .compiled import compiled


@compiled
def straight_pieces(
    points: Array, beams: NDArray[np.int64], step: float, slant: float, error: float, least: int
) -> NDArray[np.int64]:
    """Return the first and the last point of each straight piece, shape (K, 2).

    Neighbours belong together if a wall that the beams meet at `slant` or steeper could have
    returned them (the adaptive break point of Borges and Aldon); what belongs together is split
    where it is furthest from its chord until it is straight within three errors and a centimetre.

    Args:
        points: Returns in the order of the beams, seen from the sensor, shape (N, 2), [m].
        beams: Number of the beam of each, increasing, shape (N,).
        step: Angle from beam to beam [rad], > 0.
        slant: Flattest angle between a beam and a wall [rad].
        error: Standard deviation of a range [m].
        least: Fewest points of a piece.
    """
    pieces = np.empty((len(points) + 1, 2), dtype=np.int64)
    waiting = np.empty((len(points) + 1, 2), dtype=np.int64)
    count = first = 0
    for point in range(1, len(points) + 1):
        if point < len(points) and _are_neighbours(points, beams, point, step, slant, error):
            continue
        waiting[0, 0], waiting[0, 1] = first, point - 1
        stack = 1
        while stack > 0:
            stack -= 1
            a, b = waiting[stack]
            if b - a + 1 < least:
                continue
            furthest, off = _furthest_from_chord(points, a, b)
            if off <= 3.0 * error + 0.01:
                pieces[count, 0], pieces[count, 1] = a, b
                count += 1
            else:
                waiting[stack, 0], waiting[stack, 1] = furthest, b
                waiting[stack + 1, 0], waiting[stack + 1, 1] = a, furthest
                stack += 2
        first = point
    return pieces[:count].copy()


@compiled
def _are_neighbours(
    points: Array, beams: NDArray[np.int64], point: int, step: float, slant: float, error: float
) -> bool:
    """Return whether one wall can have returned a point and the one before it."""
    apart = (beams[point] - beams[point - 1]) * step
    if apart >= slant:
        return False
    before = math.hypot(points[point - 1, 0], points[point - 1, 1])
    most = before * math.sin(apart) / math.sin(slant - apart) + 3.0 * error
    dx = points[point, 0] - points[point - 1, 0]
    dy = points[point, 1] - points[point - 1, 1]
    return bool(math.hypot(dx, dy) <= most)


@compiled
def _furthest_from_chord(points: Array, a: int, b: int) -> tuple[int, float]:
    """Return the inner point furthest from the line through two points, and its distance [m]."""
    dx, dy = points[b, 0] - points[a, 0], points[b, 1] - points[a, 1]
    length = math.hypot(dx, dy)
    most, where = 0.0, a + 1
    for point in range(a + 1, b):
        x, y = points[point, 0] - points[a, 0], points[point, 1] - points[a, 1]
        off = abs(dx * y - dy * x) / length if length > 1e-9 else math.hypot(x, y)
        if off > most:
            most, where = off, point
    return where, most
