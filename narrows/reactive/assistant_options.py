"""What the driving assistant is told, and the states it can be in."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from enum import IntEnum

from ..errors import ShapeError
from .avoidance import AvoidanceOptions


class AssistantState(IntEnum):
    """States of the assistant, [DrivingAssistant, Fig. 4]."""

    FULL_USER_CONTROL = 0
    BRAKING = 1
    OBSTACLE_AVOIDANCE = 2
    RESTORING_ORIENTATION = 3


@dataclass(frozen=True)
class AssistantOptions:
    """How the driving assistant works.

    Attributes:
        period: Control period [s].
        latency: Time from a command to its taking effect [s]; bridged by the commands on their
            way. What is longer or jitters belongs into the latency of the safety regions.
        motor_lag: Time constant of the wheels [s].
        yaw_jerk: Limit of the yaw's jerk [rad/s^3]; a chair's limits hold none.
        comfort: Share of the acceleration limit that comfortable braking uses.
        fresh: Age up to which a percept is as good as new [s].
        stale: Age from which on it allows no motion [s]; between the two, less and less.
        unknown_speed: Rim speed at which the chair may drive into places nothing is known of
            [m/s]; 0: it stops before them.
        steers: Whether steering is corrected; else only the speed is limited.
        sides: Name of the table of sides.
        close: Obstacles that allow less than this share of the speed asked for are close.
        avoidance: How a way past obstacles is looked for.
        restores: Whether the orientation is restored after an avoidance.
        restore_gain: Heading rate per heading error while restoring [1/s].
        restore_tolerance: Heading error at which it is restored [rad].
        restore_time: Longest time of restoring [s].
        hand_tolerance: Change of the user's command, as a share of the limits, that is none [-].
        disobedience: Rim speed above the safe one at which a chair that was not told so is braked
            fully [m/s].
    """

    period: float = 0.02
    latency: float = 0.0
    motor_lag: float = 0.05
    yaw_jerk: float = 10.0
    comfort: float = 0.8
    fresh: float = 0.25
    stale: float = 0.6
    unknown_speed: float = 0.0
    steers: bool = True
    sides: str = "corrected"
    close: float = 0.95
    avoidance: AvoidanceOptions = field(default_factory=AvoidanceOptions)
    restores: bool = True
    restore_gain: float = 1.5
    restore_tolerance: float = math.radians(2.0)
    restore_time: float = 5.0
    hand_tolerance: float = 0.15
    disobedience: float = 0.08

    def __post_init__(self) -> None:
        """Check the ranges."""
        for name in ("period", "yaw_jerk", "restore_gain", "restore_tolerance"):
            value = getattr(self, name)
            if not (0.0 < value < math.inf):
                raise ShapeError(f"{name} must be a finite positive number, got {value}")
        for name in ("latency", "motor_lag", "unknown_speed", "restore_time", "disobedience"):
            value = getattr(self, name)
            if not (0.0 <= value < math.inf):
                raise ShapeError(f"{name} must be a finite number >= 0, got {value}")
        for name in ("comfort", "close", "hand_tolerance"):
            value = getattr(self, name)
            if not (0.0 < value <= 1.0):
                raise ShapeError(f"{name} must be a share above 0 and up to 1, got {value}")
        if not 0.0 <= self.fresh < self.stale < math.inf:
            raise ShapeError(
                f"ages must be 0 <= fresh < stale, got {self.fresh} and {self.stale} s"
            )
