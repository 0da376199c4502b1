"""What a section of a path is: a smooth motion in one direction of travel."""

from __future__ import annotations

from typing import NamedTuple, Protocol

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .se2 import Array


class Enclosure(NamedTuple):
    """Proven bounds on the poses of N pieces of motion.

    Attributes:
        hull: Points whose convex hull holds every position of the piece, shape (N, H, 2), [m].
        middle: Pose in the middle of the piece, shape (N, 3), [m, m, rad].
        heading_low: Least heading on the piece, shape (N,), [rad].
        heading_high: Greatest heading on the piece, shape (N,), [rad].
    """

    hull: Array
    middle: Array
    heading_low: Array
    heading_high: Array


class Section(Protocol):
    """A motion that starts, goes one way and ends, by its progress.

    Progress is the arc length travelled by the body origin [m]; where the chair turns on the spot
    it is the angle turned [rad]. It increases in reverse too.
    """

    @property
    def direction(self) -> int:
        """+1 forward, -1 reverse, 0 turning on the spot."""
        ...

    @property
    def span(self) -> float:
        """Progress at the end, [m] or [rad]."""
        ...

    @property
    def pieces(self) -> int:
        """Number of analytic pieces, each with a local parameter in [0, 1]."""
        ...

    def evaluate(self, progress: ArrayLike, order: int = 0) -> Array:
        """Return the pose or its first or second derivative by progress, shape (..., 3)."""
        ...

    def locate(self, progress: Array) -> tuple[NDArray[np.int64], Array]:
        """Return the piece and its local parameter at progress, shapes (N,)."""
        ...

    def progress_at(self, piece: NDArray[np.int64], parameter: Array) -> Array:
        """Return the progress at local parameters of pieces, shapes (N,)."""
        ...

    def enclose(self, piece: NDArray[np.int64], low: Array, high: Array) -> Enclosure:
        """Return bounds on the poses of pieces between two local parameters, shapes (N,)."""
        ...
