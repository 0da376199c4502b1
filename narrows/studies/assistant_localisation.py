"""The map of the course and where the drives were in it, as the paper found them out."""

from __future__ import annotations

from collections.abc import Mapping
from functools import cache
from pathlib import Path

import numpy as np
import shapely

from ..perception.ranges import LaserScan
from ..se2 import Array
from ..simulation.assisted_chair import PERIOD
from ..simulation.grid_mapping import GridMap, GridMapper
from ..simulation.laser import LaserManners, LaserScanner, front_and_rear
from ..simulation.particle_filter import ParticleFilter
from ..simulation.record import Record
from ..simulation.surfaces import SensedWorld
from .assistant_course import BOUNDS, course_routes, course_scene
from .assistant_drives import Conditions, drive, regions_of
from .case import Case, Scalar

CELL = 0.02
"""Edge of a cell of the global map [m]: the paper's 2 cm."""

_MAPS, _TRACKS = 0.2, 0.2  # s between the scans that are used


def learn_map(file: Path, regions: str, seed: int) -> Path:
    """Learn the map of the course from one slow drive into a file; keep one that is there.

    Args:
        file: NumPy's .npz, with the map and how far it is wrong.
        regions: File of the safety regions.
        seed: Of the drive and the scans.
    """
    if file.is_file():
        return file
    rng = np.random.default_rng(seed)
    scene = course_scene()
    alone = Conditions(assisted=False)
    record, _ = drive(scene, "cautious", course_routes(), alone, regions_of(regions), rng)
    mapper = GridMapper(BOUNDS, scene.start, cell=CELL)
    rows = _rows(record, _MAPS)
    found = np.array([mapper.add(record.estimates[row], _scans(record, row, rng)) for row in rows])
    errors = np.hypot(*(found - record.poses[rows])[:, :2].T)
    drift = float(np.hypot(*(record.estimates[-1] - record.poses[-1])[:2]))
    walls = shapely.union_all([one.shape.buffer(one.radius) for one in scene.world.solids])
    off = shapely.distance(shapely.points(mapper.map.points), walls.boundary)
    np.savez_compressed(
        file,
        occupied=mapper.map.occupied,
        errors=errors,
        drift=drift,
        wall_error=np.quantile(off, [0.5, 0.95]),
    )
    return file


def read_map(file: Path | str) -> GridMap:
    """Return the map in a file of `learn_map`."""
    with np.load(file) as stored:
        return GridMap(stored["occupied"], np.array(BOUNDS[:2]), CELL)


def map_figures(file: Path) -> dict[str, float]:
    """Return how far a learned map is wrong, and the drive it was learned on."""
    with np.load(file) as stored:
        return {
            "pose_mean_mm": 1e3 * float(stored["errors"].mean()),
            "pose_max_mm": 1e3 * float(stored["errors"].max()),
            "drift_mm": 1e3 * float(stored["drift"]),
            "wall_median_mm": 1e3 * float(stored["wall_error"][0]),
            "wall_95_mm": 1e3 * float(stored["wall_error"][1]),
        }


def localised_case(
    case: Case, rng: np.random.Generator, regions: str, grid: str, tracks: str
) -> Mapping[str, Scalar]:
    """Drive the course and find the drive in the learned map; keep the track in a file.

    Args:
        case: `driver`, `device`, `assisted`.
        rng: Source of everything random.
        regions: File of the safety regions.
        grid: File of the map.
        tracks: Folder for the tracks.
    """
    scene = course_scene()
    conditions = Conditions(str(case["device"]), bool(case["assisted"]))
    of_drive, of_scans, of_filter = rng.spawn(3)
    name = str(case["driver"])
    record, driver = drive(scene, name, course_routes(), conditions, regions_of(regions), of_drive)
    tracker = ParticleFilter(read_map(grid), scene.start, of_filter)
    rows = _rows(record, _TRACKS)
    found = np.array(
        [
            tracker.step(record.estimates[row], _points(_scans(record, row, of_scans)))
            for row in rows
        ]
    )
    true = record.poses[rows]
    errors = np.hypot(*(found - true)[:, :2].T)
    turned = np.abs(np.remainder(found[:, 2] - true[:, 2] + np.pi, 2.0 * np.pi) - np.pi)
    drift = float(np.hypot(*(record.estimates[-1] - record.poses[-1])[:2]))
    np.savez_compressed(track_file(Path(tracks), case), found=found, true=true)
    return {
        "arrived": driver.finished,
        "mean_mm": 1e3 * float(errors.mean()),
        "p95_mm": 1e3 * float(np.quantile(errors, 0.95)),
        "max_mm": 1e3 * float(errors.max()),
        "heading_mean_deg": float(np.degrees(turned.mean())),
        "heading_max_deg": float(np.degrees(turned.max())),
        "odometry_mm": 1e3 * drift,
    }


def track_file(folder: Path, case: Mapping[str, Scalar]) -> Path:
    """Return where the track of a drive is kept."""
    help_given = "assisted" if case["assisted"] else "alone"
    return folder / f"{case['driver']}-{case['device']}-{help_given}.npz"


def _rows(record: Record, every: float) -> list[int]:
    """Return the rows of a record at which scans are used, on control steps."""
    steps = round(every / PERIOD) * round(PERIOD / float(record.times[1] - record.times[0]))
    return list(range(0, len(record.times), steps))


@cache
def _eyes() -> tuple[SensedWorld, tuple[LaserScanner, LaserScanner]]:
    """Return the course as scanners see it, and the scanners."""
    scene = course_scene()
    manners = LaserManners(beams=271, noise=0.005)
    return SensedWorld(scene.world), front_and_rear(scene.vehicle, manners=manners)


def _scans(record: Record, row: int, rng: np.random.Generator) -> list[LaserScan]:
    """Return what both scanners measured at a row."""
    world, scanners = _eyes()
    pose, time = record.poses[row], float(record.times[row])
    return [scanner.measure(world, pose, time, rng=rng) for scanner in scanners]


def _points(scans: list[LaserScan]) -> Array:
    return np.concatenate([scan.points[:, :2] for scan in scans])
