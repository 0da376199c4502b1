"""Sensors fitted to a chair: how often and how late they answer, and what goes wrong with them."""

from __future__ import annotations

import math
from dataclasses import dataclass, field, replace
from typing import Protocol, TypeVar

import numpy as np
from numpy.typing import NDArray

from ..errors import InputError
from ..perception.obstacle_map import ObstacleMap
from ..perception.obstacles import ObstacleFinder
from ..perception.ranges import LaserScan, UltrasoundReadings
from ..perception.surroundings import Surroundings
from ..se2 import Array
from .depth_sensor import DepthSensor
from .laser import LaserScanner
from .surfaces import SensedWorld
from .ultrasound import UltrasoundOptions, measure_ranges

Spell = tuple[float, float]
"""A time from which and one to which, not included [s]; the latter may be infinite."""


@dataclass(frozen=True)
class Faults:
    """What goes wrong with a sensor. The default: nothing.

    Attributes:
        silent: Spells in which it measures nothing; ((5.0, inf),): dead from 5 s on.
        invalid: Spells in which it answers without one valid reading: all NaN, an empty frame.
        late: Spells in which answers are held back, and for how long [s]: (from, to, delay).
        lost: Share of answers that never arrive, each by itself.
        jitter: Greatest additional delay of an answer, drawn evenly [s].
    """

    silent: tuple[Spell, ...] = ()
    invalid: tuple[Spell, ...] = ()
    late: tuple[tuple[float, float, float], ...] = ()
    lost: float = 0.0
    jitter: float = 0.0

    def __post_init__(self) -> None:
        """Refuse spells that end before they begin, shares and delays that are none."""
        for name in ("silent", "invalid", "late"):
            for spell in getattr(self, name):
                if not (spell[0] < spell[1] and all(length >= 0.0 for length in spell[2:])):
                    raise InputError("no spell", field=name, value=spell, allowed="from < to")
        if not 0.0 <= self.lost <= 1.0:
            raise InputError("no share", field="lost", value=self.lost, allowed="0 to 1")
        if not 0.0 <= self.jitter < math.inf:
            raise InputError("no delay", field="jitter", value=self.jitter, allowed=">= 0 s")

    def delay(self, time: float) -> float:
        """Return how much longer than usual an answer measured at a time is held back [s]."""
        return sum(extra for begin, end, extra in self.late if begin <= time < end)


def holds(spells: tuple[Spell, ...], time: float) -> bool:
    """Return whether one of some spells holds at a time."""
    return any(begin <= time < end for begin, end in spells)


@dataclass(frozen=True)
class Schedule:
    """When a sensor measures, and when its answer arrives.

    Attributes:
        rate: Measurements a second [Hz]; at the first control step that is due.
        latency: From the measurement to its arrival [s].
        phase: When the first one is due [s].
        faults: What goes wrong.
    """

    rate: float = 12.5
    latency: float = 0.04
    phase: float = 0.0
    faults: Faults = field(default_factory=Faults)

    def __post_init__(self) -> None:
        """Refuse rates and times that are none."""
        if not 0.0 < self.rate < math.inf:
            raise InputError("no rate", field="rate", value=self.rate, allowed="> 0 Hz")
        for name in ("latency", "phase"):
            value = getattr(self, name)
            if not 0.0 <= value < math.inf:
                raise InputError("no delay", field=name, value=value, allowed=">= 0 s")


Answer = TypeVar("Answer")


class FittedSensor(Protocol[Answer]):
    """A sensor on a chair, and what its answers become."""

    @property
    def name(self) -> str:
        """Its name; sensors of one chair have different ones."""
        ...

    @property
    def schedule(self) -> Schedule:
        """When it measures."""
        ...

    def measure(
        self, world: SensedWorld, pose: Array, time: float, rng: np.random.Generator
    ) -> Answer:
        """Return its answer from the chair's true pose, shape (3,)."""
        ...

    def spoilt(self, answer: Answer) -> Answer:
        """Return the same without one valid reading."""
        ...

    def enter(self, answer: Answer, known: ObstacleMap) -> None:
        """Enter an answer into a map that stands where the chair believed to be then."""
        ...


