"""What timing a path and judging its limits cost, and how near the bound it comes.

`make bench` prints the times; the assertions hold twice the aim, as machines are shared.
"""

from pathlib import Path as File
from time import process_time

import numpy as np
import pytest
from pytest_benchmark.fixture import BenchmarkFixture

from narrows.bezier_section import BezierSection
from narrows.limit_check import check_limits
from narrows.path import Path
from narrows.planners.comfort import ride_comfort
from narrows.planners.doorway import DoorwayPlanner
from narrows.planners.timing import timed_path
from narrows.scene import load_scene
from narrows.vehicle import Vehicle

CHAIR = Vehicle.rectangle(1.0, 0.6, 0.3)
EXAMPLE = File(__file__).parents[2] / "examples" / "scenes" / "narrow-door.yaml"


@pytest.fixture(scope="module")
def through_a_door() -> tuple[Path, Vehicle]:
    """Return a path of 4.8 m through a door and its chair."""
    scene = load_scene(EXAMPLE)
    path = DoorwayPlanner().plan(scene).raise_for_status().path
    assert path is not None
    return path, scene.vehicle


def shunting() -> Path:
    """Return 4.4 m of curves in three legs, forward, in reverse, forward."""
    first = np.array([[[0, 0], [0.6, 0], [1.2, 0.2], [1.6, 0.6]]])
    back = np.array([[[1.6, 0.6], [1.2, 0.2], [0.9, -0.2], [0.9, -0.8]]])
    last = np.array([[[0.9, -0.8], [0.9, -0.2], [0.9, 0.4], [1.1, 1.4]]])
    sections = (BezierSection(first), BezierSection(back, -1), BezierSection(last))
    return Path(sections)


def least_cpu(function, repeats: int = 7) -> float:
    times = []
    for _ in range(repeats):
        start = process_time()
        function()
        times.append(process_time() - start)
    return min(times)


def test_timing_a_path_through_a_door(
    benchmark: BenchmarkFixture, through_a_door: tuple[Path, Vehicle]
) -> None:
    path, chair = through_a_door
    timed = benchmark(lambda: timed_path(Path(path.sections), chair))  # its table too
    assert timed.check.kept
    assert least_cpu(lambda: timed_path(Path(path.sections), chair)) < 0.016


def test_timing_a_shunt_of_three_legs(benchmark: BenchmarkFixture) -> None:
    path = shunting()
    assert benchmark(lambda: timed_path(Path(path.sections), CHAIR)).check.kept
    assert least_cpu(lambda: timed_path(Path(path.sections), CHAIR)) < 0.03


def test_judging_the_limits_at_1_khz(
    benchmark: BenchmarkFixture, through_a_door: tuple[Path, Vehicle]
) -> None:
    trajectory = timed_path(*through_a_door).trajectory
    assert benchmark(check_limits, trajectory, through_a_door[1]).kept
    assert least_cpu(lambda: check_limits(trajectory, through_a_door[1])) < 0.006


def test_comfort_figures(benchmark: BenchmarkFixture, through_a_door: tuple[Path, Vehicle]) -> None:
    trajectory = timed_path(*through_a_door).trajectory
    assert benchmark(ride_comfort, trajectory).weighted_acceleration > 0.0
