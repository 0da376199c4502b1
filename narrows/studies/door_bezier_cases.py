"""The cases of [DoorBezier]: Table I, the obstacle scenario, and driving them as the paper does.

Not printed in the paper and assumed here: the wall is 0.10 m thick with P_d in its middle, so the
1.60 m corridor lies at y = 0.15..1.75 m; the chair of 0.75 m is 1.10 m long with its drive axle
0.25 m before its back (the `door-bezier` preset); speed 0.4 m/s and look-ahead 0.28 m.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from .. import bezier
from ..clearance import Certificate, certify
from ..errors import PlanningFailed, StudyError
from ..path import Path
from ..planners.bezier_segment import Segment
from ..planners.door_regions import describe_passage
from ..planners.doorway import DoorwayOptions, DoorwayPlanner, smooth_path
from ..scene import Goal, Scene, load_vehicle
from ..se2 import Array
from ..simulation.plant import PlantOptions
from ..simulation.record import Record
from ..simulation.simulator import SimulationOptions, simulate
from ..tracking.lookahead import LookaheadOptions, LookaheadTracker
from ..vehicle import Vehicle
from ..world import Door, Solid, World
from .case import Case, Scalar

START, DOOR = (0.1, 1.3), (1.6, 1.8)
TARGETS = {"A": (0.0, 3.5), "B": (3.4, 3.5)}
HEADINGS_DEG = {
    "A1": (-20.0, 90.0),
    "A2": (-40.0, 90.0),
    "A3": (90.0, 160.0),
    "A4": (90.0, 200.0),
    "B1": (-10.0, 90.0),
    "B2": (10.0, 90.0),
    "B3": (90.0, 20.0),
    "B4": (90.0, -20.0),
}
"""Headings at the ends of the eight trajectories [DoorBezier, Table I]."""

DOOR_WIDTH, CORRIDOR_WIDTH, WALL = 0.90, 1.60, 0.10
OBSTACLES = ((1.35, 0.82, 0.12), (0.95, 2.4, 0.12))
"""x, y, radius of the obstacles: one in the corridor, one in the room; the paper prints none."""

_IDEAL = PlantOptions(motor_lag=0.0, wheel_acceleration=1e3)


def paper_chair(*, reference: str = "axle") -> Vehicle:
    """Return the 0.75 m chair with its body origin on the drive axle or in its middle."""
    chair = load_vehicle("door-bezier")
    if reference == "axle":
        return chair
    if reference == "middle":
        return Vehicle.rectangle(chair.length, chair.width, 0.5 * chair.length)
    raise StudyError(f"reference must be 'axle' or 'middle', got {reference!r}")


def paper_world(obstacles: tuple[tuple[float, float, float], ...] = ()) -> World:
    """Return the corridor, the door's wall and round obstacles."""
    x, y = DOOR
    near, far = y - 0.5 * WALL, y + 0.5 * WALL
    left, right = x - 0.5 * DOOR_WIDTH, x + 0.5 * DOOR_WIDTH
    low = near - CORRIDOR_WIDTH
    boxes = {
        "corridor wall": (-2.0, low - WALL, 5.0, low),
        "left jamb": (-2.0, near, left, far),
        "right jamb": (right, near, 5.0, far),
    }
    walls = [
        Solid.polygon([[a, b], [c, b], [c, d], [a, d]], name=name)
        for name, (a, b, c, d) in boxes.items()
    ]
    names = ("corridor obstacle", "room obstacle")
    disks = [Solid.circle(*disk, name=names[k % 2]) for k, disk in enumerate(obstacles)]
    return World((*walls, *disks), doors=(Door(DOOR, DOOR_WIDTH, math.pi / 2),))


def scene_of(start: ArrayLike, goal: ArrayLike, world: World | None = None) -> Scene:
    """Return a scene with the paper's chair; its ends may overlap the wall, as the paper's do."""
    return Scene(
        paper_chair(),
        paper_world() if world is None else world,
        np.asarray(start, dtype=float),
        Goal(np.asarray(goal, dtype=float)),
        name="[DoorBezier]",
    )


def _pose(point: tuple[float, float], degrees: float) -> Array:
    return np.array([*point, math.radians(degrees)])


def plan_trajectory(name: str) -> tuple[Scene, Segment]:
    """Return one trajectory of Table I as the paper plans it, with its scene.

    Args:
        name: A key of `HEADINGS_DEG`.
    """
    first, last = HEADINGS_DEG[name]
    planner = DoorwayPlanner(DoorwayOptions.paper())
    target = TARGETS[name[0]]
    if name[1] in "12":
        scene = scene_of(_pose(START, first), _pose(target, 90.0))
        passage = describe_passage(scene, scene.world.doors[0], keep_off="half_width")
        return scene, planner.first_segment(scene, passage)
    scene = scene_of(_pose(DOOR, first), _pose(target, last))
    passage = describe_passage(scene, scene.world.doors[0], keep_off="half_width")
    return scene, planner.second_segment(scene, passage, passage.pose)


@dataclass(frozen=True, eq=False)
class Drive:
    """A reference curve driven as the paper does.

    Attributes:
        path: The reference.
        parameter: Curve parameter of the reference at each control period, shape (N,).
        omega: Command [rad/s], shape (N,).
        lookahead_error: D_err [m], shape (N,).
        record: True motion and C_err.
    """

    path: Path
    parameter: Array
    omega: Array
    lookahead_error: Array
    record: Record

    @property
    def arrived(self) -> Array:
        """Pose where the drive ended, shape (3,)."""
        return np.asarray(self.record.poses[-1])


