"""One drive of the driving-assistant study: who drives with what, with assistance or without."""

from __future__ import annotations

import functools
import zlib
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from ..errors import StudyError
from ..perception.map_options import MapOptions
from ..reactive.assistant_options import AssistantOptions
from ..reactive.safety_regions import RegionOptions, SafetyRegions
from ..reactive.safety_regions_file import FORMAT
from ..reactive.smooth_motion import MotionLimits
from ..scene import Scene, load_vehicle
from ..simulation.assisted_chair import PERIOD, assisted_chair
from ..simulation.chair_senses import ChairSenses
from ..simulation.driver_hostile import HostileDriver
from ..simulation.driver_route import Route
from ..simulation.driver_sight import Sight
from ..simulation.driver_sticks import Stick, make_stick
from ..simulation.driver_traits import DRIVERS, by_head
from ..simulation.drivers import Driver, ScriptedDriver
from ..simulation.fitted_sensors import Faults, FittedLaser, Schedule
from ..simulation.judge import Judgement, judge
from ..simulation.laser import LaserManners, front_and_rear
from ..simulation.plant import PlantOptions
from ..simulation.record import Record
from ..simulation.simulator import simulate
from .assistant_course import course_routes, course_scene
from .case import Case, Scalar

DEVICES = ("joystick", "head-joystick")
"""Input devices, as in the paper."""

HOSTILE = "hostile"
"""Name of the driver who wants to hit something."""

PLANT = PlantOptions(slip=0.01, left_radius_error=0.002)
"""The chair of all drives: motors with a lag of 0.05 s, wheels that slip and differ a little."""

_HOSTILE_TIME = 40.0  # s: as long a hostile driver is let loose
_SIDE = 7.5  # m: of the map, as in [DrivingAssistant, Section III-A]
_CELL = 0.02  # m
_BANDS = (0.025, 0.3)  # m: the scanners' height lies in the one band there is


@dataclass(frozen=True)
class Conditions:
    """What a drive is like, besides its driver.

    Attributes:
        device: One of `DEVICES`.
        assisted: Whether the assistant assists.
        through_doors: Whether it also helps along certified paths through doors it senses.
        unknown_is_free: Whether it takes for free what nothing is known of, as the paper's does.
        options: Of the assistant.
        faults: Of both scanners.
        plant: The chair.
        time_limit: When a drive is given up [s].
    """

    device: str = "joystick"
    assisted: bool = True
    through_doors: bool = False
    unknown_is_free: bool = True
    options: AssistantOptions = field(default_factory=lambda: AssistantOptions(period=PERIOD))
    faults: Faults = field(default_factory=Faults)
    plant: PlantOptions = PLANT
    time_limit: float = 400.0


def region_options() -> RegionOptions:
    """Return what the safety regions of all drives allow for: a period, and the motors' lag."""
    return RegionOptions(latency=PERIOD + PLANT.motor_lag)


def prepare_regions(folder: Path) -> str:
    """Compute the Xeno's safety regions into a folder unless they are there; return the file."""
    options = region_options()
    file = folder / f"regions-{zlib.crc32(repr((FORMAT, options)).encode()):08x}.npz"
    if not file.is_file():
        SafetyRegions.compute(load_vehicle("xeno"), options).save(file)
    return str(file)


@functools.cache
def regions_of(file: str) -> SafetyRegions:
    """Return the safety regions in a file, checked against the Xeno."""
    return SafetyRegions.load(file, load_vehicle("xeno"))


def seat_driver(
    name: str,
    scene: Scene,
    routes: tuple[Route, ...],
    stick: Stick,
    rng: np.random.Generator,
    *,
    device: str = "joystick",
) -> Driver:
    """Return a driver by name, ready to drive.

    Args:
        name: One of `DRIVERS`, or `HOSTILE`.
        scene: Where they drive; they see its true world.
        routes: Their ways.
        stick: What they hold or wear.
        rng: Source of their errors.
        device: What that is.

    Raises:
        StudyError: If there is nobody of that name.
    """
    sight = Sight(scene.world)
    if name == HOSTILE:
        return HostileDriver(sight, rng)
    if name not in DRIVERS:
        raise StudyError("no such driver", value=name, allowed=", ".join((*DRIVERS, HOSTILE)))
    traits = DRIVERS[name]
    if device == "head-joystick":
        traits = by_head(traits)
    return ScriptedDriver(traits, routes, sight, stick, scene.vehicle, rng)


