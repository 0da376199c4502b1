"""The floor in a depth image, looked for where the camera's mounting says it is.

A plane is affine in the inverse depth over the image, and so is the sensor's quantisation uniform
in it: 1 / z = a x / z + b y / z + c with (a, b, c) = -up / height. Samples of three pixels, drawn
among those near where the floor should be, propose planes; one that is too steep, too high or too
low for the mounting is no floor, however many points it has: a table top, a wall, somebody's back.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from ..errors import InputError
from ..se2 import Array
from .camera import DepthCamera, Mounting
from .depth_image import DepthFrame
from .floor_kernels import best_floor, floor_candidates, floor_moments

_STRIDE = 4  # pixels between samples: 19,200 of 307,200
_PROPOSALS = 64
_ROUNDS = 2  # of least squares on the inliers


@dataclass(frozen=True)
class FloorPrior:
    """How far the floor may be from where the mounting says, and what it takes to believe it.

    Attributes:
        height_tolerance: Greatest difference of the camera's height [m].
        angle_tolerance: Greatest angle between the floor and the mounting's [rad].
        steps: Greatest distance of a floor pixel from the plane, in steps of quantisation.
        least_share: Least share of the image that is floor.
        least_spread: Least standard deviation of the floor's points in any direction along it [m].
    """

    height_tolerance: float = 0.06
    angle_tolerance: float = math.radians(7.0)
    steps: float = 2.5
    least_share: float = 0.01
    least_spread: float = 0.10

    def __post_init__(self) -> None:
        """Refuse tolerances that are not positive."""
        for name, value in vars(self).items():
            if not (math.isfinite(value) and value > 0.0):
                raise InputError("must be positive", field=name, value=value, allowed="> 0")


@dataclass(frozen=True, eq=False)
class Floor:
    """The floor as a camera sees it, or as it is assumed.

    Attributes:
        mounting: The mounting with the height, tilt and roll it has over this floor.
        is_seen: Whether the floor was found; if not, it is where the mounting says.
        share: Share of the image that is floor.
        reason: What was found, or why no plane was believed.
    """

    mounting: Mounting
    is_seen: bool
    share: float
    reason: str

    @cached_property
    def up(self) -> Array:
        """Its normal in the camera frame, shape (3,)."""
        return self.mounting.up


def mounting_over(mounting: Mounting, up: Array, height: float) -> Mounting:
    """Return a mounting turned and lifted to a floor.

    >>> seen = Mounting(height=0.8, tilt=0.3, roll=0.1)
    >>> found = mounting_over(Mounting(height=1.0), seen.up, 0.8)
    >>> round(found.tilt, 12), round(found.roll, 12), found.height
    (0.3, 0.1, 0.8)

    Args:
        mounting: Where the camera sits on the chair; its position and heading stay.
        up: Normal of the floor in the camera frame, shape (3,).
        height: Height of the camera above it [m].
    """
    tilt = math.atan2(-up[2], math.hypot(up[0], up[1]))
    return replace(mounting, height=height, tilt=tilt, roll=math.atan2(-up[0], -up[1]))


def is_floor(up: Array, height: float, mounting: Mounting, prior: FloorPrior) -> bool:
    """Return whether a plane can be the floor under a mounting.

    Args:
        up: Unit normal towards the camera, camera frame, shape (3,).
        height: Distance of the camera from it [m].
        mounting: The mounting.
        prior: How far it may be off.
    """
    angle = math.atan2(float(np.linalg.norm(np.cross(up, mounting.up))), float(up @ mounting.up))
    off = abs(height - mounting.height)
    return angle <= prior.angle_tolerance and off <= prior.height_tolerance


def find_floor(
    frame: DepthFrame, camera: DepthCamera, prior: FloorPrior, *, seed: int = 0
) -> Floor:
    """Return the floor in a depth image; where none is believed, the mounting's, and why.

    Args:
        frame: The image.
        camera: The camera and how it is meant to be mounted.
        prior: How far that may be off.
        seed: Of the samples; the same image and seed give the same floor.
    """
    mounting, lens = camera.mounting, camera.intrinsics
    geometry = np.array([lens.fx, lens.fy, lens.cx, lens.cy])
    plane = np.array([*mounting.up, mounting.height])
    slack = np.array([prior.height_tolerance, math.tan(prior.angle_tolerance), camera.furthest])
    columns = floor_candidates(frame.image, frame.per_metre, geometry, plane, slack, _STRIDE)
    rows, width = frame.image.shape
    samples_in_image = (rows // _STRIDE) * (width // _STRIDE)
    least = max(12, math.ceil(prior.least_share * samples_in_image))
    if columns.shape[1] < least:
        return _not_seen(mounting, "too few returns where the floor should be")
    draws = np.random.default_rng(seed).integers(0, columns.shape[1], (_PROPOSALS, 3))
    limits = np.array([math.cos(prior.angle_tolerance), mounting.height, prior.height_tolerance])
    tolerance = prior.steps * camera.step
    coefficients, _ = best_floor(columns, draws, mounting.up, limits, np.float32(tolerance))
    count, spread = 0, 0.0
    for _ in range(_ROUNDS):
        if not coefficients.any():
            return _not_seen(mounting, "no plane near enough to where the floor should be")
        count, centre, covariance, spread = _fit(columns, coefficients, tolerance)
        coefficients = _least_squares(centre, covariance) if count >= least else np.zeros(3)
    size = float(np.linalg.norm(coefficients))
    if size == 0.0 or spread < prior.least_spread:
        return _not_seen(mounting, "too little floor in view to be sure of it")
    up, height = -coefficients / size, 1.0 / size
    if not is_floor(up, height, mounting, prior):
        return _not_seen(mounting, "the plane found is not where the floor should be")
    share = count / samples_in_image
    return Floor(mounting_over(mounting, up, height), True, share, "floor seen")


def _not_seen(mounting: Mounting, reason: str) -> Floor:
    return Floor(mounting, False, 0.0, reason)


def _fit(
    columns: NDArray[np.float32], coefficients: Array, tolerance: float
) -> tuple[int, Array, Array, float]:
    """Return the inliers' number, centre, covariance and least spread along the plane [m]."""
    plane = coefficients.astype(np.float32)
    count, centre, covariance, spread = floor_moments(columns, plane, np.float32(tolerance))
    if count < 3:
        return count, centre, covariance, 0.0
    # The point cloud has a third direction, across the plane: the smallest one is not of it.
    along = np.linalg.eigvalsh(spread)[1]
    return count, centre, covariance, math.sqrt(max(float(along), 0.0))


def _least_squares(centre: Array, covariance: Array) -> Array:
    """Return a, b, c of 1/z = a x/z + b y/z + c from the moments of (x/z, y/z, 1/z)."""
    determinant = covariance[0, 0] * covariance[1, 1] - covariance[0, 1] ** 2
    if determinant <= 1e-12:  # all on one line of the image, about a pixel wide
        return np.zeros(3)
    slope = np.linalg.solve(covariance[:2, :2], covariance[:2, 2])
    return np.array([*slope, centre[2] - slope @ centre[:2]])
