"""How long a step of the obstacle map takes, and the search for doors."""

import numpy as np
import pytest

from narrows.perception.map_scan import scan_of_map
from narrows.perception.obstacle_map import ObstacleMap
from narrows.perception.obstacles import ObstacleFinder
from narrows.perception.openings import find_doors
from narrows.simulation.laser import front_and_rear
from narrows.simulation.surfaces import SensedWorld
from narrows.studies.perception_frames import SIMULATED, load_frame
from narrows.studies.perception_times import drive_through_a_door


@pytest.fixture(scope="module")
def driven():
    """A map half-way along a drive, and the last scan."""
    drive = drive_through_a_door(30)
    sensed, rng = SensedWorld(drive.world), np.random.default_rng(0)
    chart = ObstacleMap(vehicle=drive.vehicle, pose=drive.poses[0])
    front, rear = front_and_rear(drive.vehicle)
    for pose in drive.poses[:20]:
        chart.move_to(pose)
        chart.add_scan(rear.measure(sensed, pose, rng=rng))
        scan = front.measure(sensed, pose, rng=rng)
        chart.add_scan(scan)
    return chart, scan


def test_a_scan_into_the_map(benchmark, driven):
    chart, scan = driven
    benchmark(chart.add_scan, scan)
    assert chart.heard


def test_reading_the_map(benchmark, driven):
    assert len(benchmark(driven[0].percept).points)


@pytest.mark.parametrize("name", sorted(SIMULATED))
def test_a_frame_into_the_map(benchmark, name):
    frame = load_frame(name, None)
    finder, chart = ObstacleFinder(frame.camera), ObstacleMap()
    seen = finder.see(frame.depth)
    benchmark(chart.add_frame, frame.depth, seen, finder)
    assert len(chart.percept().points)


def test_doors_in_a_scan(benchmark, driven):
    benchmark(find_doors, driven[1])


def test_doors_in_the_map(benchmark, driven):
    benchmark(lambda: find_doors(scan_of_map(driven[0])))
