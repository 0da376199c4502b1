"""The compiled loops of the simulated depth camera: a z-buffer of inverse depths.

Over the image the inverse depth of a plane is affine: w = a u + b, by row v. A convex solid is an
intersection of half-spaces; those whose plane the camera is outside of bound w from above, the
others from below. A pixel sees the solid where the least upper bound is above the greatest lower
one, and sees it at the former: exactly, pixel by pixel, without a ray being cast.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from ..perception.compiled import compiled
from ..se2 import Array

_EDGE_ON = 1e-9  # m: nearer than this to a plane the camera is in it
_FRONT, _BACK, _CUT = 0, 1, 2


@compiled
def draw_world(
    inverse: Array,
    basis: Array,
    origin: Array,
    corners: Array,
    counts: NDArray[np.int64],
    heights: Array,
    rounds: Array,
    reach: float,
) -> bool:
    """Fill an image with the inverse depth of what it shows; 0 where that is nothing.

    Args:
        inverse: The image, shape (height, width), [1/m]; overwritten.
        basis: The ray of pixel (u, v) per unit of depth is basis @ [u, v, 1], world axes, (3, 3).
        origin: The camera in the world, z above the floor, shape (3,), [m].
        corners: As in `Surfaces`.
        counts: As in `Surfaces`.
        heights: As in `Surfaces`.
        rounds: As in `Surfaces`.
        reach: Solids further than this, seen from above, are left out [m].

    Returns:
        False if the camera is inside or on a solid; the image is then of no use.
    """
    planes = np.empty((3, corners.shape[1] + 4, 3))
    number = np.zeros(3, dtype=np.int64)
    _clear(number)
    _floor(inverse, basis, origin)
    for piece in range(len(corners)):
        if _box_distance(corners[piece, : counts[piece]], origin) > reach:
            continue
        _clear(number)
        for k in range(counts[piece]):
            a = corners[piece, k]
            b = corners[piece, k + 1 if k + 1 < counts[piece] else 0]
            length = math.hypot(b[0] - a[0], b[1] - a[1])
            if length == 0.0:
                continue
            nx, ny = (b[1] - a[1]) / length, (a[0] - b[0]) / length  # outward
            offset = nx * (a[0] - origin[0]) + ny * (a[1] - origin[1])
            _add(planes, number, basis, nx, ny, 0.0, offset)
        _add(planes, number, basis, 0.0, 0.0, 1.0, heights[piece, 1] - origin[2])
        _add(planes, number, basis, 0.0, 0.0, -1.0, origin[2] - heights[piece, 0])
        if number[_FRONT] == 0:
            return False
        _draw_prism(inverse, planes, number)
    for row in range(len(rounds)):
        solid = rounds[row]
        if math.hypot(solid[0] - origin[0], solid[1] - origin[1]) - solid[2] > reach:
            continue
        if not _draw_round(inverse, planes, number, basis, origin, solid):
            return False
    return True


@compiled
def _box_distance(corners: Array, origin: Array) -> float:
    """Return the distance from above to the box around corners."""
    gap = np.zeros(2)
    for axis in range(2):
        low, high = np.inf, -np.inf
        for k in range(len(corners)):
            low, high = min(low, corners[k, axis]), max(high, corners[k, axis])
        gap[axis] = max(low - origin[axis], origin[axis] - high, 0.0)
    return math.hypot(gap[0], gap[1])


@compiled
def _clear(number: NDArray[np.int64]) -> None:
    number[_FRONT] = number[_BACK] = number[_CUT] = 0


@compiled
def _floor(inverse: Array, basis: Array, origin: Array) -> None:
    """Write the floor, or 0 above the horizon."""
    for v in range(inverse.shape[0]):
        start = -(basis[2, 1] * v + basis[2, 2]) / origin[2]
        slope = -basis[2, 0] / origin[2]
        for u in range(inverse.shape[1]):
            inverse[v, u] = max(start + slope * u, 0.0)


@compiled
def _add(
    planes: Array,
    number: NDArray[np.int64],
    basis: Array,
    nx: float,
    ny: float,
    nz: float,
    offset: float,
) -> None:
    """Add the half-space n . p <= offset, p from the camera, to the planes of its kind.

    Front: w <= row . [u, v, 1]; back: w >= that; cut, the camera being in the plane: 0 >= that.
    """
    kind, scale = _CUT, 1.0
    if offset < -_EDGE_ON:
        kind, scale = _FRONT, 1.0 / offset
    elif offset > _EDGE_ON:
        kind, scale = _BACK, 1.0 / offset
    row = planes[kind, number[kind]]
    for k in range(3):
        row[k] = scale * (nx * basis[0, k] + ny * basis[1, k] + nz * basis[2, k])
    number[kind] += 1


@compiled
def _columns(
    planes: Array, number: NDArray[np.int64], v: int, width: int, starts: Array
) -> tuple[int, int]:
    """Return the first and the last column of a row in which fronts, backs and cuts agree."""
    low, high = 0.0, width - 1.0
    for kind in range(3):
        for k in range(number[kind]):
            starts[kind, k] = planes[kind, k, 1] * v + planes[kind, k, 2]
    for k in range(number[_CUT]):
        low, high = _bounded(low, high, -planes[_CUT, k, 0], -starts[_CUT, k])
    for i in range(number[_FRONT]):
        slope, start = planes[_FRONT, i, 0], starts[_FRONT, i]
        low, high = _bounded(low, high, slope, start)  # the solid is ahead
        for j in range(number[_BACK]):
            low, high = _bounded(low, high, slope - planes[_BACK, j, 0], start - starts[_BACK, j])
    if not low <= high:
        return 1, 0
    return math.ceil(low), math.floor(high)


@compiled
def _bounded(low: float, high: float, slope: float, start: float) -> tuple[float, float]:
    """Return the part of an interval in which slope u + start >= 0."""
    if slope > 0.0:
        low = max(low, -start / slope)
    elif slope < 0.0:
        high = min(high, -start / slope)
    elif start < 0.0:
        high = -1.0
    return low, high


@compiled
def _draw_prism(inverse: Array, planes: Array, number: NDArray[np.int64]) -> None:
    """Draw a convex polyhedron given by its planes."""
    starts = np.empty(planes.shape[:2])
    width = inverse.shape[1]
    for v in range(inverse.shape[0]):
        first, last = _columns(planes, number, v, width, starts)
        row = inverse[v]
        if number[_FRONT] == 1:
            slope, start = planes[_FRONT, 0, 0], starts[_FRONT, 0]
            for u in range(first, last + 1):
                row[u] = max(row[u], slope * u + start)
        elif number[_FRONT] == 2:
            slope, start = planes[_FRONT, 0, 0], starts[_FRONT, 0]
            other, begin = planes[_FRONT, 1, 0], starts[_FRONT, 1]
            for u in range(first, last + 1):
                row[u] = max(row[u], min(slope * u + start, other * u + begin))
        else:
            for u in range(first, last + 1):
                w = planes[_FRONT, 0, 0] * u + starts[_FRONT, 0]
                for k in range(1, number[_FRONT]):
                    w = min(w, planes[_FRONT, k, 0] * u + starts[_FRONT, k])
                row[u] = max(row[u], w)


@compiled
def _draw_round(
    inverse: Array,
    planes: Array,
    number: NDArray[np.int64],
    basis: Array,
    origin: Array,
    solid: Array,
) -> bool:
    """Draw an upright cylinder [x, y, radius, low, high]; return False if the camera is inside.

    From above the ray w -> h / w meets the circle where K w^2 - 2 (h . c) w + h . h = 0, with c
    its centre from the camera and K = c . c - r^2.
    """
    cx, cy, radius = solid[0] - origin[0], solid[1] - origin[1], solid[2]
    outside = cx * cx + cy * cy - radius * radius
    if abs(outside) < _EDGE_ON:
        outside = _EDGE_ON
    _clear(number)
    _add(planes, number, basis, 0.0, 0.0, 1.0, solid[4] - origin[2])
    _add(planes, number, basis, 0.0, 0.0, -1.0, origin[2] - solid[3])
    if number[_FRONT] == 0 and outside < 0.0:
        return False
    if outside > 0.0:
        # Seen from above it lies between the two tangents through the camera, each a cut.
        root = math.sqrt(outside)
        for side in (-1.0, 1.0):
            tx, ty = root * cx - side * radius * cy, root * cy + side * radius * cx
            _add(planes, number, basis, -side * ty, side * tx, 0.0, 0.0)
    starts = np.empty(planes.shape[:2])
    for v in range(inverse.shape[0]):
        first, last = _columns(planes, number, v, inverse.shape[1], starts)
        hx0, hy0 = basis[0, 1] * v + basis[0, 2], basis[1, 1] * v + basis[1, 2]
        for u in range(first, last + 1):
            hx, hy = hx0 + basis[0, 0] * u, hy0 + basis[1, 0] * u
            along, square = hx * cx + hy * cy, hx * hx + hy * hy
            root = math.sqrt(max(along * along - outside * square, 0.0))
            upper, lower = np.inf, (along - root) / outside
            if outside > 0.0:
                upper = (along + root) / outside
            for k in range(number[_FRONT]):
                upper = min(upper, planes[_FRONT, k, 0] * u + starts[_FRONT, k])
            for k in range(number[_BACK]):
                lower = max(lower, planes[_BACK, k, 0] * u + starts[_BACK, k])
            if upper >= lower and upper > inverse[v, u]:
                inverse[v, u] = upper
    return True
