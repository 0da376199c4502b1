"""The compiled loops of the deformable zone: points to rays, rays to intrusion and derivatives.

Imported when first needed, compiled on the first call, kept on disk.
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


def compiled(function: Function) -> Function:
    """Return the function compiled on its first call, division by zero giving infinity."""
    return cast(Function, numba.njit(cache=True, error_model="numpy")(function))


@compiled
def nearest_points(
    points: Array,
    spread: float,
    zone: tuple[float, float, float, float, float],
    least: float,
    latitudes: Array,
    columns: int,
) -> tuple[Array, NDArray[np.int64]]:
    """Return the nearest range on every ray of a grid and the point that gave it, -1: none.

    Args:
        points: Body frame, z above the floor, shape (N, 3), [m].
        spread: How far an obstacle may reach beyond a point, seen from above [m].
        zone: c_x, center height, squash, lowest and highest height.
        least: Ranges are not taken shorter than this [m].
        latitudes: Edges of the rows, shape (R + 1,), increasing, [rad].
        columns: Number of azimuths; the first begins at -pi.
    """
    c_x, center, squash, low, high = zone
    rows = len(latitudes) - 1
    ranges = np.full((rows, columns), np.inf)
    index = np.full((rows, columns), -1, dtype=np.int64)
    step = 2.0 * math.pi / columns
    for n in range(len(points)):
        x, y, z = points[n, 0], points[n, 1], points[n, 2]
        if not low <= z < high:
            continue
        up = squash * (z - center)
        flat = math.hypot(x, y)
        distance = math.hypot(flat, up)
        if distance - spread > 5.0 / 9.0 * c_x + 2.0 / 3.0 * (x + spread):
            continue  # outside the ellipsoid, its spread too
        latitude = math.atan2(up, flat)
        row = int(np.searchsorted(latitudes, latitude, side="right")) - 1
        row = min(max(row, 0), rows - 1)
        seen = max(distance - spread, least)
        half = 0.5 * math.pi if spread >= flat else math.asin(spread / flat)
        azimuth = math.atan2(y, x) + math.pi
        first = math.floor((azimuth - half) / step)
        last = math.floor((azimuth + half) / step)
        for column in range(first, last + 1):
            wrapped = column % columns
            if seen < ranges[row, wrapped]:
                ranges[row, wrapped] = seen
                index[row, wrapped] = n
    return ranges, index


@compiled
def stand_upright(
    ranges: Array, index: NDArray[np.int64], middles: Array, top: float
) -> tuple[Array, NDArray[np.int64]]:
    """Return ranges as if the nearest obstacle of each azimuth stood from floor to ceiling.

    Args:
        ranges: Shape (R, C), [m].
        index: The points that gave them, shape (R, C).
        middles: Latitudes of the rows' middles, shape (R,), [rad].
        top: Squashed height of the body above the focus, and below it [m].
    """
    rows, columns = ranges.shape
    filled = np.full((rows, columns), np.inf)
    owner = np.full((rows, columns), -1, dtype=np.int64)
    for column in range(columns):
        flat, best = np.inf, -1
        for row in range(rows):
            if index[row, column] >= 0:
                across = ranges[row, column] * math.cos(middles[row])
                if across < flat:
                    flat, best = across, index[row, column]
        if best < 0:
            continue
        for row in range(rows):
            if abs(flat * math.tan(middles[row])) <= top or rows == 1:
                filled[row, column] = flat / math.cos(middles[row])
                owner[row, column] = best
    return filled, owner


@compiled
def measure_rays(
    ranges: Array, drift: Array, middles: Array, steps: tuple[float, float], c_x: float, jump: float
) -> tuple[float, float, float, float, float, int]:
    """Return sums over the intruded rays; see `narrows.reactive.deformable_zone`.

    Args:
        ranges: c, shape (R, C), infinite where nothing is, [m].
        drift: Velocity of what is seen over the floor, body frame, shape (R, C, 2), [m/s].
        middles: Latitudes of the rows, shape (R,), [rad].
        steps: Width of a column and height of a row [rad].
        c_x: Half the long axis [m].
        jump: Neighbours of which one is further away by this share are two surfaces.

    Returns:
        I, the sum of d_h / c, J_alpha, F for the chair's own speed 1, F for the obstacles, rays.
    """
    rows, columns = ranges.shape
    d_theta, d_phi = steps
    area = d_theta * d_phi
    intrusion = swelling = turning = own = others = 0.0
    count = 0
    standing = np.zeros((rows, columns, 2))
    standing[:, :, 0] = -1.0  # the chair's own way at unit speed: what stands comes nearer
    for row in range(rows):
        phi = middles[row]
        for column in range(columns):
            theta = -math.pi + (column + 0.5) * d_theta
            c = ranges[row, column]
            reach = _reach(theta, phi, c_x)
            if not c < reach:
                continue
            count += 1
            intrusion += (reach / c - 1.0) * area
            swelling += reach / c * area
            steep = 6.0 / (5.0 * c_x) * reach * reach
            turning += steep / c * math.sin(theta) * math.cos(phi) * area
            place = (row, column, theta)
            own += _flow(ranges, standing, middles, place, steps, c_x, jump)
            if drift[row, column, 0] != 0.0 or drift[row, column, 1] != 0.0:
                others += _flow(ranges, drift, middles, place, steps, c_x, jump)
    return intrusion, swelling, turning, own, others, count


@compiled
def _reach(theta: float, phi: float, c_x: float) -> float:
    """Return d_h."""
    return 5.0 / 9.0 * c_x / (1.0 - 2.0 / 3.0 * math.cos(theta) * math.cos(phi))


@compiled
def _approach(drift: Array, row: int, column: int, theta: float) -> tuple[float, float]:
    """Return a, how fast a ray's surface comes nearer, and b, how fast it moves to the left."""
    x, y = drift[row, column, 0], drift[row, column, 1]
    cos, sin = math.cos(theta), math.sin(theta)
    return -(x * cos + y * sin), y * cos - x * sin


