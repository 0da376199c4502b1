"""The cases of the `narrow-arcs` study: chairs in corridors and doors, and turns executed."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from ..clearance import certify
from ..errors import ShapeError, StudyError
from ..path import Path
from ..planners.arc_geometry import (
    ArcBody,
    best_paper_turn,
    contact_radii,
    least_paper_corridor,
    rigid_bound,
    spin_corridor,
)
from ..planners.arc_path import CornerFrame, path_of, turn_pieces
from ..planners.corridor_turn import (
    Corner,
    TurnArc,
    arc_of_radius,
    best_arc,
    least_corridor,
)
from ..planners.door_space import least_corridor_for_door
from ..scene import Goal, Scene
from ..se2 import Array
from ..short_forms import Corridor
from ..simulation.judge import judge
from ..simulation.localisation import EncoderOdometry, Estimator
from ..simulation.plant import PlantOptions
from ..simulation.record import Record
from ..simulation.simulator import SimulationOptions, simulate
from ..simulation.ultrasound import measure_ranges, read_corner, sensor_ring
from ..tracking.registry import make_tracker
from ..vehicle import Vehicle
from ..vehicle_presets import vehicle_names
from ..world import World

WIDTH = 1.30
"""L, the corridor of the experiment [m]."""

DOOR = 0.90
"""D, the door of the experiment [m]."""

SPEED = 0.16 * 2.0 * math.pi * 10.0 / 60.0
"""v = 10 r/min with r_c = 0.16 m [m/s]."""

DOORS = (0.80, 0.85, 0.90, 1.00)
"""Doors of the trade-off [m]."""

ARCS = ("the paper's", "best on the bisector", "best anywhere")
"""Arcs that are executed."""

_LEG = 2.2  # m: of the corridor beyond the corner, in the executed turns
_BEFORE = 1.55  # m: the drive axle before the inner corner where it measures
_OFF = (0.04, math.radians(2.0))  # of the pose it measures from, standard deviation [m, rad]


def paper_vehicle() -> Vehicle:
    """Return the chair as the paper's formulas have it: the axle at its back."""
    return Vehicle.rectangle(1.0, 0.67, 0.0, track=0.67, wheel_radius=0.16, name="paper's chair")


def paper_body() -> ArcBody:
    """Return its rectangle: d = 1.00 m, w = 0.67 m."""
    return ArcBody.of(paper_vehicle())


def chairs() -> dict[str, ArcBody]:
    """Return the rectangles of the paper's chair and of all that come with narrows, by name."""
    from ..scene import load_vehicle

    named = {name: ArcBody.of(load_vehicle(name)) for name in vehicle_names()}
    return {"paper's formulas": paper_body(), **named}


def chair_cases() -> list[dict[str, Any]]:
    """Return a case for each chair."""
    return [
        {"chair": name, "front": body.front, "rear": body.rear, "width": body.width}
        for name, body in chairs().items()
    ]


def run_chair(case: Mapping[str, Any], rng: np.random.Generator) -> dict[str, Any]:
    """Return what a chair needs: corridors for one arc and others, and corridors for doors.

    The least corridor for one arc is confirmed by the certificate 2 mm above and below it.
    """
    body = ArcBody(case["front"], case["rear"], case["width"])
    least = least_corridor(body)
    found: dict[str, Any] = {
        "bisector_m": least_paper_corridor(body.overhang, body.width),
        "one_arc_m": least,
        "spin_m": spin_corridor(body),
        "bound_m": rigid_bound(body),
    }
    for name, spare in (("above", 0.002), ("below", -0.002)):
        corner = Corner(least + spare, least + spare)
        arc = best_arc(body, corner, least_radius=0.5 * body.width)
        found[f"clear_2mm_{name}"] = certify_arc(body, corner, arc)[0] > 0.0
    for door in DOORS:
        key = f"corridor_{1e2 * door:.0f}cm_m"
        if door <= body.width:
            found[key] = found[f"{key}_beyond"] = None
            continue
        found[key] = least_corridor_for_door(body, door).corridor
        found[f"{key}_beyond"] = least_corridor_for_door(body, door, before_wall=False).corridor
    return found


def certify_arc(body: ArcBody, corner: Corner, arc: TurnArc) -> tuple[float, float]:
    """Return proven and attained clearance of line - arc - line in a real corridor [m]."""
    world = World(Corridor(corner.before, corner.turn, corner.after, 4.0).world().solids[:2])
    x, y = arc.centre
    frame = CornerFrame(np.array([0.0, corner.before]), 0.0, 1)
    start = frame.pose_in_world(x - 2.0, y - arc.radius, 0.0)
    pieces = [(2.0, 0.0), (arc.radius * arc.turn, 1.0 / arc.radius), (2.0, 0.0)]
    vehicle = Vehicle.rectangle(body.front + body.rear, body.width, body.rear)
    certificate = certify(world, vehicle, path_of(start, pieces), tolerance=1e-4)
    return certificate.clearance, certificate.attained


