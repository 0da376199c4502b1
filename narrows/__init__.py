"""narrows: plan how a wheelchair with a real body gets through narrow places.

The names below are those meant for use from outside; `docs/python.md` says what they do. Each is
imported when it is first used, so that `import narrows` costs nothing.
"""

# ruff: noqa: F401 - what type checkers see is what `_MODULES` finds
from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING, Any

__version__ = "0.1.0"

if TYPE_CHECKING:
    from .clearance import Certificate, certify, clearance_at
    from .errors import (
        InputError,
        MissingExtra,
        NarrowsError,
        PlanningFailed,
        SceneError,
        ShapeError,
        StudyError,
        TrajectoryError,
    )
    from .formats import read_trajectory, write_trajectory
    from .interfaces import Controller, Percept, Plan, Planner, PlanStatus, Tracker
    from .limit_check import LimitCheck, check_limits
    from .maps import load_map
    from .path import Path
    from .perception.obstacle_map import ObstacleMap
    from .perception.ranges import LaserScan
    from .planners import plan
    from .planners.passage import Verdict, passable
    from .reactive.assistant import Assistant
    from .reactive.navigator import Navigator
    from .reactive.navigator_tracking import GuardedTracker
    from .reactive.safety_regions import SafetyRegions
    from .scene import (
        Goal,
        Scene,
        load_scene,
        load_vehicle,
        read_scene,
        scene_schema,
        vehicle_names,
        write_scene,
    )
    from .simulation.judge import Judgement, judge
    from .simulation.record import Record
    from .simulation.senses import IdealSenses
    from .simulation.simulator import simulate
    from .tracking.linearizing import LinearizingTracker
    from .tracking.lookahead import LookaheadTracker
    from .tracking.predictive import PredictiveTracker
    from .tracking.registry import make_tracker
    from .tracking.virtual_target import VirtualTargetTracker
    from .trajectory import Trajectory
    from .vehicle import Layer, Limits, Vehicle
    from .verification import Verification, verify
    from .world import Door, MovingSolid, Solid, World

_MODULES = {
    "clearance": ("Certificate", "certify", "clearance_at"),
    "errors": (
        "InputError",
        "MissingExtra",
        "NarrowsError",
        "PlanningFailed",
        "SceneError",
        "ShapeError",
        "StudyError",
        "TrajectoryError",
    ),
    "formats": ("read_trajectory", "write_trajectory"),
    "interfaces": ("Controller", "Percept", "Plan", "PlanStatus", "Planner", "Tracker"),
    "limit_check": ("LimitCheck", "check_limits"),
    "maps": ("load_map",),
    "path": ("Path",),
    "perception.obstacle_map": ("ObstacleMap",),
    "perception.ranges": ("LaserScan",),
    "planners": ("plan",),
    "planners.passage": ("Verdict", "passable"),
    "reactive.assistant": ("Assistant",),
    "reactive.navigator": ("Navigator",),
    "reactive.navigator_tracking": ("GuardedTracker",),
    "reactive.safety_regions": ("SafetyRegions",),
    "scene": (
        "Goal",
        "Scene",
        "load_scene",
        "load_vehicle",
        "read_scene",
        "scene_schema",
        "vehicle_names",
        "write_scene",
    ),
    "simulation.judge": ("Judgement", "judge"),
    "simulation.record": ("Record",),
    "simulation.senses": ("IdealSenses",),
    "simulation.simulator": ("simulate",),
    "tracking.linearizing": ("LinearizingTracker",),
    "tracking.lookahead": ("LookaheadTracker",),
    "tracking.predictive": ("PredictiveTracker",),
    "tracking.registry": ("make_tracker",),
    "tracking.virtual_target": ("VirtualTargetTracker",),
    "trajectory": ("Trajectory",),
    "vehicle": ("Layer", "Limits", "Vehicle"),
    "verification": ("Verification", "verify"),
    "world": ("Door", "MovingSolid", "Solid", "World"),
}
_HOMES = {name: module for module, names in _MODULES.items() for name in names}

__all__ = ["__version__", *sorted(_HOMES)]


def __getattr__(name: str) -> Any:
    """Return a public name, importing its module when it is first asked for."""
    if name not in _HOMES:
        raise AttributeError(f"module 'narrows' has no attribute '{name}'")
    value = getattr(import_module(f".{_HOMES[name]}", __name__), name)
    globals()[name] = value
    return value


def __dir__() -> list[str]:
    """Return the public names."""
    return sorted(__all__)
