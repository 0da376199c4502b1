"""The depth camera: exact by known answers and by rays cast singly, then the Kinect's manners."""

import math
from dataclasses import replace

import numpy as np
import pytest

from narrows.errors import InputError, ShapeError
from narrows.perception.camera import DepthCamera, Intrinsics, Mounting
from narrows.perception.obstacles import ObstacleFinder
from narrows.perception.surroundings import Sight
from narrows.se2 import compose, transform
from narrows.simulation.depth_sensor import DepthManners, DepthSensor, kinect
from narrows.simulation.surfaces import SensedWorld
from narrows.world import MovingSolid, Solid, World

CLEAN = DepthManners(baseline=0.0, noise=0.0)
LEVEL = kinect(Mounting(0.8, x=0.3))
WALL = Solid.polygon([[2.3, -9], [2.5, -9], [2.5, 9], [2.3, 9]], name="wall")
HERE = [0.0, 0.0, 0.0]


def sensor(camera: DepthCamera = LEVEL, manners: DepthManners = CLEAN, **changes) -> DepthSensor:
    return DepthSensor(camera, replace(manners, **changes))


def sensed(*solids: Solid, **more) -> SensedWorld:
    return SensedWorld(World(solids, **more))


def small(mounting: Mounting) -> DepthCamera:
    view = Intrinsics.from_field_of_view(math.radians(57), math.radians(43), 33, 25)
    return DepthCamera(view, mounting)


def test_a_wall_at_right_angles_has_one_depth_and_the_floor_below_it_its_own():
    inverse = sensor().inverse_depth(sensed(WALL), HERE)
    lens = LEVEL.intrinsics
    floor = (np.arange(lens.height) - lens.cy) / lens.fy / 0.8  # 1/z = y / height
    expected = np.where(floor > 0.5, floor, 0.5)
    np.testing.assert_allclose(inverse, np.tile(expected[:, None], lens.width), rtol=1e-12)


@pytest.mark.parametrize("seed", range(12))
def test_every_pixel_agrees_with_a_ray_cast_by_itself(seed, plain):
    """Any place among the solids, any way up, narrow and wide views, any time."""
    rng = np.random.default_rng(seed)
    world, time = plain.clutter(rng), rng.uniform(-1.0, 4.0)
    mounting = Mounting(
        rng.uniform(0.05, 2.2),
        rng.uniform(-1.5, 1.5),
        *rng.uniform(-0.3, 0.4, 2),
        *rng.uniform(-3.1, 3.1, 2),
    )
    lens = Intrinsics.from_field_of_view(*rng.uniform(0.4, 2.2, 2), 17, 13)
    sensed_world, camera = SensedWorld(world), sensor(DepthCamera(lens, mounting))
    pose = np.array([rng.uniform(-1.0, 5.5), rng.uniform(-3.0, 3.0), rng.uniform(-9.0, 9.0)])
    x, y = transform(pose, mounting.position[None, :2])[0]
    if not plain.is_outside(world, x, y, time):
        pose = np.array([-2.0, 0.0, rng.uniform(-0.5, 0.5)])  # before all of it
        x, y = transform(pose, mounting.position[None, :2])[0]
    inverse = camera.inverse_depth(sensed_world, pose, time)
    c, s = math.cos(pose[2]), math.sin(pose[2])
    for v in range(lens.height):
        for u in range(lens.width):
            ray = mounting.camera_to_body @ [(u - lens.cx) / lens.fx, (v - lens.cy) / lens.fy, 1.0]
            ray = np.array([c * ray[0] - s * ray[1], s * ray[0] + c * ray[1], ray[2]])
            depth = plain.cast(world, [x, y, mounting.height], ray, time=time)
            assert inverse[v, u] == pytest.approx(1.0 / depth, rel=1e-8, abs=1e-10), (v, u)


def test_seen_from_above_a_post_shows_its_top_and_its_side():
    post = Solid.circle(1.0, 0.0, 0.2, z=(0.0, 0.5))
    down = small(Mounting(1.5, 0.5 * math.pi - 1e-6, x=1.0))  # straight down on its middle
    inverse = sensor(down).inverse_depth(sensed(post), HERE)
    assert inverse[12, 16] == pytest.approx(1.0, rel=1e-5)
    slant = small(Mounting(1.5, math.radians(50)))
    seen = sensor(slant).inverse_depth(sensed(post), HERE)[:, 16]
    without = sensor(slant).inverse_depth(sensed(), HERE)[:, 16]
    heights = 1.5 - math.sin(math.radians(50)) / seen  # along the axis; others by their ray
    assert (seen >= without).all()
    assert heights.max() > 0.4


