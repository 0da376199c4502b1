"""Cubic Bezier curves in Bernstein form: evaluate, derive, split, bound, curvature, convexity.

A curve is its four control points, shape (4, 2), [m]; a batch of curves has shape (..., 4, 2).
B(u) = sum_i binom(3, i) u^i (1 - u)^(3 - i) P_i for u in [0, 1] [DoorBezier, Eqs. (1)-(4)].
Any degree is accepted where the text says (..., D + 1, 2).
"""

from __future__ import annotations

from math import comb

import numpy as np
from numpy.typing import ArrayLike

from .errors import ShapeError
from .se2 import Array


def evaluate(control: ArrayLike, parameter: ArrayLike, order: int = 0) -> Array:
    """Return the curve or one of its derivatives by the parameter.

    [DoorBezier, Eq. (3)] for order 0.

    >>> evaluate([[0, 0], [1, 0], [2, 0], [3, 0]], 0.5)
    array([1.5, 0. ])
    >>> evaluate([[0, 0], [1, 0], [2, 0], [3, 0]], [0.0, 1.0], order=1)
    array([[3., 0.],
           [3., 0.]])

    Args:
        control: Control points, shape (..., D + 1, 2), [m].
        parameter: Parameters in [0, 1]; shape (...) broadcast against the batch of curves.
        order: Order of the derivative, 0 or more; above the degree the result is zero.

    Returns:
        Points or derivatives, shape (..., 2), [m].

    Raises:
        ShapeError: If the order is negative.
    """
    points = np.asarray(control, dtype=float)
    if order < 0:
        raise ShapeError(f"the order of a derivative must be 0 or more, got {order}")
    for _ in range(order):
        points = derivative(points) if points.shape[-2] > 1 else np.zeros_like(points)
    u = np.asarray(parameter, dtype=float)[..., None]
    degree = points.shape[-2] - 1
    total = np.zeros(np.broadcast_shapes(u.shape, points[..., 0, :].shape))
    for i in range(degree + 1):
        total = total + comb(degree, i) * u**i * (1.0 - u) ** (degree - i) * points[..., i, :]
    return total


def derivative(control: ArrayLike) -> Array:
    """Return the control points of the derivative, the hodograph.

    >>> derivative([[0, 0], [1, 0], [2, 1], [3, 3]])
    array([[3., 0.],
           [3., 3.],
           [3., 6.]])

    Args:
        control: Control points, shape (..., D + 1, 2), [m], D >= 1.

    Returns:
        Control points, shape (..., D, 2), [m per unit of parameter].
    """
    points = np.asarray(control, dtype=float)
    return np.asarray((points.shape[-2] - 1) * np.diff(points, axis=-2))


def split(control: ArrayLike, parameter: float) -> tuple[Array, Array]:
    """Return the two halves of a curve cut at a parameter, by de Casteljau's construction.

    >>> left, right = split([[0, 0], [0, 1], [1, 1], [1, 0]], 0.5)
    >>> left[-1], bool((left[-1] == right[0]).all())
    (array([0.5 , 0.75]), True)

    Args:
        control: Control points, shape (..., D + 1, 2), [m].
        parameter: Where to cut, in [0, 1].

    Returns:
        Control points of the part before and the part after, each shape (..., D + 1, 2).
    """
    points = np.asarray(control, dtype=float)
    left, right = [points[..., 0, :]], [points[..., -1, :]]
    while points.shape[-2] > 1:
        points = (1.0 - parameter) * points[..., :-1, :] + parameter * points[..., 1:, :]
        left.append(points[..., 0, :])
        right.append(points[..., -1, :])
    return np.stack(left, axis=-2), np.stack(right[::-1], axis=-2)


