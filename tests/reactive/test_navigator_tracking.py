"""A planned path under guard: somebody in the way stops the chair, a cleared way lets it go on."""

import math

import numpy as np
import pytest

from narrows.clearance import clearance_at
from narrows.errors import ShapeError
from narrows.interfaces import Percept
from narrows.path import Path
from narrows.reactive.navigator_guard_options import GuardOptions
from narrows.reactive.navigator_known import KnownSolids
from narrows.reactive.navigator_tracking import GuardedTracker
from narrows.scene import Goal, Scene
from narrows.simulation.judge import judge
from narrows.simulation.named_senses import Silenced
from narrows.simulation.senses import IdealSenses
from narrows.simulation.simulator import SimulationOptions, simulate
from narrows.tracking.registry import make_tracker
from narrows.vehicle import Vehicle
from narrows.world import MovingSolid, Solid, World

CHAIR = Vehicle.rectangle(1.0, 0.67, 0.25)
PATH = Path.from_poses([[-1.5, 0, 0], [2.5, 0, 0]])
WALLS = {
    width: (
        Solid.polygon([[0.5, width / 2], [0.6, width / 2], [0.6, 2], [0.5, 2]], name="left jamb"),
        Solid.polygon([[0.5, -2], [0.6, -2], [0.6, -width / 2], [0.5, -width / 2]], name="right"),
    )
    for width in (0.72, 0.77, 0.87)
}


def drive(world, *, unforeseen=(), moving=(), patience=60.0, limit=40.0, path=None):
    whole = World((*world, *unforeseen), moving=moving)
    scene = Scene(CHAIR, whole, PATH.start, Goal(PATH.goal))
    options = SimulationOptions(period=0.05, time_limit=limit)
    controller = GuardedTracker(
        make_tracker("lookahead", PATH, CHAIR),
        CHAIR,
        GuardOptions(deceleration=0.6),
        known=KnownSolids(World(world)),
        path=path,
        patience=patience,
    )
    record = simulate(scene, controller, senses=IdealSenses(whole), reference=PATH, options=options)
    return controller, record, judge(scene, record)


@pytest.mark.parametrize("width", [0.72, 0.77, 0.87])
def test_a_door_five_to_twenty_centimetres_wider_is_passed_without_a_stop(width):
    controller, record, verdict = drive(WALLS[width])
    assert verdict.reached
    assert controller.arrived
    assert record.signals["waits"][record.times < 10.0].max() == 0.0
    assert verdict.min_clearance > (width - 0.67) / 2 - 5e-3


def test_a_box_left_in_the_door_stops_the_chair_before_it_until_it_gives_up():
    box = Solid.polygon(
        [[0.5, -0.1], [0.7, -0.1], [0.7, 0.1], [0.5, 0.1]], z=(0.0, 0.3), name="box"
    )
    controller, record, verdict = drive(WALLS[0.87], unforeseen=(box,), patience=5.0)
    assert controller.finished
    assert not controller.arrived
    assert "gave up after 5 s: something is in the way" in controller.reason
    assert not verdict.contacts
    assert 0.0 < verdict.min_clearance < 0.15  # it came near, no wider berth than it needs
    assert abs(record.wheel_speeds[-1]).max() < 1e-2


def test_on_its_path_it_stands_back_from_what_is_left_there():
    box = Solid.polygon([[0.5, -0.1], [0.7, -0.1], [0.7, 0.1], [0.5, 0.1]], z=(0.0, 0.3))
    controller, _, verdict = drive(WALLS[0.87], unforeseen=(box,), patience=5.0, path=PATH)
    assert "gave up after 5 s: something is in the way" in controller.reason
    berth = GuardOptions().berth
    assert berth - 0.25 < verdict.min_clearance < berth  # it brakes when the box is half a metre on


def test_what_stands_beside_its_path_does_not_hold_it_up():
    post = Solid.circle(-0.2, 0.335 + 0.08 + 0.1, 0.1, name="a post 8 cm beside the way")
    _, _, verdict = drive(WALLS[0.87], unforeseen=(post,), path=PATH)
    assert verdict.reached
    assert verdict.min_clearance == pytest.approx(0.08, abs=0.01)


