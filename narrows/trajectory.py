"""Where to be when: a path and the progress along it over time."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise

import numpy as np
from numpy.typing import ArrayLike

from .errors import ShapeError
from .path import Path, is_repeated
from .profile import Profile
from .se2 import Array
from .twist_section import TwistSection

ROW_TIME = 0.02
"""Longest time between rows [s]."""

ROW_DISTANCE = 0.01
"""Longest distance between rows [m]."""


@dataclass(frozen=True, eq=False)
class Trajectory:
    """A path with a time for each of its poses: pose(t) = path(progress(t)).

    Attributes:
        path: Where the body frame goes.
        profile: Progress along the path over time, from 0 to the path's span.
        sampled: Whether it was read from rows, its speed constant between them; its
            accelerations are then difference quotients.
    """

    path: Path
    profile: Profile
    sampled: bool = False

    def __post_init__(self) -> None:
        """Check that the profile covers the path."""
        gap = abs(self.profile.span - self.path.span)
        if gap > 1e-6 * max(1.0, self.path.span):
            raise ShapeError(f"the profile ends {gap:.3g} short of or beyond the path's end")

    @classmethod
    def from_samples(cls, times: ArrayLike, poses: ArrayLike) -> Trajectory:
        """Return the trajectory through timed poses, its twist constant between them.

        Args:
            times: Times, shape (N,), increasing, [s]; the first becomes 0.
            poses: Poses [x, y, heading], shape (N, 3), [m, m, rad].

        Raises:
            ShapeError: If shapes differ, times do not increase, or nothing moves.
        """
        t = np.array(times, dtype=float)
        rows = np.array(poses, dtype=float)
        if t.ndim != 1 or rows.shape != (len(t), 3) or not np.isfinite(t).all():
            raise ShapeError(f"times and poses must be (N,) and (N, 3): {t.shape}, {rows.shape}")
        if (np.diff(t) <= 0.0).any():
            raise ShapeError("times must increase from row to row")
        path = Path.from_poses(rows)
        begins, steps = [], []
        for section, bound in zip(path.sections, path.section_bounds, strict=False):
            ends = section.progress_at(np.arange(section.pieces), np.ones(section.pieces))
            begins.append(bound + np.concatenate([[0.0], ends[:-1]]))
            steps.append(np.diff(ends, prepend=0.0))
        moved = ~is_repeated(rows)
        step = np.zeros(len(t) - 1)
        step[moved] = np.concatenate(steps)
        following = np.searchsorted(np.flatnonzero(moved), np.arange(len(step)))
        progress = np.append(np.concatenate(begins), path.span)[following]
        speed = step / np.diff(t)
        zeros = np.zeros_like(speed)
        profile = Profile(t - t[0], np.column_stack([progress, speed, zeros, zeros]))
        return cls(path, profile, sampled=True)

    @property
    def duration(self) -> float:
        """Time at the end [s]."""
        return self.profile.duration

    @cached_property
    def section_times(self) -> Array:
        """Times at which sections start and end, shape (M + 1,), [s]."""
        inner = self.profile.time_at(self.path.section_bounds[1:-1])
        return np.concatenate([[0.0], inner, [self.duration]])

    def progress(self, time: ArrayLike, order: int = 0) -> Array:
        """Return the progress along the path or its derivative at times (...) [s]."""
        return self.profile(time, order)

    def __call__(self, time: ArrayLike, order: int = 0) -> Array:
        """Return pose, velocity or acceleration in the world frame.

        By the chain rule: order 1 is p' s', order 2 is p'' s'^2 + p' s''. At a joint of the path,
        derivatives are those of the section that begins there, as the profile's are.

        Args:
            time: Times, shape (...), clipped to [0, duration], [s].
            order: 0, 1 or 2.

        Returns:
            [x, y, heading] or its derivative, shape (..., 3), [m, m, rad] / s^order.
        """
        s = self.profile(time)
        if order == 0:
            return self.path(s)
        rate = self.profile(time, 1)[..., None]
        if order == 1:
            return self.path(s, 1, joint="after") * rate
        if order == 2:
            bend = self.profile(time, 2)[..., None]
            bent, along = self.path(s, 2, joint="after"), self.path(s, 1, joint="after")
            return np.asarray(bent * rate**2 + along * bend)
        raise ShapeError(f"the order of a trajectory's derivative is 0, 1 or 2, got {order}")

    def command(self, time: ArrayLike) -> Array:
        """Return [v, omega] at times (...), shape (..., 2), [m/s, rad/s].

        v is along the body's x axis: negative in reverse, 0 on the spot.
        """
        pose, velocity = self(time), self(time, 1)
        heading = pose[..., 2]
        v = velocity[..., 0] * np.cos(heading) + velocity[..., 1] * np.sin(heading)
        return np.stack([v, velocity[..., 2]], axis=-1)

    @cached_property
    def times(self) -> Array:
        """Times of the rows, at most 0.02 s and 0.01 m apart, exact at section ends, (N,), [s]."""
        ends = self.profile.breaks if self.sampled else self.section_times
        rows = [np.zeros(1)]
        for start, end in pairwise(ends):
            if end - start <= 1e-12:
                continue
            fine = np.linspace(start, end, max(2, int(np.ceil((end - start) / ROW_TIME)) + 1))
            within = fine[:-1] if self.sampled else fine  # at a break, the next rows' speed counts
            fastest = float(np.abs(self.profile(within, 1)).max())
            step = min(ROW_TIME, 0.98 * ROW_DISTANCE / max(fastest, 1e-9))
            count = max(1, int(np.ceil((end - start) / step - 1e-9)))
            rows.append(np.linspace(start, end, count + 1)[1:])
        return np.concatenate(rows)

    @cached_property
    def poses(self) -> Array:
        """Poses at `times`, shape (N, 3), [m, m, rad]."""
        return self(self.times)

    @cached_property
    def commands(self) -> Array:
        """[v, omega] at `times`, shape (N, 2), [m/s, rad/s]."""
        return self.command(self.times)

    def slip(self) -> float:
        """Return the greatest angle between the motion and the chair's x axis while driving [rad].

        A chair on wheels moves along its x axis only; anything else is slip. The heading of a
        Bezier section is its tangent; a twist keeps its angle to the x axis all along.
        """
        worst = 0.0
        for section in self.path.sections:
            if isinstance(section, TwistSection) and section.direction != 0:
                along = section.direction * section.twists[:, :2]
                worst = max(worst, float(np.abs(np.arctan2(along[:, 1], along[:, 0])).max()))
        return worst
