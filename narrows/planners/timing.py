"""When to be where along a path: jerk-limited progress that keeps the chair's limits."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from narrows.errors import ShapeError
from narrows.limit_check import LimitCheck, check_limits, limits_by_name
from narrows.path import Path
from narrows.profile import Profile
from narrows.trajectory import Trajectory
from narrows.vehicle import Vehicle

from .legs import MARGIN, Leg, legs_of
from .local_slowing import varied_motion
from .single_motion import single_motion

LONGEST = 600.0
"""Longest time a stretch between two stops may take [s]."""

_PLENTY = 0.7  # share of the useful acceleration up to which the limit is simply used
_SAMPLES = 400  # of a leg's motion, to see what it takes of the limits
_SHARPER = 1.01  # curvature of this much beyond its limit is no rounding
_TRIES = 8  # of stretching the whole by what the check finds in excess
_ORDERS = {
    "speed": 1,
    "reverse_speed": 1,
    "wheel_speed": 1,
    "yaw_rate": 1,
    "lateral_acceleration": 2,
    "acceleration": 2,
    "yaw_acceleration": 2,
    "jerk": 3,
}
"""The power of a factor on time by which each peak falls."""


class Timed(NamedTuple):
    """A path with times, and what the check of its limits found.

    Attributes:
        trajectory: The trajectory.
        check: Its limits, judged by `check_limits`; kept.
    """

    trajectory: Trajectory
    check: LimitCheck


def time_path(path: Path, vehicle: Vehicle) -> Trajectory:
    """Return the path with times: as fast as the limits allow, jerk-limited.

    The chair rests at both ends, where the direction of travel changes, before and after a turn
    on the spot, and where the curvature jumps; between, its speed varies with the bend. See
    docs/timing.md.

    Args:
        path: The path.
        vehicle: Its limits.

    Raises:
        ShapeError: If the path needs something the limits exclude at any speed: reverse travel
            for a chair that only drives forward, or a curvature beyond the limit.
    """
    return timed_path(path, vehicle).trajectory


def timed_path(path: Path, vehicle: Vehicle) -> Timed:
    """Return the path with times, as `time_path`, with the check that it keeps the limits."""
    if (path.directions < 0).any() and vehicle.limits.reverse_speed == 0.0:
        raise ShapeError("the path reverses and the chair only drives forward")
    profile = _joined([(leg.begin, leg_motion(leg)) for leg in legs_of(path, vehicle)])
    for _ in range(_TRIES):
        trajectory = Trajectory(path, profile)
        check = check_limits(trajectory, vehicle)
        if check.kept:
            return Timed(trajectory, check)
        factor = _stretch_asked(check, vehicle)
        if factor <= 1.0 or check.peaks["curvature"] > _SHARPER * vehicle.limits.curvature:
            break  # no time mends it: trying would sample a drive of days
        profile = stretched(profile, 1.001 * factor)
    raise ShapeError(f"no speed keeps the limits: {'; '.join(check.violations)}")


def _stretch_asked(check: LimitCheck, vehicle: Vehicle) -> float:
    """Return the factor on time that would keep the limits that depend on speed."""
    asked = [
        (check.peaks[name] / limit) ** (1.0 / _ORDERS[name])
        for name, _, limit in limits_by_name(vehicle.limits)
        if name in _ORDERS and limit > 0.0
    ]
    return float(max(asked))


def leg_motion(leg: Leg) -> Profile:
    """Return progress along a leg from rest to rest.

    The fastest single motion at the leg's greatest cap is taken if it keeps the limits: then
    nothing is faster. Else the fastest of a single motion at the least cap and of some whose
    speed varies, each stretched in time by what it still is in excess.

    Raises:
        ShapeError: If the leg bends so sharply that driving it takes longer than `LONGEST`.
    """
    single, factor = _kept(leg, float(leg.cap.max()))
    if factor <= 1.0:
        return single
    slowest = leg.span / leg.cap.min()
    found = [stretched(*_kept(leg, float(leg.cap.min())))] if slowest < LONGEST else []
    for strongest in _accelerations(leg, single):
        varied = varied_motion(leg, strongest)
        found.append(stretched(varied, stretch_needed(leg, varied)))
    best = min(found, key=lambda profile: profile.duration)
    if best.duration > LONGEST:
        raise ShapeError(f"a stretch of {leg.span:.2g} m bends too sharply: {best.duration:.0f} s")
    return best


def _accelerations(leg: Leg, single: Profile) -> list[float]:
    """Return the accelerations to try on a leg.

    To reach speed v, more than sqrt(jerk x v) is of no use: reaching and leaving it takes longer
    than it saves. Where that is near, less may be better still.
    """
    fastest = float(single(single.breaks, 1).max())
    useful = float((MARGIN * leg.jerk * fastest) ** 0.5)
    strongest = MARGIN * leg.acceleration
    if strongest <= _PLENTY * useful:
        return [strongest]
    return [min(strongest, useful), _PLENTY * useful, _PLENTY**2 * useful]


def _kept(leg: Leg, speed: float) -> tuple[Profile, float]:
    """Return the fastest single motion at a speed, and the stretch it needs."""
    motion = single_motion(leg.span, speed, MARGIN * leg.acceleration, MARGIN * leg.jerk)
    return motion, stretch_needed(leg, motion)


def stretch_needed(leg: Leg, profile: Profile) -> float:
    """Return the factor on time with which a motion keeps the leg's limits, at least 1.

    Speeds fall with the factor, accelerations with its square, jerk with its cube.
    """
    even = np.linspace(0.0, profile.duration, _SAMPLES)
    time = np.concatenate([even, profile.breaks])
    excess = leg.excess(profile(time), profile(time, 1), profile(time, 2))
    jerk = 6.0 * np.abs(profile.coefficients[:, 3]).max() / (leg.jerk * MARGIN)
    needed = (excess.speed.max(), excess.yaw.max() ** 0.5, jerk ** (1.0 / 3.0))
    return float(max(needed)) if max(needed) > 1.0 + 0.5 * (1.0 - MARGIN) else 1.0


def stretched(profile: Profile, factor: float) -> Profile:
    """Return the same progress, slower by a factor on time."""
    if factor == 1.0:
        return profile
    scale = factor ** -np.arange(4.0)
    return Profile(profile.breaks * factor, profile.coefficients * scale)


def _joined(parts: list[tuple[float, Profile]]) -> Profile:
    """Return profiles one after the other, each from its progress at the beginning."""
    breaks, rows = [np.zeros(1)], []
    for begin, part in parts:
        coefficients = part.coefficients.copy()
        coefficients[:, 0] += begin
        breaks.append(breaks[-1][-1] + part.breaks[1:])
        rows.append(coefficients)
    return Profile(np.concatenate(breaks), np.concatenate(rows))
