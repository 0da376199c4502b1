"""What the assistant promises, on simulated drives: the true body among true obstacles."""

import math
from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from narrows.reactive.assistant_options import AssistantOptions, AssistantState
from narrows.reactive.smooth_motion import MotionLimits, Smooth, SmoothMotion
from narrows.se2 import transform
from narrows.simulation.plant import PlantOptions
from narrows.vehicle import Limits, Vehicle

LIMITS = MotionLimits()  # those of the chair
PERIOD = 0.02
NOTHING = np.zeros((0, 2))


def random_room(rng, simulated, vehicle):
    """Return points of a closed room full of boxes, and a start that touches none."""
    polygons = [simulated.box(-2.6, 2.6, -2.6, 2.6)]
    for _ in range(rng.integers(2, 10)):
        half = 0.5 * rng.uniform(0.05, 0.6, 2)
        corners = np.array([[-1, -1], [1, -1], [1, 1], [-1, 1]]) * half
        polygons.append(transform([*rng.uniform(-2.5, 2.5, 2), rng.uniform(0, 3)], corners))
    points = simulated.outlines(*polygons)
    for _ in range(1000):
        start = np.array([*rng.uniform(-2.0, 2.0, 2), rng.uniform(-math.pi, math.pi)])
        if simulated.gap(vehicle, start, points) > 0.05:
            return points, start
    return random_room(rng, simulated, vehicle)


def wild_driver(rng):
    """Return a driver of sudden whims, from tremor to long pushes; one in three at full stick."""
    hold = rng.choice([0.02, 0.4, 2.0])
    state = {"until": 0.0, "command": (0.0, 0.0)}

    def command(time, pose):
        if time >= state["until"]:
            state["until"] = time + hold * rng.uniform(0.3, 1.7)
            if rng.random() < 0.33:
                state["command"] = (rng.choice([0.8, -0.4]), rng.choice([-1.2, 0.0, 1.2]))
            else:
                turn = rng.uniform(-1.2, 1.2) * (rng.random() < 0.7)
                state["command"] = (rng.uniform(-0.4, 0.8) * (rng.random() < 0.8), turn)
        return state["command"]

    return command


def wild_drive(seed, simulated, vehicle, latency, seconds):
    rng = np.random.default_rng(seed)
    points, start = random_room(rng, simulated, vehicle)
    return simulated.drive(
        wild_driver(rng),
        points,
        assistant=simulated.assistant(AssistantOptions(latency=latency)),
        seconds=seconds,
        start=start,
        plant=PlantOptions(latency=latency),
    )


def check_promises(drive, limits=LIMITS):
    """Check what holds at every step of every drive."""
    asked, taken, full = drive.arrays()
    before = np.vstack([[0.0, 0.0], taken[:-1]])
    rate = np.diff(np.vstack([[0.0, 0.0], before]), axis=0) / PERIOD
    for k in range(len(taken)):
        v, _ = limits.clipped(*asked[k])
        last, now = before[k, 0], taken[k, 0]
        # Never the other way: what moves against the command only rolls out.
        if now * v < 0.0:
            assert abs(now) <= abs(last) + 1e-9 or full[k] or rate[k, 0] * now > 0.0
            assert now * last > 0.0
        elif abs(now) > abs(v) + 1e-9:
            # Faster than asked only on the way down, as fast as smooth motion goes there.
            known = min(max(rate[k, 0], -limits.acceleration), limits.acceleration)
            slowing = Smooth(last, known).towards(v, limits.acceleration, limits.jerk, PERIOD)
            assert abs(now) <= abs(last if full[k] else slowing.value) + 1e-9
    assert taken[:, 0].max() <= limits.speed + 1e-9
    check_jerk(taken, full, limits)
    states = [row["state"] for row in drive.signals]
    begun = (AssistantState.FULL_USER_CONTROL, AssistantState.RESTORING_ORIENTATION)
    assert begun not in list(pairwise(states))  # Fig. 4: only what was avoided is restored


