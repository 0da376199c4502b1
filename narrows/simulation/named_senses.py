"""What a chair may perceive with, by name: the truth, or its own sensors and their map."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import replace

import numpy as np

from ..errors import InputError
from ..interfaces import Percept
from ..perception.camera import Mounting
from ..perception.obstacles import ObstacleFinder
from ..perception.surroundings import Grid
from ..scene import Scene
from ..se2 import Array, compose, invert, transform
from .chair_senses import ChairSenses
from .depth_sensor import DepthSensor, kinect
from .fitted_sensors import Faults, FittedCamera, FittedLaser, Schedule, Spell
from .laser import on_corners
from .senses import IdealOptions, IdealSenses, Senses
from .vacated import Vacated

CAMERA = Mounting(height=1.0, tilt=math.radians(25.0))
"""Where the depth camera sits: above the drive axle, looking down ahead."""

REACH = 3.7
"""Distance from the body's origin up to which all of them tell of obstacles [m]: as far as the map
of the sensors does in every direction. A guard must be told, see `GuardOptions.reach`."""

_BAND = (0.1, 0.2)  # m: that of the map in which the scanners look
_PIXELS = (320, 240)
_RATE, _LATENCY = 10.0, 0.06  # Hz, s: of the camera
_DEEP = 2.5  # m: returns from further away err by more than a cell of the map
_GRID = Grid(x_from=0.8, x_to=_DEEP + 0.4)  # what the camera looks for obstacles in


class Silenced:
    """Senses that go silent now and then: what was perceived last stays, with its old time."""

    def __init__(self, senses: Senses, silent: tuple[Spell, ...]) -> None:
        """Silence senses.

        Args:
            senses: The senses.
            silent: From when until when, the latter not included [s].
        """
        self._senses, self._silent = senses, silent
        self._last = Percept(-math.inf, np.zeros((0, 3)))
        self._pose = np.zeros(3)

    def perceive(self, time: float, true_pose: Array, believed_pose: Array) -> Percept:
        """Return what was perceived last, where it is seen from the pose believed now."""
        if not any(begin <= time < end for begin, end in self._silent):
            self._last = self._senses.perceive(time, true_pose, believed_pose)
            self._pose = np.array(believed_pose)
            return self._last
        moved = compose(invert(believed_pose), self._pose)
        points = self._last.points.copy()
        points[:, :2] = transform(moved, points[:, :2])
        return replace(self._last, points=points, unknown=transform(moved, self._last.unknown))


def fitted_camera(faults: Faults | None = None) -> FittedCamera:
    """Return a depth camera 57 degrees wide and 2.5 m deep, 320 x 240 pixels, 10 times a second.

    Args:
        faults: What goes wrong with it.
    """
    camera = replace(kinect(CAMERA, width=_PIXELS[0], height=_PIXELS[1]), furthest=_DEEP)
    schedule = Schedule(rate=_RATE, latency=_LATENCY, faults=Faults() if faults is None else faults)
    return FittedCamera(DepthSensor(camera), ObstacleFinder(camera, _GRID), schedule)


def lasers_and_camera(
    scene: Scene, *, faults: Faults | None = None, rng: np.random.Generator | None = None
) -> Vacated:
    """Return scanners on two corners and a depth camera, and the map that remembers.

    The scanners see all around at 0.12 m, 12.5 times a second; the camera sees what hangs and
    what lies.

    Args:
        scene: World, chair, and where it starts.
        faults: Of all three alike.
        rng: Source of their noise and faults.
    """
    found = Faults() if faults is None else faults
    scanners = on_corners(scene.vehicle)
    fitted = [FittedLaser(scanner, Schedule(faults=found)) for scanner in scanners]
    seeing = fitted_camera(found)
    senses = ChairSenses(scene, [*fitted, seeing], reach=REACH, rng=rng)
    return Vacated(senses, seeing.sensor.camera, _BAND, seeing.name)


def _ideal(scene: Scene, silent: tuple[Spell, ...]) -> Senses:
    return Silenced(IdealSenses(scene.world, IdealOptions(reach=REACH)), silent)


def _sensors(scene: Scene, silent: tuple[Spell, ...]) -> Senses:
    return lasers_and_camera(scene, faults=Faults(silent=silent))


_MAKERS: dict[str, Callable[[Scene, tuple[Spell, ...]], Senses]] = {
    "ideal": _ideal,
    "sensors": _sensors,
}


def senses_names() -> tuple[str, ...]:
    """Return the names of the senses."""
    return tuple(_MAKERS)


def make_senses(name: str, scene: Scene, *, silent: tuple[Spell, ...] = ()) -> Senses:
    """Return senses for one drive of a scene.

    Args:
        name: One of `senses_names()`: "ideal" knows all outlines near the chair; "sensors" are
            `lasers_and_camera`, their noise of seed 0.
        scene: World, chair, and where it starts.
        silent: Spells in which they fall silent [s].

    Raises:
        InputError: If there are no senses of that name.
    """
    if name not in _MAKERS:
        raise InputError(
            "there are no such senses",
            field="--senses",
            value=name,
            allowed=", ".join(senses_names()),
        )
    return _MAKERS[name](scene, silent)
