"""A depth camera over the obstacle map: what pixels mean, and which columns of cells it sees."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from ..se2 import Array
from .compiled import compiled
from .depth_kernels import Image


class Optics(NamedTuple):
    """What the pixels of a depth camera mean.

    Attributes:
        fx: Focal length along the columns [px].
        fy: Focal length along the rows [px].
        cx: Column of the optical axis [px].
        cy: Row of the optical axis [px].
        per_metre: What one metre is in the image.
        furthest: Depth beyond which returns are not used [m].
        short: How much before a return a cell must lie to be free, at no depth [m].
        growth: What that grows by with the square of the depth [1/m].
    """

    fx: float
    fy: float
    cx: float
    cy: float
    per_metre: np.float32
    furthest: float
    short: float
    growth: float


class View(NamedTuple):
    """A depth camera where it is.

    Attributes:
        optics: What its pixels mean.
        pose: Rotation camera_to_body and position of the camera in the body frame, shape (3, 4).
        chair: Pose of the chair in the world, shape (3,).
    """

    optics: Optics
    pose: Array
    chair: Array


class Columns(NamedTuple):
    """Columns of cells as a camera sees them: its frame is affine in east, north and height.

    Attributes:
        eye: Where the camera is in the world, shape (2,), [m].
        east: Camera coordinates of a metre to the east, shape (3,).
        north: Of a metre to the north, shape (3,).
        rises: Of each band's middle above the camera, shape (K, 3), [m].
    """

    eye: Array
    east: Array
    north: Array
    rises: Array


@compiled
def columns_of(view: View, heights: Array) -> Columns:
    """Return how the camera sees columns of cells, given the heights of the bands' middles."""
    cos, sin, pose = math.cos(view.chair[2]), math.sin(view.chair[2]), view.pose
    eye = np.array(
        [
            view.chair[0] + cos * pose[0, 3] - sin * pose[1, 3],
            view.chair[1] + sin * pose[0, 3] + cos * pose[1, 3],
        ]
    )
    rises = np.empty((len(heights), 3))
    for band in range(len(heights)):
        rises[band] = (heights[band] - pose[2, 3]) * pose[2, :3]
    return Columns(
        eye, cos * pose[0, :3] - sin * pose[1, :3], sin * pose[0, :3] + cos * pose[1, :3], rises
    )


@compiled
def sides_of_view(optics: Optics, image: Image, columns: Columns) -> Array:
    """Return half-planes that hold all columns in view, shape (6, 3): [a, b, c].

    Of a column at [east, north] from the eye something may be in view where
    a east + b north + c >= 0. Each side of the view is a plane; a column crosses it unless both
    its ends are outside.
    """
    fx, fy, cx, cy = optics.fx, optics.fy, optics.cx, optics.cy
    height, width = image.shape
    planes = np.array(
        [
            [0.0, 0.0, 1.0, 0.0],
            [0.0, 0.0, -1.0, optics.furthest],
            [fx, 0.0, cx + 0.5, 0.0],
            [-fx, 0.0, width - 0.5 - cx, 0.0],
            [0.0, fy, cy + 0.5, 0.0],
            [0.0, -fy, height - 0.5 - cy, 0.0],
        ]
    )
    sides = np.zeros((len(planes), 3))
    for side in range(len(planes)):
        below = above = planes[side, 3]
        for axis in range(3):
            sides[side, 0] += planes[side, axis] * columns.east[axis]
            sides[side, 1] += planes[side, axis] * columns.north[axis]
            below += planes[side, axis] * columns.rises[0, axis]
            above += planes[side, axis] * columns.rises[-1, axis]
        sides[side, 2] = max(below, above)
    return sides


@compiled
def between(sides: Array, east: float) -> tuple[float, float]:
    """Return from where to where north a line of columns is inside half-planes [m]."""
    first, last = -1e6, 1e6
    for side in range(len(sides)):
        slope, room = sides[side, 1], sides[side, 0] * east + sides[side, 2]
        if slope > 0.0:
            first = max(first, -room / slope)
        elif slope < 0.0:
            last = min(last, -room / slope)
        elif room < 0.0:
            return 1e6, -1e6
    return max(first, -1e6), min(last, 1e6)
