"""Is the exact body clear along an arc? Proven by conservative advancement, compiled.

At a pose the signed gap between body and solid and the axis n that shows it are exact. Driving on
with constant twist, corner p of the body moves along n by at most

    (n.v_p) s + |omega| |v_p| s^2 / 2,

v_p its velocity now, because a velocity that turns at omega changes at |omega| |v_p|. The body is
clear as long as no corner spends the gap it has along n; there the gap is measured again. Sliding
along a wall costs one measurement, driving at it many short ones: until the gap is below the
floor, and the arc is refused.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..se2 import Array
from .compiled import compiled

MOST_LOOKS = 200
"""Measurements of one solid along one arc before the arc is refused."""


class Solids(NamedTuple):
    """The body's layers and the convex pieces each can meet, as compiled loops want them.

    Attributes:
        body: Corners and outward edge normals of each layer [x, y, n_x, n_y], body frame, short
            ones repeat their last corner, shape (L, V, 4), [m].
        reach: Distance of each layer's furthest corner from the body origin, shape (L,), [m].
        pieces: Corners and outward edge normals, shape (P, K, 4), [m].
        sides: Number of different corners of each piece, shape (P,).
        radius: What each piece is grown by, shape (P,), [m].
        box: x_min, y_min, x_max, y_max of each grown piece, shape (P, 4), [m].
        layer: Layer each piece counts for, shape (P,).
        origin: Lower corner of the grid of candidates, shape (2,), [m].
        cell: Its cell size [m].
        first: Where each cell's candidates start in `candidates`, shape (columns, rows + 1).
        candidates: Pieces the body can touch from a cell within `span`.
        span: Longest arc one check covers [m] (or turn [rad]).
    """

    body: Array
    reach: Array
    pieces: Array
    sides: NDArray[np.int64]
    radius: Array
    box: Array
    layer: NDArray[np.int64]
    origin: Array
    cell: float
    first: NDArray[np.int64]
    candidates: NDArray[np.int64]
    span: float


@compiled
def advance(
    x: float, y: float, heading: float, v: float, omega: float, s: float
) -> tuple[float, float, float]:
    """Return the pose after driving s with v in {-1, 0, 1} and heading rate omega per s."""
    turned = heading + omega * s
    if abs(omega * s) < 1e-9:
        return x + v * s * math.cos(heading), y + v * s * math.sin(heading), turned
    ratio = v / omega
    return (
        x + ratio * (math.sin(turned) - math.sin(heading)),
        y - ratio * (math.cos(turned) - math.cos(heading)),
        turned,
    )


@compiled
def place(body: Array, x: float, y: float, heading: float, outline: Array) -> None:
    """Write the corners and normals of a layer (V, 4) standing at a pose into outline (V, 4)."""
    c, s = math.cos(heading), math.sin(heading)
    for i in range(body.shape[0]):
        px, py, nx, ny = body[i, 0], body[i, 1], body[i, 2], body[i, 3]
        outline[i, 0] = x + c * px - s * py
        outline[i, 1] = y + s * px + c * py
        outline[i, 2] = c * nx - s * ny
        outline[i, 3] = s * nx + c * ny


@compiled
def widest_gap(first: Array, second: Array, count: int) -> tuple[float, float, float]:
    """Return the largest gap along an edge normal of `first`, and that normal."""
    best, best_x, best_y = -math.inf, 0.0, 0.0
    for i in range(first.shape[0]):
        nx, ny = first[i, 2], first[i, 3]
        if nx == 0.0 and ny == 0.0:
            continue
        low = math.inf
        for j in range(count):
            low = min(low, nx * second[j, 0] + ny * second[j, 1])
        gap = low - nx * first[i, 0] - ny * first[i, 1]
        if gap > best:
            best, best_x, best_y = gap, nx, ny
    return best, best_x, best_y


@compiled
def nearest_corner(
    corners: Array, count: int, polygon: Array, sides: int
) -> tuple[float, float, float]:
    """Return the least squared distance from a corner to a side of `polygon`, and its vector."""
    best, best_x, best_y = math.inf, 0.0, 0.0
    for j in range(sides):
        k = j + 1 if j + 1 < sides else 0
        ax, ay = polygon[j, 0], polygon[j, 1]
        ex, ey = polygon[k, 0] - ax, polygon[k, 1] - ay
        squared = ex * ex + ey * ey
        for i in range(count):
            dx, dy = ax - corners[i, 0], ay - corners[i, 1]
            if squared > 0.0:
                t = min(max(-(dx * ex + dy * ey) / squared, 0.0), 1.0)
                dx += t * ex
                dy += t * ey
            length = dx * dx + dy * dy
            if length < best:
                best, best_x, best_y = length, dx, dy
    return best, best_x, best_y


@compiled
def gap_between(outline: Array, piece: Array, count: int) -> tuple[float, float, float]:
    """Return the signed gap between body and piece and the axis from body to piece."""
    corners = outline.shape[0]
    gap, nx, ny = widest_gap(outline, piece, count)
    if count > 2:
        other, mx, my = widest_gap(piece, outline, corners)
        if other > gap:
            gap, nx, ny = other, -mx, -my
    if gap <= 1e-9:
        return gap, nx, ny
    squared, dx, dy = nearest_corner(outline, corners, piece, count)
    other, ex, ey = nearest_corner(piece, count, outline, corners)
    if other < squared:
        squared, dx, dy = other, -ex, -ey
    length = math.sqrt(squared)
    return length, dx / length, dy / length


@compiled
def safe_length(
    outline: Array,
    x: float,
    y: float,
    along: tuple[float, float],
    omega: float,
    axis: tuple[float, float, float],
) -> float:
    """Return how far the body may drive before a corner can spend its gap.

    Args:
        outline: The body where it stands, shape (V, 4).
        x: Body origin [m].
        y: Body origin [m].
        along: Velocity of the body origin.
        omega: Heading rate.
        axis: n_x, n_y and the gap the foremost corner may spend.
    """
    nx, ny, spend = axis
    foremost = -math.inf
    for i in range(outline.shape[0]):
        foremost = max(foremost, nx * outline[i, 0] + ny * outline[i, 1])
    least = math.inf
    for i in range(outline.shape[0]):
        px, py = outline[i, 0], outline[i, 1]
        vx, vy = along[0] - omega * (py - y), along[1] + omega * (px - x)
        gap = spend + foremost - nx * px - ny * py
        speed = nx * vx + ny * vy
        bend = abs(omega) * math.sqrt(vx * vx + vy * vy)
        if bend > 1e-12:
            # The positive root of bend s^2 / 2 + speed s = gap, without cancellation.
            root = math.sqrt(speed * speed + 2.0 * bend * gap)
            least = min(least, 2.0 * gap / (root + speed) if speed > 0.0 else (root - speed) / bend)
        elif speed > 0.0:
            least = min(least, gap / speed)
    return least


@compiled
def candidate_cell(solids: Solids, x: float, y: float) -> tuple[int, int]:
    """Return column and row of the cell of candidates at a point; negative outside."""
    column = math.floor((x - solids.origin[0]) / solids.cell)
    row = math.floor((y - solids.origin[1]) / solids.cell)
    if column >= solids.first.shape[0] or row >= solids.first.shape[1] - 1 or row < 0:
        return -1, -1
    return column, row


@compiled
def clearance_along(
    solids: Solids,
    x: float,
    y: float,
    heading: float,
    v: float,
    omega: float,
    length: float,
    floor: float,
    care: float,
    outline: Array,
) -> float:
    """Return the least gap met along an arc, or -1 if it cannot be shown clear.

    A value of at least `floor` means: the gap never falls below floor / 2. It is capped at `care`.

    Args:
        solids: What not to touch.
        x: Body origin at the start [m].
        y: The same.
        heading: Heading at the start [rad].
        v: +1 forward, -1 in reverse, 0 on the spot.
        omega: Heading rate per unit of length.
        length: Length driven [m] (angle turned on the spot), at most `solids.span`.
        floor: Gap below which the arc is refused [m], positive.
        care: Gaps above are not told apart [m].
        outline: Room for one layer's corners, shape (V, 4).
    """
    column, row = candidate_cell(solids, x, y)
    if column < 0:
        return -1.0
    least = care
    for index in range(solids.first[column, row], solids.first[column, row + 1]):
        k = solids.candidates[index]
        layer = solids.layer[k]
        dx = max(solids.box[k, 0] - x, x - solids.box[k, 2], 0.0)
        dy = max(solids.box[k, 1] - y, y - solids.box[k, 3], 0.0)
        room = solids.reach[layer] + abs(v) * length + care
        if dx * dx + dy * dy > room * room:
            continue
        driven = 0.0
        for _ in range(MOST_LOOKS):
            here = advance(x, y, heading, v, omega, driven)
            place(solids.body[layer], here[0], here[1], here[2], outline)
            gap, nx, ny = gap_between(outline, solids.pieces[k], solids.sides[k])
            gap -= solids.radius[k]
            if gap < floor:
                return -1.0
            least = min(least, gap)
            if driven >= length:
                break
            axis = (nx, ny, gap - 0.5 * floor)
            along = (v * math.cos(here[2]), v * math.sin(here[2]))
            driven = min(
                driven + safe_length(outline, here[0], here[1], along, omega, axis), length
            )
        if driven < length:
            return -1.0
    return least
