"""A plan carries a path when it is certified, and only then."""

import numpy as np
import pytest

from narrows.clearance import Certificate, certify
from narrows.errors import NarrowsError, PlanningFailed, ShapeError
from narrows.interfaces import Plan, PlanStatus
from narrows.path import Path
from narrows.profile import Profile
from narrows.trajectory import Trajectory
from narrows.vehicle import Vehicle
from narrows.world import Solid, World

PATH = Path.from_poses([[0, 0, 0], [1, 0, 0]])
TRAJECTORY = Trajectory(PATH, Profile(np.array([0.0, 2.0]), np.array([[0, 0.5, 0, 0]])))
CHAIR = Vehicle.rectangle(1.0, 0.67, 0.25)


def certificate(wall_at: float) -> Certificate:
    wall = Solid.polygon([[wall_at, -1], [wall_at + 1, -1], [wall_at + 1, 1], [wall_at, 1]])
    return certify(World((wall,)), CHAIR, PATH)


def test_a_certified_plan_carries_all_three_and_is_returned_by_raise_for_status() -> None:
    plan = Plan(PlanStatus.CERTIFIED, "test", "", PATH, TRAJECTORY, certificate(2.0))
    assert plan.raise_for_status() is plan
    assert plan.statistics == {}


@pytest.mark.parametrize("status", [PlanStatus.IMPASSABLE, PlanStatus.NOT_FOUND])
def test_the_other_outcomes_raise_with_status_and_reason(status: PlanStatus) -> None:
    plan = Plan(status, "test", "20 mm are missing")
    with pytest.raises(PlanningFailed, match=f"^{status.value}: 20 mm are missing$") as caught:
        plan.raise_for_status()
    assert isinstance(caught.value, NarrowsError)


@pytest.mark.parametrize("status", [PlanStatus.IMPASSABLE, PlanStatus.NOT_FOUND])
@pytest.mark.parametrize("part", range(3))
def test_a_plan_that_is_not_certified_may_carry_nothing_to_drive(
    status: PlanStatus, part: int
) -> None:
    parts = [None, None, None]
    parts[part] = (PATH, TRAJECTORY, certificate(2.0))[part]
    with pytest.raises(ShapeError, match="a certified plan carries"):
        Plan(status, "test", "", *parts)


@pytest.mark.parametrize("missing", range(3))
def test_a_certified_plan_may_lack_none(missing: int) -> None:
    parts = [PATH, TRAJECTORY, certificate(2.0)]
    parts[missing] = None
    with pytest.raises(ShapeError, match="a certified plan carries"):
        Plan(PlanStatus.CERTIFIED, "test", "", *parts)


@pytest.mark.parametrize("wall_at", [1.75, 1.2])
def test_contact_cannot_be_called_certified(wall_at: float) -> None:
    with pytest.raises(ShapeError, match="not clear cannot be certified"):
        Plan(PlanStatus.CERTIFIED, "test", "", PATH, TRAJECTORY, certificate(wall_at))


def test_leaving_the_bounds_cannot_be_called_certified() -> None:
    outside = certify(World(bounds=(-1, -1, 1, 1)), CHAIR, PATH)
    with pytest.raises(ShapeError, match="not clear cannot be certified"):
        Plan(PlanStatus.CERTIFIED, "test", "", PATH, TRAJECTORY, outside)


def test_the_words_of_the_outcomes_are_those_of_the_command_line() -> None:
    assert [s.value for s in PlanStatus] == ["certified", "impassable", "not_found"]
