"""Whole worlds from a few numbers: a door off a corridor, a corridor that turns."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
import shapely
from numpy.typing import ArrayLike

from .errors import ShapeError
from .se2 import Array, rotate
from .vehicle import Vehicle
from .world import Door, Solid, World

_END_GAP = 0.3  # m: chair to the end wall behind it at a default start, ahead of it at a goal


def _check_positive(**sizes: float) -> None:
    for name, size in sizes.items():
        if not 0.0 < size < math.inf:
            raise ShapeError(f"{name} must be a positive length [m], got {size}")


@dataclass(frozen=True)
class Doorway:
    """A corridor along x, a door in its left wall, a room behind the door.

    The corridor spans y from 0 to its width, the wall the thickness behind it, then the room. The
    room reaches 0.35 of its width to the left of the door's middle (smaller x), the rest to the
    right. The corridor runs at least from x = -2 to 5 and from 3.6 m before the door to 3.4 m
    behind it; at its ends the bounds close it.

    Attributes:
        corridor_width: Between the corridor's walls [m].
        door_width: Clear width of the door [m].
        door_position: x of the door's middle [m].
        wall_thickness: Thickness of all walls [m].
        room: Width along x and depth along y of the room [m].
    """

    corridor_width: float
    door_width: float
    door_position: float = 1.6
    wall_thickness: float = 0.1
    room: tuple[float, float] = (4.0, 3.0)

    def __post_init__(self) -> None:
        """Check that the sizes are positive and the door fits into the room's wall."""
        _check_positive(
            corridor_width=self.corridor_width,
            door_width=self.door_width,
            wall_thickness=self.wall_thickness,
            room_width=self.room[0],
            room_depth=self.room[1],
        )
        if self.door_width > self.room[0]:
            raise ShapeError(
                f"the door ({self.door_width} m) must not be wider than the room ({self.room[0]} m)"
            )

    @property
    def _room_sides(self) -> tuple[float, float]:
        left = self.door_position - max(0.35 * self.room[0], 0.5 * self.door_width)
        return left, left + self.room[0]

    def world(self) -> World:
        """Return the walls, the bounds and the door."""
        thick, near = self.wall_thickness, self.corridor_width
        far, back = near + thick, near + thick + self.room[1]
        left, right = self._room_sides
        x_min = min(-2.0, self.door_position - 3.6, left - thick)
        x_max = max(5.0, self.door_position + 3.4, right + thick)
        jambs = [self.door_position + side * 0.5 * self.door_width for side in (-1.0, 1.0)]
        boxes = {
            "corridor wall": (x_min, -thick, x_max, 0.0),
            "wall left of the door": (x_min, near, jambs[0], far),
            "wall right of the door": (jambs[1], near, x_max, far),
            "left wall of the room": (left - thick, far, left, back),
            "right wall of the room": (right, far, right + thick, back),
            "back wall of the room": (left - thick, back, right + thick, back + thick),
        }
        return World(
            solids=tuple(Solid.polygon(_box(*box), name=name) for name, box in boxes.items()),
            bounds=(x_min, -thick, x_max, back + thick),
            doors=(Door((self.door_position, near + 0.5 * thick), self.door_width, math.pi / 2),),
        )

    def start(self, vehicle: Vehicle) -> Array:
        """Return the default start, shape (3,): mid-corridor, 2.2 m before the door, along x."""
        return np.array([self.door_position - 2.2, 0.5 * self.corridor_width, 0.0])

    def goal(self, vehicle: Vehicle) -> Array:
        """Return the default goal, shape (3,): behind the door, heading on.

        The axle stands at 0.6 of the room's depth, or as much nearer as leaves 0.3 m ahead.
        """
        depth = min(0.6 * self.room[1], self.room[1] - vehicle.front_overhang - _END_GAP)
        y = self.corridor_width + self.wall_thickness + depth
        return np.array([self.door_position, y, math.pi / 2])


