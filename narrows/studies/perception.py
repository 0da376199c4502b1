"""What the paper's chain and the fast route make of depth frames, and how long they take."""

from __future__ import annotations

import math
import os
from collections.abc import Sequence
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np

from ..perception.cloud import CloudStages, run_chain
from ..perception.depth_image import depth_frame
from ..perception.floor import FloorPrior, is_floor
from ..perception.obstacle_map import ObstacleMap
from ..perception.obstacles import ObstacleFinder
from ..perception.surroundings import Surroundings
from .case import Case
from .perception_frames import Frame, frame_names, load_frame
from .perception_times import cpu_ms, measure_map_and_openings
from .report import markdown_table
from .sweep import sweep
from .table import Row

SUMMARY = "depth frames to obstacles: the chain of [FuzzyDVZ], the fast route, counts and times"

_ROUNDS = 15
_STEPS = {
    "move_ms": "move the map [ms]",
    "scan_ms": "a scan into it [ms]",
    "frame_ms": "a depth frame into it [ms]",
    "percept_ms": "read it [ms]",
    "doors_ms": "doors in a scan [ms]",
    "corridor_ms": "corridor [ms]",
    "map_doors_ms": "doors in the map [ms]",
}
_STAGES = ("removeNaN", "voxel", "pass", "ransac", "extract", "cluster")


def run(out: Path, *, jobs: int, resume: bool, seed: int, data: Path | str | None = None) -> str:
    """Run the study into a folder and return its report.

    Writes `frames.csv` and a picture of every frame.

    Args:
        out: Folder.
        jobs: Worker processes; times are for one.
        resume: Keep the frames done before.
        seed: Kept in the table; the samples in the search for a plane have their own.
        data: Folder of real frames with `intrinsics.json` and, if there is one,
            `pcl_reference.json`, or one that holds it as `kinect`; by default `$NARROWS_DATA` if
            that is set, otherwise simulated frames.

    Raises:
        StudyError: If the folder cannot be read.
    """
    source = _folder(data if data is not None else os.environ.get("NARROWS_DATA"))
    origin = "simulated" if source is None else str(source)
    cases = [{"frame": name, "source": origin} for name in frame_names(source)]
    table = sweep(
        cases,
        partial(run_frame, folder=source),
        table=out / "frames.sqlite",
        keys=("frame", "source"),
        jobs=jobs,
        resume=resume,
        seed=seed,
    )
    table.write_csv(out / "frames.csv", with_runs=False)
    rows = table.done.rows
    for row in rows:
        _draw(out, load_frame(str(row["frame"]), source))
    failed = [f"{row['frame']}: {row['reason']}" for row in table.failed.rows]
    steps = measure_map_and_openings(np.random.default_rng(seed))
    return _report(rows, steps, source, failed)


def _folder(given: Path | str | None) -> Path | None:
    """Return the folder of the frames; None: simulated ones."""
    if given is None:
        return None
    inner = Path(given) / "kinect"
    return inner if inner.is_dir() else Path(given)


def run_frame(case: Case, rng: np.random.Generator, *, folder: Path | None) -> dict[str, Any]:
    """Run both routes on one frame and return counts, the plane, obstacles and times."""
    frame = load_frame(str(case["frame"]), folder)
    finder = ObstacleFinder(frame.camera)
    stages = run_chain(frame.depth, frame.camera.intrinsics)
    seen = finder.see(frame.depth)
    values: dict[str, Any] = dict(stages.counts)
    values |= _plane(frame, stages) | _surroundings(seen)
    values["chain_ms"] = cpu_ms(lambda: run_chain(frame.depth, frame.camera.intrinsics), _ROUNDS)
    values["fast_ms"] = cpu_ms(lambda: finder.see(frame.depth), _ROUNDS)
    chart = ObstacleMap()
    values["map_ms"] = cpu_ms(lambda: chart.add_frame(frame.depth, seen, finder), _ROUNDS)
    reference = frame.reference
    if reference:
        counts, times = reference["n"], reference["ms"]
        values |= {f"reference_{name}": counts[name] for name in ("voxel", "pass", "plane")}
        values["reference_clusters"] = len(reference["clusters"])
        values["reference_ms"] = sum(times[stage][0] for stage in _STAGES)
    else:
        values |= dict.fromkeys(
            [f"reference_{name}" for name in ("voxel", "pass", "plane", "clusters", "ms")]
        )
    return values