def named_arc(name: str) -> TurnArc:
    """Return an arc of `ARCS` round the experiment's corner."""
    body, both = paper_body(), ArcBody(1.0, 1.0, 0.67)
    corner, half = Corner(WIDTH, WIDTH), 0.5 * body.width
    if name == ARCS[0]:
        radii = contact_radii(body.front, body.width, WIDTH)
        if radii is None:
            raise StudyError("the paper's corridor is too narrow for its chair")
        return arc_of_radius(both, corner, radii[1] + half)
    if name == ARCS[1]:
        turn = best_paper_turn(body.front, body.width, WIDTH)
        return arc_of_radius(both, corner, turn.inner_radius + half)
    if name == ARCS[2]:
        return best_arc(body, corner, least_radius=half)
    raise StudyError("there is no such arc", value=name, allowed=", ".join(ARCS))


@dataclass(frozen=True, eq=False)
class ExecutedTurn:
    """A turn from measuring to the end.

    Attributes:
        scene: Walls, chair, true start.
        believed: Start by the chair's own measurement, shape (3,).
        path: What it drove along, from there.
        record: The drive.
    """

    scene: Scene
    believed: Array
    path: Path
    record: Record


@dataclass(frozen=True, eq=False)
class _MeasuredOdometry:
    """Dead reckoning from a measured pose instead of the true one."""

    measured: Array

    def start(
        self, vehicle: Vehicle, plant: PlantOptions, pose: Array, rng: np.random.Generator
    ) -> Estimator:
        return EncoderOdometry().start(vehicle, plant, self.measured, rng)


def execute(
    arc: TurnArc, rng: np.random.Generator, *, tracker: str = "linearizing"
) -> ExecutedTurn:
    """Measure C_r, C_n and heading with sixteen ultrasonic sensors, then turn from there.

    The chair stands somewhere before the corner, takes one set of readings (5 mm noise), plans
    line - arc - line from the measured pose and drives it by its encoders alone, as fast as the
    paper's.

    Args:
        arc: The turn.
        rng: Where it stands, and the noise.
        tracker: Name of the tracker.
    """
    vehicle, form = paper_vehicle(), Corridor(WIDTH, length=_LEG)
    frame = CornerFrame(np.array([0.0, WIDTH]), 0.0, 1)
    line = arc.behind_before - arc.radius
    start = frame.pose_in_world(
        -_BEFORE - 0.1 * abs(rng.standard_normal()),
        min(max(line + _OFF[0] * rng.standard_normal(), -WIDTH + 0.45), -0.45),
        _OFF[1] * rng.standard_normal(),
    )
    goal = frame.pose_in_world(arc.radius - arc.behind_after, _LEG - 1.2, 0.5 * math.pi)
    scene = Scene(vehicle, form.world(), start, Goal(goal, 0.10, math.radians(5.0)))
    sensors = sensor_ring(vehicle)
    reading = read_corner(
        vehicle, sensors, measure_ranges(scene.world, start, sensors, rng=rng), width_after=WIDTH
    )
    half = 0.5 * vehicle.width
    believed = frame.pose_in_world(-reading.axle_gap, -reading.side_gap - half, reading.heading)
    ends = frame.pose_in_frame(believed), frame.pose_in_frame(goal)
    pieces = turn_pieces(arc, *ends, 0.3)
    if isinstance(pieces, str):
        raise ShapeError(f"the turn cannot be driven from where the chair stands: {pieces}")
    path = path_of(believed, pieces)
    record = simulate(
        scene,
        make_tracker(tracker, path, vehicle, speed=SPEED),
        reference=path,
        options=SimulationOptions(localisation=_MeasuredOdometry(believed), time_limit=120.0),
        rng=rng,
    )
    return ExecutedTurn(scene, believed, path, record)


def run_turn(case: Mapping[str, Any], rng: np.random.Generator) -> dict[str, Any]:
    """Return what became of one executed turn."""
    turn = execute(named_arc(case["arc"]), rng, tracker=case["tracker"])
    found = judge(turn.scene, turn.record)
    off = turn.believed - turn.scene.start
    return {
        "planned_mm": 1e3 * named_arc(case["arc"]).clearance,
        "clearance_mm": 1e3 * found.min_clearance,
        "collided": bool(found.contacts),
        "measured_x_mm": 1e3 * float(off[0]),
        "measured_y_mm": 1e3 * float(off[1]),
        "measured_heading_deg": math.degrees(float(off[2])),
        "cross_track_mm": 1e3 * float(found.max_cross_track_error or 0.0),
        "duration_s": found.duration,
    }
