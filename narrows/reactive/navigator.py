"""The navigator of [FuzzyDVZ]: to a goal by fuzzy rules, round obstacles by the deformable zone.

What the paper's does not have: a guard that has the last word (`navigator_guard`), a turn away
from what stands straight ahead, a speed below which the zone does not hold the chair up, and an
end to driving that comes to nothing.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import ArrayLike

from ..errors import ShapeError
from ..interfaces import Percept
from ..se2 import Array, rotate, transform
from ..vehicle import Vehicle
from .deformable_zone import DeformableZone, Deformation, RayGrid
from .fuzzy import FuzzyGoalController, polar_error
from .fuzzy_table import DERIVED, RuleTable
from .navigator_guard import Guard
from .navigator_guard_options import GuardOptions
from .navigator_persistence import Persistence, PersistenceOptions
from .switching import Active, Switch, Thresholds
from .zone_law import ZoneGains, zone_law
from .zone_shape import ZoneShape

Velocities = Callable[[float, Array], Array]
"""Velocities over the floor (N, 2) [m/s] of points of the world (N, 3) at a time [s]."""

_FACING = math.radians(75.0)  # the target is before the chair
_BESIDE = 0.1  # m: what stands that near beside the way straight on bars it too


@dataclass(frozen=True)
class NavigatorOptions:
    """How the navigator drives.

    Attributes:
        arrival: Distance from the target at which it has arrived [m].
        speed: Rim speed of the rules' greatest output [m/s]; at most the chair's limit.
        zone: The zone; None: `ZoneShape.around` the chair.
        grid: Its rays.
        gains: Of the zone's law.
        thresholds: Intrusions at which the controllers change.
        creep: Speed the zone leaves the chair [m/s]; the guard may take it.
        pivot: Rate of turning on the spot where the way of the zone is barred [rad/s].
        tie: Turn by the zone that is added to the side chosen, as a share of what the whole
            intrusion could ask for; breaks the tie before an obstacle straight ahead.
        docking: Nearer than this to the target, and facing it, the goal controller drives whatever
            intrudes, as long as the guard lets it [m].
        guard: What the guard reckons with.
        persistence: What it does where it comes no nearer.
    """

    arrival: float = 0.1
    speed: float = 0.6
    zone: ZoneShape | None = None
    grid: RayGrid = field(default_factory=RayGrid)
    gains: ZoneGains = field(default_factory=ZoneGains)
    thresholds: Thresholds = field(default_factory=Thresholds)
    creep: float = 0.12
    pivot: float = 0.5
    tie: float = 0.5
    docking: float = 0.9
    guard: GuardOptions = field(default_factory=GuardOptions)
    persistence: PersistenceOptions = field(default_factory=PersistenceOptions)

    def __post_init__(self) -> None:
        """Check the numbers."""
        for name in ("arrival", "speed"):
            if not 0.0 < getattr(self, name) < math.inf:
                raise ShapeError(f"{name} must be a positive number, got {getattr(self, name)}")
        for name in ("creep", "tie", "docking", "pivot"):
            if not 0.0 <= getattr(self, name) < math.inf:
                raise ShapeError(f"{name} must be a number >= 0, got {getattr(self, name)}")


class Navigator:
    """Drives to a point through what it perceives; a `narrows.interfaces.Controller`.

    Attributes:
        zone: The deformable zone.
        guard: The guard.
        switch: Who drives.
    """

    def __init__(
        self,
        vehicle: Vehicle,
        target: ArrayLike,
        options: NavigatorOptions | None = None,
        *,
        rules: RuleTable | str = DERIVED,
        velocities: Velocities | None = None,
    ) -> None:
        """Set off for a target.

        Args:
            vehicle: The chair.
            target: Where to, world frame, shape (2,), [m].
            options: How it drives.
            rules: Rule table of the goal controller.
            velocities: Known velocities of what it perceives, for [FuzzyDVZ, Eq. (22)]; None: all
                is taken to stand, Eq. (21).
        """
        self.options = NavigatorOptions() if options is None else options
        self._limits = limits = vehicle.limits
        self._half = float(np.abs(vehicle.outline[:, 1]).max()) + _BESIDE
        self._target = np.array(target, dtype=float)
        if self._target.shape != (2,) or not np.isfinite(self._target).all():
            raise ShapeError(f"the target must be a finite point (2,), got {self._target}")
        speed = min(self.options.speed, vehicle.limits.speed)
        self._goal = FuzzyGoalController(rules, track=vehicle.track, speed=speed)
        shape = self.options.zone or ZoneShape.around(vehicle)
        self.zone = DeformableZone(shape, self.options.grid)
        self.guard = Guard(vehicle, self.options.guard)
        self.switch = Switch(self.options.thresholds)
        self._persistence = Persistence(
            self._target,
            self.options.arrival,
            vehicle.radius,
            limits.reverse_speed > 0.0,
            self.options.persistence,
        )
        self._velocities = velocities
        self._command, self._dock_after = np.zeros(2), -math.inf
        self._deformation, self._distance = Deformation(), math.nan

    @property
    def progress(self) -> float:
        """How much nearer to the target it has been than at the start [m]."""
        watched = self._persistence
        return 0.0 if math.isnan(watched.first) else watched.first - watched.best

    @property
    def finished(self) -> bool:
        """Whether it has arrived or given up."""
        return bool(self._persistence.outcome)

    @property
    def arrived(self) -> bool:
        """Whether it is at its target."""
        return self._persistence.arrived

    @property
    def reason(self) -> str:
        """How it stands, for people; the outcome once it has finished."""
        return self._persistence.outcome or "on its way"

    @property
    def signals(self) -> Mapping[str, float]:
        """Intrusion, who drives (`Active`), changes, share the guard let pass."""
        return {
            "intrusion": self._deformation.intrusion,
            "active": float(self._active),
            "switches": float(self.switch.count),
            "guard_share": self.guard.share,
            "target_distance": self._distance,
        }

    @property
    def _active(self) -> Active:
        if self.finished:
            return Active.STOPPED
        return Active.BACKING if self._persistence.is_backing else self.switch.active

    def step(self, time: float, pose: ArrayLike, percept: Percept) -> Array:
        """Return the command [v, omega] for the coming period, shape (2,), [m/s, rad/s]."""
        pose = np.asarray(pose, dtype=float)
        self._distance, bearing = polar_error(pose, self._target)
        v = max(float(self._command[0]), 0.0)
        self._deformation = self._measured(time, pose, percept, v)
        watched = self._persistence
        watched.watch(time, pose, self.guard.reason)
        if self.finished:
            self._command = self.guard.stop(time)
            return self._command.copy()
        before = self.switch.active
        docks = self._docks(time, bearing)
        active = self.switch.update(0.0 if docks else self._deformation.intrusion)
        if active is Active.ZONE and before is Active.GOAL and time > watched.keeps_side_until:
            watched.side = self._chosen_side(polar_error(pose, watched.aim)[1])
        wanted, otherwise = self._wanted(pose, percept, v, active)
        self._command = self.guard.limit(time, pose, percept, wanted, otherwise=otherwise)
        return self._command.copy()

    def _docks(self, time: float, bearing: float) -> bool:
        """Return whether the target is so near that what stands beside it does not matter."""
        chosen, watched = self.options, self._persistence
        elsewhere = watched.is_backing or watched.aim is not self._target
        if self._distance > chosen.docking or abs(bearing) > _FACING or elsewhere:
            return False
        if self.guard.share == 0.0:
            self._dock_after = time + 0.5 * chosen.persistence.patience
        return time >= self._dock_after

    def _wanted(
        self, pose: Array, percept: Percept, v: float, active: Active
    ) -> tuple[Array, tuple[Array, ...]]:
        """Return the command wanted, and others for where no share of it passes."""
        watched = self._persistence
        if watched.is_backing:
            speed = -min(self.options.creep, self._limits.reverse_speed)
            aside = np.array([speed, watched.side * self.options.creep])
            return self._limited(aside), (self._limited(np.array([speed, 0.0])),)
        if active is Active.GOAL:
            return self._limited(self._goal.command(pose, watched.aim)), ()
        if active is Active.ZONE:
            pivot = np.array([0.0, watched.side * self.options.pivot])
            return self._limited(self._avoiding(percept, v)), (self._limited(pivot),)
        raise ShapeError(f"nobody drives: {active}")

    def _measured(self, time: float, pose: Array, percept: Percept, v: float) -> Deformation:
        points, velocities = percept.points, None
        if self._velocities is not None:
            world = np.column_stack([transform(pose, points[:, :2]), points[:, 2]])
            velocities = rotate(-pose[2], self._velocities(time, world))
        return self.zone.measure(points, v, spread=percept.spread, velocities=velocities)

    def _chosen_side(self, bearing: float) -> float:
        """Return the side to turn to, +1 left: away from the nearer obstacle, else the target's."""
        found = self._deformation
        lopsided = found.by_heading / max(found.intrusion, 1e-9)
        if abs(lopsided) > 0.1:
            return -math.copysign(1.0, lopsided)
        return math.copysign(1.0, bearing)

    def _avoiding(self, percept: Percept, v: float) -> Array:
        """Return the command of the zone's law, and of the tie broken."""
        found, chosen = self._deformation, self.options
        change, omega = zone_law(found, v, chosen.gains)
        speed = max(v + change * chosen.guard.period, chosen.creep)
        if self._is_barred(percept, v):
            omega += self._persistence.side * chosen.tie * chosen.gains.turning * found.intrusion
        return np.array([speed, omega])

    def _is_barred(self, percept: Percept, v: float) -> bool:
        """Return whether something within the zone stands before the whole width of the chair."""
        points = percept.points
        ahead = points[(points[:, 0] > 0.0) & (np.abs(points[:, 1]) < self._half + percept.spread)]
        low, high = self.zone.shape.heights
        ahead = ahead[(ahead[:, 2] >= low) & (ahead[:, 2] < high)]
        return bool(self.zone.shape.holds(ahead, v).any())

    def _limited(self, wanted: Array) -> Array:
        """Return a command within the chair's limits, speeding up no faster than they allow."""
        limits, period = self._limits, self.options.guard.period
        v, omega = wanted.tolist()
        v = min(v, self._command[0] + limits.acceleration * period, limits.speed)
        omega = min(max(omega, -limits.yaw_rate), limits.yaw_rate)
        if abs(v * omega) > limits.lateral_acceleration:
            v = limits.lateral_acceleration / abs(omega)
        reach = limits.yaw_acceleration * period
        omega = min(max(omega, self._command[1] - reach), self._command[1] + reach)
        return np.array([max(v, -limits.reverse_speed), omega])
