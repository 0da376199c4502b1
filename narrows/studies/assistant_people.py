"""Somebody steps before a chair whose driver keeps pushing: does it stop in time?"""

from __future__ import annotations

import math
from collections.abc import Mapping

import numpy as np
from numpy.typing import ArrayLike

from ..errors import StudyError
from ..scene import Goal, Scene, load_vehicle
from ..se2 import Array
from ..simulation.judge import judge
from ..world import MovingSolid, Solid, World
from .assistant_drives import Conditions, drive_with, regions_of
from .case import Case, Scalar

WALKS = ("steps in and stays", "crosses", "comes towards")
"""What somebody does: stops in the chair's way, walks on across it, or walks at the chair and
stops half a metre before where it was."""

GAPS = (0.6, 1.0, 1.5, 2.5)
"""Distance from the chair's front at which they enter the way of a chair at full speed [m]."""

_RADIUS = 0.25  # m
_FULL, _REACHED = 0.8, 2.0  # m/s, s: the chair's speed, and when it has it
_TIME = 14.0  # s


class Pusher:
    """A driver who pushes the stick forward and does not look."""

    finished = False
    progress = 0.0

    def step(self, time: float, pose: ArrayLike, motion: ArrayLike) -> Array:
        """See `Driver`."""
        return np.array([1.0, 0.0])


def people_scene(walk: str, gap: float, rng: np.random.Generator) -> Scene:
    """Return a hall with a chair and somebody who gets in its way.

    Args:
        walk: One of `WALKS`.
        gap: Distance from the front of a chair at full speed as they get there [m].
        rng: Source of their speed (0.5 to 1.4 m/s), side and where they stop.

    Raises:
        StudyError: If nobody walks like that.
    """
    chair = load_vehicle("xeno")
    arrival = 4.0  # s
    front = -3.0 + _FULL * (arrival - 0.5 * _REACHED) + chair.front_overhang
    x, speed = front + gap + _RADIUS, rng.uniform(0.5, 1.4)
    side = 1.0 if rng.random() < 0.5 else -1.0
    enters = side * (0.5 * chair.width + _RADIUS)  # there they begin to be in the way
    begins = 1.8 * side
    start = arrival - abs(begins - enters) / speed
    stop = rng.uniform(-0.2, 0.2)
    across = [[0.0, x, begins], [start, x, begins]]
    if walk == "steps in and stays":
        rows = [*across, [start + abs(begins - stop) / speed, x, stop]]
    elif walk == "crosses":
        rows = [*across, [start + 2.0 * abs(begins) / speed, x, -begins]]
    elif walk == "comes towards":
        far, near = x + 1.5, x + 0.25
        rows = [[0.0, far, stop], [arrival, far, stop], [arrival + 1.25 / speed, near, stop]]
    else:
        raise StudyError("nobody walks like that", value=walk, allowed=", ".join(WALKS))
    somebody = MovingSolid(_RADIUS, np.array(rows), (0.0, 1.8), "somebody")
    walls = tuple(
        Solid.polygon([[-4, y], [9, y], [9, y + 0.1], [-4, y + 0.1]], name="wall")
        for y in (-2.2, 2.1)
    )
    goal = Goal(np.array([8.0, 0.0, 0.0]), 0.5, math.pi)
    return Scene(chair, World(walls, moving=(somebody,)), np.array([-3.0, 0.0, 0.0]), goal)


def people_case(case: Case, rng: np.random.Generator, regions: str) -> Mapping[str, Scalar]:
    """Return what came of one meeting.

    Args:
        case: `walk`, `gap_m`.
        rng: Source of everything random.
        regions: File of the safety regions.
    """
    scene = people_scene(str(case["walk"]), float(case["gap_m"] or 0.0), rng)
    record = drive_with(
        scene, Pusher(), Conditions(time_limit=_TIME), regions_of(regions), rng.spawn(2)
    )
    verdict = judge(scene, record)
    speed = 0.0
    if verdict.collisions:
        row = int(np.searchsorted(record.times, verdict.collisions[0].start))
        speed = float(np.abs(record.wheel_speeds[row]).max())
    return {
        "collisions": len(verdict.collisions),
        "walked_into": len(verdict.walked_into),
        "impact_speed": speed,
        "min_clearance_mm": 1e3 * verdict.min_clearance,
        "distance_m": record.length,
    }
