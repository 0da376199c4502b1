"""What laser scanners and ultrasonic sensors measure: points, and the space that is surely free.

Frames: `body` is the chair's (origin on the floor midway between the drive wheels, x forward,
y left, z up). A scanner's beams lie in a horizontal plane; angle 0 is the direction it is mounted
in, angles count counter-clockwise seen from above.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from enum import IntEnum
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from ..errors import InputError, ShapeError
from ..se2 import Array, transform


class Beam(IntEnum):
    """What a reading says."""

    INVALID = 0
    """Nothing: NaN, zero, negative, or nearer than the sensor measures. Neither free nor not."""
    RETURN = 1
    """There is something at this distance, and nothing before it."""
    CLEAR = 2
    """Infinity, or beyond the sensor's reach: there is nothing within its reach."""


@dataclass(frozen=True)
class ScannerMounting:
    """Where a range sensor sits on the chair.

    Attributes:
        height: Height of its beams above the floor [m].
        x: Position ahead of the drive axle [m].
        y: Position to the left of the chair's middle [m].
        heading: Direction of angle 0, counter-clockwise from straight ahead [rad].
    """

    height: float = 0.12
    x: float = 0.0
    y: float = 0.0
    heading: float = 0.0

    def __post_init__(self) -> None:
        """Refuse what is no number, and beams in the floor."""
        for name in ("x", "y", "heading"):
            if not math.isfinite(getattr(self, name)):
                raise InputError("not a number", field=name, value=getattr(self, name))
        if not (math.isfinite(self.height) and self.height > 0.0):
            raise InputError(
                "beams are above the floor", field="height", value=self.height, allowed="> 0 m"
            )

    @property
    def pose(self) -> Array:
        """The sensor's pose in the body frame, sensor_to_body, shape (3,), [m, m, rad]."""
        return np.array([self.x, self.y, self.heading])


@dataclass(frozen=True, eq=False)
class LaserScan:
    """One scan, as a driver or the simulator delivers it.

    Attributes:
        ranges: Distance along each beam, shape (N,), [m]. What is not a distance is defined by
            `Beam`: infinity is "nothing within reach", NaN and 0 are "no answer".
        first_angle: Angle of the first beam [rad].
        step: Angle from beam to beam [rad]; negative for a sensor that turns clockwise.
        mounting: Where the sensor sits.
        nearest: Least distance it measures [m].
        furthest: Its reach [m].
        time: When it was taken [s].
        sensor: Its name: sensors are told apart by it.
    """

    ranges: Array
    first_angle: float
    step: float
    mounting: ScannerMounting = field(default_factory=ScannerMounting)
    nearest: float = 0.02
    furthest: float = 30.0
    time: float = 0.0
    sensor: str = "laser"

    def __post_init__(self) -> None:
        """Check shape and numbers; keep a read-only copy."""
        object.__setattr__(self, "ranges", _readings(self.ranges))
        for name in ("first_angle", "step", "time"):
            if not math.isfinite(getattr(self, name)):
                raise InputError("not a number", field=name, value=getattr(self, name))
        if self.step == 0.0 or abs(self.step) * max(len(self.ranges) - 1, 0) > 2.0 * math.pi + 1e-6:
            raise InputError("beams lie within one turn", field="step", value=self.step)
        if not 0.0 <= self.nearest < self.furthest < math.inf:
            limits = f"{self.nearest}..{self.furthest}"
            raise InputError("not a range", field="nearest, furthest", value=limits)

    @property
    def angles(self) -> Array:
        """Angle of each beam in the sensor's frame, shape (N,), [rad]."""
        return np.asarray(self.first_angle + self.step * np.arange(len(self.ranges)))

    @cached_property
    def beams(self) -> NDArray[np.uint8]:
        """What each reading says, values of `Beam`, shape (N,)."""
        return _beams(self.ranges, self.nearest, self.furthest)

    @property
    def has_answer(self) -> bool:
        """Whether a single beam says anything; a scan without answers is silence."""
        return bool((self.beams != Beam.INVALID).any())

    @cached_property
    def directions(self) -> Array:
        """Unit vector along each beam in the body frame, shape (N, 2)."""
        angle = self.angles + self.mounting.heading
        return np.column_stack([np.cos(angle), np.sin(angle)])

    @cached_property
    def points(self) -> Array:
        """Points of the returns in the body frame, in the order of the beams, shape (M, 3), [m]."""
        hit = self.beams == Beam.RETURN
        flat = self.directions[hit] * self.ranges[hit, None] + self.mounting.pose[:2]
        return np.column_stack([flat, np.full(len(flat), self.mounting.height)])

    def free_reach(self, *, short: float = 0.0) -> Array:
        """Return how far each beam has shown there to be nothing, shape (N,), [m]; invalid: 0.

        Args:
            short: How much before a return that ends [m]; the sensor's error.
        """
        reach = np.where(self.beams == Beam.CLEAR, self.furthest, 0.0)
        hit = self.beams == Beam.RETURN
        reach[hit] = np.maximum(self.ranges[hit] - short, 0.0)
        return reach

    def free_polygon(self, *, short: float = 0.0, longest: float = math.inf) -> Array:
        """Return the corners of the area seen free, in the body frame, shape (N + 1, 2), [m].

        The sensor first, then the end of each beam; an invalid beam ends at the sensor, so that
        nothing between its neighbours and it is free. Between two beams the area is what lies
        before the line that joins their ends; a thing thinner than their distance may be in it.
        Not a simple polygon where beams are invalid; (1, 2) without beams.

        Args:
            short: How much before a return that ends [m].
            longest: Distance beyond which nothing is taken for free [m].
        """
        reach = np.minimum(self.free_reach(short=short), longest)
        place = self.mounting.pose[:2]
        return np.vstack([place, place + reach[:, None] * self.directions])


