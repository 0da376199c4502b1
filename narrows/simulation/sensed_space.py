"""Worlds made of what a map knows: one in which the unknown is solid, one in which it is free.

The first is for what is driven, the second for where to look next. A third, of the cells
themselves, is for the proof that what is driven is clear of all that was sensed.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property

import numpy as np
import shapely
from numpy.typing import NDArray

from ..maps.cells import regions
from ..perception.obstacle_map import ObstacleMap
from ..perception.surroundings import Cell
from ..se2 import Array, transform
from ..vehicle import Vehicle
from ..world import Door, Solid, World

Mask = NDArray[np.bool_]

_SPECK = 0.05  # m: unknown that narrow between free cells lies between two beams
_STITCH = 0.12  # m: hits that near are one thing, for the look ahead
_SMOOTH = 0.9  # cells: corners nearer to a straight line are left out
_SPLINTER = 0.24  # m: free space narrower than that is of no use
_SHELL = 0.4  # m: thickness of what surrounds the free space
_LEAST = 4  # cells of free space that are worth a polygon
_UNSEEN, _SEEN = "what is not seen to be free", "what was seen there"  # names of solids


@dataclass(frozen=True, eq=False)
class SensedSpace:
    """What a map knows at a moment, cell by cell, for each layer of a chair.

    Attributes:
        corner: Lower corner of the cells in the world, shape (2,), [m].
        cell: Edge of a cell [m].
        known: Cells of which something is known, shape (n, n): rows along y, columns along x.
        occupied: Cells occupied in the heights of each layer, shape (layers, n, n).
        vehicle: The chair.
        pose: Where it stands: there nothing else is, shape (3,).
        bounds: Of the world, as given.
        doors: Those found so far.
    """

    corner: Array
    cell: float
    known: Mask
    occupied: Mask
    vehicle: Vehicle
    pose: Array
    bounds: tuple[float, float, float, float] | None
    doors: tuple[Door, ...] = ()

    @classmethod
    def of(
        cls,
        chart: ObstacleMap,
        vehicle: Vehicle,
        bounds: tuple[float, float, float, float] | None,
        doors: tuple[Door, ...] = (),
    ) -> SensedSpace:
        """Return what a map knows now.

        A cell is known if something is known of it at one of the chair's heights; it is occupied
        for a layer if something is at that layer's heights.
        """
        from scipy import ndimage

        x_from, _, y_from, _ = chart.extent
        states = [chart.states(layer.z).T for layer in vehicle.layers]
        occupied = np.stack([state == Cell.OBSTACLE for state in states])
        free = np.asarray(np.stack([state == Cell.FREE for state in states]).any(axis=0))
        reach = math.ceil(0.5 * _SPECK / chart.options.cell)
        closed = ndimage.binary_closing(free, _disc(reach))
        corner, cell = np.array([x_from, y_from]), chart.options.cell
        known = free | occupied.any(axis=0) | closed | _under(chart, vehicle, corner)
        if bounds is not None:
            known &= _within(chart, corner, bounds)
        return cls(corner, cell, known, occupied, vehicle, chart.pose, bounds, doors)

    @cached_property
    def cautious(self) -> World:
        """What is not known to be free is solid; outlines are smoothed by less than a cell."""
        solids = []
        for layer, occupied in zip(self.vehicle.layers, self.occupied, strict=True):
            free = shapely.simplify(self._area(self._open(occupied)), _SMOOTH * self.cell)
            free = shapely.union(shapely.buffer(free, 0.0), self._stand(layer.polygon))
            outer = shapely.buffer(free, _SHELL, join_style="mitre")
            solids += _solids(shapely.difference(outer, free), layer.z, _UNSEEN)
        return World(tuple(solids), self.bounds, doors=self.doors)

    @cached_property
    def hopeful(self) -> World:
        """What is not known to be occupied is free; hits of one thing are joined."""
        from scipy import ndimage

        solids = []
        for layer, occupied in zip(self.vehicle.layers, self.occupied, strict=True):
            reach = math.ceil(0.5 * _STITCH / self.cell)
            joined = ndimage.binary_closing(np.pad(occupied, reach), _disc(reach))
            joined = joined[reach:-reach, reach:-reach]
            area = shapely.simplify(self._area(joined), _SMOOTH * self.cell)
            area = shapely.difference(shapely.buffer(area, 0.0), self._stand(layer.polygon))
            solids += _solids(area, layer.z, _SEEN)
        return World(tuple(solids), self.bounds, doors=self.doors)

    @cached_property
    def exact(self) -> World:
        """The cells themselves: those that are occupied or unknown are solid, all around too."""
        solids = []
        for layer, occupied in zip(self.vehicle.layers, self.occupied, strict=True):
            solid = np.pad(occupied | ~self.known, 1, constant_values=True)
            found = regions(solid)
            corner = self.corner - self.cell  # of the pad
            low = found.rectangles[:, :2] * self.cell + corner
            high = found.rectangles[:, 2:] * self.cell + corner
            (left, below), (right, above) = low.T, high.T
            corners = [left, below, right, below, right, above, left, above]
            parts = np.stack(corners, axis=1).reshape(-1, 4, 2)
            for k, outline in enumerate(found.outlines):
                shape = shapely.transform(outline, self._to_world(1))
                own = tuple(parts[found.owner == k])
                solids.append(Solid(shape, z=layer.z, name=_UNSEEN, parts=own))
        return World(tuple(solids), self.bounds)

    def _open(self, occupied: Mask) -> Mask:
        """Return the free cells of a layer without what is too narrow to be of use.

        Rays leave long splinters of free space between the unknown. Beside what is occupied
        every cell stays, so that corners and jambs are what they are.
        """
        free = self.known & ~occupied
        reach = math.ceil(0.5 * _SPLINTER / self.cell)
        wide = _dilated(~_dilated(~free, reach), reach)
        return np.asarray(wide | (free & _dilated(occupied, 2 * reach) & _dilated(wide, reach)))

    def leads_to(self, pose: Array) -> bool:
        """Return whether free cells lead to a pose, for the largest disc about each layer's middle.

        If they do not, no motion gets there: a quick answer before planning.
        """
        from scipy import ndimage

        for layer, occupied in zip(self.vehicle.layers, self.occupied, strict=True):
            body = shapely.Polygon(layer.polygon)
            radius = shapely.distance(body.centroid, body.exterior)
            room = ndimage.distance_transform_edt(self.known & ~occupied) * self.cell
            labels, _ = ndimage.label(room >= radius - 2.0 * self.cell)
            middle = shapely.get_coordinates(body.centroid)
            places = np.concatenate([transform(self.pose, middle), transform(pose, middle)])
            columns, rows = ((places - self.corner) // self.cell).astype(int).T
            size = len(self.known)
            if not all(0 <= index < size for index in (*columns, *rows)):
                return False
            here, there = labels[rows, columns]
            if here == 0 or here != there:
                return False
        return True

    def _area(self, cells: Mask) -> shapely.Geometry:
        """Return the area of cells in the world."""
        outlines = [o for o in regions(cells).outlines if o.area >= _LEAST]
        area = shapely.union_all(outlines) if outlines else shapely.Polygon()
        return shapely.transform(area, self._to_world(0))

    def _to_world(self, pad: int) -> Callable[[Array], Array]:
        """Return what turns corners counted in cells, of a padded array, into places [m]."""
        return lambda rows: np.asarray((rows - pad) * self.cell + self.corner)

    def _stand(self, polygon: Array) -> shapely.Geometry:
        """Return the place the chair stands on and a hair around it."""
        body = shapely.Polygon(transform(self.pose, polygon))
        return shapely.buffer(body, 0.5 * self.cell, join_style="mitre")


def _solids(area: shapely.Geometry, z: tuple[float, float], name: str) -> list[Solid]:
    """Return a solid for each polygon of an area that is more than a crumb."""
    parts = shapely.get_parts(area)
    return [
        Solid(part, z=z, name=name)
        for part in parts
        if isinstance(part, shapely.Polygon) and part.is_valid and part.area > 1e-6
    ]


def _dilated(cells: Mask, reach: int) -> Mask:
    """Return the cells within a distance of some cells, in cells."""
    from scipy import ndimage

    if not cells.any():
        return cells
    return np.asarray(ndimage.distance_transform_edt(~cells) <= reach)


def _disc(reach: int) -> Mask:
    """Return a disc of cells, shape (2 reach + 1, 2 reach + 1)."""
    steps = np.arange(-reach, reach + 1)
    return np.asarray(np.hypot(*np.meshgrid(steps, steps)) <= reach + 0.5)


def _within(chart: ObstacleMap, corner: Array, bounds: tuple[float, ...]) -> Mask:
    """Return the cells inside the bounds or a body's breadth beside them, shape (n, n)."""
    middles = (np.arange(chart.options.count) + 0.5) * chart.options.cell
    x, y = corner[0] + middles, corner[1] + middles
    inside_x = (x > bounds[0] - _SHELL) & (x < bounds[2] + _SHELL)
    inside_y = (y > bounds[1] - _SHELL) & (y < bounds[3] + _SHELL)
    return np.asarray(inside_y[:, None] & inside_x)


def _under(chart: ObstacleMap, vehicle: Vehicle, corner: Array) -> Mask:
    """Return the cells the chair stands on, in part is enough, shape (n, n)."""
    body = shapely.Polygon(transform(chart.pose, vehicle.outline))
    cell, count = chart.options.cell, chart.options.count
    middles = (np.arange(count) + 0.5) * cell
    x, y = np.meshgrid(corner[0] + middles, corner[1] + middles)
    near = np.hypot(x - chart.pose[0], y - chart.pose[1]) <= vehicle.radius + cell
    under = np.zeros((count, count), dtype=bool)
    under[near] = shapely.dwithin(shapely.points(x[near], y[near]), body, 0.75 * cell)
    return under
