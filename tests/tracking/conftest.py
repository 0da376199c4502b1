"""Drives of an ideal chair, and paths every tracker must follow."""

import math
from dataclasses import dataclass

import numpy as np
import pytest

from narrows.bezier_section import BezierSection
from narrows.path import Path
from narrows.se2 import compose
from narrows.simulation.plant import Plant, PlantOptions
from narrows.simulation.simulator import reference_errors
from narrows.vehicle import Limits, Vehicle

AGILE = Vehicle.rectangle(
    1.0, 0.7, 0.25, limits=Limits(yaw_rate=3.0, yaw_acceleration=20.0, lateral_acceleration=5.0)
)


@dataclass
class Drive:
    """A drive of a chair that obeys at once, unless told otherwise, in 20 ms periods."""

    poses: np.ndarray
    commands: np.ndarray
    progress: np.ndarray
    across: np.ndarray
    finished: bool


def drive_ideally(tracker, start, path=None, *, plant=None, most=60.0, period=0.02):
    plant = PlantOptions(motor_lag=0.0, wheel_acceleration=1e3) if plant is None else plant
    chair = Plant(AGILE, start, plant, np.random.default_rng(0))
    poses, commands, progress = [chair.pose], [], []
    while chair.time < most and not tracker.finished:
        v, omega = tracker.step(chair.time, chair.pose)
        commands.append((v, omega))
        progress.append(tracker.progress)
        chair.command(v, omega)
        for _ in range(4):
            chair.step(period / 4)
        poses.append(chair.pose)
    for _ in range(200):  # what is still on its way, and the motors' answer to the last zero
        chair.step(period / 4)
    poses.append(chair.pose)
    poses, progress = np.array(poses), np.array(progress)
    across = np.zeros(1)
    if path is not None:
        across, _ = reference_errors(path, poses[:-2], progress)
    return Drive(poses, np.array(commands), progress, across, tracker.finished)


@pytest.fixture(scope="session")
def agile():
    """Return a chair whose limits do not matter at 0.4 m/s."""
    return AGILE


@pytest.fixture(scope="session")
def drive():
    """Return the function that drives a chair."""
    return drive_ideally


@pytest.fixture(scope="session")
def shunting():
    """Return forward, turn on the spot, in reverse on an arc, and forward again."""
    poses = [[0, 0, 0], [1.5, 0, 0], [1.5, 0, 1.0]]
    poses.append(compose(poses[-1], [-0.8, -0.3, 2 * math.atan2(0.3, 0.8)]).tolist())
    poses.append(compose(poses[-1], [1.0, 0.0, 0.0]).tolist())
    return Path.from_poses(poses)


@pytest.fixture(scope="session")
def winding():
    """Return an S of two cubics, forward, and the same in reverse."""
    control = np.array(
        [
            [[0.0, 0.0], [0.7, 0.0], [0.9, 0.8], [1.5, 0.8]],
            [[1.5, 0.8], [2.1, 0.8], [2.0, 0.0], [2.8, -0.2]],
        ]
    )
    return tuple(Path((BezierSection(control, direction),)) for direction in (1, -1))
