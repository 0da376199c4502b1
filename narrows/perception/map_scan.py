"""What a laser would see in the obstacle map, so that doors are found in it as in a scan."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from ..errors import InputError
from ..se2 import Array
from .compiled import compiled
from .obstacle_map import ObstacleMap
from .ranges import LaserScan, ScannerMounting
from .surroundings import Cell


def scan_of_map(
    chart: ObstacleMap,
    *,
    heights: tuple[float, float] = (0.0, math.inf),
    beams: int = 1080,
    time: float = 0.0,
) -> LaserScan:
    """Return a scan all around the chair's origin, at its place in the map.

    A beam ends at the middle of the first occupied cell it enters, is clear where it leaves the
    map and invalid where it enters the unknown, unless something is known to stand behind it.

    Args:
        chart: The map, its chair where it believes to be.
        heights: Of the bands looked at [m].
        beams: Number of beams.
        time: Time of the scan [s].

    Raises:
        InputError: If there are no beams.
    """
    if beams < 1:
        raise InputError("no beams", field="beams", value=beams, allowed=">= 1")
    x_from, _, y_from, _ = chart.extent
    cell, pose = chart.options.cell, chart.pose
    place = np.array([pose[0] - x_from, pose[1] - y_from]) / cell
    angles = pose[2] - math.pi + 2.0 * math.pi / beams * np.arange(beams)
    directions = np.column_stack([np.cos(angles), np.sin(angles)])
    ranges = cell * _cast(chart.states(heights), place, directions, Cell.OBSTACLE, Cell.UNKNOWN)
    middle = 0.5 * (max(heights[0], chart.options.bands[0]) + min(heights[1], 1.0))
    return LaserScan(
        ranges,
        -math.pi,
        2.0 * math.pi / beams,
        ScannerMounting(max(middle, 1e-3)),
        nearest=0.0,
        furthest=0.5 * chart.options.side,
        time=time,
        sensor="map",
    )


@compiled
def _cast(
    states: NDArray[np.uint8], place: Array, directions: Array, obstacle: int, unknown: int
) -> Array:
    """Return how far each beam gets, shape (N,), in cells; infinite out of the map, NaN unknown."""
    ranges = np.empty(len(directions))
    for beam in range(len(directions)):
        dx, dy = directions[beam]
        i, j = math.floor(place[0]), math.floor(place[1])
        step_i, step_j = (1 if dx > 0.0 else -1), (1 if dy > 0.0 else -1)
        each_i, each_j = abs(1.0 / dx), abs(1.0 / dy)
        next_i = ((i + 1 - place[0]) if dx > 0.0 else (place[0] - i)) * each_i
        next_j = ((j + 1 - place[1]) if dy > 0.0 else (place[1] - j)) * each_j
        ranges[beam] = np.inf
        while 0 <= i < states.shape[0] and 0 <= j < states.shape[1]:
            if states[i, j] == obstacle:
                ranges[beam] = (i + 0.5 - place[0]) * dx + (j + 0.5 - place[1]) * dy
                break
            if states[i, j] == unknown:
                ranges[beam] = np.nan
            if next_i < next_j:
                i += step_i
                next_i += each_i
            else:
                j += step_j
                next_j += each_j
    return ranges
