"""The scenes of DoorBench: a chair in a corridor, a door, a room, obstacles."""

from __future__ import annotations

import json
import math
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from ..errors import StudyError
from ..scene import Goal, Scene
from ..vehicle import Limits, Vehicle
from ..world import Door, Solid, World

GOAL_TOLERANCE = (0.05, math.radians(3.0))
"""How far from the goal a motion may end [m, rad]."""


@dataclass(frozen=True, eq=False)
class DoorBenchScene:
    """One scene of the benchmark.

    Attributes:
        name: Its identifier, such as `c05_07`.
        level: Its level, such as `c05`: the door is 5 cm wider than the chair.
        scene: The scene.
    """

    name: str
    level: str
    scene: Scene


def read_doorbench(file: Path, *, reversing: bool = False) -> tuple[DoorBenchScene, ...]:
    """Return the scenes of a DoorBench file, metres and radians throughout.

    Args:
        file: JSON with a list `scenes`.
        reversing: Whether the chair may drive in reverse.

    Raises:
        StudyError: If the file cannot be read, or a scene lacks something.
    """
    try:
        rows = json.loads(Path(file).read_text(encoding="utf-8"))["scenes"]
    except (OSError, ValueError, KeyError, TypeError) as error:
        raise StudyError(
            f"not a DoorBench file: {error!r}", file=str(file), allowed="JSON with a list `scenes`"
        ) from error
    return tuple(_checked(row, str(file), reversing) for row in rows)


def _checked(row: Mapping[str, Any], file: str, reversing: bool) -> DoorBenchScene:
    try:
        scene = doorbench_scene(row, reversing=reversing)
        return DoorBenchScene(str(row["id"]), str(row.get("level", "")), scene)
    except (KeyError, TypeError, IndexError) as error:
        raise StudyError(f"a DoorBench scene is incomplete: {error!r}", file=file) from error


def doorbench_scene(row: Mapping[str, Any], *, reversing: bool = False) -> Scene:
    """Return one scene of DoorBench.

    Args:
        row: `vehicle` (length, width, rear_overhang, max_curvature), `walls` (convex polygons),
            `obstacles` (circles [x, y, r]), `bounds`, `start`, `goal`, optionally `door`
            (x, width and y, the two faces of the wall it is in), `id`.
        reversing: Whether the chair may drive in reverse.
    """
    chair = row["vehicle"]
    reverse = Limits().reverse_speed if reversing else 0.0
    vehicle = Vehicle.rectangle(
        chair["length"],
        chair["width"],
        chair["rear_overhang"],
        limits=Limits(curvature=chair["max_curvature"], reverse_speed=reverse),
    )
    walls = [Solid.polygon(c, name=f"wall {k}") for k, c in enumerate(row["walls"], start=1)]
    rounds = [
        Solid.circle(x, y, r, name=f"obstacle {k}")
        for k, (x, y, r) in enumerate(row["obstacles"], start=1)
    ]
    doors: tuple[Door, ...] = ()
    if "door" in row:
        door = row["door"]
        center = (float(door["x"]), 0.5 * float(sum(door["y"])))
        doors = (Door(center, float(door["width"]), 0.5 * math.pi),)
    x_min, y_min, x_max, y_max = (float(v) for v in row["bounds"])
    return Scene(
        vehicle=vehicle,
        world=World((*walls, *rounds), bounds=(x_min, y_min, x_max, y_max), doors=doors),
        start=np.array(row["start"], dtype=float),
        goal=Goal(np.array(row["goal"], dtype=float), *GOAL_TOLERANCE),
        name=str(row.get("id", "")),
    )
