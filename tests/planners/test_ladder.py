"""The ladder: which rung answers, what it says, and that a name is a rung."""

import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from narrows.errors import InputError
from narrows.interfaces import PlanStatus
from narrows.planners.ladder import RUNGS, plan
from narrows.scene import Goal, Scene, load_scene
from narrows.studies.doorbench_generator import doorbench_rows
from narrows.studies.doorbench_scenes import doorbench_scene
from narrows.vehicle import Limits, Vehicle
from narrows.world import Solid, World

EXAMPLES = Path(__file__).parents[2] / "examples" / "scenes"
DOORS = {row["id"]: row for row in doorbench_rows(per_level=2, seed=8)}
CHAIR = Vehicle.rectangle(1.0, 0.6, 0.25, limits=Limits(curvature=2.5, reverse_speed=0.0))


def test_an_unknown_planner_is_named_with_the_nearest_and_the_choices():
    scene = doorbench_scene(DOORS["c30_00"])
    with pytest.raises(InputError, match="did you mean 'manoeuvre'") as caught:
        plan(scene, planner="manouevre")
    assert caught.value.field == "planner"
    assert all(name in str(caught.value) for name in ("auto", *RUNGS))


def test_the_open_plain_is_crossed_straight():
    found = plan(Scene(CHAIR, World(), [0, 0, 0], Goal([3, 0, 0])))
    assert found.status is PlanStatus.CERTIFIED
    # the goal's tolerance may be used: 5 cm at most
    assert found.path.length == pytest.approx(3.0, abs=0.051)
    assert found.path.max_curvature < 1e-3
    assert found.reason == "there is nothing to touch"


def test_a_wide_door_is_settled_by_the_first_curve():
    found = plan(doorbench_scene(DOORS["c30_00"]))
    assert found.status is PlanStatus.CERTIFIED
    assert found.planner == "manoeuvre"
    assert found.statistics["starts"] == 1.0
    assert found.certificate.clearance >= 0.02 - 2e-4  # the margin, but for the proof's tolerance
    assert "margin" not in found.reason


@pytest.mark.slow
def test_a_margin_that_cannot_be_had_is_said_to_be_missing():
    """The door leaves 25 mm on either side; nearly all of it is had when 30 are asked for."""
    scene = replace(doorbench_scene(DOORS["c05_00"]), margin=0.03)
    found = plan(scene)
    assert found.status is PlanStatus.CERTIFIED, found.reason
    assert 0.02 < found.certificate.clearance <= 0.025
    assert "the margin of 30 mm asked for is not kept" in found.reason


@pytest.mark.slow
def test_a_chair_that_may_reverse_is_never_led_closer_than_one_that_may_not():
    """Where the first curve lacks some of the margin, all forward ways are tried as well."""
    row = next(r for r in doorbench_rows(8, 31337) if r["id"] == "c10_07")
    forward, reversing = (plan(doorbench_scene(row, reversing=ways)) for ways in (False, True))
    assert forward.certificate.clearance < 0.015
    assert reversing.certificate.clearance >= forward.certificate.clearance - 1e-4


@pytest.mark.slow
@pytest.mark.parametrize("name", RUNGS)
def test_a_rung_asked_for_by_name_is_the_one_that_answers(name):
    found = plan(doorbench_scene(DOORS["c30_00"]), planner=name)
    assert found.planner == name
    if found.status is PlanStatus.CERTIFIED:
        assert found.certificate.is_clear


def test_a_gap_that_keeps_the_margin_is_looked_for_where_the_first_one_does_not():
    """Straight on are 20 mm on either side, and 50 are asked for; a wider gap is a bend away."""
    rails = ((-2.0, -0.32, "right"), (0.32, 0.95, "middle"), (2.0, 3.0, "left"))
    walls = tuple(
        Solid.polygon([[1.5, low], [1.6, low], [1.6, high], [1.5, high]], name=name)
        for low, high, name in rails
    )
    world = World(walls, (-1.6, -2, 5.4, 3))
    found = plan(Scene(CHAIR, world, [-0.9, 0, 0], Goal([4.2, 0, 0]), margin=0.05))
    assert found.status is PlanStatus.CERTIFIED
    assert found.certificate.clearance >= 0.05 - 2e-4
    assert found.path(np.linspace(0.0, found.path.span, 200))[:, 1].max() > 1.2


