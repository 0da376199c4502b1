"""Through a door on two cubic segments: certified, or a reason a person can act on."""

import math
from dataclasses import replace
from pathlib import Path as File

import numpy as np
import pytest

from narrows import bezier
from narrows.errors import ShapeError
from narrows.interfaces import Plan, PlanStatus
from narrows.planners.door_regions import choose_door, describe_passage, least_width
from narrows.planners.doorway import DoorwayOptions, DoorwayPlanner, certify_segments
from narrows.scene import Goal, Scene, load_scene
from narrows.vehicle import Vehicle
from narrows.world import Door, Solid, World

EXAMPLE = File(__file__).parents[2] / "examples" / "scenes" / "door.yaml"


def corridor_and_room(width: float = 0.9, *extra: Solid) -> World:
    """A corridor 1.6 m wide under a room, a door at x = 1.6 in the wall between."""
    left, right = 1.6 - width / 2, 1.6 + width / 2
    return World(
        (
            Solid.polygon([[-2, -0.1], [5, -0.1], [5, 0], [-2, 0]], name="corridor wall"),
            Solid.polygon([[-2, 1.6], [left, 1.6], [left, 1.7], [-2, 1.7]], name="left jamb"),
            Solid.polygon([[right, 1.6], [5, 1.6], [5, 1.7], [right, 1.7]], name="right jamb"),
            *extra,
        ),
        bounds=(-2.0, -0.1, 5.0, 4.8),
        doors=(Door((1.6, 1.65), width, math.pi / 2),),
    )


def scene(world: World | None = None, **changes: object) -> Scene:
    chair = Vehicle.rectangle(1.0, 0.67, 0.25).with_limits(curvature=2.5)
    plain = Scene(
        chair,
        corridor_and_room() if world is None else world,
        np.array([-0.6, 0.8, 0.0]),
        Goal(np.array([1.6, 3.5, math.pi / 2])),
    )
    return replace(plain, **changes)  # type: ignore[arg-type]


@pytest.fixture(scope="module")
def example() -> Plan:
    return DoorwayPlanner().plan(load_scene(EXAMPLE))


def curve(plan: Plan) -> np.ndarray:
    assert plan.path is not None
    (section,) = plan.path.sections
    return np.asarray(section.control)  # type: ignore[union-attr]


def test_the_example_door_is_passed_with_the_margin_asked_for(example: Plan) -> None:
    assert example.status is PlanStatus.CERTIFIED
    assert example.planner == "doorway"
    assert example.certificate is not None
    assert example.certificate.clearance >= 0.019  # margin 0.020, certificate within 1 mm


def test_curvature_is_bounded_and_continuous_at_the_join(example: Plan) -> None:
    control = curve(example)
    bend = bezier.curvature(control[:, None], np.linspace(0.0, 1.0, 501))
    assert np.abs(bend).max() <= 2.5
    assert bend[0, -1] == pytest.approx(bend[1, 0], abs=1e-3)  # an elastic row, tolerance 1e-4


def test_the_papers_own_curve_cuts_the_jamb_and_is_refused() -> None:
    """The finding of the corrections: the footprint is ignored."""
    plan = DoorwayPlanner(DoorwayOptions.paper()).plan(scene())
    assert plan.status is PlanStatus.NOT_FOUND
    assert "mm into right jamb" in plan.reason


def test_the_papers_join_has_one_tangent_and_a_jump_in_curvature() -> None:
    world = World(doors=(Door((1.6, 1.8), 0.9, math.pi / 2),))
    wide = scene(world, start=np.array([0.1, 1.3, math.radians(-10)]))
    wide = replace(wide, goal=Goal(np.array([3.4, 3.5, math.radians(20)])))
    plan = DoorwayPlanner(DoorwayOptions.paper()).plan(wide)
    control = curve(plan)
    ends = [control[0, 3] - control[0, 2], control[1, 1] - control[1, 0]]
    assert bezier.cross(*ends) == pytest.approx(0.0, abs=1e-9)
    before = float(bezier.curvature(control[0], 1.0))
    behind = float(bezier.curvature(control[1], 0.0))
    # B1 then B3: +2.28 -> -0.87 1/m
    assert before == pytest.approx(2.28, abs=0.01)
    assert behind == pytest.approx(-0.87, abs=0.01)


