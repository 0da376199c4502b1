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
from .deformable_zone import DeformableZone, Deformation, RayGrid, ZoneGains, zone_law
from .fuzzy import FuzzyGoalController, polar_error
from .fuzzy_table import DERIVED, RuleTable
from .navigator_guard import Guard
from .navigator_guard_options import GuardOptions
from .switching import Active, Switch, Thresholds
from .zone_shape import ZoneShape

Velocities = Callable[[float, Array], Array]
"""Velocities over the floor (N, 2) [m/s] of points of the world (N, 3) at a time [s]."""

_FACING = math.radians(75.0)  # the target is before the chair
_SAME_SIDE = 2  # retreats after which the other side is tried


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
        patience: Time in which the chair must move by `stir`, or it backs off; and once more, or it
            is stuck [s].
        stir: Distance [m]; a turn by as many metres of the body's furthest point counts too.
        backing: How far it backs off [m], where its limits let it reverse.
        retreats: How often it backs off without having come nearer to its target in between.
        change: Time after which it keeps to the other side for half as long, if it has come no
            nearer to its target than ever by `stir` [s].
        endurance: Time in which it must come nearer to its target than ever by `stir` [s].
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
    patience: float = 5.0
    stir: float = 0.1
    backing: float = 0.6
    retreats: int = 6
    change: float = 30.0
    endurance: float = 120.0

    def __post_init__(self) -> None:
        """Check the numbers."""
        for name in ("arrival", "speed", "patience", "stir", "change", "endurance"):
            if not 0.0 < getattr(self, name) < math.inf:
                raise ShapeError(f"{name} must be a positive number, got {getattr(self, name)}")
        for name in ("creep", "tie", "docking", "pivot", "backing"):
            if not 0.0 <= getattr(self, name) < math.inf:
                raise ShapeError(f"{name} must be a number >= 0, got {getattr(self, name)}")


