"""A section of constant twists between poses: lines, arcs, turns on the spot, sampled rows."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .errors import ShapeError
from .se2 import Array, compose, exponential, invert, logarithm, rotate
from .section import Enclosure

ON_THE_SPOT = 1e-4
"""Radius [m] below which an arc counts as a turn on the spot."""


def twist_directions(twists: Array) -> NDArray[np.int64]:
    """Return +1, -1 or 0 for twists that drive forward, in reverse, or turn on the spot.

    Args:
        twists: Body twists times duration [v_x, v_y, omega], shape (N, 3), [m, m, rad].
    """
    spot = np.hypot(twists[:, 0], twists[:, 1]) <= ON_THE_SPOT * np.abs(twists[:, 2])
    return np.where(spot, 0, np.where(twists[:, 0] >= 0.0, 1, -1)).astype(np.int64)


@dataclass(frozen=True, eq=False)
class TwistSection:
    """Poses joined by motions of constant twist: the body origin moves on arcs or lines.

    Between two poses the velocity in the body frame is constant, as under a constant command.
    Headings are taken as given, not wrapped: they say how far each piece turns.

    Attributes:
        poses: Poses, shape (N, 3), N >= 2, successive ones different, [m, m, rad].
    """

    poses: Array

    def __post_init__(self) -> None:
        """Check that all pieces move, and the same way; keep a read-only copy."""
        poses = np.array(self.poses, dtype=float)
        if poses.ndim != 2 or poses.shape[1] != 3 or len(poses) < 2:
            raise ShapeError(f"poses must be (N >= 2, 3), got {poses.shape}")
        if not np.isfinite(poses).all():
            raise ShapeError("poses must be finite numbers")
        poses.setflags(write=False)
        object.__setattr__(self, "poses", poses)
        directions = twist_directions(self.twists)
        if not self.twists.any(axis=1).all():
            raise ShapeError("successive poses of a section must differ")
        if len(np.unique(directions)) > 1:
            raise ShapeError("a section drives one way; split it where the direction changes")

    @cached_property
    def twists(self) -> Array:
        """Body twist times duration of each piece, shape (N - 1, 3), [m, m, rad]."""
        twists = logarithm(compose(invert(self.poses[:-1]), self.poses[1:]))
        if (np.abs(twists[:, 2]) > 1.5 * np.pi).any():
            raise ShapeError("a piece turns by more than 3/4 of a turn; give poses in between")
        return twists

    @cached_property
    def direction(self) -> int:
        """+1 forward, -1 reverse, 0 turning on the spot."""
        return int(twist_directions(self.twists)[0])

    @cached_property
    def _lengths(self) -> Array:
        if self.direction == 0:
            return np.abs(self.twists[:, 2])
        return np.hypot(self.twists[:, 0], self.twists[:, 1])

    @cached_property
    def _ends(self) -> Array:
        return np.cumsum(self._lengths)

    @property
    def span(self) -> float:
        """Arc length [m], or angle turned on the spot [rad]."""
        return float(self._ends[-1])

    @property
    def pieces(self) -> int:
        """Number of twists."""
        return len(self.poses) - 1

    def locate(self, progress: Array) -> tuple[NDArray[np.int64], Array]:
        """Return the twist and the fraction of it driven at progress, shapes (N,)."""
        s = np.clip(progress, 0.0, self.span)
        piece = np.minimum(np.searchsorted(self._ends, s, side="left"), self.pieces - 1)
        length = self._lengths[piece]
        return piece, (s - (self._ends[piece] - length)) / length

    def evaluate(self, progress: ArrayLike, order: int = 0) -> Array:
        """Return the pose or its derivative by progress; see `narrows.section.Section`.

        At a joint of two twists derivatives are those of the piece that ends there.
        """
        s = np.asarray(progress, dtype=float)
        piece, fraction = self.locate(s.ravel())
        twist = self.twists[piece]
        pose = compose(self.poses[piece], exponential(fraction[:, None] * twist))
        rate = twist / self._lengths[piece][:, None]
        velocity = rotate(pose[:, 2], rate[:, :2])
        if order == 0:
            result = pose
        elif order == 1:
            result = np.column_stack([velocity, rate[:, 2]])
        elif order == 2:
            turned = np.column_stack([-velocity[:, 1], velocity[:, 0]]) * rate[:, 2:]
            result = np.column_stack([turned, np.zeros(len(turned))])
        else:
            raise ShapeError(f"the order of a section's derivative is 0, 1 or 2, got {order}")
        return result.reshape(*s.shape, 3)

    def progress_at(self, piece: NDArray[np.int64], parameter: Array) -> Array:
        """Return the progress at fractions of twists, shape (N,), [m] or [rad]."""
        return np.asarray(self._ends[piece] - (1.0 - parameter) * self._lengths[piece])

    def enclose(self, piece: NDArray[np.int64], low: Array, high: Array) -> Enclosure:
        """Return bounds on poses: an arc lies in the triangle of its chord and end tangents.

        The triangle's tip is at (chord / 2) / cos(alpha / 2) along the first tangent for an arc
        of angle alpha; past a third of a turn a box about the chord's start is used instead.
        """
        twist = self.twists[piece]
        start = compose(self.poses[piece], exponential(low[:, None] * twist))
        end = compose(self.poses[piece], exponential(high[:, None] * twist))
        half = 0.5 * (high - low)
        middle = compose(start, exponential(half[:, None] * twist))
        bend = half * twist[:, 2]  # half the angle turned
        chord = end[:, :2] - start[:, :2]
        tangent = rotate(start[:, 2], twist[:, :2])
        length = np.linalg.norm(tangent, axis=1, keepdims=True)
        tangent = np.divide(tangent, length, out=np.zeros_like(tangent), where=length > 0.0)
        reach = 0.5 * np.linalg.norm(chord, axis=1) / np.maximum(np.cos(bend), 0.5)
        tip = start[:, :2] + reach[:, None] * tangent
        hull = np.stack([start[:, :2], tip, tip, end[:, :2]], axis=1)
        wide = np.abs(bend) > np.pi / 3.0
        if wide.any():
            travelled = (2.0 * half * length[:, 0])[wide, None]
            corners = np.array([[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]])
            hull[wide] = start[wide, None, :2] + travelled[..., None] * corners
        low_heading = np.minimum(start[:, 2], end[:, 2])
        return Enclosure(hull, middle, low_heading, np.maximum(start[:, 2], end[:, 2]))
