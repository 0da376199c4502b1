"""Clamped uniform cubic B-splines: composite cubic Bezier curves with continuous curvature."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from math import factorial

import numpy as np
from numpy.typing import ArrayLike

from narrows.errors import ShapeError
from narrows.se2 import Array


@dataclass(frozen=True)
class Spline:
    """The basis of cubic splines on [0, 1] with equal segments; C2 inside, clamped at the ends.

    The curve is sum_j B_j(t) P_j. It starts at the first control point along the leg to the
    second, and ends at the last along the leg from the one before.

    Attributes:
        segments: Number of cubic pieces, 1 or more.
    """

    segments: int

    def __post_init__(self) -> None:
        """Check the number."""
        if self.segments < 1:
            raise ShapeError(f"a spline needs at least one segment, got {self.segments}")

    @property
    def count(self) -> int:
        """Number of control points."""
        return self.segments + 3

    @cached_property
    def knots(self) -> Array:
        """Knots with the ends four times, shape (count + 4,)."""
        inner = np.linspace(0.0, 1.0, self.segments + 1)
        return np.concatenate([np.zeros(3), inner, np.ones(3)])

    def basis(self, parameter: ArrayLike, order: int = 0) -> Array:
        """Return the weights of the control points.

        On each segment the weights are cubic in the parameter: their Taylor series about the
        segment's start, whose derivatives come from the Cox-de Boor recursion, is exact.

        Args:
            parameter: Parameters in [0, 1], shape (N,).
            order: Order of the derivative by the parameter, 0 to 3.

        Returns:
            Weights, shape (N, count); each row sums to 1 for order 0 and to 0 above.
        """
        t = np.atleast_1d(np.asarray(parameter, dtype=float))
        if not 0 <= order <= 3:
            raise ShapeError(f"order must be 0 to 3, got {order}")
        segment = np.clip((t * self.segments).astype(np.int64), 0, self.segments - 1)
        step = (t - self.knots[3 + segment])[:, None]
        taylor = self._taylor[segment]  # (N, 4, count)
        weights = taylor[:, 3] / float(factorial(3 - order))
        for k in range(2, order - 1, -1):
            weights = weights * step + taylor[:, k] / float(factorial(k - order))
        return np.asarray(weights)

    def powers(self, control: Array) -> Array:
        """Return each piece's coefficients by powers of the parameter from its start.

        Args:
            control: Control points of the spline, shape (count, 2), [m].

        Returns:
            Shape (segments, 4, 2), [m].
        """
        factorials = np.array([1.0, 1.0, 2.0, 6.0])[None, :, None]
        return np.ascontiguousarray((self._taylor / factorials) @ control)

    @cached_property
    def _taylor(self) -> Array:
        """Derivatives 0 to 3 of the weights at the start of each segment, (segments, 4, count)."""
        start = self.knots[3:-4]  # bit for bit the knots, or the segment before would answer
        return np.stack([self._recursion(start, order) for order in range(4)], axis=1)

    def _recursion(self, t: Array, order: int) -> Array:
        """Return the weights or a derivative of them by the Cox-de Boor recursion, (N, count)."""
        knots = self.knots
        span = np.clip(np.searchsorted(knots, t, side="right") - 1, 3, self.count - 1)
        weights = np.zeros((len(t), len(knots) - 1))
        weights[np.arange(len(t)), span] = 1.0
        for degree in range(1, 4):
            width = knots[degree:] - knots[:-degree]
            inverse = np.divide(1.0, width, out=np.zeros_like(width), where=width > 0.0)
            left, right = weights[:, :-1] * inverse[:-1], weights[:, 1:] * inverse[1:]
            if degree > 3 - order:  # the last `order` steps differentiate
                weights = degree * (left - right)
            else:
                from_left = t[:, None] - knots[: -degree - 1]
                to_right = knots[degree + 1 :] - t[:, None]
                weights = from_left * left + to_right * right
        return weights

    @cached_property
    def _to_bezier(self) -> Array:
        """Weights of the spline's control points in those of its Bezier pieces, (4 M, count)."""
        ends = np.linspace(0.0, 1.0, self.segments + 1)
        third = 1.0 / (3.0 * self.segments)
        point, slope = self.basis(ends), self.basis(ends, 1)
        start, end = point[:-1], point[1:]
        rows = [start, start + third * slope[:-1], end - third * slope[1:], end]
        return np.stack(rows, axis=1).reshape(4 * self.segments, self.count)

    def to_bezier(self, control: Array) -> Array:
        """Return the Bezier control points of the pieces, shape (segments, 4, 2), [m].

        Args:
            control: Control points of the spline, shape (count, 2), [m].
        """
        return np.asarray((self._to_bezier @ control).reshape(self.segments, 4, 2))