@dataclass(frozen=True)
class Corridor:
    """A corridor along x that turns, closed at both ends.

    Before the turn it spans y from 0 to its width; the inner corner is at x = 0.

    Attributes:
        width: Before the turn [m].
        turn: Angle [rad], left positive; its size from 5 to 150 degrees.
        width_after: After the turn [m]; None = as before.
        length: Of each leg, outside the corner [m].
        wall_thickness: Thickness of all walls [m].
    """

    width: float
    turn: float = math.pi / 2
    width_after: float | None = None
    length: float = 3.0
    wall_thickness: float = 0.1

    def __post_init__(self) -> None:
        """Check the sizes and the angle."""
        _check_positive(
            width=self.width,
            width_after=self._after,
            length=self.length,
            wall_thickness=self.wall_thickness,
        )
        if not math.radians(5.0) <= abs(self.turn) + 1e-12 <= math.radians(150.0) + 2e-12:
            raise ShapeError(
                f"a corridor turns by 5 to 150 degrees, got {math.degrees(self.turn):g}"
            )
        if self.wall_thickness * math.tan(0.5 * abs(self.turn)) >= self.length:
            raise ShapeError(
                f"walls {self.wall_thickness:g} m thick do not fit round the inner corner of legs "
                f"of {self.length:g} m"
            )

    @property
    def _after(self) -> float:
        return self.width if self.width_after is None else self.width_after

    def _place(self, points: ArrayLike) -> Array:
        """Return points of the left turn where they are: mirrored for a right turn."""
        placed = np.array(points, dtype=float)
        if self.turn < 0.0:
            placed[..., 1] = self.width - placed[..., 1]
        return placed

    def _corner(self, before: float, after: float) -> Array:
        """Return where two lines along the legs cross, for a left turn.

        Args:
            before: y of the line along the first leg [m].
            after: Distance of the line along the second leg from that leg's inner wall, positive
                into the corridor [m].
        """
        angle = abs(self.turn)
        along = (before - self.width + after * math.cos(angle)) / math.sin(angle)
        inner = np.array([0.0, self.width])
        return np.asarray(inner + rotate(angle, [along, -after]))

    @property
    def _ends(self) -> tuple[float, float]:
        """X of the first leg's end; distance of the second's along it from the inner corner."""
        outer = self._corner(0.0, self._after) - [0.0, self.width]
        along = float(outer @ rotate(abs(self.turn), [1.0, 0.0]))
        return min(0.0, float(outer[0])) - self.length, max(0.0, along) + self.length

    def _leg_point(self, along: float, across: float) -> Array:
        """Return a point of the second leg: along it, and to the right of its inner wall."""
        inner = np.array([0.0, self.width])
        return np.asarray(inner + rotate(abs(self.turn), [along, -across]))

    def world(self) -> World:
        """Return the walls and the bounds."""
        thick, wide, after = self.wall_thickness, self.width, self._after
        begin, end = self._ends
        outer, inner = np.array([begin, 0.0]), np.array([begin, wide])  # where the walls begin
        across = np.array([0.0, thick])
        strips = {
            "outer wall": [
                outer,
                self._corner(0.0, after),
                self._leg_point(end, after),
                self._leg_point(end, after + thick),
                self._corner(-thick, after + thick),
                outer - across,
            ],
            "inner wall": [
                inner,
                self._corner(wide, 0.0),
                self._leg_point(end, 0.0),
                self._leg_point(end, -thick),
                self._corner(wide + thick, -thick),
                inner + across,
            ],
            "wall behind": list(_box(begin - thick, -thick, begin, wide + thick)),
            "wall at the end": [
                self._leg_point(end, -thick),
                self._leg_point(end + thick, -thick),
                self._leg_point(end + thick, after + thick),
                self._leg_point(end, after + thick),
            ],
        }
        solids = tuple(
            Solid.polygon(self._place(corners), name=name) for name, corners in strips.items()
        )
        x_min, y_min, x_max, y_max = shapely.total_bounds([solid.shape for solid in solids])
        return World(solids=solids, bounds=(float(x_min), float(y_min), float(x_max), float(y_max)))

    def start(self, vehicle: Vehicle) -> Array:
        """Return the default start, shape (3,): mid-corridor, 0.3 m from the wall behind."""
        x = self._ends[0] + _END_GAP + vehicle.rear_overhang
        return np.array([x, 0.5 * self.width, 0.0])

    def goal(self, vehicle: Vehicle) -> Array:
        """Return the default goal, shape (3,): mid-corridor, 0.3 m from the wall at the end."""
        along = self._ends[1] - _END_GAP - vehicle.front_overhang
        position = self._place(self._leg_point(along, 0.5 * self._after))
        return np.array([position[0], position[1], self.turn])


def _box(x_min: float, y_min: float, x_max: float, y_max: float) -> Array:
    return np.array([[x_min, y_min], [x_max, y_min], [x_max, y_max], [x_min, y_max]])
