"""Mapping: scans from a known room give back the room, whatever the odometry drifts."""

import math
from itertools import pairwise

import numpy as np
import pytest
import shapely

from narrows.errors import ShapeError
from narrows.perception.ranges import LaserScan, ScannerMounting
from narrows.se2 import compose, invert
from narrows.simulation.grid_mapping import GridMap, GridMapper, aligned

ROOM = shapely.box(0.1, 0.1, 3.9, 2.9).difference(shapely.box(2.0, 1.5, 2.3, 2.9))
EDGE = ROOM.exterior
BOUNDS = (0.0, 0.0, 4.0, 3.0)


def scan(pose, *, beams=181, noise=0.0, rng=None):
    """Return a level scan of the room, all around, cast by shapely."""
    mounting = ScannerMounting(0.12, 0.1, 0.0, 0.0)
    eye = compose(pose, mounting.pose)
    step = 2.0 * math.pi / beams
    ranges = []
    for k in range(beams):
        angle = eye[2] + step * k
        far = eye[:2] + 10.0 * np.array([math.cos(angle), math.sin(angle)])
        hit = shapely.LineString([eye[:2], far]).intersection(EDGE)
        ranges.append(shapely.distance(shapely.Point(eye[:2]), hit))
    ranges = np.array(ranges)
    if rng is not None:
        ranges += noise * rng.standard_normal(beams)
    return LaserScan(ranges, 0.0, step, mounting)


def true_map(cell=0.02):
    columns, rows = round(4.0 / cell), round(3.0 / cell)
    x, y = np.meshgrid((np.arange(columns) + 0.5) * cell, (np.arange(rows) + 0.5) * cell)
    middles = shapely.points(np.column_stack([x.T.ravel(), y.T.ravel()]))
    on_edge = shapely.distance(middles, EDGE) <= 0.51 * cell  # walls lie between cells
    return GridMap(on_edge.reshape(columns, rows), np.zeros(2), cell)


def way(count):
    """Return poses of a drive through the room."""
    s = np.linspace(0.0, 1.0, count)
    x, y = 0.6 + 2.6 * s, 0.7 + 0.3 * np.sin(2.0 * math.pi * s)
    return np.column_stack([x, y, np.arctan2(np.gradient(y), np.gradient(x))])


def test_the_distance_field_is_the_distance_to_the_walls():
    grid = true_map()
    points = np.random.default_rng(0).uniform([0.1, 0.1], [3.9, 2.9], (300, 2))
    exact = np.minimum(shapely.distance(shapely.points(points), EDGE), 0.4)
    # Cells of 2 cm: half a one to the wall that lies between two, half a diagonal along it.
    assert np.abs(grid.distance(points) - exact).max() < 0.02
    assert grid.distance([-1.0, 1.0]) == 0.4


def test_a_scan_is_brought_back_onto_the_walls():
    grid, pose = true_map(), np.array([1.2, 1.0, 0.4])
    points = scan(pose).points[:, :2]
    for off in ([0.06, -0.05, 0.04], [-0.08, 0.02, -0.05]):
        found = aligned(grid, pose + off, points, (0.2, 0.2))
        assert found == pytest.approx(pose, abs=0.008)  # half a cell


def test_without_walls_the_odometry_is_believed():
    empty = GridMap(np.zeros((50, 50), dtype=bool), np.zeros(2), 0.02)
    pose = np.array([0.5, 0.5, 0.1])
    assert (aligned(empty, pose, np.ones((40, 2)), (0.1, 0.1)) == pose).all()


@pytest.fixture(scope="module")
def learned():
    rng, truth = np.random.default_rng(5), way(30)
    mapper = GridMapper(BOUNDS, truth[0])
    drifting, found = np.zeros(3), [truth[0]]
    mapper.add(drifting, [scan(truth[0], noise=0.01, rng=rng)])
    for before, now in pairwise(truth):
        step = compose(invert(before), now) * [1.05, 1.0, 1.0] + [0.0, 0.0, 0.008]
        drifting = compose(drifting, step)
        found.append(mapper.add(drifting, [scan(now, noise=0.01, rng=rng)]))
    start = compose(truth[0], drifting)
    return mapper.map, np.array(found), truth, np.hypot(*(start - truth[-1])[:2])


def test_mapping_finds_its_way_where_odometry_drifts(learned):
    _, found, truth, drift = learned
    error = np.hypot(*(found - truth)[:, :2].T)
    assert drift > 0.2
    assert error.max() < 0.04  # two cells


def test_the_learned_map_is_the_room(learned):
    grid, *_ = learned
    off = shapely.distance(shapely.points(grid.points), EDGE)
    assert np.quantile(off, 0.95) < 0.05
    seen = shapely.points(true_map().points)
    nearest = grid.distance(shapely.get_coordinates(seen))
    assert np.mean(nearest < 0.05) > 0.7  # what a chair below the partition sees of it


def test_a_map_says_what_is_wrong_with_it():
    with pytest.raises(ShapeError, match="a grid map needs cells"):
        GridMap(np.zeros(4, dtype=bool), np.zeros(2), 0.02)
