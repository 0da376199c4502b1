"""How long a control step of the navigator takes with 5,000 points; the claim is 1 ms."""

import numpy as np
import pytest

from narrows.interfaces import Percept
from narrows.reactive.deformable_zone import DeformableZone
from narrows.reactive.fuzzy import FuzzyGoalController
from narrows.reactive.navigator import Navigator
from narrows.reactive.zone_shape import ZoneShape
from narrows.vehicle import Vehicle

CHAIR = Vehicle.rectangle(1.2, 0.7, 0.25)


@pytest.fixture
def points():
    """5,000 points about the chair, none nearer than 0.3 m, half of them within the zone."""
    rng = np.random.default_rng(0)
    rows = rng.uniform([-2.5, -2.5, 0.0], [3.5, 2.5, 1.3], (20_000, 3))
    beside = (np.abs(rows[:, 1]) > 0.65) | (rows[:, 0] < -0.6) | (rows[:, 0] > 1.6)
    return rows[beside][:5_000]


def test_a_step_of_the_navigator(benchmark, points):
    navigator = Navigator(CHAIR, [5.0, 0.0])
    times = iter(0.05 * k for k in range(10_000_000))

    def step():
        time = next(times)
        return navigator.step(time, [0.0, 0.0, 0.0], Percept(time, points, 0.018))

    found = benchmark.pedantic(step, rounds=400, warmup_rounds=3)  # 6 s of strangers, 14 s of none
    assert found.shape == (2,)


def test_the_deformation(benchmark, points):
    zone = DeformableZone(ZoneShape.around(CHAIR))
    assert benchmark(zone.measure, points, 0.5, spread=0.018).rays > 0


def test_the_rules(benchmark):
    goal = FuzzyGoalController()
    assert benchmark(goal.command, [0.0, 0.0, 0.3], [2.0, 1.0]).shape == (2,)
