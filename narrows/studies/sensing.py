"""What simulated and real sensors show: a frame, its cloud by stages, the map while driving."""

from __future__ import annotations

import math
import os
import time
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..perception.cloud import run_chain
from ..perception.depth_image import depth_frame
from ..perception.obstacle_map import ObstacleMap
from ..perception.obstacles import ObstacleFinder
from ..perception.ranges import LaserScan
from ..scene import Scene
from ..se2 import Array, transform
from ..simulation.chair_senses import two_lasers
from ..simulation.depth_sensor import DepthSensor, kinect
from ..simulation.laser import front_and_rear
from ..simulation.surfaces import SensedWorld
from ..trajectory import Trajectory
from .perception import plane_is_floor
from .perception_frames import Frame, frame_names, load_frame
from .report import markdown_table
from .sensing_drive import MOUNTED, Moment, against_truth, bands_of, drive, finder_of, living_room

SUMMARY = (
    "simulated sensors: a depth frame and its cloud, the obstacle map while driving; real frames"
)

_TIMES = (0.4, 3.0, 6.0)  # s
_VIEWED = 1.0  # s: the frame that is shown
CAUSES = ("a return", "too near", "too far", "edge", "shadow of the projector", "grazing")
_ROUNDS = 25


def run(out: Path, *, jobs: int, resume: bool, seed: int, data: str | None = None) -> str:
    """Run the study into a folder and return its report.

    Writes `frame.png`, `cloud.png` and `map.png`, and a cloud and a map of every real frame.

    Args:
        out: Folder.
        jobs: Not used: there is one drive.
        resume: Not used: it is driven anew.
        seed: Of the sensors.
        data: Folder of real frames, or one with a folder `kinect` of them; by default
            `$NARROWS_DATA` if it has that folder, otherwise none.

    Raises:
        StudyError: If the folder cannot be read.
    """
    given = os.environ.get("NARROWS_DATA")
    if data is None and given is not None and (Path(given) / "kinect").is_dir():
        data = given
    scene = living_room()
    moments, driven = drive(scene, seed, sorted((*_TIMES, _VIEWED)))
    viewed = next(moment for moment in moments if moment.time >= _VIEWED)
    shares = _draw_frame(out, scene, viewed.pose, viewed.time, seed)
    shown = [moment for moment in moments if moment is not viewed]
    _draw_map(out, scene, shown, driven)
    rows = [
        {"time": f"{moment.time:.1f}", **against_truth(scene, moment), "points": moment.points}
        for moment in shown
    ]
    parts = [
        "# What sensors show",
        f"Two laser scanners and a depth camera drive {driven.path.length:.1f} m through a room.",
        "![the frame](frame.png)",
        markdown_table(shares, {"cause": "", "share": "share of the frame [%]"}, {"share": ".2f"}),
        "![its cloud](cloud.png)",
        "![the map](map.png)",
        markdown_table(rows, _COLUMNS, {}),
        "## Processor time, medians on one core",
        markdown_table(_costs(scene), {"what": "", "ms": "[ms]"}, {"ms": ".3f"}),
    ]
    if data is not None:
        parts += ["## Real frames", *_real(out, Path(data))]
    return "\n\n".join(parts) + "\n"


_COLUMNS = {
    "time": "time [s]",
    "occupied": "occupied cells",
    "free": "free cells",
    "ghosts": "occupied, nothing within 5 cm",
    "missed": "free, inside what stands there",
    "points": "points of the percept",
}


def why_missing(
    sensor: DepthSensor, world: SensedWorld, pose: Array, when: float
) -> NDArray[np.uint8]:
    """Return the index into `CAUSES` for each pixel: the first cause that alone takes it away.

    Args:
        sensor: The camera, its manners.
        world: What there is.
        pose: True pose of the chair, shape (3,).
        when: Time [s].
    """
    manners = sensor.manners
    nothing = replace(manners, nearest=1e-3, edge=1e9, baseline=0.0, incidence=0.5 * math.pi)
    far = replace(sensor.camera, furthest=1e3)
    alone = (
        DepthSensor(far, replace(nothing, nearest=manners.nearest)),
        DepthSensor(sensor.camera, nothing),
        DepthSensor(far, replace(nothing, edge=manners.edge)),
        DepthSensor(far, replace(nothing, baseline=manners.baseline)),
        DepthSensor(far, replace(nothing, incidence=manners.incidence)),
    )
    why = np.zeros(
        (sensor.camera.intrinsics.height, sensor.camera.intrinsics.width), dtype=np.uint8
    )
    missing = sensor.measure(world, pose, when) == 0
    for index, one in enumerate(alone, start=1):
        why[missing & (why == 0) & (one.measure(world, pose, when) == 0)] = index
    return why


