"""A depth camera in the simulated world: the Kinect's geometry and its manners [FuzzyDVZ, 3.2]."""

from __future__ import annotations

import math
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..errors import InputError
from ..perception.camera import DepthCamera, Intrinsics, Mounting
from ..se2 import Array
from .depth_kernels import draw_world
from .depth_manner_kernels import sensor_image
from .surfaces import SensedWorld, checked_pose


@dataclass(frozen=True)
class DepthManners:
    """What a structured-light camera does to what it sees; reach and step are the camera's.

    Attributes:
        nearest: Depth below which nothing comes back [m].
        incidence: Greatest angle between ray and surface normal that comes back [rad].
        edge: Where the inverse depth's slope changes by more than this share of it from one pixel
            to the next there is an edge, and nothing comes back from either side of it.
        baseline: From the camera to its projector, to the right [m]: what the projector cannot see
            is missing, a shadow on the left of what stands in front; 0: none.
        noise: Standard deviation of an inverse depth before it is quantised [1/m].
        dropouts: Share of returns that are lost, each by itself.
    """

    nearest: float = 0.5
    incidence: float = math.radians(80.0)
    edge: float = 0.03
    baseline: float = 0.075
    noise: float = 1.45e-3
    dropouts: float = 0.0

    def __post_init__(self) -> None:
        """Refuse what no camera does."""
        for name in ("nearest", "edge"):
            value = getattr(self, name)
            if not (math.isfinite(value) and value > 0.0):
                raise InputError("must be positive", field=name, value=value, allowed="> 0")
        for name in ("baseline", "noise"):
            value = getattr(self, name)
            if not (math.isfinite(value) and value >= 0.0):
                raise InputError("must not be negative", field=name, value=value, allowed=">= 0")
        if not 0.0 < self.incidence <= 0.5 * math.pi:
            raise InputError("an angle of incidence", field="incidence", value=self.incidence)
        if not 0.0 <= self.dropouts <= 1.0:
            raise InputError("a share", field="dropouts", value=self.dropouts, allowed="0 to 1")


def kinect(mounting: Mounting, *, width: int = 640, height: int = 480) -> DepthCamera:
    """Return a Kinect as it is mounted: 57 x 43 deg, 4 m, 2.9e-3 1/m a step [FuzzyDVZ, 3.2]."""
    view = (math.radians(57.0), math.radians(43.0))
    return DepthCamera(Intrinsics.from_field_of_view(*view, width, height), mounting)


@dataclass(frozen=True)
class DepthSensor:
    """A depth camera that can be asked what it returns.

    Attributes:
        camera: Geometry, mounting, furthest depth, step of quantisation.
        manners: What it does to what it sees.
    """

    camera: DepthCamera
    manners: DepthManners = field(default_factory=DepthManners)

    def inverse_depth(
        self, world: SensedWorld, pose: ArrayLike, time: float = 0.0, *, reach: float = math.inf
    ) -> Array:
        """Return the exact inverse depth of what each pixel shows, shape (height, width), [1/m].

        0 where there is nothing, above the horizon; infinite everywhere inside a solid. The floor
        reaches to the horizon.

        Args:
            world: As in `Sensor.measure`, like pose and time.
            pose: Of the chair.
            time: When.
            reach: Solids further than this, seen from above, are left out [m].

        Raises:
            ShapeError: If the pose or the time is not finite.
        """
        x, y, heading = checked_pose(pose)
        lens, mounting = self.camera.intrinsics, self.camera.mounting
        c, s = math.cos(heading), math.sin(heading)
        turn = np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])
        pixel = np.array(
            [
                [1.0 / lens.fx, 0.0, -lens.cx / lens.fx],
                [0.0, 1.0 / lens.fy, -lens.cy / lens.fy],
                [0.0, 0.0, 1.0],
            ]
        )
        basis = turn @ mounting.camera_to_body @ pixel
        origin = turn @ mounting.position + np.array([x, y, 0.0])
        there = world.at(time)
        image = np.empty((lens.height, lens.width))
        outside = draw_world(
            image,
            np.ascontiguousarray(basis),
            origin,
            there.corners,
            there.counts,
            there.heights,
            there.rounds,
            reach,
        )
        if not outside:
            image[:] = np.inf
        return image

    def measure(
        self,
        world: SensedWorld,
        pose: ArrayLike,
        time: float = 0.0,
        *,
        rng: np.random.Generator | None = None,
    ) -> NDArray[np.uint16]:
        """Return the depth image the camera delivers, shape (height, width), [mm]; 0: no return.

        `Sensor.measure`. Quantised in inverse depth; without returns too near and too far, at
        edges, in the projector's shadow and at grazing incidence; none at all inside a solid.
        """
        camera, manners = self.camera, self.manners
        lens = camera.intrinsics
        # What is left out is beyond twice the furthest return: beside it is an edge either way.
        corner = max(lens.cx, lens.width - 1 - lens.cx) / lens.fx
        reach = 2.0 * camera.furthest * math.hypot(1.0, corner)
        exact = self.inverse_depth(world, pose, time, reach=reach)
        noise = np.empty((0, 0), np.float32) if rng is None else self._noise(exact.shape, rng)
        limits = np.array(
            [
                1.0 / camera.furthest,
                1.0 / manners.nearest,
                manners.edge,
                math.cos(manners.incidence),
                manners.baseline,
            ]
        )
        image = np.empty(exact.shape, dtype=np.uint16)
        optics = np.array([lens.fx, lens.fy, lens.cx, lens.cy])
        sensor_image(exact, noise, manners.noise, optics, limits, camera.step, image)
        return image

    def _noise(self, shape: tuple[int, ...], rng: np.random.Generator) -> NDArray[np.float32]:
        """Return standard normal numbers, NaN where a return is lost; empty if neither is asked."""
        manners = self.manners
        noise = np.empty((0, 0), np.float32)
        if manners.noise > 0.0:
            noise = rng.standard_normal(shape, dtype=np.float32)
        elif manners.dropouts > 0.0:
            noise = np.zeros(shape, np.float32)
        if manners.dropouts > 0.0:
            noise[rng.random(shape, dtype=np.float32) < manners.dropouts] = np.nan
        return noise
