"""The arc planner recognises corners and doors in any walls, and says what one arc lacks."""

import math

import numpy as np
import pytest
import shapely

from narrows.clearance import certify
from narrows.interfaces import PlanStatus
from narrows.planners.arc_geometry import ArcBody
from narrows.planners.arcs import ArcPlanner, arc_guess
from narrows.planners.corner_finding import find_turn
from narrows.planners.corridor_turn import Corner, best_arc, missing_width
from narrows.planners.door_arc import DoorTurn
from narrows.planners.door_space import least_corridor_for_door
from narrows.scene import Goal, Scene, load_vehicle, read_scene
from narrows.se2 import rotate
from narrows.short_forms import Corridor, Doorway
from narrows.vehicle import Vehicle
from narrows.world import Solid, World

CHAIR = load_vehicle("narrow-arcs")


def corridor_scene(width, turn_deg=90.0, after=None, vehicle=CHAIR, start=None):
    form = Corridor(width, math.radians(turn_deg), after)
    begin = form.start(vehicle) if start is None else np.array(start)
    return Scene(vehicle, form.world(), begin, Goal(form.goal(vehicle)))


def doorway_scene(corridor, door, vehicle=CHAIR, thickness=0.1):
    form = Doorway(corridor, door, wall_thickness=thickness)
    return Scene(vehicle, form.world(), form.start(vehicle), Goal(form.goal(vehicle)))


def moved(scene, pose):
    """Return the scene turned and shifted, its walls plain polygons in one solid each way round."""

    def place(points):
        return rotate(pose[2], np.asarray(points)) + np.asarray(pose[:2])

    def placed(given):
        return np.append(place(given[:2]), given[2] + pose[2])

    joined = shapely.union_all([solid.shape for solid in scene.world.solids])
    parts = [part for part in shapely.get_parts(joined) if part.area > 0.0]
    solids = tuple(
        Solid(shapely.transform(part, place), name=f"part {k}") for k, part in enumerate(parts)
    )
    return Scene(scene.vehicle, World(solids), placed(scene.start), Goal(placed(scene.goal.pose)))


@pytest.mark.parametrize("turn_deg", [-150.0, -90.0, -35.0, 20.0, 60.0, 90.0, 120.0, 150.0])
@pytest.mark.parametrize(("width", "after"), [(1.3, None), (1.1, 1.5), (1.6, 1.0)])
def test_corridors_of_any_angle_and_widths_are_recognised(turn_deg, width, after):
    found = find_turn(corridor_scene(width, turn_deg, after))
    assert isinstance(found.shape, Corner)
    assert found.shape.turn == pytest.approx(math.radians(abs(turn_deg)))
    widths = (found.shape.before, found.shape.after)
    assert widths == pytest.approx((width, after or width), abs=1e-6)
    assert found.frame.side == math.copysign(1, turn_deg)


@pytest.mark.parametrize("thickness", [0.05, 0.1, 0.35])
def test_doors_are_recognised_with_their_walls_thickness(thickness):
    found = find_turn(doorway_scene(1.6, 0.9, thickness=thickness))
    assert isinstance(found.shape, DoorTurn)
    sizes = (found.shape.corridor, found.shape.door)
    assert sizes == pytest.approx((1.6, 0.9), abs=1e-6)
    assert found.shape.thickness == pytest.approx(thickness, abs=0.021)  # rays are 20 mm apart


@pytest.mark.parametrize("pose", [(0, 0, 0), (3.0, -2.0, 0.7), (-1.0, 5.0, -2.5), (0, 0, 3.1)])
@pytest.mark.parametrize("kind", ["corridor", "door"])
def test_plain_polygons_anywhere_give_the_same_plan(pose, kind):
    scene = corridor_scene(1.05) if kind == "corridor" else doorway_scene(1.6, 0.9)
    there, here = ArcPlanner().plan(moved(scene, pose)), ArcPlanner().plan(scene)
    assert there.status is here.status is PlanStatus.CERTIFIED
    for figure in ("radius_m", "side_gap_m", "axle_gap_m", "best_clearance_m"):
        assert there.statistics[figure] == pytest.approx(here.statistics[figure], abs=1e-5)
    assert there.certificate.clearance == pytest.approx(here.certificate.clearance, abs=2e-3)


def test_a_tight_corridor_is_turned_in_with_the_closed_forms_clearance():
    plan = ArcPlanner().plan(corridor_scene(1.05))
    free = best_arc(ArcBody.of(CHAIR), Corner(1.05, 1.05))
    assert plan.certificate.clearance == pytest.approx(free.clearance, abs=1.1e-3)
    assert plan.statistics["side_gap_m"] == pytest.approx(free.side_gap(0.67), abs=1e-4)
    assert plan.statistics["axle_gap_m"] == pytest.approx(free.axle_gap, abs=1e-4)
    begin = [plan.statistics[f"turn_start_{name}"] for name in ("x", "y", "heading")]
    assert begin[0] == pytest.approx(-plan.statistics["axle_gap_m"])
    assert begin[1] == pytest.approx(1.05 - 0.335 - plan.statistics["side_gap_m"])
    assert "one arc of radius" in plan.reason


def test_left_and_right_turns_mirror_each_other():
    left, right = (ArcPlanner().plan(corridor_scene(1.1, turn)) for turn in (90.0, -90.0))
    at = np.linspace(0.0, left.path.span, 50)
    mirrored = left.path(at) * [1, -1, -1] + [0, 1.1, 0]
    np.testing.assert_allclose(right.path(at), mirrored, atol=1e-9)


