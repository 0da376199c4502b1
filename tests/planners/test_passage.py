"""The verdict and the millimetres against closed forms, published facts and plain cases.

Room to spare is bracketed to less than 1 mm (`spare.BRACKET`), so figures agree within 1 mm.
"""

import math
from dataclasses import replace

import numpy as np
import pytest
import shapely

from narrows.clearance import clearance_at
from narrows.planners import passage_windows
from narrows.planners.heading_slices import ObstaclePieces
from narrows.planners.passage import PassageStatus, Verdict, passable
from narrows.planners.passage_problem import PassageProblem
from narrows.planners.passage_reason import reason_for
from narrows.planners.passage_windows import PassageDecider
from narrows.planners.spare import Limit
from narrows.scene import Goal, Scene
from narrows.se2 import rotate
from narrows.vehicle import Layer, Limits, Vehicle
from narrows.world import Door, MovingSolid, Solid, World

MILLIMETRE = 1e-3
CHAIR = Vehicle.rectangle(1.0, 0.67, 0.25)
POST = (np.zeros((1, 1, 2)), np.array([0.3]))
PASSABLE, IMPASSABLE = PassageStatus.PASSABLE, PassageStatus.IMPASSABLE


def door_scene(
    opening: float, *, vehicle: Vehicle = CHAIR, thickness: float = 0.1, door: bool = True
) -> Scene:
    """A wall across a 6 x 6 m room, a door in its middle, start and goal 2 m from it."""
    half = opening / 2.0
    solids = (
        Solid.polygon([[-3, 0], [-half, 0], [-half, thickness], [-3, thickness]]),
        Solid.polygon([[half, 0], [3, 0], [3, thickness], [half, thickness]]),
    )
    doors = (Door((0.0, thickness / 2), opening, math.pi / 2),) if door else ()
    world = World(solids, (-3.0, -3.0, 3.0, 3.0), doors=doors)
    return Scene(vehicle, world, np.array([0.2, -2.0, 0.3]), Goal(np.array([-0.3, 2.0, 1.2])))


def corner_scene(width: float, length: float, body_width: float, rear: float = 0.0) -> Scene:
    """Two corridors of one width that meet at a right angle; start and goal in their far ends."""
    arm = 4.0
    solids = (
        Solid.polygon([[-1, -1], [arm, -1], [arm, 0], [0, 0], [0, arm], [-1, arm]]),
        Solid.polygon([[width, width], [arm, width], [arm, arm], [width, arm]]),
    )
    end = arm - length + rear - 0.2
    return Scene(
        Vehicle.rectangle(length, body_width, rear),
        World(solids, (-1.0, -1.0, arm, arm)),
        np.array([end, width / 2, math.pi]),
        Goal(np.array([width / 2, end, math.pi / 2])),
    )


def way(verdict: Verdict, step: float = 0.005) -> np.ndarray:
    """The witness sampled densely as documented: slides and turns about the pivot."""
    assert verdict.witness is not None
    poses = verdict.witness
    pivots = poses[:, :2] + rotate(poses[:, 2], verdict.pivot)
    rows = []
    for k in range(len(poses) - 1):
        slide, turn = pivots[k + 1] - pivots[k], poses[k + 1, 2] - poses[k, 2]
        assert np.hypot(*slide) < 1e-9 or abs(turn) < 1e-12
        share = np.linspace(0.0, 1.0, 2 + int((np.hypot(*slide) + abs(turn)) / step))[:, None]
        heading = poses[k, 2] + share[:, 0] * turn
        place = pivots[k] + share * slide - rotate(heading, verdict.pivot)
        rows.append(np.column_stack([place, heading]))
    return np.concatenate(rows)


def check_witness(scene: Scene, verdict: Verdict) -> None:
    poses = way(verdict)
    assert poses[0] == pytest.approx(scene.start)
    offset = poses[-1] - scene.goal.pose
    assert np.hypot(*offset[:2]) <= scene.goal.position_tolerance + 1e-9
    turned = abs(math.remainder(offset[2], 2.0 * math.pi))
    assert turned <= scene.goal.heading_tolerance + 1e-9
    assert clearance_at(scene.world, scene.vehicle, poses)[0].min() > 0.0
    if scene.world.bounds is not None:
        low, high = np.array(scene.world.bounds[:2]), np.array(scene.world.bounds[2:])
        for corner in scene.vehicle.outline:
            at = poses[:, :2] + rotate(poses[:, 2], np.tile(corner, (len(poses), 1)))
            assert (at >= low).all()
            assert (at <= high).all()


