"""Ultrasonic cones read the nearest echo, and sixteen of them tell C_r and C_n."""

import math
from itertools import pairwise

import numpy as np
import pytest

from narrows.errors import ShapeError
from narrows.se2 import transform
from narrows.short_forms import Corridor
from narrows.simulation.ultrasound import (
    UltrasoundOptions,
    measure_ranges,
    read_corner,
    sensor_ring,
)
from narrows.vehicle import Vehicle
from narrows.world import MovingSolid, Solid, World

CHAIR = Vehicle.rectangle(1.0, 0.67, 0.0)
WALL = World((Solid.polygon([[2, -5], [2.1, -5], [2.1, 5], [2, 5]], name="wall"),))
AHEAD = np.zeros((1, 3))
ROUGH = UltrasoundOptions(incidence=0.5 * math.pi)


def test_a_wall_askew_is_read_at_right_angles_within_the_cone_and_at_its_rim_beyond():
    for tilt in np.radians([0.0, 5.0, 14.9, 20.0, 40.0]):
        (reading,) = measure_ranges(WALL, [0.0, 0.0, tilt], AHEAD, options=ROUGH)
        beyond = max(0.0, tilt - math.radians(15.0))
        assert reading == pytest.approx(2.0 / math.cos(beyond), abs=1e-9)


@pytest.mark.parametrize(
    ("pose", "sensors", "time"),
    [
        ([np.nan, 0, 0], AHEAD, 0.0),
        ([0, 0], AHEAD, 0.0),
        ([0, 0, 0], np.zeros((2, 2)), 0.0),
        ([0, 0, 0], [[np.inf, 0, 0]], 0.0),
        ([0, 0, 0], AHEAD, math.nan),
    ],
)
def test_nothing_is_read_from_no_place_and_at_no_time(pose, sensors, time):
    with pytest.raises(ShapeError):
        measure_ranges(WALL, pose, sensors, time=time)


def test_a_smooth_wall_too_much_askew_gives_no_echo():
    smooth = UltrasoundOptions(incidence=math.radians(25.0))
    for tilt_deg, seen in ((0.0, True), (39.0, True), (41.0, False)):
        (reading,) = measure_ranges(WALL, [0.0, 0.0, math.radians(tilt_deg)], AHEAD, options=smooth)
        assert (reading < 3.0) == seen


def test_out_of_reach_reads_the_reach_and_backs_of_walls_are_not_seen_through():
    assert measure_ranges(WALL, [-1.5, 0.0, 0.0], AHEAD)[0] == 3.0
    assert measure_ranges(WALL, [0.0, 0.0, math.pi], AHEAD)[0] == 3.0


def test_a_round_post_and_a_thin_edge_are_read_at_their_nearest():
    post = World((Solid.circle(1.5, 0.2, 0.1, name="post"),))
    assert measure_ranges(post, [0, 0, 0], AHEAD)[0] == pytest.approx(math.hypot(1.5, 0.2) - 0.1)
    edge = World((Solid.polygon([[1, 0.1], [1, 0.103], [3, 0.103], [3, 0.1]], name="edge"),))
    assert measure_ranges(edge, [0, 0, 0], AHEAD)[0] == pytest.approx(math.hypot(1.0, 0.1))


def test_what_is_above_a_sensor_is_not_seen():
    table = World((Solid.polygon([[1, -1], [2, -1], [2, 1], [1, 1]], z=(0.7, 0.75), name="top"),))
    assert measure_ranges(table, [0, 0, 0], AHEAD)[0] == 3.0


def test_readings_agree_with_the_distance_to_sampled_walls():
    """Two methods: the least distance of wall points that lie in the cone."""
    world, rng = Corridor(1.3, length=3.0).world(), np.random.default_rng(5)
    points = []
    for solid in world.solids:
        corners = np.asarray(solid.shape.exterior.coords)
        for a, b in pairwise(corners):
            points.append(a + np.linspace(0, 1, 4000)[:, None] * (b - a))
    wall = np.concatenate(points)
    for _ in range(20):
        pose = np.array([rng.uniform(-2, 0.5), rng.uniform(0.2, 1.1), rng.uniform(-3, 3)])
        (reading,) = measure_ranges(world, pose, AHEAD, options=ROUGH)
        offset = wall - pose[:2]
        aside = np.abs(
            np.remainder(np.arctan2(*offset.T[::-1]) - pose[2] + np.pi, 2 * np.pi) - np.pi
        )
        sampled = np.hypot(*offset.T)[aside <= math.radians(15.0)].min(initial=3.0)
        # 1.5 mm between points of the walls, 1.5 degrees between rays at the cone's rim
        assert reading == pytest.approx(min(sampled, 3.0), abs=0.004)