def test_where_start_and_goal_stand_well_the_path_is_line_arc_line():
    plan = ArcPlanner().plan(corridor_scene(1.3))
    kappa = [
        float(plan.path.curvature(s.span / 2 + b))
        for s, b in zip(plan.path.sections, plan.path.section_bounds[:-1], strict=True)
    ]
    assert kappa == pytest.approx([0.0, 1.0 / plan.statistics["radius_m"], 0.0], abs=1e-12)


@pytest.mark.parametrize("start", [(-2.5, 0.8, 0.1), (-2.6, 0.45, 0.0), (-2.4, 0.7, -0.12)])
def test_a_start_askew_or_aside_is_aligned_first(start):
    plan = ArcPlanner().plan(corridor_scene(1.3, start=start))
    assert plan.status is PlanStatus.CERTIFIED, plan.reason
    np.testing.assert_allclose(plan.path.start, start, atol=1e-9)
    np.testing.assert_allclose(plan.path.goal, corridor_scene(1.3).goal.pose, atol=1e-6)


def test_from_the_room_into_the_corridor_the_same_arc_is_driven_the_other_way_round():
    there = doorway_scene(1.6, 0.9)
    back = Scene(
        CHAIR,
        there.world,
        there.goal.pose + np.array([0, 0, math.pi]),
        Goal(there.start + np.array([0, 0, math.pi])),
    )
    plan = ArcPlanner().plan(back)
    assert plan.status is PlanStatus.CERTIFIED
    assert (plan.path.directions == 1).all()
    swapped = Vehicle.rectangle(1.0, 0.67, 0.75)
    mirrored = ArcPlanner().plan(doorway_scene(1.6, 0.9, swapped))
    assert plan.statistics["best_clearance_m"] == pytest.approx(
        mirrored.statistics["best_clearance_m"], abs=1e-6
    )


def test_what_one_arc_lacks_is_said_in_millimetres_and_is_not_impassable():
    scene = corridor_scene(0.9)
    plan = ArcPlanner().plan(scene)
    more = missing_width(ArcBody.of(CHAIR), Corner(0.9, 0.9), least_radius=0.02)
    assert plan.status is PlanStatus.NOT_FOUND
    assert plan.statistics["missing_mm"] == pytest.approx(1e3 * more, abs=0.01)
    assert f"needs {1e3 * more:.0f} mm more corridor" in plan.reason
    assert "shunting, may pass" in plan.reason
    wider = corridor_scene(0.9 + more + 0.005)
    assert ArcPlanner().plan(wider).status is PlanStatus.CERTIFIED
    narrower = corridor_scene(0.9 + more - 0.005)
    assert ArcPlanner().plan(narrower).status is PlanStatus.NOT_FOUND


def test_a_bounded_curvature_asks_for_more_room_at_a_door():
    gentle = CHAIR.with_limits(curvature=1.0)
    plan = ArcPlanner().plan(doorway_scene(1.2, 0.8, gentle))
    assert plan.status is PlanStatus.NOT_FOUND
    assert "mm more corridor" in plan.reason
    space = least_corridor_for_door(ArcBody.of(CHAIR), 0.8, least_radius=1.0)
    assert space.corridor > 1.2
    free = ArcPlanner().plan(doorway_scene(1.6, 0.9, CHAIR.with_limits(curvature=2.5)))
    assert free.path.max_curvature <= 2.5


def test_a_start_too_near_to_the_corner_is_said():
    plan = ArcPlanner().plan(corridor_scene(1.05, start=(-0.1, 0.45, 0.0)))
    assert plan.status is PlanStatus.NOT_FOUND
    assert "too near to the corner" in plan.reason


def test_furniture_the_closed_form_does_not_see_is_seen_by_the_certificate():
    scene = corridor_scene(1.3)
    post = Solid.circle(-1.0, 0.65, 0.1, name="post")
    blocked = Scene(CHAIR, World((*scene.world.solids, post)), scene.start, scene.goal)
    plan = ArcPlanner().plan(blocked)
    assert plan.status is PlanStatus.NOT_FOUND
    assert "post" in plan.reason


def test_without_a_corner_it_says_so():
    scene = read_scene(
        "{vehicle: narrow-arcs, world: {bounds: [-1, -1, 5, 1]},"
        " start: {x: 0, y: 0, heading_deg: 0}, goal: {x: 3, y: 0, heading_deg: 0}}"
    )
    assert "no walls" in ArcPlanner().plan(scene).reason
    straight = corridor_scene(1.3)
    ahead = Scene(CHAIR, straight.world, straight.start, Goal([-1.5, 0.65, 0.0]))
    assert "turn by 0 degrees" in ArcPlanner().plan(ahead).reason
    assert arc_guess(scene) is None


@pytest.mark.parametrize(
    "scene", [corridor_scene(1.05), corridor_scene(1.3, 60.0), doorway_scene(1.6, 0.9)]
)
def test_the_guess_starts_and_ends_right_and_is_clear(scene):
    guess = arc_guess(scene)
    np.testing.assert_allclose(guess.start, scene.start, atol=1e-9)
    np.testing.assert_allclose(guess.goal, scene.goal.pose, atol=1e-6)
    assert certify(scene.world, scene.vehicle, guess).clearance > 0.0
