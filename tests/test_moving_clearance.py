"""People in motion: closed forms, dense sampling in time, invariants."""

import math

import numpy as np
import pytest
import shapely
from hypothesis import given, settings
from hypothesis import strategies as st

from narrows import moving_clearance
from narrows.bezier_section import BezierSection
from narrows.moving_clearance import clearance_of_moving
from narrows.path import Path
from narrows.profile import Profile
from narrows.se2 import compose, exponential, transform
from narrows.trajectory import Trajectory
from narrows.vehicle import Vehicle
from narrows.world import MovingSolid

BODY = Vehicle.rectangle(1.0, 0.67, 0.25).outline
FRONT, REAR, HALF = 0.75, 0.25, 0.335  # m
TOLERANCE = 1e-3


def steady(path: Path, speed: float) -> Trajectory:
    """A path driven at one speed throughout."""
    return Trajectory(
        path, Profile(np.array([0.0, path.span / speed]), np.array([[0, speed, 0, 0]]))
    )


def ahead(speed: float, length: float = 4.0) -> Trajectory:
    """A drive along x from the origin."""
    return steady(Path.from_poses([[0, 0, 0], [length, 0, 0]]), speed)


def sampled(solid: MovingSolid, motion: Trajectory, count: int = 20001) -> float:
    """Return the least clearance over times close together, by Shapely; apart only."""
    time = np.linspace(0.0, motion.duration, count)
    bodies = shapely.polygons(transform(motion(time), BODY))
    return (
        float(shapely.distance(bodies, shapely.points(solid.position(time))).min()) - solid.radius
    )


def test_overtaking_beside_keeps_the_lateral_gap() -> None:
    person = MovingSolid(0.25, [[0, 1.5, 0.8], [10, 3.5, 0.8]])
    proven, attained, time = clearance_of_moving(person, BODY, ahead(0.5), TOLERANCE)
    gap = 0.8 - HALF - 0.25
    assert gap - TOLERANCE <= proven <= gap <= attained + 1e-12
    assert attained <= proven + TOLERANCE
    # beside the body while its rear is behind the person and its front ahead
    assert 1.5 + 0.2 * time <= 0.5 * time + FRONT + 0.03


def test_catching_up_from_behind_leaves_what_the_speeds_do_in_the_time() -> None:
    """Front at 0.5 t + 0.75, person at 3 + 0.3 t: 8 s bring the gap from 2.0 to 0.4 m."""
    person = MovingSolid(0.25, [[0, 3.0, 0], [10, 6.0, 0]])
    proven, attained, time = clearance_of_moving(person, BODY, ahead(0.5), TOLERANCE)
    gap = 3.0 + 0.3 * 8 - (0.5 * 8 + FRONT) - 0.25
    assert gap == pytest.approx(0.4)
    assert gap - TOLERANCE <= proven <= gap
    assert gap <= attained <= gap + TOLERANCE
    assert time == pytest.approx(8.0, abs=0.02)


def test_crossing_behind_the_chair_passes_its_rear_corner_by_the_closed_form() -> None:
    """Relative motion is a line: its distance from the rear left corner, less the radius."""
    start, velocity = np.array([-0.2, 1.6]), np.array([0.0, -0.8])
    person = MovingSolid(0.2, [[0, *start], [4, *(start + 4 * velocity)]])
    motion = ahead(0.4, 1.6)
    relative = velocity - np.array([0.4, 0.0])
    offset = start - np.array([-REAR, HALF])
    gap = abs(relative[0] * offset[1] - relative[1] * offset[0]) / np.linalg.norm(relative) - 0.2
    proven, attained, time = clearance_of_moving(person, BODY, motion, TOLERANCE)
    nearest = -float(offset @ relative) / float(relative @ relative)
    assert 0.1 < gap < 0.6
    assert gap - TOLERANCE <= proven <= gap + 1e-12
    assert gap - 1e-12 <= attained <= gap + TOLERANCE
    assert time == pytest.approx(nearest, abs=0.1)


def test_someone_who_steps_into_the_way_is_hit() -> None:
    person = MovingSolid(0.25, [[0, 2.0, 2.0], [3, 2.0, 0.0]])
    proven, attained, _ = clearance_of_moving(person, BODY, ahead(0.5), TOLERANCE)
    assert proven <= attained < -0.2


