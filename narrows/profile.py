"""Progress over time: a smooth, never-decreasing piecewise cubic."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from .errors import ShapeError
from .se2 import Array


@dataclass(frozen=True, eq=False)
class Profile:
    """Progress along a path as a piecewise cubic of time: constant jerk on each piece.

    On piece k, progress = c0 + c1 tau + c2 tau^2 + c3 tau^3 with tau = t - breaks[k].

    Attributes:
        breaks: Times at the ends of the pieces, increasing from 0, shape (K + 1,), [s].
        coefficients: c0..c3 of each piece, shape (K, 4), [progress / s^i].
    """

    breaks: Array
    coefficients: Array

    def __post_init__(self) -> None:
        """Check times and continuity; keep read-only copies."""
        breaks = np.array(self.breaks, dtype=float)
        coefficients = np.array(self.coefficients, dtype=float)
        if breaks.ndim != 1 or coefficients.shape != (len(breaks) - 1, 4) or len(breaks) < 2:
            shapes = f"{breaks.shape} and {coefficients.shape}"
            raise ShapeError(f"breaks and coefficients must be (K + 1,) and (K, 4), got {shapes}")
        if not (np.isfinite(breaks).all() and np.isfinite(coefficients).all()):
            raise ShapeError("a profile's numbers must be finite")
        if breaks[0] != 0.0 or (np.diff(breaks) <= 0.0).any():
            raise ShapeError("a profile's times must increase from 0")
        breaks.setflags(write=False)
        coefficients.setflags(write=False)
        object.__setattr__(self, "breaks", breaks)
        object.__setattr__(self, "coefficients", coefficients)
        tau = np.diff(breaks)[:-1, None] ** np.arange(4)
        jump = np.abs((coefficients[:-1] * tau).sum(axis=1) - coefficients[1:, 0])
        if len(jump) and jump.max() > 1e-6:
            raise ShapeError(f"a profile's pieces do not join: progress jumps by {jump.max():.3g}")

    @property
    def duration(self) -> float:
        """Time at the end [s]."""
        return float(self.breaks[-1])

    @property
    def span(self) -> float:
        """Progress at the end."""
        return float(self(self.duration))

    def __call__(self, time: ArrayLike, order: int = 0) -> Array:
        """Return progress or one of its derivatives at times (...) [s], clipped to the profile.

        At a break, derivatives are those of the piece that begins there; at the end, of the last.
        """
        if order < 0:
            raise ShapeError(f"the order of a derivative must be 0 or more, got {order}")
        t = np.clip(np.asarray(time, dtype=float), 0.0, self.duration)
        piece = np.searchsorted(self.breaks[1:-1], t, side="right")
        tau = t - self.breaks[piece]
        total = np.zeros_like(t)
        for power in range(3, order - 1, -1):
            factor = float(np.prod(np.arange(power - order + 1, power + 1)))
            total = total * tau + factor * self.coefficients[piece, power]
        return np.asarray(total)

    def time_at(self, progress: ArrayLike) -> Array:
        """Return the first times at which progress (...) is reached, by bisection, [s].

        Exact to rounding; progress beyond the end gives the duration.
        """
        target = np.asarray(progress, dtype=float)
        ends = np.append(self.coefficients[:, 0], self.span)
        piece = np.clip(np.searchsorted(ends, target, side="left") - 1, 0, len(ends) - 2)
        low, high = self.breaks[piece], self.breaks[piece + 1]
        for _ in range(60):
            middle = 0.5 * (low + high)
            below = self(middle) < target
            low, high = np.where(below, middle, low), np.where(below, high, middle)
        return np.asarray(np.where(target <= ends[0], 0.0, high))
