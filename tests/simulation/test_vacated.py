"""What stood on the floor and has left it is forgotten; what hangs, or stands on legs, is not."""

import math

import numpy as np
import pytest

from narrows.scene import Goal, Scene
from narrows.se2 import transform
from narrows.simulation.named_senses import lasers_and_camera
from narrows.vehicle import Vehicle
from narrows.world import MovingSolid, Solid, World

CHAIR = Vehicle.rectangle(0.9, 0.6, 0.25)
AHEAD = np.zeros(3)
ASIDE = np.array([0.0, 0.0, math.radians(100.0)])  # the camera looks away
PERIOD = 0.05


def look(world, poses):
    """Return what is perceived and what is remembered at the end of looks from poses."""
    senses = lasers_and_camera(Scene(CHAIR, world, AHEAD, Goal([5.0, 0.0, 0.0])))
    for k, pose in enumerate(poses):
        percept = senses.perceive(k * PERIOD, pose, pose)
    remembered = senses.map.percept(reach=3.7, heights=(0.0, CHAIR.height))
    return [
        np.column_stack([transform(poses[-1], points[:, :2]), points[:, 2]])
        for points in (percept.points, remembered.points)
    ]


def about(points, x, y, reach=0.45, low=0.2):
    """Return how many points above the scanners' band are near a place."""
    near = np.hypot(points[:, 0] - x, points[:, 1] - y) < reach
    return int((near & (points[:, 2] > low)).sum())


def test_somebody_who_stood_there_and_left_is_forgotten():
    walk = [[0.0, 1.7, 0.0], [2.0, 1.7, 0.0], [4.0, 1.7, 3.0], [9.0, 1.7, 3.0]]
    she = MovingSolid(0.25, np.array(walk), (0.0, 1.8))
    world = World(moving=(she,))
    here, _ = look(world, [AHEAD] * 35)
    assert about(here, 1.7, 0.0) > 100
    perceived, remembered = look(world, [AHEAD] * 40 + [ASIDE] * 80)
    assert about(remembered, 1.7, 0.0) > 100  # nothing behind her sent a ray back to free it
    assert about(perceived, 1.7, 0.0) == 0


def test_a_table_out_of_view_is_remembered_whoever_walks_by():
    top = Solid.polygon([[1.2, -0.4], [2.0, -0.4], [2.0, 0.4], [1.2, 0.4]], z=(0.55, 0.6))
    legs = tuple(Solid.circle(x, y, 0.03, z=(0.0, 0.55)) for x in (1.25, 1.95) for y in (-0.3, 0.3))
    passer = MovingSolid(0.15, np.array([[3.0, 1.1, -3.0], [5.0, 1.1, 3.0]]), (0.0, 0.4))
    perceived, remembered = look(World((top, *legs), moving=(passer,)), [AHEAD] * 40 + [ASIDE] * 80)
    on_top = about(remembered, 1.5, 0.0, low=0.5)
    assert on_top > 100
    assert about(perceived, 1.5, 0.0, low=0.5) == on_top


def test_what_hangs_where_something_stood_is_kept_once_it_was_seen_to_hang():
    lamp = Solid.circle(1.7, 0.0, 0.15, z=(0.5, 1.2), name="lamp")
    box = MovingSolid(0.15, np.array([[0.0, 1.7, 0.0], [1.0, 1.7, 0.0], [2.0, 1.7, 3.0]]), (0, 0.4))
    perceived, remembered = look(World((lamp,), moving=(box,)), [AHEAD] * 110 + [ASIDE] * 40)
    assert about(remembered, 1.7, 0.0, low=0.5) > 50
    assert about(perceived, 1.7, 0.0, low=0.5) == pytest.approx(
        about(remembered, 1.7, 0.0, low=0.5), abs=5
    )


def test_what_the_scanners_see_is_never_left_out():
    walls = (Solid.polygon([[1.5, -1], [1.6, -1], [1.6, 1], [1.5, 1]]),)
    perceived, remembered = look(World(walls), [AHEAD] * 30 + [ASIDE] * 30)
    assert len(perceived) == len(remembered) > 300