def segment(control: ArrayLike, start: ArrayLike, end: ArrayLike) -> Array:
    """Return the control points of the part of cubic curves between two parameters.

    Control point i of the part is the blossom at (start, ..., end, ...) with i times `end`.
    The curve between the parameters lies in the convex hull of the result.

    Args:
        control: Control points of cubic curves, shape (N, 4, 2), [m].
        start: First parameters in [0, 1], shape (N,).
        end: Last parameters in [0, 1], shape (N,).

    Returns:
        Control points, shape (N, 4, 2), [m].
    """
    points = np.asarray(control, dtype=float)
    a = np.asarray(start, dtype=float)[:, None, None]
    b = np.asarray(end, dtype=float)[:, None, None]

    def blend(p: Array, t: Array) -> Array:
        return np.asarray(p[:, :-1] + t * (p[:, 1:] - p[:, :-1]))

    by_a, by_b = blend(points, a), blend(points, b)  # (N, 3, 2)
    by_aa, by_ab, by_bb = blend(by_a, a), blend(by_a, b), blend(by_b, b)  # (N, 2, 2)
    return np.concatenate(
        [blend(by_aa, a), blend(by_aa, b), blend(by_ab, b), blend(by_bb, b)], axis=1
    )


def hull_bounds(control: ArrayLike) -> tuple[Array, Array]:
    """Return the lower and upper corner of the box of the control points, which holds the curve.

    Args:
        control: Control points, shape (..., D + 1, 2), [m].

    Returns:
        Lower and upper corners, each shape (..., 2), [m].
    """
    points = np.asarray(control, dtype=float)
    return points.min(axis=-2), points.max(axis=-2)


def cross(first: ArrayLike, second: ArrayLike) -> Array:
    """Return the z component of the cross product of plane vectors, shape (...)."""
    a, b = np.asarray(first, dtype=float), np.asarray(second, dtype=float)
    return np.asarray(a[..., 0] * b[..., 1] - a[..., 1] * b[..., 0])


def curvature(control: ArrayLike, parameter: ArrayLike) -> Array:
    """Return the signed curvature, positive to the left.

    kappa = (x' y'' - y' x'') / (x'^2 + y'^2)^(3/2) [DoorBezier, Eq. (9), exponent restored].

    Args:
        control: Control points, shape (..., 4, 2), [m].
        parameter: Parameters in [0, 1], shape (...), broadcast.

    Returns:
        Curvature, shape (...), [1/m]; infinite or undefined where the speed is zero.
    """
    first = evaluate(control, parameter, 1)
    second = evaluate(control, parameter, 2)
    speed = np.linalg.norm(first, axis=-1)
    with np.errstate(divide="ignore", invalid="ignore"):
        return np.asarray(cross(first, second) / speed**3)


def curvature_rate(control: ArrayLike, parameter: ArrayLike) -> Array:
    """Return the derivative of the curvature by the curve's parameter, [1/m per unit].

    d kappa / du = cross(B', B''') / |B'|^3 - 3 cross(B', B'') (B' . B'') / |B'|^5.

    Args:
        control: Control points, shape (..., 4, 2), [m].
        parameter: Parameters in [0, 1], shape (...), broadcast.

    Returns:
        Rate of the curvature, shape (...).
    """
    first, second, third = (evaluate(control, parameter, k) for k in (1, 2, 3))
    speed = np.linalg.norm(first, axis=-1)
    with np.errstate(divide="ignore", invalid="ignore"):
        turning = 3.0 * cross(first, second) * np.sum(first * second, axis=-1) / speed**5
        return np.asarray(cross(first, third) / speed**3 - turning)


def is_completely_convex(control: ArrayLike) -> bool:
    """Return whether the control polygon turns one way only, so that the curve does too.

    Z_w1 Z_w2 > 0 with w1 = P0P1 x P1P2, w2 = P1P2 x P2P3 [DoorBezier, Eqs. (7), (8)]; a straight
    control polygon (both zero) counts as convex.

    Args:
        control: Control points of one curve, shape (4, 2), [m].
    """
    legs = np.diff(np.asarray(control, dtype=float), axis=-2)
    first, second = float(cross(legs[0], legs[1])), float(cross(legs[1], legs[2]))
    return first * second > 0.0 or first == second == 0.0
