"""Depth frames in the map: what stands, what hangs, what is looked through, what is not known."""

import math

import numpy as np
import pytest

from narrows.errors import InputError, ShapeError
from narrows.perception.camera import Mounting
from narrows.perception.obstacle_map import ObstacleMap
from narrows.perception.obstacles import ObstacleFinder
from narrows.perception.ranges import LaserScan
from narrows.perception.surroundings import Cell
from narrows.studies.perception_frames import SIMULATED, depth_of_boxes, kinect

FLOOR, WALL = (-1.0, -3.0, -0.1, 6.0, 3.0, 0.0), (3.3, -3.0, 0.0, 3.4, 3.0, 2.5)
BOX = (1.5, 0.2, 0.0, 1.8, 0.5, 0.40)
LAMP = (1.5, -0.5, 0.92, 1.8, -0.2, 1.28)
CAMERA = kinect(Mounting(0.8, math.radians(12.0), x=0.3))
FINDER = ObstacleFinder(CAMERA)


def put(boxes, chart=None, *, true=CAMERA, frames=1, finder=FINDER):
    chart = chart or ObstacleMap()
    depth = depth_of_boxes(boxes, true)
    for k in range(frames):
        chart.add_frame(depth, finder.see(depth, 1.0 + k), finder)
    return chart


def state(chart, x, y, low, high):
    x_from, _, y_from, _ = chart.extent
    cell = chart.options.cell
    return chart.states((low, high))[int((x - x_from) // cell), int((y - y_from) // cell)]


@pytest.fixture(scope="module")
def room():
    return put([FLOOR, WALL, BOX, LAMP])


def test_a_box_on_the_floor_is_occupied_as_high_as_it_is(room):
    assert state(room, 1.51, 0.35, 0.0, 0.1) == Cell.OBSTACLE
    assert state(room, 1.51, 0.35, 0.3, 0.4) == Cell.OBSTACLE
    assert state(room, 1.51, 0.35, 0.5, 0.8) == Cell.FREE


def test_under_what_hangs_the_way_is_free_for_what_is_low_enough(room):
    points = room.percept().points
    lamp = points[(np.abs(points[:, 0] - 1.65) < 0.2) & (np.abs(points[:, 1] + 0.35) < 0.2)]
    assert len(lamp) > 5
    assert lamp[:, 2].min() > 0.9
    assert state(room, 1.65, -0.35, 0.1, 0.8) == Cell.FREE
    assert lamp[:, 0].min() == pytest.approx(1.5, abs=0.05)


def test_what_is_hidden_outside_the_view_or_under_the_camera_is_unknown(room):
    assert state(room, 2.2, 0.45, 0.0, 0.1) == Cell.UNKNOWN  # behind the box
    assert state(room, 2.0, -2.0, 0.0, 1.6) == Cell.UNKNOWN  # beside the image
    assert state(room, 0.4, 0.0, 0.0, 0.3) == Cell.UNKNOWN  # below it
    assert state(room, 3.6, 0.0, 0.0, 1.6) == Cell.UNKNOWN  # behind the wall


def test_a_frame_marks_nothing_on_a_bare_floor():
    chart = put([FLOOR, WALL], frames=5)
    points = chart.percept().points
    assert len(points)
    assert points[:, 0].min() > 3.2


def test_what_was_removed_is_forgotten():
    chart = put([FLOOR, WALL, BOX])
    put([FLOOR, WALL], chart, frames=6)
    assert state(chart, 1.51, 0.35, 0.0, 0.4) == Cell.FREE


def test_a_missing_floor_is_an_obstacle():
    (height, tilt), boxes = SIMULATED["stairs down"]
    finder = ObstacleFinder(kinect(Mounting(height, math.radians(tilt))))
    chart = put(boxes, true=finder.camera, finder=finder)
    assert state(chart, 1.85, 0.0, 0.0, 0.1) == Cell.OBSTACLE
    assert state(chart, 1.6, 0.0, 0.0, 0.1) == Cell.FREE


def test_a_camera_knocked_by_five_degrees_puts_things_where_they_are():
    knocked = kinect(Mounting(0.8, math.radians(17.0), x=0.3))
    chart = put([FLOOR, WALL, BOX], true=knocked)
    points = chart.percept(heights=(0.0, 0.4)).points
    box = points[points[:, 0] < 2.5]
    assert box[:, 0].min() == pytest.approx(1.5, abs=0.05)
    assert box[:, 1].min() == pytest.approx(0.2, abs=0.05)
    assert box[:, 1].max() == pytest.approx(0.5, abs=0.05)


def test_where_the_floor_is_only_assumed_nothing_is_free():
    (height, tilt), boxes = SIMULATED["wall"]
    finder = ObstacleFinder(kinect(Mounting(height, math.radians(tilt))))
    chart = put(boxes, true=finder.camera, finder=finder)
    assert len(chart.percept().points) > 100
    assert (chart.states() != Cell.FREE).all()


@pytest.mark.parametrize(
    "depth", [None, np.zeros((480, 640), np.uint16), np.full((480, 640), np.nan)]
)
def test_a_silent_or_blind_camera_changes_nothing_and_has_not_spoken(depth):
    chart = put([FLOOR, WALL, BOX])
    before = chart.states()
    chart.add_frame(depth, FINDER.see(depth, 9.0), FINDER)
    assert np.array_equal(chart.states(), before)
    assert chart.time == 1.0


def test_a_frame_of_another_size_or_type_is_refused():
    chart = ObstacleMap()
    seen = FINDER.see(depth_of_boxes([FLOOR, WALL], CAMERA))
    with pytest.raises(ShapeError):
        chart.add_frame(np.zeros((240, 320), np.uint16), seen, FINDER)
    with pytest.raises(InputError):
        chart.add_frame(np.zeros((480, 640), np.int8), seen, FINDER)


def test_a_turned_and_moved_chair_puts_things_at_their_place_in_the_world():
    pose = np.array([3.0, -1.0, 2.0])
    chart = ObstacleMap(pose=pose)
    put([FLOOR, WALL, BOX], chart)
    points = chart.percept(heights=(0.0, 0.4)).points
    box = points[points[:, 0] < 2.5]
    assert box[:, 0].min() == pytest.approx(1.5, abs=0.04)
    assert box[:, 1].mean() == pytest.approx(0.35, abs=0.03)


def test_a_laser_and_a_camera_share_one_map():
    chart = put([FLOOR, WALL, BOX])
    angles = np.radians(np.arange(-135.0, 135.5, 0.5))
    chart.add_scan(LaserScan(np.full(len(angles), 3.0), angles[0], np.radians(0.5), time=2.0))
    assert state(chart, 2.0, -2.0, 0.0, 1.6) == Cell.FREE
    assert chart.heard == {"camera": 1.0, "laser": 2.0}
    assert chart.time == 1.0
