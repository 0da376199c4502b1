"""Paces: limits kept, stops where the direction changes, clocks that wait."""

import math

import numpy as np
import pytest

from narrows.path import Path
from narrows.profile import Profile
from narrows.tracking.legs import legs_of
from narrows.tracking.pace import LimitedPace, TimedPace
from narrows.trajectory import Trajectory
from narrows.vehicle import Limits, Vehicle

CHAIR = Vehicle.rectangle(1.0, 0.6, 0.3, limits=Limits(speed=0.8, acceleration=0.5))
LINE = Path.from_poses([[0, 0, 0], [2, 0, 0]])


def driven(pace: LimitedPace | TimedPace, end: float, period: float = 0.02) -> np.ndarray:
    """Return the rates of a perfect chair until it stops."""
    progress, rates = 0.0, []
    while progress < end - 1e-3 and len(rates) < 2000:
        rates.append(pace.rate(0, progress, period))
        progress += rates[-1] * period
    assert progress <= end + 1e-9
    return np.array(rates)


def test_a_straight_line_is_a_trapezoid_within_the_limits() -> None:
    rates = driven(LimitedPace(legs_of(LINE), CHAIR, speed=0.6, share=1.0), 2.0)
    assert rates.max() == pytest.approx(0.6)
    assert np.diff(rates).max() <= 0.5 * 0.02 + 1e-12
    assert -np.diff(rates).min() <= 0.5 * 0.02 + 1e-9
    # T = s / v + v / a for a trapezoid; creeping in takes a few periods more
    assert 0.02 * len(rates) == pytest.approx(2.0 / 0.6 + 0.6 / 0.5, abs=0.15)


def test_a_bend_is_taken_as_fast_as_the_limits_allow() -> None:
    radius = 0.5
    arc = Path.from_poses([[0, 0, 0], [0, 2 * radius, math.pi]])
    rates = driven(LimitedPace(legs_of(arc), CHAIR, speed=0.8), arc.span)
    lateral = CHAIR.limits.lateral_acceleration
    assert rates.max() == pytest.approx(math.sqrt(lateral * radius), rel=1e-3)
    assert rates.max() ** 2 / radius <= lateral * (1 + 1e-9)


def test_reverse_keeps_the_reverse_speed() -> None:
    back = Path.from_poses([[0, 0, 0], [-2, 0, 0]])
    rates = driven(LimitedPace(legs_of(back), CHAIR, speed=0.8), 2.0)
    assert rates.max() == pytest.approx(CHAIR.limits.reverse_speed)


def steady(path: Path, speed: float) -> Trajectory:
    duration = path.span / speed
    return Trajectory(path, Profile(np.array([0.0, duration]), np.array([[0.0, speed, 0.0, 0.0]])))


def test_a_chair_on_time_drives_at_the_trajectorys_speed() -> None:
    pace = TimedPace(steady(LINE, 0.5), legs_of(LINE))
    rates = driven(pace, 2.0)
    np.testing.assert_allclose(rates[:-3], 0.5, atol=1e-6)
    assert pace.is_due(0)


def test_the_clock_waits_for_a_chair_that_stands() -> None:
    pace = TimedPace(steady(LINE, 0.5), legs_of(LINE))
    for _ in range(1000):
        rate = pace.rate(0, 0.0, 0.02)
    assert not pace.is_due(0)  # twenty seconds for a drive of four
    assert rate == pytest.approx(0.5 + 2.0 * 0.15, abs=0.05)  # catching up, not more
