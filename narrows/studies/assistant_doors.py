"""Through a door of 0.80 m with a chair of 0.66 m: alone, assisted, and helped along a path."""

from __future__ import annotations

import math
from collections.abc import Mapping

import numpy as np

from ..errors import StudyError
from ..scene import Goal, Scene, load_vehicle
from ..simulation.driver_route import Route
from ..simulation.judge import judge
from ..world import Door, Solid, World
from .assistant_course import DOOR_WIDTH
from .assistant_drives import Conditions, drive, regions_of
from .case import Case, Scalar

HELP = {
    "alone": Conditions(assisted=False, time_limit=60.0),
    "assisted": Conditions(time_limit=60.0),
    "helped": Conditions(through_doors=True, time_limit=60.0),
}
"""How a door is driven through, by name; `helped` blends towards a certified path."""

OFFSETS = (-0.8, -0.4, 0.0, 0.4, 0.8)
"""Where the chair starts beside the door's middle, 2.1 m before its wall [m]."""

ANGLES_DEG = (-40.0, -20.0, 0.0, 20.0, 40.0)
"""Its heading there, from straight on [deg]."""

DOOR_DRIVERS = ("steady", "hasty", "shaky")
"""Who drives."""

_BEFORE, _BEHIND, _SIDE = 3.1, 2.2, 2.2  # m of room before, behind and beside the door


def door_scene(offset: float, angle: float) -> Scene:
    """Return a door in the middle of a wall, the chair before it.

    Args:
        offset: Of the chair to the left of the door's middle [m].
        angle: Its heading from straight on, to the left [rad].
    """
    half = 0.5 * DOOR_WIDTH
    walls = [
        Solid.polygon(_box(0.0, low, 0.1, high), name=name)
        for name, low, high in (
            ("wall left of the door", half, _SIDE),
            ("wall right of the door", -_SIDE, -half),
        )
    ]
    walls += [
        Solid.polygon(_box(-_BEFORE, side * _SIDE, _BEHIND, side * _SIDE + side * 0.1), name="side")
        for side in (-1.0, 1.0)
    ]
    world = World(tuple(walls), doors=(Door((0.05, 0.0), DOOR_WIDTH, 0.0),))
    goal = Goal(np.array([1.5, 0.0, 0.0]), 0.4, math.pi)
    return Scene(load_vehicle("xeno"), world, np.array([-2.1, offset, angle]), goal)


def door_case(case: Case, rng: np.random.Generator, regions: str) -> Mapping[str, Scalar]:
    """Return the figures of one drive through the door.

    Args:
        case: `driver`, `help`, `offset_m`, `angle_deg`.
        rng: Source of everything random.
        regions: File of the safety regions.

    Raises:
        StudyError: If there is no such help.
    """
    conditions = HELP.get(str(case["help"]))
    if conditions is None:
        raise StudyError("no such help", value=case["help"], allowed=", ".join(HELP))
    offset, angle = float(case["offset_m"] or 0.0), math.radians(float(case["angle_deg"] or 0.0))
    scene = door_scene(offset, angle)
    route = Route(np.array([scene.start[:2], [-1.0, 0.0], [1.5, 0.0]]), 0.5)
    record, driver = drive(
        scene, str(case["driver"]), (route,), conditions, regions_of(regions), rng
    )
    verdict = judge(scene, record)
    weight = record.signals.get("door_weight")
    return {
        "arrived": driver.finished,
        "collisions": len(verdict.collisions),
        "succeeded": driver.finished and not verdict.collisions,
        "time_s": record.duration,
        "distance_m": record.length,
        "min_clearance_mm": 1e3 * verdict.min_clearance,
        "share_helped": None if weight is None else float(np.mean(weight > 0.0)),
    }


def _box(x: float, y: float, x_end: float, y_end: float) -> list[list[float]]:
    low, high = min(y, y_end), max(y, y_end)
    return [[x, low], [x_end, low], [x_end, high], [x, high]]
