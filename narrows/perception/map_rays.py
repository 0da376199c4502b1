"""What sensors' answers mean to the obstacle map: points that are hit, and rays that are clear."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from ..errors import ShapeError
from ..se2 import Array
from .camera import DepthCamera
from .depth_image import DepthFrame
from .floor import Floor
from .map_options import MapOptions
from .map_view_kernels import Optics, View
from .ranges import LaserScan


class Rays(NamedTuple):
    """What was hit and what was looked through, body frame [m].

    Attributes:
        points: Of obstacles, shape (N, 3).
        eye: Where the sensor is, shape (3,).
        ends: Up to where rays are clear, shape (M, 3).
    """

    points: Array
    eye: Array
    ends: Array


def rays_of_scan(scan: LaserScan, options: MapOptions) -> Rays:
    """Return the hits and clear rays of a laser scan."""
    reach = np.minimum(scan.free_reach(short=options.short), 2.0 * options.side)
    seen = np.flatnonzero(reach > 0.0)
    eye = np.array([scan.mounting.x, scan.mounting.y, scan.mounting.height])
    ends = eye + np.zeros((len(seen), 1))
    ends[:, :2] += reach[seen, None] * scan.directions[seen]
    return Rays(scan.points, eye, ends)


def rays_to_points(points: ArrayLike, eye: ArrayLike | None, short: float) -> Rays:
    """Return the points that are finite as hits, and rays that are clear to a little before them.

    Args:
        points: Shape (N, 3).
        eye: Where the sensor is, shape (3,); None: nothing is clear.
        short: How much before a point its ray ends [m].

    Raises:
        ShapeError: If points or eye have another shape.
    """
    rows = np.asarray(points, dtype=float)
    if rows.ndim != 2 or rows.shape[1] != 3:
        raise ShapeError(f"points must be (N, 3), got {rows.shape}")
    rows = rows[np.isfinite(rows).all(axis=1)]
    if eye is None:
        return Rays(rows, np.zeros(3), np.zeros((0, 3)))
    place = np.array(eye, dtype=float)
    if place.shape != (3,) or not np.isfinite(place).all():
        raise ShapeError(f"eye must be a finite point (3,), got {place}")
    way = rows - place
    length = np.linalg.norm(way, axis=1)
    share = np.maximum(length - short, 0.0) / np.maximum(length, 1e-12)
    return Rays(rows, place, place + share[:, None] * way)


def view_of(
    camera: DepthCamera, floor: Floor, frame: DepthFrame, chair: Array, short: float, steps: float
) -> View:
    """Return how a camera looks over a floor.

    Args:
        camera: Its lens and range.
        floor: The floor, and how the camera is mounted over it.
        frame: The image.
        chair: Pose of the chair in the world, shape (3,).
        short: How much before a return a cell must lie to be free, at no depth [m].
        steps: What more at any depth, in steps of quantisation.
    """
    lens, mounting = camera.intrinsics, floor.mounting
    optics = Optics(
        float(lens.fx),
        float(lens.fy),
        float(lens.cx),
        float(lens.cy),
        frame.per_metre,
        float(camera.furthest),
        float(short),
        float(steps * camera.step),
    )
    pose = np.column_stack([mounting.camera_to_body, mounting.position])
    return View(optics, pose, chair)
