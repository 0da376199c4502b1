"""The navigator: arrives, passes under, gives up with a reason, keeps the chair's limits."""

import math
from dataclasses import replace

import numpy as np
import pytest

from narrows.errors import ShapeError
from narrows.interfaces import Percept
from narrows.reactive.navigator import Navigator, NavigatorOptions
from narrows.reactive.navigator_guard_options import GuardOptions
from narrows.reactive.navigator_persistence import PersistenceOptions
from narrows.reactive.switching import Active, Switch, Thresholds
from narrows.scene import Goal, Scene
from narrows.simulation.judge import judge
from narrows.simulation.senses import IdealSenses
from narrows.simulation.simulator import SimulationOptions, simulate
from narrows.vehicle import Vehicle
from narrows.world import Solid, World

CHAIR = Vehicle.rectangle(1.0, 0.65, 0.25, height=1.0, track=0.55)
NOTHING = np.zeros((0, 3))


def box(x, y, size, z, name="a box"):
    a = 0.5 * size
    return Solid.polygon(
        [[x - a, y - a], [x + a, y - a], [x + a, y + a], [x - a, y + a]], z=z, name=name
    )


def drive(solids, *, goal=(3.0, 0.0), options=None, limit=90.0, vehicle=CHAIR):
    world = World(tuple(solids))
    scene = Scene(vehicle, world, np.array([-2.0, 0.0, 0.0]), Goal([*goal, 0.0], 0.2, math.pi))
    navigator = Navigator(vehicle, goal, options)
    record = simulate(
        scene,
        navigator,
        senses=IdealSenses(world),
        options=SimulationOptions(step=0.05, period=0.05, time_limit=limit),
    )
    return navigator, record, judge(scene, record)


def test_it_goes_round_a_post_in_its_way():
    navigator, record, verdict = drive([Solid.circle(0.5, 0.1, 0.3)])
    assert navigator.arrived
    assert verdict.reached
    assert verdict.min_clearance > 0.1
    assert (record.signals["active"] == Active.ZONE).any()
    assert record.signals["switches"][-1] >= 2


def test_it_passes_under_what_is_high_enough_and_round_what_is_not():
    under, straight, over = drive([box(0.5, 0.0, 0.6, (1.1, 1.4))])
    assert under.arrived
    assert over.reached
    assert np.abs(straight.poses[:, 1]).max() < 1e-6
    around, turned, verdict = drive([box(0.5, 0.0, 0.6, (0.75, 1.4))])
    assert around.arrived
    assert verdict.reached
    assert np.abs(turned.poses[:, 1]).max() > 0.5


def test_commands_keep_the_chairs_limits():
    _, record, _ = drive([Solid.circle(0.5, 0.1, 0.3)])
    v, omega = record.commands.T
    limits = CHAIR.limits
    assert v.max() <= limits.speed
    assert np.abs(omega).max() <= limits.yaw_rate + 1e-9
    assert np.abs(v * omega).max() <= limits.lateral_acceleration + 1e-9
    assert np.diff(v).max() <= limits.acceleration * 0.05 + 1e-9
    assert np.diff(v).min() >= -0.8 * 0.05 - 1e-9  # the guard's braking


def test_a_closed_room_ends_in_stuck_with_a_reason_and_without_contact():
    walls = [
        Solid.polygon([[-3.1, a], [-0.5, a], [-0.5, b], [-3.1, b]])
        for a, b in ((-0.8, -0.7), (0.7, 0.8))
    ]
    walls += [
        Solid.polygon([[a, -0.8], [b, -0.8], [b, 0.8], [a, 0.8]])
        for a, b in ((-3.2, -3.1), (-0.5, -0.4))
    ]
    options = NavigatorOptions(persistence=PersistenceOptions(patience=2.0, endurance=40.0))
    navigator, record, verdict = drive(walls, options=options)
    assert navigator.finished
    assert not navigator.arrived
    assert navigator.reason.startswith(("stuck", "comes no nearer"))
    assert not verdict.contacts
    assert np.abs(record.wheel_speeds[-1]).max() < 1e-2
    assert record.signals["active"][-1] == Active.STOPPED


