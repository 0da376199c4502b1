"""How long the obstacle map and the search for openings take on a simulated drive."""

from __future__ import annotations

import math
import time
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

from ..perception.camera import Mounting
from ..perception.map_scan import scan_of_map
from ..perception.obstacle_map import ObstacleMap
from ..perception.obstacles import ObstacleFinder
from ..perception.openings import find_corridor, find_doors
from ..se2 import Array
from ..simulation.depth_sensor import DepthSensor, kinect
from ..simulation.laser import front_and_rear
from ..simulation.surfaces import SensedWorld
from ..vehicle import Vehicle
from ..world import Solid, World

_PERIOD = 0.08  # s between scans
_WARM = 5  # steps that compile and fill the map


def cpu_ms(function: Callable[[], object], rounds: int) -> float:
    """Return the median processor time of a call [ms], after one to warm up."""
    function()
    times = []
    for _ in range(rounds):
        begin = time.process_time_ns()
        function()
        times.append((time.process_time_ns() - begin) / 1e6)
    return float(np.median(times))


@dataclass(frozen=True, eq=False)
class Drive:
    """Places of a drive and what the lasers see.

    Attributes:
        world: A corridor with a door and a table in the room behind it.
        vehicle: The chair.
        poses: Where it is at each step, shape (N, 3).
    """

    world: World
    vehicle: Vehicle
    poses: Array


def drive_through_a_door(steps: int = 60) -> Drive:
    """Return a drive along a corridor, past a door of 0.9 m."""
    boxes: list[tuple[float, float, float, float]]
    boxes = [(-2, -0.1, 6, 0), (-2, 1.6, 2, 1.7), (2.9, 1.6, 6, 1.7), (0, 5, 5, 5.1)]
    boxes += [(0, 1.7, 0.1, 5), (5, 1.7, 5.1, 5), (6, -0.1, 6.1, 1.7), (-2.1, -0.1, -2, 1.7)]
    walls = [Solid.polygon([[a, b], [c, b], [c, d], [a, d]]) for a, b, c, d in boxes]
    legs = [Solid.circle(x, y, 0.03, z=(0.0, 0.7)) for x in (2.0, 3.2) for y in (3.2, 4.0)]
    x = np.linspace(-1.0, 2.0, steps)
    poses = np.column_stack([x, 0.8 + 0.1 * np.sin(x), 0.1 * np.cos(x)])
    return Drive(World((*walls, *legs)), Vehicle.rectangle(1.0, 0.65, 0.25), poses)


def measure_map_and_openings(rng: np.random.Generator) -> dict[str, Any]:
    """Return median processor times of a step of each kind [ms], and the doors that were found."""
    drive = drive_through_a_door()
    sensed = SensedWorld(drive.world)
    scanners = front_and_rear(drive.vehicle)
    chart = ObstacleMap(vehicle=drive.vehicle, pose=drive.poses[0])
    camera = DepthSensor(kinect(Mounting(1.0, math.radians(20.0), drive.vehicle.front_overhang)))
    finder = ObstacleFinder(camera.camera)
    spent: dict[str, list[float]] = {}

    def timed(name: str, function: Callable[..., Any], *given: Any) -> Any:
        begin = time.process_time_ns()
        result = function(*given)
        spent.setdefault(name, []).append((time.process_time_ns() - begin) / 1e6)
        return result

    widths: list[float] = []
    for step, pose in enumerate(drive.poses):
        timed("move_ms", chart.move_to, pose)
        for scanner in scanners:
            scan = scanner.measure(sensed, pose, step * _PERIOD, rng=rng)
            timed("scan_ms", chart.add_scan, scan)
            doors = timed("doors_ms", find_doors, scan)
            timed("corridor_ms", find_corridor, scan)
            widths += [door.width for door in doors if abs(door.width - 0.9) < 0.2]
        frame = camera.measure(sensed, pose, step * _PERIOD, rng=rng)
        timed("frame_ms", chart.add_frame, frame, finder.see(frame, step * _PERIOD), finder)
        timed("percept_ms", chart.percept)
        timed("map_doors_ms", lambda: find_doors(scan_of_map(chart)))
    values: dict[str, Any] = {
        name: float(np.median(times[_WARM:])) for name, times in spent.items()
    }
    values |= {"seen_doors": len(widths), "mean_width_m": float(np.mean(widths))}
    return values
