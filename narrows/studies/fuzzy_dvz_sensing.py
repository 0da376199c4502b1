"""The paper's runs again with a chair's own sensors and its obstacle map."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import replace
from typing import Any

import numpy as np

from ..errors import StudyError
from ..perception.camera import Mounting
from ..perception.obstacles import ObstacleFinder
from ..perception.surroundings import Grid
from ..scene import Scene
from ..simulation.chair_senses import ChairSenses
from ..simulation.depth_sensor import DepthSensor, kinect
from ..simulation.fitted_sensors import FittedCamera, FittedLaser, FittedSensor, Schedule
from ..simulation.laser import front_and_rear
from .case import Case, Scalar
from .fuzzy_dvz_runs import DRIVE, drive, row_of
from .fuzzy_dvz_scenes import PAPER_SCENES

SENSED = ("two lasers", "two lasers and a depth camera", "a depth camera")
"""What the chair carries; each with the map that remembers what leaves the view."""

CAMERA = Mounting(height=1.0, tilt=math.radians(25.0))
"""Of the depth camera, 57 degrees wide; 320 x 240 pixels at 10 Hz."""

_REACH = 3.7  # m: as far as the map tells in every direction


def senses_of(scene: Scene, kind: str, rng: np.random.Generator) -> ChairSenses:
    """Return a chair's senses.

    Args:
        scene: World, chair, start.
        kind: One of `SENSED`.
        rng: Source of their noise.
    """
    if kind not in SENSED:
        raise StudyError("no such senses", value=kind, allowed=", ".join(SENSED))
    fitted: list[FittedSensor[Any]] = []
    if "lasers" in kind:
        fitted += [FittedLaser(scanner) for scanner in front_and_rear(scene.vehicle)]
    if "camera" in kind:
        camera = kinect(CAMERA, width=320, height=240)
        finder = ObstacleFinder(camera, Grid(x_from=0.8, x_to=4.4))
        schedule = Schedule(rate=10.0, latency=0.06)
        fitted.append(FittedCamera(DepthSensor(camera), finder, schedule))
    return ChairSenses(scene, fitted, reach=_REACH, rng=rng)


def sensing_case(case: Case, rng: np.random.Generator) -> Mapping[str, Scalar]:
    """Return a row: one of the paper's runs by a chair's own senses."""
    scene = PAPER_SCENES[str(case["scene"])]()
    senses = senses_of(scene, str(case["senses"]), rng)
    options = replace(DRIVE, time_limit=120.0)
    return row_of(drive(scene, senses=senses, reach=_REACH, options=options))