def test_one_who_stands_still_is_a_post() -> None:
    person = MovingSolid(0.3, [[0, 2.0, 1.0]])
    proven, attained, _ = clearance_of_moving(person, BODY, ahead(0.5), TOLERANCE)
    gap = 1.0 - HALF - 0.3
    assert attained == pytest.approx(gap, abs=1e-9)
    assert gap - TOLERANCE <= proven <= gap


def test_before_its_first_row_and_after_its_last_it_stands_there() -> None:
    late = MovingSolid(0.25, [[100, 1.5, 0.7], [101, 1.5, 9.0]])
    early = MovingSolid(0.25, [[-5, 1.5, 9.0], [-4, 1.5, 0.7]])
    for person in (late, early):
        proven, attained, _ = clearance_of_moving(person, BODY, ahead(0.5), TOLERANCE)
        gap = 0.7 - HALF - 0.25
        assert attained == pytest.approx(gap, abs=1e-9)
        assert gap - TOLERANCE <= proven <= gap


def test_a_dash_between_two_rows_is_not_overlooked() -> None:
    """In front of the chair and back within 20 ms, between any two samples a tenth apart."""
    away, near = [2.0, 5.0], [2.0, 0.7]
    person = MovingSolid(
        0.25, [[0, *away], [2.03, *away], [2.04, *near], [2.05, *away], [9, *away]]
    )
    motion = ahead(0.5)
    gap = 0.7 - HALF - 0.25  # at 2.04 s the body reaches from 0.77 to 1.77 m: the corner is nearest
    corner = math.hypot(2.0 - (0.5 * 2.04 + FRONT), 0.7 - HALF) - 0.25
    proven, attained, time = clearance_of_moving(person, BODY, motion, TOLERANCE)
    assert corner > gap
    assert corner - TOLERANCE <= proven <= corner
    assert attained <= corner + TOLERANCE
    assert time == pytest.approx(2.04, abs=1e-3)


def test_a_swing_of_the_corner_between_two_rows_of_time_is_not_overlooked() -> None:
    """The motion's own pieces cut time too: here it bends away and back within 40 ms."""
    turns = [(0.976, 0.0, 0.0), (0.01, 0.0, 0.5), (0.01, 0.0, -0.5), (0.5, 0.0, 0.0)]
    poses = [np.zeros(3)]
    for twist in turns:
        poses.append(compose(poses[-1], exponential(np.array(twist))))
    motion = steady(Path.from_poses(poses), 0.5)
    corner = transform(poses[2], [[FRONT, HALF]])[0]  # furthest to the left at the bend's middle
    person = MovingSolid(0.25, [[0, corner[0], corner[1] + 0.25 + 0.05]])
    proven, attained, time = clearance_of_moving(person, BODY, motion, TOLERANCE)
    assert proven <= 0.05 + 1e-12
    assert attained == pytest.approx(0.05, abs=2 * TOLERANCE)
    assert time == pytest.approx((0.976 + 0.01) / 0.5, abs=0.01)


def random_drive(rng: np.random.Generator) -> Trajectory:
    """Curves, arcs, shunts and turns on the spot, the speed changing along the way."""
    if rng.random() < 0.5:
        control = np.cumsum(rng.uniform(0.2, 0.5, (4, 2)) * [[1.0, 0.6]], axis=0)
        bends = rng.choice([-1, 1]) * control[:, 1]
        path = Path((BezierSection(np.column_stack([control[:, 0], bends])[None]),))
    else:
        poses = [np.append(rng.normal(scale=0.2, size=2), rng.uniform(-3, 3))]
        for _ in range(rng.integers(1, 6)):
            kind = rng.integers(3)
            forward = 0.0 if kind == 0 else rng.choice([-1, 1]) * rng.uniform(0.2, 0.8)
            turn = 0.0 if kind == 1 else rng.choice([-1, 1]) * rng.uniform(0.2, 1.5)
            poses.append(compose(poses[-1], exponential(np.array([forward, 0.0, turn]))))
        path = Path.from_poses(poses)
    # from rest to rest in two cubics that meet at half the way, at full speed
    half, span = rng.uniform(1.0, 4.0), path.span
    first = [0.0, 0.0, 1.5 * span / half**2 / 2, -0.5 * span / half**3 / 2]
    speed, bend = 1.5 * span / 2 / half, 0.0
    last = [span / 2, speed, bend, -speed / (3 * half**2)]
    last[3] = (span / 2 - speed * half) / half**3
    return Trajectory(path, Profile(np.array([0.0, half, 2 * half]), np.array([first, last])))


