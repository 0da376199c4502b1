"""Feedback linearisation: the error's dynamics, the singular case, the paper's wheel speeds."""

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
from narrows.tracking.delay import moved
from narrows.tracking.following import FollowingOptions
from narrows.tracking.level import CircleLevel, Jet, LineLevel
from narrows.tracking.level_tracker import LevelTracker
from narrows.tracking.linearizing import LinearizingTracker
from narrows.tracking.linearizing_law import (
    LinearizingGains,
    LinearizingOptions,
    linearizing_yaw_rate,
    wheel_rates,
)
from narrows.vehicle import Vehicle

EXACT = LinearizingOptions(following=FollowingOptions(delay=0.0))
COORDINATE = st.floats(-1.5, 1.5)


def bowl(x, y):
    """Return x^2 / 2 + x y / 3 + y^3 + sin x - 0.4: nothing about it is special."""
    return Jet(
        x * x / 2 + x * y / 3 + y**3 + math.sin(x) - 0.4,
        x + y / 3 + math.cos(x),
        x / 3 + 3 * y * y,
        1.0 - math.sin(x),
        1.0 / 3.0,
        6.0 * y,
    )


@settings(deadline=None, max_examples=100)
@given(x=COORDINATE, y=COORDINATE, heading=st.floats(-math.pi, math.pi))
@pytest.mark.parametrize("level", [bowl, CircleLevel(2.0, 2.0, 1.3), LineLevel(0.1, 0.2, 0.7)])
@pytest.mark.parametrize("v", [0.4, -0.3])
def test_the_error_obeys_its_linear_equation(level, v, x, y, heading):
    gains = LinearizingGains(1.3, 0.7)
    jet = level(x, y)
    along = jet.fx * math.cos(heading) + jet.fy * math.sin(heading)
    if abs(jet.fy * math.cos(heading) - jet.fx * math.sin(heading)) < 0.1:
        return  # near the singular heading
    omega = linearizing_yaw_rate(jet, heading, v, gains)
    dt = 1e-3
    before, after = (
        level(*moved(x, y, heading, v, omega, sign * dt)[:2]).value for sign in (-1, 1)
    )
    second = (after - 2 * jet.value + before) / dt**2
    # fourth derivatives times dt^2 / 12: at most about omega^3 of 100 times 1e-7
    scale = 1.0 + abs(omega) ** 3
    assert second == pytest.approx(-gains.k1 * v * along - gains.k2 * jet.value, abs=1e-4 * scale)


@settings(deadline=None, max_examples=50)
@given(x=COORDINATE, y=COORDINATE)
@pytest.mark.parametrize("level", [CircleLevel(2.0, 2.0, 1.3), LineLevel(0.1, 0.2, 0.7), bowl])
def test_the_derivatives_of_levels_are_their_difference_quotients(level, x, y):
    h, jet = 1e-4, level(x, y)
    right, left, up, down = level(x + h, y), level(x - h, y), level(x, y + h), level(x, y - h)
    quotients = [
        (right.value - left.value) / (2 * h),
        (up.value - down.value) / (2 * h),
        (right.fx - left.fx) / (2 * h),
        (up.fx - down.fx) / (2 * h),
        (up.fy - down.fy) / (2 * h),
    ]
    assert_allclose(quotients, jet[1:], atol=1e-5)


def test_the_papers_wheels_turn_as_its_radii_ask():
    chair = Vehicle.rectangle(1.0, 0.67, 0.0, track=0.67, wheel_radius=0.16)
    v = 0.16 * 2 * math.pi * 10 / 60  # 10 revolutions a minute
    inner, outer = 1.3533, 2.0233
    left, right = wheel_rates(chair, v, v / (0.5 * (inner + outer)))
    assert right / left == pytest.approx(outer / inner, rel=1e-3)
    assert (right, left) == pytest.approx((1.255, 0.839), abs=1e-3)  # corrections 2.4


@pytest.mark.parametrize("heading", [0.5 * math.pi, -0.5 * math.pi])
def test_straight_across_the_path_no_yaw_rate_is_defined(heading):
    jet = Jet(0.1, 0.0, 1.0, 0.0, 0.0, 0.0)
    with pytest.raises(ShapeError, match="straight across the path"):
        linearizing_yaw_rate(jet, heading, 0.0, LinearizingGains(1.0, 1.0))


