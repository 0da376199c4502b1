"""Comfort figures: published values of the weighting, closed forms of simple motions."""

import math
from pathlib import Path as File

import numpy as np
import pytest

from narrows.path import Path
from narrows.planners.comfort import horizontal_weighting, ride_comfort, weighted_rms
from narrows.planners.doorway import DoorwayPlanner
from narrows.planners.timing import time_path
from narrows.profile import Profile
from narrows.scene import load_scene
from narrows.trajectory import Trajectory
from narrows.vehicle import Vehicle

SCENES = File(__file__).parents[2] / "examples" / "scenes"
CHAIR = Vehicle.rectangle(1.0, 0.6, 0.3)


def test_the_weighting_has_its_published_value_at_the_reference_frequency() -> None:
    # 100 rad/s = 15.915 Hz: 0.1261 [ZETLAB]
    assert horizontal_weighting(100.0 / (2.0 * math.pi)) == pytest.approx(0.1261, abs=5e-5)


def test_the_weighting_passes_neither_slow_nor_fast_vibration() -> None:
    assert horizontal_weighting([0.0, 0.04, 1000.0]) == pytest.approx([0.0, 0.01, 0.0], abs=1e-3)


@pytest.mark.parametrize("frequency", [0.8, 2.0, 8.0])
def test_a_long_sine_is_weighted_by_its_frequency(frequency: float) -> None:
    t = np.arange(0.0, 200.0, 0.004)
    sine = np.sin(2.0 * math.pi * frequency * t)[None]
    expected = float(horizontal_weighting(frequency)) / math.sqrt(2.0)
    assert weighted_rms(sine, 250.0, 200.0) == pytest.approx(expected, rel=5e-3)  # ends of 200 s


def test_a_steady_circle_has_its_centripetal_acceleration_only() -> None:
    path = Path.from_poses([[0, 0, 0], [0, 2, math.pi]])
    profile = Profile(np.array([0.0, path.span / 0.5]), np.array([[0.0, 0.5, 0.0, 0.0]]))
    comfort = ride_comfort(Trajectory(path, profile))
    assert comfort.rms_acceleration == pytest.approx(0.25, rel=1e-3)
    assert comfort.rms_jerk == 0.0


def test_a_straight_drive_has_the_closed_form_of_its_s_curve() -> None:
    trajectory = time_path(Path.from_poses([[0, 0, 0], [4, 0, 0]]), CHAIR)
    comfort, duration = ride_comfort(trajectory), trajectory.duration
    v, a, j = 0.8, 0.6, 1.5
    # four ramps of length a / j at jerk j; two plateaus of acceleration a, v / a - a / j long
    jerk = math.sqrt(4.0 * (a / j) * j**2 / duration)
    acceleration = math.sqrt((2.0 * (v / a - a / j) * a**2 + 4.0 * (a / j) * a**2 / 3.0) / duration)
    assert comfort.rms_jerk == pytest.approx(jerk, rel=5e-3)
    assert comfort.rms_acceleration == pytest.approx(acceleration, rel=5e-3)


def test_turning_on_the_spot_accelerates_nobody() -> None:
    comfort = ride_comfort(time_path(Path.from_poses([[0, 0, 0], [0, 0, 2.0]]), CHAIR))
    assert comfort.rms_acceleration == comfort.rms_jerk == comfort.weighted_acceleration == 0.0


def test_less_jerk_is_felt_less() -> None:
    path = Path.from_poses([[0, 0, 0], [3, 0, 0]])
    felt = [
        ride_comfort(time_path(path, CHAIR.with_limits(jerk=jerk))).weighted_acceleration
        for jerk in (0.5, 1.5, 5.0)
    ]
    assert felt == sorted(felt)


def test_a_plan_tells_how_it_rides() -> None:
    scene = load_scene(SCENES / "door.yaml")
    plan = DoorwayPlanner().plan(scene).raise_for_status()
    figures = plan.statistics
    assert figures["peak_jerk_m_s3"] <= scene.vehicle.limits.jerk
    assert figures["rms_jerk_m_s3"] < figures["peak_jerk_m_s3"]
    assert 0.0 < figures["weighted_acceleration_m_s2"] < figures["rms_acceleration_m_s2"]