def walled_in():
    """Return a scene whose goal is behind a wall without a door."""
    wall = Solid.polygon([[1.5, -2], [1.6, -2], [1.6, 2], [1.5, 2]], name="wall")
    return Scene(CHAIR, World((wall,), (-1, -2, 4, 2)), [0, 0, 0], Goal([3, 0, 0]))


def test_a_chair_that_stands_at_its_goal_has_nothing_to_drive():
    with pytest.raises(InputError, match="nothing to drive") as caught:
        plan(Scene(CHAIR, World(), [1, 2, 0.5], Goal([1, 2, 0.5 + 2 * math.pi])))
    assert caught.value.field == "goal"


@pytest.mark.parametrize("heading", [math.pi / 2, math.pi, -2.0])
def test_a_chair_that_may_turn_on_the_spot_turns_round_where_it_stands(heading):
    chair = Vehicle.rectangle(1.0, 0.6, 0.25, limits=Limits(reverse_speed=0.0))
    wall = Solid.polygon([(2, -2), (2.1, -2), (2.1, 2), (2, 2)])
    found = plan(Scene(chair, World((wall,)), [0, 0, 0], Goal([0, 0, heading])))
    assert found.status is PlanStatus.CERTIFIED, found.reason
    assert found.path.length < 0.05
    assert abs(math.remainder(found.path.goal[2] - heading, 2 * math.pi)) <= math.radians(3.0)


@pytest.mark.slow
def test_a_chair_that_may_turn_on_the_spot_rolls_through_rooms_all_the_same():
    found = plan(load_scene(EXAMPLES / "course.yaml"))
    assert found.status is PlanStatus.CERTIFIED, found.reason
    assert found.planner == "manoeuvre"
    assert found.certificate.clearance >= 0.02
    assert found.path.length / found.trajectory.duration > 0.5  # m/s on average: no stops


def test_a_goal_behind_a_wall_is_proven_to_be_out_of_reach():
    found = plan(walled_in())
    assert found.status is PlanStatus.IMPASSABLE
    assert found.planner == "passage"
    assert found.path is None
    assert found.statistics["solve_time_s"] > 0.0


def forward_only_dead_end():
    """Return a scene that only a chair that reverses can solve: turn round in a corridor."""
    walls = (
        Solid.polygon([[-3, 0.55], [3, 0.55], [3, 0.65], [-3, 0.65]], name="left"),
        Solid.polygon([[-3, -0.65], [3, -0.65], [3, -0.55], [-3, -0.55]], name="right"),
    )
    return Scene(CHAIR, World(walls, (-3, -0.65, 3, 0.65)), [1, 0, 0], Goal([-1, 0, 0]))


@pytest.mark.slow
def test_not_found_says_what_was_tried_and_what_a_chair_that_reverses_could():
    found = plan(forward_only_dead_end())
    assert found.status is PlanStatus.NOT_FOUND
    assert found.path is None
    assert "tried" in found.reason
    assert "reverse" in found.reason


@pytest.mark.slow
def test_a_chair_that_reverses_backs_out_of_the_dead_end():
    scene = forward_only_dead_end()
    able = Vehicle.rectangle(1.0, 0.6, 0.25, limits=Limits(curvature=2.5))
    found = plan(Scene(able, scene.world, scene.start, scene.goal))
    assert found.status is PlanStatus.CERTIFIED, found.reason
    assert (found.path.directions == -1).any()


@pytest.mark.slow
def test_no_time_still_tries_the_first_curve():
    found = plan(doorbench_scene(DOORS["c30_00"]), time_budget=0.0)
    assert found.status is PlanStatus.CERTIFIED
    assert found.statistics["starts"] == 1.0
