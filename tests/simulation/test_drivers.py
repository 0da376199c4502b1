"""Scripted drivers: what they see, how they steer, how their traits show."""

import dataclasses
import math

import numpy as np
import pytest

from narrows.errors import ShapeError
from narrows.reactive.smooth_motion import MotionLimits
from narrows.scene import load_vehicle
from narrows.simulation.driver_hand import LAG, Hand
from narrows.simulation.driver_hostile import HostileDriver
from narrows.simulation.driver_route import Route
from narrows.simulation.driver_sight import Sight, SightOptions, free_travel
from narrows.simulation.driver_sticks import make_stick
from narrows.simulation.driver_traits import BOUNDS, DRIVERS, Traits, by_head
from narrows.simulation.drivers import ARRIVED, ScriptedDriver
from narrows.simulation.plant import Plant, PlantOptions
from narrows.world import MovingSolid, Solid, World

CHAIR = load_vehicle("xeno")
STICK = make_stick("joystick", MotionLimits.of(CHAIR))
PERFECT = Traits(heading_noise=0.0, judgement=0.0, tremor=0.0)
ROOM = World((Solid.polygon([[5, -3], [6, -3], [6, 3], [5, 3]], name="wall"),))


def drive(driver, start, *, seconds, latency=0.1, hold=None):
    """Return times and poses of a chair that obeys a stick within its limits, 20 times a second."""
    plant = Plant(CHAIR, start, PlantOptions(latency=latency), np.random.default_rng(0))
    rows, command, dt = [], np.zeros(2), 0.05
    steps = dt * np.array([CHAIR.limits.acceleration, CHAIR.limits.yaw_acceleration])
    for k in range(round(seconds / dt)):
        left, right = plant.wheel_speeds
        motion = [0.5 * (left + right), (right - left) / CHAIR.track]
        wanted = STICK.command(driver.step(k * dt, plant.pose, motion))
        wanted = np.zeros(2) if hold and hold(k * dt) else wanted
        command = command + np.clip(wanted - command, -steps, steps)
        plant.command(*command)
        rows.append([k * dt, *plant.pose])
        for _ in range(5):
            plant.step(0.01)
        if driver.finished:
            break
    return np.array(rows)


def driver_on(places, traits=PERFECT, world=None, seed=0, **more):
    sight = Sight(world or World())
    return ScriptedDriver(
        traits, (Route(places),), sight, STICK, CHAIR, np.random.default_rng(seed), **more
    )


def test_who_wants_to_be_there_exactly_slows_down_for_the_end_of_the_way():
    ends, speeds = {}, {}
    for arrived in (ARRIVED, 0.03):
        rows = drive(driver_on([[0, 0], [4, 0.02]], arrived=arrived), [0, 0, 0], seconds=20.0)
        ends[arrived] = abs(rows[-1, 1] - 4.0)
        speeds[arrived] = (rows[-1, 1] - rows[-3, 1]) / (rows[-1, 0] - rows[-3, 0])
    assert ends[0.03] <= 0.03 < ends[ARRIVED] <= ARRIVED
    assert speeds[0.03] < 0.15 < 0.6 < speeds[ARRIVED]


def test_who_passes_beside_the_end_of_the_way_is_there_too():
    driver = driver_on([[0, 0], [3, 0]], arrived=0.02)
    rows = drive(driver, [0, 0.3, 0], seconds=20.0)
    assert driver.finished
    assert rows[-1, 1] < 3.1


def test_eight_drivers_have_names_and_all_keep_the_bounds_of_their_traits():
    assert len(DRIVERS) == 8
    assert len({dataclasses.astuple(traits) for traits in DRIVERS.values()}) == 8
    for traits in DRIVERS.values():
        by_head(traits)  # the constructor checks


def test_every_trait_has_bounds_and_is_refused_beyond_them():
    names = {field.name for field in dataclasses.fields(Traits)}
    assert names == set(BOUNDS)
    for name, (_, high) in BOUNDS.items():
        with pytest.raises(ShapeError, match=f"trait {name} must lie between"):
            Traits(**{name: high + 0.01})


