"""Several starts, the best certified one; the examples end as they must."""

import math
from dataclasses import replace
from pathlib import Path as File

import numpy as np
import pytest

from narrows.bezier_section import BezierSection
from narrows.clearance import clearance_at
from narrows.interfaces import Plan, PlanStatus
from narrows.path import Path
from narrows.planners import plan
from narrows.planners.body_program import Weights
from narrows.planners.guess import curve_through, forward_guesses
from narrows.planners.manoeuvre import (
    Candidate,
    ManoeuvreOptions,
    ManoeuvrePlanner,
    best_candidates,
    plan_of,
    refine,
    segments_for,
)
from narrows.planners.refinement import Refined
from narrows.scene import Goal, Scene, load_scene
from narrows.vehicle import Vehicle
from narrows.world import Solid, World

EXAMPLES = File(__file__).parents[2] / "examples" / "scenes"
CHAIR = Vehicle.rectangle(1.0, 0.67, 0.25)
NEVER = math.inf  # CPU time after which no further start is taken


def gap(width: float, margin: float = 0.02) -> Scene:
    """Nearly straight through a gap in a wall that has no end."""
    half = width / 2
    wall = (
        Solid.polygon([[1.5, half], [1.6, half], [1.6, 3], [1.5, 3]], name="left"),
        Solid.polygon([[1.5, -3], [1.6, -3], [1.6, -half], [1.5, -half]], name="right"),
    )
    start, goal = np.array([0.0, 0.1, 0.0]), np.array([4.0, -0.1, 0.0])
    return Scene(CHAIR, World(wall, (-1, -3, 6, 3)), start, Goal(goal), margin)


def least_by_sampling(scene: Scene, outcome: Plan) -> float:
    assert outcome.path is not None
    poses = outcome.path(np.linspace(0.0, outcome.path.span, 6000))
    return float(clearance_at(scene.world, scene.vehicle, poses)[0].min())


@pytest.mark.parametrize(
    "name",
    ["door", "narrow-door", "tight-door", "l-corridor", "under-the-table", "person", "flat"],
)
def test_the_examples_are_certified_with_their_margin(name: str) -> None:
    scene = load_scene(EXAMPLES / f"{name}.yaml")
    outcome = plan(scene).raise_for_status()
    assert outcome.planner == "manoeuvre"
    assert outcome.certificate is not None
    assert outcome.trajectory is not None
    assert outcome.certificate.clearance >= scene.margin - 2e-4
    assert outcome.certificate.clearance <= least_by_sampling(scene, outcome) + 1e-9
    assert "margin" not in outcome.reason
    limits = scene.vehicle.limits
    assert outcome.path.max_curvature <= limits.curvature
    assert float(np.abs(outcome.trajectory.commands[:, 0]).max()) <= limits.speed + 1e-9
    assert outcome.path.direction_changes == 0


def test_the_door_that_is_too_narrow_is_impassable_by_twenty_millimetres() -> None:
    """0.65 m of door, 0.67 m of chair."""
    outcome = plan(load_scene(EXAMPLES / "too-narrow.yaml"))
    assert outcome.status is PlanStatus.IMPASSABLE
    assert outcome.path is None
    assert outcome.statistics["missing_mm"] == pytest.approx(20.0, abs=1.0)
    assert "20 mm too large for the door" in outcome.reason


def test_every_example_has_an_expected_outcome() -> None:
    known = {"door", "narrow-door", "tight-door", "too-narrow", "l-corridor", "under-the-table"}
    known |= {"person", "flat"}
    known |= {"course", "course-back", "somebody-in-the-door"}  # to be driven: see simulation
    assert {file.stem for file in EXAMPLES.glob("*.yaml")} == known


def test_a_margin_that_cannot_be_had_is_said_and_the_largest_clearance_taken() -> None:
    scene = gap(0.80, margin=0.1)
    outcome = ManoeuvrePlanner().plan(scene).raise_for_status()
    assert outcome.certificate is not None
    assert 0.065 - 1.5e-3 <= outcome.certificate.clearance <= 0.065 + 1e-9
    assert "the margin of 100 mm asked for is not kept" in outcome.reason


def test_more_margin_costs_more_bending() -> None:
    scene = load_scene(EXAMPLES / "narrow-door.yaml")
    costs, bends = [], []
    for margin in (0.0, 0.02, 0.04):
        outcome = ManoeuvrePlanner().plan(replace(scene, margin=margin)).raise_for_status()
        costs.append(outcome.statistics["cost"])
        bends.append(bending(outcome.path))
    assert costs == sorted(costs)
    assert bends[0] < bends[1] < bends[2]


def bending(path: Path | None) -> float:
    """Return INT kappa^2 ds by the trapezoid rule [1/m]."""
    assert path is not None
    s = np.linspace(0.0, path.span, 4001)
    return float(np.trapezoid(path.curvature(s) ** 2, s))


def test_a_price_below_what_the_margin_is_worth_leaves_it_and_nothing_unproven() -> None:
    """Where clearance is nearly free the curve cuts the corner; no plan comes of that."""
    scene = load_scene(EXAMPLES / "narrow-door.yaml")
    cheap = ManoeuvrePlanner(ManoeuvreOptions(weights=Weights(price=1.0))).plan(scene)
    assert cheap.status is PlanStatus.NOT_FOUND
    assert cheap.path is None
    assert "not clear: the body cuts" in cheap.reason


