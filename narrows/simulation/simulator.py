"""Drives a scene: senses, controller, localisation and plant, period by period, into a record."""

from __future__ import annotations

import math
from bisect import bisect_left
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import overload

import numpy as np

from ..errors import ShapeError
from ..interfaces import Controller, Tracker
from ..path import Path
from ..scene import Scene
from ..se2 import Array
from ..tracking.legs import Leg, legs_of
from ..trajectory import Trajectory
from .localisation import ExactPose, Localisation
from .plant import Plant, PlantOptions
from .record import Record
from .senses import Senses

_REACH = 0.3  # m: how far from the claimed progress the true foot is looked for
_STILL = 1e-3  # m/s: rim speed at which a finished drive ends
_LONGEST_STOP = 3.0  # s: a finished drive ends then at the latest


@dataclass(frozen=True)
class SimulationOptions:
    """How a drive is simulated.

    Attributes:
        plant: The chair's drive and its disturbances.
        localisation: What the chair believes about its pose.
        step: Physics step [s].
        period: Control period [s], a multiple of the step.
        time_limit: Time after which the drive is broken off [s].
    """

    plant: PlantOptions = field(default_factory=PlantOptions)
    localisation: Localisation = field(default_factory=ExactPose)
    step: float = 0.01
    period: float = 0.02
    time_limit: float = 300.0

    def __post_init__(self) -> None:
        """Check the times."""
        for name in ("step", "period", "time_limit"):
            value = getattr(self, name)
            if not (0.0 < value < math.inf):
                raise ShapeError(f"{name} must be a finite positive number [s], got {value}")
        ratio = self.period / self.step
        if abs(ratio - round(ratio)) > 1e-6 or round(ratio) < 1:
            raise ShapeError(f"period must be a multiple of step, got {self.period}, {self.step}")


@overload
def simulate(
    scene: Scene,
    driver: Tracker,
    *,
    senses: None = None,
    reference: Path | Trajectory | None = None,
    options: SimulationOptions | None = None,
    rng: np.random.Generator | None = None,
    report: Callable[[float], None] | None = None,
) -> Record: ...


@overload
def simulate(
    scene: Scene,
    driver: Controller,
    *,
    senses: Senses,
    reference: Path | Trajectory | None = None,
    options: SimulationOptions | None = None,
    rng: np.random.Generator | None = None,
    report: Callable[[float], None] | None = None,
) -> Record: ...


def simulate(
    scene: Scene,
    driver: Tracker | Controller,
    *,
    senses: Senses | None = None,
    reference: Path | Trajectory | None = None,
    options: SimulationOptions | None = None,
    rng: np.random.Generator | None = None,
    report: Callable[[float], None] | None = None,
) -> Record:
    """Return the record of a drive from the scene's start, until its driver has finished.

    The chair starts at rest. There is no contact dynamics: a chair that drives into a wall goes
    on, and `narrows.simulation.judge` says that it did.

    Args:
        scene: Chair and start.
        driver: Sends a command every period: a tracker by the pose it believes, a controller by
            what it perceives too.
        senses: What a controller perceives with, made for this drive; None: a tracker drives.
        reference: What is followed: true errors are measured to it; None: none are.
        options: Default `SimulationOptions()`.
        rng: Source of all disturbances of chair and localisation; default a generator of seed 0.
            Senses have their own.
        report: Called about every second of driving with the share of the reference done.

    Raises:
        ShapeError: If a controller's signals change their names.
    """
    options = SimulationOptions() if options is None else options
    rng = np.random.default_rng(0) if rng is None else rng
    path = reference.path if isinstance(reference, Trajectory) else reference
    pilot = _Pilot(driver, senses)
    rows = _drive(scene, pilot, options, rng, 0.0 if path is None else path.span, report)
    table = np.array(rows)
    poses, progress = table[:, 1:4], table[:, 11]
    if path is None:
        cross_track, heading_error = np.full((2, len(table)), math.nan)
    else:
        cross_track, heading_error = reference_errors(path, poses, progress)
    return Record(
        times=table[:, 0],
        poses=poses,
        estimates=table[:, 4:7],
        commands=table[:, 7:9],
        wheel_speeds=table[:, 9:11],
        progress=progress,
        cross_track=cross_track,
        heading_error=heading_error,
        signals=dict(zip(pilot.names, table[:, 12:].T, strict=True)),
    )