@pytest.mark.parametrize("opening", [0.90, 0.70, 0.66, 0.60])
def test_a_door_passed_straight_on_spares_its_opening_less_the_width(opening: float) -> None:
    scene = door_scene(opening)
    verdict = passable(scene)
    assert verdict.status is (PASSABLE if opening > 0.67 else IMPASSABLE)
    assert verdict.spare_m == pytest.approx(opening - 0.67, abs=MILLIMETRE)
    assert verdict.narrowest == pytest.approx([0.0, 0.05], abs=0.02)
    if verdict.status is PASSABLE:
        check_witness(scene, verdict)


def test_the_reason_names_the_door_and_the_millimetres() -> None:
    reason = passable(door_scene(0.635)).reason
    assert reason == (
        "no motion gets this body from start to goal: "
        "it is 35 mm too large for the door at (0.00, 0.05)"
    )
    assert "230 mm to spare at the door at (0.00, 0.05)" in passable(door_scene(0.90)).reason


def test_the_door_is_the_narrowest_place_though_its_frame_is_thicker_than_the_wall() -> None:
    # Places on two sides of the wall are nearer to each other beside the frame than in the door.
    room = door_scene(0.762).world
    frame = [[0.381, -0.04], [0.441, -0.04], [0.441, 0.14], [0.381, 0.14]]
    mirrored = [[-x, y] for x, y in reversed(frame)]
    solids = (*room.solids, Solid.polygon(frame), Solid.polygon(mirrored))
    scene = Scene(
        Vehicle.rectangle(1.1, 0.83, 0.55),
        replace(room, solids=solids),
        np.array([0.0, -1.4, math.pi / 2]),
        Goal(np.array([0.0, 1.5, math.pi / 2])),
    )
    assert passable(scene).narrowest == pytest.approx([0.0, 0.05], abs=0.02)


def test_a_search_for_the_millimetres_that_ends_early_says_between_which_they_are() -> None:
    scene = door_scene(0.635)
    verdict = passable(scene)
    assert verdict.spare is not None
    rough = replace(verdict.spare, refuted=-0.020)
    decision = PassageDecider(PassageProblem.from_scene(scene), 1e-3, math.inf).decide(0.0)
    reason = reason_for(scene, decision, rough, verdict.narrowest)
    assert reason.endswith("it is 20 to 35 mm too large for the door at (0.00, 0.05)")


def test_a_fit_within_a_hair_is_left_undecided_with_the_room_bracketed() -> None:
    verdict = passable(door_scene(0.67))
    assert verdict.status is PassageStatus.UNDECIDED
    assert verdict.spare is not None
    assert verdict.spare.proven <= 0.0 <= verdict.spare.refuted
    assert verdict.spare.refuted - verdict.spare.proven < MILLIMETRE
    assert verdict.witness is None
    assert verdict.proof is None


@pytest.mark.parametrize("width", [0.80, 0.60])
def test_a_long_corridor_spares_its_width_less_the_bodys(width: float) -> None:
    scene = door_scene(width, thickness=2.0)
    goal = Goal(np.array([0.0, 2.5, 1.57]), 0.3, math.pi)
    verdict = passable(
        Scene(CHAIR, World(scene.world.solids, (-3.0, -3.0, 3.0, 5.0)), scene.start, goal)
    )
    assert verdict.status is (PASSABLE if width > 0.67 else IMPASSABLE)
    assert verdict.spare_m == pytest.approx(width - 0.67, abs=MILLIMETRE)
    assert verdict.narrowest is not None
    assert abs(verdict.narrowest[0]) < 0.1


@pytest.mark.parametrize(
    ("length", "width", "corridor"),
    [(1.0, 0.67, 0.80), (1.0, 0.67, 0.90), (1.2, 0.60, 0.86), (1.065, 0.66, 0.84)],
)
def test_a_square_corner_spares_what_the_rigid_motion_bound_says(
    length: float, width: float, corridor: float
) -> None:
    # At 45 deg, centred on the diagonal, a rectangle needs (l/2 + w) / sqrt(2), corrections 3.4;
    # a body larger by s each way needs (l/2 + w + 1.5 s) / sqrt(2).
    room = (math.sqrt(2.0) * corridor - length / 2.0 - width) / 1.5
    verdict = passable(corner_scene(corridor, length, width))
    assert verdict.spare_m == pytest.approx(room, abs=MILLIMETRE)
    assert verdict.status is (PASSABLE if room > 0.0 else IMPASSABLE)
    assert verdict.narrowest is not None
    assert np.hypot(*verdict.narrowest) < 1.5  # by the corner, not in the arms of 4 m


