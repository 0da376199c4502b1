"""Rough manoeuvres: through the doors between start and goal, and splines near to given paths."""

import math

import numpy as np
import pytest

from narrows.bezier_section import BezierSection
from narrows.errors import ShapeError
from narrows.path import Path
from narrows.planners.fitting import fitted
from narrows.planners.guess import (
    curve_through,
    direction_of,
    doors_between,
    forward_guesses,
)
from narrows.planners.spline import Spline
from narrows.scene import Goal, Scene
from narrows.se2 import compose, exponential
from narrows.vehicle import Vehicle
from narrows.world import Door, World

CHAIR = Vehicle.rectangle(1.0, 0.67, 0.25)
START, GOAL = np.array([-0.6, 0.8, 0.0]), np.array([1.6, 3.5, math.pi / 2])
DOOR = Door((1.6, 1.65), 0.9, math.pi / 2)


def scene(*doors: Door, start=START, goal=GOAL) -> Scene:
    return Scene(CHAIR, World(doors=doors), np.array(start), Goal(np.array(goal)))


def test_a_curve_passes_through_its_poses_along_their_headings() -> None:
    poses = np.array([[0, 0, 0.3], [1, 0.5, 1.0], [1.2, 2.0, 2.0]])
    path = curve_through(poses)
    section = path.sections[0]
    joints = [0.0, *section.progress_at(np.arange(2), np.ones(2))]
    np.testing.assert_allclose(path(joints), poses, atol=1e-9)
    assert path.directions.tolist() == [1]


class TestDoors:
    """Which doors are on the way."""

    def test_a_door_between_start_and_goal_is_driven_through_its_own_way(self) -> None:
        assert doors_between(scene(DOOR)) == [(DOOR, math.pi / 2)]

    def test_on_the_way_back_it_is_driven_through_the_other_way_round(self) -> None:
        back = scene(DOOR, start=[1.6, 3.5, -math.pi / 2], goal=[-0.6, 0.8, math.pi])
        ((door, heading),) = doors_between(back)
        assert door is DOOR
        assert heading == pytest.approx(3 * math.pi / 2)

    def test_one_that_start_and_goal_lie_on_the_same_side_of_is_left_alone(self) -> None:
        assert doors_between(scene(DOOR, goal=[3.0, 1.0, 0.0])) == []

    def test_one_far_out_of_the_way_is_left_alone(self) -> None:
        assert doors_between(scene(Door((12.0, 1.65), 0.9, math.pi / 2))) == []

    def test_the_nearest_comes_first_and_two_are_tried(self) -> None:
        others = [Door((x, 1.65), 0.9, math.pi / 2) for x in (3.0, 0.4, 2.4)]
        found = [door for door, _ in doors_between(scene(*others, DOOR))]
        assert found[-1] is others[0]
        assert len(found) == 4
        names = [name for name, _ in forward_guesses(scene(*others, DOOR))]
        assert names == ["through the door", "through the door"]


def test_a_guess_starts_at_the_start_passes_the_doors_middle_and_ends_at_the_goal() -> None:
    ((name, path),) = forward_guesses(scene(DOOR))
    assert name == "through the door"
    np.testing.assert_allclose(path.start, START, atol=1e-9)
    np.testing.assert_allclose(path.goal, GOAL, atol=1e-9)
    poses = path(np.linspace(0, path.span, 2001))
    nearest = np.linalg.norm(poses[:, :2] - DOOR.center, axis=1).argmin()
    np.testing.assert_allclose(poses[nearest], [*DOOR.center, DOOR.heading], atol=2e-3)


def test_without_a_door_the_last_guess_goes_straight_on() -> None:
    name, path = forward_guesses(scene())[-1]
    assert name == "straight on"
    assert path.sections[0].pieces == 1
    np.testing.assert_allclose(path.goal, GOAL, atol=1e-9)


def shunt() -> Path:
    """Forward along an arc, back along another, forward: three sections."""
    poses = [START]
    for twist in ([0.8, 0, 0.5], [0.5, 0, 0.2], [-0.6, 0, 0.5], [0.9, 0, 0.4]):
        poses.append(compose(poses[-1], exponential(np.array(twist, dtype=float))))
    return Path.from_poses(poses)


