"""The controllers `narrows drive` knows by name, each made with the senses it needs."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path as FilePath
from typing import TYPE_CHECKING

import numpy as np

from ..errors import InputError
from ..files import check_can_be_written
from ..interfaces import Controller
from ..path import Path
from ..scene import Scene
from ..simulation.senses import Senses
from ..simulation.simulator import SimulationOptions
from ..trajectory import Trajectory

if TYPE_CHECKING:
    from ..reactive.safety_regions import SafetyRegions


@dataclass(frozen=True, eq=False)
class Fitted:
    """A controller ready for one drive.

    Attributes:
        controller: It drives.
        senses: What it perceives with.
        options: How its drive is simulated.
        outcome: Returns how it stands, for people; asked after the drive.
        follows: Whether it follows the planned motion, so that errors to it can be measured.
    """

    controller: Controller
    senses: Senses
    options: SimulationOptions
    outcome: Callable[[], str]
    follows: bool = True


@dataclass(frozen=True)
class Wishes:
    """What may be chosen of a controller; what does not belong to it is left alone.

    Attributes:
        tracker: Name of the tracker that is protected.
        driver: Who sits in the chair.
        regions: File of the chair's safety regions: read, or computed and written; None:
            computed for this drive.
        report: Called with the share of what must be computed before the drive.
        senses: What the navigator perceives with, see `narrows.simulation.named_senses`.
        silent_from: When those fall silent for good [s].
    """

    tracker: str = "lookahead"
    driver: str = "steady"
    regions: str | None = None
    report: Callable[[float], None] | None = None
    senses: str = "ideal"
    silent_from: float = math.inf


Maker = Callable[[Scene, Path | Trajectory, Wishes], Fitted]
"""Makes a controller for a scene and the planned motion."""


def _navigator(scene: Scene, motion: Path | Trajectory, wishes: Wishes) -> Fitted:
    from ..reactive.navigator_guard_options import GuardOptions
    from ..reactive.navigator_known import KnownSolids
    from ..reactive.navigator_tracking import GuardedTracker
    from ..simulation.named_senses import REACH, make_senses
    from ..tracking.registry import make_tracker

    # By progress, not by the trajectory's clock: the chair may have to wait for somebody.
    path = motion.path if isinstance(motion, Trajectory) else motion
    options = SimulationOptions()
    limits = scene.vehicle.limits
    guard = GuardOptions(
        deceleration=limits.acceleration,
        yaw_deceleration=limits.yaw_acceleration,
        latency=options.plant.latency,
        lag=options.plant.motor_lag,
        period=options.period,
        reach=REACH,
    )
    controller = GuardedTracker(
        make_tracker(wishes.tracker, path, scene.vehicle),
        scene.vehicle,
        guard,
        known=KnownSolids(scene.world),
        path=path,
    )
    silent = ((wishes.silent_from, math.inf),) if wishes.silent_from < math.inf else ()
    senses = make_senses(wishes.senses, scene, silent=silent)
    return Fitted(controller, senses, options, lambda: controller.reason)


def _assistant(scene: Scene, motion: Path | Trajectory, wishes: Wishes) -> Fitted:
    from ..simulation.assisted_chair import assisted_chair, hand_stick, scanners, scripted_driver

    path = motion.path if isinstance(motion, Trajectory) else motion
    stick = hand_stick(scene.vehicle)
    driver = scripted_driver(scene, path, wishes.driver, stick, np.random.default_rng(0))
    regions = _regions(scene, wishes)
    chair = assisted_chair(scene, driver, stick, scanners(scene), regions=regions)

    def outcome() -> str:
        return _of_driver(wishes.driver, driver.finished, scene)

    return Fitted(chair.controller, chair.senses, chair.options, outcome, follows=False)


def _of_driver(name: str, finished: bool, scene: Scene) -> str:
    """Return how a drive ended for its driver, who does not aim at millimetres."""
    if finished:
        asked = f"{1e3 * scene.goal.position_tolerance:.0f} mm"
        if math.isfinite(scene.goal.heading_tolerance):
            asked += f" and {math.degrees(scene.goal.heading_tolerance):.3g} degrees"
        return (
            f"the {name} driver let go where they wanted to be, as near as people do; the goal "
            f"asks for {asked}"
        )
    stuck = "" if scene.vehicle.limits.reverse_speed > 0.0 else "; this chair cannot back off"
    return f"the {name} driver did not get there in the time{stuck}"


def _regions(scene: Scene, wishes: Wishes) -> SafetyRegions:
    """Return the chair's safety regions, from the file if it is there."""
    from ..reactive.safety_regions import SafetyRegions
    from ..simulation.assisted_chair import compute_regions

    if wishes.regions is not None and FilePath(wishes.regions).exists():
        return SafetyRegions.load(wishes.regions, scene.vehicle)
    if wishes.regions is not None:
        check_can_be_written(wishes.regions)
    regions = compute_regions(scene.vehicle, wishes.report)
    if wishes.regions is not None:
        regions.save(wishes.regions)
    return regions


_MAKERS: dict[str, Maker] = {"navigator": _navigator, "assistant": _assistant}


def controller_names() -> tuple[str, ...]:
    """Return the names of the controllers."""
    return tuple(_MAKERS)


def check_controller(name: str) -> None:
    """Say that there is no such controller.

    Raises:
        InputError: If it is not one of `controller_names()`.
    """
    if name not in _MAKERS:
        raise InputError(
            "there is no such controller",
            field="--controller",
            value=name,
            allowed=", ".join(_MAKERS),
        )


def make_controller(
    name: str,
    scene: Scene,
    motion: Path | Trajectory,
    *,
    tracker: str = "lookahead",
    driver: str = "steady",
    regions: str | None = None,
    report: Callable[[float], None] | None = None,
    senses: str = "ideal",
    silent_from: float = math.inf,
) -> Fitted:
    """Return a controller that drives a planned motion of a scene.

    Args:
        name: One of `controller_names()`.
        scene: World, chair, start, goal.
        motion: What was planned; for a driver, the way they have in mind.
        tracker: See `Wishes`, as the rest.
        driver: See `Wishes`.
        regions: See `Wishes`.
        report: See `Wishes`.
        senses: See `Wishes`.
        silent_from: See `Wishes`.

    Raises:
        InputError: If there is no such controller, driver or senses, or the regions cannot be used,
            or the time is none.
    """
    check_controller(name)
    if not silent_from >= 0.0:
        raise InputError("no time", field="--silent-from", value=silent_from, allowed=">= 0 s")
    wishes = Wishes(tracker, driver, regions, report, senses, silent_from)
    return _MAKERS[name](scene, motion, wishes)
