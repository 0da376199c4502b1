"""The search for contacts along a section, compiled: `contact_finding` in plain loops."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from narrows.se2 import Array

from .compiled import compiled
from .search_collision import nearest_corner, place, widest_gap

FOUND = 9
"""Columns of a contact found: parameter, x, y, heading, distance, axis (2), kind, is_least."""

BODY_EDGE, SOLID_EDGE, CORNERS = 0.0, 1.0, 2.0
"""What the axis of a contact belongs to."""

_BESIDE = 1e-9  # m: a corner this far beyond an edge's end counts as beside it
_ROUNDS = 40  # of narrowing, at most
_EXACT = 1e-9  # of the parameter: narrowed down to this


class Course(NamedTuple):
    """A section's motion and the samples along it.

    Attributes:
        powers: Coefficients of x and y by powers of the parameter within each piece of the
            spline, shape (segments, 4, 2), [m].
        direction: +1 or -1.
        samples: Fine samples.
        finer: Fine samples for each coarse one.
    """

    powers: Array
    direction: float
    samples: int
    finer: int


class Watch(NamedTuple):
    """What is watched.

    Attributes:
        horizon: Distance beyond which a solid is not watched [m].
        near: Nearer than this it is watched along the way [m].
        close: Nearer than this more densely [m].
        stride: Between places watched along the way [m].
        close_stride: The same where it is close [m].
    """

    horizon: float
    near: float
    close: float
    stride: float
    close_stride: float


@compiled
def pose_at(course: Course, parameter: float) -> tuple[float, float, float]:
    """Return the pose at a parameter."""
    segments = course.powers.shape[0]
    k = min(max(int(parameter * segments), 0), segments - 1)
    u = parameter - k / segments
    c = course.powers[k]
    x = c[0, 0] + u * (c[1, 0] + u * (c[2, 0] + u * c[3, 0]))
    y = c[0, 1] + u * (c[1, 1] + u * (c[2, 1] + u * c[3, 1]))
    dx = course.direction * (c[1, 0] + u * (2.0 * c[2, 0] + u * 3.0 * c[3, 0]))
    dy = course.direction * (c[1, 1] + u * (2.0 * c[2, 1] + u * 3.0 * c[3, 1]))
    return x, y, math.atan2(dy, dx)


@compiled
def measure(
    body: Array, piece: Array, sides: int, outline: Array, pose: tuple[float, float, float]
) -> tuple[float, float, float, float]:
    """Return distance, axis from body to piece, and what the axis belongs to.

    Args:
        body: Corners and normals of the body, shape (A, 4), see `Solids`.
        piece: The same of the piece, shape (B, 4).
        sides: Different corners of the piece.
        outline: Room for the body where it stands, shape (A, 4).
        pose: Where it stands.
    """
    place(body, pose[0], pose[1], pose[2], outline)
    corners = outline.shape[0]
    gap, nx, ny = widest_gap(outline, piece, sides)
    kind = BODY_EDGE
    if sides > 2:
        other, mx, my = widest_gap(piece, outline, corners)
        if other >= gap:
            gap, nx, ny, kind = other, -mx, -my, SOLID_EDGE
    if gap <= 0.0:
        return gap, nx, ny, kind
    squared, dx, dy = nearest_corner(outline, corners, piece, sides)
    other, ex, ey = nearest_corner(piece, sides, outline, corners)
    if other < squared:
        squared, dx, dy = other, -ex, -ey
    length = math.sqrt(squared)
    if length > gap + _BESIDE:
        return length, dx / length, dy / length, CORNERS
    return gap, nx, ny, kind


@compiled
def contacts(
    course: Course,
    watch: Watch,
    body: Array,
    reach: float,
    pieces: Array,
    sides: NDArray[np.int64],
    radius: Array,
    boxes: Array,
    chosen: NDArray[np.int64],
    found: Array,
    of_piece: NDArray[np.int64],
) -> int:
    """Write the contacts found, least distances and places along what is near, return how many.

    Args:
        course: The motion.
        watch: What is watched.
        body: Corners and normals of the body, shape (A, 4).
        reach: Distance of its furthest corner from its origin [m].
        pieces: Corners and normals of all pieces, shape (P, B, 4).
        sides: Different corners of each, shape (P,).
        radius: What each is grown by, shape (P,), [m].
        boxes: x_min, y_min, x_max, y_max of each, shape (P, 4), [m].
        chosen: Pieces to look at, shape (M,).
        found: Room for contacts, shape (room, FOUND).
        of_piece: Room for their pieces, shape (room,).
    """
    count, finer = course.samples, course.finer
    poses, travelled = np.empty((count, 3)), np.zeros(count)
    for i in range(count):
        poses[i, 0], poses[i, 1], poses[i, 2] = pose_at(course, i / (count - 1))
        if i:
            step = math.hypot(poses[i, 0] - poses[i - 1, 0], poses[i, 1] - poses[i - 1, 1])
            travelled[i] = travelled[i - 1] + step
    outline = np.empty_like(body)
    rows = np.empty((count, 4))
    total = 0
    for index in range(chosen.shape[0]):
        k = chosen[index]
        piece, corners, grown = pieces[k], sides[k], radius[k]
        rows[:, 0] = math.inf
        for i in range(0, count, finer):
            dx = max(boxes[k, 0] - poses[i, 0], poses[i, 0] - boxes[k, 2], 0.0)
            dy = max(boxes[k, 1] - poses[i, 1], poses[i, 1] - boxes[k, 3], 0.0)
            if math.hypot(dx, dy) < reach + watch.horizon:
                _look(body, piece, corners, grown, outline, poses, i, rows)
        for i in range(0, count - 1, finer):
            middle = 0.5 * (rows[i, 0] + rows[i + finer, 0])
            turn = abs(poses[i + finer, 2] - poses[i, 2])
            turn = min(turn, abs(turn - 2.0 * math.pi))
            moved = travelled[i + finer] - travelled[i] + reach * turn
            if middle - 0.5 * moved < watch.close:
                for j in range(i + 1, i + finer):
                    _look(body, piece, corners, grown, outline, poses, j, rows)
        total = _picked(
            course, watch, body, piece, corners, grown, outline, poses, travelled, rows, found,
            of_piece, k, total,
        )  # fmt: skip
    return total


@compiled
def _look(
    body: Array,
    piece: Array,
    sides: int,
    grown: float,
    outline: Array,
    poses: Array,
    i: int,
    rows: Array,
) -> None:
    """Write distance, axis and kind at a sample; infinite beyond measure is left to the caller."""
    distance, nx, ny, kind = measure(
        body, piece, sides, outline, (poses[i, 0], poses[i, 1], poses[i, 2])
    )
    rows[i, 0], rows[i, 1], rows[i, 2], rows[i, 3] = distance - grown, nx, ny, kind


@compiled
def _picked(
    course: Course,
    watch: Watch,
    body: Array,
    piece: Array,
    sides: int,
    grown: float,
    outline: Array,
    poses: Array,
    travelled: Array,
    rows: Array,
    found: Array,
    of_piece: NDArray[np.int64],
    k: int,
    total: int,
) -> int:
    """Write one piece's contacts, return how many there are now."""
    count = course.samples
    last, mark = -1, -1.0
    for i in range(count):
        here = rows[i, 0]
        if here >= watch.horizon:
            continue
        if total >= found.shape[0]:
            return total
        before = rows[last, 0] if last >= 0 and i - last <= course.finer else math.inf
        after, following = math.inf, i + 1
        while following < count and following <= i + course.finer:
            if rows[following, 0] < math.inf:
                after = rows[following, 0]
                break
            following += 1
        close = here < watch.close
        stride = watch.close_stride if close else watch.stride
        cell = math.floor(travelled[i] / stride) + (1e6 if close else 0.0)
        is_least = here <= before and here < after
        if is_least:
            width = max(i - last if before < math.inf else 1, following - i)
            t = _narrowed(course, body, piece, sides, outline, i / (count - 1), width / (count - 1))
            x, y, heading = pose_at(course, t)
            distance, nx, ny, kind = measure(body, piece, sides, outline, (x, y, heading))
            _write(found, total, t, (x, y, heading), distance - grown, nx, ny, kind)
            found[total, 8] = 1.0 if 0.0 < t < 1.0 else 0.0
            of_piece[total] = k
            total += 1
        elif here < watch.near and (cell != mark or last < 0 or i - last > course.finer):
            pose = (poses[i, 0], poses[i, 1], poses[i, 2])
            _write(found, total, i / (count - 1), pose, here, rows[i, 1], rows[i, 2], rows[i, 3])
            found[total, 8] = 0.0
            of_piece[total] = k
            total += 1
        last, mark = i, cell
    return total