def test_a_chair_that_brakes_in_a_bend_stays_on_its_path():
    """The bend ends before it stands: braking on the arc of the last command leads 11 mm off."""
    turns = np.linspace(0.0, 1.0, 30)
    bend = np.column_stack([0.5 * np.sin(turns), 0.5 * (1 - np.cos(turns)), turns])
    end = bend[-1] + np.array([math.cos(1.0), math.sin(1.0), 0.0])
    path = Path.from_poses([[-1.0, 0.0, 0.0], *bend, end])
    tracker = make_tracker("lookahead", path, CHAIR)
    controller = GuardedTracker(tracker, CHAIR, GuardOptions(deceleration=0.6), path=path)
    scene = Scene(CHAIR, World(), path.start, Goal(path.goal))
    silent = Silenced(IdealSenses(scene.world), ((4.2, math.inf),))
    options = SimulationOptions(period=0.05, time_limit=8.0)
    record = simulate(scene, controller, senses=silent, reference=path, options=options)
    braking = (record.commands[:, 0] > 1e-3) & (record.times > 4.6)
    assert 0.0 < record.poses[braking, 2].min() < record.poses[-1, 2] < 1.0 + 1e-2  # in the bend
    assert np.abs(record.wheel_speeds[-1]).max() < 1e-3
    assert np.abs(record.cross_track).max() < 5e-3


def test_somebody_who_steps_into_the_door_stops_it_and_a_cleared_door_lets_it_go_on():
    walks = [[0, 1.5, 1.5], [2, 1.5, 1.5], [4, 0.8, 0], [10, 0.8, 0], [13, 1.5, 1.8]]
    controller, record, verdict = drive(
        WALLS[0.87], moving=(MovingSolid(0.25, np.array(walks, dtype=float), (0.0, 1.8), "she"),)
    )
    coming = (record.times > 3.5) & (record.times < 7.0)
    assert np.abs(record.wheel_speeds[coming]).max() < 1e-3
    assert record.signals["waits"][coming].all()
    there = record.times < 10.0  # once she has stood for a while it comes nearer, as to a thing
    assert record.poses[there, 0].max() + CHAIR.front_overhang < 0.8 - 0.25
    assert not verdict.contacts
    assert verdict.reached
    assert controller.arrived


def test_without_a_guard_the_same_drive_hits_her():
    walks = [[0, 1.5, 1.5], [2, 1.5, 1.5], [4, 0.8, 0], [10, 0.8, 0], [13, 1.5, 1.8]]
    world = World(WALLS[0.87], moving=(MovingSolid(0.25, np.array(walks, dtype=float)),))
    scene = Scene(CHAIR, world, PATH.start, Goal(PATH.goal))
    record = simulate(scene, make_tracker("lookahead", PATH, CHAIR), reference=PATH)
    meets = np.hypot(*(record.poses[:, :2] + [0.25, 0.0] - [0.8, 0.0]).T) < 0.5
    assert (meets & (record.times > 4.0) & (record.times < 10.0)).any()


def test_a_chair_badly_off_its_path_is_stopped_by_a_wall_it_knows():
    known = KnownSolids(World(WALLS[0.72]))
    controller = GuardedTracker(
        make_tracker("lookahead", PATH, CHAIR), CHAIR, GuardOptions(trusted_after=0.0), known=known
    )
    senses = IdealSenses(World(WALLS[0.72]))
    pose, command = np.array([-0.4, 0.2, 0.0]), np.ones(2)  # 0.2 m aside in a door of 25 mm a side
    for k in range(400):
        command = controller.step(0.05 * k, pose, senses.perceive(0.05 * k, pose, pose))
        v, omega = command
        pose = pose + 0.05 * np.array([v * math.cos(pose[2]), v * math.sin(pose[2]), omega])
    assert abs(command[0]) < 1e-3
    depth = clearance_at(World(WALLS[0.72]), CHAIR, pose[None])[0][0]
    assert -0.035 < depth < 0.0  # 30 mm may be an error of the sensors


def test_known_solids_are_told_by_place():
    known = KnownSolids(World((Solid.circle(1.0, 0.0, 0.5), *WALLS[0.87])))
    points = [
        [1.5, 0.0, 0.3],
        [1.53, 0.0, 0.3],
        [1.7, 0.0, 0.3],
        [0.55, 1.0, 1.0],
        [90.0, 0.0, 0.0],
    ]
    np.testing.assert_array_equal(known(points), [True, True, False, True, False])
    np.testing.assert_array_equal(known(points), [True, True, False, True, False])  # looked up
    assert not KnownSolids(World())([[0.0, 0.0]]).any()


def test_it_refuses_to_wait_for_no_time():
    with pytest.raises(ShapeError, match="patience"):
        GuardedTracker(make_tracker("lookahead", PATH, CHAIR), CHAIR, patience=0.0)


def test_silent_sensors_stop_it_on_its_path():
    controller = GuardedTracker(make_tracker("lookahead", PATH, CHAIR), CHAIR)
    pose = np.array([-1.5, 0.0, 0.0])
    nothing = np.zeros((0, 3))
    for k in range(40):
        v = controller.step(0.05 * k, pose, Percept(0.05 * k, nothing))[0]
        pose[0] += 0.05 * v
    assert v > 0.3
    for k in range(40, 70):
        v = controller.step(0.05 * k, pose, Percept(1.95, nothing))[0]
    assert v == 0.0
    assert "silent" in controller.reason
