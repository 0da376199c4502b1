"""What the navigator does where it comes no nearer: backs off, changes sides, goes round, gives up.

Fuzzy rules and a zone remember nothing, so they can stand before a thing for ever, or circle among
some. Two places to look at are enough to notice: where the chair last stirred, and where it came
nearest to its target. From the latter it then makes detours, to the left and to the right in turn,
wider and wider: what bars the way is behind them at last, unless there is no way.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from ..errors import ShapeError
from ..se2 import Array

_SAME_SIDE = 2  # retreats after which the other side is tried
_FORWARD = 0.5  # of a detour's width: how far beyond the barred place it leads
_THERE = 0.75  # m: a detour's point is reached


@dataclass(frozen=True)
class PersistenceOptions:
    """How long the navigator tries.

    Attributes:
        patience: Time in which the chair must move by `stir`, or it backs off; and once more, or it
            is stuck [s].
        stir: Distance [m]; a turn by as many metres of the body's furthest point counts too.
        backing: How far it backs off [m], where its limits let it reverse.
        retreats: How often it backs off without having come nearer to its target in between.
        change: Time after which it tries something else, if it has come no nearer to its target
            than ever by `stir`: at first it keeps to the other side, then come detours [s].
        detour: By so much every second detour is wider [m].
        endurance: Time in which it must come nearer to its target than ever by `stir` [s].
    """

    patience: float = 7.0
    stir: float = 0.1
    backing: float = 0.6
    retreats: int = 6
    change: float = 30.0
    detour: float = 1.5
    endurance: float = 120.0

    def __post_init__(self) -> None:
        """Check the numbers."""
        for name in ("patience", "stir", "change", "endurance"):
            if not 0.0 < getattr(self, name) < math.inf:
                raise ShapeError(f"{name} must be a positive number, got {getattr(self, name)}")
        for name in ("backing", "detour"):
            if not 0.0 <= getattr(self, name) < math.inf:
                raise ShapeError(f"{name} must be a number >= 0, got {getattr(self, name)}")


class Persistence:
    """Watches how driving to a target goes, and says what to try.

    Attributes:
        side: The side to turn to, +1 left.
        keeps_side_until: Time until which that is not to be chosen anew [s].
        aim: Where to drive now, the target or the point of a detour, shape (2,), [m].
        is_backing: Whether to back off.
        best: Least distance from the target so far [m]; NaN before the first look.
        first: The distance at the first look [m].
        outcome: Why it ended; empty while it goes on.
        arrived: Whether it ended at the target.
    """

    def __init__(
        self,
        target: Array,
        arrival: float,
        radius: float,
        reverses: bool,
        chosen: PersistenceOptions,
    ) -> None:
        """Begin.

        Args:
            target: Where to, world frame, shape (2,), [m].
            arrival: Distance from it at which the chair has arrived [m].
            radius: Of the body about its origin [m].
            reverses: Whether the chair may back off.
            chosen: How long to try.
        """
        self._target, self._arrival, self._radius = target, arrival, radius
        self._reverses, self._chosen = reverses, chosen
        self.side, self.keeps_side_until = 1.0, -math.inf
        self.aim, self.is_backing = target, False
        self.first = self.best = math.nan
        self.outcome, self.arrived = "", False
        self._best_at = self._stirred_at = self._change_at = math.nan
        self._nearest, self._stirred, self._left = np.zeros(2), np.zeros(3), np.zeros(2)
        self._retreats = self._changes = 0

    def watch(self, time: float, pose: Array, why: str) -> None:
        """Look at where the chair is now.

        Args:
            time: Now [s].
            pose: Of the chair, shape (3,).
            why: What holds it up, for people.
        """
        if self.outcome:
            return
        chosen, distance = self._chosen, math.dist(pose[:2], self._target)
        if math.isnan(self.best):
            self.first, self.best = distance, math.inf
            self._stirred, self._stirred_at = pose, time
        if distance < self.best - chosen.stir:
            self.best, self._best_at, self._nearest = distance, time, pose[:2]
            self._retreats = self._changes = 0
            self._aim_at(self._target, time)
        elif time >= self._change_at:
            self._try_something_else(time)
        elif self.aim is not self._target and math.dist(pose[:2], self.aim) < _THERE:
            self._aim_at(self._target, time)
        if _way(self._stirred, pose, self._radius) > chosen.stir:
            self._stirred, self._stirred_at = pose, time
        waited = time - self._stirred_at > chosen.patience
        if distance <= self._arrival:
            self.best, self.arrived = distance, True
            self.outcome = f"arrived, {distance:.2f} m from the target"
        elif time - self._best_at > chosen.endurance:
            self.outcome = f"comes no nearer than {self.best:.2f} m to the target"
        elif self.is_backing:
            if waited or math.dist(pose[:2], self._left) >= chosen.backing:
                self.is_backing, self.keeps_side_until = False, time + 2.0 * chosen.patience
                self._stirred, self._stirred_at = pose, time
        elif waited and self._reverses and self._retreats < chosen.retreats:
            self._back_off(time, pose)
        elif waited:
            self.outcome = f"stuck {distance:.2f} m from the target: {why or 'obstacles all about'}"

    def _back_off(self, time: float, pose: Array) -> None:
        self._retreats += 1
        self.is_backing, self._left = True, pose[:2]
        if self._retreats % _SAME_SIDE == 0:
            self.side = -self.side
        self._stirred, self._stirred_at = pose, time

    def _try_something_else(self, time: float) -> None:
        """Keep to the other side; after that go round on it, every second time wider."""
        self._changes += 1
        self.side = -self.side
        self.keeps_side_until = time + 0.5 * self._chosen.change
        width = self._chosen.detour * (self._changes // 2)
        if width <= 0.0:
            self._aim_at(self._target, time)
            return
        ahead = (self._target - self._nearest) / self.best
        aside = self.side * np.array([-ahead[1], ahead[0]])
        self._aim_at(self._nearest + width * (aside + _FORWARD * ahead), time)

    def _aim_at(self, point: Array, time: float) -> None:
        self.aim, self._change_at = point, time + self._chosen.change


def _way(first: Array, second: Array, radius: float) -> float:
    """Return the way of a body's furthest point between two poses, at most [m]."""
    moved = math.hypot(second[0] - first[0], second[1] - first[1])
    return moved + radius * abs(math.remainder(second[2] - first[2], 2.0 * math.pi))
