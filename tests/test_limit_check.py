"""The judge of limits: each limit is found when broken, jumps count, nothing honest is refused."""

import math

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from narrows.bezier_section import BezierSection
from narrows.limit_check import PERIOD, check_limits
from narrows.path import Path
from narrows.planners.timing import time_path
from narrows.profile import Profile
from narrows.se2 import compose, exponential
from narrows.trajectory import Trajectory
from narrows.vehicle import Limits, Vehicle

CHAIR = Vehicle.rectangle(1.0, 0.6, 0.3)
WIDE = Limits(9.0, 9.0, 9.0, 99.0, 9.0, 99.0, 9.0)  # nothing of it is reached below
LINE = Path.from_poses([[0, 0, 0], [2, 0, 0]])
CIRCLE = Path.from_poses([[0, 0, 0], [0, 2, math.pi]])  # radius 1 m
SPOT = Path.from_poses([[0, 0, 0], [0, 0, 2.0]])
BEND = Path((BezierSection(np.array([[[0, 0], [1.0, 0.0], [1.5, 0.4], [1.5, 2.0]]])),))


def with_only(**limits: float) -> Vehicle:
    return Vehicle.rectangle(1.0, 0.6, 0.3, limits=WIDE).with_limits(**limits)


def steady(path: Path, speed: float) -> Trajectory:
    time = path.span / speed
    return Trajectory(path, Profile(np.array([0.0, time]), np.array([[0.0, speed, 0.0, 0.0]])))


def pushed(path: Path, acceleration: float) -> Trajectory:
    """Return a motion from rest with constant acceleration, moving at the end."""
    time = math.sqrt(2.0 * path.span / acceleration)
    rows = np.array([[0.0, 0.0, 0.5 * acceleration, 0.0]])
    return Trajectory(path, Profile(np.array([0.0, time]), rows))


def trapezoid(path: Path, speed: float, acceleration: float) -> Trajectory:
    ramp = speed / acceleration
    cruise = path.span / speed - ramp
    times = np.cumsum([0.0, ramp, cruise, ramp])
    gained = 0.5 * speed * ramp
    rows = [
        [0.0, 0.0, 0.5 * acceleration, 0.0],
        [gained, speed, 0.0, 0.0],
        [path.span - gained, speed, -0.5 * acceleration, 0.0],
    ]
    return Trajectory(path, Profile(times, np.array(rows)))


HALF = 0.5 * CHAIR.track


@pytest.mark.parametrize(
    ("motion", "name", "peak"),
    [
        (steady(LINE, 0.7), "speed", 0.7),
        (steady(CIRCLE, 0.7), "yaw_rate", 0.7),
        (steady(CIRCLE, 0.7), "lateral_acceleration", 0.49),
        (steady(CIRCLE, 0.7), "wheel_speed", 0.7 * (1.0 + HALF)),
        (steady(SPOT, 0.7), "wheel_speed", 0.7 * HALF),
        (pushed(LINE, 0.5), "acceleration", 0.5),
        (pushed(SPOT, 0.5), "acceleration", 0.5 * HALF),
        (pushed(CIRCLE, 0.5), "yaw_acceleration", 0.5),
        (pushed(CIRCLE, 0.5), "wheel_acceleration", 0.5 * (1.0 + HALF)),
        (steady(CIRCLE, 0.7), "curvature", 1.0),
    ],
)
def test_peaks_of_simple_motions_are_the_known_ones(motion, name, peak) -> None:
    assert check_limits(motion, CHAIR).peaks[name] == pytest.approx(peak, rel=1e-9)


@pytest.mark.parametrize(
    ("motion", "limit", "words"),
    [
        (steady(LINE, 0.7), {"speed": 0.69}, "speed reaches 0.7 m/s, the limit is 0.69"),
        (steady(CIRCLE, 0.7), {"yaw_rate": 0.69}, "yaw rate reaches 0.7 rad/s"),
        (
            steady(CIRCLE, 0.7),
            {"lateral_acceleration": 0.48},
            "lateral acceleration reaches 0.49 m/s^2, the limit is 0.48",
        ),
        (pushed(LINE, 0.5), {"acceleration": 0.49}, "acceleration reaches 0.5 m/s^2"),
        (pushed(CIRCLE, 0.5), {"yaw_acceleration": 0.49}, "yaw acceleration reaches 0.5"),
        (steady(CIRCLE, 0.7), {"curvature": 0.9}, "curvature reaches 1 1/m, the limit is 0.9"),
        (steady(SPOT, 0.7), {"curvature": 0.9}, "it turns on the spot"),
    ],
)
def test_each_limit_is_found_broken_and_named(motion, limit, words) -> None:
    assert any(
        words in violation for violation in check_limits(motion, with_only(**limit)).violations
    )
    assert check_limits(motion, with_only()).kept


def test_no_rim_may_be_faster_than_the_chair() -> None:
    chair = with_only(speed=0.7, reverse_speed=0.4)
    assert check_limits(steady(LINE, 0.7), chair).kept
    (violation,) = check_limits(steady(CIRCLE, 0.7), chair).violations
    assert violation.startswith("wheel speed reaches 0.878 m/s, the limit is 0.7")


def test_a_trapezoid_of_speed_has_too_much_jerk_though_each_piece_has_none() -> None:
    motion = trapezoid(LINE, 0.5, 0.4)
    check = check_limits(motion, with_only(jerk=5.0))
    assert check.peaks["jerk"] == pytest.approx(0.4 / PERIOD, rel=1e-3)
    assert [v.split()[0] for v in check.violations] == ["jerk"]


