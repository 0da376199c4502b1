"""Laser scanners: exact by known answers and by beams cast singly, then noise and the chair."""

import math

import numpy as np
import pytest
import shapely

from narrows.errors import InputError, ShapeError
from narrows.perception.ranges import Beam, ScannerMounting
from narrows.se2 import compose, transform
from narrows.simulation.laser import LaserManners, LaserScanner, front_and_rear, on_corners
from narrows.simulation.surfaces import SensedWorld
from narrows.vehicle import Vehicle
from narrows.world import MovingSolid, Solid, World

CLEAN = LaserManners(noise=0.0, dropouts=0.0)
HERE = [0.0, 0.0, 0.0]
WALL = Solid.polygon([[2, -50], [2.2, -50], [2.2, 50], [2, 50]], name="wall")
CHAIR = Vehicle.rectangle(1.2, 0.7, 0.25)


def scanner(manners: LaserManners = CLEAN, **place: float) -> LaserScanner:
    return LaserScanner(ScannerMounting(**place), manners)


def sensed(*solids: Solid, **more) -> SensedWorld:
    return SensedWorld(World(solids, **more))


def angles_of(laser: LaserScanner) -> np.ndarray:
    return laser.first_angle + laser.step * np.arange(laser.manners.beams)


def test_a_wall_is_read_at_its_distance_over_the_cosine():
    laser = scanner()
    ranges = laser.exact_ranges(sensed(WALL), HERE)
    angle = angles_of(laser)
    expected = np.where(np.abs(angle) < 0.5 * math.pi, 2.0 / np.cos(angle), np.inf)
    expected[expected > 30.0] = np.inf
    np.testing.assert_allclose(ranges, expected, rtol=1e-9)
    assert laser.step == pytest.approx(math.radians(0.5))


def test_a_room_is_read_all_around_without_a_gap():
    """From its middle every beam of a full turn meets one of the walls, corners too."""
    room = shapely.Polygon(
        [(-3, -2), (3, -2), (3, 2), (-3, 2)], [[(-2, -1), (2, -1), (2, 1), (-2, 1)]]
    )
    around = LaserScanner(manners=LaserManners(field=2 * math.pi, beams=721, noise=0.0))
    for heading in (0.0, 1.0, math.pi, -2.0):
        ranges = around.exact_ranges(SensedWorld(World((Solid(room),))), [0.3, -0.2, heading])
        angle = angles_of(around) + heading
        x, y = 0.3 + ranges * np.cos(angle), -0.2 + ranges * np.sin(angle)
        np.testing.assert_allclose(np.maximum(np.abs(x) / 2.0, np.abs(y)), 1.0, atol=1e-12)


@pytest.mark.parametrize("seed", range(6))
def test_every_beam_agrees_with_a_ray_cast_by_itself(seed, plain):
    rng = np.random.default_rng(seed)
    world, time = plain.clutter(rng), rng.uniform(0.0, 3.0)
    manners = LaserManners(beams=61, noise=0.0, dropouts=0.0)
    place = {"height": rng.uniform(0.05, 1.2), "x": 0.2, "y": -0.1, "heading": rng.uniform(-3, 3)}
    laser = scanner(manners, **place)
    for _ in range(20):
        pose = np.array([rng.uniform(-1, 6), rng.uniform(-3, 3), rng.uniform(-9, 9)])
        x, y, heading = compose(pose, laser.mounting.pose)
        if not plain.is_outside(world, x, y, time):
            continue
        ranges = laser.exact_ranges(SensedWorld(world), pose, time)
        for angle, distance in zip(angles_of(laser) + heading, ranges, strict=True):
            ray = (math.cos(angle), math.sin(angle), 0.0)
            exact = plain.cast(world, (x, y, place["height"]), ray, time=time)
            assert distance == pytest.approx(exact if exact <= 30.0 else math.inf, abs=1e-9)


