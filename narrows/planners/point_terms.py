"""Sums over places of a section, carried from what happens there to the control points.

At a place the curve gives two vectors a = A C and b = B C of the control points C; what depends on
them is described by derivatives by (a_x, a_y, b_x, b_y).
"""

from __future__ import annotations

import numpy as np

from narrows.se2 import Array


def by_control(gradient: Array, weights: tuple[Array, Array]) -> Array:
    """Return derivatives by the control points, shape (N, 2 count), x and y of each in turn.

    Args:
        gradient: Derivatives by a and b, shape (N, 4).
        weights: A and B, each shape (N, count).
    """
    jacobian = weights[0][:, :, None] * gradient[:, None, :2]
    jacobian += weights[1][:, :, None] * gradient[:, None, 2:]
    return np.asarray(jacobian.reshape(len(gradient), 2 * weights[0].shape[1]))


def basis_of(weights: tuple[Array, Array]) -> Array:
    """Return the derivative of a and b by the control points, shape (N, 4, 2 count)."""
    basis = np.zeros((len(weights[0]), 4, 2 * weights[0].shape[1]))
    for order in (0, 1):
        for axis in (0, 1):
            basis[:, 2 * order + axis, axis::2] = weights[order]
    return basis


def gathered(basis: Array, hessian: Array) -> Array:
    """Return the sum of second derivatives by the control points, shape (2 count, 2 count).

    Args:
        basis: What `basis_of` returns.
        hessian: Second derivatives by a and b, multiplied already, shape (N, 4, 4).
    """
    size = basis.shape[2]
    return np.asarray(basis.reshape(-1, size).T @ (hessian @ basis).reshape(-1, size))


def left(vectors: Array) -> Array:
    """Return vectors (N, 2) turned left by a right angle."""
    turned = np.empty_like(vectors)
    turned[:, 0], turned[:, 1] = -vectors[:, 1], vectors[:, 0]
    return turned


def dot(first: Array, second: Array) -> Array:
    """Return the products of vectors (N, 2), shape (N,)."""
    return np.asarray(first[:, 0] * second[:, 0] + first[:, 1] * second[:, 1])
