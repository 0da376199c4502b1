"""Rows of clearance as functions of a section's control points, with derivatives.

A row (`body_program`) depends on the position p and the heading phi at its parameter, these on the
control points through the spline:

    p = B C,  s = B' C,  phi = angle of s (turned about in reverse).

In the world's frame g = h - n.(p + w) with w = R v, in the body's g = m.R'(q - p) - h.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from narrows.se2 import Array

from .clearance_rows import Rows
from .point_terms import basis_of, by_control, dot, gathered, left
from .spline import Spline

_AT_LEAST = 1e-4  # m: a row within this of its least value by its slope counts as there


class RowTerms(NamedTuple):
    """Rows at a section's control points.

    Attributes:
        rows: The rows.
        value: Clearance less what is required, shape (N,), [m].
        gradient: Derivatives by p and s, shape (N, 4).
        weights: B and B' at the rows' parameters, each shape (N, count).
        control: Control points, shape (count, 2), [m].
        direction: +1 or -1.
    """

    rows: Rows
    value: Array
    gradient: Array
    weights: tuple[Array, Array]
    control: Array
    direction: int

    @classmethod
    def of(
        cls, rows: Rows, control: Array, direction: int, weights: tuple[Array, Array]
    ) -> RowTerms:
        """Return rows of clearance at control points."""
        axis, corner = rows.fields[:, :2], rows.fields[:, 2:4]
        support, required = rows.fields[:, 4], rows.fields[:, 6]
        position, slope = weights[0] @ control, weights[1] @ control
        squared = dot(slope, slope)[:, None]
        ahead = direction * slope / np.sqrt(squared)
        aside = left(ahead)
        in_world = rows.fields[:, 5] == 1.0
        # w in the world's frame, R m in the body's
        turned = np.where(in_world[:, None], corner, axis)
        turned = ahead * turned[:, :1] + aside * turned[:, 1:]
        away = corner - position
        value = np.where(
            in_world, support - dot(axis, position + turned), dot(turned, away) - support
        )
        by_place = np.where(in_world[:, None], -axis, -turned)
        by_heading = np.where(in_world, -dot(axis, left(turned)), dot(left(turned), away))
        gradient = np.concatenate([by_place, by_heading[:, None] * left(slope) / squared], axis=1)
        return cls(rows, value - required, gradient, weights, control, direction)

    @property
    def jacobian(self) -> Array:
        """The derivatives by the control points, shape (N, 2 count)."""
        return by_control(self.gradient, self.weights)

    def take(self, rows: NDArray[np.int64]) -> RowTerms:
        """Return some of the rows."""
        return RowTerms(
            self.rows.take(rows),
            self.value[rows],
            self.gradient[rows],
            (self.weights[0][rows], self.weights[1][rows]),
            self.control,
            self.direction,
        )

    def hessian(self, multipliers: Array, spline: Spline) -> Array:
        """Return sum_i multiplier_i d^2 g_i by the control points, shape (2 count, 2 count).

        A row that is least where it stands moves along the section as the curve changes, to stay
        least: the second derivative of min_t g is that of g less g_ct g_ct' / g_tt.
        """
        basis, inner = basis_of(self.weights), self._inner()
        total = gathered(basis, multipliers[:, None, None] * inner)
        least = np.flatnonzero(self.rows.is_least)
        if not len(least):
            return total
        parameter = self.rows.parameter[least]
        second, third = (spline.basis(parameter, order) for order in (2, 3))
        weights = self.weights[1][least]
        speed = np.concatenate([weights @ self.control, second @ self.control], axis=1)
        rate = np.concatenate([second @ self.control, third @ self.control], axis=1)
        gradient = self.gradient[least]
        pushed = np.einsum("nij,nj->ni", inner[least], speed)
        bending = (speed * pushed).sum(axis=1) + (gradient * rate).sum(axis=1)  # g_tt
        slope = (gradient * speed).sum(axis=1)  # g_t
        mixed = np.einsum("ni,nij->nj", pushed, basis[least])  # g_ct
        mixed += by_control(gradient, (weights, second))
        # Where two edges take turns it is least without being flat.
        flat = (bending > 0.0) & (slope**2 <= 2.0 * _AT_LEAST * bending)
        scale = np.where(flat, multipliers[least] / np.where(flat, bending, 1.0), 0.0)
        return np.asarray(total - (mixed * scale[:, None]).T @ mixed)

    def _inner(self) -> Array:
        """Return the second derivatives by p and s, shape (N, 4, 4)."""
        fields = self.rows.fields
        in_world, axis, corner = fields[:, 5] == 1.0, fields[:, :2], fields[:, 2:4]
        slope = self.weights[1] @ self.control
        squared = dot(slope, slope)[:, None]
        turn = left(slope) / squared  # d phi / d s
        ahead = self.direction * slope / np.sqrt(squared)
        aside = left(ahead)
        turned = np.where(in_world[:, None], corner, axis)
        turned = ahead * turned[:, :1] + aside * turned[:, 1:]
        away = corner - self.weights[0] @ self.control
        by_heading = dot(self.gradient[:, 2:], left(slope))
        twice = np.where(in_world, dot(axis, turned), -dot(turned, away))
        mixed = np.where(in_world[:, None], 0.0, -left(turned))[:, :, None] * turn[:, None]
        inner = np.zeros((len(slope), 4, 4))
        inner[:, :2, 2:], inner[:, 2:, :2] = mixed, mixed.transpose(0, 2, 1)
        inner[:, 2:, 2:] = twice[:, None, None] * turn[:, :, None] * turn[:, None]
        inner[:, 2:, 2:] += by_heading[:, None, None] * _angle_hessian(slope)
        # From corner to corner the axis turns with the corner that moves across it.
        across = np.zeros((len(slope), 4))
        across[:, :2] = left(axis)
        across[:, 2:] = dot(left(axis), left(turned))[:, None] * turn
        across /= np.sqrt(self.rows.between_corners)[:, None]
        return np.asarray(inner + across[:, :, None] * across[:, None])


def _angle_hessian(vector: Array) -> Array:
    """Return the second derivatives of the angle of vectors (N, 2), shape (N, 2, 2)."""
    x, y = vector.T
    result = np.empty((len(vector), 2, 2))
    result[:, 0, 0] = 2.0 * x * y
    result[:, 1, 1] = -result[:, 0, 0]
    result[:, 0, 1] = result[:, 1, 0] = y**2 - x**2
    return result / (dot(vector, vector) ** 2)[:, None, None]
