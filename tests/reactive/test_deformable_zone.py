"""The deformable zone: its shape holds the chair, its derivatives are those of its intrusion."""

import math

import casadi as ca
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from narrows.errors import ShapeError
from narrows.reactive.deformable_zone import (
    DeformableZone,
    Deformation,
    RayGrid,
)
from narrows.reactive.zone_law import ZoneGains, zone_law
from narrows.reactive.zone_shape import ZoneShape
from narrows.vehicle import Layer, Vehicle

CHAIR = Vehicle.rectangle(1.2, 0.7, 0.25)
SHAPE = ZoneShape(1.2, 0.6)
FLAT = RayGrid(columns=20_000, rows=1)
ROUND = RayGrid(columns=2_000, rows=301, latitude=math.radians(60.0))


def cast(spheres, grid, *, pose=(0.0, 0.0, 0.0), time=0.0):
    """Return exact ranges to spheres [x, y, z, radius, v_x, v_y] and the sphere each ray meets."""
    theta, phi = grid.azimuths[None, :] + pose[2], grid.latitudes[:, None]
    rays = np.stack(
        [np.cos(theta) * np.cos(phi), np.sin(theta) * np.cos(phi), np.sin(phi) + 0.0 * theta], -1
    )
    ranges, owner = np.full(rays.shape[:2], np.inf), np.full(rays.shape[:2], -1)
    for k, (x, y, z, radius, v_x, v_y) in enumerate(spheres):
        centre = np.array([x + v_x * time - pose[0], y + v_y * time - pose[1], z])
        along = rays @ centre
        inside = along**2 - (centre @ centre - radius**2)
        hit = np.where(
            (inside >= 0) & (along > 0), along - np.sqrt(np.maximum(inside, 0.0)), np.inf
        )
        owner[hit < ranges] = k
        ranges = np.minimum(ranges, hit)
    return ranges, owner


def measured(spheres, grid, speed):
    """Return the deformation of a scene seen from the origin."""
    zone = DeformableZone(SHAPE, grid)
    ranges, owner = cast(spheres, grid)
    drift = np.zeros((*ranges.shape, 2))
    for k, sphere in enumerate(spheres):
        drift[owner == k] = sphere[4:]
    return zone.deform(ranges, speed, drift)


def differences(spheres, grid, speed, step):
    """Return dI by V, by heading, along the way and by time from ray-cast scenes."""
    zone = DeformableZone(SHAPE, grid)

    def intrusion(x=0.0, heading=0.0, time=0.0, v=speed):
        ranges, _ = cast(spheres, grid, pose=(x, 0.0, heading), time=time)
        return zone.deform(ranges, v).intrusion

    return [
        (intrusion(v=speed + step) - intrusion(v=speed - step)) / (2 * step),
        (intrusion(heading=step) - intrusion(heading=-step)) / (2 * step),
        (intrusion(x=step) - intrusion(x=-step)) / (2 * step),
        (intrusion(time=step) - intrusion(time=-step)) / (2 * step),
    ]


SCENES = {
    "ahead, left": [(1.2, 0.3, 0.0, 0.35, 0.0, 0.0)],
    "abeam": [(0.2, 0.8, 0.0, 0.3, 0.3, -0.2)],
    "behind": [(-0.7, -0.2, 0.0, 0.35, 0.5, 0.0)],
    "one before another": [(1.0, 0.2, 0.0, 0.2, -0.4, 0.3), (1.3, 0.5, 0.0, 0.3, 0.0, 0.0)],
    "crossing": [(1.0, 0.0, 0.0, 0.2, 0.0, -0.5), (1.6, -0.2, 0.0, 0.4, 0.0, 0.2)],
}


@pytest.mark.parametrize("name", SCENES)
def test_derivatives_are_those_of_a_ray_cast_scene(name):
    found = measured(SCENES[name], FLAT, 0.5)
    by_speed, by_heading, by_driving, by_others = differences(SCENES[name], FLAT, 0.5, 0.02)
    assert 0.5 * found.by_speed == pytest.approx(by_speed, rel=1e-3)
    # Silhouettes jump from ray to ray: up to 0.3 mrad of an edge of intrusion 1 in 40 mrad.
    assert found.by_heading == pytest.approx(by_heading, abs=0.02)
    assert found.by_driving == pytest.approx(by_driving, abs=0.03)
    assert found.by_others == pytest.approx(by_others, abs=0.03)


