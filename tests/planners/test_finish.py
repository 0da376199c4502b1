"""Nothing becomes a plan that is not at its ends, clear, drivable, and out of people's way."""

import math
from dataclasses import replace

import numpy as np
import pytest

from narrows.bezier_section import BezierSection
from narrows.interfaces import Plan, PlanStatus
from narrows.limit_check import check_limits
from narrows.path import Path
from narrows.planners import finish
from narrows.planners.finish import CERTIFICATE_TOLERANCE, ends_problem, finished_plan
from narrows.planners.timing import Timed, time_path, timed_path
from narrows.scene import Goal, Scene
from narrows.vehicle import Limits, Vehicle
from narrows.world import MovingSolid, Solid, World

CHAIR = Vehicle.rectangle(1.0, 0.67, 0.25, limits=Limits(curvature=2.5))
WALL = Solid.polygon([[-1, 0.385], [4, 0.385], [4, 1], [-1, 1]], name="wall")  # 50 mm beside
LINE = Path.from_poses([[0, 0, 0], [2, 0, 0]])


def scene(**changes) -> Scene:
    """Straight on beside a wall."""
    given = Scene(CHAIR, World((WALL,)), np.zeros(3), Goal(np.array([2.0, 0, 0])), 0.02)
    return replace(given, **changes)


def finished(given: Scene, path: Path = LINE) -> Plan:
    return finished_plan(given, path, planner="test", statistics={"cost": 1.0}, note="by hand")


def refused(given: Scene, path: Path = LINE) -> str:
    """Return why nothing came of it."""
    plan = finished(given, path)
    assert plan.status is PlanStatus.NOT_FOUND
    assert plan.path is plan.trajectory is plan.certificate is None
    assert plan.planner == "test"
    assert plan.statistics["cost"] == 1.0
    return plan.reason


def test_a_good_path_becomes_a_certified_plan_that_says_how_clear_it_is() -> None:
    plan = finished(scene())
    assert plan.status is PlanStatus.CERTIFIED
    assert plan.path is LINE
    assert plan.reason.startswith("clear by 50.0 mm, least against wall at ")
    assert plan.reason.endswith("; by hand")
    assert plan.certificate is not None
    assert 0.05 - CERTIFICATE_TOLERANCE <= plan.certificate.clearance <= 0.05 + 1e-12
    assert plan.trajectory is not None
    assert plan.trajectory.duration > 2.0
    assert plan.statistics["cost"] == 1.0


@pytest.mark.parametrize(
    ("start", "text"),
    [
        ([0.002, 0, 0], "starts 2.0 mm and 0.0000 rad off the start"),
        ([0, 0, 0.01], "starts 0.0 mm and 0.0100 rad off the start"),
    ],
)
def test_a_wrong_start_is_refused(start, text) -> None:
    assert text in refused(scene(start=np.array(start)))


@pytest.mark.parametrize(
    ("goal", "text"),
    [
        ([2.04, 0.04, 0], "ends 56.6 mm and 0.0000 rad off the goal"),
        ([2, 0, -0.1], "ends 0.0 mm and 0.1000 rad off the goal"),
    ],
)
def test_a_wrong_goal_is_refused(goal, text) -> None:
    assert text in refused(scene(goal=Goal(np.array(goal))))


def test_the_goals_whole_tolerance_counts_and_headings_are_compared_as_angles() -> None:
    assert ends_problem(scene(goal=Goal(np.array([2.05, 0, math.radians(3)]))), LINE) == ""
    assert ends_problem(scene(goal=Goal(np.array([2.0, 0, 2 * math.pi]))), LINE) == ""
    assert ends_problem(scene(start=np.array([0, 0, -2 * math.pi])), LINE) == ""


def test_contact_is_refused_with_the_place_and_the_depth() -> None:
    post = Solid.circle(1.5, -0.3, 0.1, name="post")
    reason = refused(scene(world=World((post,))))
    assert reason.startswith("the best path found is not clear: the body cuts 135 mm into post at ")


