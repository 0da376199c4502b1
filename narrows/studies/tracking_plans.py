"""The plans of the tracking study: paper arcs, Table I, corridors, a door, reversing."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path as FilePath

import numpy as np
import shapely
from shapely.geometry.base import BaseGeometry

from ..clearance import certify
from ..errors import StudyError
from ..path import Path
from ..planners.doorway import DoorwayPlanner, smooth_path
from ..planners.timing import time_path
from ..scene import Goal, Scene, load_vehicle
from ..se2 import Array, compose
from ..trajectory import Trajectory
from ..vehicle import Vehicle
from ..world import Door, Solid, World
from .door_bezier_cases import HEADINGS_DEG, paper_chair, plan_trajectory
from .doorbench_scenes import read_doorbench

PAPER_SPEED = 0.16 * 2.0 * math.pi * 10.0 / 60.0
"""Speed of [NarrowArcs]: wheels of 0.16 m radius at 10 revolutions a minute [m/s]."""

SPEED = 0.3
"""Cruising speed on the other paths without times [m/s]."""

_TABLE = tuple(name for name in HEADINGS_DEG if name != "B2")  # B2 has a radius of 0.16 m
PAPER_PLANS = ("paper corner", "paper door", *_TABLE)
"""Plans of the papers; driven without solids, where the paper's own chair touches them."""

NARROW_PLANS = ("corner", "S corridor", "door", "shunt")
"""Certified plans between solids, on which the disturbances are tried."""


@dataclass(frozen=True, eq=False)
class TrackedPlan:
    """A motion to follow, in its scene.

    Attributes:
        scene: Chair, solids, goal.
        motion: A path driven at `speed`, or a trajectory.
        speed: Cruising speed [m/s].
        clearance: Proven clearance of the plan [m]; infinite without solids.
    """

    scene: Scene
    motion: Path | Trajectory
    speed: float
    clearance: float

    @property
    def path(self) -> Path:
        """Where the motion goes."""
        return self.motion.path if isinstance(self.motion, Trajectory) else self.motion


@lru_cache(maxsize=64)
def tracked_plan(name: str, doorbench: str = "") -> TrackedPlan:
    """Return a plan by its name, planned once in a process.

    Args:
        name: One of `PAPER_PLANS` or `NARROW_PLANS`, or the name of a scene of DoorBench.
        doorbench: File of DoorBench, for its scenes.

    Raises:
        StudyError: If there is no such plan, or it cannot be planned.
    """
    if name == "paper corner":
        return _paper_corner()
    if name == "paper door":
        return _paper_door()
    if name in _TABLE:
        return _table(name)
    if name == "corner":
        return _corner()
    if name == "S corridor":
        return _s_corridor()
    if name == "door":
        return _door()
    if name == "shunt":
        return _shunt()
    if doorbench:
        return _doorbench(name, doorbench)
    raise StudyError(
        "there is no such plan", value=name, allowed=", ".join((*PAPER_PLANS, *NARROW_PLANS))
    )


def _tracked(
    vehicle: Vehicle, world: World, motion: Path | Trajectory, speed: float, name: str
) -> TrackedPlan:
    path = motion.path if isinstance(motion, Trajectory) else motion
    scene = Scene(vehicle, world, path.start, Goal(path.goal), name=name)
    certificate = certify(world, vehicle, motion)
    if not certificate.is_clear:
        raise StudyError(f"the plan touches something: {certificate.reason}", value=name)
    return TrackedPlan(scene, motion, speed, certificate.clearance)


def _ideal_chair() -> Vehicle:
    """Return the chair as [NarrowArcs] has it: its axle is its back edge, track = width."""
    return Vehicle.rectangle(1.0, 0.67, 0.0, track=0.67)


def _pieces(start: tuple[float, float, float], *pieces: tuple[float, float]) -> Path:
    """Return straight lines (length, 0) and arcs (radius, angle), one after the other.

    Lengths are negative in reverse; an arc's angle is positive to the left, its radius negative
    in reverse, 0 on the spot.
    """
    poses = [np.array(start, dtype=float)]
    for size, angle in pieces:
        steps = max(1, math.ceil(abs(angle) / 0.5))
        part = angle / steps
        if angle == 0.0:
            step = np.array([size, 0.0, 0.0])
        else:
            chord = 2.0 * size * math.sin(abs(part) / 2.0)
            step = np.array([chord * math.cos(part / 2), chord * math.sin(part / 2), part])
        poses += [pose for pose in _repeat(poses[-1], step, steps)]
    return Path.from_poses(np.array(poses))


def _repeat(pose: Array, step: Array, count: int) -> list[Array]:
    poses = []
    for _ in range(count):
        pose = compose(pose, step)
        poses.append(pose)
    return poses


def _around(free: BaseGeometry, thickness: float = 0.3) -> tuple[Solid, ...]:
    """Return walls around a free area: what surrounds it, as solids."""
    shell = free.buffer(thickness, join_style="mitre").difference(free)
    parts = shapely.get_parts(shell)
    return tuple(Solid(part, name=f"wall {k}") for k, part in enumerate(parts, start=1))


def _paper_corner() -> TrackedPlan:
    """Return the paper's turn from 1.30 m to 1.30 m: r = 1.3533 m, no clearance at all."""
    middle = 1.3533 + 0.335
    path = _pieces((-1.0, 0.0, 0.0), (1.0, 0.0), (middle, math.pi / 2), (1.0, 0.0))
    return _tracked(_ideal_chair(), World(), path, PAPER_SPEED, "paper corner")


