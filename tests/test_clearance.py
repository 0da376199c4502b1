"""The certificate against a referee of its own, closed forms, invariants; a count of its work."""

import itertools
import math

import numpy as np
import pytest
import shapely

from narrows.bezier_section import BezierSection
from narrows.clearance import Certificate, certify, clearance_at
from narrows.clearance_search import MotionSearch
from narrows.errors import ShapeError
from narrows.path import Path
from narrows.profile import Profile
from narrows.se2 import compose, exponential, rotate, transform
from narrows.trajectory import Trajectory
from narrows.vehicle import Layer, Vehicle
from narrows.world import MovingSolid, Solid, World

CHAIR = Vehicle.rectangle(1.0, 0.67, 0.25)
CORNER = math.hypot(0.75, 0.335)  # m, the chair's furthest point from its axle's middle
LAYERED = Vehicle(
    (
        Layer(
            np.array([[-0.25, -0.3], [0.8, -0.3], [0.9, 0.0], [0.8, 0.3], [-0.25, 0.3]]), (0, 0.7)
        ),
        Layer(np.array([[-0.3, -0.2], [0.3, -0.25], [0.3, 0.25], [-0.3, 0.2]]), (0.7, 1.3)),
    )
)
BENT = [[0, 0], [0.9, 0], [0.9, 0.3], [0.3, 0.3], [0.3, 0.9], [0, 0.9]]  # an L, not convex
EXACT = 1e-9  # m: rounding in metres


def random_world(rng: np.random.Generator) -> World:
    """Boxes, L shapes, posts and a table top about the origin, none nearer than 0.9 m."""
    solids = []
    for index in range(rng.integers(3, 9)):
        away, angle = rng.uniform(0.9, 2.6), rng.uniform(-math.pi, math.pi)
        at = away * np.array([math.cos(angle), math.sin(angle)])
        z = (0.72, 0.76) if rng.random() < 0.3 else (0.0, 2.5)
        kind = rng.integers(3)
        if kind == 0:
            solids.append(Solid.circle(*at, rng.uniform(0.02, 0.3), z=z, name=f"post {index}"))
            continue
        shape = np.array(BENT) if kind == 1 else np.array([[0, 0], [1, 0], [0.8, 0.2], [0.1, 0.3]])
        corners = rotate(rng.uniform(-math.pi, math.pi), rng.uniform(0.3, 1.5) * shape) + at
        solids.append(Solid.polygon(corners, z=z, name=f"block {index}"))
    return World(tuple(solids))


def random_curve(rng: np.random.Generator) -> Path:
    """Cubic curves joined smoothly, forward or in reverse; a few turn within a centimetre."""
    count = int(rng.integers(1, 4))
    turns = rng.normal(scale=3.0 if rng.random() < 0.1 else 0.8, size=count + 1)
    headings = np.cumsum(turns) + rng.uniform(-math.pi, math.pi)
    ahead = np.column_stack([np.cos(headings), np.sin(headings)])
    steps = rng.uniform(0.4, 1.0, size=(count, 1))
    points = np.cumsum(np.vstack([rng.normal(scale=0.3, size=2), steps * ahead[:-1]]), axis=0)
    points[1:] += 0.3 * steps * (ahead[1:] - ahead[:-1])
    legs = rng.uniform(0.15, 0.4, size=(count + 1, 1)) * ahead
    control = [
        [points[k], points[k] + legs[k], points[k + 1] - legs[k + 1], points[k + 1]]
        for k in range(count)
    ]
    return Path((BezierSection(np.array(control), int(rng.choice([-1, 1]))),))


def random_twists(rng: np.random.Generator) -> Path:
    """Lines, arcs, turns on the spot and shunts; a tenth of them slipping sideways."""
    slip = rng.random() < 0.1
    poses = [np.append(rng.normal(scale=0.3, size=2), rng.uniform(-3, 3))]
    for _ in range(rng.integers(1, 7)):
        kind = rng.integers(4)
        forward = 0.0 if kind == 0 else rng.choice([-1, 1]) * rng.uniform(0.1, 0.8)
        turn = 0.0 if kind == 1 else rng.choice([-1, 1]) * rng.uniform(0.1, 2.0)
        twist = np.array([forward, rng.normal(scale=0.1) if slip else 0.0, turn])
        poses.append(compose(poses[-1], exponential(twist)))
    return Path.from_poses(poses)


