"""Doors and corridors: where they are within 2 cm, and none where there is none."""

import itertools
import math

import numpy as np
import pytest

from narrows.errors import InputError
from narrows.perception.map_scan import scan_of_map
from narrows.perception.obstacle_map import ObstacleMap
from narrows.perception.openings import OpeningOptions, find_corridor, find_doors
from narrows.perception.ranges import LaserScan
from narrows.perception.walls import WallOptions
from narrows.se2 import transform
from narrows.simulation.laser import LaserManners, LaserScanner
from narrows.simulation.surfaces import SensedWorld
from narrows.vehicle import Vehicle
from narrows.world import Solid, World

S300 = LaserScanner()  # 0.5 deg, 1 cm of noise
EXACT = LaserScanner(manners=LaserManners(noise=0.0, dropouts=0.0, beams=2161))
NEAR, BACK = 2.0, ((5.0, -4.0), (5.1, -4.0), (5.1, 4.0), (5.0, 4.0))


def box(x_from, y_from, x_to, y_to):
    return Solid.polygon([[x_from, y_from], [x_to, y_from], [x_to, y_to], [x_from, y_to]])


def wall_with_door(width=0.9, thickness=0.1, *more):
    """A wall across x = 2 with a door in its middle, a room's back wall behind it."""
    half, far = 0.5 * width, NEAR + thickness
    left, right = box(NEAR, half, far, 4.0), box(NEAR, -4.0, far, -half)
    return SensedWorld(World((left, right, Solid.polygon(BACK), *more)))


def seen_from(angle, distance=2.0, turned=0.0):
    """A pose at a distance from the door's middle, so many degrees off its axis, facing it."""
    a = math.radians(angle)
    x, y = NEAR - distance * math.cos(a), -distance * math.sin(a)
    return np.array([x, y, a + math.radians(turned)])


def in_world(door, pose):
    return transform(pose, door.center[None])[0], door.heading + pose[2]


@pytest.mark.parametrize("thickness", [0.1, 0.2, 0.3])
@pytest.mark.parametrize("angle", [-40.0, -20.0, 0.0, 20.0, 40.0])
def test_a_door_is_known_within_two_centimetres_from_two_metres(thickness, angle):
    world, rng, errors = wall_with_door(0.9, thickness), np.random.default_rng(7), []
    for _ in range(30):
        pose = seen_from(angle, turned=rng.uniform(-20.0, 20.0))
        (door,) = find_doors(S300.measure(world, pose, rng=rng))
        center, heading = in_world(door, pose)
        errors.append([door.width - 0.9, *(center - [NEAR, 0.0]), math.degrees(heading)])
    errors = np.abs(errors)
    # Beams are 1.7 cm apart there, so that now and then a jamb is off by more than a centimetre.
    assert np.quantile(errors[:, 0], 0.9) <= 0.02
    assert errors[:, 0].max() <= 0.035
    assert errors[:, 1:3].max() <= 0.02
    assert errors[:, 3].max() <= 0.2


def test_without_noise_and_with_fine_beams_a_door_is_known_within_five_millimetres():
    for angle in (-30.0, 10.0, 45.0):
        pose = seen_from(angle, 1.5)
        (door,) = find_doors(EXACT.measure(wall_with_door(0.85), pose))
        center, heading = in_world(door, pose)
        assert door.width == pytest.approx(0.85, abs=0.005)
        assert center == pytest.approx([NEAR, 0.0], abs=0.005)
        assert heading == pytest.approx(0.0, abs=1e-3)
        assert door.jambs[1] == pytest.approx(
            transform(-pose * [0, 0, 1], (np.array([[NEAR, 0.425]]) - pose[:2]))[0], abs=0.008
        )


@pytest.mark.parametrize("side", ["room", "corridor"])
def test_a_leaf_open_by_a_right_angle_is_a_side_of_the_door(side):
    leaf = box(2.1, 0.41, 3.0, 0.45) if side == "room" else box(1.1, 0.41, 2.0, 0.45)
    world, rng = wall_with_door(0.9, 0.1, leaf), np.random.default_rng(3)
    for angle in (0.0, 20.0, 35.0):
        pose = seen_from(angle)
        (door,) = find_doors(S300.measure(world, pose, rng=rng))
        center, _ = in_world(door, pose)
        assert door.width == pytest.approx(0.86, abs=0.03)  # the leaf is 4 cm thick
        assert center == pytest.approx([NEAR, -0.02], abs=0.02)


@pytest.mark.parametrize("width", [0.3, 0.5, 1.5, 2.5])
def test_what_is_too_narrow_or_too_wide_is_no_door(width):
    assert not find_doors(EXACT.measure(wall_with_door(width), seen_from(10.0)))


def test_a_recess_is_no_door():
    closed = box(2.5, -1.0, 2.6, 1.0)
    assert not find_doors(EXACT.measure(wall_with_door(0.9, 0.1, closed), seen_from(10.0)))


def test_half_a_door_is_none():
    cupboard = box(1.0, 0.1, 1.5, 1.2)
    assert not find_doors(EXACT.measure(wall_with_door(0.9, 0.1, cupboard), seen_from(0.0)))


def test_a_door_somebody_stands_in_is_none():
    person = Solid.circle(2.05, 0.1, 0.2)
    assert not find_doors(EXACT.measure(wall_with_door(0.9, 0.1, person), seen_from(0.0)))


def room(*things):
    walls = ((-3, -3, 3, -2.9), (-3, 2.9, 3, 3), (-3, -3, -2.9, 3), (2.9, -3, 3, 3))
    return SensedWorld(World((*(box(*corners) for corners in walls), *things)))