def _paper_door() -> TrackedPlan:
    """Return the paper's arc through a door of 0.90 m: r = 1.3889 m."""
    middle = 1.3889 + 0.335
    path = _pieces((-0.5, 0.0, 0.0), (0.5, 0.0), (middle, math.pi / 2), (1.0, 0.0))
    return _tracked(_ideal_chair(), World(), path, PAPER_SPEED, "paper door")


def _table(name: str) -> TrackedPlan:
    """Return a trajectory of Table I [DoorBezier] at the paper's figure's 0.4 m/s."""
    chair = paper_chair().with_limits(speed=0.4)
    _, segment = plan_trajectory(name)
    if segment.control is None:
        raise StudyError("the curve of Table I was not found", value=name)
    motion = time_path(smooth_path(segment.control[None]), chair)
    return _tracked(chair, World(), motion, 0.4, name)


@dataclass(frozen=True)
class _Turn:
    """The arc with the same clearance everywhere round a corner.

    Attributes:
        middle: Radius of the body origin [m].
        centre: Distance of the arc's centre from the outer walls [m].
    """

    middle: float
    centre: float


def _best_turn(chair: Vehicle, corridor: float) -> _Turn:
    d, w = chair.front_overhang, chair.width
    spare = (math.sqrt(2.0) * corridor - d - w) / (1.0 + math.sqrt(2.0))
    return _Turn(d - 0.5 * w, spare + math.sqrt(2.0) * d)


def _corner() -> TrackedPlan:
    """Return the turn with the most clearance in the paper's corridor of 1.30 m: 70 mm."""
    chair, width = _ideal_chair(), 1.30
    turn = _best_turn(chair, width)
    path = _pieces((-1.0, 0.0, 0.0), (1.0, 0.0), (turn.middle, math.pi / 2), (1.0, 0.0))
    right = turn.middle - turn.centre  # y of the outer wall before the turn
    free = shapely.box(-1.5, right, turn.centre, right + width).union(
        shapely.box(turn.centre - width, right, turn.centre, turn.middle + 2.5)
    )
    return _tracked(chair, World(_around(free)), path, SPEED, "corner")


def _s_corridor() -> TrackedPlan:
    """Return a left and a right turn between corridors of 1.15 m."""
    chair, width, between = load_vehicle("narrow-arcs"), 1.15, 0.6
    turn = _best_turn(chair, width)
    m, c = turn.middle, turn.centre
    path = _pieces(
        (-1.0, 0.0, 0.0),
        (1.0, 0.0),
        (m, math.pi / 2),
        (between, 0.0),
        (m, -math.pi / 2),
        (1.0, 0.0),
    )
    right, top = m - c, m + between + c
    left, end = min(c - width, 2.0 * m - c), max(c, 2.0 * m - c + width)
    free = shapely.union_all(
        [
            shapely.box(-1.5, right, c, right + width),
            shapely.box(left, right, end, top),
            shapely.box(left, top - width, 2.0 * m + 2.2, top),
        ]
    )
    return _tracked(chair, World(_around(free)), path, SPEED, "S corridor")


def _door() -> TrackedPlan:
    """Return a smooth plan from a corridor of 1.7 m through a door of 1.0 m, 60 mm asked for."""
    chair = load_vehicle("narrow-arcs").with_limits(speed=0.4)
    free = shapely.union_all(
        [
            shapely.box(-1.5, -0.85, 3.5, 0.85),
            shapely.box(1.2, 0.8, 2.2, 1.0),
            shapely.box(-0.5, 0.95, 3.5, 4.0),
        ]
    )
    world = World(_around(free), doors=(Door((1.7, 0.9), 1.0, math.pi / 2),))
    start, goal = np.array([-0.5, -0.1, 0.0]), np.array([1.7, 2.6, math.pi / 2])
    scene = Scene(chair, world, start, Goal(goal), margin=0.06, name="door")
    plan = DoorwayPlanner().plan(scene)
    if plan.trajectory is None:
        raise StudyError(f"the door cannot be planned: {plan.reason}", value="door")
    return _tracked(chair, world, plan.trajectory, SPEED, "door")


def _shunt() -> TrackedPlan:
    """Return forward past a door, in reverse through it, a turn on the spot, and forward."""
    chair = load_vehicle("narrow-arcs")
    path = _pieces(
        (0.0, 0.0, 0.0),
        (1.6, 0.0),
        (-0.9, -math.pi / 2),
        (-0.9, 0.0),
        (0.0, math.pi / 2),
        (0.6, 0.0),
    )
    free = shapely.union_all(
        [
            shapely.box(-0.6, -0.62, 2.8, 0.62),
            shapely.box(0.29, 0.5, 1.33, 0.8),
            shapely.box(-0.6, 0.72, 2.6, 3.0),
        ]
    )
    return _tracked(chair, World(_around(free)), path, SPEED, "shunt")


def first_scenes(file: str) -> tuple[str, ...]:
    """Return the name of the first scene of each level in a file of DoorBench."""
    levels: dict[str, str] = {}
    for scene in read_doorbench(FilePath(file)):
        levels.setdefault(scene.level, scene.name)
    return tuple(levels.values())


def _doorbench(name: str, file: str) -> TrackedPlan:
    """Return the plan of a scene of DoorBench, with reversing allowed."""
    from ..planners import plan

    found = [
        one.scene for one in read_doorbench(FilePath(file), reversing=True) if one.name == name
    ]
    if not found:
        raise StudyError("there is no such scene", file=file, value=name)
    scene = found[0]
    planned = plan(scene)
    if planned.trajectory is None or planned.certificate is None:
        raise StudyError(f"the scene is {planned.status.value}: {planned.reason}", value=name)
    return TrackedPlan(scene, planned.trajectory, SPEED, planned.certificate.clearance)
