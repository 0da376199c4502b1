"""The course of the driving-assistant study: 11 x 6 m, two doors of 0.80 m, narrow turns.

[DrivingAssistant, Section V] describes it in words; its map is lost. Walls, doors and furniture
are ours, drawn so that the way there and back is as long as the paper's subjects drove.
`examples/scenes/course.yaml` and `course-back.yaml` hold the same world as files.
"""

from __future__ import annotations

import math
from functools import cache

import numpy as np

from ..scene import Goal, Scene, load_vehicle
from ..simulation.driver_route import Route
from ..world import Door, MovingSolid, Solid, World

BOUNDS = (0.0, 0.0, 11.0, 6.0)
"""x_min, y_min, x_max, y_max of the course [m]: the paper's 11 x 6 m."""

DOOR_WIDTH = 0.80
"""Clear width of the doors [m], as on the REHACARE stand [DrivingAssistant, Section VI]."""

_LOW = (0.0, 0.75)
_WALLS: dict[str, tuple[float, float, float, float]] = {
    "lower wall": (0.0, 0.0, 11.0, 0.1),
    "upper wall": (0.0, 5.9, 11.0, 6.0),
    "left wall": (0.0, 0.1, 0.1, 5.9),
    "right wall": (10.9, 0.1, 11.0, 5.9),
    "wall below the first door": (3.1, 0.1, 3.2, 4.1),
    "wall above the first door": (3.1, 4.9, 3.2, 5.9),
    "partition": (5.5, 1.5, 5.6, 5.9),
    "wall below the second door": (8.3, 0.1, 8.4, 1.9),
    "wall above the second door": (8.3, 2.7, 8.4, 5.9),
}
_FURNITURE: dict[str, tuple[float, float, float, float]] = {
    "cupboard": (2.1, 1.5, 2.7, 2.7),
    "bench": (5.6, 3.8, 6.2, 5.2),
    "sofa": (6.9, 4.9, 8.3, 5.9),
}
_TABLE = (10.3, 0.9, 0.40)  # x, y, radius

THERE = (
    (1.1, 1.7),
    (1.1, 4.5),
    (4.55, 4.5),
    (4.55, 0.8),
    (5.8, 0.8),
    (6.55, 2.3),
    (9.8, 2.3),
    (9.8, 4.4),
)
"""The way there as a person would tell it, [m]."""

BACK = (
    (9.8, 4.4),
    (10.0, 3.6),
    (10.0, 2.3),
    (6.55, 2.3),
    (5.8, 0.8),
    (4.6, 0.8),
    (4.8, 4.5),
    (1.1, 4.5),
    (1.1, 1.7),
)
"""The way back: before the doors they keep further away, to turn in with room to spare."""

_ROUNDING_THERE = (0.75, 0.4, 0.7, 0.7, 0.7, 0.4)  # m, at the corners: narrow behind a door
_ROUNDING_BACK = (1.0, 0.4, 0.7, 0.7, 0.7, 0.4, 0.75)


def course_scene(*, people: tuple[MovingSolid, ...] = ()) -> Scene:
    """Return the course with the Xeno at its start, the far end its goal.

    Args:
        people: Who walks about in it.
    """
    solids = [Solid.polygon(_corners(box), name=name) for name, box in _WALLS.items()]
    solids += [Solid.polygon(_corners(box), z=_LOW, name=name) for name, box in _FURNITURE.items()]
    solids.insert(-1, Solid.circle(*_TABLE, z=_LOW, name="table"))
    doors = (Door((3.15, 4.5), DOOR_WIDTH, 0.0), Door((8.35, 2.3), DOOR_WIDTH, 0.0))
    world = World(tuple(solids), BOUNDS, people, doors)
    goal = Goal(np.array([9.8, 4.4, 0.5 * math.pi]), 0.35, math.pi)
    start = np.array([1.1, 1.7, 0.5 * math.pi])
    return Scene(load_vehicle("xeno"), world, start, goal, name="driving-assistant course, there")


@cache
def course_routes() -> tuple[Route, Route]:
    """Return the way there and the way back, as the drivers know them."""
    return Route(THERE, _ROUNDING_THERE), Route(BACK, _ROUNDING_BACK)


def _corners(box: tuple[float, float, float, float]) -> list[list[float]]:
    x_min, y_min, x_max, y_max = box
    return [[x_min, y_min], [x_max, y_min], [x_max, y_max], [x_min, y_max]]
