"""Planning by what is sensed: the unknown is never driven into, and the true world judges."""

import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from narrows.clearance import certify
from narrows.errors import InputError
from narrows.interfaces import PlanStatus
from narrows.perception.ranges import LaserScan
from narrows.scene import Goal, Scene, load_scene
from narrows.se2 import wrap
from narrows.simulation.lookout import LookOptions, Lookout, averaged, averaged_frame
from narrows.simulation.sensed_plan import SensedOptions, joined, plan_sensed
from narrows.trajectory import Trajectory
from narrows.vehicle import Vehicle
from narrows.verification import verify
from narrows.world import MovingSolid, Solid, World

SCENES = Path(__file__).parents[2] / "examples" / "scenes"
CHAIR = Vehicle.rectangle(1.0, 0.6, 0.25, height=1.2)
FAST = SensedOptions(LookOptions(scans=4, side=10.0))


def box(x_from, y_from, x_to, y_to, z=(0.0, 2.5), name="wall"):
    return Solid.polygon(
        [[x_from, y_from], [x_to, y_from], [x_to, y_to], [x_from, y_to]], z=z, name=name
    )


def room(*things, x=4.0, y=3.0):
    """A closed room from (0, 0) to (x, y)."""
    walls = (
        (-0.1, -0.1, x + 0.1, 0),
        (-0.1, y, x + 0.1, y + 0.1),
        (-0.1, 0, 0, y),
        (x, 0, x + 0.1, y),
    )
    return World((*(box(*corners) for corners in walls), *things), (-0.1, -0.1, x + 0.1, y + 0.1))


def scene_of(world, start=(0.6, 1.5, 0.0), goal=(3.0, 1.5, 0.0)):
    return Scene(CHAIR, world, np.array(start), Goal(np.array(goal)), name="room")


def assert_honest(scene, outcome):
    """Every leg is clear of what was not seen to be free then, and the legs are the motion."""
    for view in outcome.views:
        if view.leg is not None:
            assert certify(view.space.exact, scene.vehicle, view.leg.path).is_clear
    if outcome.plan.status is PlanStatus.CERTIFIED:
        assert verify(scene, outcome.plan.trajectory).is_certified
        ends = [view.leg.path.goal for view in outcome.views]
        starts = [view.leg.path.start for view in outcome.views[1:]]
        apart = np.subtract(starts, ends[:-1]).reshape(-1, 3)
        apart[:, 2] = wrap(apart[:, 2])  # a leg may begin a whole turn away
        assert np.allclose(apart, 0.0, atol=1e-6)
        off = outcome.plan.path.goal - scene.goal.pose
        assert math.hypot(*off[:2]) <= scene.goal.position_tolerance


def test_what_lies_open_is_planned_at_the_first_look():
    scene = scene_of(room())
    outcome = plan_sensed(scene, FAST)
    assert outcome.plan.status is PlanStatus.CERTIFIED
    assert (len(outcome.views), outcome.replans) == (1, 0)
    assert_honest(scene, outcome)


@pytest.mark.slow
@pytest.mark.parametrize("name", ["door", "l-corridor", "flat"])
def test_a_goal_out_of_sight_is_reached_by_looking_again(name):
    scene = load_scene(SCENES / f"{name}.yaml")
    outcome = plan_sensed(scene)
    assert outcome.plan.status is PlanStatus.CERTIFIED
    assert outcome.replans >= 1
    assert outcome.views[0].into_the_unknown
    assert not outcome.views[-1].into_the_unknown
    assert_honest(scene, outcome)


@pytest.mark.slow
def test_a_door_that_is_not_visible_from_the_start_is_found_on_the_way():
    wall = (box(2.4, 0.0, 2.5, 2.0), box(2.4, 2.9, 2.5, 4.0))
    screen = box(1.2, 1.4, 2.4, 1.5, name="screen")
    scene = scene_of(room(*wall, screen, x=5.0, y=4.0), (0.6, 0.8, 0.0), (3.8, 2.4, 0.0))
    outcome = plan_sensed(scene, FAST)
    assert not outcome.views[0].space.doors
    assert any(abs(door.width - 0.9) < 0.05 for door in outcome.views[-1].space.doors)
    assert outcome.plan.status is PlanStatus.CERTIFIED
    assert_honest(scene, outcome)


def test_where_the_goal_cannot_be_seen_from_anywhere_it_says_so():
    cell = (box(2.4, 0.0, 2.5, 3.0),)
    scene = scene_of(room(*cell, x=4.5))
    outcome = plan_sensed(scene, FAST)
    assert outcome.plan.status is PlanStatus.NOT_FOUND
    assert outcome.plan.path is None
    assert "what is seen leaves no way to the goal" in outcome.plan.reason
    assert outcome.plan.reason.endswith("(after 1 view)")
    assert_honest(scene, outcome)


def test_of_a_door_that_is_seen_to_be_too_narrow_it_says_how_wide_it_is():
    wall = (box(2.4, 0.0, 2.5, 1.2), box(2.4, 1.84, 2.5, 3.0))
    wide = Vehicle.rectangle(1.0, 0.7, 0.25, height=1.2)
    scene = replace(scene_of(room(*wall, x=4.5), goal=(3.4, 1.5, 0.0)), vehicle=wide)
    reason = plan_sensed(scene, FAST).plan.reason
    assert "seen to be narrower than the chair (0.70 m): door of 0.6" in reason