def test_each_step_beyond_the_paper_is_a_switch_that_works() -> None:
    world = World(doors=(Door((1.6, 1.8), 0.9, math.pi / 2),))
    free = scene(world, start=np.array([0.1, 1.3, math.radians(-10)]))
    free = replace(free, goal=Goal(np.array([3.4, 3.5, math.radians(20)])))
    paper = DoorwayOptions.paper()
    bounded = DoorwayPlanner(replace(paper, curvature_bound=True)).plan(
        replace(free, vehicle=free.vehicle.with_limits(curvature=2.2))
    )
    assert np.abs(bezier.curvature(curve(bounded)[:, None], np.linspace(0, 1, 501))).max() <= 2.2
    smooth = DoorwayPlanner(replace(paper, continuous=True, convex=False)).plan(free)
    control = curve(smooth)
    assert bezier.curvature(control[0], 1.0) == pytest.approx(
        float(bezier.curvature(control[1], 0.0)), abs=1e-3
    )
    np.testing.assert_allclose(control[0, 3], [1.6, 1.8], atol=1e-9)  # the join stays at the door


def test_both_segments_together_find_the_papers_optimum_when_nothing_ties_them() -> None:
    """Two methods agree: the program of four legs, its ties cut, and the two of two legs."""
    world = World(doors=(Door((1.6, 1.8), 0.9, math.pi / 2),))
    free = scene(world, start=np.array([0.1, 1.3, math.radians(-20)]))
    free = replace(free, goal=Goal(np.array([0.0, 3.5, math.radians(160)])))
    apart = DoorwayPlanner(DoorwayOptions.paper()).plan(free)
    together = DoorwayPlanner(
        replace(DoorwayOptions.paper(), join_tilt=1e-9, starts=3)  # a freedom of no size
    ).plan(free)
    # A1 + A3 of the corrected table: 4.26 + 0.709
    assert apart.statistics["cost"] == pytest.approx(4.2590 + 0.7095, rel=1e-3)
    assert together.statistics["cost"] == pytest.approx(apart.statistics["cost"], rel=1e-3)


@pytest.mark.parametrize(
    ("given", "message"),
    [
        (scene(World()), "names no door"),
        (scene(goal=Goal(np.array([3.5, 0.8, 0.0]))), "same side of every door's wall"),
        (scene(corridor_and_room(0.6)), "70 mm are missing"),
        (
            scene(corridor_and_room(0.9, Solid.circle(1.6, 1.65, 0.2, name="box"))),
            "best",
        ),
        (scene(goal=Goal(np.array([3.5, 3.5, -math.pi / 2]))), ""),
        (scene(start=np.array([0.1, 1.0, math.radians(100)])), "best"),
    ],
    ids=["no door", "behind the wall", "too narrow", "obstacle in the door", "turn", "backwards"],
)
def test_what_cannot_be_planned_gets_a_reason_and_no_exception(given: Scene, message: str) -> None:
    for options in (DoorwayOptions(starts=1), DoorwayOptions.paper()):
        plan = DoorwayPlanner(options).plan(given)
        if plan.status is PlanStatus.CERTIFIED:
            assert message == ""
        else:
            assert plan.status is PlanStatus.NOT_FOUND
            assert plan.path is None
            assert len(plan.reason) > 20
    if message:
        assert message in DoorwayPlanner(DoorwayOptions(starts=1)).plan(given).reason


def test_headings_like_b2_are_refused_by_the_curvature_bound() -> None:
    world = World(doors=(Door((1.6, 1.8), 0.9, math.pi / 2),))
    sharp = scene(world, start=np.array([0.1, 1.3, math.radians(10)]))
    kept = replace(DoorwayOptions.paper(), curvature_bound=True)
    plan = DoorwayPlanner(kept).plan(sharp)
    assert plan.status is PlanStatus.NOT_FOUND
    assert plan.reason.startswith("the segment to the door: the curve would have to bend with")
    assert "allowed are 2.49 1/m" in plan.reason


def test_an_obstacle_in_the_doorway_stops_the_papers_formulation_too() -> None:
    blocked = scene(corridor_and_room(0.9, Solid.circle(1.6, 1.65, 0.2, name="box")))
    plan = DoorwayPlanner(DoorwayOptions.paper()).plan(blocked)
    assert "no curve stays far enough from the obstacle at (1.60, 1.65)" in plan.reason


def test_an_obstacle_of_the_paper_moves_the_curve_away() -> None:
    disk = Solid.circle(1.0, 0.2, 0.25, name="stool")
    free = scene(start=np.array([-0.6, 0.5, 0.0]))
    paper = DoorwayPlanner(DoorwayOptions.paper())
    results = []
    for given in (free, replace(free, world=corridor_and_room(0.9, disk))):
        door = choose_door(given)
        assert isinstance(door, Door)
        passage = describe_passage(given, door, keep_off="half_width")
        segment = paper.first_segment(given, passage)
        assert segment.control is not None
        points = bezier.evaluate(segment.control, np.linspace(0, 1, 1000))
        results.append(np.linalg.norm(points - [1.0, 0.2], axis=1).min())
    assert results[0] < 0.25 + 0.335 - 0.01
    assert results[1] == pytest.approx(0.25 + 0.335, abs=1e-3)