def at_its_ends(path: Path) -> Scene:
    """A scene that starts and ends where a path does."""
    return scene(start=path.start, goal=path.goal)


@pytest.mark.parametrize("segments", [3, 6, 10])
def test_the_splines_hold_nodes_and_headings_and_lie_near_the_path(segments: int) -> None:
    path = shunt()
    found = fitted(path, at_its_ends(path), segments)
    assert found.directions.tolist() == [1, -1, 1]
    np.testing.assert_allclose(found.nodes, path(path.section_bounds), atol=1e-9)
    spline = Spline(segments)
    for k, control in enumerate(found.controls):
        np.testing.assert_allclose(control[[0, -1]], found.nodes[k : k + 2, :2], atol=1e-12)
        for leg, heading in (
            (control[1] - control[0], found.nodes[k, 2]),
            (control[-1] - control[-2], found.nodes[k + 1, 2]),
        ):
            along = found.directions[k] * direction_of(heading)
            assert leg @ along == pytest.approx(np.linalg.norm(leg), abs=1e-12)
            even = path.sections[k].span / (3 * segments)
            assert np.linalg.norm(leg) >= min(0.05, 0.49 * even)
        section = path.sections[k]
        points = spline.basis(np.linspace(0, 1, 200)) @ control
        track = section.evaluate(np.linspace(0, section.span, 200))[:, :2]
        assert np.linalg.norm(points - track, axis=1).max() < 0.02


def test_a_spline_is_fitted_to_itself() -> None:
    """A line at even speed is a spline already."""
    line = np.linspace([0.0, 0.0], [1.5, 0.0], 4)
    path = Path((BezierSection(line[None]),))
    found = fitted(path, at_its_ends(path), 6)
    points = Spline(6).basis(np.linspace(0, 1, 50)) @ found.controls[0]
    np.testing.assert_allclose(points[:, 1], 0.0, atol=1e-12)
    np.testing.assert_allclose(points[:, 0], np.linspace(0, 1.5, 50), atol=1e-9)


def test_nodes_take_the_scenes_ends_and_a_continuous_heading() -> None:
    """The scene's headings may be whole turns away, its goal centimetres."""
    path = shunt()
    start = path.start + np.array([0, 0, 2 * math.pi])
    goal = path.goal + np.array([0.03, -0.02, 0.04 - 4 * math.pi])
    found = fitted(path, scene(start=start, goal=goal), 6)
    np.testing.assert_allclose(found.nodes[0], start)
    np.testing.assert_allclose(found.nodes[-1, :2], goal[:2])
    expected = path(path.section_bounds)[:, 2] + 2 * math.pi
    expected[-1] += 0.04
    np.testing.assert_allclose(found.nodes[:, 2], expected, atol=1e-9)


def test_a_short_last_section_keeps_its_own_end_within_the_tolerance() -> None:
    """Its end moved aside by centimetres would bend it double."""
    path = Path.from_poses([[0, 0, 0], [2, 0, 0], [1.9, 0, 0]])
    near = path.goal + np.array([0.0, 0.03, 0.04])
    found = fitted(path, scene(start=path.start, goal=near), 8)
    np.testing.assert_allclose(found.nodes[-1], path.goal, atol=1e-12)
    curve = BezierSection(Spline(8).to_bezier(found.controls[1]), -1)
    assert Path((curve,)).max_curvature < 0.1
    far = path.goal + np.array([0.0, 0.06, 0.04])
    found = fitted(path, scene(start=path.start, goal=far), 8)
    np.testing.assert_allclose(found.nodes[-1], far, atol=1e-12)


def test_a_turn_on_the_spot_is_no_spline() -> None:
    path = Path.from_poses([[0, 0, 0], [1, 0, 0], [1, 0, 1]])
    with pytest.raises(ShapeError, match="turns on the spot"):
        fitted(path, at_its_ends(path), 6)