class _Pilot:
    """A tracker, or a controller with its senses: commands by the true and the believed pose."""

    def __init__(self, driver: Tracker | Controller, senses: Senses | None) -> None:
        self.driver = driver
        self.names: tuple[str, ...] = ()
        self.signals: tuple[float, ...] = ()
        self._senses = senses
        self._has_begun = False

    def step(self, time: float, true_pose: Array, believed_pose: Array) -> tuple[float, float]:
        """Return the command for the coming period; take down the signals."""
        if self._senses is None:
            command = self.driver.step(time, believed_pose)  # type: ignore[call-arg]
        else:
            percept = self._senses.perceive(time, true_pose, believed_pose)
            command = self.driver.step(time, believed_pose, percept)  # type: ignore[call-arg]
            self._take_down(self.driver.signals)  # type: ignore[union-attr]
        v, omega = command.tolist()
        return v, omega

    def _take_down(self, signals: Mapping[str, float]) -> None:
        if not self._has_begun:
            self.names, self._has_begun = tuple(signals), True
        if tuple(signals) != self.names:
            raise ShapeError(f"signals must keep their names {self.names}, got {tuple(signals)}")
        self.signals = tuple(signals.values())


def _drive(
    scene: Scene,
    pilot: _Pilot,
    options: SimulationOptions,
    rng: np.random.Generator,
    span: float,
    report: Callable[[float], None] | None,
) -> list[tuple[float, ...]]:
    """Return a row for each physics step."""
    plant = Plant(scene.vehicle, scene.start, options.plant, rng)
    estimator = options.localisation.start(scene.vehicle, options.plant, scene.start, rng)
    driver = pilot.driver
    every = round(options.period / options.step)
    each_second = max(1, round(1.0 / options.step))
    rows: list[tuple[float, ...]] = []
    believed, command = (0.0, 0.0, 0.0), (0.0, 0.0)
    finished_at = math.inf
    for k in range(int(options.time_limit / options.step) + 1):
        time = k * options.step
        if k % every == 0:
            estimate = estimator.estimate(plant, options.period)
            command = pilot.step(time, plant.pose, estimate)
            believed = tuple(estimate.tolist())
            plant.command(*command)
            if driver.finished:
                finished_at = min(finished_at, time)
        own = (*believed, *command, *plant.wheel_speeds, driver.progress)
        rows.append((time, *plant.pose.tolist(), *own, *pilot.signals))
        since = time - finished_at
        still = max(map(abs, plant.wheel_speeds)) < _STILL
        if (since > options.plant.latency and still) or since > _LONGEST_STOP:
            break
        if report is not None and k % each_second == 0:
            report(min(driver.progress / span, 1.0) if span else time / options.time_limit)
        plant.step(options.step)
    if report is not None:
        report(1.0)
    return rows


def reference_errors(path: Path, poses: Array, progress: Array) -> tuple[Array, Array]:
    """Return cross-track and heading errors of true poses; signs as in `Record`.

    Measured to the leg the claimed progress lies on, near that progress, so that another branch
    of the path does not count as near.

    Args:
        path: The reference.
        poses: True poses, shape (N, 3), [m, m, rad].
        progress: Progress claimed at each, shape (N,).
    """
    legs = legs_of(path)
    ends = [leg.end for leg in legs]
    errors = np.empty((len(poses), 2))
    pairs = zip(poses.tolist(), progress.tolist(), strict=True)
    for row, ((x, y, heading), claimed) in enumerate(pairs):
        leg = legs[min(bisect_left(ends, claimed - 1e-9), len(legs) - 1)]
        errors[row] = _errors(leg, x, y, heading, claimed)
    return errors[:, 0], errors[:, 1]


def _errors(leg: Leg, x: float, y: float, heading: float, near: float) -> tuple[float, float]:
    if leg.direction == 0:
        spot_x, spot_y, first = leg.pose(leg.start)
        low, high = min(0.0, leg.turn), max(0.0, leg.turn)
        middle = first + 0.5 * (low + high)
        turned = math.remainder(heading - middle, 2.0 * math.pi) + middle - first
        return math.hypot(x - spot_x, y - spot_y), min(max(turned, low), high) - turned
    foot = leg.project(x, y, near=near, reach=_REACH)
    off = math.remainder(leg.heading(foot.progress) - heading, 2.0 * math.pi)
    return -foot.offset, off
