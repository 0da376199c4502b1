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
from .body_slabs import body_slabs
from .camera import DepthCamera
from .depth_image import depth_frame
from .map_cells import begin_update, forget_lines, unknown_cells
from .map_depth_kernels import Optics, View, hit_pixels, pass_pixels
from .map_look_kernels import look_around, stand_on
from .map_options import MapOptions
from .map_ray_kernels import hit_points, pass_rays
from .obstacles import ObstacleFinder
from .ranges import LaserScan, UltrasoundReadings
from .surroundings import Cell, Sight, Surroundings


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
        chosen, count = self.options, self.options.count
        edges = np.array(chosen.bands, dtype=float)
        self._cells = unknown_cells(count, edges, chosen.cell, chosen.hit, chosen.miss, chosen.most)
        self._slabs = [] if vehicle is None else body_slabs(vehicle, edges)
        self._heard: dict[str, float] = dict.fromkeys(chosen.sensors, -math.inf)
        self.pose = _pose(pose)
        self._origin = self._corner(self.pose)
        self._stand()

    def move_to(self, pose: ArrayLike) -> None:
        """Move the chair: the map follows in whole cells; what leaves it is forgotten.

        Of a jump further than the map nothing is left.

        Args:
            pose: Pose the chair believes to have, shape (3,), [m, m, rad].

        Raises:
            ShapeError: If it is no pose, or not finite.
        """
        self.pose = _pose(pose)
        corner = self._corner(self.pose)
        size = self.options.count
        moved = corner - self._origin
        if (np.abs(moved) >= size).any():
            self.forget()
        else:
            for axis in (0, 1):
                steps = int(moved[axis])
                first = self._origin[axis] if steps > 0 else corner[axis]
                if steps:
                    forget_lines(self._cells, int(first) % size, abs(steps), axis)
        self._origin = corner
        self._stand()

    def forget(self) -> None:
        """Make every cell unknown."""
        forget_lines(self._cells, 0, self.options.count, 0)

    def add_scan(self, scan: LaserScan) -> None:
        """Add a laser scan taken at the pose believed last.

        A scan in which no beam answers is silence: nothing changes, and the sensor counts as not
        having spoken.
        """
        if not scan.has_answer:
            return
        points = scan.points
        reach = np.minimum(scan.free_reach(short=self.options.short), 2.0 * self.options.side)
        seen = np.flatnonzero(reach > 0.0)
        place = np.array([scan.mounting.x, scan.mounting.y, scan.mounting.height])
        ends = place + np.zeros((len(seen), 1))
        ends[:, :2] += reach[seen, None] * scan.directions[seen]
        self._add(points, place, ends)
        self._hear(scan.sensor, scan.time)

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
        rows = np.asarray(points, dtype=float)
        if rows.ndim != 2 or rows.shape[1] != 3:
            raise ShapeError(f"points must be (N, 3), got {rows.shape}")
        rows = rows[np.isfinite(rows).all(axis=1)]
        if not len(rows):
            return
        place, ends = np.zeros(3), np.zeros((0, 3))
        if eye is not None:
            place = np.array(eye, dtype=float)
            if place.shape != (3,) or not np.isfinite(place).all():
                raise ShapeError(f"eye must be a finite point (3,), got {place}")
            way = rows - place
            length = np.linalg.norm(way, axis=1)
            share = np.maximum(length - self.options.short, 0.0) / np.maximum(length, 1e-12)
            ends = place + share[:, None] * way
        self._add(rows, place, ends)
        self._hear(sensor, time)

    def add_echoes(self, readings: UltrasoundReadings) -> None:
        """Add ultrasonic echoes: all of the arc an echo may come from; they clear nothing."""
        if readings.has_answer:
            arcs = readings.arcs(self.options.cell)
            self._add(arcs, np.zeros(3), np.zeros((0, 3)))
            self._hear(readings.sensor, readings.time)

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
        camera, mounting, area = finder.camera, seen.floor.mounting, seen.grid
        frame = depth_frame(depth, camera.intrinsics)
        lens = camera.intrinsics
        optics = Optics(
            float(lens.fx),
            float(lens.fy),
            float(lens.cx),
            float(lens.cy),
            frame.per_metre,
            camera.furthest,
            self.options.short,
            finder.options.steps * camera.step,
        )
        pose = np.column_stack([mounting.camera_to_body, mounting.position])
        view = View(optics, pose, self.pose)
        corner = np.array([area.x_from, area.y_from, area.cell])
        begin_update(self._cells)
        holes = area.spots(np.equal(seen.cells, Cell.DROP), 0.7 * self.options.cell)
        self._hit(np.column_stack([holes, np.full(len(holes), self.options.bands[0])]))
        hit_pixels(
            self._cells,
            self._origin,
            view,
            frame.image,
            finder.thresholds(seen.floor),
            corner,
            seen.cells,
            Cell.OBSTACLE,
            self._stride(camera),
        )
        if seen.floor.is_seen:
            pass_pixels(self._cells, self._origin, view, frame.image)
        self._hear(sensor, seen.time)

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
        """
        points, unknown = look_around(
            self._cells,
            self._origin,
            self.pose,
            min(reach, 2.0 * self.options.side),
            self._mask(heights),
        )
        return Percept(self.time, points, self.options.cell / math.sqrt(2.0), unknown)

    @property
    def time(self) -> float:
        """When the sensor that has been silent longest last spoke [s]; -inf: one never has."""
        return min(self._heard.values(), default=-math.inf)

    @property
    def heard(self) -> Mapping[str, float]:
        """When each sensor last spoke [s]."""
        return dict(self._heard)

    @property
    def extent(self) -> tuple[float, float, float, float]:
        """x_min, x_max, y_min, y_max of the map in the world [m]."""
        low = self._origin * self.options.cell
        high = low + self.options.count * self.options.cell
        return float(low[0]), float(high[0]), float(low[1]), float(high[1])

    def states(self, heights: tuple[float, float] = (0.0, math.inf)) -> NDArray[np.uint8]:
        """Return values of `Cell` seen from above, shape (n along world x, n along world y).

        Occupied: in one of the bands between the heights. Free: none is occupied and one is free.
        """
        mask = self._mask(heights)
        occupied = np.not_equal(self._cells.occupied & mask, 0)
        free = np.not_equal(self._cells.free & mask, 0)
        cells = np.where(occupied, Cell.OBSTACLE, np.where(free, Cell.FREE, Cell.UNKNOWN))
        return self._unrolled(cells.astype(np.uint8))

    def certainty(self, height: float) -> NDArray[np.int8]:
        """Return the certainty in the band that holds a height, shape (n, n).

        Raises:
            InputError: If no band holds it.
        """
        edges = self._cells.edges
        if not edges[0] <= height < edges[-1]:
            allowed = f"{edges[0]} to {edges[-1]} m"
            raise InputError("no band there", field="height", value=height, allowed=allowed)
        band = int(np.searchsorted(edges, height, side="right")) - 1
        return self._unrolled(self._cells.certainty[:, :, band])

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
        place = np.floor(transform(self.pose, rows) / self.options.cell) - self._origin
        inside = np.logical_and(place >= 0.0, place < self.options.count).all(axis=1)
        i, j = np.where(np.expand_dims(inside, 1), place, 0.0).astype(np.int64).T
        free: NDArray[np.bool_] = np.equal(self.states(heights)[i, j], Cell.FREE)
        return inside & free

    def _add(self, points: Array, eye: Array, ends: Array) -> None:
        """Hit points (N, 3) and clear rays to ends (M, 3), all in the body frame."""
        begin_update(self._cells)
        self._hit(points)
        if len(ends):
            place = self._in_world(eye[None])[0]
            pass_rays(self._cells, self._origin, place, self._in_world(ends))

    def _stride(self, camera: DepthCamera) -> int:
        """Return a stride at which pixels at the furthest depth are a cell apart."""
        lens = camera.intrinsics
        pixels = self.options.cell * min(lens.fx, lens.fy) / camera.furthest
        return max(1, math.floor(pixels))

    def _hit(self, points: Array) -> None:
        outside = points[~self._are_own(points)]
        hit_points(self._cells, self._origin, self._in_world(outside))

    def _in_world(self, points: Array) -> Array:
        return np.column_stack([transform(self.pose, points[:, :2]), points[:, 2]])

    def _are_own(self, points: Array) -> NDArray[np.bool_]:
        """Return which points lie in the chair's own body."""
        own = np.zeros(len(points), dtype=bool)
        for slab in self._slabs:
            depth = (slab.offsets - points[:, :2] @ slab.normals.T).min(axis=1)
            own |= (
                (depth > self.options.own) & (points[:, 2] >= slab.low) & (points[:, 2] < slab.high)
            )
        return own

    def _stand(self) -> None:
        for slab in self._slabs:
            stand_on(
                self._cells,
                self._origin,
                self.pose,
                slab.normals,
                slab.offsets,
                slab.bands,
                slab.reach,
                self.options.deep,
            )

    def _hear(self, sensor: str, time: float) -> None:
        if not math.isfinite(time):
            raise InputError("not a time", field="time", value=time)
        if self.options.sensors and sensor not in self.options.sensors:
            allowed = ", ".join(self.options.sensors)
            raise InputError("no such sensor", field="sensor", value=sensor, allowed=allowed)
        self._heard[sensor] = max(time, self._heard.get(sensor, -math.inf))

    def _corner(self, pose: Array) -> NDArray[np.int64]:
        """Return the world cell in the window's lower corner: the chair within half a cell."""
        middle = np.rint(pose[:2] / self.options.cell)
        return middle.astype(np.int64) - self.options.count // 2

    def _mask(self, heights: tuple[float, float]) -> np.uint32:
        low, high = heights
        edges = self._cells.edges
        bands = np.flatnonzero((edges[1:] > low) & (edges[:-1] < high))
        return np.uint32(sum(1 << int(band) for band in bands))

    def _unrolled(self, cells: NDArray[Any]) -> NDArray[Any]:
        """Return cells of the ring with the window's corner first."""
        i, j = (int(-corner % self.options.count) for corner in self._origin)
        return np.roll(cells, (i, j), axis=(0, 1))


def _pose(pose: ArrayLike) -> Array:
    checked = np.array(pose, dtype=float)
    if checked.shape != (3,) or not np.isfinite(checked).all():
        raise ShapeError(f"a pose is finite [x, y, heading], got {checked}")
    checked.setflags(write=False)
    return checked
