"""Worlds from a few numbers: the sizes asked for are there, and the default poses are free."""

import math

import numpy as np
import pytest
import shapely

from narrows.clearance import clearance_at
from narrows.errors import ShapeError
from narrows.scene import Goal, Scene, check_scene, load_vehicle, read_scene, vehicle_names
from narrows.short_forms import Corridor, Doorway


def free_area(world) -> shapely.Geometry:
    """Return the part of the bounds that no solid covers."""
    return shapely.box(*world.bounds).difference(
        shapely.union_all([solid.shape for solid in world.solids])
    )


def test_a_doorway_is_the_corridor_door_and_room_of_the_door_benchmark():
    world = Doorway(1.6, 0.97).world()
    expected = [
        [[-2.0, -0.1], [5.0, -0.1], [5.0, 0.0], [-2.0, 0.0]],
        [[-2.0, 1.6], [1.115, 1.6], [1.115, 1.7], [-2.0, 1.7]],
        [[2.085, 1.6], [5.0, 1.6], [5.0, 1.7], [2.085, 1.7]],
        [[0.1, 1.7], [0.2, 1.7], [0.2, 4.7], [0.1, 4.7]],
        [[4.2, 1.7], [4.3, 1.7], [4.3, 4.7], [4.2, 4.7]],
        [[0.1, 4.7], [4.3, 4.7], [4.3, 4.8], [0.1, 4.8]],
    ]
    for solid, corners in zip(world.solids, expected, strict=True):
        np.testing.assert_allclose(
            np.asarray(solid.shape.exterior.coords)[:-1], corners, atol=1e-12
        )
    np.testing.assert_allclose(world.bounds, [-2.0, -0.1, 5.0, 4.8], atol=1e-12)
    (door,) = world.doors
    np.testing.assert_allclose([*door.center, door.width], [1.6, 1.65, 0.97], atol=1e-12)
    assert door.heading == math.pi / 2


@pytest.mark.parametrize("position", [-30.0, 0.0, 1.6, 12.0])
@pytest.mark.parametrize("room", [(1.0, 1.5), (4.0, 3.0), (12.0, 2.0)])
def test_a_doorway_leads_into_a_closed_room_wherever_it_is(position, room):
    form = Doorway(1.5, 0.9, position, 0.12, room)
    world = form.world()
    inside = next(
        part
        for part in shapely.get_parts(free_area(world))
        if part.covers(shapely.Point(position, 0.75))
    )
    corridor = (world.bounds[2] - world.bounds[0]) * 1.5
    assert inside.area == pytest.approx(corridor + 0.9 * 0.12 + room[0] * room[1])
    jambs = inside.intersection(shapely.box(-99, 1.5 + 1e-9, 99, 1.62 - 1e-9)).bounds
    assert (jambs[0], jambs[2]) == pytest.approx((position - 0.45, position + 0.45))
    assert world.bounds[0] <= min(-2.0, position - 3.6)
    assert world.bounds[2] >= max(5.0, position + 3.4)


@pytest.mark.parametrize("turn", [-150.0, -90.0, -35.0, 5.0, 60.0, 90.0, 120.0, 150.0])
@pytest.mark.parametrize("after", [None, 0.9, 1.8])
def test_a_corridor_has_its_widths_on_both_legs_and_no_way_out(turn, after):
    form = Corridor(1.3, math.radians(turn), after, 4.0)
    world = form.world()
    start, goal = form.start(load_vehicle("narrow-arcs")), form.goal(load_vehicle("narrow-arcs"))
    solid = shapely.union_all([solid.shape for solid in world.solids])
    assert np.degrees(goal[2]) == pytest.approx(turn)
    for pose, width, inward in ((start, 1.3, 1.0), (goal, after or 1.3, -1.0)):
        ahead = np.array([math.cos(pose[2]), math.sin(pose[2])])
        middle = pose[:2] + 1.2 * inward * ahead  # away from the wall at the leg's end
        assert solid.distance(shapely.Point(middle)) == pytest.approx(0.5 * width, abs=1e-9)
        side = 0.5 * width * np.array([-ahead[1], ahead[0]])
        assert all(solid.contains(shapely.Point(middle + k * side)) for k in (-1.001, 1.001))
    parts = shapely.get_parts(free_area(world))
    inside = next(part for part in parts if part.covers(shapely.Point(start[:2])))
    assert inside.covers(shapely.Point(goal[:2]))
    assert inside.distance(shapely.box(*world.bounds).exterior) > 1e-3  # closed