def drive(
    scene: Scene,
    name: str,
    routes: tuple[Route, ...],
    conditions: Conditions,
    regions: SafetyRegions,
    rng: np.random.Generator,
) -> tuple[Record, Driver]:
    """Return the record of a drive, its estimates odometry's, and the driver as they ended.

    Args:
        scene: Chair, start, world.
        name: Of the driver.
        routes: Their ways.
        conditions: What the drive is like.
        regions: The chair's safety regions.
        rng: Source of everything random.
    """
    of_driver, *of_chair = rng.spawn(3)
    stick = make_stick(conditions.device, MotionLimits.of(scene.vehicle))
    driver = seat_driver(name, scene, routes, stick, of_driver, device=conditions.device)
    return drive_with(scene, driver, conditions, regions, of_chair), driver


def drive_with(
    scene: Scene,
    driver: Driver,
    conditions: Conditions,
    regions: SafetyRegions,
    streams: Sequence[np.random.Generator],
) -> Record:
    """Return the record of a drive with anybody at the stick.

    Args:
        scene: Chair, start, world.
        driver: Who drives.
        conditions: What the drive is like.
        regions: The chair's safety regions.
        streams: Sources of what is random in the sensors and in the chair.
    """
    of_sensors, of_plant = streams
    assisted = conditions.assisted
    chair = assisted_chair(
        scene,
        driver,
        make_stick(conditions.device, MotionLimits.of(scene.vehicle)),
        scanners(scene, conditions.faults, of_sensors) if assisted else None,
        regions=regions if assisted else None,
        options=conditions.options,
        through_doors=conditions.through_doors,
        unknown_is_free=conditions.unknown_is_free,
        plant=conditions.plant,
        time_limit=conditions.time_limit,
    )
    return simulate(
        scene, chair.controller, senses=chair.senses, options=chair.options, rng=of_plant
    )


def scanners(scene: Scene, faults: Faults, rng: np.random.Generator) -> ChairSenses:
    """Return the Xeno's two scanners at work: front and rear, a beam a degree, 5 mm noise, 8 Hz."""
    schedule = Schedule(rate=8.0, latency=0.04, faults=faults)
    manners = LaserManners(beams=271, noise=0.005)
    fitted = [FittedLaser(one, schedule) for one in front_and_rear(scene.vehicle, manners=manners)]
    options = MapOptions(side=_SIDE, cell=_CELL, bands=_BANDS)
    return ChairSenses(scene, fitted, options=options, reach=0.5 * _SIDE, rng=rng)


def course_case(case: Case, rng: np.random.Generator, regions: str) -> Mapping[str, Scalar]:
    """Return the figures of one drive there and back.

    Args:
        case: `driver`, `device`, `assisted`.
        rng: Source of everything random.
        regions: File of the safety regions.
    """
    scene = course_scene()
    conditions = Conditions(
        str(case["device"]),
        bool(case["assisted"]),
        time_limit=_HOSTILE_TIME if case["driver"] == HOSTILE else 400.0,
    )
    name = str(case["driver"])
    record, driver = drive(scene, name, course_routes(), conditions, regions_of(regions), rng)
    verdict = judge(scene, record)
    return {
        **drive_figures(record, driver, verdict),
        "peak_jerk": verdict.peak_jerk,
        **_shares(record),
    }


def drive_figures(record: Record, driver: Driver, verdict: Judgement) -> dict[str, Scalar]:
    """Return what is asked of every drive."""
    first = verdict.collisions[0] if verdict.collisions else None
    return {
        "arrived": driver.finished,
        "collisions": len(verdict.collisions),
        "first_collision": first.reason if first else None,
        "time_s": record.duration,
        "distance_m": record.length,
        "min_clearance_mm": 1e3 * verdict.min_clearance,
    }


def _shares(record: Record) -> dict[str, Scalar]:
    """Return the share of the time the assistant was in each state; None without."""
    names = ("user", "braking", "avoiding", "restoring")
    state = record.signals.get("state")
    if state is None:
        return dict.fromkeys(f"share_{name}" for name in names)
    return {f"share_{name}": float(np.mean(state == k)) for k, name in enumerate(names)}
