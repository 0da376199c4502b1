"""A chair that stands and looks around: averaged scans and frames into a map, and doors in them."""

from __future__ import annotations

import math
from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import NDArray

from ..errors import InputError
from ..perception.camera import DepthCamera, Mounting
from ..perception.map_options import MapOptions, bands_of
from ..perception.obstacle_map import ObstacleMap
from ..perception.obstacles import ObstacleFinder
from ..perception.openings import find_doors
from ..perception.ranges import Beam, LaserScan
from ..scene import Scene
from ..se2 import Array, transform
from ..trajectory import Trajectory
from ..vehicle import Vehicle
from ..world import Door
from .depth_sensor import DepthSensor, kinect
from .laser import LaserManners, on_corners
from .sensed_space import SensedSpace
from .surfaces import SensedWorld

_SAME_DOOR = 0.5  # m: doors nearer to each other are one
_ASIDE = math.radians(50.0)  # a camera's view overlaps that ahead by 7 deg


@dataclass(frozen=True)
class LookOptions:
    """What the chair looks around with.

    Attributes:
        manners: Of the two laser scanners on its corners.
        camera_headings: Where a depth camera above its front turns to, counter-clockwise from
            ahead [rad]: what lasers pass under or over, such as a table top, is seen by it alone.
            None at all: there is no camera.
        camera_reach: Depth up to which its returns are used [m].
        scans: Taken at each look and averaged, frames likewise: the chair stands.
        rate: Of the scans [Hz].
        cell: Of the map [m].
        side: Of the map [m].
        seed: Of the sensors' noise.
    """

    manners: LaserManners = field(default_factory=lambda: LaserManners(beams=1081))
    camera_headings: tuple[float, ...] = (0.0, _ASIDE, -_ASIDE)
    camera_reach: float = 2.5
    scans: int = 8
    rate: float = 12.5
    cell: float = 0.02
    side: float = 16.0
    seed: int = 0

    def __post_init__(self) -> None:
        """Refuse to look without looking."""
        if self.scans < 1:
            raise InputError("no look", field="scans", value=self.scans, allowed=">= 1")
        if not 0.0 < self.rate < math.inf:
            raise InputError("no rate", field="rate", value=self.rate, allowed="> 0 Hz")

    @property
    def duration(self) -> float:
        """How long a look takes [s]."""
        return self.scans / self.rate


class Lookout:
    """The sensors of a chair in a scene's true world, and the map of what they have seen.

    Attributes:
        map: What is known around the chair.
    """

    def __init__(self, scene: Scene, options: LookOptions) -> None:
        """Fit the chair with sensors.

        Args:
            scene: The true world, the chair, and where it starts.
            options: What it looks with.
        """
        self._scene, self._options = scene, options
        self._sensed = SensedWorld(scene.world)
        self._scanners = on_corners(scene.vehicle, manners=options.manners)
        self._cameras = [
            _camera_of(scene.vehicle, options.camera_reach, heading)
            for heading in options.camera_headings
        ]
        self._rng = np.random.default_rng(options.seed)
        bands = bands_of(scene.vehicle)
        # A look is many scans at once: one look learns and one forgets.
        chosen = MapOptions(
            options.side, options.cell, bands, hit=1, miss=1, most=1, short=options.cell
        )
        self.map = ObstacleMap(chosen, vehicle=scene.vehicle, pose=scene.start)
        self._doors: list[Door] = []

    def look(self, time: float) -> SensedSpace:
        """Return what is known after a look around from where the chair stands.

        Args:
            time: When [s]: moving solids are where they are then.
        """
        pose, count = self.map.pose, range(self._options.scans)
        for scanner in self._scanners:
            scan = averaged(
                [scanner.measure(self._sensed, pose, time, rng=self._rng) for _ in count]
            )
            self.map.add_scan(scan)
            self._note_doors(scan)
        for camera in self._cameras:
            sensor, finder = DepthSensor(camera), ObstacleFinder(camera)
            frame = averaged_frame(
                [sensor.measure(self._sensed, pose, time, rng=self._rng) for _ in count]
            )
            self.map.add_frame(frame, finder.see(frame, time), finder)
        scene = self._scene
        return SensedSpace.of(self.map, scene.vehicle, scene.world.bounds, tuple(self._doors))

    def drive(self, leg: Trajectory) -> None:
        """Move to the end of a leg; where the chair has been there is nothing."""
        path = leg.path
        for pose in path(np.linspace(0.0, path.span, 2 + math.ceil(path.span / 0.1))):
            self.map.move_to(pose)

    def _note_doors(self, scan: LaserScan) -> None:
        """Remember the doors of a scan; one that is seen again is known better."""
        pose: Array = self.map.pose
        for seen in find_doors(scan):
            x, y = transform(pose, seen.center[None])[0].tolist()
            door = Door((x, y), seen.width, seen.heading + float(pose[2]))
            others = [d for d in self._doors if math.dist(d.center, door.center) > _SAME_DOOR]
            self._doors = [*others, door]


def averaged(scans: list[LaserScan]) -> LaserScan:
    """Return the median of scans of one sensor from one place.

    A beam is clear or invalid if most of its readings are; otherwise it returns their median.
    """
    ranges = np.stack([scan.ranges for scan in scans])
    says = np.stack([scan.beams for scan in scans])
    result = np.full(ranges.shape[1], np.nan)
    result[np.count_nonzero(says == Beam.CLEAR, axis=0) * 2 > len(scans)] = np.inf
    hit = np.count_nonzero(says == Beam.RETURN, axis=0) * 2 > len(scans)
    readings = np.where(says == Beam.RETURN, ranges, np.nan)[:, hit]
    result[hit] = np.nanmedian(readings, axis=0)
    return replace(scans[-1], ranges=result)


def averaged_frame(frames: list[NDArray[np.uint16]]) -> NDArray[np.float32]:
    """Return the mean depth of frames from one place [m], 0 where most have no return.

    The noise before the quantisation makes the mean finer than a step of it.
    """
    stack = np.stack(frames).astype(np.float32)
    returns = np.count_nonzero(stack, axis=0)
    mean = stack.sum(axis=0) / np.maximum(returns, 1) / np.float32(1e3)
    return np.where(returns * 2 > len(frames), mean, np.float32(0.0))


def _camera_of(vehicle: Vehicle, reach: float, heading: float) -> DepthCamera:
    """Return a camera above the front of a chair's highest layer, looking down that way."""
    highest = max(vehicle.layers, key=lambda layer: layer.z[1])
    front = float(highest.polygon[:, 0].max())
    mounting = Mounting(min(vehicle.height, 1.3), math.radians(25.0), front, heading=heading)
    return replace(kinect(mounting), furthest=reach)
