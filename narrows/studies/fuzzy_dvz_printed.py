"""The zone of [FuzzyDVZ] as printed, mistakes and all, beside the right one, both without a guard.

Only for the comparison of the study: these chairs collide. What stays apart is one thing at a time:
the side of the long end (Eq. (7)), the sign of J_alpha (Eq. (17)), and all equations as printed:
J_BV with a_x twice (Eq. (19)), the sums of J and F over rays on which nothing is.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from ..errors import StudyError
from ..interfaces import Percept
from ..reactive.deformable_zone import DeformableZone, RayGrid
from ..reactive.fuzzy import FuzzyGoalController, polar_error
from ..reactive.switching import Active, Switch, Thresholds
from ..reactive.zone_law import ZoneGains, zone_law
from ..reactive.zone_shape import ZoneShape
from ..se2 import Array
from ..vehicle import Vehicle

VARIANTS = ("as printed", "long end ahead only", "right equations")
"""Zones compared, none with a guard."""

GAINS = ZoneGains(speed=0.5, turning=1.5)
"""Those with which the right equations of the paper's zone do best here."""

THRESHOLDS = Thresholds(0.12, 0.04)
CREEP, ARRIVAL, SPEED, PERIOD = 0.12, 0.1, 0.6, 0.05

_GRID = RayGrid(columns=120, rows=12, latitude=math.radians(66.0))


@dataclass(frozen=True)
class Sums:
    """I, J_V, J_alpha and F_rob of a zone."""

    intrusion: float
    by_speed: float
    by_heading: float
    by_driving: float


def printed_sums(ranges: Array, grid: RayGrid, shape: ZoneShape, speed: float) -> Sums:
    """Return I, J_V, J_alpha, F_rob by Eqs. (7)-(20) as they are printed, in the robot's frame.

    Over the upper half of all directions, which is what the printed bounds cover.

    Args:
        ranges: c, shape (rows, columns), infinite where nothing is, [m].
        grid: Its rays.
        shape: c_x_min and lambda.
        speed: V [m/s].
    """
    phi, theta = grid.latitudes[:, None], grid.azimuths[None, :]
    upper = np.broadcast_to(phi > 0.0, ranges.shape)
    x, y, z = np.cos(theta) * np.cos(phi), np.sin(theta) * np.cos(phi), np.sin(phi) + 0.0 * theta
    c, dc = shape.c_x(speed), 2.0 * shape.growth * speed
    b, db = math.sqrt(5.0) / 3.0 * c, math.sqrt(5.0) / 3.0 * dc  # c_y = c_z
    a, da = -2.0 / 3.0 * c, -2.0 / 3.0 * dc  # a_x: the long end behind
    square = b**4 * x**2 + c**2 * b**2 * (y**2 + z**2)
    linear = -2.0 * b**4 * a * x
    constant = a**2 * b**4 - c**2 * b**4
    root = np.sqrt(linear**2 - 4.0 * square * constant)
    reach = (-linear + root) / (2.0 * square)

    def slope(d_square: Array, d_linear: Array, d_constant: Array | float) -> Array:
        inner = (linear * d_linear - 2.0 * constant * d_square - 2.0 * square * d_constant) / root
        return np.asarray(
            (-d_linear + inner) / (2.0 * square) - d_square * (-linear + root) / (2.0 * square**2)
        )

    mixed = 2.0 * c * dc * b**2 + 2.0 * b * db * c**2
    by_speed = slope(
        4.0 * b**3 * db * x**2 + mixed * (y**2 + z**2),
        -2.0 * (4.0 * b**3 * db * a + b**4 * a * da) * x,
        2.0 * a * da * b**4 + 4.0 * a**2 * b**3 * db - 2.0 * c * dc * b**4 - 4.0 * c**2 * b**3 * db,
    )
    by_heading = slope(2.0 * x * y * (b**4 - c**2 * b**2), -2.0 * b**4 * a * y, 0.0)
    distance = np.minimum(ranges, reach)
    area = math.prod(grid.steps)

    def total(values: Array) -> float:
        return float(values[upper].sum() * area)

    return Sums(
        total((reach - distance) / distance),
        total(by_speed / distance),
        total(-by_heading / distance),
        total(reach / distance**2 * x),
    )


class UnguardedNavigator:
    """Fuzzy rules and a zone in turn, as the paper has them; a `narrows.interfaces.Controller`."""

    def __init__(self, vehicle: Vehicle, target: ArrayLike, variant: str) -> None:
        """Set off.

        Args:
            vehicle: The chair.
            target: Where to, shape (2,), [m].
            variant: One of `VARIANTS`.
        """
        if variant not in VARIANTS:
            raise StudyError("no such zone", value=variant, allowed=", ".join(VARIANTS))
        self._variant = variant
        self._target = np.asarray(target, dtype=float)
        self._goal = FuzzyGoalController(track=vehicle.track, speed=SPEED)
        self._limits = vehicle.limits
        height = vehicle.height
        self._shape = ZoneShape.paper(height=height)
        self._zone = DeformableZone(self._shape, _GRID)
        self._far = DeformableZone(ZoneShape(12.0, 0.0, heights=(0.0, height)), _GRID)
        self.switch = Switch(THRESHOLDS)
        self._command = np.zeros(2)
        self._intrusion, self._first, self._distance = 0.0, math.nan, math.nan

    @property
    def progress(self) -> float:
        """How much nearer to the target than at the start [m]."""
        return 0.0 if math.isnan(self._first) else self._first - self._distance

    @property
    def finished(self) -> bool:
        """Whether it has arrived."""
        return self._distance <= ARRIVAL

    @property
    def signals(self) -> Mapping[str, float]:
        """As the navigator's, as far as there are any."""
        return {
            "intrusion": self._intrusion,
            "active": float(self.switch.active),
            "switches": float(self.switch.count),
            "guard_share": 1.0,
            "target_distance": self._distance,
        }

    def step(self, time: float, pose: ArrayLike, percept: Percept) -> Array:
        """Return the command [v, omega] for the coming period, shape (2,)."""
        self._distance, _ = polar_error(pose, self._target)
        if math.isnan(self._first):
            self._first = self._distance
        if self.finished:
            return np.zeros(2)
        speed = max(float(self._command[0]), 0.0)
        change, omega = self._law(percept, speed)
        if self.switch.update(self._intrusion) is Active.GOAL:
            v, omega = self._goal.command(pose, self._target).tolist()
            v = min(v, speed + self._limits.acceleration * PERIOD)
        else:
            v = min(max(speed + change * PERIOD, CREEP), self._limits.speed)
        bound = self._limits.yaw_rate
        self._command = np.array([v, min(max(omega, -bound), bound)])
        return self._command.copy()

    def _law(self, percept: Percept, speed: float) -> tuple[float, float]:
        if self._variant != "as printed":
            found = self._zone.measure(percept.points, speed, spread=percept.spread)
            self._intrusion = found.intrusion
            change, omega = zone_law(found, speed, GAINS)
            return change, omega if self._variant == "right equations" else -omega
        ranges = self._far.ranges(percept.points, speed, spread=percept.spread)
        sums = printed_sums(ranges, _GRID, self._shape, speed)
        self._intrusion = sums.intrusion
        change = -GAINS.speed * sums.by_speed * sums.intrusion
        if abs(sums.by_speed) > 1e-9:  # at V = 0 the printed law divides by zero
            change -= sums.by_driving / sums.by_speed * speed
        change = min(max(change, -GAINS.braking), GAINS.speeding)
        return change, -GAINS.turning * sums.by_heading * sums.intrusion
