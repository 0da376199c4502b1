"""The virtual target: its Lyapunov function falls as promised, from everywhere."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.testing import assert_allclose

from narrows.errors import ShapeError
from narrows.path import Path
from narrows.se2 import compose
from narrows.simulation.plant import PlantOptions
from narrows.tracking.following import FollowingOptions
from narrows.tracking.virtual_target import (
    VirtualTargetGains,
    VirtualTargetOptions,
    VirtualTargetTracker,
    follow_target,
)

EXACT = VirtualTargetOptions(following=FollowingOptions(delay=0.0))
GAINS = VirtualTargetGains()


def lyapunov(ahead, left, angle, gains=GAINS):
    off = angle - gains.angle(left)
    return 0.5 * (ahead**2 + left**2) + off**2 / (2.0 * gains.pull)


@settings(deadline=None, max_examples=200)
@given(
    ahead=st.floats(-1, 1),
    left=st.floats(-1, 1),
    angle=st.floats(-3, 3),
    speed=st.floats(0, 1),
    curvature=st.floats(-5, 5),
)
def test_the_lyapunov_function_falls_as_the_identity_says(ahead, left, angle, speed, curvature):
    asked = follow_target(ahead, left, angle, speed=speed, curvature=curvature, gains=GAINS)
    # Errors in the frame of a target on a curve [corrections 3.1].
    rates = np.array(
        [
            speed * math.cos(angle) - asked.target_speed * (1.0 - curvature * left),
            speed * math.sin(angle) - curvature * asked.target_speed * ahead,
            asked.yaw_rate - curvature * asked.target_speed,
        ]
    )
    state, h = np.array([ahead, left, angle]), 1e-5
    slope = (lyapunov(*(state + h * rates)) - lyapunov(*(state - h * rates))) / (2 * h)
    delta = GAINS.angle(left)
    promised = speed * (
        -GAINS.along * ahead**2
        + left * math.sin(delta)
        - GAINS.turn * (angle - delta) ** 2 / GAINS.pull
    )
    assert promised <= 0.0
    size = 1.0 + float(np.abs(rates).max()) ** 3  # third derivatives times h^2 / 6
    assert slope == pytest.approx(promised, abs=1e-6 * size)


def test_the_default_gains_are_critical_with_the_root_they_say():
    slope = GAINS.approach / GAINS.width
    total, product = slope + GAINS.turn, slope * GAINS.turn + GAINS.pull
    assert_allclose(np.roots([1.0, total, product]), [-5.0, -5.0], rtol=1e-6)


@settings(deadline=None, max_examples=50)
@given(left=st.floats(-1, 1), offset=st.floats(-1e-6, 1e-6))
def test_the_law_is_smooth_where_the_angle_is_the_one_wanted(left, offset):
    exact, near = (
        follow_target(0.0, left, GAINS.angle(left) + extra, speed=0.4, curvature=0.5, gains=GAINS)
        for extra in (0.0, offset)
    )
    assert near.yaw_rate == pytest.approx(exact.yaw_rate, abs=1e-4)


def test_it_starts_at_the_centre_of_curvature_where_no_point_is_nearest(agile, drive):
    circle = Path.from_poses([[0, 0, 0], [0, 2, math.pi], [0, 0, 2 * math.pi - 1e-3]])
    run = drive(VirtualTargetTracker(circle, agile, EXACT), [0.0, 1.0, 0.0])
    late = run.poses[len(run.poses) // 2 : -1]
    assert np.abs(np.hypot(late[:, 0], late[:, 1] - 1.0) - 1.0).max() < 0.01


@pytest.mark.parametrize("direction", [1.0, -1.0])
@pytest.mark.parametrize("offset", [[0, 0.5, 0], [-0.3, -0.4, 2.0], [0.2, 0.1, math.pi - 0.01]])
def test_errors_never_grow_in_the_lyapunov_norm(agile, drive, direction, offset):
    path = Path.from_poses([[0, 0, 0.3], compose([0, 0, 0.3], [6 * direction, 0, 0])])
    start = compose(path.start, offset)
    tracker = VirtualTargetTracker(path, agile, EXACT)
    places = []
    step = tracker.step

    def noting(time, pose):
        command = step(time, pose)
        places.append(tracker._follower.place)
        return command

    tracker.step = noting
    run = drive(tracker, start, path, period=0.005)
    values = [lyapunov(p.ahead, p.left, p.angle) for p in places]
    # held for 5 ms, a command overshoots by some thousandths of the value
    assert (np.diff(values) <= 2e-3 * np.array(values[:-1]) + 1e-9).all()
    assert abs(run.across[-1]) < 1e-3


@pytest.mark.parametrize("way", [0, 1])
def test_an_ideal_chair_stays_on_a_winding_path(agile, drive, winding, way):
    path = winding[way]
    run = drive(VirtualTargetTracker(path, agile, EXACT), path.start, path)
    assert run.finished
    assert np.abs(run.across).max() < 3e-4  # two-millimetre tables and 20 ms of held commands
    assert_allclose(run.poses[-1], path.goal, atol=3e-3)


def test_reversing_and_turning_on_the_spot_are_followed(agile, drive, shunting):
    run = drive(VirtualTargetTracker(shunting, agile, EXACT), shunting.start, shunting)
    assert run.finished
    assert np.abs(run.across).max() < 3e-3
    assert_allclose(run.poses[-1], shunting.goal, atol=6e-3)


def test_a_known_latency_costs_little(agile, drive, winding):
    path = winding[0]
    plant = PlantOptions(motor_lag=0.05, latency=0.2)
    told = VirtualTargetOptions(following=FollowingOptions(delay=0.25))
    error = {
        name: np.abs(
            drive(VirtualTargetTracker(path, agile, chosen), path.start, path, plant=plant).across
        ).max()
        for name, chosen in (("told", told), ("untold", EXACT))
    }
    assert error["told"] < 2e-3 < 0.01 < error["untold"]


def test_wrong_gains_are_refused_in_words():
    with pytest.raises(ShapeError, match="gain pull must be"):
        VirtualTargetGains(pull=0.0)
    with pytest.raises(ShapeError, match="below pi / 2"):
        VirtualTargetGains(approach=1.6)
