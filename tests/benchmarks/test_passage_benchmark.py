"""How long a verdict and its millimetres take on a doorway (aims: 0.3 s and 3 s of CPU)."""

import math

import numpy as np
import pytest
from pytest_benchmark.fixture import BenchmarkFixture

from narrows.planners.passage import PassageStatus, passable
from narrows.scene import Goal, Scene
from narrows.vehicle import Vehicle
from narrows.world import Solid, World

CHAIR = Vehicle.rectangle(1.0, 0.67, 0.25)


def doorway(opening: float) -> Scene:
    """A door of a corridor 1.6 m wide into a room of 4 x 3 m, two posts in the room."""
    left, right = 1.6 - opening / 2.0, 1.6 + opening / 2.0
    solids = [
        Solid.polygon([[x0, y0], [x1, y0], [x1, y1], [x0, y1]])
        for x0, y0, x1, y1 in (
            (-2.0, -0.1, 5.0, 0.0),
            (-2.0, 1.6, left, 1.7),
            (right, 1.6, 5.0, 1.7),
            (0.1, 1.7, 0.2, 4.7),
            (4.2, 1.7, 4.3, 4.7),
            (0.1, 4.7, 4.3, 4.8),
        )
    ]
    posts = [Solid.circle(0.8, 2.6, 0.15), Solid.circle(3.0, 3.6, 0.2)]
    goal = Goal(np.array([1.9, 3.5, math.pi / 3]))
    world = World((*solids, *posts), (-2.0, -0.1, 5.0, 4.8))
    return Scene(CHAIR, world, np.array([-0.4, 0.8, 0.05]), goal)


@pytest.mark.parametrize(
    ("opening", "status"),
    [
        (0.90, PassageStatus.PASSABLE),
        (0.68, PassageStatus.PASSABLE),
        (0.65, PassageStatus.IMPASSABLE),
    ],
)
def test_verdict_on_a_doorway(
    benchmark: BenchmarkFixture, opening: float, status: PassageStatus
) -> None:
    verdict = benchmark(passable, doorway(opening), spare=False)
    assert verdict.status is status


def test_millimetres_on_a_doorway(benchmark: BenchmarkFixture) -> None:
    verdict = benchmark(passable, doorway(0.90))
    assert verdict.spare_m == pytest.approx(0.23, abs=1e-3)