def test_touching_is_contact() -> None:
    touching = Solid.polygon([[-1, 0.335], [4, 0.335], [4, 1], [-1, 1]], name="wall")
    assert "not clear" in refused(scene(world=World((touching,))))


def test_leaving_the_bounds_is_refused() -> None:
    reason = refused(scene(world=World(bounds=(-1, -1, 2.5, 1))))
    assert reason == (
        "the best path found is not clear: the body leaves the world's bounds by 250 mm"
    )


def test_a_bend_beyond_the_chairs_is_refused() -> None:
    curve = np.array([[[0, 0], [1.6, 0], [1.6, 0.1], [1.6, 1.0]]])
    path = Path((BezierSection(curve),))
    bent = scene(world=World(), goal=Goal(path.goal))
    assert path.max_curvature > 2.5
    assert "curvature" in refused(bent, path)
    agile = replace(CHAIR, limits=Limits(curvature=math.inf))
    assert finished(replace(bent, vehicle=agile), path).status is PlanStatus.CERTIFIED


def test_a_timing_that_breaks_a_limit_is_refused_whoever_made_it(monkeypatch) -> None:
    """The check has the last word: here the timing was made for a faster chair."""
    fast = replace(CHAIR, limits=Limits(speed=2.0, curvature=2.5))

    def careless(path: Path, vehicle: Vehicle) -> Timed:
        trajectory = time_path(path, fast)
        return Timed(trajectory, check_limits(trajectory, vehicle))

    monkeypatch.setattr(finish, "timed_path", careless)
    reason = refused(scene())
    assert reason.startswith("the path found breaks a limit: ")
    assert "speed reaches" in reason


def test_a_turn_on_the_spot_is_refused_where_the_chair_has_a_least_radius() -> None:
    path = Path.from_poses([[0, 0, 0], [1, 0, 0], [1, 0, 1.5]])
    turning = scene(world=World(), goal=Goal(path.goal))
    assert "on the spot" in refused(turning, path)


def test_reversing_is_refused_where_the_chair_does_not() -> None:
    path = Path.from_poses([[0, 0, 0], [-1, 0, 0]])
    back = scene(world=World(), goal=Goal(path.goal))
    assert finished(back, path).status is PlanStatus.CERTIFIED
    forward = replace(CHAIR, limits=Limits(curvature=2.5, reverse_speed=0.0))
    reason = refused(replace(back, vehicle=forward), path)
    assert "revers" in reason


def test_a_margin_that_is_not_kept_is_said_and_still_certified() -> None:
    plan = finished(scene(margin=0.06))
    assert plan.status is PlanStatus.CERTIFIED
    assert "; the margin of 60 mm asked for is not kept; by hand" in plan.reason
    assert "margin" not in finished(scene(margin=0.05)).reason


class TestPeople:
    """Who moves is met at the time the chair gets there."""

    @staticmethod
    def in_the_way(leaves_at: float) -> Scene:
        """Somebody stands at the end of the way and steps aside within a second."""
        path = [[leaves_at, 2.2, 0.0], [leaves_at + 1.0, 2.2, -3.0]]
        person = MovingSolid(0.25, path, name="somebody")
        return scene(world=World((WALL,), moving=(person,)))

    def test_one_who_steps_aside_in_time_is_no_hindrance(self) -> None:
        plan = finished(self.in_the_way(0.5))
        assert plan.status is PlanStatus.CERTIFIED
        assert plan.certificate is not None
        assert plan.certificate.time is not None

    def test_one_who_does_not_is(self) -> None:
        reason = refused(self.in_the_way(timed_path(LINE, CHAIR)[0].duration))
        assert reason.startswith("clear of what stands still, but the body cuts ")
        assert "into somebody" in reason

    def test_the_margin_counts_for_people_too(self) -> None:
        close = MovingSolid(0.25, [[0, 1.0, -0.335 - 0.25 - 0.01]], name="somebody")
        plan = finished(scene(world=World((WALL,), moving=(close,))))
        assert plan.status is PlanStatus.CERTIFIED
        assert "against somebody" in plan.reason
        assert "margin of 20 mm asked for is not kept" in plan.reason