def test_a_gap_narrower_than_the_chair_is_not_found_by_this_planner_and_says_what_blocked() -> None:
    outcome = ManoeuvrePlanner().plan(gap(0.60))
    assert outcome.status is PlanStatus.NOT_FOUND
    assert "manoeuvres tried, none certified" in outcome.reason
    assert "mm into left" in outcome.reason or "mm into right" in outcome.reason


def straight(length: float) -> Path:
    return Path((BezierSection(np.linspace([0, 0], [length, 0], 4)[None]),))


@pytest.mark.parametrize(("length", "segments"), [(0.5, 6), (2.69, 6), (2.71, 10), (30.0, 10)])
def test_a_longer_way_has_more_pieces(length: float, segments: int) -> None:
    assert segments_for(straight(length)) == segments


def test_a_shunt_has_six_pieces_a_section() -> None:
    path = Path.from_poses([[0, 0, 0], [5, 0, 0], [2, 0, 0], [6, 0, 0]])
    assert segments_for(path) == 6


class TestStarts:
    """Which starts are tried, and what becomes of them."""

    @staticmethod
    def guesses(scene: Scene, asked: list[str]):
        """Yield four starts, noting which are asked for: 2 cannot be splines."""
        ways = {
            "1": curve_through([scene.start, [1.5, 0.6, 0.0], scene.goal.pose]),
            "2": Path.from_poses([[0, 0.1, 0], [1, 0.1, 0], [1, 0.1, 1]]),
            "3": curve_through([scene.start, scene.goal.pose]),
            "4": curve_through([scene.start, [2.5, -0.5, 0.0], scene.goal.pose]),
        }
        for name, path in ways.items():
            asked.append(name)
            yield name, path

    def test_no_more_are_asked_for_than_needed(self) -> None:
        scene, asked = gap(1.2), []
        found = best_candidates(scene, self.guesses(scene, asked), ManoeuvreOptions(), NEVER)
        assert asked == ["1"]
        assert [candidate.name for candidate in found] == ["1"]
        assert found[0].is_good

    def test_those_that_are_no_splines_are_passed_over_and_the_best_comes_first(self) -> None:
        scene, asked = gap(1.2), []
        options = ManoeuvreOptions(compare=3)
        found = best_candidates(scene, self.guesses(scene, asked), options, NEVER)
        assert asked == ["1", "2", "3", "4"]
        assert sorted(candidate.name for candidate in found) == ["1", "3", "4"]
        costs = [candidate.refined.cost for candidate in found]
        assert costs == sorted(costs)

    def test_when_the_time_is_over_no_further_one_is_tried(self) -> None:
        scene, asked = gap(1.2), []
        options = ManoeuvreOptions(compare=3)
        found = best_candidates(scene, self.guesses(scene, asked), options, 0.0)
        assert asked == ["1"]
        assert len(found) == 1

    def test_the_first_candidate_that_can_be_certified_is_the_plan(self) -> None:
        scene = gap(1.2)
        good = refine(
            scene, "good", curve_through([scene.start, scene.goal.pose]), ManoeuvreOptions()
        )
        askew = Refined(straight(4.0), 0.0, 0.0, 0.0, 3, 4)  # ends 100 mm off, starts as much
        outcome = plan_of(scene, [Candidate("askew", askew), good], 0.0)
        assert outcome.path is good.refined.path
        assert outcome.statistics["cost"] == good.refined.cost
        assert outcome.statistics["starts"] == 2.0
        assert outcome.statistics["iterations"] == 3.0 + good.refined.iterations

    def test_if_none_can_be_the_reason_says_what_was_wrong_with_each(self) -> None:
        scene = gap(1.2)
        askew = Candidate("askew", Refined(straight(4.0), 0.0, 0.0, 0.0, 3, 4))
        outcome = plan_of(scene, [askew, askew], 0.0)
        assert outcome.status is PlanStatus.NOT_FOUND
        assert outcome.reason.startswith(
            "2 manoeuvres tried, none certified: askew: the path starts "
        )
        nothing = plan_of(scene, [], 0.0)
        assert nothing.reason.endswith("no rough path could be refined")

    @pytest.mark.parametrize(("slack", "excess"), [(2e-4, 0.0), (0.0, 2e-3)])
    def test_a_candidate_that_lacks_clearance_or_bends_too_much_is_not_good(
        self, slack: float, excess: float
    ) -> None:
        assert not Candidate("", Refined(straight(1.0), 0.0, slack, excess, 1, 1)).is_good
        assert Candidate("", Refined(straight(1.0), 0.0, 5e-5, 5e-4, 1, 1)).is_good


def test_the_planner_starts_from_the_guesses_of_the_scene() -> None:
    scene = load_scene(EXAMPLES / "door.yaml")
    name, guess = forward_guesses(scene)[0]
    candidate = refine(scene, name, guess, ManoeuvreOptions())
    outcome = ManoeuvrePlanner().plan(scene)
    assert outcome.statistics["cost"] == candidate.refined.cost
    assert outcome.statistics["solve_time_s"] > 0.0