def test_on_a_circle_the_distance_decays_as_critical_damping_says(agile, drive):
    circle, distance = CircleLevel(0.0, 1.5, 1.5), 0.25
    options = LinearizingOptions(distance=distance, following=FollowingOptions(delay=0.0))
    run = drive(LevelTracker(circle, agile, options, length=3.0), [0.0, -0.1, 0.0], period=0.005)
    error = [circle(x, y).value for x, y, _ in run.poses[:-1]]
    way = 0.4 * 0.005 * np.arange(len(error))
    start = circle(0.0, -0.1).value
    expected = start * (1 + way / distance) * np.exp(-way / distance)
    # the law knows f' = v sin(angle) exactly; 5 ms of holding a command is 2 mm of way
    assert_allclose(error, expected, atol=0.02 * abs(start))


@pytest.mark.parametrize("direction", [1, -1])
@pytest.mark.parametrize("left", [1, -1])
@pytest.mark.parametrize("heading", [0.0, math.pi / 2, math.pi, -2.0])
def test_from_any_heading_the_chosen_way_along_the_path_is_taken(
    agile, drive, direction, left, heading
):
    line = LineLevel(0.0, 0.0, 0.0)
    tracker = LevelTracker(line, agile, EXACT, direction=direction, left=left, length=4.0)
    run = drive(tracker, [0.0, 0.3, heading])
    assert run.finished
    assert abs(run.poses[-1, 1]) < 1e-3
    assert np.sign(run.poses[-1, 0] - run.poses[-60, 0]) == left
    moving = np.abs(run.commands[:, 0]) > 0
    assert (np.sign(run.commands[moving, 0]) == direction).all()


def test_a_chair_that_cannot_turn_on_the_spot_drives_round(agile, drive):
    chair = agile.with_limits(curvature=2.0)
    tracker = LevelTracker(LineLevel(0.0, 0.0, 0.0), chair, EXACT, length=8.0)
    run = drive(tracker, [0.0, 0.2, math.pi])
    assert abs(run.poses[-1, 1]) < 2e-3
    assert abs(math.remainder(run.poses[-1, 2], 2 * math.pi)) < 0.01
    bend = np.abs(run.commands[:-1, 1]) / np.abs(run.commands[:-1, 0])
    assert bend[: len(bend) // 3].max() == pytest.approx(2.0)


@pytest.mark.parametrize("way", [0, 1])
def test_an_ideal_chair_stays_on_a_winding_path(agile, drive, winding, way):
    path = winding[way]
    run = drive(LinearizingTracker(path, agile, EXACT), path.start, path)
    assert run.finished
    assert np.abs(run.across).max() < 3e-4  # two-millimetre tables and 20 ms of held commands
    assert_allclose(run.poses[-1], path.goal, atol=3e-3)


def test_reversing_and_turning_on_the_spot_are_followed(agile, drive, shunting):
    run = drive(LinearizingTracker(shunting, agile, EXACT), shunting.start, shunting)
    assert run.finished
    assert np.abs(run.across).max() < 3e-3
    assert_allclose(run.poses[-1], shunting.goal, atol=6e-3)
    assert (np.diff(run.progress) >= 0.0).all()


@pytest.mark.parametrize("direction", [1.0, -1.0])
def test_errors_decay_from_beside_the_path_and_across_it(agile, drive, direction):
    path = Path.from_poses([[0, 0, 0.3], compose([0, 0, 0.3], [5 * direction, 0, 0])])
    for offset in ([0, 0.2, -0.3], [0, -0.1, 2.0], [0, 0.05, math.pi]):
        start = compose(path.start, offset)
        run = drive(LinearizingTracker(path, agile, EXACT), start, path)
        assert abs(run.across[-1]) < 1e-3


def test_a_known_latency_costs_little(agile, drive, winding):
    path = winding[0]
    plant = PlantOptions(motor_lag=0.05, latency=0.2)
    told = LinearizingOptions(following=FollowingOptions(delay=0.25))
    error = {
        name: np.abs(
            drive(LinearizingTracker(path, agile, chosen), path.start, path, plant=plant).across
        ).max()
        for name, chosen in (("told", told), ("untold", EXACT))
    }
    assert error["told"] < 2e-3 < 0.01 < error["untold"]


def test_wrong_options_are_refused_in_words():
    with pytest.raises(ShapeError, match="distance must be a finite positive number"):
        LinearizingOptions(distance=0.0)
    with pytest.raises(ShapeError, match="0 < approach < singular"):
        LinearizingOptions(approach=1.3)
    with pytest.raises(ShapeError, match="gain k1 must be"):
        LinearizingGains(-1.0, 1.0)
    with pytest.raises(ShapeError, match="left must be"):
        LevelTracker(LineLevel(0, 0, 0), Vehicle.rectangle(1, 0.7, 0.2), left=0)
