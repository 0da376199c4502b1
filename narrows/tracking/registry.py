"""The trackers by name."""

from __future__ import annotations

import math
from collections.abc import Callable

from ..errors import InputError
from ..interfaces import Tracker
from ..path import Path
from ..trajectory import Trajectory
from ..vehicle import Vehicle

SPEED = 0.4
"""Cruising speed on a path without times [m/s], unless told otherwise."""

DELAY = 0.05
"""Time from a command to its effect [s], unless told otherwise: the nominal chair's motor lag."""

_Maker = Callable[[Path | Trajectory, Vehicle, float, float], Tracker]


def _lookahead(motion: Path | Trajectory, vehicle: Vehicle, speed: float, delay: float) -> Tracker:
    from .lookahead import LookaheadGains, LookaheadOptions, LookaheadTracker

    gains = LookaheadGains(10.0 * speed / SPEED, 0.0, 0.0)  # the same per metre at every speed
    options = LookaheadOptions(gains=gains, speed=speed, delay=delay)
    return LookaheadTracker(motion, vehicle, options)


def _paper(motion: Path | Trajectory, vehicle: Vehicle, speed: float, delay: float) -> Tracker:
    from .lookahead import LookaheadOptions, LookaheadTracker

    return LookaheadTracker(motion, vehicle, LookaheadOptions.paper(speed=speed))


def _linearizing(
    motion: Path | Trajectory, vehicle: Vehicle, speed: float, delay: float
) -> Tracker:
    from .following import FollowingOptions
    from .linearizing import LinearizingTracker
    from .linearizing_law import LinearizingOptions

    options = LinearizingOptions(following=FollowingOptions(speed=speed, delay=delay))
    return LinearizingTracker(motion, vehicle, options)


def _virtual_target(
    motion: Path | Trajectory, vehicle: Vehicle, speed: float, delay: float
) -> Tracker:
    from .following import FollowingOptions
    from .virtual_target import VirtualTargetOptions, VirtualTargetTracker

    options = VirtualTargetOptions(following=FollowingOptions(speed=speed, delay=delay))
    return VirtualTargetTracker(motion, vehicle, options)


def _predictive(motion: Path | Trajectory, vehicle: Vehicle, speed: float, delay: float) -> Tracker:
    from .predictive import PredictiveTracker
    from .predictive_options import PredictiveOptions

    # No budget: simulated time waits, and a drive must not depend on how busy the machine is.
    options = PredictiveOptions(speed=speed, delay=delay, budget=math.inf)
    return PredictiveTracker(motion, vehicle, options)


_MAKERS: dict[str, _Maker] = {
    "lookahead": _lookahead,
    "lookahead-paper": _paper,
    "linearizing": _linearizing,
    "virtual-target": _virtual_target,
    "predictive": _predictive,
}


def tracker_names() -> tuple[str, ...]:
    """Return the names of the trackers."""
    return tuple(_MAKERS)


def make_tracker(
    name: str,
    motion: Path | Trajectory,
    vehicle: Vehicle,
    *,
    speed: float = SPEED,
    delay: float = DELAY,
) -> Tracker:
    """Return a tracker with its default gains, for simulation.

    Args:
        name: One of `tracker_names()`; "lookahead-paper" is the bare law of [DoorBezier], always
            at the cruising speed.
        motion: What it follows.
        vehicle: Its limits bound the commands.
        speed: Cruising speed on a path without times [m/s].
        delay: Time from a command to its effect that the tracker reckons with [s].

    Raises:
        InputError: If there is no such tracker.
    """
    if name not in _MAKERS:
        raise InputError(
            "there is no such tracker", field="tracker", value=name, allowed=", ".join(_MAKERS)
        )
    return _MAKERS[name](motion, vehicle, speed, delay)