@dataclass(frozen=True, eq=False)
class FittedLaser:
    """A laser scanner on a chair.

    Attributes:
        scanner: The scanner and where it is mounted.
        schedule: When it measures.
    """

    scanner: LaserScanner
    schedule: Schedule = field(default_factory=Schedule)

    @property
    def name(self) -> str:
        """The scanner's name."""
        return self.scanner.name

    def measure(
        self, world: SensedWorld, pose: Array, time: float, rng: np.random.Generator
    ) -> LaserScan:
        """Return a scan."""
        return self.scanner.measure(world, pose, time, rng=rng)

    def spoilt(self, answer: LaserScan) -> LaserScan:
        """Return a scan of NaN."""
        return replace(answer, ranges=np.full(len(answer.ranges), math.nan))

    def enter(self, answer: LaserScan, known: ObstacleMap) -> None:
        """Enter a scan."""
        known.add_scan(answer)


@dataclass(frozen=True, eq=False)
class SeenFrame:
    """A depth frame and what the fast route makes of it.

    Attributes:
        image: The frame, shape (height, width), [mm], 0: no return.
        seen: What is known from it.
    """

    image: NDArray[np.uint16]
    seen: Surroundings


@dataclass(frozen=True, eq=False)
class FittedCamera:
    """A depth camera on a chair; its frames go the fast route, as it is meant to be mounted.

    Attributes:
        sensor: The camera as it is mounted in truth.
        finder: What finds obstacles in its frames, its camera mounted as it is believed to be.
        schedule: When it takes a frame.
        name: Its name.
    """

    sensor: DepthSensor
    finder: ObstacleFinder
    schedule: Schedule = field(default_factory=lambda: Schedule(rate=30.0, latency=0.06))
    name: str = "camera"

    def measure(
        self, world: SensedWorld, pose: Array, time: float, rng: np.random.Generator
    ) -> SeenFrame:
        """Return a frame."""
        image = self.sensor.measure(world, pose, time, rng=rng)
        return SeenFrame(image, self.finder.see(image, time))

    def spoilt(self, answer: SeenFrame) -> SeenFrame:
        """Return a frame without a return."""
        empty = np.zeros_like(answer.image)
        return SeenFrame(empty, self.finder.see(empty, answer.seen.time))

    def enter(self, answer: SeenFrame, known: ObstacleMap) -> None:
        """Enter a frame."""
        known.add_frame(answer.image, answer.seen, self.finder, sensor=self.name)


@dataclass(frozen=True, eq=False)
class FittedUltrasound:
    """Ultrasonic sensors on a chair; glass answers them too.

    Attributes:
        sensors: Poses on the chair, shape (S, 3), such as `sensor_ring` returns.
        options: What they can do.
        schedule: When they all measure.
        name: Name of the set.
    """

    sensors: Array
    options: UltrasoundOptions = field(default_factory=UltrasoundOptions)
    schedule: Schedule = field(default_factory=lambda: Schedule(rate=10.0, latency=0.02))
    name: str = "ultrasound"

    def measure(
        self, world: SensedWorld, pose: Array, time: float, rng: np.random.Generator
    ) -> UltrasoundReadings:
        """Return a reading of every sensor."""
        options = self.options
        ranges = measure_ranges(
            world.world, pose, self.sensors, time=time, options=options, rng=rng
        )
        return UltrasoundReadings(
            ranges,
            self.sensors,
            options.half_angle,
            options.reach,
            options.height,
            time,
            self.name,
        )

    def spoilt(self, answer: UltrasoundReadings) -> UltrasoundReadings:
        """Return readings of NaN."""
        return replace(answer, ranges=np.full(len(answer.ranges), math.nan))

    def enter(self, answer: UltrasoundReadings, known: ObstacleMap) -> None:
        """Enter the echoes."""
        known.add_echoes(answer)
