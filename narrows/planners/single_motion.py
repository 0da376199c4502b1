"""One jerk-limited motion from rest to rest, the fastest there is (ruckig)."""

from __future__ import annotations

import numpy as np
from ruckig import InputParameter, Result, Ruckig
from ruckig import Trajectory as Motion

from narrows.errors import ShapeError
from narrows.profile import Profile


def single_motion(span: float, speed: float, acceleration: float, jerk: float) -> Profile:
    """Return the fastest progress from rest at 0 to rest at a span.

    Args:
        span: Where to stop, [m] or [rad]; positive, as are the limits.
        speed: Limit of the rate of progress.
        acceleration: Limit of its second derivative.
        jerk: Limit of its third.

    Raises:
        ShapeError: If there is no such motion.
    """
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
    breaks = np.concatenate([[0.0], np.cumsum(steps[kept])])
    return Profile(breaks, rows[kept] * np.array([1.0, 1.0, 0.5, 1.0 / 6.0]))
