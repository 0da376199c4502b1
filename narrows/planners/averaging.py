"""Jerk-limited progress as the moving average of acceleration-limited progress.

With the acceleration a piecewise constant, the average over a window T of the progress before
has the jerk (a(t) - a(t - T)) / T, constant between the times when either changes: pieces of a
`Profile`. It takes T longer, covers the same ground, and starts and ends at rest with no
acceleration.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from narrows.profile import Profile
from narrows.se2 import Array


@dataclass(frozen=True, eq=False)
class Accelerated:
    """Progress from rest to rest with constant acceleration on each of N cells.

    Attributes:
        times: Times at the nodes, increasing from 0, shape (N + 1,), [s].
        progress: Progress at the nodes, increasing from 0, shape (N + 1,).
        speed: Its rate at the nodes, shape (N + 1,).
        acceleration: The rate of that on the cells, shape (N,).
    """

    times: Array
    progress: Array
    speed: Array
    acceleration: Array

    @classmethod
    def fastest(cls, progress: Array, cap: Array, acceleration: Array) -> Accelerated:
        """Return the fastest motion from rest to rest under a speed cap.

        In v^2 a limit of acceleration is a limit of slope, |d v^2 / ds| <= 2 a: the least of all
        slopes through caps further back, then of all through caps further on.

        Args:
            progress: Progress at the nodes, shape (N + 1,).
            cap: Greatest speed at the nodes, shape (N + 1,).
            acceleration: Greatest acceleration on the cells, shape (N,).
        """
        square = cap**2
        square[[0, -1]] = 0.0
        gained = np.concatenate([[0.0], np.cumsum(2.0 * acceleration * np.diff(progress))])
        forward = gained + np.minimum.accumulate(square - gained)
        square = np.minimum.accumulate((forward + gained)[::-1])[::-1] - gained
        square[[0, -1]] = 0.0
        return cls.of_squared_speed(progress, np.maximum(square, 0.0))

    @classmethod
    def of_squared_speed(cls, progress: Array, square: Array) -> Accelerated:
        """Return the motion whose squared speed is linear in progress between nodes."""
        speed = np.sqrt(square)
        length = np.diff(progress)
        steps = 2.0 * length / (speed[1:] + speed[:-1])
        times = np.concatenate([[0.0], np.cumsum(steps)])
        return cls(times, progress, speed, np.diff(square) / (2.0 * length))

    @property
    def duration(self) -> float:
        """Time at the end [s]."""
        return float(self.times[-1])

    def merged(self) -> Accelerated:
        """Return the same motion with cells of equal acceleration made one."""
        steps = np.abs(np.diff(self.acceleration))
        kept = np.concatenate([[True], steps > 1e-9, [True]])
        return Accelerated(
            self.times[kept],
            self.progress[kept],
            self.speed[kept],
            self.acceleration[np.concatenate([[True], steps > 1e-9])],
        )


@dataclass(frozen=True, eq=False)
class Averaged:
    """Progress and its derivatives at the ends of M pieces of constant jerk.

    Attributes:
        times: Times at the nodes, increasing from 0, shape (M + 1,), [s].
        progress: Progress at the nodes, shape (M + 1,).
        speed: Its rate, shape (M + 1,).
        acceleration: The rate of that, shape (M + 1,).
        jerk: The rate of that on the pieces, shape (M,).
    """

    times: Array
    progress: Array
    speed: Array
    acceleration: Array
    jerk: Array

    @classmethod
    def of(cls, motion: Accelerated, window: float) -> Averaged:
        """Return the moving average of a motion over a window [s]."""
        times = np.sort(np.concatenate([motion.times, motion.times + window]))
        times = times[np.concatenate([[True], np.diff(times) > 1e-9])]
        later, before = _at(motion, times), _at(motion, times - window)
        total, progress, speed = (
            (now - then) / window for now, then in zip(later, before, strict=True)
        )
        middle = 0.5 * (times[1:] + times[:-1])
        change = _acceleration(motion, middle) - _acceleration(motion, middle - window)
        return cls(times, total, progress, speed, change / window)

    def profile(self) -> Profile:
        """Return the progress as a profile."""
        rows = [self.progress[:-1], self.speed[:-1], self.acceleration[:-1] / 2.0, self.jerk / 6.0]
        return Profile(self.times, np.column_stack(rows))


def _at(motion: Accelerated, time: Array) -> tuple[Array, Array, Array]:
    """Return the time integral of progress, progress and speed at times (N,), also outside."""
    steps = np.diff(motion.times)
    s, v, a = motion.progress[:-1], motion.speed[:-1], motion.acceleration
    gains = steps * (s + steps * (v / 2.0 + steps * a / 6.0))
    total = np.concatenate([[0.0], np.cumsum(gains)])
    inside = np.clip(time, 0.0, motion.duration)
    cell = _cell(motion, inside)
    x = inside - motion.times[cell]
    s, v, a = s[cell], v[cell], a[cell]
    rest = np.maximum(time - motion.duration, 0.0) * motion.progress[-1]
    return (
        total[cell] + x * (s + x * (v / 2.0 + x * a / 6.0)) + rest,
        s + x * (v + x * a / 2.0),
        v + x * a,
    )


def _acceleration(motion: Accelerated, time: Array) -> Array:
    outside = (time < 0.0) | (time > motion.duration)
    return np.where(outside, 0.0, motion.acceleration[_cell(motion, time)])


def _cell(motion: Accelerated, time: Array) -> NDArray[np.int64]:
    return np.searchsorted(motion.times[1:-1], time, side="right")