@compiled
def _flow(
    ranges: Array,
    drift: Array,
    middles: Array,
    place: tuple[int, int, float],
    steps: tuple[float, float],
    c_x: float,
    jump: float,
) -> float:
    """Return what a ray adds to dI/dt by the motion of what it sees: its own sum and its ends."""
    row, column, theta = place
    rows, columns = ranges.shape
    d_theta, d_phi = steps
    phi = middles[row]
    c = ranges[row, column]
    reach = _reach(theta, phi, c_x)
    a, b = _approach(drift, row, column, theta)
    steep = -6.0 / (5.0 * c_x) * reach * reach
    by_theta = steep * math.sin(theta) * math.cos(phi)
    total: float = reach * a * math.cos(phi) + 0.5 * (by_theta * b + reach * a) / math.cos(phi)
    if rows > 1:
        by_phi = steep * math.cos(theta) * math.sin(phi)
        total += 0.5 * a * (by_phi * math.sin(phi) + reach * math.cos(phi))
    total *= d_theta * d_phi / (c * c)
    for side in (-1, 1):
        beside = (column + side) % columns
        edge = theta + 0.5 * side * d_theta
        reach = _reach(edge, phi, c_x)
        other = ranges[row, beside]
        outside = not other < _reach(theta + side * d_theta, phi, c_x)
        beyond = _approach(drift, row, beside, edge)[1]
        b = _approach(drift, row, column, edge)[1]
        total += side * d_phi * _edge(reach, b, beyond, c, other, outside, jump) / math.cos(phi)
        if rows > 1:
            edge = phi + 0.5 * side * d_phi
            reach = _reach(theta, edge, c_x)
            rise = a * math.sin(edge)
            if not 0 <= row + side < rows:  # the grid's own edge cuts, and does not move
                total -= side * d_theta * rise * reach / (2.0 * c * c)
                continue
            other = ranges[row + side, column]
            outside = not other < _reach(theta, phi + side * d_phi, c_x)
            beyond = _approach(drift, row + side, column, theta)[0] * math.sin(edge)
            total += side * d_theta * _edge(reach, rise, beyond, c, other, outside, jump)
    return total


@compiled
def _edge(
    reach: float, rate: float, beyond: float, c: float, other: float, outside: bool, jump: float
) -> float:
    """Return what passes between a ray and its neighbour: nothing within one surface.

    Where the neighbour is not intruded the interval ends. Where it is another surface, further
    away, the edge moves with the nearer one; what the neighbour sums to is counted here too.
    """
    if outside:
        return rate * (reach / (2.0 * c * c) - 1.0 / c)
    if c < other and (other - c > jump * c or abs(rate - beyond) > 1e-9):
        near, far = 1.0 / c, 1.0 / other
        return 0.5 * reach * (rate * near * near - 2.0 * rate * near * far + beyond * far * far)
    return 0.0
