"""The manoeuvre search: known answers, honest endings, nothing that is not clear."""

import math
import subprocess
import sys
from dataclasses import replace

import numpy as np
import pytest

from narrows.clearance import certify
from narrows.errors import ShapeError
from narrows.interfaces import PlanStatus
from narrows.planners.search import SearchPlanner
from narrows.planners.search_options import SearchOptions, ladder
from narrows.scene import Goal, Scene
from narrows.se2 import wrap
from narrows.vehicle import Limits, Vehicle
from narrows.world import Solid, World


def chair(*, reverse=0.0, curvature=2.5):
    limits = Limits(reverse_speed=reverse, curvature=curvature)
    return Vehicle.rectangle(1.0, 0.7, 0.25, limits=limits)


def scene(start, goal, *solids, bounds=None, vehicle=None, margin=0.02):
    return Scene(
        chair() if vehicle is None else vehicle,
        World(tuple(solids), bounds=bounds),
        np.array(start, dtype=float),
        Goal(np.array(goal, dtype=float)),
        margin=margin,
    )


def doorway(width, **options):
    walls = (
        Solid.polygon([[1, 0.5 * width], [1.1, 0.5 * width], [1.1, 3], [1, 3]], name="left"),
        Solid.polygon([[1, -3], [1.1, -3], [1.1, -0.5 * width], [1, -0.5 * width]], name="right"),
    )
    return scene([-1, 0.5, 0], [2.5, -0.4, 0], *walls, bounds=(-2, -3, 4, 3), **options)


def check(case, path):
    assert path.start == pytest.approx(case.start, abs=1e-6)
    gap = path.goal - case.goal.pose
    assert math.hypot(*gap[:2]) <= case.goal.position_tolerance
    assert abs(wrap(gap[2])) <= case.goal.heading_tolerance
    assert path.max_curvature <= case.vehicle.limits.curvature * (1.0 + 1e-9)
    assert certify(case.world, case.vehicle, path).is_clear


def test_ahead_in_the_open_is_a_straight_line():
    case = scene([0, 0, 0.3], [3 * math.cos(0.3), 3 * math.sin(0.3), 0.3])
    result = SearchPlanner().search(case)
    assert result.manoeuvre.path.length == pytest.approx(3.0, abs=1e-9)
    assert result.manoeuvre.cost == pytest.approx(3.0, abs=1e-9)
    check(case, result.manoeuvre.path)


def test_behind_is_reached_in_reverse_where_that_is_allowed():
    goal = [-1.5, 0, 0]
    backwards = SearchPlanner().search(scene([0, 0, 0], goal, vehicle=chair(reverse=0.4)))
    assert backwards.manoeuvre.path.directions.tolist() == [-1]
    assert backwards.manoeuvre.path.length == pytest.approx(1.5, abs=1e-9)
    around = SearchPlanner().search(scene([0, 0, 0], goal))
    assert set(around.manoeuvre.path.directions) == {1}
    # A loop back to the start's own line is longer than a full circle of radius 0.4.
    assert around.manoeuvre.path.length > 2 * math.pi * 0.4


def test_a_chair_that_may_turns_on_the_spot():
    case = scene([0, 0, 0], [0, 0, 3.0], vehicle=chair(curvature=math.inf))
    path = SearchPlanner().search(case).manoeuvre.path
    assert set(path.directions) == {0}
    assert path.length == 0.0
    assert path.span == pytest.approx(3.0, abs=case.goal.heading_tolerance)


def test_a_doorway_is_passed_with_the_margin_asked_for_where_there_is_room():
    case = doorway(0.9)
    manoeuvre = SearchPlanner().search(case).manoeuvre
    check(case, manoeuvre.path)
    assert manoeuvre.clearance == case.margin
    # Half the margin is what is proven between measurements; the certificate sees it kept.
    assert certify(case.world, case.vehicle, manoeuvre.path).clearance >= 0.5 * case.margin


def test_a_door_tighter_than_the_margin_is_passed_closer():
    case = doorway(0.73)
    manoeuvre = SearchPlanner().search(case).manoeuvre
    check(case, manoeuvre.path)
    assert manoeuvre.clearance < case.margin


def test_a_plan_is_certified_and_stops_where_the_curvature_changes():
    plan = SearchPlanner().plan(doorway(0.9))
    assert plan.status is PlanStatus.CERTIFIED
    for section in plan.path.sections:
        bend = section.evaluate(np.linspace(0, section.span, 9), 1)[:, 2]
        assert np.ptp(bend) < 1e-6


def test_a_door_narrower_than_the_chair_exhausts_the_search():
    coarse = SearchOptions(cell=0.1, heading_cell=math.radians(6), step=0.2, refinements=0)
    plan = SearchPlanner(coarse).plan(doorway(0.69))
    assert plan.status is PlanStatus.NOT_FOUND
    assert "search space exhausted at resolution 100.0 mm, 6.00 deg" in plan.reason


def test_a_goal_that_is_shut_in_is_told_without_combing_the_rest_of_the_world():
    """A wall close behind the goal, forward only: nothing leads there from within a metre."""
    wall = Solid.polygon([[1.4, -0.8], [1.5, -0.8], [1.5, 0.8], [1.4, 0.8]], name="behind")
    case = scene([-1, 0, 0], [2, 0, 0], wall, bounds=(-2, -2, 5, 2))
    result = SearchPlanner().search(case)
    assert result.manoeuvre is None
    assert result.is_exhausted
    assert result.statistics["expansions"] < 10_000  # 40,000 more from the start, otherwise


