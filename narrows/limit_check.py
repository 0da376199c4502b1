"""Does a trajectory keep its chair's limits? Judged from the motion, not from its maker's word."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from .se2 import Array
from .trajectory import Trajectory
from .vehicle import Limits, Vehicle

RATE = 1000.0
"""Samples a second at which smooth trajectories are judged."""

SLIP = float(np.deg2rad(1.0))
"""Most angle between motion and heading that still is rolling [rad]: a castor's play."""

PERIOD = 0.02
"""Time over which what jumps is judged [s]: a control period, the longest time between rows."""

_PART = 100_000  # samples judged at a time, to bound the memory
_RELATIVE = 1e-3  # an excess a thousandth of the limit is rounding and solver tolerance


@dataclass(frozen=True)
class LimitCheck:
    """What a trajectory asks of the chair, and what of it is too much.

    Attributes:
        peaks: Greatest absolute value by the limit's name; units as in `Limits`. Also
            `wheel_speed` and `wheel_acceleration` of the faster wheel's rim, and `slip` [rad].
        violations: One sentence for each limit exceeded.
    """

    peaks: dict[str, float]
    violations: tuple[str, ...]

    @property
    def kept(self) -> bool:
        """Whether every limit is kept."""
        return not self.violations


def check_limits(trajectory: Trajectory, vehicle: Vehicle) -> LimitCheck:
    """Return the peaks of a trajectory and the limits they exceed.

    A smooth trajectory is sampled at 1 kHz; the path's curvature comes from a table whose error
    is added to the peaks. What jumps (the yaw rate where the curvature does, the acceleration of a
    trapezoid) has no derivative there: the change within any control period, `PERIOD`, must not
    be more than the limit allows in that time. A trajectory read from rows is judged by
    difference quotients, which are mean values of the true derivatives: they never exceed a
    limit the motion keeps.

    No wheel's rim is faster than the greater of `speed` and `reverse_speed`. Its acceleration is
    reported and has no limit of its own: acceleration + yaw_acceleration track / 2 bounds it. On
    the spot, where the body origin rests, the limits of acceleration and jerk apply to the rims.

    Args:
        trajectory: The timed motion.
        vehicle: Its limits and track.
    """
    peaks = _row_peaks(trajectory, vehicle) if trajectory.sampled else _peaks(trajectory, vehicle)
    peaks["curvature"] = trajectory.path.curvature_table.greatest
    peaks["slip"] = trajectory.slip()
    violations = [
        f"{name.replace('_', ' ')} reaches {peaks[name]:.3g} {unit}, the limit is {limit:.3g}"
        for name, unit, limit in limits_by_name(vehicle.limits)
        if peaks[name] > limit * (1.0 + _RELATIVE) + _rounding(name, trajectory)
    ]
    spot = bool((trajectory.path.directions == 0).any())
    if spot and not vehicle.may_turn_on_the_spot:
        violations.append("it turns on the spot, which the chair's curvature limit excludes")
    return LimitCheck(peaks, tuple(violations))


def limits_by_name(limits: Limits) -> list[tuple[str, str, float]]:
    """Return name, unit and value of every limit a motion is judged by."""
    return [
        ("speed", "m/s", limits.speed),
        ("reverse_speed", "m/s", limits.reverse_speed),
        ("acceleration", "m/s^2", limits.acceleration),
        ("jerk", "m/s^3", limits.jerk),
        ("yaw_rate", "rad/s", limits.yaw_rate),
        ("yaw_acceleration", "rad/s^2", limits.yaw_acceleration),
        ("lateral_acceleration", "m/s^2", limits.lateral_acceleration),
        ("wheel_speed", "m/s", max(limits.speed, limits.reverse_speed)),
        ("curvature", "1/m", limits.curvature),
        ("slip", "rad", SLIP),
    ]


def _rounding(name: str, trajectory: Trajectory) -> float:
    """Return what rounding adds to a derivative taken from rows of ten decimals."""
    if not trajectory.sampled:
        return 1e-6
    step = float(np.diff(trajectory.profile.breaks).min())
    order = {"jerk": 3, "acceleration": 2, "yaw_acceleration": 2}.get(name, 1)
    return 1e-6 + 8e-9 / step**order


def _peak(values: Array) -> float:
    return float(np.abs(values).max(initial=0.0))


def _peaks(trajectory: Trajectory, vehicle: Vehicle) -> dict[str, float]:
    """Return the peaks of a smooth trajectory, sampled at 1 kHz, a part at a time."""
    count = max(int(np.ceil(trajectory.duration * RATE)), 1)
    step = trajectory.duration / count
    overlap = round(PERIOD * RATE)
    peaks = {"jerk": _piece_jerk(trajectory, 0.5 * vehicle.track)}
    for first in range(0, count, _PART):
        time = np.arange(first, min(first + _PART + overlap, count) + 1.0) * step
        for name, value in _part_peaks(trajectory, vehicle, time).items():
            peaks[name] = max(peaks.get(name, 0.0), value)
    return peaks


