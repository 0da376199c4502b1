"""Walls in a scan: straight lines that many returns lie on."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ..errors import InputError
from ..se2 import Array
from .line_kernels import straight_pieces
from .ranges import Beam, LaserScan

_ROUNDS = 3  # of least squares on what lies on the line


@dataclass(frozen=True)
class WallOptions:
    """What counts as a wall.

    Attributes:
        error: Standard deviation of the sensor's ranges [m].
        reach: Returns further away are not looked at [m].
        slant: Flattest angle between a beam and a wall [rad].
        least: Fewest returns of a straight piece.
        length: Shortest piece that begins a wall [m].
    """

    error: float = 0.01
    reach: float = 6.0
    slant: float = math.radians(8.0)
    least: int = 5
    length: float = 0.3

    def __post_init__(self) -> None:
        """Refuse what is not positive."""
        for name, value in vars(self).items():
            if not (math.isfinite(value) and value > 0.0):
                raise InputError("must be positive", field=name, value=value, allowed="> 0")

    @property
    def tolerance(self) -> float:
        """Distance up to which a return is on a wall [m]."""
        return 3.0 * self.error + 0.01


@dataclass(frozen=True, eq=False)
class Wall:
    """A line with the returns on it, in the frame of the scan's beams turned to the body's axes.

    Attributes:
        normal: Unit normal away from the sensor, shape (2,).
        distance: Of the line from the sensor, > 0 [m].
        along: Places of the returns along it, increasing, counter-clockwise about the sensor, as
            multiples of `tangent` from the foot of the perpendicular, shape (N,), [m].
        beams: Their beams, shape (N,).
    """

    normal: Array
    distance: float
    along: Array
    beams: NDArray[np.int64]

    @property
    def tangent(self) -> Array:
        """Unit vector along it, counter-clockwise about the sensor, shape (2,)."""
        return np.array([-self.normal[1], self.normal[0]])

    @property
    def length(self) -> float:
        """Length of what is seen of it, gaps of more than 0.5 m not counted [m]."""
        steps = np.diff(self.along)
        return float(steps[steps <= 0.5].sum())


@dataclass(frozen=True, eq=False)
class SortedScan:
    """A scan with its beams counter-clockwise, seen from the sensor along the body's axes.

    Attributes:
        directions: Unit vector of each beam, shape (N, 2).
        ranges: Readings, 0 where there is no return within reach, shape (N,), [m].
        beams: Values of `Beam`; returns beyond the reach count as clear, shape (N,).
        step: Angle from beam to beam [rad], > 0.
        place: The sensor in the body frame, shape (2,), [m].
    """

    directions: Array
    ranges: Array
    beams: NDArray[np.uint8]
    step: float
    place: Array

    @classmethod
    def of(cls, scan: LaserScan, reach: float) -> SortedScan:
        """Return a scan sorted."""
        order = slice(None) if scan.step > 0.0 else slice(None, None, -1)
        beams = scan.beams.copy()
        beams[(beams == Beam.RETURN) & (scan.ranges > reach)] = Beam.CLEAR
        ranges = np.where(beams == Beam.RETURN, scan.ranges, 0.0)
        place = scan.mounting.pose[:2]
        return cls(scan.directions[order], ranges[order], beams[order], abs(scan.step), place)


def find_walls(scan: SortedScan, options: WallOptions) -> tuple[Wall, ...]:
    """Return the walls in a scan, the one with the longest straight piece first.

    A wall is begun by a straight piece and holds every return on its line, whatever is between;
    pieces that lie on a wall already found begin no other.
    """
    hit = np.flatnonzero(scan.beams == Beam.RETURN)
    points = scan.ranges[hit, None] * scan.directions[hit]
    pieces = straight_pieces(points, hit, scan.step, options.slant, options.error, options.least)
    length = np.linalg.norm(points[pieces[:, 1]] - points[pieces[:, 0]], axis=1)
    taken = np.zeros(len(points), dtype=bool)
    walls = []
    for piece in np.argsort(-length, kind="stable"):
        first, last = pieces[piece]
        inside = slice(first, last + 1)
        if length[piece] < options.length or taken[inside].mean() > 0.5:
            continue
        wall = _wall(points, hit, inside, options)
        if wall is not None:
            taken[np.searchsorted(hit, wall.beams)] = True
            walls.append(wall)
    return tuple(walls)


def _wall(points: Array, hit: NDArray[np.int64], piece: slice, options: WallOptions) -> Wall | None:
    """Return the wall a piece begins; None if it passes through the sensor."""
    chosen = np.zeros(len(points), dtype=bool)
    chosen[piece] = True
    for _ in range(_ROUNDS):
        centre = points[chosen].mean(axis=0)
        offsets = points[chosen] - centre
        (xx, xy), (_, yy) = offsets.T @ offsets
        angle = 0.5 * math.atan2(2.0 * xy, xx - yy)
        normal = np.array([-math.sin(angle), math.cos(angle)])
        distance = float(normal @ centre)
        chosen = np.abs(points @ normal - distance) <= options.tolerance
        if np.count_nonzero(chosen) < options.least:
            return None
    if distance < 0.0:
        normal, distance = -normal, -distance
    if distance < options.tolerance:
        return None
    tangent = np.array([-normal[1], normal[0]])
    along = points[chosen] @ tangent
    order = np.argsort(along, kind="stable")
    return Wall(normal, distance, along[order], hit[chosen][order])