def test_the_second_segment_starts_where_the_chair_is_along_the_doors_normal() -> None:
    given = scene()
    door = choose_door(given)
    assert isinstance(door, Door)
    passage = describe_passage(given, door, keep_off="half_width")
    arrived = np.array([1.63, 1.62, math.radians(84)])
    segment = DoorwayPlanner(DoorwayOptions.paper()).second_segment(given, passage, arrived)
    # 30 mm beside the goal's line with the same heading: no convex curve, and it says so
    assert "parallel and 0.03 m apart" in segment.reason
    relaxed = replace(DoorwayOptions.paper(), convex=False)
    segment = DoorwayPlanner(relaxed).second_segment(given, passage, arrived)
    assert segment.control is not None
    np.testing.assert_allclose(segment.control[0], arrived[:2])
    tangent = segment.control[1] - segment.control[0]
    assert math.atan2(tangent[1], tangent[0]) == pytest.approx(math.pi / 2)


def test_the_regions_are_corridor_and_room() -> None:
    given = scene()
    passage = describe_passage(given, given.world.doors[0], keep_off="half_width")

    def inside(region: np.ndarray, x: float, y: float) -> bool:
        return bool((region[:, :2] @ [x, y] <= region[:, 2] + 1e-9).all())

    assert inside(passage.corridor, -1.9, 0.01)
    assert inside(passage.corridor, 1.6, 1.65)
    assert not inside(passage.corridor, 1.6, -0.01)
    assert not inside(passage.corridor, 1.6, 1.66)
    assert inside(passage.room, 4.9, 4.7)
    assert not inside(passage.room, 1.6, 1.64)


def test_a_door_is_driven_either_way_and_the_nearest_one_is_taken() -> None:
    world = corridor_and_room()
    two = replace(world, doors=(*world.doors, Door((4.0, 1.65), 0.9, math.pi / 2)))
    there = choose_door(scene(two))
    assert isinstance(there, Door)
    assert there.center == (1.6, 1.65)
    back = choose_door(
        scene(two, start=np.array([1.6, 3.5, 0.0]), goal=Goal(np.array([-0.6, 0.8, 0.0])))
    )
    assert isinstance(back, Door)
    assert math.sin(back.heading) == pytest.approx(-1.0)


def test_the_least_width_of_a_turned_rectangle_is_its_width() -> None:
    assert least_width(Vehicle.rectangle(1.0, 0.67, 0.25)) == pytest.approx(0.67)


def test_turning_and_mirroring_the_scene_changes_nothing_but_the_place() -> None:
    plain = scene()
    angle, flip = 0.7, -1.0
    c, s = math.cos(angle), math.sin(angle)
    matrix = np.array([[c, -s], [s, c]]) @ np.diag([1.0, flip])

    def moved(pose: np.ndarray) -> np.ndarray:
        return np.array([*(matrix @ pose[:2] + [3.0, -1.0]), flip * pose[2] + angle])

    solids = tuple(
        Solid.polygon(np.asarray(solid.shape.exterior.coords)[:-1] @ matrix.T + [3.0, -1.0])
        for solid in plain.world.solids
    )
    door = moved(np.array([1.6, 1.65, math.pi / 2]))
    world = World(solids, doors=(Door((door[0], door[1]), 0.9, door[2]),))
    turned = Scene(plain.vehicle, world, moved(plain.start), Goal(moved(plain.goal.pose)))
    first = DoorwayPlanner().plan(replace(plain, world=replace(plain.world, bounds=None)))
    second = DoorwayPlanner().plan(turned)
    assert first.status is second.status is PlanStatus.CERTIFIED
    assert first.certificate is not None
    assert second.certificate is not None
    assert min(first.certificate.clearance, second.certificate.clearance) > 0.019
    # Candidates differ (aside and tilt change sign), and sliding the join along the path hardly
    # changes the drive but the cost in the parameter by a fifth.
    assert second.statistics["cost"] == pytest.approx(first.statistics["cost"], rel=0.25)


def test_repeats_give_the_same_curve(example: Plan) -> None:
    again = DoorwayPlanner().plan(load_scene(EXAMPLE))
    assert (curve(again) == curve(example)).all()


def test_a_certificate_of_a_curve_that_hits_says_where() -> None:
    given = scene()
    control = np.array([[[-0.6, 0.8], [0.2, 0.8], [1.0, 0.8], [1.6, 1.65]]])
    certificate = certify_segments(given, control)
    assert certificate.attained < 0.0
    assert "jamb" in certificate.against


def test_wrong_options_are_refused() -> None:
    with pytest.raises(ShapeError, match="'half_width' or 'circumscribed', got 'round'"):
        DoorwayOptions(keep_off="round")
    with pytest.raises(ShapeError, match="starts must be at least 1"):
        DoorwayOptions(starts=0)
