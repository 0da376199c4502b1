"""Depth images: checked, turned into points, and points into an image again."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..errors import InputError, ShapeError
from .camera import Intrinsics
from .depth_kernels import Image, lift

Points = NDArray[np.float32]
"""Points in the precision of the sensor and of the reference library, shape (N, 3), [m]."""


@dataclass(frozen=True, eq=False)
class DepthFrame:
    """A depth image that has been checked, not copied where that can be spared.

    Attributes:
        image: Shape (height, width), unsigned integers or finite floats >= 0; 0: no return.
        per_metre: What one metre is in it.
    """

    image: Image
    per_metre: np.float32

    @property
    def metres(self) -> NDArray[np.float32]:
        """The depths [m], 0 where there is no return."""
        return np.divide(self.image, self.per_metre, dtype=np.float32)


def depth_frame(depth: Any, intrinsics: Intrinsics) -> DepthFrame:
    """Return a depth image checked.

    Args:
        depth: Shape (height, width): unsigned 16-bit integers in millimetres, or floats in
            metres. No return: 0, NaN, infinity or anything negative.
        intrinsics: The camera the image is of.

    Raises:
        ShapeError: If the image is not of the camera's size; an empty one never is.
        InputError: If its values are of another type.
    """
    image = np.asarray(depth)
    expected = (intrinsics.height, intrinsics.width)
    if image.dtype == np.uint16:
        checked: Image = np.ascontiguousarray(image, dtype=np.uint16)
        per_metre = 1000.0
    elif image.dtype in (np.float32, np.float64):
        with np.errstate(over="ignore"):
            metres = image.astype(np.float32)
        metres[~((metres > 0.0) & (metres < np.inf))] = 0.0
        checked, per_metre = metres, 1.0
    else:
        raise InputError(
            "a depth image of another type",
            value=str(image.dtype),
            allowed="uint16 in millimetres, float32 or float64 in metres",
        )
    if image.shape != expected:
        raise ShapeError(f"a depth image of this camera is {expected}, got {image.shape}")
    return DepthFrame(checked, np.float32(per_metre))


def points_from_depth(depth: Any, intrinsics: Intrinsics) -> Points:
    """Return the valid pixels of a depth image as points in the camera frame, row by row.

    x = (u z - cx z) / fx, and y likewise, in single precision as the reference library keeps it.

    Args:
        depth: As for `depth_frame`.
        intrinsics: The camera.

    Returns:
        Shape (N, 3), [m]; (0, 3) if there is no return at all.

    Raises:
        ShapeError: If the image is not of the camera's size.
        InputError: If its values are of another type.
    """
    frame = depth_frame(depth, intrinsics)
    lens = np.array([intrinsics.fx, intrinsics.fy, intrinsics.cx, intrinsics.cy], dtype=np.float32)
    return lift(frame.image, frame.per_metre, lens)


def depth_from_points(points_camera: ArrayLike, intrinsics: Intrinsics) -> NDArray[np.float32]:
    """Return the depth image of points: each falls on the pixel nearest to it, the nearest stays.

    Args:
        points_camera: Shape (N, 3), camera frame, [m]; what is not finite, behind the camera or
            outside the image is left out.
        intrinsics: The camera.

    Returns:
        Shape (height, width), [m], 0 where there is no point.

    Raises:
        ShapeError: If the points are not (N, 3).
    """
    points = np.asarray(points_camera, dtype=float)
    if points.ndim != 2 or points.shape[1] != 3:
        raise ShapeError(f"points must be (N, 3), got {points.shape}")
    points = points[np.isfinite(points).all(axis=1) & (points[:, 2] > 0.0)]
    z = points[:, 2]
    column = np.rint(points[:, 0] / z * intrinsics.fx + intrinsics.cx)
    row = np.rint(points[:, 1] / z * intrinsics.fy + intrinsics.cy)
    inside = (column >= 0) & (column < intrinsics.width) & (row >= 0) & (row < intrinsics.height)
    image = np.full((intrinsics.height, intrinsics.width), np.inf, dtype=np.float32)
    place = (row[inside].astype(int), column[inside].astype(int))
    np.minimum.at(image, place, z[inside].astype(np.float32))
    image[np.isinf(image)] = 0.0
    return image
