"""The controllers `narrows drive` knows by name, each made with the senses it needs."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from ..errors import InputError
from ..interfaces import Controller
from ..path import Path
from ..scene import Scene
from ..simulation.senses import Senses
from ..simulation.simulator import SimulationOptions
from ..trajectory import Trajectory


@dataclass(frozen=True, eq=False)
class Fitted:
    """A controller ready for one drive.

    Attributes:
        controller: It drives.
        senses: What it perceives with.
        options: How its drive is simulated.
        outcome: Returns how it stands, for people; asked after the drive.
    """

    controller: Controller
    senses: Senses
    options: SimulationOptions
    outcome: Callable[[], str]


Maker = Callable[[Scene, Path | Trajectory, str], Fitted]
"""Makes a controller for a scene, the planned motion and the name of a tracker."""


def _navigator(scene: Scene, motion: Path | Trajectory, tracker: str) -> Fitted:
    from ..reactive.navigator_guard import GuardOptions
    from ..reactive.navigator_known import KnownSolids
    from ..reactive.navigator_tracking import GuardedTracker
    from ..simulation.senses import IdealSenses
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
    )
    controller = GuardedTracker(
        make_tracker(tracker, path, scene.vehicle),
        scene.vehicle,
        guard,
        known=KnownSolids(scene.world),
    )
    return Fitted(controller, IdealSenses(scene.world), options, lambda: controller.reason)


_MAKERS: dict[str, Maker] = {"navigator": _navigator}


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


def make_controller(name: str, scene: Scene, motion: Path | Trajectory, *, tracker: str) -> Fitted:
    """Return a controller that drives a planned motion of a scene.

    Args:
        name: One of `controller_names()`.
        scene: World, chair, start, goal.
        motion: What was planned.
        tracker: Name of the tracker, for controllers that protect one.

    Raises:
        InputError: If there is no such controller.
    """
    check_controller(name)
    return _MAKERS[name](scene, motion, tracker)
