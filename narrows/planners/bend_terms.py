"""The curvature along a section as a function of its control points, with derivatives.

kappa = a x b / |a|^3 with a and b the first and second derivative of the spline.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from narrows.se2 import Array

from .point_terms import basis_of, by_control, dot, gathered, left


class BendTerms(NamedTuple):
    """The curvature at samples of a section.

    Attributes:
        value: kappa, shape (N,), [1/m].
        first: a, shape (N, 2).
        second: b, shape (N, 2).
        weights: B' and B'' there, each shape (N, count).
    """

    value: Array
    first: Array
    second: Array
    weights: tuple[Array, Array]

    @classmethod
    def of(cls, control: Array, weights: tuple[Array, Array]) -> BendTerms:
        """Return the curvature of a spline's control points (count, 2)."""
        first, second = weights[0] @ control, weights[1] @ control
        cross = first[:, 0] * second[:, 1] - first[:, 1] * second[:, 0]
        return cls(cross / dot(first, first) ** 1.5, first, second, weights)

    def take(self, rows: NDArray[np.int64]) -> BendTerms:
        """Return some of the samples."""
        weights = self.weights[0][rows], self.weights[1][rows]
        return BendTerms(self.value[rows], self.first[rows], self.second[rows], weights)

    @property
    def jacobian(self) -> Array:
        """The derivatives by the control points, shape (N, 2 count)."""
        return by_control(self._gradient(), self.weights)

    def _gradient(self) -> Array:
        """Return the derivatives by a and b, shape (N, 4)."""
        squared = dot(self.first, self.first)[:, None]
        cube = squared**1.5
        along = self.first / squared
        by_first = -left(self.second) / cube - 3.0 * self.value[:, None] * along
        return np.concatenate([by_first, left(self.first) / cube], axis=1)

    def hessian(self, multipliers: Array) -> Array:
        """Return sum_i multiplier_i d^2 kappa_i by the control points, (2 count, 2 count)."""
        gradient = self._gradient()
        squared = dot(self.first, self.first)[:, None, None]
        cube = squared**1.5
        along = self.first[:, None] / squared  # (N, 1, 2)
        lengthwise = self.first[:, :, None] * along
        quarter = np.array([[0.0, -1.0], [1.0, 0.0]])  # d left(a) / d a
        mixed = quarter / cube - 3.0 * gradient[:, 2:, None] * along  # rows by b, columns by a
        twice = 3.0 * left(self.second)[:, :, None] * along / cube
        twice -= 3.0 * along.transpose(0, 2, 1) * gradient[:, None, :2]
        twice -= 3.0 * self.value[:, None, None] / squared * (np.eye(2) - 2.0 * lengthwise)
        inner = np.zeros((len(self.value), 4, 4))
        inner[:, :2, :2], inner[:, 2:, :2] = twice, mixed
        inner[:, :2, 2:] = mixed.transpose(0, 2, 1)
        return gathered(basis_of(self.weights), multipliers[:, None, None] * inner)