@pytest.mark.parametrize(
    ("front", "rear", "width", "bound", "arc"),
    [
        (1.0, 0.0, 0.67, 0.827, 1.181),
        (0.90, 0.20, 0.65, 0.849, 1.096),
        (0.60, 0.60, 0.62, 0.863, 0.863),
        (0.845, 0.22, 0.66, 0.843, 1.064),
        (1.0, 0.20, 0.70, 0.919, 1.202),
    ],
)
def test_the_angled_corridor_lies_between_the_bound_and_one_arc(
    front: float, rear: float, width: float, bound: float, arc: float
) -> None:
    # Table of corrections 3.4, rounded there to 1 mm.
    below, above = (
        passable(corner_scene(w, front + rear, width, rear), spare=False)
        for w in (bound - 0.002, arc + 0.002)
    )
    assert below.status is IMPASSABLE
    assert above.status is PASSABLE


def test_the_adaag_chair_turns_between_walls_36_inches_apart() -> None:
    # Stanford's planner confirms the 36 in (915 mm) turn of ADAAG; IDEA: 85 to 100 cm pass half
    # to most users. corrections 3.3, 3.4.
    scene = corner_scene(0.915, 1.065, 0.66, 0.22)
    verdict = passable(scene, spare=False)
    assert verdict.status is PASSABLE
    check_witness(scene, verdict)
    assert passable(corner_scene(0.84, 1.065, 0.66, 0.22), spare=False).status is IMPASSABLE


@pytest.mark.parametrize(("clear", "status"), [(0.75, PASSABLE), (0.65, IMPASSABLE)])
def test_low_footrests_pass_under_a_table_that_stops_the_seat(
    clear: float, status: PassageStatus
) -> None:
    low = Layer(np.array([[-0.2, -0.3], [0.9, -0.3], [0.9, 0.3], [-0.2, 0.3]]), (0.0, 0.7))
    high = Layer(np.array([[-0.2, -0.2], [0.4, -0.2], [0.4, 0.2], [-0.2, 0.2]]), (0.7, 1.3))
    gate = door_scene(0.5).world.solids  # 0.5 m wide: only the narrow upper layer passes
    table = tuple(Solid(s.shape, z=(clear, 1.0)) for s in gate)
    world = World(table, (-3.0, -3.0, 3.0, 3.0))
    scene = Scene(
        Vehicle((low, high)), world, np.array([0, -2, 1.57]), Goal(np.array([0, 2, 1.57]))
    )
    verdict = passable(scene)
    assert verdict.status is status
    if status is PASSABLE:
        assert verdict.spare_m == pytest.approx(0.1, abs=MILLIMETRE)
        check_witness(scene, verdict)
    else:
        assert verdict.spare_m == pytest.approx(-0.1, abs=MILLIMETRE)


def test_two_posts_spare_their_gap_less_the_width() -> None:
    # Circles are polygons within 0.1 mm on each side.
    posts = tuple(Solid.circle(x, 0.0, 0.3, name="post") for x in (-0.7, 0.7))
    walls = (Solid.polygon([[-3, 0], [-0.8, 0], [-0.8, 0.1], [-3, 0.1]]),)
    walls += (Solid.polygon([[0.8, 0], [3, 0], [3, 0.1], [0.8, 0.1]]),)
    scene = door_scene(0.9)
    world = World(posts + walls, scene.world.bounds)
    verdict = passable(Scene(CHAIR, world, scene.start, scene.goal))
    assert verdict.status is PASSABLE
    assert verdict.spare_m == pytest.approx(0.80 - 0.67, abs=MILLIMETRE)
    assert "near post and post" in verdict.reason


