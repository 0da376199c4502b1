"""The paper's runs again with a chair's own sensors and its obstacle map."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from ..errors import StudyError
from ..scene import Scene
from ..simulation.chair_senses import ChairSenses
from ..simulation.fitted_sensors import FittedLaser
from ..simulation.laser import on_corners
from ..simulation.named_senses import REACH, fitted_camera, lasers_and_camera
from ..simulation.senses import Senses
from .case import Case, Scalar
from .fuzzy_dvz_runs import DRIVE, drive, row_of
from .fuzzy_dvz_scenes import PAPER_SCENES

SENSED = ("two lasers", "two lasers and a depth camera", "a depth camera")
"""What the chair carries; each with the map that remembers what leaves the view."""


def senses_of(scene: Scene, kind: str, rng: np.random.Generator) -> Senses:
    """Return a chair's senses.

    Args:
        scene: World, chair, start.
        kind: One of `SENSED`.
        rng: Source of their noise.
    """
    if kind == "two lasers":
        lasers = [FittedLaser(scanner) for scanner in on_corners(scene.vehicle)]
        return ChairSenses(scene, lasers, reach=REACH, rng=rng)
    if kind == "two lasers and a depth camera":
        return lasers_and_camera(scene, rng=rng)
    if kind == "a depth camera":
        return ChairSenses(scene, [fitted_camera()], reach=REACH, rng=rng)
    raise StudyError("no such senses", value=kind, allowed=", ".join(SENSED))


def sensing_case(case: Case, rng: np.random.Generator) -> Mapping[str, Scalar]:
    """Return a row: one of the paper's runs by a chair's own senses."""
    scene = PAPER_SCENES[str(case["scene"])]()
    senses = senses_of(scene, str(case["senses"]), rng)
    options = replace(DRIVE, time_limit=120.0)
    return row_of(drive(scene, senses=senses, reach=REACH, options=options))
