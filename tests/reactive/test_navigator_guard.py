"""The guard's promise: the chair brakes before all that its body would sweep over."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from narrows.errors import ShapeError
from narrows.interfaces import Percept
from narrows.reactive.navigator_guard import Guard
from narrows.reactive.navigator_guard_options import GuardOptions
from narrows.scene import Goal, Scene
from narrows.simulation.judge import judge
from narrows.simulation.plant import PlantOptions
from narrows.simulation.senses import IdealSenses
from narrows.simulation.simulator import SimulationOptions, simulate
from narrows.vehicle import Layer, Vehicle
from narrows.world import MovingSolid, Solid, World

CHAIR = Vehicle.rectangle(1.2, 0.7, 0.25)
NOTHING = np.zeros((0, 3))
FAR = Percept(0.0, NOTHING)
TRUSTING = GuardOptions(trusted_after=0.0)
PERIOD = TRUSTING.period


class Hostile:
    """Wants to drive anywhere at full speed, something else every second; guarded."""

    progress, finished, signals, wanted = 0.0, False, {}, (0.0, 0.0)

    def step(self, time, pose, percept):
        if abs(time - round(time)) < 1e-6:
            self.wanted = self.rng.uniform([-0.4, -1.2], [0.8, 1.2])
        return self.guard.limit(time, pose, percept, self.wanted)


def walled(rng, moving=()):
    """A closed room of 5 x 5 m with five posts and boxes."""
    solids = [
        Solid.polygon([[-2.6, a], [2.6, a], [2.6, b], [-2.6, b]], name="a wall")
        for a, b in ((-2.6, -2.5), (2.5, 2.6))
    ]
    solids += [
        Solid.polygon([[a, -2.5], [b, -2.5], [b, 2.5], [a, 2.5]], name="a wall")
        for a, b in ((-2.6, -2.5), (2.5, 2.6))
    ]
    while len(solids) < 9:
        x, y = rng.uniform(-2.3, 2.3, 2)
        if math.hypot(x, y) > 1.4:
            solids.append(Solid.circle(x, y, rng.uniform(0.05, 0.3)))
    return World(tuple(solids), moving=tuple(moving))


def hostile_drive(seed, *, guard, plant, moving=(), duration=12.0):
    rng = np.random.default_rng(seed)
    world = walled(rng, moving)
    scene = Scene(CHAIR, world, np.array([-0.3, 0.0, 0.0]), Goal([9.0, 0.0, 0.0]))
    options = SimulationOptions(period=PERIOD, time_limit=duration, plant=plant)
    driver = Hostile()
    driver.guard, driver.rng = Guard(CHAIR, guard), rng
    record = simulate(scene, driver, senses=IdealSenses(world), options=options)
    return record, judge(scene, record)


PLANTS = {
    "nominal": (PlantOptions(), TRUSTING),
    "late": (PlantOptions(latency=0.15), GuardOptions(latency=0.15, trusted_after=0.0)),
    "sluggish": (PlantOptions(motor_lag=0.2), GuardOptions(lag=0.2, trusted_after=0.0)),
}


@pytest.mark.parametrize("name", PLANTS)
@pytest.mark.parametrize("seed", range(4))
def test_a_hostile_driver_touches_nothing_that_stands(name, seed):
    plant, guard = PLANTS[name]
    record, verdict = hostile_drive(seed, guard=guard, plant=plant)
    assert not verdict.contacts
    assert record.length > 0.3  # it does drive


@pytest.mark.slow
@pytest.mark.parametrize("name", PLANTS)
def test_a_hostile_driver_touches_nothing_in_many_rooms(name):
    plant, guard = PLANTS[name]
    for seed in range(100, 120):
        _, verdict = hostile_drive(seed, guard=guard, plant=plant)
        assert not verdict.contacts, seed


def test_a_guard_that_does_not_know_of_the_latency_fails():
    plant = PlantOptions(latency=0.4)
    hit = [bool(hostile_drive(k, guard=TRUSTING, plant=plant)[1].contacts) for k in range(6)]
    assert any(hit)


def walker(rng):
    """Somebody who walks through the room at most as fast as the guard reckons with."""
    time, place = 0.0, rng.uniform(-2.2, 2.2, 2)
    while np.hypot(*place) < 1.6:
        place = rng.uniform(-2.2, 2.2, 2)
    rows = [[time, *place]]
    for _ in range(8):
        goal = rng.uniform(-2.2, 2.2, 2)
        time += np.hypot(*(goal - place)) / rng.uniform(0.4, 1.4) + 1e-3
        rows.append([time, *goal])
        place = goal
    return MovingSolid(0.25, np.array(rows), (0.0, 1.8))


@pytest.mark.slow
def test_who_walks_meets_only_a_chair_that_stands():
    walked = 0
    for seed in range(8):
        people = [walker(np.random.default_rng([seed, k])) for k in range(2)]
        guard = GuardOptions(trusted_after=4.0)
        _, verdict = hostile_drive(seed, guard=guard, plant=PlantOptions(), moving=people)
        assert not verdict.collisions, seed
        walked += len(verdict.walked_into)
    assert walked > 0  # they do come


def drive_straight(guard, percepts, wanted=(0.6, 0.0)):
    """Drive a chair that obeys exactly by what the guard lets pass; return its poses."""
    pose, poses = np.zeros(3), []
    for k, percept in enumerate(percepts):
        v, omega = guard.limit(k * PERIOD, pose, percept(k * PERIOD, pose), wanted)
        pose = pose + PERIOD * np.array([v * math.cos(pose[2]), v * math.sin(pose[2]), omega])
        poses.append(pose)
    return np.array(poses)


def wall_at(x):
    def percept(time, pose):
        y = np.arange(-0.5, 0.5, 0.02)
        return Percept(time, np.column_stack([x - pose[0] + 0 * y, y, 0.5 + 0 * y]))

    return percept


@given(st.floats(0.2, 0.8), st.floats(1.2, 3.0))
@settings(deadline=None, max_examples=15)
def test_it_stops_before_a_wall_by_its_margin_and_not_much_sooner(speed, distance):
    guard = Guard(CHAIR, GuardOptions(trusted_after=0.0, margin=0.03))
    poses = drive_straight(guard, [wall_at(distance)] * 300, (speed, 0.0))
    gap = distance - (poses[-1, 0] + CHAIR.front_overhang)
    assert gap >= 0.03 - 1e-9
    assert gap < 0.03 + 0.04  # looks are 30 mm apart; a tenth of the speed takes what is left
    assert guard.share == 0.0
    assert "something is in the way" in guard.reason


def test_when_the_sensors_fall_silent_it_stops_within_the_braking_distance():
    guard = Guard(CHAIR, TRUSTING)
    drive_straight(guard, [lambda t, p: Percept(t, NOTHING)] * 60)
    last = 59 * PERIOD
    twist, stopped = guard.twist, []
    assert twist[0] == pytest.approx(0.6, abs=1e-3)
    way, v = 0.0, 0.6
    for k in range(60, 120):
        v = guard.limit(k * PERIOD, [0, 0, 0], Percept(last, NOTHING), [0.6, 0.0])[0]
        way += v * PERIOD
        stopped.append(v == 0.0)
    assert stopped[-1]
    assert "silent" in guard.reason
    allowed = 0.6 * TRUSTING.oldest + guard.stopping_distance(0.6)
    assert way <= allowed
    fresh = Percept(120 * PERIOD, NOTHING)
    assert guard.limit(120 * PERIOD, [0, 0, 0], fresh, [0.6, 0.0])[0] > 0.0


def test_it_does_not_move_before_anything_was_seen():
    guard = Guard(CHAIR)
    assert not guard.limit(0.0, [0, 0, 0], Percept(-math.inf, NOTHING), [0.5, 0.5]).any()
    assert guard.reason == "nothing has been seen yet"


def test_what_has_just_come_into_view_may_walk_and_is_furniture_after_a_while():
    guard = Guard(CHAIR, GuardOptions(trusted_after=2.0))
    beside = Percept(0.0, np.array([[0.3, 0.55, 0.5]]))  # 0.2 m to the left
    commands = [
        guard.limit(k * PERIOD, [0, 0, 0], Percept(k * PERIOD, beside.points), [0.3, 0.0])[0]
        for k in range(80)
    ]
    assert max(commands[:39]) == 0.0
    assert commands[-1] > 0.1


def test_a_point_between_two_cells_becomes_furniture_too():
    guard = Guard(CHAIR, GuardOptions(trusted_after=2.0))
    commands = []
    for k in range(80):
        points = np.array([[0.3 + (1e-3 if k % 4 < 2 else -1e-3), 0.55, 0.5]])
        commands.append(
            guard.limit(k * PERIOD, [0, 0, 0], Percept(k * PERIOD, points), [0.3, 0])[0]
        )
    assert commands[-1] > 0.1


def test_something_in_the_body_forbids_any_motion():
    guard = Guard(CHAIR, TRUSTING)
    inside = Percept(0.0, np.array([[0.3, 0.1, 0.5]]))
    for wanted in ([0.3, 0.0], [-0.3, 0.0], [0.0, 0.5]):
        assert not guard.limit(0.0, [0, 0, 0], inside, wanted).any()


def test_it_may_leave_what_is_nearer_than_its_margin_but_not_approach_it():
    near = np.array([[0.95 + 0.02, 0.0, 0.5]])
    assert Guard(CHAIR, TRUSTING).limit(0.0, [0, 0, 0], Percept(0.0, near), [0.3, 0.0])[0] == 0.0
    assert Guard(CHAIR, TRUSTING).limit(0.0, [0, 0, 0], Percept(0.0, near), [-0.3, 0.0])[0] < 0.0


def test_heights_count_layer_by_layer():
    chair = Vehicle(
        layers=(
            Layer([[-0.25, -0.32], [0.8, -0.32], [0.8, 0.32], [-0.25, 0.32]], (0.0, 0.68)),
            Layer([[-0.2, -0.28], [0.28, -0.28], [0.28, 0.28], [-0.2, 0.28]], (0.68, 1.3)),
        ),
        track=0.56,
    )
    y = np.arange(-0.5, 0.5, 0.02)
    for height, expected in ((0.5, 0.8), (0.74, 0.28), (1.4, -math.inf)):

        def percept(time, pose, height=height):
            points = np.column_stack([1.5 - pose[0] + 0 * y, y, height + 0 * y])
            return Percept(time, points)

        poses = drive_straight(Guard(chair, TRUSTING), [percept] * 200, (0.4, 0.0))
        if math.isinf(expected):
            assert poses[-1, 0] > 3.0  # passes under
        else:
            assert poses[-1, 0] + expected == pytest.approx(1.45, abs=0.03)


def test_unknown_places_are_never_taken_for_free():
    guard = Guard(CHAIR, TRUSTING)
    unknown = np.column_stack([np.full(20, 1.0), np.linspace(-0.4, 0.4, 20)])
    command = guard.limit(0.0, [0, 0, 0], Percept(0.0, NOTHING, 0.02, unknown), [0.3, 0.0])
    assert command[0] == 0.0


def test_a_share_keeps_the_curve_and_the_rates():
    guard = Guard(CHAIR, TRUSTING)
    before = np.zeros(2)
    for k in range(30):
        command = guard.limit(k * PERIOD, [0, 0, 0], Percept(k * PERIOD, NOTHING), [0.5, 0.25])
        assert command[1] == pytest.approx(0.5 * command[0])
        rates = np.abs(command - before) / PERIOD
        assert rates[0] <= TRUSTING.deceleration + 1e-9
        assert rates[1] <= TRUSTING.yaw_deceleration + 1e-9
        before = command
    np.testing.assert_allclose(before, [0.5, 0.25])


def approached(reach):
    """Drive towards somebody who comes at 1.4 m/s, seen from 3 m away; return the contacts."""
    person = MovingSolid(0.25, np.array([[0.0, 9.0, 0.0], [12.0, -7.8, 0.0]]), (0.0, 1.8), "she")
    scene = Scene(CHAIR, World(moving=(person,)), np.zeros(3), Goal([9.0, 0.0, 0.0]))
    driver = Hostile()
    driver.guard = Guard(CHAIR, GuardOptions(reach=reach))
    driver.step = lambda time, pose, percept: driver.guard.limit(time, pose, percept, [0.8, 0.0])
    options = SimulationOptions(period=PERIOD, time_limit=8.0)
    record = simulate(scene, driver, senses=IdealSenses(scene.world), options=options)
    return judge(scene, record)


def test_who_comes_from_beyond_what_is_seen_meets_a_chair_that_stands():
    told = approached(3.0)
    assert told.walked_into
    assert not told.collisions
    assert approached(math.inf).collisions  # it drove faster than it could see


def test_other_commands_are_tried_where_no_share_passes():
    guard = Guard(CHAIR, TRUSTING)
    ahead = Percept(0.0, np.array([[0.97, 0.0, 0.5]]))
    command = guard.limit(0.0, [0, 0, 0], ahead, [0.3, 0.0], otherwise=([-0.1, 0.0],))
    assert command[0] < 0.0
    assert guard.share == 0.0


def test_wrong_numbers_are_refused():
    with pytest.raises(ShapeError, match="deceleration"):
        GuardOptions(deceleration=0.0)
    with pytest.raises(ShapeError, match="margin"):
        GuardOptions(margin=-0.1)
    with pytest.raises(ShapeError, match="shares"):
        GuardOptions(shares=(0.5, 0.8))
    with pytest.raises(ShapeError, match="finite"):
        Guard(CHAIR).limit(0.0, [0, 0, 0], FAR, [math.nan, 0.0])
