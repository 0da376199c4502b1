"""A path as legs driven without a stop, tabled finely enough to project onto in microseconds."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise
from typing import NamedTuple

import numpy as np

from ..path import Path
from ..se2 import Array
from ..twist_section import TwistSection

STEP = 0.002
"""Longest distance between rows [m]: a chord of 2 mm on a radius of 0.1 m is 5 um off the arc."""

TURN_STEP = 0.005
"""Longest angle between rows of a turn on the spot [rad]."""

OVERRUN = 1.0
"""How far a leg goes on straight before its start and beyond its end [m]."""


class Foot(NamedTuple):
    """The point of a leg nearest to a given point.

    Attributes:
        progress: Progress along the path there; beyond the leg's ends on its overrun.
        offset: Signed distance of the given point from the leg [m], positive to the left of the
            direction of travel.
    """

    progress: float
    offset: float


@dataclass(frozen=True, eq=False)
class Leg:
    """Sections of a path driven one way without a stop, as rows evenly spaced in progress.

    A driven leg goes on straight beyond both ends (`OVERRUN`), so that points ahead of its end
    have a foot. A turn on the spot turns one way only and has no overrun.

    Attributes:
        direction: +1 forward, -1 reverse, 0 turning on the spot.
        start: Progress along the path at the leg's start, [m] or [rad].
        end: Progress along the path at its end.
        origin: Progress of the first row.
        step: Progress between rows.
        poses: Poses [x, y, heading] of the body, shape (K, 3), headings unwrapped.
    """

    direction: int
    start: float
    end: float
    origin: float
    step: float
    poses: Array

    @cached_property
    def _columns(self) -> tuple[Array, Array, list[float], list[float], list[float]]:
        """Columns: x and y as arrays for the search; x, y and heading as floats for single rows."""
        x, y, heading = np.ascontiguousarray(self.poses.T)
        return x, y, x.tolist(), y.tolist(), heading.tolist()

    @property
    def turn(self) -> float:
        """Angle turned from start to end [rad], signed."""
        return self.heading(self.end) - self.heading(self.start)

    def heading(self, progress: float) -> float:
        """Return the heading of the body at progress [rad], interpolated, clipped to the rows."""
        rows = self._columns[4]
        place = (progress - self.origin) / self.step
        k = min(max(int(place), 0), len(rows) - 2)
        share = min(max(place - k, 0.0), 1.0)
        return rows[k] + share * (rows[k + 1] - rows[k])

    def pose(self, progress: float) -> tuple[float, float, float]:
        """Return x, y and heading at progress, interpolated, clipped to the rows."""
        _, _, xs, ys, headings = self._columns
        place = (progress - self.origin) / self.step
        k = min(max(int(place), 0), len(xs) - 2)
        share = min(max(place - k, 0.0), 1.0)
        return (
            xs[k] + share * (xs[k + 1] - xs[k]),
            ys[k] + share * (ys[k + 1] - ys[k]),
            headings[k] + share * (headings[k + 1] - headings[k]),
        )

    def project(self, x: float, y: float, *, near: float, reach: float) -> Foot:
        """Return the foot of a point among the rows within `reach` of the progress `near`.

        The search never looks further, so it cannot jump to another branch of the path.

        Args:
            x: Point in the world frame [m].
            y: Likewise.
            near: Where the foot is expected, progress.
            reach: How far from there to look, progress.
        """
        x_rows, y_rows, xs, _, _ = self._columns
        first = max(0, min(int((near - reach - self.origin) / self.step), len(xs) - 2))
        last = max(first + 2, int((near + reach - self.origin) / self.step) + 2)
        dx, dy = x_rows[first:last] - x, y_rows[first:last] - y
        k = first + int((dx * dx + dy * dy).argmin())
        ahead = min(k, len(xs) - 2)
        best = self._on_chord(ahead, x, y)
        if k == ahead and k > 0:
            behind = self._on_chord(k - 1, x, y)
            if abs(behind.offset) < abs(best.offset):
                return behind
        return best

    def _on_chord(self, row: int, x: float, y: float) -> Foot:
        """Return the foot on the chord from a row to the next."""
        _, _, xs, ys, _ = self._columns
        along_x, along_y = xs[row + 1] - xs[row], ys[row + 1] - ys[row]
        from_x, from_y = x - xs[row], y - ys[row]
        square = along_x * along_x + along_y * along_y
        share = min(max((from_x * along_x + from_y * along_y) / square, 0.0), 1.0)
        distance = math.hypot(from_x - share * along_x, from_y - share * along_y)
        left = along_x * from_y - along_y * from_x
        return Foot(self.origin + (row + share) * self.step, math.copysign(distance, left))


def legs_of(path: Path) -> tuple[Leg, ...]:
    """Return the legs of a path in order; they cover its progress without gaps.

    A leg ends where the direction of travel changes, where a turn on the spot begins or ends, and
    where such a turn changes its sense.
    """
    bounds, directions = path.section_bounds, path.directions
    cuts = [0, *(np.flatnonzero(np.diff(directions)) + 1).tolist(), len(directions)]
    legs: list[Leg] = []
    for first, last in pairwise(cuts):
        if directions[first] == 0:
            legs.extend(_turning_legs(path, first, last))
        else:
            start, end = float(bounds[first]), float(bounds[last])
            legs.append(_driven_leg(path, int(directions[first]), start, end))
    return tuple(legs)


def _driven_leg(path: Path, direction: int, start: float, end: float) -> Leg:
    rows = max(1, math.ceil((end - start) / STEP))
    step = (end - start) / rows
    inner = path(start + step * np.arange(rows + 1))
    count = math.ceil(OVERRUN / step)
    distance: Array = step * np.arange(1.0, count + 1.0)
    before = _straight(inner[0], -direction * distance[::-1])
    after = _straight(inner[-1], direction * distance)
    poses = np.concatenate([before, inner, after])
    return Leg(direction, start, end, start - count * step, step, poses)


def _straight(pose: Array, distance: Array) -> Array:
    """Return poses at signed distances along a pose's x axis, shape (N, 3)."""
    x = pose[0] + distance * math.cos(pose[2])
    y = pose[1] + distance * math.sin(pose[2])
    return np.column_stack([x, y, np.full(len(distance), pose[2])])


def _turning_legs(path: Path, first: int, last: int) -> list[Leg]:
    ends = [float(path.section_bounds[first])]
    senses: list[float] = []
    for section, begin in zip(
        path.sections[first:last], path.section_bounds[first:last], strict=True
    ):
        piece = np.arange(section.pieces)
        sense = np.ones(len(piece))
        if isinstance(section, TwistSection):  # the only kind that turns on the spot
            sense = np.sign(section.twists[:, 2])
        done = begin + section.progress_at(piece, np.ones(len(piece)))
        for each, end in zip(sense.tolist(), done.tolist(), strict=True):
            if senses and senses[-1] == each:
                ends[-1] = end
            else:
                ends.append(end)
                senses.append(each)
    legs = []
    for start, end in pairwise(ends):
        rows = max(1, math.ceil((end - start) / TURN_STEP))
        step = (end - start) / rows
        poses = path(start + step * np.arange(rows + 1))
        legs.append(Leg(0, start, end, start, step, poses))
    return legs
