"""When to be where along a path: jerk-limited progress that keeps the chair's limits."""

from __future__ import annotations

import numpy as np
from ruckig import InputParameter, Result, Ruckig
from ruckig import Trajectory as Motion

from narrows.errors import ShapeError
from narrows.limit_check import check_limits
from narrows.path import Path
from narrows.profile import Profile
from narrows.se2 import Array
from narrows.section import Section
from narrows.trajectory import Trajectory
from narrows.vehicle import Vehicle

_SLOWER = 0.9  # factor on speeds while a limit that couples speed and bend is exceeded
_TRIES = 40  # 0.9^40 = 1.5 %


def time_path(path: Path, vehicle: Vehicle) -> Trajectory:
    """Return the path with times: at rest at both ends of every section, limits kept.

    Each section is driven by one jerk-limited motion (ruckig) at the speed its sharpest bend
    allows; it slows down further while the yaw acceleration is above its limit.

    Args:
        path: The path.
        vehicle: Its limits.

    Raises:
        ShapeError: If the path needs something the limits exclude at any speed: reverse travel
            for a chair that only drives forward, or a curvature beyond the limit.
    """
    if (path.directions < 0).any() and vehicle.limits.reverse_speed == 0.0:
        raise ShapeError("the path reverses and the chair only drives forward")
    factor = 1.0
    for _ in range(_TRIES):
        trajectory = Trajectory(path, _rest_to_rest(path, vehicle, factor))
        check = check_limits(trajectory, vehicle)
        if check.kept:
            return trajectory
        factor *= _SLOWER
    raise ShapeError(f"no speed keeps the limits: {'; '.join(check.violations)}")


def _rest_to_rest(path: Path, vehicle: Vehicle, factor: float) -> Profile:
    """Return one jerk-limited motion per section, joined at rest."""
    breaks, rows, begin = [np.zeros(1)], [], 0.0
    for section in path.sections:
        speed, acceleration, jerk = _caps(section, vehicle)
        steps, coefficients = _motion(
            section.span, factor * speed, factor**2 * acceleration, factor**3 * jerk
        )
        coefficients[:, 0] += begin
        begin += section.span
        breaks.append(breaks[-1][-1] + np.cumsum(steps))
        rows.append(coefficients)
    return Profile(np.concatenate(breaks), np.concatenate(rows))


def _caps(section: Section, vehicle: Vehicle) -> tuple[float, float, float]:
    """Return speed, acceleration and jerk along a section that its sharpest bend allows."""
    limits = vehicle.limits
    if section.direction == 0:
        rim = 2.0 / vehicle.track
        return (
            min(limits.yaw_rate, rim * limits.speed),
            min(limits.yaw_acceleration, rim * limits.acceleration),
            rim * limits.jerk,
        )
    bend = max(Path((section,)).max_curvature, 1e-9)
    top = limits.speed if section.direction > 0 else limits.reverse_speed
    lateral = (limits.lateral_acceleration / bend) ** 0.5
    return min(top, limits.yaw_rate / bend, lateral), limits.acceleration, limits.jerk


def _motion(span: float, speed: float, acceleration: float, jerk: float) -> tuple[Array, Array]:
    """Return durations and coefficients of the fastest motion from rest to rest over a span."""
    request = InputParameter(1)
    request.target_position = [span]
    request.max_velocity, request.max_acceleration = [speed], [acceleration]
    request.max_jerk = [jerk]
    motion = Motion(1)
    if Ruckig(1).calculate(request, motion) not in (Result.Working, Result.Finished):
        raise ShapeError(f"no motion over {span} with limits {speed}, {acceleration}, {jerk}")
    profile = motion.profiles[0][0]
    steps = np.array(profile.t)
    rows = np.column_stack([profile.p[:7], profile.v[:7], profile.a[:7], profile.j])
    kept = steps > 1e-12
    return steps[kept], rows[kept] * np.array([1.0, 1.0, 0.5, 1.0 / 6.0])
