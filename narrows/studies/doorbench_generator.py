"""Scenes of DoorBench's family, drawn from a seed."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
import shapely

from ..errors import StudyError
from ..se2 import transform

LEVELS: Mapping[str, tuple[float, float]] = {
    "c30": (0.67, 0.97),
    "c23": (0.67, 0.90),
    "c15": (0.75, 0.90),
    "c10": (0.75, 0.85),
    "c05": (0.75, 0.80),
}
"""Width of the chair and of the door by level [m]."""

_LENGTH, _REAR, _CURVATURE = 1.00, 0.25, 2.5  # m, m, 1/m
_CORRIDOR, _WALL = 1.6, 0.1  # m
_CORRIDOR_X, _ROOM_X, _ROOM_DEPTH = (-2.0, 5.0), (0.2, 4.2), 3.0  # m
_DOOR_X = 1.6  # m
_BODY_AWAY, _DOOR_AWAY, _APART = 0.15, 0.75, 0.10  # m an obstacle stays off ends, door, others
_TRIES = 1000


def doorbench_rows(per_level: int, seed: int) -> list[dict[str, Any]]:
    """Return scenes as DoorBench's file has them, levels in order, reproducible.

    A chair stands in a corridor of 1.6 m, a door in its wall, a room of 4 x 3 m behind; 0 to 3
    round obstacles stand in corridor and room, clear of the start, the goal and the doorway. No
    planner is asked: some scenes may have no way, or none without reversing.

    Args:
        per_level: Scenes of each level, >= 1.
        seed: Seed, >= 0.

    Raises:
        StudyError: If a number is out of range.
    """
    if per_level < 1:
        raise StudyError("no scenes", field="per_level", value=per_level, allowed=">= 1")
    if seed < 0:
        raise StudyError("the seed is negative", field="seed", value=seed, allowed=">= 0")
    rng = np.random.default_rng(seed)
    return [
        _scene(f"{level}_{number:02d}", level, number % 4, rng)
        for level in LEVELS
        for number in range(per_level)
    ]


def _scene(name: str, level: str, count: int, rng: np.random.Generator) -> dict[str, Any]:
    """Return one scene with a number of obstacles."""
    width, door = LEVELS[level]
    y_door = (_CORRIDOR, _CORRIDOR + _WALL)
    y_end = y_door[1] + _ROOM_DEPTH
    start = [rng.uniform(-0.5, 0.1), rng.uniform(0.72, 0.89), rng.uniform(-0.1, 0.1)]
    goal = [rng.uniform(1.9, 2.95), 3.5, rng.uniform(0.5, 2.6)]
    rear, front, half = -_REAR, _LENGTH - _REAR, 0.5 * width
    body = np.array([[rear, -half], [front, -half], [front, half], [rear, half]])
    taken = [shapely.Polygon(transform(np.array(pose), body)) for pose in (start, goal)]
    left, right = _DOOR_X - door / 2, _DOOR_X + door / 2
    return {
        "id": name,
        "level": level,
        "clearance": round(door - width, 6),
        "n_obstacles": count,
        "door": {"width": door, "x": _DOOR_X, "y": list(y_door)},
        "bounds": [_CORRIDOR_X[0], -_WALL, _CORRIDOR_X[1], y_end + _WALL],
        "walls": [
            _box(_CORRIDOR_X[0], -_WALL, _CORRIDOR_X[1], 0.0),
            _box(_CORRIDOR_X[0], y_door[0], left, y_door[1]),
            _box(right, y_door[0], _CORRIDOR_X[1], y_door[1]),
            _box(_ROOM_X[0] - _WALL, y_door[1], _ROOM_X[0], y_end),
            _box(_ROOM_X[1], y_door[1], _ROOM_X[1] + _WALL, y_end),
            _box(_ROOM_X[0] - _WALL, y_end, _ROOM_X[1] + _WALL, y_end + _WALL),
        ],
        "obstacles": _obstacles(count, taken, y_door[1], y_end, rng),
        "vehicle": {
            "length": _LENGTH,
            "width": width,
            "rear_overhang": _REAR,
            "max_curvature": _CURVATURE,
        },
        "start": [round(float(v), 6) for v in start],
        "goal": [round(float(v), 6) for v in goal],
    }


def _box(x_min: float, y_min: float, x_max: float, y_max: float) -> list[list[float]]:
    return [[x_min, y_min], [x_max, y_min], [x_max, y_max], [x_min, y_max]]


def _obstacles(
    count: int,
    ends: list[shapely.Polygon],
    y_room: float,
    y_end: float,
    rng: np.random.Generator,
) -> list[list[float]]:
    """Return circles [x, y, r] that stand clear of the ends, the doorway and each other.

    Raises:
        StudyError: If there is no room for so many.
    """
    found: list[list[float]] = []
    door = shapely.Point(_DOOR_X, 0.5 * (_CORRIDOR + y_room))
    for _ in range(_TRIES):
        if len(found) == count:
            return found
        in_room = rng.uniform() < 0.7
        low, high = ((_ROOM_X[0], y_room), (_ROOM_X[1], y_end)) if in_room else ((2.2, 0), (4, 1.6))
        x, y = rng.uniform(low, high)
        radius = rng.uniform(0.08, 0.20)
        if _is_free(shapely.Point(x, y), radius, ends, door, found):
            found.append([round(float(x), 4), round(float(y), 4), round(float(radius), 4)])
    raise StudyError("no room for the obstacles", field="n_obstacles", value=count)


def _is_free(
    place: shapely.Point,
    radius: float,
    ends: list[shapely.Polygon],
    door: shapely.Point,
    others: list[list[float]],
) -> bool:
    if any(place.distance(end) < radius + _BODY_AWAY for end in ends):
        return False
    if place.distance(door) < radius + _DOOR_AWAY:
        return False
    return all(
        place.distance(shapely.Point(x, y)) >= radius + other + _APART for x, y, other in others
    )