def check_jerk(taken, full, limits):
    """Check acceleration and jerk wherever there was no full braking in the last two steps."""
    rows = np.vstack([np.zeros((3, 2)), taken])
    braked = np.concatenate([[False] * 3, full])
    for column, most, jerk in (
        (0, limits.acceleration, limits.jerk),
        (1, limits.yaw_acceleration, 10.0),
    ):
        value = rows[:, column]
        rate = np.diff(value) / PERIOD
        assert np.abs(rate[~braked[1:]]).max() <= most + 1e-9
        calm = ~(braked[1:-1] | braked[2:] | np.roll(braked, 1)[1:-1])
        calm &= (value[1:-1] != 0.0) & (value[2:] != 0.0)  # coming to rest may be abrupt
        assert np.abs(np.diff(rate))[calm].max(initial=0.0) <= jerk * PERIOD + 1e-9


@given(seed=st.integers(0, 10_000), latency=st.sampled_from([0.0, 0.1, 0.2]))
@settings(deadline=None, max_examples=6, derandomize=True)
def test_wild_commands_keep_every_promise(simulated, xeno, seed, latency):
    drive = wild_drive(seed, simulated, xeno, latency, 3.0)
    assert drive.gap > 0.01  # of the 25 mm that are to be kept, the plant's lag and noise take some
    check_promises(drive)


@pytest.mark.slow
@given(seed=st.integers(0, 1_000_000), latency=st.sampled_from([0.0, 0.1, 0.2]))
@settings(deadline=None, max_examples=25, derandomize=True)
def test_many_wild_commands_keep_every_promise(simulated, xeno, seed, latency):
    drive = wild_drive(seed, simulated, xeno, latency, 6.0)
    assert drive.gap > 0.01
    check_promises(drive)


CHAIRS = {
    "long scooter": Vehicle.rectangle(
        1.45, 0.62, 0.30, limits=Limits(speed=1.4, acceleration=0.7, jerk=2.0, yaw_rate=0.9)
    ),
    "front drive": Vehicle.rectangle(1.15, 0.65, 0.75, limits=Limits(speed=1.0)),
    "narrow track": Vehicle.rectangle(1.30, 0.70, 0.50, track=0.4, limits=Limits(yaw_rate=2.0)),
}


@pytest.mark.slow
@pytest.mark.parametrize("name", CHAIRS)
def test_chairs_of_other_shapes_keep_every_promise(simulate_chair, name):
    chair = CHAIRS[name]
    simulated = simulate_chair(chair)
    for seed in range(4):
        drive = wild_drive(seed, simulated, chair, 0.1 * (seed % 2), 5.0)
        assert drive.gap > 0.01
        check_promises(drive, MotionLimits.of(chair))


STEADY = st.one_of(
    st.tuples(st.floats(-0.4, 0.8), st.floats(-1.2, 1.2)),
    st.tuples(st.floats(0.1, 0.25), st.sampled_from([-1.2, 1.2])),  # nearly on the spot
)


@given(command=STEADY, seed=st.integers(0, 1000))
@settings(deadline=None, max_examples=10, derandomize=True)
def test_from_rest_a_steady_command_is_never_exceeded(simulated, xeno, command, seed):
    points, start = random_room(np.random.default_rng(seed), simulated, xeno)
    v, omega = LIMITS.clipped(*command)
    drive = simulated.drive(
        lambda time, pose: (v, omega),
        points,
        assistant=simulated.assistant(AssistantOptions(restores=False)),
        seconds=2.5,
        start=start,
    )
    _, taken, _ = drive.arrays()
    assert np.abs(taken[:, 0]).max() <= abs(v) + 1e-9
    assert (taken[:, 0] * v >= 0.0).all()


@pytest.mark.parametrize("far", [False, True])
def test_the_user_has_full_control_where_nothing_is_near(simulated, far):
    rng = np.random.default_rng(5)
    driver = wild_driver(rng)
    points = simulated.outlines(simulated.box(40.0, 41.0, 0.0, 1.0)) if far else NOTHING
    drive = simulated.drive(driver, points, assistant=simulated.assistant(), seconds=5.0)
    asked, taken, full = drive.arrays()
    alone = SmoothMotion(LIMITS)
    assert np.array_equal(taken, [alone.step(command) for command in asked])
    assert not full.any()
    assert {row["state"] for row in drive.signals} == {float(AssistantState.FULL_USER_CONTROL)}
