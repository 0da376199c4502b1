"""What the assistant may rely on of what it is told it perceives."""

from __future__ import annotations

import math

import numpy as np

from ..interfaces import Percept
from ..se2 import Array, invert, transform


class View:
    """Keeps the last percept that made sense, carried along by the chair's own motion.

    Attributes:
        points: Obstacles in the body frame now, shape (N, 3), [m].
        unknown: Unknown places, shape (M, 2), [m].
        spread: How far an obstacle may reach beyond its point [m].
        trust: 1: as good as new; 0: too old, missing or without sense.
        is_known: Whether any percept ever made sense.
    """

    def __init__(self, fresh: float, stale: float) -> None:
        """Begin blind.

        Args:
            fresh: Age up to which a percept is as good as new [s].
            stale: Age from which on it is worth nothing [s].
        """
        self._fresh = fresh
        self._stale = stale
        self.points: Array = np.zeros((0, 3))
        self.unknown: Array = np.zeros((0, 2))
        self.spread = 0.0
        self.trust = 0.0
        self.is_known = False

    def update(self, time: float, percept: Percept | None, moved: Array) -> None:
        """Take in a percept.

        Args:
            time: Now [s].
            percept: What is perceived now, in the body frame now; None: nothing.
            moved: Pose of the chair now in its frame at the last update, shape (3,).
        """
        if percept is not None and _makes_sense(percept, time):
            self.points, self.unknown = percept.points, percept.unknown
            self.spread = percept.spread
            self.is_known = True
            span = self._stale - self._fresh
            self.trust = min(max((self._stale - (time - percept.time)) / span, 0.0), 1.0)
            return
        self.trust = 0.0
        back = invert(moved)
        self.points = np.column_stack([transform(back, self.points[:, :2]), self.points[:, 2]])
        self.unknown = transform(back, self.unknown)


def _makes_sense(percept: Percept, time: float) -> bool:
    """Return whether all numbers of a percept are finite and it is not from the future."""
    if not (math.isfinite(percept.time) and percept.time <= time + 1e-3):
        return False
    if not (math.isfinite(percept.spread) and percept.spread >= 0.0):
        return False
    return bool(np.isfinite(percept.points).all() and np.isfinite(percept.unknown).all())
