"""A depth camera on a chair: its geometry, and where it is mounted.

Frames: `camera` is the optical frame (x right, y down, z forward along the optical axis), `body`
the chair's (origin on the floor midway between the drive wheels, x forward, y left, z up). Depth is
the z coordinate in the camera frame, not the distance.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike

from ..errors import InputError
from ..se2 import Array

_TO_BODY_AXES = np.array([[0.0, 0.0, 1.0], [-1.0, 0.0, 0.0], [0.0, -1.0, 0.0]])


@dataclass(frozen=True)
class Intrinsics:
    """Pinhole geometry of a depth image.

    Attributes:
        fx: Focal length along the columns [px].
        fy: Focal length along the rows [px].
        cx: Column of the optical axis, pixel centres at whole numbers [px].
        cy: Row of the optical axis [px].
        width: Number of columns.
        height: Number of rows.
    """

    fx: float
    fy: float
    cx: float
    cy: float
    width: int = 640
    height: int = 480

    def __post_init__(self) -> None:
        """Refuse what no camera has."""
        for name in ("fx", "fy", "width", "height"):
            value = getattr(self, name)
            if not (math.isfinite(value) and value > 0):
                raise InputError("no camera has that", field=name, value=value, allowed="> 0")
        for name in ("width", "height"):
            value = getattr(self, name)
            if value != int(value):
                raise InputError(
                    "not a number of pixels", field=name, value=value, allowed="1, 2, …"
                )
        for name in ("cx", "cy"):
            if not math.isfinite(getattr(self, name)):
                raise InputError("not a place", field=name, value=getattr(self, name))

    @classmethod
    def from_field_of_view(
        cls, horizontal: float, vertical: float, width: int = 640, height: int = 480
    ) -> Intrinsics:
        """Return the geometry with given angles between the image's outer edges [rad].

        >>> kinect = Intrinsics.from_field_of_view(np.radians(57.0), np.radians(43.0))
        >>> round(kinect.fx, 1), round(kinect.fy, 1), kinect.cx
        (589.4, 609.3, 319.5)

        Raises:
            InputError: If an angle is not between 0 and pi.
        """
        for name, angle in (("horizontal", horizontal), ("vertical", vertical)):
            if not 0.0 < angle < math.pi - 1e-6:
                raise InputError("no view", field=name, value=angle, allowed="0 to pi [rad]")
        fx = 0.5 * width / math.tan(0.5 * horizontal)
        fy = 0.5 * height / math.tan(0.5 * vertical)
        return cls(fx, fy, 0.5 * (width - 1), 0.5 * (height - 1), width, height)


@dataclass(frozen=True)
class Mounting:
    """Where a camera sits on the chair and where it looks.

    Attributes:
        height: Height of the camera above the floor [m].
        tilt: How far the optical axis points below the horizon [rad].
        x: Position ahead of the drive axle [m].
        y: Position to the left of the chair's middle [m].
        heading: Direction of the optical axis, counter-clockwise from straight ahead [rad].
        roll: Turn about the optical axis, clockwise as the camera sees itself [rad].
    """

    height: float
    tilt: float = 0.0
    x: float = 0.0
    y: float = 0.0
    heading: float = 0.0
    roll: float = 0.0

    def __post_init__(self) -> None:
        """Refuse a camera in or under the floor, and angles that are no numbers."""
        for name in ("tilt", "x", "y", "heading", "roll"):
            if not math.isfinite(getattr(self, name)):
                raise InputError("not a number", field=name, value=getattr(self, name))
        if not (math.isfinite(self.height) and self.height > 0.0):
            raise InputError(
                "a camera is above the floor", field="height", value=self.height, allowed="> 0 m"
            )

    @cached_property
    def camera_to_body(self) -> Array:
        """Rotation from the camera frame to the body frame, shape (3, 3)."""
        ch, sh = math.cos(self.heading), math.sin(self.heading)
        ct, st = math.cos(self.tilt), math.sin(self.tilt)
        cr, sr = math.cos(self.roll), math.sin(self.roll)
        turn = np.array([[ch, -sh, 0.0], [sh, ch, 0.0], [0.0, 0.0, 1.0]])
        nod = np.array([[ct, 0.0, st], [0.0, 1.0, 0.0], [-st, 0.0, ct]])
        lean = np.array([[1.0, 0.0, 0.0], [0.0, cr, -sr], [0.0, sr, cr]])
        rotation: Array = turn @ nod @ lean @ _TO_BODY_AXES
        rotation.setflags(write=False)
        return rotation

    @property
    def position(self) -> Array:
        """The camera in the body frame, shape (3,), [m]."""
        return np.array([self.x, self.y, self.height])

    @property
    def up(self) -> Array:
        """The vertical in the camera frame, shape (3,): `up @ p + height` is p's height."""
        up: Array = self.camera_to_body[2]
        return up

    def to_body(self, points_camera: ArrayLike) -> Array:
        """Return points of the camera frame in the body frame, shape (..., 3), [m].

        >>> Mounting(height=0.8, x=0.3).to_body([0.0, 0.8, 2.0]).round(12)
        array([2.3, 0. , 0. ])
        """
        points = np.asarray(points_camera, dtype=float)
        result: Array = points @ self.camera_to_body.T + self.position
        return result

    def to_camera(self, points_body: ArrayLike) -> Array:
        """Return points of the body frame in the camera frame, shape (..., 3), [m]."""
        points = np.asarray(points_body, dtype=float)
        result: Array = (points - self.position) @ self.camera_to_body
        return result


@dataclass(frozen=True)
class DepthCamera:
    """A depth camera as it is mounted.

    Attributes:
        intrinsics: Geometry of its image.
        mounting: Where it sits.
        furthest: Depth beyond which its returns are not used [m].
        step: Step of its quantisation, uniform in inverse depth [1/m].
    """

    intrinsics: Intrinsics
    mounting: Mounting
    furthest: float = 4.0
    step: float = 2.9e-3

    def __post_init__(self) -> None:
        """Refuse ranges and steps that are not positive."""
        for name in ("furthest", "step"):
            value = getattr(self, name)
            if not (math.isfinite(value) and value > 0.0):
                raise InputError("not a range", field=name, value=value, allowed="> 0")