@pytest.mark.parametrize("name", ["ahead, left", "one before another"])
def test_derivatives_are_those_of_a_ray_cast_scene_in_three_dimensions(name):
    lifted = [(x, y, 0.2 + 0.1 * k, r, *w) for k, (x, y, _, r, *w) in enumerate(SCENES[name])]
    found = measured(lifted, ROUND, 0.5)
    by_speed, by_heading, by_driving, by_others = differences(lifted, ROUND, 0.5, 0.02)
    assert 0.5 * found.by_speed == pytest.approx(by_speed, rel=1e-3)
    assert found.by_heading == pytest.approx(by_heading, abs=0.01)
    # Edges in latitude between two rows 7 mrad apart.
    assert found.by_driving == pytest.approx(by_driving, rel=0.02)
    assert found.by_others == pytest.approx(by_others, abs=0.02)


def quadratic_reach(length, growth):
    """Return d_h of Eqs. (6)-(12) as a CasADi function of V, theta, phi; a_x = +2/3 c_x."""
    v, theta, phi = ca.SX.sym("v"), ca.SX.sym("theta"), ca.SX.sym("phi")
    c_x = growth * v**2 + length
    c_y = math.sqrt(5.0) / 3.0 * c_x
    a_x = 2.0 / 3.0 * c_x
    x, y, z = ca.cos(theta) * ca.cos(phi), ca.sin(theta) * ca.cos(phi), ca.sin(phi)
    a = (x / c_x) ** 2 + (y / c_y) ** 2 + (z / c_y) ** 2
    b = -2.0 * a_x * x / c_x**2
    c = (a_x / c_x) ** 2 - 1.0
    reach = (-b + ca.sqrt(b**2 - 4.0 * a * c)) / (2.0 * a)
    gradient = ca.gradient(reach, ca.vertcat(v, theta, phi))
    return ca.Function("reach", [v, theta, phi], [reach, gradient])


def test_the_closed_forms_are_those_of_automatic_differentiation():
    automatic = quadratic_reach(1.2, 0.6)
    rng = np.random.default_rng(3)
    for v, theta, phi in rng.uniform([0, -3.1, -1.5], [1.2, 3.1, 1.5], (500, 3)):
        reach, gradient = (np.array(part).ravel() for part in automatic(v, theta, phi))
        own = float(SHAPE.reach(theta, phi, v))
        c_x = SHAPE.c_x(v)
        expected = [
            own * 2.0 * 0.6 * v / c_x,
            -6.0 / (5.0 * c_x) * own**2 * math.sin(theta) * math.cos(phi),
            -6.0 / (5.0 * c_x) * own**2 * math.cos(theta) * math.sin(phi),
        ]
        assert own == pytest.approx(float(reach[0]), rel=1e-12)
        np.testing.assert_allclose(gradient, expected, atol=1e-10)


def test_the_sums_are_those_of_automatic_differentiation():
    grid = RayGrid(columns=40, rows=7, latitude=math.radians(50.0))
    ranges = np.random.default_rng(4).uniform(0.2, 2.5, (7, 40))
    found = DeformableZone(SHAPE, grid).deform(ranges, 0.6)
    automatic = quadratic_reach(1.2, 0.6)
    area = math.prod(grid.steps)
    intrusion = by_speed = by_heading = 0.0
    for phi, row in zip(grid.latitudes, ranges, strict=True):
        for theta, c in zip(grid.azimuths, row, strict=True):
            reach, gradient = (np.array(part).ravel() for part in automatic(0.6, theta, phi))
            if c < reach[0]:
                intrusion += area * (reach[0] / c - 1.0)
                by_speed += area * gradient[0] / c
                by_heading -= area * gradient[1] / c  # the heading turns the rays: d/dalpha
    assert found.intrusion == pytest.approx(intrusion, rel=1e-12)
    assert 0.6 * found.by_speed == pytest.approx(by_speed, rel=1e-12)
    assert found.by_heading == pytest.approx(by_heading, rel=1e-9)


