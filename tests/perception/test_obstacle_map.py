"""The map remembers what it saw, forgets what it sees gone, and never takes unknown for free."""

import numpy as np
import pytest

from narrows.errors import InputError, ShapeError
from narrows.perception.obstacle_map import MapOptions, ObstacleMap, bands_of
from narrows.perception.ranges import LaserScan, ScannerMounting, UltrasoundReadings
from narrows.perception.surroundings import Cell
from narrows.vehicle import Layer, Vehicle

FRONT = ScannerMounting(0.12)


def scan(ranges, first=-np.pi / 2, step=None, **more):
    ranges = np.asarray(ranges, dtype=float)
    step = np.pi / max(len(ranges) - 1, 1) if step is None else step
    return LaserScan(ranges, first, step, more.pop("mounting", FRONT), **more)


def wall_scan(distance=2.0, **more):
    """A half turn of beams that see a wall straight ahead, infinitely wide."""
    angles = np.linspace(-np.pi / 2, np.pi / 2, 361)
    with np.errstate(divide="ignore"):
        ranges = np.where(np.cos(angles) > 1e-9, distance / np.cos(angles), np.inf)
    return scan(ranges, **more)


def state(chart, x, y, **more):
    """What the map says about a place of the world."""
    x_from, _, y_from, _ = chart.extent
    cell = chart.options.cell
    return chart.states(**more)[int((x - x_from) // cell), int((y - y_from) // cell)]


def test_a_new_map_knows_nothing_and_says_so():
    chart = ObstacleMap()
    seen = chart.percept()
    assert (chart.states() == Cell.UNKNOWN).all()
    assert len(seen.points) == 0
    assert seen.time == -np.inf
    assert not chart.is_free([[0.0, 0.0], [1.0, 0.0]]).any()


def test_a_wall_is_occupied_what_lies_before_it_free_and_behind_it_unknown():
    chart = ObstacleMap()
    chart.add_scan(wall_scan(2.01))
    assert state(chart, 2.01, 0.3) == Cell.OBSTACLE
    assert state(chart, 1.5, 0.3) == Cell.FREE
    assert state(chart, 2.2, 0.3) == Cell.UNKNOWN
    assert state(chart, -0.5, 0.3) == Cell.UNKNOWN
    assert list(chart.is_free([[1.5, 0.3], [2.2, 0.3], [9.0, 0.0]])) == [True, False, False]
