"""The plane most points lie on, by random samples [FuzzyDVZ, 3.2.4].

Whatever is flat and large is found: a floor, but also a table top, a wall or a row of backs.
`narrows.perception.floor` looks for a floor only.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ..errors import InputError
from ..se2 import Array
from .depth_image import Points
from .plane_kernels import best_sample, distances, moments
from .point_rows import point_rows


@dataclass(frozen=True, eq=False)
class Plane:
    """A plane: the points p with normal @ p + offset = 0.

    Attributes:
        normal: Unit normal, towards the origin (the camera), shape (3,).
        offset: Distance of the origin from the plane, >= 0 [m].
    """

    normal: Array
    offset: float

    def distance(self, points: Points) -> Array:
        """Return how far points (N, 3) are from the plane, positive on the origin's side [m]."""
        result: Array = np.asarray(points, dtype=float) @ self.normal + self.offset
        return result

    def angle_to(self, direction: Array) -> float:
        """Return the angle between the normal, either way, and a unit vector [rad]."""
        cosine = abs(float(self.normal @ direction))
        return float(np.arctan2(np.linalg.norm(np.cross(self.normal, direction)), cosine))


@dataclass(frozen=True, eq=False)
class PlaneFit:
    """A plane found in a cloud.

    Attributes:
        plane: The plane.
        is_on_plane: Which points are within the tolerance of it, shape (N,).
        iterations: Samples that were drawn.
    """

    plane: Plane
    is_on_plane: NDArray[np.bool_]
    iterations: int


def find_plane(
    points: Points,
    *,
    tolerance: float = 0.02,
    most_iterations: int = 1000,
    probability: float = 0.99,
    seed: int = 0,
) -> PlaneFit | None:
    """Return the plane with most points within a tolerance, refined once to those points.

    As the reference library does it: samples of three points until one without an outlier has been
    drawn with the probability asked for, the share of inliers taken from the best so far; then the
    least-squares plane of the best sample's inliers, and the inliers of that.

    Args:
        points: Shape (N, 3), [m].
        tolerance: Greatest distance of an inlier [m].
        most_iterations: Most samples drawn.
        probability: Of having drawn three points of the largest plane, in (0, 1).
        seed: Of the samples; the same points and seed give the same plane.

    Returns:
        The fit; None if there are fewer than three points or all lie on a line.

    Raises:
        ShapeError: If the points are not (N, 3) or not finite.
        InputError: If an option is outside its range.
    """
    rows = point_rows(points)
    _check(tolerance, most_iterations, probability)
    if len(rows) < 3:
        return None
    columns = np.ascontiguousarray(rows.T)
    samples = np.random.default_rng(seed).integers(0, len(rows), (most_iterations, 3))
    sampled, count, iterations = best_sample(columns, samples, np.float32(tolerance), probability)
    if count < 3:
        return None
    refined = _least_squares(columns, sampled, tolerance)
    plane = Plane(refined[:3].astype(float), float(refined[3]))
    is_on_plane = np.abs(distances(columns, refined.astype(np.float32))) < tolerance
    return PlaneFit(plane, is_on_plane, iterations)


def _check(tolerance: float, most_iterations: int, probability: float) -> None:
    if not 0.0 < tolerance < np.inf:
        raise InputError("not a distance", field="tolerance", value=tolerance, allowed="> 0 m")
    if most_iterations < 1:
        raise InputError(
            "no sample", field="most_iterations", value=most_iterations, allowed=">= 1"
        )
    if not 0.0 < probability < 1.0:
        raise InputError("not reached", field="probability", value=probability, allowed="in (0, 1)")


def _least_squares(columns: Points, sampled: NDArray[np.float32], tolerance: float) -> Array:
    """Return normal and offset (4,) of the plane nearest to a sample's inliers, facing us."""
    centre, covariance = moments(columns, sampled, np.float32(tolerance))
    _, vectors = np.linalg.eigh(covariance)
    normal = vectors[:, 0]
    offset = -float(normal @ centre)
    sign = -1.0 if offset < 0.0 else 1.0
    return sign * np.array([*normal, offset])