def test_the_ring_has_sixteen_sensors_on_the_outline_looking_out():
    ring = sensor_ring(CHAIR)
    assert ring.shape == (16, 3)
    ahead = np.array([transform(pose, [[0.01, 0.0]])[0] for pose in ring])
    for place, out in zip(ring[:, :2], ahead, strict=True):
        assert 0.0 <= place[0] <= 1.0
        assert abs(place[1]) <= 0.335
        assert not (0.0 <= out[0] <= 1.0 and abs(out[1]) <= 0.335)
    with pytest.raises(ShapeError, match="at least 2 sensors, got 1"):
        sensor_ring(CHAIR, per_side=1)


@pytest.mark.parametrize("turn", [90, -90])
@pytest.mark.parametrize("heading_deg", [-6.0, 0.0, 4.0])
def test_exact_readings_give_the_pose_before_the_corner(turn, heading_deg):
    corridor = Corridor(1.3, math.radians(turn), 1.5)
    side, ring = int(math.copysign(1, turn)), sensor_ring(CHAIR)
    pose = np.array([-1.3, 0.65 - side * 0.08, math.radians(heading_deg)])
    ranges = measure_ranges(corridor.world(), pose, ring)
    reading = read_corner(CHAIR, ring, ranges, width_after=1.5, side=side)
    inner_wall = 1.3 if side > 0 else 0.0
    assert reading.side_gap == pytest.approx(abs(inner_wall - pose[1]) - 0.335, abs=1e-6)
    assert reading.axle_gap == pytest.approx(1.3, abs=1e-6)
    assert reading.heading == pytest.approx(pose[2], abs=1e-6)


def test_a_front_sensor_that_sees_the_inner_corner_first_is_left_out():
    ring, pose = sensor_ring(CHAIR), np.array([-1.6, 0.915, 0.0])
    ranges = measure_ranges(Corridor(1.3).world(), pose, ring)
    assert ranges[:4].min() < 0.7 < 1.89 < ranges[:4].max()
    reading = read_corner(CHAIR, ring, ranges, width_after=1.3)
    assert reading.axle_gap == pytest.approx(1.6, abs=1e-6)


def test_noise_of_5_mm_leaves_centimetres_at_most():
    corridor, ring, rng = Corridor(1.3), sensor_ring(CHAIR), np.random.default_rng(2)
    errors = []
    for _ in range(200):
        ranges = measure_ranges(corridor.world(), [-1.3, 0.5, 0.02], ring, rng=rng)
        reading = read_corner(CHAIR, ring, ranges, width_after=1.3)
        errors.append([reading.side_gap - 0.465, reading.axle_gap - 1.3, reading.heading - 0.02])
    spread = np.std(errors, axis=0)
    # four readings over 0.8 m: 0.005 sqrt(1/4 + 0.25 / 0.36) for the gap, 0.005 / 0.6 for the slope
    assert spread[0] == pytest.approx(0.0049, rel=0.25)
    assert spread[2] == pytest.approx(0.0084, rel=0.25)
    assert spread[1] < 0.01


def test_too_far_from_the_wall_across_is_said():
    ring = sensor_ring(CHAIR)
    ranges = measure_ranges(Corridor(1.3).world(), [-3.0, 0.65, 0.0], ring)
    with pytest.raises(ShapeError, match="drive nearer to the corner"):
        read_corner(CHAIR, ring, ranges, width_after=1.3)


def test_somebody_is_heard_where_he_is_at_the_time():
    walker = MovingSolid(0.2, np.array([[0, 1.0, 0.0], [2, 2.0, 0.0]]), (0.0, 1.8))
    child = MovingSolid(0.2, walker.path - [0, 0.3, 0], (0.0, 0.3))  # lower than the sensor
    world = World(moving=(walker, child))
    readings = [measure_ranges(world, [0, 0, 0], AHEAD, time=t)[0] for t in (0.0, 1.0, 9.0)]
    assert readings == pytest.approx([0.8, 1.3, 1.8])
