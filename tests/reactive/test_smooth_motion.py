"""Smooth motion keeps its limits whatever is asked, and gets there without overshooting."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from narrows.errors import ShapeError
from narrows.reactive.smooth_motion import MotionLimits, Smooth, SmoothMotion

LIMITS = MotionLimits()
COMMANDS = st.lists(
    st.tuples(st.floats(-2.0, 2.0), st.floats(-3.0, 3.0), st.integers(1, 60)),
    min_size=1,
    max_size=8,
)


def driven(commands):
    motion = SmoothMotion(LIMITS)
    rows = [[0.0, 0.0]] * 3
    for v, omega, count in commands:
        rows += [motion.step([v, omega]) for _ in range(count)]
    return np.array(rows)


@given(commands=COMMANDS)
@settings(deadline=None, max_examples=150, derandomize=True)
def test_speed_acceleration_and_jerk_keep_their_limits(commands):
    rows = driven(commands)
    assert rows[:, 0].max() <= LIMITS.speed
    assert rows[:, 0].min() >= -LIMITS.reverse_speed
    rounding = 1e-9
    for column, most, jerk in (
        (0, LIMITS.acceleration, LIMITS.jerk),
        (1, LIMITS.yaw_acceleration, LIMITS.yaw_jerk),
    ):
        value = rows[:, column]
        rate = np.diff(value) / 0.02
        assert np.abs(rate).max() <= most + rounding
        # A value that comes to rest may do so abruptly: it never swings through zero.
        moving = (value[1:-1] != 0.0) & (value[2:] != 0.0)
        assert np.abs(np.diff(rate))[moving].max(initial=0.0) <= jerk * 0.02 + rounding


@given(target=st.floats(-1.0, 1.0), value=st.floats(-1.0, 1.0), dt=st.floats(0.005, 0.1))
@settings(deadline=None, max_examples=150, derandomize=True)
def test_a_target_that_stays_is_reached_and_never_overshot(target, value, dt):
    smooth = Smooth(value)
    for _ in range(round(8.0 / dt)):
        before, smooth = smooth.value, smooth.towards(target, 0.6, 1.5, dt)
        if smooth.value != 0.0:
            assert abs(target - smooth.value) <= abs(target - before) + 1e-12
            assert (target - value) * (target - smooth.value) >= -1e-12
    assert smooth.value == pytest.approx(target, abs=1e-6)


def test_turning_is_slowed_at_speed():
    v, omega = LIMITS.clipped(0.8, 1.2)
    assert v * omega == pytest.approx(LIMITS.lateral_acceleration)
    assert LIMITS.clipped(0.0, 1.2) == (0.0, 1.2)


def test_what_is_not_a_number_counts_as_nothing():
    motion = SmoothMotion(LIMITS)
    for _ in range(50):
        motion.step([0.5, 0.5])
    for _ in range(200):
        motion.step([math.nan, math.inf])
    assert motion.command == (0.0, 0.0)


def test_driving_on_after_a_full_braking_is_smooth_again():
    motion = SmoothMotion(LIMITS)
    for _ in range(100):
        motion.step([0.8, 0.0])
    motion.force(0.4, 0.0)
    assert abs(motion.rates[0]) <= LIMITS.acceleration
    first, second = motion.step([0.8, 0.0]), motion.step([0.8, 0.0])
    assert abs(second[0] - first[0]) <= LIMITS.acceleration * 0.02 + 1e-12


def test_limits_and_commands_of_no_sense_are_refused():
    with pytest.raises(ShapeError, match="jerk"):
        MotionLimits(jerk=0.0)
    with pytest.raises(ShapeError, match="period"):
        SmoothMotion(LIMITS, period=0.0)
    with pytest.raises(ShapeError, match=r"\[v, omega\]"):
        SmoothMotion(LIMITS).step([1.0, 2.0, 3.0])
