"""Poses in the plane: wrap, compose, invert, transform, and motions of constant twist.

A pose is [x, y, heading] in [m, m, rad]; arrays of poses have shape (..., 3). The heading is
counter-clockwise from the x axis. `pose_a_to_b` names read "maps coordinates in a to coordinates
in b": the pose of the body in the world is body_to_world.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

Array = NDArray[np.float64]


def wrap(angle: ArrayLike) -> Array:
    """Return the angle in (-pi, pi].

    >>> float(wrap(3 * np.pi))
    3.141592653589793

    Args:
        angle: Angles, any shape, [rad].

    Returns:
        Wrapped angles, the same shape, [rad].
    """
    angle = np.asarray(angle, dtype=float)
    wrapped = np.pi - np.mod(np.pi - angle, 2.0 * np.pi)
    # A hair beyond pi, mod rounds up to the whole turn it never reaches.
    return np.where(wrapped <= -np.pi, np.pi, wrapped)


def rotate(angle: ArrayLike, vector: ArrayLike) -> Array:
    """Return vectors turned counter-clockwise by an angle.

    >>> rotate(np.pi / 2, [1.0, 0.0]).round(12) + 0.0
    array([0., 1.])

    Args:
        angle: Angles, shape (...), [rad].
        vector: Vectors, shape (..., 2).

    Returns:
        Turned vectors, shapes broadcast, (..., 2).
    """
    angle = np.asarray(angle, dtype=float)
    vector = np.asarray(vector, dtype=float)
    c, s = np.cos(angle), np.sin(angle)
    x, y = vector[..., 0], vector[..., 1]
    return np.stack([c * x - s * y, s * x + c * y], axis=-1)


def transform(pose: ArrayLike, points: ArrayLike) -> Array:
    """Return points given in a pose's frame in the frame the pose is given in.

    >>> transform([1.0, 2.0, np.pi / 2], [[1.0, 0.0]]).round(12)
    array([[1., 3.]])

    Args:
        pose: Poses body_to_world, shape (..., 3), [m, m, rad].
        points: Points in the body frame, shape (M, 2), [m].

    Returns:
        Points in the world frame, shape (..., M, 2), [m].
    """
    pose = np.asarray(pose, dtype=float)
    points = np.asarray(points, dtype=float)
    turned = rotate(pose[..., None, 2], points)
    return np.asarray(turned + pose[..., None, :2])


def compose(first: ArrayLike, second: ArrayLike) -> Array:
    """Return the pose reached by `second`, given in the frame of `first`.

    >>> compose([1.0, 0.0, np.pi / 2], [2.0, 0.0, 0.0]).round(12)
    array([1.        , 2.        , 1.57079633])

    Args:
        first: Poses b_to_c, shape (..., 3), [m, m, rad].
        second: Poses a_to_b, shape (..., 3), [m, m, rad].

    Returns:
        Poses a_to_c, shapes broadcast, (..., 3); headings are added, not wrapped.
    """
    first = np.asarray(first, dtype=float)
    second = np.asarray(second, dtype=float)
    position = first[..., :2] + rotate(first[..., 2], second[..., :2])
    heading = first[..., 2] + second[..., 2]
    return np.concatenate([position, heading[..., None]], axis=-1)


def invert(pose: ArrayLike) -> Array:
    """Return the inverse pose: b_to_a from a_to_b.

    >>> compose([1.0, 2.0, 0.5], invert([1.0, 2.0, 0.5])).round(12) + 0.0
    array([0., 0., 0.])

    Args:
        pose: Poses, shape (..., 3), [m, m, rad].

    Returns:
        Inverse poses, shape (..., 3).
    """
    pose = np.asarray(pose, dtype=float)
    position = -rotate(-pose[..., 2], pose[..., :2])
    return np.concatenate([position, -pose[..., 2:]], axis=-1)


def _sinc_pair(angle: Array) -> tuple[Array, Array]:
    """Return sin(a)/a and (1-cos(a))/a, both exact in the limit a -> 0."""
    return np.sinc(angle / np.pi), np.sinc(angle / (2.0 * np.pi)) * np.sin(angle / 2.0)


def exponential(twist: ArrayLike) -> Array:
    """Return the pose reached from the origin by a constant twist held for unit time.

    The origin of the body moves on a circular arc (a line where omega = 0).

    >>> exponential([np.pi / 2, 0.0, np.pi / 2]).round(12)
    array([1.        , 1.        , 1.57079633])

    Args:
        twist: Body twists [v_x, v_y, omega] times duration, shape (..., 3), [m, m, rad].

    Returns:
        Poses, shape (..., 3).
    """
    twist = np.asarray(twist, dtype=float)
    a, b = _sinc_pair(twist[..., 2])
    x, y = twist[..., 0], twist[..., 1]
    return np.stack([a * x - b * y, b * x + a * y, twist[..., 2]], axis=-1)


def logarithm(pose: ArrayLike) -> Array:
    """Return the constant twist that reaches a pose from the origin in unit time.

    Inverse of `exponential` for headings in (-2 pi, 2 pi); the heading is used as given, so
    unwrapped headings select the number of turns.

    >>> logarithm([1.0, 1.0, np.pi / 2]).round(12)
    array([1.57079633, 0.        , 1.57079633])

    Args:
        pose: Poses, shape (..., 3), [m, m, rad].

    Returns:
        Twists times duration, shape (..., 3), [m, m, rad].
    """
    pose = np.asarray(pose, dtype=float)
    a, b = _sinc_pair(pose[..., 2])
    scale = 1.0 / (a * a + b * b)
    x, y = pose[..., 0], pose[..., 1]
    return np.stack([scale * (a * x + b * y), scale * (a * y - b * x), pose[..., 2]], axis=-1)