def test_moving_chair_and_world_together_changes_nothing(plain):
    world = plain.clutter(np.random.default_rng(8))
    motion, here, laser = np.array([-2.0, 5.0, 2.5]), np.array([0.0, 0.2, 0.3]), scanner()
    moved = tuple(
        Solid.circle(*transform(motion, np.array([[s.shape.x, s.shape.y]]))[0], s.radius, z=s.z)
        if s.radius
        else Solid.polygon(transform(motion, np.array(s.shape.exterior.coords)[:-1]), z=s.z)
        for s in world.solids
    )
    one = laser.exact_ranges(SensedWorld(World(world.solids)), here)
    other = laser.exact_ranges(SensedWorld(World(moved)), compose(motion, here))
    np.testing.assert_allclose(other, one, rtol=1e-8)


def test_only_what_is_at_its_height_is_seen():
    table = Solid.polygon([[1, -1], [1.5, -1], [1.5, 1], [1, 1]], z=(0.7, 0.75))
    legs = Solid.circle(1.0, 0.0, 0.03, z=(0.0, 0.7))
    for height, expected in ((0.12, 0.97), (0.72, 1.0), (0.8, 2.0)):
        laser = scanner(height=height)
        assert laser.exact_ranges(sensed(WALL, table, legs), HERE)[270] == pytest.approx(expected)


def test_somebody_is_seen_where_he_is_at_the_time():
    walker = MovingSolid(0.2, np.array([[0, 1.5, 0.0], [2, 1.9, 0.0]]))
    ranges = [scanner().exact_ranges(sensed(moving=(walker,)), HERE, t)[270] for t in (0, 1, 9)]
    assert ranges == pytest.approx([1.3, 1.5, 1.7])


def test_noise_has_the_deviation_asked_for_and_dropouts_their_share():
    laser = scanner(LaserManners(noise=0.02, dropouts=0.05))
    rng, exact = np.random.default_rng(0), scanner().exact_ranges(sensed(WALL), HERE)
    hit = np.isfinite(exact) & (exact < 20.0)
    rows = np.array([laser.measure(sensed(WALL), HERE, rng=rng).ranges for _ in range(200)])
    lost = np.isnan(rows)
    assert lost.mean() == pytest.approx(0.05, abs=0.003)  # 4.5 sigma of 108,200
    errors = (rows[:, hit] - exact[hit])[~lost[:, hit]]
    assert errors.std() == pytest.approx(0.02, rel=0.02)
    assert errors.mean() == pytest.approx(0.0, abs=4e-4)
    assert np.isinf(rows[:, 0][~lost[:, 0]]).all()  # nothing within reach stays nothing


def test_the_same_seed_gives_the_same_scan_and_no_generator_no_noise():
    laser, world = LaserScanner(), sensed(WALL)
    scans = [laser.measure(world, HERE, rng=np.random.default_rng(s)).ranges for s in (1, 1, 2)]
    np.testing.assert_array_equal(scans[0], scans[1])
    assert not np.array_equal(scans[0], scans[2], equal_nan=True)
    still = laser.measure(world, HERE).ranges
    np.testing.assert_array_equal(still, laser.exact_ranges(world, HERE))


def test_what_is_too_near_or_out_of_reach_is_told_apart():
    laser = scanner(LaserManners(nearest=0.3, furthest=3.0, noise=0.0, dropouts=0.0))
    for x, says in (
        (0.29, Beam.INVALID),
        (0.31, Beam.RETURN),
        (2.9, Beam.RETURN),
        (3.1, Beam.CLEAR),
    ):
        wall = Solid.polygon([[x, -1], [x + 1, -1], [x + 1, 1], [x, 1]])
        assert laser.measure(sensed(wall), HERE, time=2.0).beams[270] == says
    assert laser.measure(sensed(WALL), HERE, time=2.0).time == 2.0