def test_the_long_end_lies_ahead():
    angles = np.array([0.0, 0.5 * math.pi, math.pi])
    np.testing.assert_allclose(SHAPE.reach(angles, 0.0, 0.0) / 1.2, [5 / 3, 5 / 9, 1 / 3])
    assert SHAPE.reach(0.0, 0.5 * math.pi, 0.0) == pytest.approx(1.2 * 5 / 9)
    section = SHAPE.section(0.0)
    assert section[:, 0].max() == pytest.approx(2.0, rel=1e-3)
    assert section[:, 0].min() == pytest.approx(-0.4, rel=1e-3)


def test_the_papers_zone_is_as_high_as_it_says_and_reaches_two_metres():
    paper = ZoneShape.paper()
    assert paper.c_x(0.0) == pytest.approx(1.342, abs=1e-3)
    assert paper.reach(0.0, 0.0, 0.0) == pytest.approx(2.24, abs=0.01)
    top = paper.c_x(0.0) * math.sqrt(5) / 3
    assert top == pytest.approx(1.0)


CHAIRS = [
    CHAIR,
    Vehicle.rectangle(0.9, 0.55, 0.3, height=1.1),
    Vehicle(
        layers=(
            Layer([[-0.25, -0.32], [0.8, -0.32], [0.8, 0.32], [-0.25, 0.32]], (0.0, 0.68)),
            Layer([[-0.2, -0.28], [0.28, -0.28], [0.28, 0.28], [-0.2, 0.28]], (0.68, 1.3)),
        ),
        track=0.56,
    ),
]


@pytest.mark.parametrize("chair", CHAIRS)
@pytest.mark.parametrize("squash", [0.3, 1.0])
def test_the_zone_holds_the_whole_body_with_its_margin(chair, squash):
    margin = 0.05
    shape = ZoneShape.around(chair, margin=margin, squash=squash)
    angle = np.linspace(0, 2 * np.pi, 40)
    ball = margin * np.column_stack([np.cos(angle), np.sin(angle), 0 * angle])
    for layer in chair.layers:
        for z in layer.z:
            for corner in layer.polygon:
                assert shape.holds(np.append(corner, z) + ball, 0.0).all()
    smaller = ZoneShape(0.9 * shape.length, 0.5, shape.center_height, squash)
    far = [np.append(c, z) + b for p in chair.layers for c in p.polygon for z in p.z for b in ball]
    assert not smaller.holds(far, 0.0).all()


def test_what_hangs_above_the_chair_does_not_deform_the_zone():
    zone = DeformableZone(ZoneShape.around(CHAIR))
    over, under = [[0.8, 0.0, 1.31]], [[0.8, 0.0, 1.29]]
    assert zone.measure(over, 0.4).intrusion == 0.0
    assert zone.measure(under, 0.4).intrusion > 0.0


@given(st.floats(0.0, 1.0), st.integers(0, 2**32 - 1))
@settings(deadline=None, max_examples=40)
def test_points_deform_where_they_are_nearer_than_the_zone(speed, seed):
    rng = np.random.default_rng(seed)
    points = rng.uniform([-3, -3, 0], [4, 3, 1.3], (30, 3))
    points = points[points[:, 2] < np.hypot(points[:, 0], points[:, 1])]  # not above the rows
    zone = DeformableZone(SHAPE, RayGrid(rows=9), upright=False)
    found = zone.measure(points, speed)
    assert found.intrusion >= 0.0
    assert (found.rays == 0) == (found.intrusion == 0.0)
    if not SHAPE.holds(0.75 * points, speed).any():  # well outside: no ray's middle in
        assert found.rays == 0


def test_a_mirrored_scene_turns_the_other_way():
    zone = DeformableZone(ZoneShape.around(CHAIR))
    points = np.random.default_rng(5).uniform([0, 0.1, 0], [2, 1, 1.2], (60, 3))
    left, right = zone.measure(points, 0.4), zone.measure(points * [1, -1, 1], 0.4)
    assert left.by_heading == pytest.approx(-right.by_heading, rel=1e-9)
    assert left.by_heading > 0.0  # turning toward it makes it worse
    assert left.by_driving == pytest.approx(right.by_driving, rel=1e-9)


