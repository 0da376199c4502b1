"""A wheelchair with its occupant, drawn within the body that plans are made for.

The parts say which way the chair looks and where its wheels are; they are no claim about any make.
Every part is cut to what the body's layers leave at its height.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import shapely

from narrows.se2 import Array
from narrows.vehicle import Vehicle

from .solids_mesh import Mesh, ball_mesh, box_mesh, joined, wheel_mesh

Colour = tuple[int, int, int]

FRAME: Colour = (52, 58, 64)
SEAT: Colour = (0, 96, 160)
WHEEL: Colour = (24, 24, 26)
CLOTHES: Colour = (120, 134, 150)
TROUSERS: Colour = (74, 84, 104)
SKIN: Colour = (214, 164, 128)

_LEAST = 0.01  # m: thinner parts are left out


@dataclass(frozen=True, eq=False)
class Part:
    """A part of one colour.

    Attributes:
        name: What it is.
        mesh: Where it is, in the body frame, z above the floor, [m].
        colour: Red, green, blue, 0 to 255.
    """

    name: str
    mesh: Mesh
    colour: Colour


def chair_parts(vehicle: Vehicle) -> tuple[Part, ...]:
    """Return the parts of a chair with its occupant, inside its body."""
    shape = _Shape(vehicle)
    found: dict[str, tuple[Colour, list[Mesh]]] = {}
    for name, colour, meshes in (*shape.chair(), *shape.person()):
        found.setdefault(name, (colour, []))[1].extend(meshes)
    parts = [Part(name, joined(meshes), colour) for name, (colour, meshes) in found.items()]
    return tuple(part for part in parts if len(part.mesh.faces))


class _Shape:
    """Boxes by shares of the body's length (from the back), half width and height."""

    def __init__(self, vehicle: Vehicle) -> None:
        """Measure the body."""
        self.vehicle = vehicle
        self.back = float(vehicle.outline[:, 0].min())
        self.length = vehicle.length
        self.middle = float(vehicle.outline[:, 1].max() + vehicle.outline[:, 1].min()) / 2.0
        self.half = 0.5 * vehicle.width
        self.seat = 0.38 * vehicle.height  # m, its top

    def chair(self) -> list[tuple[str, Colour, list[Mesh]]]:
        """Return frame, seat and wheels."""
        seat, top = self.seat, min(0.76 * self.vehicle.height, self.seat + 0.5)
        rest = seat + 0.18
        frame = [
            *self.box((0.12, 0.66), (-0.62, 0.62), (0.35 * seat, 0.8 * seat)),
            *self.box((0.02, 0.16), (-0.66, -0.58), (top - 0.06, top - 0.02)),  # push handles
            *self.box((0.02, 0.16), (0.58, 0.66), (top - 0.06, top - 0.02)),
            *self.box((0.80, 0.985), (-0.50, 0.50), (0.07, 0.10)),  # foot plate
            *self.box((0.68, 0.82), (-0.46, -0.40), (0.10, 0.8 * seat)),
            *self.box((0.68, 0.82), (0.40, 0.46), (0.10, 0.8 * seat)),
        ]
        for side in (-1.0, 1.0):
            y = (0.72 * side - 0.07, 0.72 * side + 0.07)
            frame += self.box((0.20, 0.56), y, (rest, rest + 0.05))
            frame += self.box((0.46, 0.52), y, (seat, rest))
        cushions = [
            *self.box((0.16, 0.66), (-0.66, 0.66), (seat - 0.08, seat)),
            *self.box((0.10, 0.17), (-0.62, 0.62), (seat, top)),
        ]
        return [("frame", FRAME, frame), ("seat", SEAT, cushions), ("wheels", WHEEL, self.wheels())]

    def person(self) -> list[tuple[str, Colour, list[Mesh]]]:
        """Return somebody who sits in the chair and reaches to its top."""
        seat, top = self.seat, self.vehicle.height
        head = min(0.11, 0.09 * top)
        shoulder = top - 2.3 * head
        trunk = [
            *self.box((0.18, 0.36), (-0.46, 0.46), (seat, shoulder)),
            *self.box((0.22, 0.32), (-0.62, -0.46), (seat + 0.22, shoulder - 0.03)),
            *self.box((0.22, 0.32), (0.46, 0.62), (seat + 0.22, shoulder - 0.03)),
        ]
        legs, hands = [], []
        for side in (-1.0, 1.0):
            y = (0.26 * side - 0.16, 0.26 * side + 0.16)
            legs += self.box((0.30, 0.76), y, (seat, seat + 0.13))
            legs += self.box((0.70, 0.80), y, (0.14, seat))
            legs += self.box((0.72, 0.96), y, (0.10, 0.17))
            hand = (0.70 * side - 0.09, 0.70 * side + 0.09)
            hands += self.box((0.30, 0.54), hand, (seat + 0.23, seat + 0.29))
        place = np.array([self.back + 0.28 * self.length, self.middle, top - head])
        if self._holds(place[:2], head, (top - 2.0 * head, top)):
            hands.append(ball_mesh(place, head))
        return [
            ("trunk", CLOTHES, trunk),
            ("legs", TROUSERS, legs),
            ("skin", SKIN, hands),
        ]

    def wheels(self) -> list[Mesh]:
        """Return drive wheels on the axle and casters ahead or behind."""
        outside = min(self.vehicle.rear_overhang, self.vehicle.front_overhang)
        radius = max(min(self.vehicle.wheel_radius, outside), 0.05)  # an axle at the very back
        thick = min(0.06, 0.2 * self.half)
        caster = min(0.5 * radius + 0.02, 0.1)
        front = self.back + 0.72 * self.length
        if front < radius + caster:  # drive wheels in front: casters behind
            front = self.back + 0.05 * self.length + caster
        meshes = []
        for side in (-1.0, 1.0):
            y = side * min(0.5 * self.vehicle.track, self.half - 0.5 * thick)
            meshes.append(wheel_mesh([0.0, self.middle + y, radius], radius, thick))
            y = self.middle + side * 0.68 * self.half
            meshes.append(wheel_mesh([front, y, caster], caster, 0.6 * thick))
        return meshes

    def box(
        self, x: tuple[float, float], y: tuple[float, float], z: tuple[float, float]
    ) -> list[Mesh]:
        """Return a box as far as the body holds it: a list of one, or none.

        Args:
            x: From and to, as shares of the length from the back.
            y: From and to, as shares of the half width, left positive.
            z: From and to [m].
        """
        low = np.array([self.back + x[0] * self.length, self.middle + y[0] * self.half])
        high = np.array([self.back + x[1] * self.length, self.middle + y[1] * self.half])
        for layer in self.vehicle.layers:
            if layer.z[0] < z[1] and z[0] < layer.z[1]:
                low, high = _within(layer.polygon, low, high)
        top = min(z[1], self.vehicle.height)
        if (high - low).min() < _LEAST or top - z[0] < _LEAST:
            return []
        return [box_mesh([*low, z[0]], [*high, top])]

    def _holds(self, place: Array, radius: float, z: tuple[float, float]) -> bool:
        """Return whether all layers between two heights hold a circle."""
        disc = shapely.Point(place).buffer(radius)
        return all(
            shapely.Polygon(layer.polygon).covers(disc)
            for layer in self.vehicle.layers
            if layer.z[0] < z[1] and z[0] < layer.z[1]
        )


def _within(polygon: Array, low: Array, high: Array) -> tuple[Array, Array]:
    """Return the largest box (2,), (2,) of these sides that a convex polygon holds, cut along x."""
    x0, x1 = max(low[0], polygon[:, 0].min()), min(high[0], polygon[:, 0].max())
    if x1 - x0 < _LEAST:
        return low, low
    area = shapely.Polygon(polygon)
    y0, y1 = low[1], high[1]
    for x in (x0 + 1e-9, x1 - 1e-9):  # the sides are convex: narrowest at an end
        across = area.intersection(shapely.LineString([[x, -1e3], [x, 1e3]]))
        y0, y1 = max(y0, across.bounds[1]), min(y1, across.bounds[3])
    return np.array([x0, y0]), np.array([x1, y1])