@dataclass(frozen=True, eq=False)
class UltrasoundReadings:
    """Readings of ultrasonic sensors: the nearest echo in a cone, nobody knows where in it.

    A smooth wall at a slant sends the sound away. So a reading is evidence of an obstacle, and
    no reading is evidence of free space: `LaserScan` has a free area, this has none.

    Attributes:
        ranges: Distance of the nearest echo of each sensor, shape (S,), [m]; at or beyond the
            reach: no echo; NaN, 0 and negative: no answer.
        sensors: Poses of the sensors, sensor_to_body, shape (S, 3), [m, m, rad].
        half_angle: Half the opening of the cones [rad].
        reach: Greatest distance they measure [m].
        height: Above the floor [m].
        time: When they were taken [s].
        sensor: Name of the set.
    """

    ranges: Array
    sensors: Array
    half_angle: float = math.radians(15.0)
    reach: float = 3.0
    height: float = 0.4
    time: float = 0.0
    sensor: str = "ultrasound"

    def __post_init__(self) -> None:
        """Check shapes and numbers; keep read-only copies."""
        object.__setattr__(self, "ranges", _readings(self.ranges))
        sensors = np.array(self.sensors, dtype=float)
        if sensors.shape != (len(self.ranges), 3) or not np.isfinite(sensors).all():
            raise ShapeError(
                f"sensors must be finite poses ({len(self.ranges)}, 3), got {sensors.shape}"
            )
        sensors.setflags(write=False)
        object.__setattr__(self, "sensors", sensors)
        if not (0.0 < self.half_angle < 0.5 * math.pi and 0.0 < self.reach < math.inf):
            raise InputError("no cone", value=f"{self.half_angle} rad, {self.reach} m")
        if not (self.height > 0.0 and math.isfinite(self.height) and math.isfinite(self.time)):
            raise InputError("not a height or time", value=f"{self.height} m, {self.time} s")

    @property
    def has_answer(self) -> bool:
        """Whether a single sensor says anything."""
        return bool((self.ranges > 0.0).any())

    def arcs(self, spacing: float = 0.05) -> Array:
        """Return points along the arcs the echoes may come from, body frame, shape (M, 3), [m].

        Args:
            spacing: Greatest distance between neighbouring points of an arc [m].
        """
        rows = [np.zeros((0, 2))]
        for pose, distance in zip(self.sensors, self.ranges, strict=True):
            if not 0.0 < distance < self.reach:
                continue
            count = 1 + math.ceil(2.0 * self.half_angle * distance / spacing)
            angle = np.linspace(-self.half_angle, self.half_angle, count)
            local = distance * np.column_stack([np.cos(angle), np.sin(angle)])
            rows.append(transform(pose, local))
        flat = np.concatenate(rows)
        return np.column_stack([flat, np.full(len(flat), self.height)])


def _readings(ranges: Array) -> Array:
    """Return ranges as a read-only copy (N,) of floats."""
    given = np.asarray(ranges)
    if given.dtype.kind not in "fiu":
        raise InputError("ranges of another type", value=str(given.dtype), allowed="numbers, m")
    if given.ndim != 1:
        raise ShapeError(f"ranges must have shape (N,), got {given.shape}")
    copied: Array = np.array(given, dtype=float)
    copied.setflags(write=False)
    return copied


def _beams(ranges: Array, nearest: float, furthest: float) -> NDArray[np.uint8]:
    """Return what readings say, shape (N,), read-only."""
    says = np.full(len(ranges), Beam.INVALID, dtype=np.uint8)
    says[(ranges >= nearest) & (ranges > 0.0) & (ranges <= furthest)] = Beam.RETURN
    says[ranges > furthest] = Beam.CLEAR
    says.setflags(write=False)
    return says