def _part_peaks(trajectory: Trajectory, vehicle: Vehicle, time: Array) -> dict[str, float]:
    """Return the peaks at evenly spaced times, [v, omega] and their derivatives by formula."""
    path = trajectory.path
    s, rate, bend = _sampled(trajectory, time)
    kappa, kappa_rate, kappa_off, rate_off = path.curvature_table.with_errors(s)
    direction = path.directions[path.section_index(s)]
    omega = kappa * rate
    yaw_acceleration = kappa_rate * rate**2 + kappa * bend
    v = direction * rate
    acceleration, half = direction * bend, 0.5 * vehicle.track
    spot = direction == 0
    # what the limits of acceleration and jerk are about: the body origin, on the spot a rim
    pull = np.where(spot, half * yaw_acceleration, acceleration)
    omega_off = kappa_off * np.abs(rate)
    yaw_off = rate_off * rate**2 + kappa_off * np.abs(bend)
    turning = np.abs(omega) + omega_off
    step = float(time[1] - time[0])
    return {
        "speed": _peak(v[direction > 0]),
        "reverse_speed": _peak(v[direction < 0]),
        "acceleration": max(_peak(pull), _in_period(np.where(spot, half * omega, v), step)),
        "jerk": _in_period(pull, step),
        "yaw_rate": _peak(turning),
        "yaw_acceleration": max(_peak(np.abs(yaw_acceleration) + yaw_off), _in_period(omega, step)),
        "lateral_acceleration": _peak(v * turning),
        "wheel_speed": _peak(np.abs(v) + half * turning),
        "wheel_acceleration": _peak(np.abs(acceleration) + half * np.abs(yaw_acceleration)),
    }


def _sampled(trajectory: Trajectory, time: Array) -> tuple[Array, Array, Array]:
    """Return progress and its first two derivatives at increasing times, each shape (N,)."""
    profile = trajectory.profile
    piece = np.searchsorted(profile.breaks[1:-1], time, side="right")
    tau = time - profile.breaks[piece]
    c0, c1, c2, c3 = profile.coefficients[piece].T
    bend = 2.0 * c2 + 6.0 * c3 * tau
    rate = c1 + tau * (2.0 * c2 + 3.0 * c3 * tau)
    return c0 + tau * (c1 + tau * (c2 + tau * c3)), rate, bend


def _piece_jerk(trajectory: Trajectory, half_track: float) -> float:
    """Return the greatest jerk of the profile's pieces, of the body origin or of the rims."""
    path, profile = trajectory.path, trajectory.profile
    lever = np.where(path.directions == 0, half_track, 1.0)
    jerk = 6.0 * np.abs(profile.coefficients[:, 3])
    start = profile.coefficients[:, 0]
    length = np.diff(start, append=profile.span)
    return max(
        float((jerk * lever[path.section_index(start + share * length)]).max())
        for share in (0.02, 0.5, 0.98)
    )


def _in_period(values: Array, step: float) -> float:
    """Return the greatest change of samples a step [s] apart in a control period, per second.

    The mean of the derivative over a period: where there is one, never above its peak.
    """
    count = min(round(PERIOD * RATE), len(values) - 1)
    return _peak(values[count:] - values[:-count]) / (count * step)


def _row_peaks(trajectory: Trajectory, vehicle: Vehicle) -> dict[str, float]:
    """Return the peaks of a trajectory read from rows, by difference quotients."""
    breaks, path = trajectory.profile.breaks, trajectory.path
    middle = 0.5 * (breaks[:-1] + breaks[1:])
    command = trajectory.command(middle)
    v, omega = command.T
    half = 0.5 * vehicle.track
    spot = path.directions[path.section_index(trajectory.progress(middle))] == 0
    along = np.where(spot, half * omega, v)
    change = np.diff(along) / np.diff(middle)
    # the third divided difference of progress, times 3!: a mean value of the jerk
    third = np.diff(change) / ((breaks[3:] - breaks[:-3]) / 3.0)
    wheels = vehicle.wheel_speeds(command)
    pull = np.diff(wheels, axis=0) / np.diff(middle)[:, None]
    return {
        "speed": _peak(v[v > 0.0]),
        "reverse_speed": _peak(v[v < 0.0]),
        "acceleration": _peak(change),
        "jerk": _peak(third),
        "yaw_rate": _peak(omega),
        "yaw_acceleration": _row_yaw_acceleration(middle, omega),
        "lateral_acceleration": _peak(v * omega),
        "wheel_speed": _peak(wheels),
        "wheel_acceleration": _peak(pull),
    }


def _row_yaw_acceleration(middle: Array, omega: Array) -> float:
    """Return the greatest mean yaw acceleration over a control period or the next row's end."""
    later = np.searchsorted(middle, middle + (1.0 - 1e-6) * PERIOD)
    first = np.flatnonzero(later < len(middle))
    last = later[first]
    return _peak((omega[last] - omega[first]) / (middle[last] - middle[first]))
