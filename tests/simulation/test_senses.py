"""Ideal senses tell the outlines that are near: true places, no gap wider than they say."""

import math

import numpy as np
import pytest
import shapely

from narrows.errors import InputError, ShapeError
from narrows.se2 import compose, invert, transform
from narrows.simulation.senses import IdealOptions, IdealSenses
from narrows.world import MovingSolid, Solid, World

HERE = np.zeros(3)


def test_points_lie_on_the_outlines_and_leave_no_gap(plain):
    world = plain.clutter(np.random.default_rng(1))
    options = IdealOptions(reach=4.0, spacing=0.06, heights=(0.0, 2.0))
    pose, time = np.array([1.0, 0.3, 2.0]), 1.2
    percept = IdealSenses(world, options).perceive(time, pose, HERE)
    outlines = [
        shapely.LineString(_ring(s.shape.x, s.shape.y, s.radius)) if s.radius else s.shape.exterior
        for s in world.solids
    ]
    outlines += [shapely.LineString(_ring(*m.position(time), m.radius)) for m in world.moving]
    told = shapely.points(transform(pose, percept.points[:, :2]))
    every = shapely.union_all(outlines)
    assert shapely.distance(every, told).max() < 1e-6
    cloud = shapely.MultiPoint(list(told))
    dense = shapely.points(shapely.get_coordinates(shapely.segmentize(every, 0.005)))
    near = shapely.distance(dense, shapely.Point(pose[:2])) < 3.9
    assert shapely.distance(dense[near], cloud).max() <= percept.spread + 1e-6
    assert percept.spread == 0.03
    assert percept.time == time
    assert len(percept.unknown) == 0


def _ring(x: float, y: float, radius: float) -> np.ndarray:
    angle = np.linspace(0.0, 2.0 * math.pi, 5000)
    return np.column_stack([x + radius * np.cos(angle), y + radius * np.sin(angle)])


def test_only_what_is_in_reach_and_in_the_band_is_told():
    table = Solid.polygon([[1, -1], [2, -1], [2, 1], [1, 1]], z=(0.7, 0.75))
    lamp = Solid.circle(1.0, 0.0, 0.2, z=(1.6, 2.0))
    far = Solid.circle(5.0, 0.0, 0.5)
    rows = IdealSenses(World((table, lamp, far))).perceive(0.0, HERE, HERE).points
    assert rows[:, 2].min() == 0.7
    assert rows[:, 2].max() == 0.75
    assert rows[:, 0].max() == 2.0
    wall = Solid.polygon([[1, -1], [1.1, -1], [1.1, 1], [1, 1]], z=(0.0, 2.5))
    levels = np.unique(IdealSenses(World((wall,))).perceive(0.0, HERE, HERE).points[:, 2])
    assert levels[0] == 0.02
    assert levels[-1] == 1.5
    assert np.diff(levels).max() <= 0.3


def test_what_is_told_moves_with_the_chair_and_ignores_what_it_believes(plain):
    world = plain.clutter(np.random.default_rng(2))
    senses = IdealSenses(world, IdealOptions(reach=50.0))
    pose = np.array([0.4, -0.2, 1.1])
    one, other = (senses.perceive(0.0, p, b).points for p, b in ((HERE, pose), (pose, HERE)))
    np.testing.assert_allclose(transform(pose, other[:, :2]), one[:, :2], atol=1e-12)
    np.testing.assert_allclose(compose(pose, invert(pose)), 0.0, atol=1e-12)


def test_somebody_is_where_he_is_at_the_time():
    walker = MovingSolid(0.2, np.array([[0, 1.0, 0.0], [2, 2.0, 0.0]]))
    senses = IdealSenses(World(moving=(walker,)))
    for time, x in ((0.0, 1.0), (1.0, 1.5), (5.0, 2.0)):
        assert senses.perceive(time, HERE, HERE).points[:, 0].mean() == pytest.approx(x)


def test_odd_senses_have_their_answers():
    assert IdealSenses(World()).perceive(0.0, HERE, HERE).points.shape == (0, 3)
    with pytest.raises(ShapeError, match="three finite numbers"):
        IdealSenses(World()).perceive(0.0, np.array([math.nan, 0, 0]), HERE)
    for wrong in ({"reach": 0.0}, {"spacing": -1.0}, {"heights": (1.0, 0.0)}):
        with pytest.raises(InputError):
            IdealOptions(**wrong)
