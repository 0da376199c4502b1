"""A scene's chair with somebody in it and the assistant beside them, ready to drive."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from ..errors import InputError
from ..path import Path
from ..perception.map_options import MapOptions
from ..reactive.assistant import Assistant
from ..reactive.assistant_options import AssistantOptions
from ..reactive.door_blend import DoorBlend
from ..reactive.safety_regions import RegionOptions, SafetyRegions
from ..reactive.smooth_motion import MotionLimits, SmoothMotion
from ..scene import Scene
from ..vehicle import Vehicle
from .assisted_driving import AssistedDriving, Seat, UnknownIsFree
from .assisted_driving_doors import CertifiedDoorPaths, DoorSense
from .chair_senses import ChairSenses
from .driver_route import Route
from .driver_sight import Sight
from .driver_sticks import Stick, make_stick
from .driver_traits import DRIVERS
from .drivers import ARRIVED, Driver, ScriptedDriver
from .fitted_sensors import FittedLaser, Schedule
from .laser import LaserManners, front_and_rear
from .localisation import EncoderOdometry
from .plant import PlantOptions
from .senses import Senses
from .simulator import SimulationOptions

PERIOD = 0.05
"""Control period of the assistant [s]."""

_REACH = 3.75  # m, of the map about the chair, as in [DrivingAssistant, Section III-A]
_CELL = 0.02  # m
_BAND = (0.025, 0.3)  # m: the scanners' height lies in the one band there is
_LEG = 0.4  # m between the corners of a driver's way
_APART = 0.02  # m: corners nearer than that are one
_THERE = 0.3  # m from a corner: it is passed
_LONGEST = 90.0  # s: drives are broken off then


@dataclass(frozen=True, eq=False)
class AssistedChair:
    """All that `simulate` needs for a drive with a driver.

    Attributes:
        controller: Driver, stick and assistant.
        senses: What the driver sees and the chair's scanners.
        options: How the drive is simulated.
    """

    controller: AssistedDriving
    senses: Seat
    options: SimulationOptions


def compute_regions(
    vehicle: Vehicle, report: Callable[[float], None] | None = None
) -> SafetyRegions:
    """Return the safety regions of a chair as it is simulated; takes seconds."""
    options = RegionOptions(latency=PERIOD + PlantOptions().motor_lag)
    return SafetyRegions.compute(vehicle, options, report)


def scanners(scene: Scene) -> ChairSenses:
    """Return two laser scanners, front and rear, and the map of the one height they look along."""
    both = front_and_rear(scene.vehicle, manners=LaserManners(beams=271))
    fitted = [FittedLaser(one, Schedule()) for one in both]
    options = MapOptions(side=2.0 * _REACH, cell=_CELL, bands=_BAND)
    return ChairSenses(scene, fitted, options=options, reach=_REACH)


def hand_stick(vehicle: Vehicle) -> Stick:
    """Return a joystick that asks for what the chair's limits allow."""
    return make_stick("joystick", MotionLimits.of(vehicle))


def scripted_driver(
    scene: Scene, path: Path, name: str, stick: Stick, rng: np.random.Generator
) -> ScriptedDriver:
    """Return somebody who has the way of a path in mind.

    Args:
        scene: What they see.
        path: The way.
        name: One of `DRIVERS`.
        stick: What they hold.
        rng: Source of their errors.

    Raises:
        InputError: If there is nobody of that name.
    """
    if name not in DRIVERS:
        raise InputError(
            "there is no such driver", field="--driver", value=name, allowed=", ".join(DRIVERS)
        )
    count = max(2, math.ceil(path.length / _LEG) + 1)
    places = path(np.linspace(0.0, path.span, count))[:, :2]
    apart = np.hypot(*np.diff(places, axis=0).T) > _APART
    route = Route(places[np.concatenate([[True], apart])], _THERE)
    return ScriptedDriver(
        DRIVERS[name],
        (route,),
        Sight(scene.world),
        stick,
        scene.vehicle,
        rng,
        arrived=min(ARRIVED, 0.5 * scene.goal.position_tolerance),
    )


def assisted_chair(
    scene: Scene,
    driver: Driver,
    stick: Stick,
    sensors: ChairSenses | None,
    *,
    regions: SafetyRegions | None,
    senses: Senses | None = None,
    options: AssistantOptions | None = None,
    through_doors: bool = True,
    unknown_is_free: bool = True,
    plant: PlantOptions | None = None,
    time_limit: float = _LONGEST,
) -> AssistedChair:
    """Return the chair with its driver, with the assistant or with the limits of motion alone.

    Args:
        scene: Its chair.
        driver: Who drives.
        stick: What they hold.
        sensors: The chair's scanners; None: it has none, and no assistant.
        regions: Safety regions of the chair; None: the driver is alone.
        senses: What passes on what the scanners perceive; None: they themselves.
        options: Of the assistant, for a control period of `PERIOD`.
        through_doors: Whether it also helps along certified paths through doors it senses.
        unknown_is_free: Whether it takes for free what nothing is known of.
        plant: How the chair differs from its commands; default a good chair.
        time_limit: When the drive is broken off [s].
    """
    doors = None
    mover: Assistant | SmoothMotion = SmoothMotion(MotionLimits.of(scene.vehicle), period=PERIOD)
    if regions is not None and sensors is not None:
        blend = None
        if through_doors:
            doors, blend = DoorSense(sensors), DoorBlend(CertifiedDoorPaths(scene.vehicle))
        options = AssistantOptions(period=PERIOD) if options is None else options
        mover = Assistant(scene.vehicle, regions, options, door_blend=blend)
    seen = sensors if senses is None else senses
    seat = Seat(UnknownIsFree(seen) if seen is not None and unknown_is_free else seen)
    return AssistedChair(
        AssistedDriving(driver, stick, seat, mover, doors=doors),
        seat,
        SimulationOptions(
            PlantOptions() if plant is None else plant,
            EncoderOdometry(),
            step=0.025,
            period=PERIOD,
            time_limit=time_limit,
        ),
    )
