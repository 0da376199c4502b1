"""How long a warm search takes."""

import numpy as np
import pytest

from narrows.planners.search import SearchPlanner
from narrows.scene import Goal, Scene
from narrows.vehicle import Limits, Vehicle
from narrows.world import Solid, World


@pytest.mark.parametrize("width", [1.05, 0.9, 0.8])
@pytest.mark.parametrize("reverse_speed", [0.0, 0.4])
def test_a_turn_from_a_corridor_through_a_door(benchmark, width, reverse_speed):
    left, right = 1.6 - 0.5 * width, 1.6 + 0.5 * width
    boxes = [(-2, -0.1, 5, 0), (-2, 1.6, left, 1.7), (right, 1.6, 5, 1.7)]
    walls = tuple(
        Solid.polygon([[a, b], [c, b], [c, d], [a, d]], name="wall") for a, b, c, d in boxes
    )
    limits = Limits(curvature=2.5, reverse_speed=reverse_speed)
    scene = Scene(
        Vehicle.rectangle(1.0, 0.75, 0.25, limits=limits),
        World(walls, bounds=(-2, -0.1, 5, 4.7)),
        np.array([-0.2, 0.8, 0.0]),
        Goal(np.array([1.9, 3.5, 1.3])),
    )
    planner = SearchPlanner()
    planner.search(scene)  # compiles where nothing is cached
    result = benchmark(planner.search, scene)
    assert result.manoeuvre is not None