class _Noted:
    """A look-ahead tracker whose errors and commands are noted down."""

    def __init__(self, tracker: LookaheadTracker) -> None:
        self.tracker = tracker
        self.rows: list[tuple[float, float, float]] = []

    @property
    def progress(self) -> float:
        return self.tracker.progress

    @property
    def finished(self) -> bool:
        return self.tracker.finished

    def step(self, time: float, pose: ArrayLike) -> Array:
        command = self.tracker.step(time, pose)
        if not self.finished:
            row = (self.progress, float(command[1]), self.tracker.lookahead_error)
            self.rows.append(row)
        return command


def drive_curve(
    scene: Scene,
    control: Array,
    *,
    start: Array | None = None,
    options: LookaheadOptions | None = None,
) -> Drive:
    """Return the drive along one curve with the paper's law, at constant speed, on ideal wheels.

    Args:
        scene: World and chair.
        control: Control points of the curve, shape (4, 2), [m].
        start: True pose at its start, shape (3,); default the curve's own.
        options: Default `LookaheadOptions.paper()`.
    """
    path = smooth_path(np.asarray(control)[None])
    begin = path.start if start is None else start
    tracker = _Noted(LookaheadTracker(path, scene.vehicle, options or LookaheadOptions.paper()))
    given = Scene(scene.vehicle, scene.world, begin, Goal(path.goal))
    record = simulate(given, tracker, reference=path, options=SimulationOptions(plant=_IDEAL))
    rows = np.array(tracker.rows)
    parameter = np.linspace(0.0, 1.0, 2001)
    speed = np.linalg.norm(bezier.evaluate(control, parameter, 1), axis=-1)
    length = np.concatenate([[0.0], np.cumsum(0.5 * (speed[1:] + speed[:-1]) / 2000.0)])
    return Drive(path, np.interp(rows[:, 0], length, parameter), rows[:, 1], rows[:, 2], record)


def certificates(scene: Scene, control: Array) -> tuple[Certificate, Certificate]:
    """Return the certificates of a curve for the chair by its axle and by its middle."""
    path = smooth_path(np.asarray(control)[None])
    by_axle, by_middle = (
        certify(scene.world, paper_chair(reference=reference), path)
        for reference in ("axle", "middle")
    )
    return by_axle, by_middle


def run_trajectory(case: Case, rng: np.random.Generator) -> Mapping[str, Scalar]:
    """Return the results of one trajectory of Table I: the curve, its clearance, its tracking."""
    scene, segment = plan_trajectory(str(case["trajectory"]))
    return _results(scene, segment, None)[0]


def _results(
    scene: Scene, segment: Segment, start: Array | None
) -> tuple[dict[str, Scalar], Drive]:
    """Return the columns of a planned and driven segment, and the drive."""
    if segment.control is None:
        raise PlanningFailed(segment.reason)
    control = segment.control
    drive = drive_curve(scene, control, start=start)
    by_axle, by_middle = certificates(scene, control)
    bend = float(np.abs(bezier.curvature(control, np.linspace(0.0, 1.0, 2001))).max())
    columns: dict[str, Scalar] = {
        f"p{k}_{axis}": float(control[k, i]) for k in range(4) for i, axis in enumerate("xy")
    }
    columns |= {
        "a": float(segment.legs[0]),
        "b": float(segment.legs[1]),
        "cost": segment.cost,
        "max_curvature": bend,
        "clearance_mm": 1e3 * by_axle.clearance,
        "attained_mm": 1e3 * by_axle.attained,
        "hit_x": by_axle.at[1],
        "hit_y": by_axle.at[2],
        "against": by_axle.against,
        "clearance_middle_mm": 1e3 * by_middle.clearance,
        "against_middle": by_middle.against,
        "max_lookahead_error_mm": 1e3 * float(np.abs(drive.lookahead_error).max()),
        "max_cross_track_mm": 1e3 * float(np.abs(drive.record.cross_track).max()),
        "max_omega": float(np.abs(drive.omega).max()),
    }
    return columns, drive


@dataclass(frozen=True, eq=False)
class ObstacleRun:
    """The obstacle scenario, with or without its obstacles.

    Attributes:
        scene: World and chair.
        control: Both planned segments, shape (2, 4, 2), [m].
        costs: J of each.
        drives: How each was driven; the second from where the first ended.
        certificate: Clearance of both segments together.
    """

    scene: Scene
    control: Array
    costs: tuple[float, float]
    drives: tuple[Drive, Drive]
    certificate: Certificate


def run_obstacles(*, with_obstacles: bool) -> ObstacleRun:
    """Return the obstacle scenario: A1 to the door, A3 behind it from where the chair truly is.

    The heading at the door is adjusted to the door's normal before the second segment is planned.
    """
    known = paper_world(OBSTACLES if with_obstacles else ())
    start, goal = _pose(START, HEADINGS_DEG["A1"][0]), _pose(TARGETS["A"], HEADINGS_DEG["A3"][1])
    scene = scene_of(start, goal, known)
    planner = DoorwayPlanner(DoorwayOptions.paper())
    passage = describe_passage(scene, known.doors[0], keep_off="half_width")
    first = planner.first_segment(scene, passage)
    if first.control is None:
        raise PlanningFailed(first.reason)
    there = drive_curve(scene, first.control)
    second = planner.second_segment(scene, passage, there.arrived)
    if second.control is None:
        raise PlanningFailed(second.reason)
    onward = drive_curve(scene, second.control)
    judged = scene_of(start, goal, paper_world(OBSTACLES))
    certificate = min(
        (
            certify(judged.world, judged.vehicle, smooth_path(c[None]))
            for c in (first.control, second.control)
        ),
        key=lambda one: one.attained,
    )
    control = np.stack([first.control, second.control])
    return ObstacleRun(judged, control, (first.cost, second.cost), (there, onward), certificate)