def _draw_frame(
    out: Path, scene: Scene, pose: Array, when: float, seed: int
) -> list[dict[str, Any]]:
    """Draw a frame and its cloud; return what share of it is missing for what."""
    from ..viewer.pictures import save_picture
    from ..viewer.sensing_pictures import camera_figure

    world, sensor = SensedWorld(scene.world), DepthSensor(kinect(MOUNTED))
    image = sensor.measure(world, pose, when, rng=np.random.default_rng(seed))
    with np.errstate(divide="ignore"):
        depth = 1.0 / sensor.inverse_depth(world, pose, when)
    why = why_missing(sensor, world, pose, when)
    title = f"The camera before the table, {when:.1f} s into the drive"
    save_picture(camera_figure(title, depth, image, why, CAUSES), out / "frame.png")
    frame = Frame("What becomes of that frame", image, sensor.camera)
    _draw_cloud(out / "cloud.png", frame, finder_of(frame.camera))
    return [
        {"cause": cause, "share": 100.0 * float((why == index).mean())}
        for index, cause in enumerate(CAUSES)
    ]


def _draw_cloud(file: Path, frame: Frame, finder: ObstacleFinder) -> None:
    from ..viewer.perception_pictures import frame_figure
    from ..viewer.pictures import save_picture

    stages = run_chain(frame.depth, frame.camera.intrinsics)
    image = depth_frame(frame.depth, frame.camera.intrinsics)
    seen = finder.see(frame.depth)
    is_floor = plane_is_floor(frame, stages)
    save_picture(frame_figure(frame.name, image, stages, is_floor, seen), file)


def _draw_map(out: Path, scene: Scene, moments: list[Moment], driven: Trajectory) -> None:
    from ..viewer.pictures import save_picture
    from ..viewer.sensing_pictures import MapView, map_figure

    views = [
        MapView(
            f"{moment.time:.1f} s",
            moment.bands,
            moment.edges,
            moment.extent,
            moment.pose,
            moment.time,
            _seen(moment, driven),
        )
        for moment in moments
    ]
    figure = map_figure(
        "The obstacle map while driving past a table: two lasers at 0.12 m and a depth camera",
        views,
        scene.vehicle,
        scene=scene,
        camera=kinect(MOUNTED),
        view=(-0.2, -0.2, 6.2, 4.6),
    )
    save_picture(figure, out / "map.png")


def _seen(moment: Moment, driven: Trajectory) -> tuple[Array, ...]:
    """Return what each laser saw last in the world, from where the chair was then, (N, 2) each."""
    scans = [answer for answer in moment.answers.values() if isinstance(answer, LaserScan)]
    return tuple(transform(driven(scan.time), scan.points[:, :2]) for scan in scans)


def _real(out: Path, data: Path) -> list[str]:
    """Draw cloud and map of every real frame; return the Markdown that shows them."""
    from ..viewer.pictures import save_picture
    from ..viewer.sensing_pictures import MapView, map_figure

    folder = data / "kinect" if (data / "kinect").is_dir() else data
    parts = []
    for name in frame_names(folder):
        frame = load_frame(name, folder)
        finder, known = ObstacleFinder(frame.camera), ObstacleMap()
        _draw_cloud(out / f"real-{name}-cloud.png", frame, finder)
        seen = finder.see(frame.depth)
        known.add_frame(frame.depth, seen, finder)
        bands, edges = bands_of(known)
        view = MapView(name, bands, edges, known.extent, np.zeros(3))
        title = f"The obstacle map after one real frame, {name}: {seen.sight.value}"
        figure = map_figure(title, [view], None, view=(-0.2, -2.0, 3.75, 2.0))
        save_picture(figure, out / f"real-{name}-map.png")
        parts += [f"![{name}](real-{name}-cloud.png)", f"![{name}](real-{name}-map.png)"]
    return parts


def _costs(scene: Scene) -> list[dict[str, Any]]:
    """Return what simulating costs in the room, in processor time."""
    world, pose, rng = SensedWorld(scene.world), scene.start, np.random.default_rng(0)
    sensor, (front, _) = DepthSensor(kinect(MOUNTED)), front_and_rear(scene.vehicle)
    senses, steps = two_lasers(scene), iter(range(10**6))

    def perceive() -> None:
        senses.perceive(0.02 * next(steps), pose, pose)

    calls: dict[str, Callable[[], object]] = {
        "exact inverse depths, 640 x 480": lambda: sensor.inverse_depth(world, pose),
        "a depth frame with noise": lambda: sensor.measure(world, pose, rng=rng),
        "a scan of 541 beams": lambda: front.measure(world, pose, rng=rng),
        "a percept by two lasers, a control step": perceive,
    }
    return [{"what": what, "ms": _cpu_ms(call)} for what, call in calls.items()]


def _cpu_ms(call: Callable[[], object]) -> float:
    """Return the median processor time of a call [ms], of rounds of ten, after one to warm up."""
    call()
    times = []
    for _ in range(_ROUNDS):
        begin = time.process_time_ns()
        for _ in range(10):
            call()
        times.append((time.process_time_ns() - begin) / 1e7)
    return float(np.median(times))
