"""Every reading means one thing: something there, nothing there, or no answer."""

import numpy as np
import pytest

from narrows.errors import InputError, ShapeError
from narrows.perception.ranges import Beam, LaserScan, ScannerMounting, UltrasoundReadings


def test_each_reading_is_a_return_clear_or_invalid():
    ranges = [1.0, np.nan, np.inf, 0.0, -1.0, -np.inf, 0.01, 30.0, 30.1]
    scan = LaserScan(ranges, 0.0, 0.1, nearest=0.02, furthest=30.0)
    hit, clear, bad = Beam.RETURN, Beam.CLEAR, Beam.INVALID
    assert list(scan.beams) == [hit, bad, clear, bad, bad, bad, bad, hit, clear]
    assert list(scan.free_reach(short=0.05)) == pytest.approx([0.95, 0, 30, 0, 0, 0, 0, 29.95, 30])
    assert len(scan.points) == 2
    assert scan.has_answer


@pytest.mark.parametrize("value", [np.nan, 0.0, -np.inf])
def test_a_scan_without_an_answer_says_so_and_shows_nothing_free(value):
    scan = LaserScan(np.full(5, value), 0.0, 0.1)
    assert not scan.has_answer
    assert len(scan.points) == 0
    assert not scan.free_reach().any()
    assert np.array_equal(scan.free_polygon(), np.zeros((6, 2)))


def test_an_empty_scan_is_silence():
    scan = LaserScan([], 0.0, 0.1)
    assert not scan.has_answer
    assert scan.points.shape == (0, 3)
    assert scan.free_polygon().shape == (1, 2)


def test_points_stand_where_the_mounting_puts_them():
    mounting = ScannerMounting(height=0.3, x=-0.2, y=0.1, heading=np.pi)
    scan = LaserScan([1.0, 2.0], 0.0, np.pi / 2, mounting)
    assert scan.points == pytest.approx(np.array([[-1.2, 0.1, 0.3], [-0.2, -1.9, 0.3]]))


def test_a_scanner_that_turns_clockwise_sees_the_mirror_image():
    ranges = np.array([1.0, 2.0, 3.0])
    left = LaserScan(ranges, -0.5, 0.5).points
    right = LaserScan(ranges, 0.5, -0.5).points
    assert right == pytest.approx(left * [1.0, -1.0, 1.0])


def test_the_free_polygon_ends_short_of_returns_and_at_the_reach_asked_for():
    scan = LaserScan([2.0, np.inf, np.nan], 0.0, np.pi / 2)
    corners = scan.free_polygon(short=0.1, longest=4.0)
    assert corners == pytest.approx(np.array([[0, 0], [1.9, 0], [0, 4], [0, 0]]), abs=1e-12)


def test_a_scan_keeps_a_copy_nobody_can_change():
    ranges = np.ones(3)
    scan = LaserScan(ranges, 0.0, 0.1)
    ranges[:] = 9.0
    assert (scan.ranges == 1.0).all()
    with pytest.raises(ValueError, match="read-only"):
        scan.ranges[0] = 2.0


@pytest.mark.parametrize(
    ("change", "error"),
    [
        ({"ranges": np.ones((2, 2))}, ShapeError),
        ({"ranges": ["near", "far"]}, InputError),
        ({"ranges": [True, False]}, InputError),
        ({"first_angle": np.nan}, InputError),
        ({"step": 0.0}, InputError),
        ({"step": 4.0}, InputError),
        ({"time": np.inf}, InputError),
        ({"nearest": 40.0}, InputError),
    ],
)
def test_what_is_no_scan_is_refused(change, error):
    with pytest.raises(error):
        LaserScan(**({"ranges": np.ones(3), "first_angle": 0.0, "step": 0.1} | change))


@pytest.mark.parametrize("change", [{"height": 0.0}, {"x": np.nan}, {"heading": np.inf}])
def test_what_is_no_mounting_is_refused(change):
    with pytest.raises(InputError):
        ScannerMounting(**change)


def test_an_echo_may_come_from_all_of_its_arc_and_no_echo_from_nowhere():
    sensors = [[0.5, 0.0, 0.0], [0.0, 0.3, np.pi / 2], [0.0, -0.3, -np.pi / 2]]
    readings = UltrasoundReadings([1.0, 3.0, np.nan], sensors, reach=3.0)
    arcs = readings.arcs(0.05)
    assert np.hypot(arcs[:, 0] - 0.5, arcs[:, 1]) == pytest.approx(np.ones(len(arcs)))
    assert np.degrees(np.arctan2(arcs[:, 1], arcs[:, 0] - 0.5)).max() == pytest.approx(15.0)
    assert np.linalg.norm(np.diff(arcs[:, :2], axis=0), axis=1).max() <= 0.05
    assert readings.has_answer
    assert not UltrasoundReadings([np.nan, 0.0, -1.0], sensors).has_answer


def test_readings_and_sensors_must_be_as_many():
    with pytest.raises(ShapeError, match=r"sensors must be finite poses \(1, 3\)"):
        UltrasoundReadings([1.0], np.zeros((2, 3)))