class Navigator:
    """Drives to a point through what it perceives; a `narrows.interfaces.Controller`.

    Attributes:
        zone: The deformable zone.
        guard: The guard.
        switch: Who drives.
        reason: How it stands, for people; the outcome once it has finished.
        arrived: Whether it is at its target.
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
        self._limits = vehicle.limits
        self._target = np.array(target, dtype=float)
        if self._target.shape != (2,) or not np.isfinite(self._target).all():
            raise ShapeError(f"the target must be a finite point (2,), got {self._target}")
        speed = min(self.options.speed, vehicle.limits.speed)
        self._goal = FuzzyGoalController(rules, track=vehicle.track, speed=speed)
        shape = self.options.zone or ZoneShape.around(vehicle)
        self.zone = DeformableZone(shape, self.options.grid)
        self.guard = Guard(vehicle, self.options.guard)
        self.switch = Switch(self.options.thresholds)
        self.reason, self.arrived = "on its way", False
        self._velocities = velocities
        self._finished = False
        self._command = np.zeros(2)
        self._side, self._side_until, self._dock_after = 1.0, -math.inf, -math.inf
        self._first = self._best = math.nan
        self._best_at = self._stirred_at = self._change_at = math.nan
        self._stirred, self._radius = np.zeros(3), vehicle.radius
        self._retreat: Array | None = None
        self._retreats = 0
        self._deformation = Deformation()
        self._distance = math.nan

    @property
    def progress(self) -> float:
        """How much nearer to the target it has been than at the start [m]."""
        return 0.0 if math.isnan(self._first) else self._first - self._best

    @property
    def finished(self) -> bool:
        """Whether it has arrived or given up."""
        return self._finished

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
        if self._finished:
            return Active.STOPPED
        return self.switch.active if self._retreat is None else Active.BACKING

    def step(self, time: float, pose: ArrayLike, percept: Percept) -> Array:
        """Return the command [v, omega] for the coming period, shape (2,), [m/s, rad/s]."""
        pose = np.asarray(pose, dtype=float)
        self._distance, bearing = polar_error(pose, self._target)
        v = max(float(self._command[0]), 0.0)
        self._deformation = self._measured(time, pose, percept, v)
        self._watch(time, pose)
        if self._finished:
            self._command = self.guard.stop(time)
            return self._command.copy()
        before = self.switch.active
        docks = self._docks(time, bearing)
        active = self.switch.update(0.0 if docks else self._deformation.intrusion)
        if active is Active.ZONE and before is Active.GOAL and time > self._side_until:
            self._side = self._chosen_side(bearing)
        wanted, otherwise = self._wanted(pose, v, active)
        self._command = self.guard.limit(time, pose, percept, wanted, otherwise=otherwise)
        return self._command.copy()

    def _docks(self, time: float, bearing: float) -> bool:
        """Return whether the target is so near that what stands beside it does not matter."""
        chosen = self.options
        if self._distance > chosen.docking or abs(bearing) > _FACING or self._retreat is not None:
            return False
        if self.guard.share == 0.0:
            self._dock_after = time + 0.5 * chosen.patience
        return time >= self._dock_after

    def _wanted(self, pose: Array, v: float, active: Active) -> tuple[Array, tuple[Array, ...]]:
        """Return the command wanted, and others for where no share of it passes."""
        if self._retreat is not None:
            speed = -min(self.options.creep, self._limits.reverse_speed)
            aside = np.array([speed, self._side * self.options.creep])
            return self._limited(aside), (self._limited(np.array([speed, 0.0])),)
        if active is Active.GOAL:
            return self._limited(self._goal.command(pose, self._target)), ()
        if active is Active.ZONE:
            pivot = np.array([0.0, self._side * self.options.pivot])
            return self._limited(self._avoiding(v)), (self._limited(pivot),)
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

    def _avoiding(self, v: float) -> Array:
        """Return the command of the zone's law, and of the tie broken."""
        found, chosen = self._deformation, self.options
        change, omega = zone_law(found, v, chosen.gains)
        speed = max(v + change * chosen.guard.period, chosen.creep)
        if found.by_driving > 0.0:  # what is before the chair
            omega += self._side * chosen.tie * chosen.gains.turning * found.intrusion
        return np.array([speed, omega])

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

    def _watch(self, time: float, pose: Array) -> None:
        """Finish where the chair has arrived or comes no nearer; back off where it is stuck."""
        if self._finished:
            return
        chosen, distance = self.options, self._distance
        if math.isnan(self._first):
            self._first = self._best = distance
            self._best_at = self._stirred_at = time
            self._change_at = time + chosen.change
            self._stirred = pose
        if distance < self._best - chosen.stir:
            self._best, self._best_at, self._retreats = distance, time, 0
            self._change_at = time + chosen.change
        elif time >= self._change_at:  # it goes round and round: the other way this time
            self._side, self._change_at = -self._side, time + chosen.change
            self._side_until = time + 0.5 * chosen.change
        if _way(self._stirred, pose, self._radius) > chosen.stir:
            self._stirred, self._stirred_at = pose, time
        waited = time - self._stirred_at > chosen.patience
        if distance <= chosen.arrival:
            self._best = distance
            self._finish(f"arrived, {distance:.2f} m from the target", arrived=True)
        elif time - self._best_at > chosen.endurance:
            self._finish(f"comes no nearer than {self._best:.2f} m to the target")
        elif self._retreat is not None:
            backed = math.hypot(pose[0] - self._retreat[0], pose[1] - self._retreat[1])
            if backed >= chosen.backing or waited:
                self._retreat = None
                self._side_until = time + 2.0 * chosen.patience
                self._stirred, self._stirred_at = pose, time
        elif waited and self._retreats < chosen.retreats and self._limits.reverse_speed > 0.0:
            self._retreats += 1
            self._retreat = pose
            if self._retreats % _SAME_SIDE == 0:
                self._side = -self._side
            self._stirred, self._stirred_at = pose, time
        elif waited:
            why = self.guard.reason or "obstacles all about"
            self._finish(f"stuck {distance:.2f} m from the target: {why}")

    def _finish(self, reason: str, *, arrived: bool = False) -> None:
        self._finished, self.arrived, self.reason = True, arrived, reason


def _way(first: Array, second: Array, radius: float) -> float:
    """Return the way of a body's furthest point between two poses, at most [m]."""
    moved = math.hypot(second[0] - first[0], second[1] - first[1])
    return moved + radius * abs(math.remainder(second[2] - first[2], 2.0 * math.pi))
