"""Scenes: a chair, a world, where to start and where to go; read, checked, written.

The format is `docs/scene-format.md`; its entries are in `scene_model`, its short forms in
`short_forms`. Reading ends in a `Scene` or in one `SceneError` that names file, line, field, the
value found and what is allowed.
"""

from __future__ import annotations

import math
import os
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import shapely

from .errors import ShapeError
from .files import write_whole
from .scene_source import Source
from .scene_text import decode, read_source
from .se2 import Array, transform
from .vehicle import Vehicle
from .vehicle_presets import preset_entry, vehicle_names
from .world import Solid, World

__all__ = [
    "Goal",
    "Scene",
    "check_scene",
    "load_scene",
    "load_vehicle",
    "read_scene",
    "scene_schema",
    "vehicle_names",
    "write_scene",
]

_TOUCHING = 1e-9  # m: rounding that does not count as overlap


def _pose(pose: Any, name: str) -> Array:
    checked = np.array(pose, dtype=float)
    if checked.shape != (3,) or not np.isfinite(checked).all():
        raise ShapeError(f"{name} must be a finite pose [x, y, heading], got {pose}")
    checked.setflags(write=False)
    return checked


@dataclass(frozen=True, eq=False)
class Goal:
    """The pose to reach, and how exactly.

    Attributes:
        pose: Pose body_to_world, shape (3,), [m, m, rad].
        position_tolerance: Radius about the goal [m].
        heading_tolerance: Either side of the goal's heading [rad].
    """

    pose: Array
    position_tolerance: float = 0.05
    heading_tolerance: float = math.radians(3.0)

    def __post_init__(self) -> None:
        """Check the numbers; keep a read-only copy."""
        object.__setattr__(self, "pose", _pose(self.pose, "the goal"))
        for name in ("position_tolerance", "heading_tolerance"):
            if not 0.0 < getattr(self, name) < math.inf:
                raise ShapeError(f"{name} must be a positive number, got {getattr(self, name)}")


@dataclass(frozen=True, eq=False)
class Scene:
    """What a planner is asked.

    A scene read from a file has been checked (`check_scene`): neither start nor goal overlaps
    anything. One made in Python may ask for the impossible, such as a paper's own case.

    Attributes:
        vehicle: The chair.
        world: What it must not touch.
        start: Pose body_to_world at the start, shape (3,), [m, m, rad].
        goal: Pose to reach and tolerances.
        margin: Clearance asked for [m].
        name: Name for people.
    """

    vehicle: Vehicle
    world: World
    start: Array
    goal: Goal
    margin: float = 0.02
    name: str = ""

    def __post_init__(self) -> None:
        """Check the numbers; keep a read-only copy."""
        object.__setattr__(self, "start", _pose(self.start, "the start"))
        if not 0.0 <= self.margin < math.inf:
            raise ShapeError(f"margin must be a number of metres, at least 0, got {self.margin}")


def load_scene(file: str | os.PathLike[str]) -> Scene:
    """Return the checked scene of a file.

    Args:
        file: A YAML or JSON file as `docs/scene-format.md` says.

    Raises:
        SceneError: If the file cannot be read, does not follow the format, or start or goal
            overlap something.
    """
    name = os.fspath(file)
    return read_scene(decode(_content(name), name), name)


def read_scene(text: str, file: str | os.PathLike[str] | None = None) -> Scene:
    """Return the checked scene of a text.

    Args:
        text: YAML or JSON as `docs/scene-format.md` says.
        file: File the text comes from: for messages, and for maps named relative to it.

    Raises:
        SceneError: As for `load_scene`.
    """
    from .scene_build import build_vehicle, build_world
    from .scene_model import SceneEntry
    from .scene_problems import validated

    source = read_source(text, None if file is None else os.fspath(file))
    folder = Path(".") if file is None else Path(file).parent
    entry = validated(SceneEntry, source, None if source.root is None else source.root.value)
    vehicle = build_vehicle(entry.vehicle, source)
    world, form = build_world(entry, source, folder)
    poses: dict[str, Array] = {}
    for name, given in (("start", entry.start), ("goal", entry.goal)):
        if given is not None:
            poses[name] = np.array([given.x, given.y, math.radians(given.heading_deg)])
        elif form is not None:
            poses[name] = getattr(form, name)(vehicle)
        else:
            raise source.error((name,), "is missing", allowed="{x, y, heading_deg}")
    goal = Goal(poses["goal"])
    if entry.goal is not None:
        tolerance = math.radians(entry.goal.heading_tolerance_deg)
        goal = Goal(poses["goal"], entry.goal.position_tolerance, tolerance)
    scene = Scene(vehicle, world, poses["start"], goal, entry.margin, entry.name)
    return check_scene(scene, source)


