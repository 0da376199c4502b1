"""The local obstacle map: what was seen around the chair, kept while it moves.

[DrivingAssistant, III.A]: a square grid with the chair in its middle within half a cell. It moves
with the chair in whole cells and does not turn: its axes are the odometry's, so that neither a
step nor a turn ever blurs it, and what is remembered is as good as the odometry between then and
now. Each cell holds, for each band of height, how certain it is that something is there. Lasers
write into the band of their beams, a depth camera into all it sees.

A cell is occupied from the first hit. A place that is seen free again is forgotten, sooner the less
it was seen. What no ray has passed is unknown, and unknown is never free.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..errors import InputError, ShapeError
from ..interfaces import Percept
from ..se2 import Array, transform
from ..vehicle import Vehicle
from .body_slabs import are_inside, body_slabs
from .camera import DepthCamera
from .depth_image import depth_frame
from .last_words import LastWords
from .map_cells import begin_update
from .map_depth_kernels import hit_pixels, pass_pixels
from .map_look_kernels import look_around, stand_on
from .map_memory import MapMemory
from .map_options import MapOptions
from .map_ray_kernels import hit_points, pass_rays
from .map_rays import Rays, rays_of_scan, rays_to_points, view_of
from .obstacles import ObstacleFinder
from .ranges import LaserScan, UltrasoundReadings
from .surroundings import Cell, Sight, Surroundings

_FURTHEST = 1e8  # m: from the odometry's origin; a float tells places there 15 nm apart


class ObstacleMap:
    """What is known around a chair.

    `move_to` says where the chair believes to be when a sensor's answer is added; all that is
    added is in the body frame at that pose.

    Attributes:
        options: Size and rules.
        pose: The pose believed last, shape (3,), [m, m, rad].
    """

    def __init__(
        self,
        options: MapOptions | None = None,
        *,
        vehicle: Vehicle | None = None,
        pose: ArrayLike = (0.0, 0.0, 0.0),
    ) -> None:
        """Make a map of which every cell is unknown.

        Args:
            options: Size and rules.
            vehicle: The chair: where it stands is free, and its own returns are left out. None: a
                chair without a body.
            pose: Where it believes to be, shape (3,), [m, m, rad].
        """
        self.options = options or MapOptions()
        place = _pose(pose)
        self._memory = MapMemory(self.options, place[:2])
        edges = self._memory.cells.edges
        self._slabs = [] if vehicle is None else body_slabs(vehicle, edges)
        self._words = LastWords(self.options.sensors)
        self.pose = place
        self._stand()

    def move_to(self, pose: ArrayLike) -> None:
        """Move the chair: the map follows in whole cells; what leaves it is forgotten.

        Of a jump further than the map nothing is left.

        Args:
            pose: Pose the chair believes to have, shape (3,), [m, m, rad].

        Raises:
            ShapeError: If it is no pose, or not finite.
            InputError: If it is 100,000 km away.
        """
        self.pose = _pose(pose)
        self._memory.follow(self.pose[:2])
        self._stand()

    def forget(self) -> None:
        """Make every cell unknown."""
        self._memory.forget()

    def add_scan(self, scan: LaserScan) -> None:
        """Add a laser scan taken at the pose believed last.

        A scan in which no beam answers is silence: nothing changes, and the sensor counts as not
        having spoken.
        """
        if not scan.has_answer:
            return
        self._words.hear(scan.sensor, scan.time)
        self._add(rays_of_scan(scan, self.options))

    def add_points(
        self, points: ArrayLike, *, time: float, sensor: str, eye: ArrayLike | None = None
    ) -> None:
        """Add points of obstacles, seen at the pose believed last.

        Points below the lowest band are floor: they are not occupied, but rays to them clear.

        Args:
            points: Body frame, z above the floor, shape (N, 3), [m]; rows that are not finite are
                left out. If none is left the sensor counts as not having spoken.
            time: When they were seen [s].
            sensor: Name of the sensor.
            eye: Where the sensor is, body frame, shape (3,): what lies between it and the points
                is free. None: nothing is known to be free.

        Raises:
            ShapeError: If points or eye have another shape.
        """
        rays = rays_to_points(points, eye, self.options.short)
        if len(rays.points):
            self._words.hear(sensor, time)
            self._add(rays)

    def add_echoes(self, readings: UltrasoundReadings) -> None:
        """Add ultrasonic echoes: all of the arc an echo may come from; they clear nothing."""
        if readings.has_answer:
            self._words.hear(readings.sensor, readings.time)
            self._add(rays_to_points(readings.arcs(self.options.cell), None, 0.0))

    def add_frame(
        self,
        depth: Any,
        seen: Surroundings,
        finder: ObstacleFinder,
        *,
        sensor: str = "camera",
    ) -> None:
        """Add a depth frame taken at the pose believed last, and what the fast route made of it.

        Pixels above the floor that belong to an obstacle are hits, drop-offs fill the lowest band,
        and what the camera looks through is free; where the floor is only assumed nothing is. A
        blind or silent camera counts as not having spoken.

        Args:
            depth: The image that `seen` was made of.
            seen: `finder.see(depth, time)`.
            finder: The camera and its thresholds.
            sensor: Name of the camera.

        Raises:
            ShapeError: If the image is not of the camera's size.
            InputError: If its values are of another type.
        """
        if seen.floor is None or seen.sight in (Sight.BLIND, Sight.SILENT):
            return
        camera, area, cells = finder.camera, seen.grid, self._memory.cells
        frame = depth_frame(depth, camera.intrinsics)
        view = view_of(
            camera, seen.floor, frame, self.pose, self.options.short, finder.options.steps
        )
        self._words.hear(sensor, seen.time)
        begin_update(cells)
        holes = area.spots(np.equal(seen.cells, Cell.DROP), 0.7 * self.options.cell)
        self._hit(np.column_stack([holes, np.full(len(holes), self.options.bands[0])]))
        hit_pixels(
            cells,
            self._memory.origin,
            view,
            frame.image,
            finder.thresholds(seen.floor),
            np.array([area.x_from, area.y_from, area.cell]),
            seen.cells,
            Cell.OBSTACLE,
            self._stride(camera),
        )
        if seen.floor.is_seen:
            pass_pixels(cells, self._memory.origin, view, frame.image)

    def percept(
        self, *, reach: float = math.inf, heights: tuple[float, float] = (0.0, math.inf)
    ) -> Percept:
        """Return what controllers are given: occupied cells, and where the known ends.

        `points` are the middles of occupied cells, z the middle of their band; `spread` is half a
        cell's diagonal. `unknown` are the cells of which nothing is known in these heights, those
        beside free ones: nothing gets from the free into the unknown but across them.

        Args:
            reach: Distance from the body's origin up to which cells are returned [m].
            heights: Bands that lie between these are looked at, in part is enough [m].

        Raises:
            InputError: If the reach is not positive.
        """
        if not reach > 0.0:
            raise InputError("no reach", field="reach", value=reach, allowed="> 0 m")
        points, unknown = look_around(
            self._memory.cells,
            self._memory.origin,
            self.pose,
            min(reach, 2.0 * self.options.side),
            self._memory.mask(heights),
        )
        return Percept(self.time, points, self.options.cell / math.sqrt(2.0), unknown)

    @property
    def time(self) -> float:
        """When the sensor that has been silent longest last spoke [s]; -inf: one never has."""
        return self._words.oldest

    @property
    def heard(self) -> Mapping[str, float]:
        """When each sensor last spoke [s]."""
        return self._words.times

    @property
    def extent(self) -> tuple[float, float, float, float]:
        """x_min, x_max, y_min, y_max of the map in the world [m]."""
        return self._memory.extent

    def states(self, heights: tuple[float, float] = (0.0, math.inf)) -> NDArray[np.uint8]:
        """Return values of `Cell` seen from above, shape (n along world x, n along world y).

        Occupied: in one of the bands between the heights. Free: none is occupied and one is free.
        """
        return self._memory.states(heights)

    def certainty(self, height: float) -> NDArray[np.int8]:
        """Return the certainty in the band that holds a height, shape (n, n).

        Raises:
            InputError: If no band holds it.
        """
        return self._memory.certainty(height)

    def is_free(
        self, points: ArrayLike, heights: tuple[float, float] = (0.0, math.inf)
    ) -> NDArray[np.bool_]:
        """Return which points (N, 2) of the body frame lie in free cells; outside the map none.

        Raises:
            ShapeError: If the points are not (N, 2).
        """
        rows = np.asarray(points, dtype=float)
        if rows.ndim != 2 or rows.shape[1] != 2:
            raise ShapeError(f"points must be (N, 2), got {rows.shape}")
        return self._memory.are_free(transform(self.pose, rows), heights)

    def _add(self, rays: Rays) -> None:
        begin_update(self._memory.cells)
        self._hit(rays.points)
        if len(rays.ends):
            eye = self._in_world(rays.eye[None])[0]
            pass_rays(self._memory.cells, self._memory.origin, eye, self._in_world(rays.ends))

    def _stride(self, camera: DepthCamera) -> int:
        """Return a stride at which pixels at the furthest depth are a cell apart."""
        lens = camera.intrinsics
        pixels = self.options.cell * min(lens.fx, lens.fy) / camera.furthest
        return max(1, math.floor(pixels))

    def _hit(self, points: Array) -> None:
        outside = points[~are_inside(self._slabs, points, self.options.own)]
        hit_points(self._memory.cells, self._memory.origin, self._in_world(outside))

    def _in_world(self, points: Array) -> Array:
        return np.column_stack([transform(self.pose, points[:, :2]), points[:, 2]])

    def _stand(self) -> None:
        for slab in self._slabs:
            stand_on(
                self._memory.cells,
                self._memory.origin,
                self.pose,
                slab.normals,
                slab.offsets,
                slab.bands,
                slab.reach,
                self.options.deep,
            )


def _pose(pose: ArrayLike) -> Array:
    checked = np.array(pose, dtype=float)
    if checked.shape != (3,) or not np.isfinite(checked).all():
        raise ShapeError(f"a pose is finite [x, y, heading], got {checked}")
    if np.abs(checked[:2]).max() > _FURTHEST:
        allowed = f"up to {_FURTHEST:g} m from the origin"
        raise InputError("too far away for cells", field="pose", value=checked, allowed=allowed)
    checked.setflags(write=False)
    return checked