def test_a_jump_of_the_speed_is_an_acceleration() -> None:
    times = np.array([0.0, 1.0, 2.0])
    rows = np.array([[0.0, 0.4, 0.0, 0.0], [0.4, 1.6, 0.0, 0.0]])
    check = check_limits(Trajectory(LINE, Profile(times, rows)), CHAIR)
    assert check.peaks["acceleration"] == pytest.approx(1.2 / PERIOD, rel=1e-3)


def test_a_jump_of_the_curvature_is_a_yaw_acceleration() -> None:
    path = Path.from_poses([[0, 0, 0], [1, 0, 0], [1 + math.sin(1), 1 - math.cos(1), 1]])
    for speed in (0.03, 0.05):
        check = check_limits(steady(path, speed), CHAIR)
        assert check.peaks["yaw_acceleration"] == pytest.approx(speed / PERIOD, rel=1e-3)
        assert check.kept == (speed < CHAIR.limits.yaw_acceleration * PERIOD)


def test_jumps_on_both_sides_of_where_a_part_of_the_samples_ends_count_together() -> None:
    # samples are judged 100 000 at a time, 100 s; the jumps are met 5 ms before and after
    poses = [np.zeros(3)]
    for length, kappa in ((0.99995, 0.0), (1e-4, 1.0), (0.5, 2.0)):
        poses.append(compose(poses[-1], exponential([length, 0.0, kappa * length])))
    check = check_limits(steady(Path.from_poses(poses), 0.01), CHAIR)
    assert check.peaks["yaw_acceleration"] == pytest.approx(0.02 / PERIOD, rel=1e-3)


def test_a_change_of_direction_at_rest_is_none_and_at_speed_is_one() -> None:
    path = Path.from_poses([[0, 0, 0], [1, 0, 0], [0, 0, 0]])
    assert check_limits(time_path(path, CHAIR), CHAIR).kept
    check = check_limits(steady(path, 0.3), CHAIR)
    assert check.peaks["acceleration"] == pytest.approx(0.6 / PERIOD, rel=1e-3)


@given(speed=st.floats(0.1, 2.0), seed=st.integers(0, 2**32 - 1))
@settings(deadline=None, max_examples=25, derandomize=True)
def test_peaks_are_never_below_those_of_dense_path_evaluation(speed: float, seed: int) -> None:
    rng = np.random.default_rng(seed)
    corners = np.array([[0, 0], [0.7, 0], [1.4, 0], [2.1, 0]])
    path = Path((BezierSection((corners + rng.normal(0.0, 0.3, (4, 2)))[None]),))
    assume(path.max_curvature < 8.0)
    motion = pushed(path, 0.5 * speed**2 / path.span)
    peaks = check_limits(motion, CHAIR).peaks
    t = np.linspace(0.0, motion.duration, 5_000)
    rate, bend = motion.progress(t, 1), motion.progress(t, 2)
    kappa, kappa_rate = path(motion.progress(t), 1)[:, 2], path(motion.progress(t), 2)[:, 2]
    exact = {
        "yaw_rate": kappa * rate,
        "yaw_acceleration": kappa_rate * rate**2 + kappa * bend,
        "lateral_acceleration": kappa * rate**2,
        "wheel_speed": rate * (1.0 + HALF * np.abs(kappa)),
        "curvature": kappa,
    }
    for name, values in exact.items():
        greatest = float(np.abs(values).max())
        assert peaks[name] >= greatest * (1.0 - 1e-4), name  # what lies between 1 ms samples
        assert peaks[name] <= greatest * 1.03 + 1e-6, name  # the table's error is added


def test_rows_of_a_kept_motion_are_judged_to_keep_the_limits() -> None:
    motion = time_path(BEND, CHAIR)
    for thinning in (1, 2, 3):
        keep = np.unique(
            np.append(np.arange(0, len(motion.times), thinning), len(motion.times) - 1)
        )
        rows = Trajectory.from_samples(motion.times[keep], motion.poses[keep])
        check = check_limits(rows, CHAIR)
        assert check.kept, check.violations
        whole = check_limits(motion, CHAIR).peaks
        for name in ("speed", "acceleration", "yaw_rate", "lateral_acceleration", "wheel_speed"):
            assert check.peaks[name] == pytest.approx(whole[name], rel=0.03), name


def test_rows_at_uneven_times_do_not_feign_jerk() -> None:
    motion = time_path(LINE, CHAIR)
    steps = np.tile([0.03, 0.03, 0.06, 0.06, 0.01], 200).cumsum()
    times = np.concatenate([[0.0], steps[steps < motion.duration], [motion.duration]])
    rows = Trajectory.from_samples(times, motion(times))
    assert check_limits(rows, CHAIR).peaks["jerk"] <= CHAIR.limits.jerk * (1.0 + 1e-3)


def test_rows_that_break_a_limit_are_refused() -> None:
    fast = time_path(LINE, CHAIR.with_limits(speed=1.2, acceleration=1.2))
    rows = Trajectory.from_samples(fast.times, fast.poses)
    broken = {violation.split(" reaches")[0] for violation in check_limits(rows, CHAIR).violations}
    assert broken == {"speed", "acceleration", "wheel speed"}