def test_driving_by_head_is_slower_later_and_less_precise():
    for traits in DRIVERS.values():
        head = by_head(traits)
        assert head.pace < traits.pace
        assert head.reaction_time > traits.reaction_time
        assert head.heading_noise > traits.heading_noise
        assert head.tremor > traits.tremor


def test_a_hand_begins_to_move_after_the_reaction_time_and_is_63_percent_there_after_its_lag():
    hand = Hand(Traits(reaction_time=0.2, tremor=0.0), np.random.default_rng(0))
    hand.mean(0.0, (1.0, -0.5))
    at = np.array([hand.move(0.01 * k) for k in range(60)])
    assert (at[:20] == 0.0).all()
    share = at[19 + round(LAG / 0.01)]
    # The hand moves in steps of 10 ms, each exact: one step of tolerance.
    assert share[0] == pytest.approx(1.0 - math.exp(-1.0), abs=0.04)
    assert at[-1] == pytest.approx([1.0, -0.5], abs=0.06)


def test_a_trembling_hand_has_the_deviation_of_its_trait():
    hand = Hand(Traits(tremor=0.1), np.random.default_rng(1))
    at = np.array([hand.move(0.1 * k) for k in range(4000)])
    assert at.std() == pytest.approx(0.1, rel=0.05)  # 8000 values of memory 0.1 s: 2 % each way


def test_what_is_hidden_or_behind_is_not_seen():
    near = Solid.polygon([[1.9, -0.5], [2.0, -0.5], [2.0, 0.5], [1.9, 0.5]])
    hidden = Solid.polygon([[2.4, -0.2], [2.5, -0.2], [2.5, 0.2], [2.4, 0.2]])
    behind = Solid.circle(-2.0, 0.0, 0.2)
    eyes = Sight(World((near, hidden, behind)))
    seen = eyes.look(0.0, [0.0, 0.0, 0.0])
    assert (seen[:, 0] < 2.1).all()
    assert (seen[:, 0] > 1.8).any()
    assert (seen[:, 0] > -1.5).all()
    over_shoulder = eyes.look(0.0, [0.0, 0.0, 0.0], behind=True)
    # The nearest of a circle of 0.2 m at -2 m is at -1.8 m.
    assert over_shoulder[:, 0].max() == pytest.approx(-1.8, abs=1e-9)


def test_somebody_who_walks_is_seen_where_they_are():
    walker = MovingSolid(0.25, [[0.0, 2.0, 0.0], [10.0, 3.0, 0.0]])
    eyes = Sight(World(moving=(walker,)), SightOptions(eye=0.0))
    assert eyes.look(0.0, [0, 0, 0])[:, 0].min() == pytest.approx(1.75)
    assert eyes.look(5.0, [0, 0, 0])[:, 0].min() == pytest.approx(2.25)
    assert eyes.look(5.0, [0, 0, math.pi / 2])[:, 1].max() == pytest.approx(
        -2.25, abs=5e-3
    )  # no ray of the fan of 3 degrees points exactly there


def test_free_travel_is_the_distance_to_what_the_front_meets():
    body = np.array([-0.25, 0.85, -0.33, 0.33])
    points = np.array([[1.85, 0.0], [0.5, 0.4], [-1.25, 0.2]])
    twists = np.array([[1.0, 0.0], [-1.0, 0.0], [0.0, 1.0], [0.0, -1.0]])
    travel = free_travel(points, body, twists, 0.05, 40)
    # One step short at most. The side gets to (0.5, 0.4) where 0.4 cos a - 0.5 sin a = 0.33;
    # the other way round the rear's corner, 0.41 m from the axle, does not reach that far.
    assert travel == pytest.approx([1.0, 1.0, 0.135, 2.0], abs=0.051)