def random_motion(seed: int) -> tuple[World, Vehicle, Path]:
    rng = np.random.default_rng(seed)
    path = random_curve(rng) if seed % 2 else random_twists(rng)
    return random_world(rng), (CHAIR, LAYERED)[seed // 2 % 2], path


class Referee:
    """The clearance at single poses by Shapely; in an overlap, its depth by `clearance_at`."""

    def __init__(self, world: World, vehicle: Vehicle) -> None:
        """Merge what each layer can meet."""
        self.world, self.vehicle = world, vehicle
        self.solids = [
            [s for s in world.solids if s.z[0] < layer.z[1] and layer.z[0] < s.z[1]]
            for layer in vehicle.layers
        ]

    def __call__(self, poses: np.ndarray) -> np.ndarray:
        """Return the clearance of the body standing at poses (N, 3)."""
        least = np.full(len(poses), np.inf)
        for layer, solids in zip(self.vehicle.layers, self.solids, strict=True):
            bodies = shapely.polygons(transform(poses, layer.polygon))
            for solid in solids:
                least = np.minimum(least, shapely.distance(bodies, solid.shape) - solid.radius)
        touching = np.flatnonzero(least < 1e-6)
        if len(touching):
            least[touching] = clearance_at(self.world, self.vehicle, poses[touching])[0]
        return least

    def least(self, path: Path) -> tuple[float, float]:
        """Return bounds on the least clearance along a path, 0.04 mm apart.

        No body point moves further than |p'| + r |heading'| per progress; the middle's clearance
        less that times half the interval bounds the interval. Curvature by sampling, 10 % added;
        where it is wild nothing is said from below.
        """
        turn = float(np.abs(path(np.linspace(0, path.span, 4001), 1)[:, 2]).max())
        rate = 1.0 + 1.1 * self.vehicle.radius * turn
        middle, half = np.linspace(0, path.span, 161)[1::2], path.span / 160
        best = math.inf
        while True:
            distance = self(path(middle))
            best = min(best, float(distance.min()))
            if rate * half < 4e-5 or rate > 40.0:
                return (best - rate * half if rate <= 40.0 else -math.inf), best
            near = middle[distance - rate * half < best]
            half /= 4
            middle = (near[:, None] + half * np.array([-3.0, -1.0, 1.0, 3.0])).ravel()


def check_against_the_referee(seed: int, tolerance: float = 1e-3) -> Certificate:
    world, vehicle, path = random_motion(seed)
    referee = Referee(world, vehicle)
    certificate = certify(world, vehicle, path, tolerance=tolerance)
    below, least = referee.least(path)
    if math.isinf(least):
        assert math.isinf(certificate.clearance)
        return certificate
    dense = referee(path(np.linspace(0.0, path.span, 1500))).min()
    assert certificate.clearance <= min(dense, least) + EXACT, seed
    assert certificate.clearance >= below - tolerance, seed
    # seen at a pose of the motion, so it cannot lie below the least
    assert below <= certificate.attained <= certificate.clearance + tolerance + EXACT
    here = path(certificate.at[0])
    np.testing.assert_allclose(here[:2], certificate.at[1:], atol=EXACT)
    distance, against = clearance_at(world, vehicle, here)
    assert distance[0] == pytest.approx(certificate.attained, abs=1e-6)  # Newton about a cusp
    assert against[0] == certificate.against
    return certificate


@pytest.mark.parametrize("block", range(4))
def test_it_is_never_above_dense_sampling_and_within_a_millimetre_of_the_truth(block: int) -> None:
    found = [check_against_the_referee(seed) for seed in range(8 * block, 8 * block + 8)]
    assert any(certificate.is_clear for certificate in found)
    assert not all(certificate.is_clear for certificate in found)


@pytest.mark.slow
@pytest.mark.parametrize("block", range(1, 6))
def test_hundreds_of_random_motions_agree_with_the_referee(block: int) -> None:
    for seed in range(60 * block, 60 * block + 60):
        check_against_the_referee(seed)


def test_a_finer_tolerance_brings_it_nearer() -> None:
    for seed in (1, 3, 6, 8):
        check_against_the_referee(seed, tolerance=5e-5)


def walls(gap: float) -> World:
    """Two walls along x, `gap` beside the chair on its left, more on its right."""
    left, right = 0.335 + gap, -0.335 - abs(2 * gap)
    return World(
        (
            Solid.polygon([[-5, left], [9, left], [9, left + 1], [-5, left + 1]], name="left"),
            Solid.polygon([[-5, right - 1], [9, right - 1], [9, right], [-5, right]], name="right"),
        )
    )


@pytest.mark.parametrize("gap", [0.5, 0.02, 0.001, 1e-4, 0.0, -0.01])
@pytest.mark.parametrize("direction", [1, -1])
def test_a_body_sliding_along_a_wall_keeps_its_gap(gap: float, direction: int) -> None:
    ends = np.array([[0.0, 0, 0], [4.0, 0, 0]])[::direction]
    line = np.linspace(*ends[:, :2], 4)
    for path in (Path.from_poses(ends), Path((BezierSection(line[None], direction),))):
        assert path.directions.tolist() == [direction]
        certificate = certify(walls(gap), CHAIR, path)
        assert certificate.clearance == pytest.approx(gap, abs=EXACT)
        assert certificate.against == "left" or gap == 0.0
        assert certificate.is_clear == (gap > 0.0)


def spot(angle: float, turn: float, steps: int = 1) -> Path:
    """A turn on the spot at the origin from a heading."""
    return Path.from_poses([[0, 0, angle + turn * k / steps] for k in range(steps + 1)])


@pytest.mark.parametrize("angle", [0.0, 0.4, 2.5])
def test_turning_on_the_spot_beside_a_wall_reaches_out_with_the_corner(angle: float) -> None:
    wall = Solid.polygon([[0.9, -2], [1, -2], [1, 2], [0.9, 2]], name="wall")
    certificate = certify(World((wall,)), CHAIR, spot(angle, math.tau, 6))
    assert certificate.clearance == pytest.approx(0.9 - CORNER, abs=1e-3)
    assert certificate.clearance <= 0.9 - CORNER


def test_turning_on_the_spot_passes_the_corner_of_a_block_and_a_post_at_the_bodys_radius() -> None:
    away = 0.84 * np.array([math.cos(1.1), math.sin(1.1)])
    block = transform([*away, 1.1], [[0, 0], [0.5, -0.4], [0.9, 0], [0.5, 0.4]])
    for solid in (Solid.polygon(block), Solid.circle(*(away * (1 + 0.1 / 0.84)), 0.1)):
        certificate = certify(World((solid,)), CHAIR, spot(0.0, 2.0))
        assert certificate.clearance == pytest.approx(0.84 - CORNER, abs=1e-3)
        assert certificate.clearance <= 0.84 - CORNER
        # short of it the corner does not get there: the body's front passes nearer than its corner
        short = certify(World((solid,)), CHAIR, spot(0.0, 0.3))
        assert short.clearance > 0.84 - CORNER + 5e-3


def test_an_arc_keeps_its_inner_side_and_its_outer_corner_from_posts() -> None:
    radius, post = 1.2, 0.15
    arc = Path.from_poses(
        [[radius * math.sin(a), radius * (1 - math.cos(a)), a] for a in np.linspace(0, 3.0, 7)]
    )
    inner = certify(World((Solid.circle(0, radius, post),)), CHAIR, arc)
    expected = radius - 0.335 - post
    assert expected - 1e-3 <= inner.clearance <= expected + EXACT
    outer = math.hypot(0.75, radius + 0.335)
    away = outer + post + 0.03
    solid = Solid.circle(away * math.sin(1.9), radius - away * math.cos(1.9), post)
    certificate = certify(World((solid,)), CHAIR, arc)
    assert 0.03 - 1e-3 <= certificate.clearance <= 0.03 + EXACT


def test_a_body_deep_in_a_solid_is_as_deep_as_the_shortest_way_out() -> None:
    """Driven into the middle of a wide table: out is back, or up, or down, by its side."""
    table = Solid.polygon([[1, -2], [5, -2], [5, 2], [1, 2]], name="table")
    certificate = certify(World((table,)), CHAIR, Path.from_poses([[0, 0, 0], [1.5, 0, 0]]))
    assert certificate.clearance == pytest.approx(-(1.5 + 0.75 - 1), abs=1e-3)
    assert not certificate.is_clear
    assert certificate.reason == "the body cuts 1250 mm into table at (1.50, 0.00)"
    touching = certify(World((table,)), CHAIR, Path.from_poses([[0, 0, 0], [0.2501, 0, 0]]))
    assert touching.reason == "the body cuts less than 1 mm into table at (0.25, 0.00)"


def test_with_nothing_to_touch_the_clearance_is_infinite() -> None:
    path = Path.from_poses([[0, 0, 0], [1, 0, 0]])
    above = Solid.polygon([[0, -1], [1, -1], [1, 1], [0, 1]], z=(1.3, 2.0))
    for world in (World(), World((above,))):
        certificate = certify(world, CHAIR, path)
        assert certificate.clearance == math.inf
        assert certificate.is_clear
        assert certificate.reason == "there is nothing to touch"
        assert clearance_at(world, CHAIR, [[0, 0, 0]])[0][0] == math.inf


def test_each_layer_meets_the_solids_at_its_heights_only() -> None:
    """Knees go under the table; the trunk stops in front of it."""
    top = Solid.polygon([[1, -1], [2, -1], [2, 1], [1, 1]], z=(0.72, 0.76), name="top")
    under = certify(World((top,)), LAYERED, Path.from_poses([[0, 0, 0], [0.6, 0, 0]]))
    assert under.clearance == pytest.approx(1.0 - 0.6 - 0.3, abs=1e-3)
    box = Solid.polygon([[1, -1], [2, -1], [2, 1], [1, 1]], z=(0.0, 0.7), name="box")
    low = certify(World((box,)), LAYERED, Path.from_poses([[-0.4, 0, 0], [0.05, 0, 0]]))
    assert low.clearance == pytest.approx(1.0 - 0.05 - 0.9, abs=1e-3)
    both = certify(World((box, top)), LAYERED, Path.from_poses([[-0.4, 0, 0], [0.05, 0, 0]]))
    assert both.clearance == pytest.approx(low.clearance, abs=1e-3)
    assert both.against == "box"


MOVES = [0.0, 0.7, -2.2, math.pi]


@pytest.mark.parametrize("turn", MOVES)
@pytest.mark.parametrize("seed", [2, 5, 7])
def test_moving_world_and_motion_together_changes_nothing(seed: int, turn: float) -> None:
    world, vehicle, path = random_motion(seed)
    pose = np.array([3.0, -2.0, turn])
    moved = World(tuple(moved_solid(solid, lambda p: transform(pose, p)) for solid in world.solids))
    sections = moved_sections(path, lambda p: transform(pose, p), lambda rows: compose(pose, rows))
    first = certify(world, vehicle, path)
    second = certify(moved, vehicle, Path(sections))
    # the same intervals and axes; rounding may tip a tie of two axes, hence not to the last digit
    assert second.clearance == pytest.approx(first.clearance, abs=1e-6)
    assert second.attained == pytest.approx(first.attained, abs=1e-9)
    assert second.against == first.against
    np.testing.assert_allclose(second.at[1:], transform(pose, [first.at[1:]])[0], atol=1e-6)


@pytest.mark.parametrize("seed", [2, 5, 7, 11])
def test_mirroring_world_and_motion_changes_nothing(seed: int) -> None:
    world, vehicle, path = random_motion(seed)
    flip = np.array([1.0, -1.0])
    mirrored = World(tuple(moved_solid(solid, lambda p: p * flip) for solid in world.solids))
    layers = tuple(Layer(layer.polygon * flip, layer.z) for layer in vehicle.layers)
    sections = moved_sections(
        path, lambda p: p * flip, lambda rows: rows * np.array([1.0, -1.0, -1.0])
    )
    first = certify(world, vehicle, path)
    second = certify(mirrored, Vehicle(layers), Path(sections))
    assert second.clearance == pytest.approx(first.clearance, abs=1e-6)
    assert second.attained == pytest.approx(first.attained, abs=1e-9)


@pytest.mark.parametrize("seed", [3, 5, 9])
def test_driving_a_curve_the_other_way_round_changes_nothing(seed: int) -> None:
    world, vehicle, path = random_motion(seed)
    section = path.sections[0]
    assert isinstance(section, BezierSection)
    back = Path((BezierSection(section.control[::-1, ::-1], -section.direction),))
    first, second = certify(world, vehicle, path), certify(world, vehicle, back)
    assert second.clearance == pytest.approx(first.clearance, abs=1e-3)
    assert second.attained == pytest.approx(first.attained, abs=1e-3)


def moved_solid(solid: Solid, move) -> Solid:
    if solid.radius:
        x, y = move(np.array([[solid.shape.x, solid.shape.y]]))[0]
        return Solid.circle(x, y, solid.radius, z=solid.z, name=solid.name)
    corners = shapely.get_coordinates(solid.shape)[:-1]
    return Solid.polygon(move(corners), z=solid.z, name=solid.name)


def moved_sections(path: Path, move_points, move_poses) -> tuple:
    return tuple(
        BezierSection(move_points(section.control), section.direction)
        if isinstance(section, BezierSection)
        else type(section)(move_poses(section.poses))
        for section in path.sections
    )


class TestBounds:
    """What may not leave the world's bounds."""

    PATH = Path.from_poses([[0, 0, 0], [1, 0, 0]])  # the body reaches x from -0.25 to 1.75

    @pytest.mark.parametrize(
        ("bounds", "inside"),
        [((-1, -1, 2, 1), 0.25), ((-0.3, -1, 2, 1), 0.05), ((-1, -0.4, 2, 1), 0.065)],
    )
    def test_the_distance_to_them_is_proven(self, bounds: tuple, inside: float) -> None:
        certificate = certify(World(bounds=bounds), CHAIR, self.PATH)
        assert 0.0 < certificate.inside <= inside + EXACT
        assert certificate.is_clear

    def test_a_body_that_leaves_them_is_not_clear_however_much_room_there_is(self) -> None:
        certificate = certify(World(bounds=(-1, -1, 1.7, 1)), CHAIR, self.PATH)
        assert certificate.inside == pytest.approx(-0.05, abs=2e-3)
        assert certificate.clearance == math.inf
        assert not certificate.is_clear
        assert certificate.reason == "the body leaves the world's bounds by 50 mm"

    def test_touching_them_is_inside(self) -> None:
        certificate = certify(World(bounds=(-0.25, -0.335, 1.75, 0.335)), CHAIR, self.PATH)
        assert certificate.inside == pytest.approx(0.0, abs=1e-4)
        assert certificate.is_clear

    @pytest.mark.parametrize("room", [2e-3, -2e-3])
    def test_a_turn_on_the_spot_needs_the_corners_radius(self, room: float) -> None:
        size = CORNER + room
        certificate = certify(
            World(bounds=(-size, -size, size, size)), CHAIR, spot(0.1, math.tau, 6)
        )
        assert certificate.is_clear == (room > 0.0)
        assert certificate.inside <= room + EXACT

    @pytest.mark.parametrize("seed", range(8))
    def test_they_agree_with_dense_sampling(self, seed: int) -> None:
        _, vehicle, path = random_motion(seed)
        body = transform(path(np.linspace(0, path.span, 4000)), vehicle.outline).reshape(-1, 2)
        low, high = body.min(axis=0), body.max(axis=0)
        for room in (3e-3, -3e-3):
            bounds = (*(low - 0.1), float(high[0]) + room, float(high[1]) + 0.1)
            certificate = certify(World(bounds=bounds), vehicle, path)
            assert certificate.is_clear == (room > 0.0)
            assert certificate.inside <= room + EXACT


def timed(path: Path, speed: float = 0.5) -> Trajectory:
    return Trajectory(
        path, Profile(np.array([0.0, path.span / speed]), np.array([[0, speed, 0, 0]]))
    )


class TestTime:
    """Motions with times."""

    def test_the_static_certificate_of_a_trajectory_is_its_paths_and_says_when(self) -> None:
        world, vehicle, path = random_motion(5)
        first, second = (certify(world, vehicle, m) for m in (path, timed(path)))
        assert first.time is None
        assert second.time == pytest.approx(second.at[0] / 0.5, abs=1e-9)
        assert (first.clearance, first.at) == (second.clearance, second.at)

    def test_people_count_for_trajectories_and_not_for_paths(self) -> None:
        person = MovingSolid(0.25, [[0, 4, 0], [4, 2, 0]], name="someone")
        world = World(moving=(person,))
        path = Path.from_poses([[0, 0, 0], [2, 0, 0]])
        assert certify(world, CHAIR, path).clearance == math.inf
        met = certify(world, CHAIR, timed(path))
        assert met.against == "someone"
        # axle 0.5 t, person 4 - 0.5 t: the front touches when 4 - t = 1, and the deepest overlap
        # is the way out to the side, from when the centre is in the body
        assert met.attained == pytest.approx(-0.335 - 0.25, abs=1e-3)
        assert met.time >= 3.0
        short = certify(world, CHAIR, timed(Path.from_poses([[0, 0, 0], [1.5, 0, 0]])))
        assert short.attained == pytest.approx(0.0, abs=1e-3)
        assert short.time == pytest.approx(3.0, abs=0.01)

    def test_a_person_below_or_above_the_body_is_no_matter(self) -> None:
        person = MovingSolid(0.25, [[0, 1, 0]], z=(1.3, 1.8))
        path = Path.from_poses([[0, 0, 0], [2, 0, 0]])
        assert certify(World(moving=(person,)), CHAIR, timed(path)).clearance == math.inf

    def test_the_least_of_what_stands_and_what_moves_counts(self) -> None:
        wall = walls(0.05).solids[0]
        path = Path.from_poses([[0, 0, 0], [2, 0, 0]])
        for y, least, name in ((-1.0, 0.05, "left"), (-0.615, 0.03, "someone")):
            person = MovingSolid(0.25, [[0, 1, y]], name="someone")
            certificate = certify(World((wall,), moving=(person,)), CHAIR, timed(path))
            assert certificate.clearance == pytest.approx(least, abs=1e-3)
            assert certificate.against == name


@pytest.mark.parametrize("tolerance", [0.0, -1e-3, math.nan])
def test_a_tolerance_must_be_positive(tolerance: float) -> None:
    with pytest.raises(ShapeError, match="tolerance must be positive"):
        certify(World(), CHAIR, Path.from_poses([[0, 0, 0], [1, 0, 0]]), tolerance=tolerance)


def weaving(length: float, gap: float) -> tuple[World, Path]:
    """A corridor, and a chair that weaves along its left wall at a nearly even gap.

    The wall stands `gap` off the body's front left corner, which a straight drive would keep.
    """
    count = round(length / 0.5)
    x = np.linspace(0.0, length, count + 1)
    y = -0.004 + 0.004 * np.cos(math.tau * x)
    slope = np.zeros_like(x)  # the rows stand at the crests and troughs
    third = length / count / 3.0
    control = [
        [[x[k], y[k]], [x[k] + third, y[k] + slope[k]],
         [x[k + 1] - third, y[k + 1]], [x[k + 1], y[k + 1]]]
        for k in range(count)
    ]  # fmt: skip
    top = 0.335 + gap
    wall = Solid.polygon([[-2, top], [length + 2, top], [length + 2, 3], [-2, 3]])
    return World((wall,)), Path((BezierSection(np.array(control)),))


@pytest.mark.parametrize("gap", [2e-4, 5e-5])
def test_a_hairs_breadth_is_told_from_contact_below_the_tolerance(gap: float) -> None:
    certificate = certify(*weaving_beside(gap))
    assert 0.0 < certificate.clearance <= certificate.attained
    assert certificate.attained == pytest.approx(gap, abs=gap / 2)
    assert certificate.is_clear


def weaving_beside(gap: float) -> tuple[World, Vehicle, Path]:
    """The weave of two metres, its wall `gap` beyond where the body reaches by dense sampling."""
    _, path = weaving(2.0, 1.0)
    reach = transform(path(np.linspace(0.0, path.span, 40001)), CHAIR.outline)[..., 1].max()
    wall = Solid.polygon([[-2, reach + gap], [5, reach + gap], [5, 3], [-2, 3]])
    return World((wall,)), CHAIR, path


def examined(world: World, path: Path, monkeypatch: pytest.MonkeyPatch) -> int:
    """Return how many pairs of interval and piece a certificate looks at."""
    count = 0
    examine = MotionSearch._examine

    def counted(self, body, pieces, intervals, enclosure, row, piece):
        nonlocal count
        count += len(row)
        return examine(self, body, pieces, intervals, enclosure, row, piece)

    with monkeypatch.context() as patch:
        patch.setattr(MotionSearch, "_examine", counted)
        certify(world, CHAIR, path)
    return count


@pytest.mark.parametrize("gap", [0.3, 0.03, 0.003])
def test_the_work_along_a_wall_grows_with_its_length_and_no_faster(
    gap: float, monkeypatch: pytest.MonkeyPatch
) -> None:
    work = [examined(*weaving(length, gap), monkeypatch) for length in (4.0, 16.0, 64.0)]
    for shorter, longer in itertools.pairwise(work):
        assert longer <= 5 * shorter, work
    assert work[-1] <= 400 * 64, work  # pairs, 64 m: under 50 ms


def test_far_solids_are_not_looked_at(monkeypatch: pytest.MonkeyPatch) -> None:
    path = Path.from_poses([[0, 0, 0], [4, 0, 0]])
    posts = tuple(Solid.circle(x, y, 0.1) for x in range(-20, 21) for y in (-4, 3, 8, 20))
    near = examined(World((*walls(0.2).solids, *posts)), path, monkeypatch)
    assert near <= examined(walls(0.2), path, monkeypatch) + 10


class TestPoses:
    """`clearance_at`: the body standing still."""

    @pytest.mark.parametrize("seed", range(6))
    def test_it_is_shapelys_distance_where_the_body_is_free(self, seed: int) -> None:
        world, vehicle, path = random_motion(seed)
        poses = path(np.linspace(0.0, path.span, 60))
        distance, against = clearance_at(world, vehicle, poses)
        expected = np.full((len(poses), len(world.solids)), np.inf)
        for layer in vehicle.layers:
            bodies = shapely.polygons(transform(poses, layer.polygon))
            for k, solid in enumerate(world.solids):
                if solid.z[0] < layer.z[1] and layer.z[0] < solid.z[1]:
                    found = shapely.distance(bodies, solid.shape) - solid.radius
                    expected[:, k] = np.minimum(expected[:, k], found)
        free = expected.min(axis=1) > 1e-9
        np.testing.assert_allclose(distance[free], expected[free].min(axis=1), atol=1e-9)
        assert (distance[~free] <= 1e-9).all()
        names = [world.solids[k].name for k in expected.argmin(axis=1)]
        assert [a for a, f in zip(against, free, strict=True) if f] == [
            n for n, f in zip(names, free, strict=True) if f
        ]

    def test_one_pose_may_be_given_alone(self) -> None:
        distance, against = clearance_at(walls(0.1), CHAIR, [0.0, 0.0, 0.0])
        np.testing.assert_allclose(distance, [0.1], atol=EXACT)
        assert against == ("left",)