@pytest.mark.parametrize("slant", [0.0, 0.5, 0.25])
def test_a_circles_polygon_is_on_the_safe_side_whatever_its_corners_face(slant: float) -> None:
    # A twentieth of a millimetre too narrow or wide, half what the polygon of a post may stray.
    # The posts' polygons have a corner at 0 deg, the middle of a side half a step (slant) away.
    turn = slant * 2.0 * math.pi / (ObstaclePieces.bracket(*POST).inside.shape[1])
    for opening, wrong in ((0.67 + 5e-5, IMPASSABLE), (0.67 - 5e-5, PASSABLE)):
        at = opening / 2.0 + 0.3
        solids = [Solid.circle(*rotate(turn, [side * at, 0.0]), 0.3) for side in (-1, 1)]
        for side in (-1.0, 1.0):
            wall = side * np.array([[at, -0.05], [4.5, -0.05], [4.5, 0.05], [at, 0.05]])
            solids.append(Solid.polygon(rotate(turn, wall)))
        world = World(tuple(solids), (-3.0, -3.0, 3.0, 3.0))
        start, goal = (np.append(rotate(turn, [0.0, y]), turn + math.pi / 2) for y in (-2.0, 1.5))
        verdict = passable(Scene(CHAIR, world, start, Goal(goal)), spare=False)
        assert verdict.status is not wrong


def test_without_bounds_a_wall_is_passed_around_and_with_bounds_it_is_not() -> None:
    wall = Solid.polygon([[-3, 0], [3, 0], [3, 0.1], [-3, 0.1]])
    start, goal = np.array([0.0, -2.0, 0.0]), Goal(np.array([0.0, 2.0, 0.0]))
    free = Scene(CHAIR, World((wall,)), start, goal)
    verdict = passable(free)
    assert verdict.status is PASSABLE
    check_witness(free, verdict)
    inside = Scene(CHAIR, World((wall,), (-3.0, -3.0, 3.0, 3.0)), start, goal)
    verdict = passable(inside)
    assert verdict.status is IMPASSABLE
    assert verdict.reason.endswith("however small the body")


def test_the_body_stays_inside_the_bounds() -> None:
    wall = Solid.polygon([[-3, 0], [2.3, 0], [2.3, 0.1], [-3, 0.1]])
    world = World((wall,), (-3.0, -3.0, 3.0, 3.0))
    scene = Scene(CHAIR, world, np.array([0, -2, 0]), Goal(np.array([0, 2, 0])))
    verdict = passable(scene)
    assert verdict.spare_m == pytest.approx(0.70 - 0.67, abs=MILLIMETRE)
    check_witness(scene, verdict)


def test_an_open_plane_has_room_to_spare_beyond_what_is_looked_for() -> None:
    scene = Scene(CHAIR, World(), np.zeros(3), Goal(np.array([3.0, 1.0, 1.0])))
    verdict = passable(scene)
    assert verdict.status is PASSABLE
    assert verdict.spare is not None
    assert verdict.spare.limit is Limit.NOTHING
    assert "at least 2000 mm" in verdict.reason


def test_a_start_that_overlaps_is_impassable_and_said_to_be() -> None:
    scene = door_scene(0.9)
    blocked = Scene(CHAIR, scene.world, np.array([0.0, -0.5, math.pi / 2]), scene.goal)
    verdict = passable(blocked)
    assert verdict.status is PASSABLE or "start" in verdict.reason
    deep = Scene(CHAIR, scene.world, np.array([1.5, -0.5, math.pi / 2]), scene.goal)
    verdict = passable(deep)  # its front is 0.75 m ahead, 0.25 m into the wall
    assert verdict.status is IMPASSABLE
    assert "does not fit at the start" in verdict.reason
    assert verdict.narrowest == pytest.approx([1.5, -0.25], abs=1e-9)


def test_the_goals_tolerance_is_part_of_the_question() -> None:
    scene = door_scene(0.9)
    pose = np.array([1.5, 0.52, math.pi / 2])  # rear end 0.27 m behind: at y = 0.25, wall to 0.1
    assert passable(Scene(CHAIR, scene.world, scene.start, Goal(pose))).status is PASSABLE
    pose = np.array([1.5, 0.30, math.pi / 2])  # 50 mm into the wall
    tight = Scene(CHAIR, scene.world, scene.start, Goal(pose, 0.04))
    loose = Scene(CHAIR, scene.world, scene.start, Goal(pose, 0.06))
    assert passable(tight, spare=False).status is IMPASSABLE
    assert passable(loose, spare=False).status is PASSABLE


def test_the_goals_heading_range_decides_where_the_body_fits_only_askew() -> None:
    walls = tuple(
        Solid.polygon(p)
        for p in ([[-3, 0.4], [3, 0.4], [3, 0.5], [-3, 0.5]], [[-3, -0.5], [3, -0.5], [3, -0.4]])
    )
    world = World(walls, (-3.0, -1.0, 3.0, 1.0))  # a corridor 0.8 m wide
    pose = np.array([1.0, 0.0, math.radians(20.0)])
    start = np.array([-1.5, 0.0, 0.0])
    for tolerance, status in ((5.0, IMPASSABLE), (18.0, PASSABLE)):
        goal = Goal(pose, 0.05, math.radians(tolerance))
        assert passable(Scene(CHAIR, world, start, goal), spare=False).status is status