def test_moving_chair_and_world_together_changes_nothing(plain):
    rng = np.random.default_rng(3)
    world, motion = plain.clutter(rng), np.array([3.0, -1.0, 2.1])
    solids = tuple(
        Solid.circle(*transform(motion, np.array([[s.shape.x, s.shape.y]]))[0], s.radius, z=s.z)
        if s.radius
        else Solid.polygon(transform(motion, np.array(s.shape.exterior.coords)[:-1]), z=s.z)
        for s in world.solids
    )
    camera = sensor(small(Mounting(1.0, 0.4)))
    here = np.array([-0.5, 0.1, 0.2])
    one = camera.inverse_depth(SensedWorld(replace(world, moving=())), here)
    other = camera.inverse_depth(SensedWorld(World(solids)), compose(motion, here))
    np.testing.assert_allclose(other, one, rtol=1e-9, atol=1e-12)


def test_depths_are_quantised_in_steps_of_inverse_depth():
    slanted = Solid.polygon([[1.2, -3], [4.0, 3], [4.1, 3], [1.3, -3]])
    image = sensor().measure(sensed(slanted), HERE)
    values = np.unique(image[image > 0])
    levels = np.rint(1.0 / (values * 1e-3) / LEVEL.step)
    np.testing.assert_array_equal(values, np.rint(1e3 / (LEVEL.step * levels)))
    assert len(values) == np.ptp(levels) + 1 > 70  # and every level between is met


def test_noise_has_the_deviation_asked_for_and_dropouts_their_share():
    noisy = sensor(manners=DepthManners(baseline=0.0, noise=0.01, dropouts=0.1))
    image = noisy.measure(sensed(WALL), HERE, rng=np.random.default_rng(0))[:200]  # wall only
    returns = image[image > 0]
    assert 1.0 - returns.size / image.size == pytest.approx(0.1, abs=0.003)  # 3.6 sigma of 128,000
    spread = np.std(1e3 / returns.astype(float))
    assert spread == pytest.approx(math.hypot(0.01, LEVEL.step / math.sqrt(12)), rel=0.01)
    assert np.mean(1e3 / returns.astype(float)) == pytest.approx(0.5, abs=2e-4)


def test_the_same_seed_gives_the_same_image_and_no_generator_no_noise():
    camera, world = DepthSensor(LEVEL), sensed(WALL)
    one, again, other = (
        camera.measure(world, HERE, rng=np.random.default_rng(seed)) for seed in (1, 1, 2)
    )
    np.testing.assert_array_equal(one, again)
    assert (one != other).any()
    still = camera.measure(world, HERE)
    np.testing.assert_array_equal(still, camera.measure(world, HERE))
    assert len(np.unique(still[:200])) == 1


def test_nothing_comes_back_from_either_side_of_an_edge():
    box = Solid.polygon([[1.5, -0.2], [1.6, -0.2], [1.6, 0.2], [1.5, 0.2]])
    exact = sensor().inverse_depth(sensed(WALL, box), HERE)[100]
    image = sensor().measure(sensed(WALL, box), HERE)[100]
    jumps = np.flatnonzero(np.abs(np.diff(exact)) > 0.1)
    assert len(jumps) == 2
    missing = np.flatnonzero(image == 0)
    np.testing.assert_array_equal(missing, np.sort(np.concatenate([jumps, jumps + 1])))


@pytest.mark.parametrize(("step", "lost"), [(0.05, 0), (0.07, 2)])
def test_a_step_of_three_percent_of_the_inverse_depth_is_an_edge(step, lost):
    """On a wall at 2 m: 1 / 1.95 is 2.6 % more than 1 / 2, 1 / 1.93 is 3.6 %."""
    panel = Solid.polygon([[2.3 - step, 0.0], [2.3, 0.0], [2.3, 9], [2.3 - step, 9]])
    image = sensor().measure(sensed(WALL, panel), HERE)[100]
    assert np.count_nonzero(image == 0) == lost


def test_what_stands_in_front_throws_the_projectors_shadow_to_its_left():
    box = Solid.polygon([[1.5, -0.2], [1.6, -0.2], [1.6, 0.2], [1.5, 0.2]])
    image = sensor(baseline=0.075).measure(sensed(WALL, box), HERE)[100]
    exact = sensor().inverse_depth(sensed(WALL, box), HERE)[100]
    left, right = np.flatnonzero(np.abs(np.diff(exact)) > 0.1)
    width = LEVEL.intrinsics.fx * 0.075 * (1.0 / 1.2 - 1.0 / 2.0)  # 14.7 px
    shadow = np.flatnonzero(image[: left + 1] == 0)
    assert len(shadow) == pytest.approx(width, abs=1.0)
    assert shadow[-1] == left
    assert (image[right + 2 :] > 0).all()


def test_grazing_walls_do_not_answer():
    side = Solid.polygon([[0, 0.4], [9, 0.4], [9, 0.5], [0, 0.5]])  # 0.4 m to the left, along x
    camera = sensor(replace(LEVEL, furthest=9.0), edge=1.0)
    exact, image = camera.inverse_depth(sensed(side), HERE), camera.measure(sensed(side), HERE)
    row, lens = 239, LEVEL.intrinsics
    across = (lens.cx - np.arange(lens.width)) / lens.fx  # y / z
    on_wall = (across > 0.4 / 8.0) & (exact[row] <= 2.0)
    incidence = np.arccos(across / np.sqrt(across**2 + 1.0))  # normal is along y
    answers = incidence < camera.manners.incidence
    np.testing.assert_array_equal(image[row, on_wall] > 0, answers[on_wall])
    assert answers[on_wall].any()
    assert not answers[on_wall].all()


