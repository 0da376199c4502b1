"""Drives by what is perceived: the navigator, and people with or without the assistant."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike

from narrows.errors import InputError
from narrows.interfaces import Percept, Plan
from narrows.scene import Scene
from narrows.se2 import Array
from narrows.vehicle import Vehicle

from .page_driver import BY_HAND, PageDriver
from .page_report import Report
from .page_senses import Watched, region_outline, zone_outline
from .page_work import Drive, distances, plan_scene

if TYPE_CHECKING:
    from narrows.reactive.safety_regions import SafetyRegions
    from narrows.simulation.drivers import Driver
    from narrows.simulation.simulator import SimulationOptions

ZONE, ASSISTANT, ALONE = "zone navigator", "assistant", "driver alone"
CONTROLLERS = (ZONE, ASSISTANT, ALONE)
"""Who drives by what it perceives, without a plan to keep to; the last two have a driver."""

_PERIOD = 0.05  # s, of the assistant
_CELL = 0.02  # m
_BAND = (0.025, 0.3)  # m: the scanners' height lies in the one band there is
_NAVIGATED = 90.0  # s: longest drive of the navigator
_DRIVEN = 90.0  # s: longest drive of a person
_ROUTE = 0.4  # m between the corners of a driver's way
_THERE = 0.35  # m from the goal: a person has arrived


@dataclass(frozen=True)
class CommandControllers:
    """The controllers of `narrows drive`, handed in from above.

    Attributes:
        names: Their names.
        make: Called with a name, a scene, a motion and `tracker`; returns the controller with its
            senses and options. A function at the top of a module.
    """

    names: tuple[str, ...] = ()
    make: Callable[..., Any] | None = None


@dataclass(frozen=True, eq=False)
class Protected:
    """Safety regions and the chair they were computed for, kept for its next drive.

    Attributes:
        key: What of the chair they depend on.
        regions: They.
    """

    key: tuple[Any, ...]
    regions: SafetyRegions


def chair_key(vehicle: Vehicle) -> tuple[Any, ...]:
    """Return what safety regions depend on."""
    return (vehicle.outline.round(9).tobytes(), vehicle.track, *vars(vehicle.limits).values())


def driver_names() -> tuple[str, ...]:
    """Return who can sit in the chair."""
    from narrows.simulation.driver_traits import DRIVERS

    return (*DRIVERS, BY_HAND)


def drive_controller(
    report: Report,
    scene: Scene,
    plan: Plan | None,
    who: str,
    driver: str,
    protected: Protected | None,
    commanded: CommandControllers | None = None,
) -> Drive:
    """Return a drive by what is perceived.

    Args:
        report: Told the share of the time, and with `BY_HAND` the pose as it is.
        scene: The scene.
        plan: Its plan, the way a driver has in mind; None: planned first.
        who: One of `CONTROLLERS`, or of those of the command line.
        driver: One of `driver_names()`, for those that have one.
        protected: Safety regions of an earlier drive.
        commanded: Those of the command line; they keep to a plan.

    Raises:
        InputError: If there is nobody of that name, or a driver has no way to go.
    """
    if commanded is not None and commanded.make is not None and who in commanded.names:
        return _commanded(report, scene, who, commanded.make)
    if who == ZONE:
        return _navigated(report, scene)
    if who in (ASSISTANT, ALONE):
        return _assisted(report, scene, plan, driver, protected, alone=who == ALONE)
    allowed = ", ".join(CONTROLLERS)
    raise InputError("there is no such controller", value=who, allowed=allowed)


def _commanded(report: Report, scene: Scene, who: str, make: Callable[..., Any]) -> Drive:
    """Return a drive of a plan that reckons with nobody who moves, as `narrows drive` makes it."""
    from narrows.tracking.registry import tracker_names

    plan = plan_scene(report, replace(scene, world=replace(scene.world, moving=())))
    if plan.trajectory is None:
        return Drive(plan)
    fitted = make(who, scene, plan.trajectory, tracker=tracker_names()[0])
    watched = Watched(fitted.senses)
    shown = None if scene.world.moving else plan  # certified without those who move, not with them
    before = Drive(shown, reference=plan.trajectory)
    drive = _judged(report, scene, fitted.controller, watched, fitted.options, before)
    return replace(drive, who=who)


def _navigated(report: Report, scene: Scene) -> Drive:
    from narrows.reactive.navigator import Navigator
    from narrows.simulation.assisted_chair import scanners
    from narrows.simulation.simulator import SimulationOptions

    navigator = Navigator(scene.vehicle, scene.goal.pose[:2])
    watched = Watched(scanners(scene))
    speed = _Speed()

    def outline(percept: Percept) -> tuple[Array, ...]:
        return zone_outline(navigator.zone.shape, speed.value, percept)

    watched.outline = outline
    limits = SimulationOptions(time_limit=_NAVIGATED)
    drive = _judged(report, scene, _Told(navigator, speed), watched, limits, Drive(None))
    return replace(drive, who=ZONE)


class _Speed:
    """The speed commanded last [m/s], and the rate [rad/s]."""

    value = 0.0
    rate = 0.0


class _Told:
    """A controller whose command is taken down as it is given."""

    def __init__(self, controller: Any, speed: _Speed) -> None:
        self._controller, self._speed = controller, speed

    def __getattr__(self, name: str) -> Any:
        return getattr(self._controller, name)

    def step(self, time: float, pose: ArrayLike, percept: Percept) -> Array:
        command: Array = self._controller.step(time, pose, percept)
        self._speed.value, self._speed.rate = float(command[0]), float(command[1])
        return command


def _assisted(
    report: Report,
    scene: Scene,
    plan: Plan | None,
    name: str,
    protected: Protected | None,
    *,
    alone: bool,
) -> Drive:
    from narrows.simulation.assisted_chair import assisted_chair, hand_stick, scanners

    stick = hand_stick(scene.vehicle)
    plan, driver = _seated(report, scene, plan, name, stick)
    sensors = scanners(scene)
    speed, watched = _Speed(), Watched(sensors)
    regions: SafetyRegions | None = None
    if not alone:
        protected = _protected(report, scene.vehicle, protected)
        regions = known = protected.regions

        def outline(percept: Percept) -> tuple[Array, ...]:
            return region_outline(known, speed.value, speed.rate)

        watched.outline = outline
    chair = assisted_chair(scene, driver, stick, sensors, regions=regions, senses=watched)
    controller = _Told(chair.controller, speed)
    if isinstance(driver, PageDriver):
        driver.signals = lambda: controller.signals
    whose = f"{ALONE if alone else ASSISTANT}, {name}"
    drive = _judged(
        report, scene, controller, watched, chair.options, Drive(plan), senses=chair.senses
    )
    return replace(drive, who=whose, protected=protected)


def _judged(
    report: Report,
    scene: Scene,
    controller: Any,
    watched: Watched,
    options: SimulationOptions,
    before: Drive,
    senses: Any = None,
) -> Drive:
    from narrows.simulation.judge import judge
    from narrows.simulation.simulator import simulate

    record = simulate(
        scene,
        controller,
        senses=watched if senses is None else senses,
        reference=before.reference,
        options=options,
        report=report,
    )
    return replace(
        before,
        record=record,
        judgement=judge(scene, record),
        clearance=distances(scene, record.poses),
        moments=tuple(watched.moments),
    )


def _protected(report: Report, vehicle: Vehicle, before: Protected | None) -> Protected:
    """Return the safety regions of a chair; computing them takes seconds."""
    from narrows.simulation.assisted_chair import compute_regions

    if before is not None and before.key == chair_key(vehicle):
        return before
    report("computing where this chair may get to while it brakes")
    protected = Protected(chair_key(vehicle), compute_regions(vehicle, report))
    report("driving")
    return protected


def _seated(
    report: Report, scene: Scene, plan: Plan | None, name: str, stick: Any
) -> tuple[Plan | None, Driver]:
    """Return the plan whose path somebody has in mind, if they need one, and them."""
    from narrows.simulation.assisted_chair import scripted_driver

    if name == BY_HAND:
        return plan, PageDriver(report, scene)
    if name not in driver_names():
        allowed = ", ".join(driver_names())
        raise InputError("there is no such driver", value=name, allowed=allowed)
    plan = plan_scene(report, scene) if plan is None else plan
    if plan.path is None:
        raise InputError(f"the driver knows no way: {plan.status.value}, {plan.reason}")
    return plan, scripted_driver(scene, plan.path, name, stick, np.random.default_rng(0))