def check_scene(scene: Scene, source: Source | None = None) -> Scene:
    """Return the scene if neither start nor goal overlaps anything or leaves the bounds.

    Contact does not count. Moving things count where they are at time 0, for the start only.

    Args:
        scene: The scene.
        source: File it was read from, for the message.

    Raises:
        SceneError: Says by how many millimetres the body overlaps and with what.
    """
    from .scene_problems import first_of

    source = source if source is not None else Source(None)
    problems = [
        source.error(
            (name,),
            problem,
            value=[round(float(v), 9) for v in (pose[0], pose[1], math.degrees(pose[2]))],
            allowed="a pose [x, y, heading_deg] whose body is free",
        )
        for name, pose in (("start", scene.start), ("goal", scene.goal.pose))
        for problem in _overlaps(scene, pose, name)
    ]
    if problems:
        raise first_of(problems)
    return scene


def _overlaps(scene: Scene, pose: Array, name: str) -> list[str]:
    from .clearance import clearance_at

    world, vehicle = scene.world, scene.vehicle
    distance, against = clearance_at(world, vehicle, pose[None])
    found = []
    if distance[0] < -_TOUCHING:
        found.append(f"the chair at the {name} overlaps '{against[0]}' by {_mm(-distance[0])}")
    if world.bounds is not None:
        body = transform(pose, vehicle.outline)
        x_min, y_min, x_max, y_max = world.bounds
        beyond = max(
            *([x_min, y_min] - body.min(axis=0)),
            *(body.max(axis=0) - [x_max, y_max]),
        )
        if beyond > _TOUCHING:
            found.append(f"the chair at the {name} leaves the bounds by {_mm(beyond)}")
    if name == "start" and world.moving:
        solids = tuple(
            Solid(shapely.Point(p.position(0.0)), p.radius, p.z, p.name) for p in world.moving
        )
        distance, against = clearance_at(World(solids), vehicle, pose[None])
        if distance[0] < -_TOUCHING:
            found.append(f"the chair overlaps '{against[0]}' by {_mm(-distance[0])} at the start")
    return found


def _mm(length: float) -> str:
    """Return a length for people: whole millimetres, never 0."""
    return f"{max(1, round(1e3 * float(length)))} mm"


def write_scene(scene: Scene, file: str | os.PathLike[str]) -> None:
    """Write a scene so that reading it gives the same scene; replaces the file at once.

    Raises:
        SceneError: If the scene holds what the format does not take, such as coordinates beyond
            1e6 m.
        InputError: If the file cannot be written.
    """
    from .scene_model import SceneEntry
    from .scene_problems import validated
    from .scene_write import pose_entry, to_yaml, vehicle_entry, world_entry

    document = {
        "name": scene.name,
        "vehicle": vehicle_entry(scene.vehicle),
        "world": world_entry(scene.world),
        "start": pose_entry(scene.start),
        "goal": pose_entry(scene.goal.pose)
        | {
            "position_tolerance": scene.goal.position_tolerance,
            "heading_tolerance_deg": math.degrees(scene.goal.heading_tolerance),
        },
        "margin": scene.margin,
    }
    validated(SceneEntry, Source(None), document)
    write_whole(Path(file), to_yaml(document))


def load_vehicle(name: str) -> Vehicle:
    """Return a chair that comes with narrows.

    >>> load_vehicle("narrow-arcs").width
    0.67

    Raises:
        SceneError: If there is no such chair; names the nearest.
    """
    from .scene_build import build_vehicle
    from .scene_model import VehicleEntry

    preset_entry(name)
    return build_vehicle(VehicleEntry.model_validate({"preset": name}), Source(None))


def scene_schema() -> dict[str, Any]:
    """Return the JSON Schema of the scene format, as shipped in `scene.schema.json`."""
    from .scene_model import SceneEntry

    schema = SceneEntry.model_json_schema()
    return {"$schema": "https://json-schema.org/draft/2020-12/schema", **schema}


def _content(file: str) -> bytes:
    """Return a file's bytes, at most a little more than can be read."""
    source = Source(file)
    try:
        with open(file, "rb") as stream:
            return stream.read(2**23)
    except FileNotFoundError:
        raise source.error((), "no such file", allowed="a scene file (YAML or JSON)") from None
    except IsADirectoryError:
        raise source.error((), "a folder, not a file", allowed="a scene file") from None
    except (OSError, ValueError) as error:  # ValueError: a name with a zero byte
        raise source.error((), f"cannot be read: {error}") from None
