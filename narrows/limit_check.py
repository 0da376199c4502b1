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

    A smooth trajectory is sampled at 1 kHz. One read from rows is judged by difference quotients,
    which are mean values of the true derivatives: they never exceed a limit the motion keeps.

    Args:
        trajectory: The timed motion.
        vehicle: Its limits and track.
    """
    peaks = _row_peaks(trajectory, vehicle) if trajectory.sampled else _peaks(trajectory, vehicle)
    peaks["curvature"] = trajectory.path.max_curvature
    peaks["slip"] = trajectory.slip()
    violations = [
        f"{name.replace('_', ' ')} reaches {peaks[name]:.3g} {unit}, the limit is {limit:.3g}"
        for name, unit, limit in _limits(vehicle.limits)
        if peaks[name] > limit * (1.0 + _RELATIVE) + _rounding(name, trajectory)
    ]
    spot = bool((trajectory.path.directions == 0).any())
    if spot and not vehicle.may_turn_on_the_spot:
        violations.append("it turns on the spot, which the chair's curvature limit excludes")
    return LimitCheck(peaks, tuple(violations))


def _limits(limits: Limits) -> list[tuple[str, str, float]]:
    return [
        ("speed", "m/s", limits.speed),
        ("reverse_speed", "m/s", limits.reverse_speed),
        ("acceleration", "m/s^2", limits.acceleration),
        ("jerk", "m/s^3", limits.jerk),
        ("yaw_rate", "rad/s", limits.yaw_rate),
        ("yaw_acceleration", "rad/s^2", limits.yaw_acceleration),
        ("lateral_acceleration", "m/s^2", limits.lateral_acceleration),
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
    """Return the peaks of a smooth trajectory, [v, omega] and their derivatives by formula."""
    count = int(np.ceil(trajectory.duration * RATE)) + 1
    time = np.linspace(0.0, trajectory.duration, count)
    path, s = trajectory.path, trajectory.progress(time)
    rate, bend, third = (trajectory.progress(time, k) for k in (1, 2, 3))
    direction = path.directions[path.section_index(s)]
    first, second = path(s, 1)[:, 2], path(s, 2)[:, 2]
    omega = first * rate
    yaw_acceleration = second * rate**2 + first * bend
    moving = direction != 0
    v = np.where(moving, direction * rate, 0.0)
    acceleration = np.where(moving, direction * bend, 0.0)
    wheels = vehicle.wheel_speeds(np.column_stack([v, omega]))
    pull = vehicle.wheel_speeds(np.column_stack([acceleration, yaw_acceleration]))
    return {
        "speed": _peak(v[direction > 0]),
        "reverse_speed": _peak(v[direction < 0]),
        "acceleration": _peak(acceleration),
        "jerk": _peak(third[moving]),
        "yaw_rate": _peak(omega),
        "yaw_acceleration": _peak(yaw_acceleration),
        "lateral_acceleration": _peak(v * omega),
        "wheel_speed": _peak(wheels),
        "wheel_acceleration": _peak(pull),
    }


def _row_peaks(trajectory: Trajectory, vehicle: Vehicle) -> dict[str, float]:
    """Return the peaks of a trajectory read from rows, by difference quotients."""
    breaks = trajectory.profile.breaks
    middle = 0.5 * (breaks[:-1] + breaks[1:])
    command = trajectory.command(middle)
    change = np.diff(command, axis=0) / np.diff(middle)[:, None]
    instant = 0.5 * (middle[:-1] + middle[1:])
    third = np.diff(change[:, 0]) / np.diff(instant)
    wheels = vehicle.wheel_speeds(command)
    pull = np.diff(wheels, axis=0) / np.diff(middle)[:, None]
    return {
        "speed": _peak(command[command[:, 0] > 0.0, 0]),
        "reverse_speed": _peak(command[command[:, 0] < 0.0, 0]),
        "acceleration": _peak(change[:, 0]),
        "jerk": _peak(third),
        "yaw_rate": _peak(command[:, 1]),
        "yaw_acceleration": _peak(change[:, 1]),
        "lateral_acceleration": _peak(command[:, 0] * command[:, 1]),
        "wheel_speed": _peak(wheels),
        "wheel_acceleration": _peak(pull),
    }