def test_an_upright_obstacle_weighs_the_same_seen_at_one_height_or_at_all():
    zone = DeformableZone(ZoneShape.around(CHAIR))
    heights = np.arange(0.05, 1.3, 0.1)
    wall = np.array([[1.0, y, z] for y in np.arange(-0.5, 0.5, 0.02) for z in heights])
    low = wall[np.isclose(wall[:, 2], 0.15)]
    many, one = zone.measure(wall, 0.4), zone.measure(low, 0.4)
    assert one.intrusion == pytest.approx(many.intrusion, rel=0.1)  # rows of 10 degrees


def test_spread_brings_an_obstacle_nearer_and_closes_the_gaps_of_a_map():
    zone = DeformableZone(SHAPE, RayGrid(rows=1))
    cells = np.array([[0.5, y, 0.0] for y in np.arange(-0.4, 0.41, 0.1)])
    ranges = zone.ranges(cells, 0.0, spread=0.0707)
    ahead = np.abs(zone.grid.azimuths) < math.radians(35.0)
    assert np.isfinite(ranges[0, ahead]).all()
    assert ranges.min() == pytest.approx(0.5 - 0.0707)


def test_without_an_obstacle_nothing_is_asked_for():
    zone = DeformableZone(SHAPE)
    assert zone.measure(np.zeros((0, 3)), 0.5) == Deformation()
    assert zone_law(Deformation(), 0.5, ZoneGains()) == (0.0, 0.0)


def approaching(speed):
    """Return the deformation by somebody 1.5 m ahead who walks toward the chair."""
    points = np.array([[1.5, y, 0.9] for y in np.arange(-0.2, 0.21, 0.02)])
    velocities = np.tile([-speed, 0.0], (len(points), 1))
    zone = DeformableZone(ZoneShape.around(CHAIR))
    return zone.measure(points, 0.5, velocities=velocities)


def test_who_walks_toward_the_chair_slows_it_and_who_walks_away_less():
    toward, standing, away = (approaching(speed) for speed in (1.0, 0.0, -1.0))
    assert toward.by_others == pytest.approx(toward.by_driving, rel=1e-9)  # the same motion
    assert away.by_others == pytest.approx(-toward.by_others, rel=1e-9)
    gains = ZoneGains(braking=100.0, speeding=100.0)
    changes = [zone_law(found, 0.5, gains)[0] for found in (toward, standing, away)]
    assert changes[0] < changes[1] < changes[2]


def test_the_law_is_finite_and_does_not_reverse_at_rest():
    change, omega = zone_law(approaching(1.0), 0.0, ZoneGains())
    assert change == 0.0
    assert math.isfinite(omega)
    flat = DeformableZone(ZoneShape(1.3, growth=0.0)).measure([[1.0, 0.2, 0.0]], 0.0)
    assert zone_law(flat, 0.0, ZoneGains()) == (0.0, -30.0 * flat.by_heading * flat.intrusion)


def test_it_turns_away_and_brakes():
    zone = DeformableZone(ZoneShape.around(CHAIR))
    left = np.array([[1.3, y, 0.5] for y in np.arange(0.05, 0.5, 0.02)])
    change, omega = zone_law(zone.measure(left, 0.6), 0.6, ZoneGains())
    assert omega < 0.0
    assert change < 0.0


def test_wrong_numbers_are_refused():
    with pytest.raises(ShapeError, match="length > 0"):
        ZoneShape(0.0)
    with pytest.raises(ShapeError, match="squash"):
        ZoneShape(1.0, squash=0.0)
    with pytest.raises(ShapeError, match="heights"):
        ZoneShape(1.0, heights=(1.0, 0.0))
    with pytest.raises(ShapeError, match="8 columns"):
        RayGrid(columns=3)
    with pytest.raises(ShapeError, match="braking"):
        ZoneGains(braking=0.0)
    with pytest.raises(ShapeError, match="does not reach the height"):
        ZoneShape.paper().section(0.0, height=2.0)
    with pytest.raises(ShapeError, match="ranges must have shape"):
        DeformableZone(SHAPE).deform(np.ones((2, 2)), 0.0)
