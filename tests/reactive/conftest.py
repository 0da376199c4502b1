"""A chair, its safety regions on a coarse grid, and drives among points with the true plant."""

import math
from dataclasses import dataclass, field
from types import SimpleNamespace

import numpy as np
import pytest

import narrows
from narrows.geometry import edge_normals
from narrows.interfaces import Percept
from narrows.reactive.assistant import Assistant
from narrows.reactive.safety_regions import RegionOptions, SafetyRegions
from narrows.se2 import invert, transform
from narrows.simulation.plant import Plant, PlantOptions

COARSE = RegionOptions(
    directions=120, levels=20, cell=0.03, castor_samples=3, pose_samples=7, spread=0.015
)
"""Regions computed in a second; sound as all are, only larger."""


@pytest.fixture(scope="session")
def xeno():
    return narrows.load_vehicle("xeno")


@pytest.fixture(scope="session")
def xeno_regions(xeno):
    return SafetyRegions.compute(xeno, COARSE)


@pytest.fixture(scope="session")
def simulated(xeno, xeno_regions):
    """The Xeno on its drives, see `chair_on_drives`."""
    return chair_on_drives(xeno, xeno_regions)


@pytest.fixture(scope="session")
def simulate_chair():
    """Return what drives any chair, with regions computed for it, see `chair_on_drives`."""
    return lambda chair: chair_on_drives(chair, SafetyRegions.compute(chair, COARSE))


def chair_on_drives(chair, regions):
    """Return what tests of drives share: `drive`, `outlines`, `box`, `gap`, `assistant(...)`."""

    def assistant(options=None, **parts):
        return Assistant(chair, regions, options, **parts)

    def drive_chair(driver, points, *, assistant, **rest):
        return drive(chair, assistant, points, driver, **rest)

    return SimpleNamespace(
        assistant=assistant, drive=drive_chair, outlines=outlines, box=box, gap=gap
    )


def outlines(*polygons, step=0.03):
    """Return points along polygons, at most `step` apart."""
    rows = []
    for polygon in polygons:
        corners = np.asarray(polygon, dtype=float)
        for start, end in zip(corners, np.roll(corners, -1, axis=0), strict=True):
            count = max(1, math.ceil(np.hypot(*(end - start)) / step))
            rows.append(start + (end - start) * np.arange(count)[:, None] / count)
    return np.concatenate(rows) if rows else np.zeros((0, 2))


def box(x_from, x_to, y_from, y_to):
    return [[x_from, y_from], [x_to, y_from], [x_to, y_to], [x_from, y_to]]


def gap(vehicle, pose, points):
    """Return the least distance of points from the true body, negative inside."""
    if not len(points):
        return math.inf
    outline = vehicle.outline
    normals = edge_normals(outline)
    limits = np.einsum("kd,kd->k", normals, outline)
    return float((transform(invert(pose), points) @ normals.T - limits).max(axis=1).min())


@dataclass
class Drive:
    """What happened on a drive, a row each control period."""

    gap: float = math.inf
    asked: list = field(default_factory=list)
    taken: list = field(default_factory=list)
    signals: list = field(default_factory=list)
    poses: list = field(default_factory=list)

    def arrays(self):
        full = np.array([row["full_braking"] for row in self.signals]) > 0.0
        return np.array(self.asked), np.array(self.taken), full


def drive(vehicle, assistant, points, driver, *, seconds, start=(0.0, 0.0, 0.0), **settings):
    """Drive with the true plant among points the chair is told of exactly.

    `driver(time, pose)` returns [v, omega]; `percept(time, points in the body frame)` may spoil
    what is perceived; `plant` are its options; `door(pose)` a sensed door.
    """
    options = settings.get("plant", PlantOptions())
    percept = settings.get("percept", lambda time, rows: Percept(time, rows, 0.015))
    plant = Plant(vehicle, start, options, np.random.default_rng(0))
    result = Drive()
    for k in range(round(seconds / 0.02)):
        time = 0.02 * k
        pose = plant.pose
        seen = points[np.hypot(points[:, 0] - pose[0], points[:, 1] - pose[1]) < 2.5]
        near = transform(invert(pose), seen) if len(seen) else np.zeros((0, 2))
        rows = np.column_stack([near, np.full(len(near), 0.12)])
        left, right = plant.wheel_speeds
        motion = [0.5 * (left + right), (right - left) / vehicle.track]
        extra = {"door": settings["door"](pose)} if "door" in settings else {}
        asked = driver(time, pose)
        taken = assistant.step(time, asked, motion, percept(time, rows), **extra)
        for name, value in (("asked", asked), ("taken", taken), ("poses", pose)):
            getattr(result, name).append(value)
        result.signals.append(dict(assistant.signals))
        plant.command(*taken)
        for _ in range(2):
            plant.step(0.01)
            result.gap = min(result.gap, gap(vehicle, plant.pose, seen))
    return result