def random_person(rng: np.random.Generator) -> MovingSolid:
    times = np.cumsum(rng.uniform(0.3, 2.0, rng.integers(1, 5)))
    way = rng.normal(scale=1.5, size=(len(times), 2)) + rng.normal(scale=1.0, size=2)
    return MovingSolid(rng.uniform(0.1, 0.4), np.column_stack([times, way]))


def check_against_sampling(seed: int) -> bool:
    """Check one random meeting; return whether it was without contact."""
    rng = np.random.default_rng(seed)
    motion, person = random_drive(rng), random_person(rng)
    proven, attained, time = clearance_of_moving(person, BODY, motion, TOLERANCE)
    dense = sampled(person, motion, 4001)
    assert attained - TOLERANCE - 1e-12 <= proven <= attained
    if dense <= -person.radius + 1e-9:  # the centre is in the body: Shapely has no depth
        assert proven < 0.0
        return False
    assert proven <= dense + 1e-9, seed
    # a pose of the motion: between two samples nothing is nearer by more than it moves there
    step = motion.duration / 4000
    speed = float(np.abs(motion(np.linspace(0, motion.duration, 2001), 1)).sum(axis=1).max())
    slack = 0.5 * step * (1.1 * speed + person.speed)
    assert attained >= dense - slack, seed
    assert proven >= dense - slack - TOLERANCE, seed
    here = shapely.distance(
        shapely.Polygon(transform(motion(time), BODY)), shapely.Point(person.position(time))
    )
    assert attained == pytest.approx(here - person.radius, abs=1e-6)
    return proven > 0.0


def test_it_is_never_above_dense_sampling_in_time_and_within_a_millimetre() -> None:
    clear = [check_against_sampling(seed) for seed in range(40)]
    assert 10 <= sum(clear) <= 38


@pytest.mark.slow
def test_many_random_meetings_agree_with_sampling() -> None:
    for seed in range(1000, 1150):
        check_against_sampling(seed)


@given(st.integers(0, 2**32 - 1), st.floats(-math.pi, math.pi))
@settings(deadline=None, max_examples=10, derandomize=True)
def test_moving_chair_and_person_together_changes_nothing(seed: int, turn: float) -> None:
    rng = np.random.default_rng(seed)
    poses = np.array([[0, 0, 0.3], [0.6, 0.2, 0.4], [1.2, 0.6, 0.8]])
    person, pose = random_person(rng), np.array([3.0, -1.0, turn])
    moved = MovingSolid(
        person.radius, np.column_stack([person.path[:, 0], transform(pose, person.path[:, 1:])])
    )
    first = clearance_of_moving(person, BODY, steady(Path.from_poses(poses), 0.5), TOLERANCE)
    second = clearance_of_moving(
        moved, BODY, steady(Path.from_poses(compose(pose, poses)), 0.5), TOLERANCE
    )
    np.testing.assert_allclose(second[:2], first[:2], atol=1e-6)


def test_the_work_of_a_long_walk_side_by_side_stays_in_bounds(monkeypatch) -> None:
    """A person walks along 30 mm beside the chair for 40 m."""
    looked = 0
    separation = moving_clearance.separation

    def counted(first, second):
        nonlocal looked
        looked += len(first)
        return separation(first, second)

    monkeypatch.setattr(moving_clearance, "separation", counted)
    person = MovingSolid(0.25, [[0, 0.0, HALF + 0.28], [80, 40.0, HALF + 0.28]])
    proven, _, _ = clearance_of_moving(person, BODY, ahead(0.5, 40.0), TOLERANCE)
    assert 0.029 <= proven <= 0.03 + 1e-12
    assert looked <= 80 / 0.1 * 20  # first steps of 0.1 s, few of them halved more than four times