def test_a_route_keeps_its_places_and_rounds_its_corners():
    route = Route([[0, 0], [2, 0], [2, 3]], rounding=0.5)
    # A quarter circle saves (2 - pi / 2) radii.
    assert route.length == pytest.approx(5.0 - (2.0 - math.pi / 2.0) * 0.5, abs=2e-3)
    assert route.at(0.0) == pytest.approx((0.0, 0.0))
    assert route.at(route.length) == pytest.approx((2.0, 3.0))
    assert route.bend(1.5 + 0.1, 0.4) == pytest.approx(2.0, rel=0.02)
    assert route.progress_of(1.0, 0.3, near=1.2) == pytest.approx(1.0, abs=0.011)


def test_a_route_says_what_is_wrong_with_it():
    with pytest.raises(ShapeError, match="two places"):
        Route([[0, 0]])
    with pytest.raises(ShapeError, match="1 corners need as many radii"):
        Route([[0, 0], [1, 0], [2, 1]], [0.5, 0.5])


def test_a_driver_without_errors_returns_to_the_way_and_arrives():
    driver = driver_on([[0, 0], [6, 0]])
    rows = drive(driver, [0.0, 0.3, 0.0], seconds=30.0)
    assert driver.finished
    assert abs(rows[-1, 2]) < 0.01
    assert rows[:, 2].min() > -0.05  # and does not swing over it


def test_over_steering_swings():
    def swing(factor):
        driver = driver_on([[0, 0], [6, 0]], dataclasses.replace(PERFECT, over_steer=factor))
        return -drive(driver, [0.0, 0.4, 0.0], seconds=30.0)[:, 2].min()

    assert swing(1.9) > swing(1.0) + 0.01


def test_a_driver_turns_on_the_spot_when_the_way_is_behind():
    driver = driver_on([[0, 0], [-4, 0]])
    rows = drive(driver, [0.0, 0.0, 0.0], seconds=40.0)
    assert driver.finished
    away = np.hypot(rows[:, 1], rows[:, 2])[np.abs(rows[:, 3]) < 2.0]
    assert away.max() < 0.1


def test_a_driver_stops_before_a_wall_across_the_way():
    driver = driver_on([[0, 0], [9, 0]], world=ROOM)
    rows = drive(driver, [0.0, 0.0, 0.0], seconds=12.0)
    assert not driver.finished
    assert 3.0 < rows[:, 1].max() + CHAIR.front_overhang < 5.0


def test_a_driver_whose_chair_does_not_move_backs_off():
    driver = driver_on([[0, 0], [6, 0]])
    rows = drive(driver, [0.0, 0.0, 0.0], seconds=10.0, hold=lambda time: 3.0 < time < 7.0)
    speed = np.gradient(rows[:, 1], rows[:, 0])
    assert speed.min() < -0.1


def test_a_lapse_leaves_the_hand_where_it_is():
    dreamy = dataclasses.replace(PERFECT, lapse_rate=0.2, lapse_time=2.0)
    ways = [
        drive(driver_on([[0, 0], [3, 0], [3, 3]], traits), [0, 0, 0], seconds=30.0)
        for traits in (PERFECT, dreamy)
    ]
    assert len(ways[0]) != len(ways[1]) or not np.allclose(ways[0], ways[1])


def test_the_same_seed_is_the_same_drive_and_another_is_another():
    def way(seed):
        return drive(driver_on([[0, 0], [3, 0]], DRIVERS["shaky"], seed=seed), [0, 0, 0], seconds=9)

    assert (way(3) == way(3)).all()
    assert not np.array_equal(way(3), way(4))


def test_a_hostile_driver_drives_into_the_wall():
    driver = HostileDriver(Sight(ROOM), np.random.default_rng(2))
    rows = drive(driver, [0.0, 0.0, 0.0], seconds=40.0)
    assert rows[:, 1].max() + CHAIR.front_overhang > 5.0
    assert not driver.finished