def test_in_an_open_room_there_is_neither_door_nor_corridor():
    rng = np.random.default_rng(0)
    for heading in np.linspace(-3.0, 3.0, 20):
        scan = S300.measure(room(), [0.4, -0.3, heading], rng=rng)
        assert not find_doors(scan)
        assert find_corridor(scan) is None


def test_between_the_legs_of_chairs_and_tables_there_is_no_door():
    rng = np.random.default_rng(1)
    for _ in range(40):
        legs = []
        for _ in range(5):
            x, y, turn = rng.uniform([-2.4, -2.4, 0.0], [2.4, 2.4, math.pi])
            half = ((0.2, 0.2), (0.6, 0.4))[rng.integers(2)]
            corners = np.array(
                [[a * half[0], b * half[1]] for a, b in itertools.product((-1, 1), repeat=2)]
            )
            legs += [
                Solid.circle(*place, 0.025)
                for place in transform([x, y, turn], corners)
                if np.hypot(*place) > 0.8
            ]
        assert not find_doors(S300.measure(room(*legs), [0.0, 0.0, 0.0], rng=rng))


def test_the_gap_between_a_cupboard_and_a_side_wall_is_no_door():
    assert not find_doors(EXACT.measure(room(box(1.5, -2.0, 2.0, 2.0)), [0.0, 1.0, 0.5]))


def test_doors_are_returned_the_nearest_first():
    far = (box(-2.2, -4.0, -2.1, -1.4), box(-2.2, -0.5, -2.1, 4.0), box(-6.0, -4.0, -5.9, 4.0))
    world = wall_with_door(0.9, 0.1, *far)
    around = LaserScanner(manners=LaserManners(field=2.0 * math.pi, beams=1441))
    doors = find_doors(around.measure(world, [0.5, 0.0, 0.0], rng=np.random.default_rng(2)))
    assert [round(float(np.hypot(*door.center)), 1) for door in doors] == [1.5, 2.8]
    assert doors[1].heading == pytest.approx(math.pi, abs=0.01)


def test_a_scan_the_other_way_round_shows_the_same_doors():
    scan = S300.measure(wall_with_door(), seen_from(20.0), rng=np.random.default_rng(4))
    back = LaserScan(scan.ranges[::-1], -scan.first_angle, -scan.step, scan.mounting)
    (one,), (other,) = find_doors(scan), find_doors(back)
    assert other.width == pytest.approx(one.width, abs=1e-12)
    assert other.center == pytest.approx(one.center, abs=1e-12)


def test_turning_the_chair_turns_the_door():
    world = wall_with_door()
    for turned in (0.0, 30.0, 75.0, -60.0):
        pose = seen_from(15.0, turned=turned)
        (door,) = find_doors(EXACT.measure(world, pose))
        assert in_world(door, pose)[0] == pytest.approx([NEAR, 0.0], abs=0.005)


@pytest.mark.parametrize("ranges", [[], np.full(541, np.nan), np.full(541, np.inf), np.zeros(541)])
def test_silence_and_open_country_have_neither_doors_nor_corridors(ranges):
    scan = LaserScan(ranges, -2.356, math.radians(0.5))
    assert find_doors(scan) == ()
    assert find_corridor(scan) is None


@pytest.mark.parametrize("width", [0.9, 1.2, 1.6, 2.2])
def test_a_corridor_is_known_within_half_a_centimetre(width):
    half, rng = 0.5 * width, np.random.default_rng(5)
    left = box(-1.0, half, 8.0, half + 0.1)
    right = (box(-1.0, -half - 0.1, 3.0, -half), box(4.0, -half - 0.1, 8.0, -half))  # with a gap
    world = SensedWorld(World((left, *right)))
    for _ in range(10):
        y, heading = rng.uniform(-0.2, 0.2), rng.uniform(-0.5, 0.5)
        seen = find_corridor(S300.measure(world, [0.0, y, heading], rng=rng))
        assert seen.width == pytest.approx(width, abs=0.005)
        assert seen.offset == pytest.approx(y, abs=0.005)
        assert seen.direction == pytest.approx(-heading, abs=0.005)
        assert seen.length > 3.0


def test_the_map_shows_the_door_a_cell_narrower_at_most_two():
    rng, world = np.random.default_rng(6), wall_with_door(0.9, 0.2)
    chart = ObstacleMap(vehicle=Vehicle.rectangle(1.0, 0.6, 0.25))
    for distance in np.linspace(2.6, 2.0, 8):
        pose = seen_from(15.0, distance)
        chart.move_to(pose)
        chart.add_scan(S300.measure(world, pose, rng=rng))
    scan = scan_of_map(chart, time=3.0)
    (door,) = find_doors(scan)
    assert scan.time == 3.0
    assert 0.9 - 0.05 <= door.width <= 0.9 + 0.01
    assert in_world(door, pose)[0] == pytest.approx([NEAR, 0.0], abs=0.03)


def test_an_empty_map_is_silence_to_those_who_look_for_doors():
    scan = scan_of_map(ObstacleMap())
    assert not scan.has_answer
    assert find_doors(scan) == ()
    with pytest.raises(InputError, match="no beams"):
        scan_of_map(ObstacleMap(), beams=0)


@pytest.mark.parametrize(
    "change",
    [{"narrowest": 2.0}, {"beyond": 0.0}, {"corridor_width": (2.0, 1.0)}, {"parallel": math.nan}],
)
def test_options_that_leave_no_opening_are_refused(change):
    with pytest.raises(InputError):
        OpeningOptions(**change)
    with pytest.raises(InputError):
        WallOptions(error=0.0)
