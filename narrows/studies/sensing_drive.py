"""A drive through a furnished room with lasers and a depth camera, and what the map knew of it."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from importlib import resources
from typing import Any

import numpy as np
import shapely
from numpy.typing import ArrayLike, NDArray

from ..errors import StudyError
from ..interfaces import Percept, Tracker
from ..perception.camera import DepthCamera, Mounting
from ..perception.map_options import MapOptions
from ..perception.obstacle_map import ObstacleMap
from ..perception.obstacles import ObstacleFinder
from ..perception.surroundings import Cell, Grid
from ..scene import Scene, read_scene
from ..se2 import Array
from ..simulation.chair_senses import ChairSenses
from ..simulation.depth_sensor import DepthSensor, kinect
from ..simulation.fitted_sensors import FittedCamera, FittedLaser, Schedule
from ..simulation.laser import front_and_rear
from ..simulation.localisation import EncoderOdometry
from ..simulation.simulator import SimulationOptions, simulate
from ..tracking.registry import make_tracker
from ..trajectory import Trajectory

MOUNTED = Mounting(height=1.0, tilt=math.radians(28.0), x=0.4)
"""Where the camera sits: beside an arm rest, looking down ahead."""


@dataclass(frozen=True, eq=False)
class Moment:
    """What was known at a moment of the drive.

    Attributes:
        time: When [s].
        pose: True pose, shape (3,), [m, m, rad].
        bands: Values of `Cell` for each band of the map, shape (K, n, n), x first.
        edges: Heights between the bands, shape (K + 1,), [m].
        extent: x_min, x_max, y_min, y_max of the map in the world [m].
        answers: What each sensor said last, by its name.
        points: Number of points of the percept.
    """

    time: float
    pose: Array
    bands: NDArray[np.uint8]
    edges: Array
    extent: tuple[float, float, float, float]
    answers: Mapping[str, Any]
    points: int


def living_room() -> Scene:
    """Return the room of the study."""
    file = resources.files("narrows") / "studies" / "living_room.yaml"
    return read_scene(file.read_text(encoding="utf-8"), file=str(file))


def finder_of(camera: DepthCamera) -> ObstacleFinder:
    """Return the fast route for a camera; its grid begins ahead of the foot rests."""
    return ObstacleFinder(camera, Grid(x_from=0.9, x_to=4.4))


def bands_of(known: ObstacleMap) -> tuple[NDArray[np.uint8], Array]:
    """Return what a map knows in each of its bands, shape (K, n, n), and their edges (K + 1,)."""
    edges = np.array(known.options.bands)
    inner = 1e-6  # m: the band itself and not its neighbours
    pairs = zip(edges[:-1] + inner, edges[1:] - inner, strict=True)
    return np.array([known.states((low, high)) for low, high in pairs]), edges


def drive(scene: Scene, seed: int, times: ArrayLike) -> tuple[list[Moment], Trajectory]:
    """Drive a plan through a scene by odometry, sensing, and return what was known at some times.

    Args:
        scene: The scene.
        seed: Of all sensors.
        times: Moments [s], increasing; those beyond the drive's end are left out.

    Raises:
        StudyError: If there is no plan.
    """
    from ..planners import plan

    planned = plan(scene)
    if planned.trajectory is None:
        raise StudyError("the scene has no plan", value=scene.name, allowed=planned.reason)
    lasers = [FittedLaser(scanner) for scanner in front_and_rear(scene.vehicle)]
    sensor = DepthSensor(kinect(MOUNTED))
    camera = FittedCamera(sensor, finder_of(sensor.camera), Schedule(rate=30.0, latency=0.06))
    senses = ChairSenses(
        scene,
        [*lasers, camera],
        options=MapOptions(side=6.0),
        rng=np.random.default_rng(seed),
    )
    tracker = make_tracker("lookahead", planned.trajectory, scene.vehicle)
    watched = _Watched(tracker, senses, np.asarray(times, dtype=float))
    options = SimulationOptions(localisation=EncoderOdometry())
    record = simulate(
        scene,
        watched,
        senses=_Shared(senses, watched),
        reference=planned.trajectory,
        options=options,
    )
    return watched.moments, Trajectory.from_samples(record.times, record.poses)


class _Shared:
    """The senses, telling the watcher where the chair truly is."""

    def __init__(self, senses: ChairSenses, watched: _Watched) -> None:
        self._senses = senses
        self._watched = watched

    def perceive(self, time: float, true_pose: Array, believed_pose: Array) -> Percept:
        self._watched.true_pose = true_pose
        return self._senses.perceive(time, true_pose, believed_pose)


class _Watched:
    """A controller that follows a tracker, and keeps what the map knows at some moments."""

    def __init__(self, tracker: Tracker, senses: ChairSenses, times: Array) -> None:
        self.moments: list[Moment] = []
        self.true_pose = np.zeros(3)
        self.signals: dict[str, float] = {}
        self._tracker = tracker
        self._senses = senses
        self._times = times

    @property
    def progress(self) -> float:
        return self._tracker.progress

    @property
    def finished(self) -> bool:
        return self._tracker.finished

    def step(self, time: float, pose: ArrayLike, percept: Percept) -> Array:
        self.signals = {"points": float(len(percept.points)), "age": time - percept.time}
        taken = len(self.moments)
        if taken < len(self._times) and time >= self._times[taken] - 1e-9:
            known = self._senses.map
            self.moments.append(
                Moment(
                    time,
                    self.true_pose,
                    *bands_of(known),
                    known.extent,
                    dict(self._senses.answers),
                    len(percept.points),
                )
            )
        return self._tracker.step(time, pose)


def against_truth(scene: Scene, moment: Moment) -> dict[str, int]:
    """Return how the map of a moment compares with the world, in cells of all bands.

    Returns:
        `occupied` and `free`: cells the map says so of; `ghosts`: occupied further than two cells
        from anything that reaches into the band; `missed`: free, more than a cell inside a solid
        that stands there and fills the band.
    """
    x_min, x_max, y_min, _ = moment.extent
    count = moment.bands.shape[1]
    cell = (x_max - x_min) / count
    x = x_min + (np.arange(count) + 0.5) * cell
    y = y_min + (np.arange(count) + 0.5) * cell
    centres = shapely.points(*(grid.ravel() for grid in np.meshgrid(x, y, indexing="ij")))
    total = {"occupied": 0, "free": 0, "ghosts": 0, "missed": 0}
    for band, low, high in zip(moment.bands, moment.edges, moment.edges[1:], strict=False):
        occupied, free = (band == kind for kind in (Cell.OBSTACLE, Cell.FREE))
        total["occupied"] += int(occupied.sum())
        total["free"] += int(free.sum())
        reaching = _areas(scene, moment.time, low, high)
        far = shapely.distance(reaching, centres[occupied.ravel()])
        total["ghosts"] += int((far > 2.0 * cell).sum())
        inner = shapely.union_all(
            [
                solid.shape.buffer(solid.radius - cell)
                for solid in scene.world.solids
                if solid.z[0] <= low and solid.z[1] >= high
            ]
        )
        total["missed"] += int(shapely.intersects(inner, centres[free.ravel()]).sum())
    return total


def _areas(
    scene: Scene, time: float, low: float, high: float
) -> shapely.geometry.base.BaseGeometry:
    """Return the area of all that reaches into a band, somebody at a time too."""
    found = [
        solid.shape.buffer(solid.radius) if solid.radius else solid.shape
        for solid in scene.world.solids
        if solid.z[0] < high and solid.z[1] > low
    ]
    for solid in scene.world.moving:
        if solid.z[0] < high and solid.z[1] > low:
            found.append(shapely.Point(solid.position(time)).buffer(solid.radius))
    return shapely.union_all(found)