def test_a_chair_that_may_not_reverse_does_not_back_off():
    vehicle = replace(CHAIR, limits=replace(CHAIR.limits, reverse_speed=0.0))
    wall = Solid.polygon([[-0.5, -3], [-0.4, -3], [-0.4, 3], [-0.5, 3]])
    options = NavigatorOptions(persistence=PersistenceOptions(patience=2.0, endurance=20.0))
    _, record, _ = drive([wall], options=options, vehicle=vehicle, limit=40.0)
    assert record.commands[:, 0].min() >= 0.0
    assert not (record.signals["active"] == Active.BACKING).any()


def test_it_goes_through_a_gap_narrower_than_its_zone_without_turning_away():
    """The zone at rest is 1.4 m wide; the chair of 0.65 m fits between posts 1.1 m apart."""
    posts = [Solid.circle(0.5, side * 0.8, 0.25) for side in (-1, 1)]
    navigator, record, verdict = drive(posts)
    assert navigator.arrived
    assert not verdict.contacts
    assert (record.signals["active"] == Active.ZONE).any()
    assert np.abs(record.poses[:, 1]).max() < 0.15
    assert record.length < 5.1


def test_near_its_target_it_docks_beside_what_stands_there():
    navigator, _, verdict = drive([Solid.circle(3.0, 0.75, 0.2), Solid.circle(3.7, -0.6, 0.2)])
    assert navigator.arrived
    assert not verdict.contacts


def steps(navigator, percept, count, pose=(0.0, 0.0, 0.0)):
    return [navigator.step(0.05 * k, pose, percept(0.05 * k)) for k in range(count)]


def test_it_stops_when_the_sensors_fall_silent():
    navigator = Navigator(CHAIR, [5.0, 0.0])
    commands = steps(navigator, lambda time: Percept(min(time, 1.5), NOTHING), 60)
    assert max(v for v, _ in commands) > 0.4
    assert commands[-1][0] == 0.0
    assert "silent" in navigator.guard.reason


def test_at_its_target_it_has_finished_at_once():
    navigator = Navigator(CHAIR, [0.05, 0.0])
    assert not steps(navigator, lambda time: Percept(time, NOTHING), 1)[0].any()
    assert navigator.arrived
    assert navigator.finished
    assert navigator.reason.startswith("arrived")


def test_signals_keep_their_names():
    navigator = Navigator(CHAIR, [5.0, 0.0])
    steps(navigator, lambda time: Percept(time, NOTHING), 1)
    names = tuple(navigator.signals)
    assert names == ("intrusion", "active", "switches", "guard_share", "target_distance")
    assert navigator.progress == 0.0


def test_knowing_that_somebody_comes_slows_it_more_than_that_they_go():
    points = np.array([[1.4, y, 0.5] for y in np.arange(-0.2, 0.2, 0.02)])
    options = NavigatorOptions(guard=GuardOptions(walking=0.0, trusted_after=0.0), creep=0.0)
    ends = {}
    for approach in (1.0, -1.0):
        navigator = Navigator(
            CHAIR,
            [5.0, 0.0],
            options,
            velocities=lambda time, rows, v=approach: np.tile([v, 0.0], (len(rows), 1)),
        )
        steps(navigator, lambda time: Percept(time, NOTHING), 30)
        for k in range(30, 34):
            ends[approach] = navigator.step(0.05 * k, [0, 0, 0], Percept(0.05 * k, points))[0]
    assert ends[-1.0] < ends[1.0]


def test_thresholds_in_the_wrong_order_are_refused():
    with pytest.raises(ShapeError, match="left at a smaller intrusion than it is entered at"):
        Thresholds(enter=0.1, leave=0.2)


def test_the_switch_has_a_hysteresis():
    switch = Switch(Thresholds(enter=0.2, leave=0.1))
    seen = [switch.update(value) for value in (0.0, 0.15, 0.25, 0.15, 0.11, 0.05, 0.15)]
    goal, zone = Active.GOAL, Active.ZONE
    assert seen == [goal, goal, zone, zone, zone, goal, goal]
    assert switch.count == 2


def test_wrong_numbers_are_refused():
    with pytest.raises(ShapeError, match="target"):
        Navigator(CHAIR, [math.nan, 0.0])
    with pytest.raises(ShapeError, match="arrival"):
        NavigatorOptions(arrival=0.0)
    with pytest.raises(ShapeError, match="creep"):
        NavigatorOptions(creep=-0.1)