@pytest.mark.parametrize(("distance", "seen"), [(0.49, 0), (0.51, 1), (3.99, 1), (4.01, 0)])
def test_too_near_and_too_far_do_not_answer(distance, seen):
    wall = Solid.polygon([[0.3 + distance, -9], [9, -9], [9, 9], [0.3 + distance, 9]])
    image = sensor().measure(sensed(wall), HERE)[:230]
    assert (image > 0).all() == bool(seen)
    assert (image > 0).any() == bool(seen)


def test_glass_is_looked_through():
    glass = Solid.polygon([[1, -1], [1.1, -1], [1.1, 1], [1, 1]], name="glass")
    seen = sensor().inverse_depth(SensedWorld(World((WALL, glass)), invisible=["glass"]), HERE)
    np.testing.assert_array_equal(seen, sensor().inverse_depth(sensed(WALL), HERE))
    with pytest.raises(InputError, match=r"no solid of that name.*'glas'.*glass, wall"):
        SensedWorld(World((WALL, glass)), invisible=["glas"])


def test_somebody_is_seen_where_he_is_at_the_time():
    walker = MovingSolid(0.2, np.array([[0, 2.0, 0.0], [2, 3.0, 0.0]]), (0, 1.8))
    world = SensedWorld(World(moving=(walker,)))
    for time, x in ((-1.0, 2.0), (0.0, 2.0), (1.0, 2.5), (5.0, 3.0)):
        inverse = sensor(small(Mounting(1.0))).inverse_depth(world, HERE, time)
        assert 1.0 / inverse[12, 16] == pytest.approx(x - 0.2)


def test_odd_views_have_their_answers():
    """Inside a solid nothing returns; an empty world is floor; above the horizon is nothing."""
    camera = DepthSensor(LEVEL)
    around = sensed(Solid.circle(0.0, 0.0, 1.0), WALL)
    assert np.isinf(camera.inverse_depth(around, HERE)).all()
    assert (camera.measure(around, HERE, rng=np.random.default_rng(0)) == 0).all()
    on_it = sensed(Solid.polygon([[0.3, -1], [1, -1], [1, 1], [0.3, 1]]))
    assert (camera.measure(on_it, HERE) == 0).all()
    floor = camera.inverse_depth(sensed(), HERE)
    assert (floor[:239] == 0.0).all()
    assert (floor[241:] > 0.0).all()
    up = DepthSensor(kinect(Mounting(0.8, -math.radians(40))))
    assert (up.measure(sensed(), HERE) == 0).all()


@pytest.mark.parametrize("pose", [[math.nan, 0, 0], [0, 0, math.inf], [0, 0], [[0, 0, 0]]])
def test_a_pose_that_is_none_is_refused(pose):
    with pytest.raises(ShapeError, match="three finite numbers"):
        DepthSensor(LEVEL).measure(sensed(WALL), pose)
    with pytest.raises(ShapeError, match="finite number"):
        DepthSensor(LEVEL).measure(sensed(WALL), HERE, math.nan)


@pytest.mark.parametrize(
    "wrong",
    [
        {"nearest": 0.0},
        {"edge": math.nan},
        {"baseline": -0.1},
        {"noise": -1.0},
        {"incidence": 2.0},
        {"dropouts": 1.1},
    ],
)
def test_manners_no_camera_has_are_refused(wrong):
    with pytest.raises(InputError):
        DepthManners(**wrong)


def test_the_fast_route_finds_floor_and_box_in_what_is_simulated():
    """Noise, quantisation and missing returns are what perception expects of a real camera."""
    mounting = Mounting(0.8, math.radians(28), x=0.3)
    box = Solid.polygon([[1.6, -0.2], [1.9, -0.2], [1.9, 0.3], [1.6, 0.3]], z=(0, 0.4))
    camera = DepthSensor(kinect(mounting))
    image = camera.measure(sensed(box), HERE, rng=np.random.default_rng(4))
    seen = ObstacleFinder(camera.camera).see(image)
    assert seen.sight is Sight.SEEN
    assert seen.floor is not None
    assert seen.floor.mounting.tilt == pytest.approx(mounting.tilt, abs=math.radians(0.2))
    assert seen.floor.mounting.height == pytest.approx(0.8, abs=0.005)
    assert len(seen.obstacles) == 1
    np.testing.assert_allclose(seen.obstacles[0].low[:2], [1.6, -0.2], atol=0.03)
    assert seen.obstacles[0].high[2] == pytest.approx(0.4, abs=0.03)
    assert not seen.drop_offs