def test_glass_is_looked_through():
    glass = Solid.polygon([[1, -1], [1.1, -1], [1.1, 1], [1, 1]], name="glass")
    world = SensedWorld(World((WALL, glass)), invisible=("glass",))
    assert scanner().exact_ranges(world, HERE)[270] == pytest.approx(2.0)


def test_the_papers_two_scanners_sit_in_front_and_at_the_back_and_wheels_hide_what_is_beside():
    front, rear = front_and_rear(CHAIR)
    assert front.mounting.pose.tolist() == [pytest.approx(0.95), 0.0, 0.0]
    assert rear.mounting.pose.tolist() == [pytest.approx(-0.25), 0.0, pytest.approx(math.pi)]
    assert front.mounting.height == 0.12
    post = Solid.circle(0.05, 0.45, 0.05)  # beside the left wheel
    for laser in (front, rear):
        points = laser.measure(sensed(post), HERE).points
        assert len(points) == 0
        ahead = laser.mounting.pose
        there = transform(ahead, np.array([[1.0, 0.0]]))[0]
        seen = laser.measure(sensed(Solid.circle(*there, 0.1)), HERE).points
        assert np.hypot(*(seen[:, :2] - there).T) == pytest.approx(0.1)
        # A beam is hidden where it meets a wheel: two rectangles beside the axle.
        chord = math.sqrt(0.16**2 - 0.04**2)
        wheels = shapely.union_all(
            [
                shapely.box(-chord, y - 0.025, chord, y + 0.025)
                for y in (-0.5 * CHAIR.track, 0.5 * CHAIR.track)
            ]
        )
        scan = laser.measure(sensed(), HERE)
        ends = ahead[:2] + 5.0 * scan.directions
        beams = shapely.linestrings(np.stack([np.tile(ahead[:2], (541, 1)), ends], axis=1))
        np.testing.assert_array_equal(np.isnan(scan.ranges), shapely.intersects(beams, wheels))


def test_scanners_on_the_corners_see_all_around():
    rng = np.random.default_rng(2)
    for angle in rng.uniform(-math.pi, math.pi, 60):
        post = Solid.circle(0.35 + 2.0 * math.cos(angle), 2.0 * math.sin(angle), 0.1)
        assert any(len(laser.measure(sensed(post), HERE).points) for laser in on_corners(CHAIR))


def test_odd_scans_have_their_answers():
    """An empty world is clear, from inside a solid nothing is read, odd poses are refused."""
    laser = LaserScanner()
    assert np.isinf(laser.exact_ranges(sensed(), HERE)).all()
    inside = laser.measure(sensed(Solid.circle(0, 0, 1)), HERE, rng=np.random.default_rng(0))
    assert not inside.has_answer
    on_it = laser.measure(sensed(Solid.polygon([[0, -1], [1, -1], [1, 1], [0, 1]])), HERE)
    assert not on_it.has_answer
    for pose in ([math.nan, 0, 0], [0, 0], [0, 0, math.inf]):
        with pytest.raises(ShapeError, match="three finite numbers"):
            laser.measure(sensed(WALL), pose)
    with pytest.raises(ShapeError, match="finite number"):
        laser.measure(sensed(WALL), HERE, math.inf)
    with pytest.raises(InputError, match="inside a part of the chair"):
        LaserScanner(hidden_by=(np.array([[-1, -1], [1, -1], [1, 1], [-1, 1]]),)).measure(
            sensed(WALL), HERE
        )


@pytest.mark.parametrize(
    "wrong",
    [
        {"beams": 0},
        {"beams": 1},
        {"beams": 2.5},
        {"field": 0.0},
        {"field": 7.0},
        {"nearest": 2.0, "furthest": 1.0},
        {"noise": math.nan},
        {"dropouts": -0.1},
    ],
)
def test_manners_no_scanner_has_are_refused(wrong):
    with pytest.raises(InputError):
        LaserManners(**wrong)