@compiled
def _write(
    found: Array,
    row: int,
    t: float,
    pose: tuple[float, float, float],
    distance: float,
    nx: float,
    ny: float,
    kind: float,
) -> None:
    found[row, 0], found[row, 4], found[row, 7] = t, distance, kind
    found[row, 1], found[row, 2], found[row, 3] = pose
    found[row, 5], found[row, 6] = nx, ny


@compiled
def _narrowed(
    course: Course,
    body: Array,
    piece: Array,
    sides: int,
    outline: Array,
    parameter: float,
    width: float,
) -> float:
    """Return where within a width of a parameter the distance is least (golden section)."""
    share = 0.5 * (math.sqrt(5.0) - 1.0)
    low, high = max(parameter - width, 0.0), min(parameter + width, 1.0)
    first, second = high - share * (high - low), low + share * (high - low)
    here = measure(body, piece, sides, outline, pose_at(course, first))[0]
    there = measure(body, piece, sides, outline, pose_at(course, second))[0]
    for _ in range(_ROUNDS):
        if high - low < _EXACT:
            break
        if here <= there:
            high, second, there = second, first, here
            first = high - share * (high - low)
            here = measure(body, piece, sides, outline, pose_at(course, first))[0]
        else:
            low, first, here = first, second, there
            second = low + share * (high - low)
            there = measure(body, piece, sides, outline, pose_at(course, second))[0]
    best = first if here <= there else second
    for end in (0.0, 1.0):
        if abs(end - parameter) <= width:
            value = measure(body, piece, sides, outline, pose_at(course, end))[0]
            if value <= min(here, there):
                best = end
    return best
