"""Joysticks indicate what their deflections say, the head's whatever it looks at."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from narrows.errors import ShapeError
from narrows.reactive.joystick import Axis, HeadJoystick, Joystick, head_posture
from narrows.reactive.smooth_motion import MotionLimits

LIMITS = MotionLimits()
HAND, HEAD = Joystick(LIMITS), HeadJoystick(LIMITS)


def rotation(yaw, pitch, roll):
    c, s = np.cos([yaw, pitch, roll]), np.sin([yaw, pitch, roll])
    about_z = np.array([[c[0], -s[0], 0], [s[0], c[0], 0], [0, 0, 1]])
    about_y = np.array([[c[1], 0, s[1]], [0, 1, 0], [-s[1], 0, c[1]]])
    about_x = np.array([[1, 0, 0], [0, c[2], -s[2]], [0, s[2], c[2]]])
    return about_z @ about_y @ about_x


def test_nothing_inside_the_dead_zone_and_all_at_the_edge():
    assert HAND.command([0.04, -0.05]).tolist() == [0.0, 0.0]
    assert HAND.command([1.0, 0.0]) == pytest.approx([LIMITS.speed, 0.0])
    assert HAND.command([-1.0, 0.0]) == pytest.approx([-LIMITS.reverse_speed, 0.0])
    assert HAND.command([0.0, 1.0]) == pytest.approx([0.0, LIMITS.yaw_rate])
    assert HAND.command([5.0, 0.0]) == pytest.approx([LIMITS.speed, 0.0])


@given(share=st.floats(-1.0, 1.0), exponent=st.floats(0.5, 3.0))
@settings(deadline=None, max_examples=100)
def test_the_deflection_for_a_share_commands_it(share, exponent):
    axis = Axis(0.1, 0.9, exponent)
    # Below the size of rounding at the edge of the dead zone a share is none.
    assert axis.share(axis.deflection(share)) == pytest.approx(share, abs=1e-6)


@given(v=st.floats(-0.3, 0.5), omega=st.floats(-0.6, 0.6))
@settings(deadline=None, max_examples=100)
def test_commands_within_the_stick_s_disc_are_indicated_exactly(v, omega):
    assert HAND.command(HAND.deflection([v, omega])) == pytest.approx([v, omega], abs=1e-6)
    assert HEAD.command(HEAD.posture([v, omega])) == pytest.approx([v, omega], abs=1e-6)


def test_a_nod_drives_and_a_tilt_to_the_right_turns_right():
    v, omega = HEAD.command([math.radians(20.0), math.radians(15.0)])
    assert v > 0.0
    assert omega < 0.0
    assert HEAD.command(np.radians([5.9, -5.9])).tolist() == [0.0, 0.0]
    bowed = HeadJoystick(LIMITS, neutral_pitch=math.radians(10.0))
    assert bowed.command([math.radians(10.0), 0.0]).tolist() == [0.0, 0.0]


@given(yaw=st.floats(-3.0, 3.0), pitch=st.floats(-1.4, 1.4), roll=st.floats(-1.4, 1.4))
@settings(deadline=None, max_examples=100)
def test_looking_round_commands_nothing(yaw, pitch, roll):
    assert head_posture(rotation(yaw, pitch, roll)) == pytest.approx([pitch, roll], abs=1e-9)


def test_a_head_straight_down_has_a_posture_still():
    assert head_posture(rotation(0.3, math.pi / 2.0, 0.2)) == pytest.approx([math.pi / 2.0, 0.0])


def test_a_broken_sensor_commands_nothing():
    for device in (HAND, HEAD):
        assert device.command([math.nan, math.inf]).tolist() == [0.0, 0.0]


def test_what_is_no_deflection_is_refused():
    with pytest.raises(ShapeError, match=r"\[forward, left\]"):
        HAND.command([1.0])
    with pytest.raises(ShapeError, match="dead zone"):
        Axis(1.0, 0.5)
    with pytest.raises(ShapeError, match=r"\(3, 3\)"):
        head_posture(np.eye(2))