def test_a_right_turn_is_the_mirrored_left_turn():
    left = Corridor(1.3, math.radians(70.0), 1.1).world()
    right = Corridor(1.3, math.radians(-70.0), 1.1).world()
    for one, other in zip(left.solids, right.solids, strict=True):
        mirrored = shapely.transform(one.shape, lambda p: p * [1.0, -1.0] + [0.0, 1.3])
        assert mirrored.symmetric_difference(other.shape).area < 1e-12


def test_the_mitred_corner_of_a_right_angle_is_where_the_walls_meet():
    outer = Corridor(1.3, math.radians(90.0), 1.1).world().solids[0].shape
    corners = np.asarray(outer.exterior.coords)
    for expected in ([1.1, 0.0], [1.2, -0.1]):
        assert np.linalg.norm(corners - expected, axis=1).min() < 1e-12


@pytest.mark.parametrize("name", vehicle_names())
@pytest.mark.parametrize("form", [Doorway(1.6, 0.9), Doorway(1.4, 1.0, 3.0, 0.2), Corridor(1.3)])
def test_the_default_poses_of_every_chair_are_free(name, form):
    chair, world = load_vehicle(name), form.world()
    start, goal = form.start(chair), form.goal(chair)
    check_scene(Scene(chair, world, start, Goal(goal)))
    clearance, _ = clearance_at(world, chair, np.array([start, goal]))
    assert clearance.min() > 0.2


def test_a_file_may_give_the_start_and_leave_the_goal_to_the_short_form():
    text = "vehicle: dft\ndoorway: {corridor_width: 1.6, door_width: 0.9}\n"
    scene = read_scene(text + "start: {x: 4.5, y: 0.8, heading_deg: 180}\n")
    assert scene.start.tolist() == [4.5, 0.8, math.pi]
    np.testing.assert_allclose(scene.goal.pose, [1.6, 3.4, math.pi / 2])  # 0.3 m before the wall


def test_a_world_beside_a_short_form_adds_to_it_and_may_change_its_bounds():
    text = "vehicle: dft\ndoorway: {corridor_width: 1.6, door_width: 0.9}\n"
    world = read_scene(text + "world: {solids: [{circle: [4, 4, 0.1]}]}\n").world
    assert [solid.name for solid in world.solids[-2:]] == ["back wall of the room", "circle 1"]
    assert world.bounds == Doorway(1.6, 0.9).world().bounds
    assert len(world.doors) == 1
    wider = read_scene(text + "world: {bounds: [-3, -1, 6, 6]}\n").world
    assert wider.bounds == (-3.0, -1.0, 6.0, 6.0)


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda: Doorway(0.0, 0.9), "corridor_width must be a positive length"),
        (lambda: Doorway(1.6, math.nan), "door_width must be a positive length"),
        (lambda: Doorway(1.6, 4.1), "wider than the room"),
        (lambda: Corridor(-1.0), "width must be a positive length"),
        (lambda: Corridor(1.3, 0.0), "turns by 5 to 150 degrees, got 0"),
        (lambda: Corridor(1.3, math.radians(-151.0)), "turns by 5 to 150 degrees, got -151"),
        (lambda: Corridor(1.3, math.nan), "turns by"),
        (lambda: Corridor(1.3, wall_thickness=3.1), r"3\.1 m thick do not fit"),
    ],
)
def test_impossible_sizes_are_refused_with_the_reason(make, message):
    with pytest.raises(ShapeError, match=message):
        make()
