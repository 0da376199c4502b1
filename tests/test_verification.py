"""Judging anybody's motion: exact answers, what is refused, what is only noted."""

import numpy as np
import pytest

from narrows.errors import ShapeError, TrajectoryError
from narrows.path import Path
from narrows.planners.timing import time_path
from narrows.scene import Goal, Scene
from narrows.trajectory import Trajectory
from narrows.vehicle import Vehicle
from narrows.verification import LONGEST, verify
from narrows.world import MovingSolid, Solid, World

CHAIR = Vehicle.rectangle(1.0, 0.8, 0.2)
WALL = Solid.polygon([[3, -1], [3.1, -1], [3.1, 1], [3, 1]], name="wall")
AHEAD = Path.from_poses([[0, 0, 0], [2, 0, 0]])


def scene(world: World | None = None, vehicle: Vehicle = CHAIR, **changes: object) -> Scene:
    world = World((WALL,)) if world is None else world
    return Scene(vehicle, world, np.zeros(3), Goal(np.array([2.0, 0.0, 0.0])), **changes)


def test_a_clear_timed_drive_is_certified_without_notes():
    found = verify(scene(), time_path(AHEAD, CHAIR))
    assert found.status == "certified"
    assert found.clearance == pytest.approx(0.2, abs=1e-3)  # the certificate's tolerance
    assert found.notes == ()
    assert found.timed


def test_path_trajectory_and_poses_of_one_motion_have_one_clearance():
    motions = [AHEAD, time_path(AHEAD, CHAIR), [[0, 0, 0], [0.7, 0, 0], [2, 0, 0]]]
    for motion in motions:
        assert verify(scene(), motion).clearance == pytest.approx(0.2, abs=1e-3)


def test_contact_between_rows_is_refused():
    post = Solid.polygon([[1.4, 0.3], [1.5, 0.3], [1.5, 0.5], [1.4, 0.5]], name="post")
    found = verify(scene(World((post,))), [[-2, 0, 0], [4, 0, 0]])
    assert found.status == "refused"
    assert found.clearance == pytest.approx(-0.1, abs=1e-3)
    assert "cuts 100 mm into post" in found.reason


def test_leaving_the_bounds_is_refused():
    found = verify(scene(World((), bounds=(-1.0, -1.0, 2.5, 1.0))), AHEAD)
    assert not found.is_certified
    assert "leaves the world's bounds by 300 mm" in found.reason


def test_sliding_sideways_is_refused():
    found = verify(scene(), [[0, 0, 0], [1, 0.1, 0]])
    assert found.problems == ("slip reaches 0.0997 rad, the limit is 0.0175",)


def test_limits_are_kept_exactly_at_the_limit_and_broken_beyond():
    quarter = [[np.sin(a), 1 - np.cos(a), a] for a in np.linspace(0, np.pi / 2, 9)]
    free = World()
    assert verify(scene(free, CHAIR.with_limits(curvature=1.0)), quarter).is_certified
    found = verify(scene(free, CHAIR.with_limits(curvature=0.9)), quarter)
    assert found.problems == ("curvature reaches 1 1/m, the limit is 0.9",)


def test_times_bring_the_speed_limits():
    rows = [[0, 0, 0], [2, 0, 0]]
    slow = Trajectory.from_samples([0.0, 4.0], rows)
    fast = Trajectory.from_samples([0.0, 2.0], rows)
    assert verify(scene(), slow).is_certified
    assert "speed reaches 1 m/s, the limit is 0.8" in verify(scene(), fast).problems
    assert verify(scene(), rows).is_certified


def test_a_chair_that_only_drives_forward_is_not_driven_in_reverse():
    back = [[2, 0, 0], [0, 0, 0]]
    forward_only = CHAIR.with_limits(reverse_speed=0.0)
    assert verify(scene(), back).is_certified
    problems = verify(scene(vehicle=forward_only), back).problems
    assert problems == ("it drives in reverse, which the chair does not",)


def test_turning_on_the_spot_needs_unlimited_curvature():
    turn = [[0, 0, 0], [0, 0, 1]]
    assert verify(scene(World()), turn).is_certified
    assert "on the spot" in verify(scene(World(), CHAIR.with_limits(curvature=2.0)), turn).reason


def test_other_ends_and_a_thin_margin_are_notes_not_problems():
    found = verify(scene(margin=0.3), [[-1, 0, 0], [2, 0, 0], [2, 0, 0.1]])
    assert found.is_certified
    assert found.notes == (
        "the margin of 300 mm asked for is not kept",
        "it starts 1000 mm and 0.0 degrees from the scene's start",
        "it ends 0 mm and 5.7 degrees from the scene's goal",
    )


def test_a_person_is_met_where_there_are_times_and_noted_where_not():
    person = MovingSolid(0.25, np.array([[0.0, 1.0, 5.0], [2.0, 1.0, -5.0]]), name="Anna")
    crossed = scene(World((), moving=(person,)))
    timed = verify(crossed, Trajectory.from_samples([0.0, 4.0], [[0, 0, 0], [2, 0, 0]]))
    assert not timed.is_clear
    assert "Anna" in timed.reason
    untimed = verify(crossed, AHEAD)
    assert untimed.is_certified
    assert untimed.notes == ("moving things were not judged, as the motion has no times",)


def test_what_is_no_motion_is_an_error():
    with pytest.raises(ShapeError, match="two different poses"):
        verify(scene(), [[0, 0, 0]])
    with pytest.raises(ShapeError, match="finite rows"):
        verify(scene(), [[0, 0, 0], [1, np.nan, 0]])
    with pytest.raises(TrajectoryError, match="too long"):
        verify(scene(), [[0, 0, 0], [LONGEST + 1.0, 0, 0]])


def test_turning_the_world_changes_nothing():
    turned = np.deg2rad(37.0)
    rotation = np.array([[np.cos(turned), -np.sin(turned)], [np.sin(turned), np.cos(turned)]])
    corners = np.array([[3, -1], [3.1, -1], [3.1, 1], [3, 1]]) @ rotation.T
    world = World((Solid.polygon(corners, name="wall"),))
    end = rotation @ [2.0, 0.0]
    found = verify(scene(world), [[0, 0, turned], [*end, turned]])
    assert found.clearance == pytest.approx(0.2, abs=1e-3)


@pytest.mark.parametrize("timed", [True, False])
def test_rows_rounded_too_coarsely_to_judge_are_named_as_the_likely_reason(timed):
    bend = Path.from_poses([[np.sin(a), 1 - np.cos(a), a] for a in np.linspace(0, 1.2, 50)])
    smooth = time_path(bend, CHAIR)
    times, rows = smooth.times, smooth.poses
    free = scene(World())
    for decimals, noted in ((3, True), (10, False)):
        motion = rows.round(decimals)
        if timed:
            motion = Trajectory.from_samples(times, motion)
        found = verify(free, motion)
        assert found.is_certified is not noted
        assert ("rounded to 0.001 m" in found.reason) is noted


def test_rows_far_apart_are_not_blamed_on_rounding():
    assert "rounded" not in verify(scene(), [[0, 0, 0], [1, 0.1, 0]]).reason