def test_a_small_budget_is_said_to_be_spent():
    result = SearchPlanner(SearchOptions(budget=40)).search(doorway(0.71))
    assert result.manoeuvre is None
    assert not result.is_exhausted
    assert result.reason == "budget of 40 expansions spent without finding a way"
    assert result.statistics["expansions"] == 40


def test_a_start_in_contact_is_named():
    wall = Solid.polygon([[0.7, -1], [0.8, -1], [0.8, 1], [0.7, 1]], name="wall")
    result = SearchPlanner().search(scene([0, 0, 0], [-2, 0, 0], wall))
    assert result.reason.startswith("at the start the body is -50.0 mm from wall")


def test_the_same_search_gives_the_same_path():
    first, second = (SearchPlanner().search(doorway(0.8)) for _ in range(2))
    ends = [r.manoeuvre.path.section_bounds for r in (first, second)]
    assert np.array_equal(*ends)
    assert first.statistics == second.statistics


def test_several_manoeuvres_are_distinct_and_clear():
    post = Solid.circle(1.5, 0.0, 0.3, name="post")
    case = scene([-0.5, 0, 0], [4, 0, 0], post, bounds=(-2, -2.5, 6, 2.5))
    found = list(SearchPlanner().search_many(case, 3))
    assert len(found) >= 2
    for manoeuvre in found:
        check(case, manoeuvre.path)
    sides = [float(m.path(np.linspace(0, m.path.span, 200))[:, 1].sum()) for m in found]
    spread = max(sides) - min(sides)
    assert spread > 1.0


def test_asking_for_no_manoeuvre_gives_none():
    assert list(SearchPlanner().search_many(doorway(0.9), 0)) == []


def test_the_estimate_never_exceeds_what_was_driven():
    from narrows.planners.search_kernel import remaining
    from narrows.planners.search_options import Rung
    from narrows.planners.search_rung import Ground

    for width in (0.72, 0.8, 1.0):
        for reverse in (0.0, 0.4):
            case = doorway(width, vehicle=chair(reverse=reverse))
            ground = Ground(case, SearchOptions(crowding=0.0, weight=1.0))
            rung = Rung(False, reverse > 0.0, 1e-3, 1.0, False, 50_000)
            way = ground.search(rung, rung.budget).way
            left = np.concatenate([np.cumsum(way.drives[::-1, 2])[::-1], [0.0]])
            goal = np.array([*case.goal.pose, case.goal.position_tolerance, 0.06])
            rules = ground._rules(rung, 1)
            bound = [remaining(ground.terrain.to_goal, rules, *pose, goal) for pose in way.poses]
            assert (np.array(bound) <= left + 1e-9).all()
            assert bound[0] > 0.7 * left[0]  # and says something


@pytest.mark.slow
def test_nothing_found_in_random_worlds_is_in_contact():
    rng = np.random.default_rng(8)
    found = 0
    for case_number in range(30):
        solids = []
        for k in range(10):
            x, y = rng.uniform([0.5, -2.5], [4.5, 2.5])
            if k % 2:
                solids.append(Solid.circle(x, y, rng.uniform(0.05, 0.4), name=f"post {k}"))
            else:
                angle = np.sort(rng.uniform(0, 2 * np.pi, 5))
                corner = np.stack([np.cos(angle), np.sin(angle)], 1) * rng.uniform(0.2, 0.5)
                solids.append(Solid.polygon(corner + np.array([x, y]), name=f"box {k}"))
        vehicle = chair(
            reverse=0.4 * (case_number % 2), curvature=math.inf if case_number % 3 == 0 else 2.5
        )
        case = scene([-0.8, 0, 0], [5.5, 0, 0], *solids, bounds=(-2, -3, 7, 3), vehicle=vehicle)
        result = SearchPlanner(SearchOptions(budget=20_000)).search(case)
        if result.manoeuvre is not None:
            found += 1
            check(case, result.manoeuvre.path)
    assert found > 15


def test_a_layered_body_passes_under_what_is_above_it():
    from narrows.vehicle import Layer

    low = Layer(np.array([[-0.25, -0.35], [0.75, -0.35], [0.75, 0.35], [-0.25, 0.35]]), (0, 0.6))
    high = Layer(np.array([[-0.2, -0.3], [0.2, -0.3], [0.2, 0.3], [-0.2, 0.3]]), (0.6, 1.3))
    vehicle = replace(chair(), layers=(low, high))
    shelf = Solid.polygon([[1.5, 0.32], [2.5, 0.32], [2.5, 1], [1.5, 1]], z=(0.65, 1), name="shelf")
    case = scene([0, 0, 0], [4, 0, 0], shelf, vehicle=vehicle, margin=0.01)
    path = SearchPlanner().search(case).manoeuvre.path
    assert path.length == pytest.approx(4.0, abs=0.1)
    check(case, path)


def test_importing_the_search_does_not_load_the_compiler():
    code = "import sys, narrows.planners.search; sys.exit('numba' in sys.modules)"
    assert subprocess.run([sys.executable, "-c", code], check=False).returncode == 0


@pytest.mark.parametrize(
    ("field", "value"), [("cell", 0.0), ("weight", 0.5), ("crowding", -1.0), ("curvatures", (2.0,))]
)
def test_options_outside_their_range_are_refused(field, value):
    with pytest.raises(ShapeError, match=field):
        SearchOptions(**{field: value})


def test_only_a_chair_that_may_reverse_is_searched_in_reverse():
    options = SearchOptions()
    assert not any(rung.reversing for rung in ladder(options, 0.02, reversing=False))
    assert any(rung.reversing for rung in ladder(options, 0.02, reversing=True))