@pytest.mark.slow
def test_mirroring_and_moving_the_world_changes_neither_status_nor_millimetres() -> None:
    scene = corner_scene(0.88, 1.1, 0.65, 0.2)
    before = passable(scene)
    angle, shift = 0.7, np.array([310.0, -125.0])

    def moved(pose: np.ndarray) -> np.ndarray:
        return np.append(rotate(angle, pose[:2]) + shift, pose[2] + angle)

    frame = [Solid.polygon([[4, -1], [4, 4], [5, 4], [5, -1]])]  # the bounds that matter, as walls
    frame += [Solid.polygon([[-1, 4], [-1, 5], [4, 5], [4, 4]])]
    solids = []
    for solid in (*scene.world.solids, *frame):
        corners = np.asarray(solid.shape.exterior.coords)[:-1]
        solids.append(Solid.polygon(rotate(angle, corners) + shift))
    goal = Goal(moved(scene.goal.pose))
    there = passable(Scene(scene.vehicle, World(tuple(solids)), moved(scene.start), goal))
    mirror = np.array([-1.0, 1.0])
    solids = [
        Solid.polygon(np.asarray(s.shape.exterior.coords)[:-1] * mirror) for s in scene.world.solids
    ]
    flip = lambda p: np.array([-p[0], p[1], math.pi - p[2]])  # noqa: E731
    world = World(tuple(solids), (-4.0, -1.0, 1.0, 4.0))
    mirrored = passable(Scene(scene.vehicle, world, flip(scene.start), Goal(flip(scene.goal.pose))))
    for other in (there, mirrored):
        assert other.status is before.status
        assert other.spare_m == pytest.approx(before.spare_m, abs=MILLIMETRE)
    assert before.narrowest is not None
    assert there.narrowest == pytest.approx(rotate(angle, before.narrowest) + shift, abs=0.03)


def test_a_small_window_gives_the_same_answers_as_the_whole_world(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    scenes = [door_scene(0.9), corner_scene(0.8, 1.0, 0.67)]
    whole = [passable(scene) for scene in scenes]
    monkeypatch.setattr(passage_windows, "_FEW", 0)
    for scene, expected in zip(scenes, whole, strict=True):
        verdict = passable(scene)
        assert verdict.status is expected.status
        assert verdict.spare_m == pytest.approx(expected.spare_m, abs=MILLIMETRE)


def test_no_time_means_undecided_never_a_guess() -> None:
    verdict = passable(corner_scene(0.8275, 1.0, 0.67), time_budget=0.0)
    assert verdict.status is PassageStatus.UNDECIDED
    assert "time" in verdict.reason


def test_the_proof_holds_the_start_and_not_the_goal() -> None:
    scene = door_scene(0.6)
    proof = passable(scene, spare=False).proof
    assert proof is not None

    for pose, held in ((scene.start, True), (scene.goal.pose, False)):
        place = shapely.Point(pose[:2] + rotate(pose[2], proof.pivot))
        turn = np.mod(pose[2] - proof.intervals[:, 0], 2 * math.pi)
        inside = np.flatnonzero(turn <= np.ptp(proof.intervals, axis=1) + 1e-9)
        assert any(proof.start_side[k].covers(place) for k in inside) is held


def test_a_chair_that_does_not_reverse_is_told_what_the_verdict_leaves_open() -> None:
    forward = CHAIR.with_limits(reverse_speed=0.0)
    assert "does not reverse" in passable(door_scene(0.9, vehicle=forward)).reason
    bent = Vehicle.rectangle(1.0, 0.67, 0.25, limits=Limits(curvature=2.0))
    assert "shunting" in passable(door_scene(0.9, vehicle=bent)).reason


def test_solids_that_move_are_left_out_and_the_reason_says_so() -> None:
    scene = door_scene(0.9)
    person = MovingSolid(0.3, np.array([[0.0, 0.0, 0.0]]))
    world = World(scene.world.solids, scene.world.bounds, (person,))
    verdict = passable(Scene(CHAIR, world, scene.start, scene.goal), spare=False)
    assert verdict.status is PASSABLE
    assert "solids that move are left out" in verdict.reason
