"""Where to drive, without saying when: sections with a direction of travel, by progress."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise
from typing import Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .curvature_table import CurvatureTable
from .errors import ShapeError
from .se2 import Array, compose, invert, logarithm, wrap
from .section import Section
from .twist_section import TwistSection, twist_directions

Joint = Literal["before", "after"]
"""Which of the two sections that meet in it a joint belongs to."""

JOINT_TOLERANCE = 1e-5
"""Largest gap [m] or bend [rad] between sections: what a solver's tolerance leaves."""


@dataclass(frozen=True, eq=False)
class Path:
    """A motion of the body frame through the plane, by progress.

    Progress is the arc length travelled [m], increasing in reverse too; while turning on the spot
    it is the angle turned [rad]. The heading is unwrapped along the path.

    >>> line = Path.from_poses([[0, 0, 0], [2, 0, 0]])
    >>> line(0.5), line.length
    (array([0.5, 0. , 0. ]), 2.0)

    Attributes:
        sections: Smooth motions, each starting where the one before ends.
    """

    sections: tuple[Section, ...]

    def __post_init__(self) -> None:
        """Check that the sections join."""
        if not self.sections:
            raise ShapeError("a path needs at least one section")
        for before, after in pairwise(self.sections):
            end, start = before.evaluate(before.span), after.evaluate(0.0)
            gap = float(np.hypot(*(start - end)[:2]))
            bend = abs(float(wrap(start[2] - end[2])))
            if max(gap, bend) > JOINT_TOLERANCE:
                raise ShapeError(f"sections do not join: {gap:.3g} m and {bend:.3g} rad apart")

    @classmethod
    def from_poses(cls, poses: ArrayLike) -> Path:
        """Return the path through poses with constant twist between them.

        Sections end where the direction of travel changes. Repeated poses are dropped. Headings
        may be wrapped: each step turns the short way.

        Args:
            poses: Poses [x, y, heading], shape (N, 3), at least two different, [m, m, rad].

        Raises:
            ShapeError: If the shape is wrong, a number is not finite, or nothing moves.
        """
        rows = np.array(poses, dtype=float)
        if rows.ndim != 2 or rows.shape[1] != 3 or not np.isfinite(rows).all():
            raise ShapeError(f"poses must be finite rows [x, y, heading], got shape {rows.shape}")
        moved = np.concatenate([[True], ~is_repeated(rows)])
        rows = rows[moved]
        if len(rows) < 2:
            raise ShapeError("a path needs at least two different poses")
        rows[:, 2] = rows[0, 2] + np.concatenate([[0.0], np.cumsum(wrap(np.diff(rows[:, 2])))])
        twists = logarithm(compose(invert(rows[:-1]), rows[1:]))
        changes = np.flatnonzero(np.diff(twist_directions(twists))) + 1
        ends = [0, *changes.tolist(), len(rows) - 1]
        return cls(tuple(TwistSection(rows[a : b + 1]) for a, b in pairwise(ends)))

    @cached_property
    def section_bounds(self) -> Array:
        """Progress at the start and at the end of each section, shape (M + 1,)."""
        return np.concatenate([[0.0], np.cumsum([section.span for section in self.sections])])

    @cached_property
    def _heading_shift(self) -> Array:
        """Whole turns added to each section's heading to make it continuous, [rad]."""
        shift = [0.0]
        for before, after in pairwise(self.sections):
            jump = after.evaluate(0.0)[2] - before.evaluate(before.span)[2] - shift[-1]
            shift.append(float(wrap(jump) - jump))
        return np.array(shift)

    @property
    def directions(self) -> NDArray[np.int64]:
        """Direction of travel of each section, shape (M,): +1, -1, or 0 on the spot."""
        return np.array([section.direction for section in self.sections], dtype=np.int64)

    @property
    def span(self) -> float:
        """Progress at the end."""
        return float(self.section_bounds[-1])

    @property
    def length(self) -> float:
        """Arc length travelled by the body origin [m]; turns on the spot add nothing."""
        return float(sum(s.span for s in self.sections if s.direction != 0))

    @property
    def direction_changes(self) -> int:
        """How often the chair changes between driving forward and in reverse."""
        moving = self.directions[self.directions != 0]
        return int(np.count_nonzero(np.diff(moving)))

    @property
    def start(self) -> Array:
        """First pose, shape (3,)."""
        return self(0.0)

    @property
    def goal(self) -> Array:
        """Last pose, shape (3,)."""
        return self(self.span)

    def section_index(self, progress: ArrayLike, joint: Joint = "before") -> NDArray[np.int64]:
        """Return the index of the section at progress (...), at a joint of the one asked for."""
        inner = self.section_bounds[1:-1]
        side: Literal["left", "right"] = "left" if joint == "before" else "right"
        return np.asarray(np.searchsorted(inner, np.asarray(progress, dtype=float), side=side))

    def __call__(self, progress: ArrayLike, order: int = 0, *, joint: Joint = "before") -> Array:
        """Return the pose or its derivative by progress.

        Args:
            progress: Progress, shape (...); clipped to [0, span].
            order: 0 for the pose [x, y, heading]; 1 and 2 for its derivatives by progress.
            joint: Whether a joint belongs to the section before or after it.

        Returns:
            Shape (..., 3), [m, m, rad] per unit of progress to the order.
        """
        return self._by_section(
            progress,
            lambda section, s: section.evaluate(s, order),
            shift=self._heading_shift if order == 0 else None,
            joint=joint,
        )

    def _by_section(
        self,
        progress: ArrayLike,
        function: Callable[[Section, Array], Array],
        shift: Array | None,
        joint: Joint = "before",
    ) -> Array:
        s = np.clip(np.asarray(progress, dtype=float), 0.0, self.span)
        flat = s.ravel()
        index = self.section_index(flat, joint)
        result = np.empty((len(flat), 3))
        for k in np.unique(index):
            rows = index == k
            result[rows] = function(self.sections[k], flat[rows] - self.section_bounds[k])
            if shift is not None:
                result[rows, 2] += shift[k]
        return result.reshape(*s.shape, 3)

    def curvature(self, progress: ArrayLike) -> Array:
        """Return d heading / d arc length, shape (...), [1/m]; 0 on turns on the spot."""
        s = np.asarray(progress, dtype=float)
        spot = self.directions[self.section_index(s)] == 0
        return np.where(spot, 0.0, self(s, 1)[..., 2])

    @cached_property
    def curvature_table(self) -> CurvatureTable:
        """The curvature and its rate on a fine grid of progress, with the error between nodes."""
        return CurvatureTable.of(self.sections)

    @property
    def max_curvature(self) -> float:
        """Greatest absolute curvature while travelling [1/m].

        On Bezier sections by sampling, finest about the peak; on twists it is constant between
        poses, and every piece counts.
        """
        return self.curvature_table.greatest


def is_repeated(poses: Array) -> NDArray[np.bool_]:
    """Return whether each row but the first repeats the one before it, shape (N - 1,).

    A tenth of a nanometre and of a nanoradian count as rest: it is what rounding leaves.
    """
    step = np.abs(np.diff(poses, axis=0))
    step[:, 2] = np.abs(wrap(np.diff(poses[:, 2])))
    return np.asarray((step < 1e-10).all(axis=1))
