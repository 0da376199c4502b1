"""A sensed door, and what finds a path through it."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Protocol

import numpy as np

from ..errors import ShapeError
from ..se2 import Array


@dataclass(frozen=True)
class DoorAhead:
    """A doorway as sensed, in the body frame.

    Attributes:
        x: Middle of the opening, ahead of the chair [m].
        y: The same to its left [m].
        heading: Direction of driving through [rad].
        width: Clear width [m].
    """

    x: float
    y: float
    heading: float
    width: float

    def __post_init__(self) -> None:
        """Check the numbers."""
        if not all(math.isfinite(value) for value in vars(self).values()) or self.width <= 0.0:
            raise ShapeError(f"a door needs finite numbers and a positive width, got {vars(self)}")

    @property
    def pose(self) -> Array:
        """Middle and direction as a pose in the body frame, shape (3,)."""
        return np.array([self.x, self.y, self.heading])


class PathSource(Protocol):
    """Anything that finds a certified path through a door: a planner, for example."""

    def __call__(self, door: DoorAhead) -> Array | None:
        """Return poses of a path the chair may drive forward, or None if there is none.

        Args:
            door: The door in the body frame.

        Returns:
            Poses in the body frame now, shape (N, 3), N >= 2, from where the chair is to beyond the
            door, not more than about 0.1 m apart.
        """
        ...


def checked_path(path: Array) -> Array:
    """Return a path's poses.

    Raises:
        ShapeError: If they are not (N >= 2, 3) and finite.
    """
    poses = np.asarray(path, dtype=float)
    if poses.ndim != 2 or poses.shape[1:] != (3,) or len(poses) < 2:
        raise ShapeError(f"a path through a door must have shape (N >= 2, 3), got {poses.shape}")
    if not np.isfinite(poses).all():
        raise ShapeError("a path through a door must be of finite numbers")
    return poses