def _plane(frame: Frame, stages: CloudStages) -> dict[str, Any]:
    """Return what plane the chain removes, against the floor and against the reference's."""
    if stages.plane is None:
        return {"plane_is_floor": False, "plane_tilt_deg": None, "plane_off_deg": None}
    plane, mounting = stages.plane.plane, frame.camera.mounting
    values: dict[str, Any] = {
        "plane_is_floor": plane_is_floor(frame, stages),
        "plane_tilt_deg": math.degrees(plane.angle_to(mounting.up)),
        "plane_off_deg": None,
    }
    if frame.reference:
        normal = np.array(frame.reference["plane"][:3])
        values["plane_off_deg"] = math.degrees(plane.angle_to(normal / np.linalg.norm(normal)))
    return values


def plane_is_floor(frame: Frame, stages: CloudStages) -> bool:
    """Return whether the plane the chain removed can be the floor under the camera."""
    if stages.plane is None:
        return False
    plane = stages.plane.plane
    return is_floor(plane.normal, plane.offset, frame.camera.mounting, FloorPrior())


def _surroundings(seen: Surroundings) -> dict[str, Any]:
    nearest = seen.obstacles[0].distance if seen.obstacles else None
    floor = seen.floor
    return {
        "sight": seen.sight.name.lower().replace("_", " "),
        "obstacles": len(seen.obstacles),
        "drop_offs": len(seen.drop_offs),
        "nearest_m": nearest,
        "tilt_found_deg": None if floor is None else math.degrees(floor.mounting.tilt),
    }


def _draw(out: Path, frame: Frame) -> None:
    from ..viewer.perception_pictures import frame_figure
    from ..viewer.pictures import save_picture

    stages = run_chain(frame.depth, frame.camera.intrinsics)
    image = depth_frame(frame.depth, frame.camera.intrinsics)
    seen = ObstacleFinder(frame.camera).see(frame.depth)
    figure = frame_figure(frame.name, image, stages, plane_is_floor(frame, stages), seen)
    save_picture(figure, out / _picture(frame.name))


def _picture(name: str) -> str:
    return name.replace("'", "").replace(" ", "-") + ".png"


def _report(
    rows: Sequence[Row], steps: dict[str, Any], source: Path | None, failed: Sequence[str]
) -> str:
    counts = {
        "frame": "",
        "valid": "returns",
        "voxel": "voxels",
        "reference_voxel": "(reference)",
        "pass": "within 2 m",
        "reference_pass": "(reference) ",
        "plane": "on the plane",
        "reference_plane": "(reference)  ",
        "clusters": "clusters",
        "reference_clusters": "(reference)   ",
    }
    planes = {
        "frame": "",
        "plane_tilt_deg": "plane removed, off the vertical [deg]",
        "plane_is_floor": "is a floor",
        "plane_off_deg": "off the reference's [deg]",
        "sight": "fast route",
        "tilt_found_deg": "tilt found [deg]",
        "obstacles": "obstacles",
        "drop_offs": "drop-offs",
        "nearest_m": "nearest [m]",
    }
    times = {
        "frame": "",
        "chain_ms": "chain [ms]",
        "reference_ms": "reference library [ms]",
        "fast_ms": "fast route [ms]",
        "map_ms": "into the map, again and again [ms]",
    }
    plane_formats = {"plane_tilt_deg": ".1f", "plane_off_deg": ".2f", "tilt_found_deg": ".1f"}
    plane_formats["nearest_m"] = ".2f"
    time_formats = {"chain_ms": ".1f", "reference_ms": ".1f", "fast_ms": ".2f", "map_ms": ".2f"}
    wrong = [str(row["frame"]) for row in rows if not row["plane_is_floor"]]
    parts = [
        "# From depth frames to obstacles",
        f"Frames: {'simulated' if source is None else 'of ' + source.name}. Times are medians of "
        f"{_ROUNDS} calls, processor time on one core; the reference's were measured elsewhere.",
        "## The chain of [FuzzyDVZ, 3.2]",
        markdown_table(rows, counts, {}),
        "## The plane it removes, and what the fast route sees",
        markdown_table(rows, planes, plane_formats),
        _finding(wrong),
        "## Times",
        markdown_table(rows, times, time_formats),
        "## Obstacle map and openings",
        "Two laser scanners of 541 beams and a depth camera on a simulated drive past a door of "
        "0.90 m, found in "
        f"{steps['seen_doors']} scans, {steps['mean_width_m']:.3f} m wide on average. Medians, "
        "processor time on one core.",
        markdown_table([steps], _STEPS, dict.fromkeys(_STEPS, ".2f")),
        *(f"![{row['frame']}]({_picture(str(row['frame']))})" for row in rows),
    ]
    if failed:
        parts.append("## Failed frames\n\n" + "\n".join(failed))
    return "\n\n".join(parts) + "\n"


def _finding(wrong: Sequence[str]) -> str:
    if not wrong:
        return "In each of these frames the largest plane is the floor."
    return (
        f"In {', '.join(wrong)} the largest plane is **not a floor**: the chain takes an obstacle "
        "away before it looks for obstacles. The fast route refuses such planes."
    )
