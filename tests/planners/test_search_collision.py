"""The compiled sweep says clear only where the certificate does, and refuses only near contact."""

import math

import numpy as np
import pytest

from narrows.clearance import certify, clearance_at
from narrows.path import Path
from narrows.scene import Goal, Scene
from narrows.se2 import exponential
from narrows.vehicle import Limits, Vehicle
from narrows.world import Solid, World

FLOOR, CARE = 1e-3, 0.1


@pytest.fixture(scope="module")
def ground():
    from narrows.planners.search_options import SearchOptions
    from narrows.planners.search_rung import Ground

    world = World(
        (
            Solid.polygon([[1.2, -0.3], [1.6, -0.5], [1.5, 0.4]], name="wedge"),
            Solid.circle(-0.7, 0.6, 0.15, name="post"),
            Solid.polygon([[-2, -1.2], [2, -1.2], [2, -1.0], [-2, -1.0]], name="wall"),
        )
    )
    scene = Scene(
        Vehicle.rectangle(1.0, 0.7, 0.25), world, np.zeros(3), Goal(np.array([0.1, 0, 0]))
    )
    return Ground(scene, SearchOptions())


def drives(count):
    rng = np.random.default_rng(3)
    for _ in range(count):
        pose = rng.uniform([-0.9, -0.5, -np.pi], [0.9, 0.7, np.pi])
        v = rng.choice([-1.0, 0.0, 1.0])
        omega = rng.choice([-1.0, 1.0]) if v == 0.0 else rng.uniform(-2.5, 2.5)
        yield pose, v, omega, rng.uniform(0.02, 0.2)


def test_what_is_called_clear_is_certified_clear_and_what_is_refused_is_near_contact(ground):
    from narrows.planners.search_collision import advance, clearance_along

    outline = np.empty((4, 4))
    verdicts = []
    for pose, v, omega, length in drives(400):
        gap = clearance_along(ground.solids, *pose, v, omega, length, FLOOR, CARE, outline)
        end = advance(*pose, v, omega, length)
        path = Path.from_poses([pose, end])
        if gap >= 0.0:
            certificate = certify(ground.scene.world, ground.scene.vehicle, path, tolerance=1e-4)
            assert certificate.clearance >= 0.5 * FLOOR - 1e-4
            # The gaps met are attained, so none is below the least there is.
            assert gap >= min(certificate.clearance, CARE) - 1e-9
        else:
            poses = path(np.linspace(0.0, path.span, 400))
            distance, _ = clearance_at(ground.scene.world, ground.scene.vehicle, poses)
            assert distance.min() < FLOOR + 1e-4  # 0.2 m / 400 = 0.5 mm steps near a minimum
        verdicts.append(gap >= 0.0)
    assert 50 < sum(verdicts) < 350  # both verdicts were tried


def test_gaps_at_poses_equal_the_clearance_of_the_other_implementation(ground):
    from narrows.planners.search_collision import clearance_along

    outline = np.empty((4, 4))
    for pose, *_ in drives(200):
        expected = clearance_at(ground.scene.world, ground.scene.vehicle, [pose])[0][0]
        gap = clearance_along(ground.solids, *pose, 1.0, 0.0, 0.0, FLOOR, CARE, outline)
        if expected < FLOOR - 1e-9:
            assert gap == -1.0
        else:
            assert gap == pytest.approx(min(expected, CARE), abs=1e-9)


def test_a_pose_outside_the_region_is_refused(ground):
    from narrows.planners.search_collision import clearance_along

    far = clearance_along(
        ground.solids, 99.0, 0.0, 0.0, 1.0, 0.0, 0.1, FLOOR, CARE, np.empty((4, 4))
    )
    assert far == -1.0


@pytest.mark.parametrize("v", [-1.0, 1.0])
@pytest.mark.parametrize("omega", [-2.5, 0.0, 1e-12, 0.7])
def test_moves_follow_the_exponential_of_their_twist(v, omega):
    from narrows.planners.search_collision import advance

    expected = exponential([v * 0.3, 0.0, omega * 0.3])
    assert advance(0.0, 0.0, 0.0, v, omega, 0.3) == pytest.approx(expected, abs=1e-10)


def test_a_turn_on_the_spot_keeps_the_place():
    from narrows.planners.search_collision import advance

    assert advance(1.0, 2.0, 0.5, 0.0, -1.0, 0.2) == pytest.approx((1.0, 2.0, 0.3), abs=1e-15)


@pytest.mark.parametrize("v", [-1.0, 1.0])
@pytest.mark.parametrize("radius", [0.0, 0.4])
def test_connections_end_at_their_goal(v, radius):
    from narrows.planners.search_collision import advance
    from narrows.planners.search_curves import LONGEST_TURN, arc_line_arc

    rng = np.random.default_rng(5)
    parts, found = np.empty((3, 3)), 0
    for _ in range(50):
        start, goal = rng.uniform(-2, 2, 3), rng.uniform(-2, 2, 3)
        for word in range(4):
            length = arc_line_arc(*start, goal, v, radius, word, parts)
            if length == math.inf:
                continue
            found += 1
            pose = tuple(start)
            for drive in parts:
                pose = advance(*pose, *drive)
            assert pose[:2] == pytest.approx(goal[:2], abs=1e-9)
            # An arc of less than 1e-7 rad short of a whole turn is left out.
            assert math.remainder(pose[2] - goal[2], 2 * math.pi) == pytest.approx(0.0, abs=2e-7)
            turns = parts[[0, 2], 2] / (radius if radius else 1.0)
            assert turns.max() <= LONGEST_TURN + 1e-9
            assert length == pytest.approx(parts[:, 2].sum())
    assert found > 60


def test_a_scene_in_millimetres_taken_for_metres_does_not_fill_the_memory():
    """A chair of a kilometre in a hall of ten: cells grow instead of their number."""
    from narrows.planners.search_terrain import Terrain

    wall = Solid.polygon([[2000, -3000], [2100, -3000], [2100, -400], [2000, -400]])
    chair = Vehicle.rectangle(1000, 600, 200, limits=Limits(curvature=2.5))
    goal = Goal(np.array([4000.0, 0, 0]))
    ground = Terrain(Scene(chair, World((wall,)), np.zeros(3), goal), 0.2, 0.1)
    assert ground.solids.first.nbytes + ground.solids.candidates.nbytes < 2e7
    assert ground.to_goal is not None