def test_what_no_sensor_sees_is_touched_and_the_plan_refused():
    lasers_only = replace(FAST, look=replace(FAST.look, camera_headings=()))
    shelf = box(1.9, 0.0, 2.3, 3.0, z=(0.9, 1.1), name="shelf")
    scene = scene_of(room(shelf))
    outcome = plan_sensed(scene, lasers_only)
    assert outcome.plan.status is PlanStatus.NOT_FOUND
    assert "refused by the world as it is: the body cuts" in outcome.plan.reason
    assert "into shelf" in outcome.plan.reason
    assert "no sensor saw it" in outcome.plan.reason


def test_of_somebody_who_walked_into_the_way_it_says_that_they_moved():
    person = MovingSolid(0.25, [[0.0, 2.0, 0.4], [3.0, 2.0, 1.5]], name="guest")
    world = World(room(x=4.0).solids, (-0.1, -0.1, 4.1, 3.1), moving=(person,))
    outcome = plan_sensed(scene_of(world), replace(FAST, look=replace(FAST.look, scans=1)))
    assert outcome.plan.status is PlanStatus.NOT_FOUND
    assert "into guest" in outcome.plan.reason
    assert "it moved after the chair looked" in outcome.plan.reason


def test_the_camera_sees_what_the_lasers_pass_under():
    table = box(1.9, 1.2, 3.2, 2.6, z=(0.7, 0.75), name="table top")
    scene = scene_of(room(table, x=5.6, y=4.0), (0.6, 1.9, 0.0), (4.6, 1.9, 0.0))
    for headings in ((), (0.0,)):  # ahead alone the table's corners are out of view
        narrow = replace(FAST, look=replace(FAST.look, camera_headings=headings))
        assert "table top" in plan_sensed(scene, narrow).plan.reason
    outcome = plan_sensed(scene, FAST)
    assert outcome.plan.status is PlanStatus.CERTIFIED
    assert_honest(scene, outcome)


def test_the_same_scene_and_seed_give_the_same_motion():
    scene = scene_of(room(box(1.8, 1.2, 2.0, 1.6)))
    one, other = (plan_sensed(scene, FAST).plan for _ in range(2))
    assert one.reason == other.reason
    assert np.array_equal(one.trajectory.poses, other.trajectory.poses)


def test_a_look_knows_only_what_lies_in_sight():
    screen = box(2.0, 1.0, 2.1, 2.0, name="screen")
    scene = scene_of(room(screen))
    lookout = Lookout(scene, FAST.look)
    space = lookout.look(0.0)
    rows, columns = (
        ((np.array([1.5, 1.5]) - space.corner[1]) // space.cell).astype(int),
        ((np.array([1.0, 3.0]) - space.corner[0]) // space.cell).astype(int),
    )
    assert list(space.known[rows, columns]) == [True, False]
    assert space.leads_to(np.array([1.2, 1.5, 0.0]))
    assert not space.leads_to(np.array([3.0, 1.5, 0.0]))  # behind the screen
    assert not space.leads_to(np.array([50.0, 1.5, 0.0]))  # off the map


def test_an_average_scan_is_what_most_readings_say():
    def scan(*ranges):
        return LaserScan(ranges, 0.0, 0.1)

    found = averaged(
        [
            scan(1.0, np.inf, np.nan, 2.0),
            scan(1.2, np.inf, np.nan, np.nan),
            scan(1.1, 3.0, 1.0, 2.2),
        ]
    )
    assert found.ranges[:2] == pytest.approx([1.1, np.inf])
    assert np.isnan(found.ranges[2])
    assert found.ranges[3] == pytest.approx(2.1)


def test_an_average_frame_has_a_depth_where_most_frames_have_one():
    frames = [
        np.array([[1000, 0, 0]], np.uint16),
        np.array([[1003, 800, 0]], np.uint16),
        np.array([[1003, 802, 700]], np.uint16),
    ]
    assert averaged_frame(frames) == pytest.approx(np.array([[1.002, 0.801, 0.0]]), abs=1e-6)


def test_joined_legs_are_one_motion_with_rests_between():
    one = Trajectory.from_samples([0.0, 1.0, 2.0], [[0, 0, 0], [0.5, 0, 0], [1, 0, 0]])
    other = Trajectory.from_samples([0.0, 2.0], [[1, 0, 0], [0.4, 0, 0]])
    whole = joined([one, other], 0.5)
    assert whole.duration == pytest.approx(4.5)
    assert whole(np.array([2.0, 2.3, 2.5, 4.5]))[:, 0] == pytest.approx([1.0, 1.0, 1.0, 0.4])
    assert whole.path.direction_changes == 1


def test_options_without_a_look_are_refused():
    with pytest.raises(InputError, match="no look"):
        SensedOptions(views=0)
    with pytest.raises(InputError, match="no look"):
        LookOptions(scans=0)
    with pytest.raises(InputError, match="no rate"):
        LookOptions(rate=0.0)
