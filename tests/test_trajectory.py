"""Trajectories: derivatives by time, rows fine enough and exact where it matters, round trips."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from narrows.bezier_section import BezierSection
from narrows.errors import ShapeError
from narrows.limit_check import check_limits
from narrows.path import Path
from narrows.planners.timing import time_path
from narrows.profile import Profile
from narrows.se2 import compose, exponential
from narrows.trajectory import ROW_DISTANCE, ROW_TIME, Trajectory
from narrows.vehicle import Vehicle

CHAIR = Vehicle.rectangle(1.0, 0.6, 0.3)
CURVE = np.array([[0, 0], [1.0, 0.0], [1.4, 0.8], [1.4, 2.0]])


def shunting() -> Trajectory:
    """Return a timed drive: a curve forward, an arc in reverse, a turn on the spot."""
    first = Path((BezierSection(CURVE[None]),))
    back = compose(first.goal, exponential([-0.8, 0.0, 0.5]))
    turned = back + np.array([0.0, 0.0, -1.0])
    sections = (*first.sections, *Path.from_poses([first.goal, back, turned]).sections)
    return time_path(Path(sections), CHAIR)


def inside(trajectory: Trajectory, count: int = 200) -> np.ndarray:
    """Return times away from the breaks of the profile, where the motion is smooth."""
    t = np.linspace(0.01, trajectory.duration - 0.01, count)
    return t[np.abs(t[:, None] - trajectory.profile.breaks).min(axis=1) > 1e-3]


@pytest.mark.parametrize("order", [1, 2])
def test_derivatives_agree_with_central_differences(order: int) -> None:
    trajectory, h = shunting(), 1e-5
    t = inside(trajectory)
    difference = (trajectory(t + h, order - 1) - trajectory(t - h, order - 1)) / (2 * h)
    np.testing.assert_allclose(trajectory(t, order), difference, atol=5e-5, rtol=1e-4)


def test_commands_drive_the_poses() -> None:
    trajectory = shunting()
    count = 4000
    dt = trajectory.duration / count
    commands = trajectory.command(dt * (np.arange(count) + 0.5))
    pose = trajectory.poses[0]
    for v, omega in commands:
        pose = compose(pose, exponential([v * dt, 0.0, omega * dt]))
    np.testing.assert_allclose(pose, trajectory.poses[-1], atol=1e-4)  # midpoint rule: dt^2


def test_a_constant_speed_on_a_circle_is_a_constant_command() -> None:
    path = Path.from_poses([[0, 0, 0], [0, 2, math.pi]])
    speed = 0.5
    profile = Profile(np.array([0.0, path.span / speed]), np.array([[0, speed, 0, 0]]))
    trajectory = Trajectory(path, profile)
    np.testing.assert_allclose(trajectory.commands, [[0.5, 0.5]] * len(trajectory.times))
    acceleration = np.linalg.norm(trajectory(np.linspace(0.1, 6.0, 9), 2)[:, :2], axis=1)
    np.testing.assert_allclose(acceleration, speed**2 / 1.0, atol=1e-12)


def test_commands_are_negative_in_reverse_and_zero_on_the_spot() -> None:
    trajectory = shunting()
    ends = trajectory.section_times
    middle = 0.5 * (ends[1:] + ends[:-1])
    v, omega = trajectory.command(middle).T
    assert np.sign(v.round(9)).tolist() == [1, -1, 0]
    assert omega[2] < 0.0


def assert_rows_are_fine(trajectory: Trajectory) -> None:
    times, poses = trajectory.times, trajectory.poses
    assert times[0] == 0.0
    assert times[-1] == pytest.approx(trajectory.duration, abs=1e-12)
    assert (np.diff(times) > 0.0).all()
    assert np.diff(times).max() <= ROW_TIME + 1e-9
    step = np.diff(poses[:, :2], axis=0)
    assert np.hypot(step[:, 0], step[:, 1]).max() <= ROW_DISTANCE + 1e-9
    # every section end is a row, and its pose is the path's own
    nearest = np.abs(trajectory.section_times[:, None] - times).min(axis=1)
    assert nearest.max() < 1e-9
    joints = trajectory.path(trajectory.path.section_bounds)
    gap = np.abs(poses[None] - joints[:, None]).max(axis=2).min(axis=1)
    assert gap.max() < 1e-9


def test_rows_are_fine_and_exact_at_direction_changes() -> None:
    assert_rows_are_fine(shunting())


@given(
    speed=st.floats(0.05, 3.0),
    legs=st.lists(
        st.tuples(st.sampled_from([-0.7, 0.4]), st.floats(-2, 2)), min_size=1, max_size=4
    ),
)
@settings(deadline=None, max_examples=40)
def test_rows_of_any_constant_speed_are_fine(speed: float, legs: list[tuple[float, float]]) -> None:
    poses = [np.zeros(3)]
    for v, turn in legs:
        poses.append(compose(poses[-1], exponential([v, 0.0, turn])))
    path = Path.from_poses(poses)
    profile = Profile(np.array([0.0, path.span / speed]), np.array([[0, speed, 0, 0]]))
    assert_rows_are_fine(Trajectory(path, profile))


def test_a_trajectory_read_from_its_rows_reproduces_them() -> None:
    trajectory = shunting()
    sampled = Trajectory.from_samples(trajectory.times, trajectory.poses)
    np.testing.assert_allclose(sampled(trajectory.times), trajectory.poses, atol=1e-9)
    kept = np.searchsorted(sampled.times, trajectory.times - 1e-9)
    np.testing.assert_allclose(sampled.times[kept], trajectory.times, atol=1e-9)
    np.testing.assert_allclose(sampled.poses[kept], trajectory.poses, atol=1e-9)
    assert sampled.duration == pytest.approx(trajectory.duration)
    assert_rows_are_fine(sampled)
    between = 0.5 * (trajectory.times[1:] + trajectory.times[:-1])
    np.testing.assert_allclose(sampled(between), trajectory(between), atol=2e-4)
    again = Trajectory.from_samples(sampled.times, sampled.poses)
    np.testing.assert_allclose(again(between), sampled(between), atol=1e-9)


def test_rests_between_rows_are_kept() -> None:
    times = [10.0, 11.0, 13.0, 14.0]
    sampled = Trajectory.from_samples(times, [[0, 0, 0], [1, 0, 0], [1, 0, 0], [1.5, 0, 0]])
    np.testing.assert_allclose(
        sampled([0.5, 1.0, 2.0, 3.0, 3.5])[:, 0], [0.5, 1.0, 1.0, 1.0, 1.25], atol=1e-12
    )
    np.testing.assert_allclose(sampled.command([0.5, 2.0, 3.5])[:, 0], [1.0, 0.0, 0.5], atol=1e-9)


def test_wrapped_headings_are_read_as_short_turns() -> None:
    sampled = Trajectory.from_samples([0, 1, 2], [[0, 0, 3.0], [0, 0, -3.0], [0, 0, 3.1]])
    omega = sampled.command([0.5, 1.5])[:, 1]
    np.testing.assert_allclose(omega, [2 * math.pi - 6.0, 6.1 - 2 * math.pi], atol=1e-9)


@pytest.mark.parametrize(
    ("times", "poses", "message"),
    [
        ([0, 1], [[0, 0, 0]], r"\(2,\), \(1, 3\)"),
        ([0, 0], [[0, 0, 0], [1, 0, 0]], "times must increase"),
        ([0, math.inf], [[0, 0, 0], [1, 0, 0]], r"\(2,\), \(2, 3\)"),
        ([0, 1], [[0, 0, 0], [0, 0, 0]], "two different poses"),
    ],
)
def test_what_is_no_trajectory_is_refused(times: list, poses: list, message: str) -> None:
    with pytest.raises(ShapeError, match=message):
        Trajectory.from_samples(times, poses)


def test_a_profile_must_cover_its_path() -> None:
    path = Path.from_poses([[0, 0, 0], [1, 0, 0]])
    with pytest.raises(ShapeError, match=r"0\.5 short of"):
        Trajectory(path, Profile(np.array([0.0, 1.0]), np.array([[0, 0.5, 0, 0]])))


def test_driving_along_the_heading_does_not_slip_and_sideways_does() -> None:
    assert shunting().slip() < 1e-6
    crab = Trajectory.from_samples([0, 1], [[0, 0, 0], [1, 0.1, 0]])
    assert crab.slip() == pytest.approx(math.atan(0.1))
    assert any("slip" in text for text in check_limits(crab, CHAIR).violations)


def test_orders_beyond_two_are_refused() -> None:
    with pytest.raises(ShapeError, match="0, 1 or 2, got 3"):
        shunting()(0.5, 3)


def test_rows_beside_a_turn_on_the_spot_have_the_commands_that_follow_them():
    """1 m straight in 1 s, 1 rad on the spot in 0.5 s, 1 m straight in 2 s."""
    far = [1.0 + np.cos(1.0), np.sin(1.0), 1.0]
    poses = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 0.0, 1.0], far]
    driven = Trajectory.from_samples([0.0, 1.0, 1.5, 3.5], poses)
    expected = [[1.0, 0.0], [0.0, 2.0], [0.5, 0.0], [0.5, 0.0]]
    assert driven.command([0.0, 1.0, 1.5, 3.5]) == pytest.approx(np.array(expected), abs=1e-9)
    assert np.abs(driven.commands).max(axis=0) == pytest.approx([1.0, 2.0], abs=1e-9)
