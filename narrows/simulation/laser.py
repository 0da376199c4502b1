"""Laser scanners in the simulated world, and two of them on a chair [DrivingAssistant, II]."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..errors import InputError
from ..geometry import convex_polygon
from ..perception.ranges import LaserScan, ScannerMounting
from ..se2 import Array, compose
from ..vehicle import Vehicle
from .laser_kernels import scan_level
from .surfaces import SensedWorld, Surfaces, checked_pose

_WHEEL_WIDTH = 0.05  # m


@dataclass(frozen=True)
class LaserManners:
    """What a scanner measures and how well. The defaults are like a Sick S300's.

    Attributes:
        field: Angle from the first beam to the last, the middle straight ahead [rad]; <= 2 pi.
        beams: Number of beams, evenly spread over it.
        nearest: Least distance it measures [m]; what is nearer is read as 0.
        furthest: Its reach [m]; without a return within it the reading is infinite.
        noise: Standard deviation of a range [m].
        dropouts: Share of readings that are lost, each by itself: NaN.
    """

    field: float = math.radians(270.0)
    beams: int = 541
    nearest: float = 0.02
    furthest: float = 30.0
    noise: float = 0.01
    dropouts: float = 0.002

    def __post_init__(self) -> None:
        """Refuse what no scanner is."""
        if not 0.0 < self.field <= 2.0 * math.pi:
            raise InputError("no field", field="field", value=self.field, allowed="0 to 2 pi")
        if self.beams < 2 or self.beams != int(self.beams):
            raise InputError("too few beams", field="beams", value=self.beams, allowed=">= 2")
        if not 0.0 <= self.nearest < self.furthest < math.inf:
            value = f"{self.nearest}..{self.furthest}"
            raise InputError("not a range", field="nearest, furthest", value=value)
        if not (math.isfinite(self.noise) and self.noise >= 0.0):
            raise InputError("no deviation", field="noise", value=self.noise, allowed=">= 0 m")
        if not 0.0 <= self.dropouts <= 1.0:
            raise InputError("no share", field="dropouts", value=self.dropouts, allowed="0 to 1")


@dataclass(frozen=True, eq=False)
class LaserScanner:
    """A level laser scanner as it is mounted.

    Attributes:
        mounting: Where it sits.
        manners: What it measures and how well.
        name: Its name, `LaserScan.sensor`.
        hidden_by: Convex parts of the chair at the beams' height that it looks against, body
            frame, each (K, 2), [m]: beams that meet them read NaN.
    """

    mounting: ScannerMounting = field(default_factory=ScannerMounting)
    manners: LaserManners = field(default_factory=LaserManners)
    name: str = "laser"
    hidden_by: tuple[Array, ...] = ()

    @cached_property
    def first_angle(self) -> float:
        """Angle of the first beam [rad]."""
        return -0.5 * self.manners.field

    @cached_property
    def step(self) -> float:
        """Angle from beam to beam [rad]."""
        return self.manners.field / (self.manners.beams - 1)

    @cached_property
    def directions(self) -> Array:
        """Unit vectors of the beams in the sensor's frame, shape (B, 2)."""
        angles = self.first_angle + self.step * np.arange(self.manners.beams)
        return np.column_stack([np.cos(angles), np.sin(angles)])

    @cached_property
    def is_hidden(self) -> NDArray[np.bool_]:
        """Which beams meet the chair itself, shape (B,).

        Raises:
            InputError: If the sensor sits inside one of those parts.
        """
        parts = [convex_polygon(part) for part in self.hidden_by]
        corners = np.zeros((len(parts), max((len(part) for part in parts), default=3), 2))
        for row, part in enumerate(parts):
            corners[row, : len(part)] = part
        counts = np.array([len(part) for part in parts], dtype=np.int64)
        heights = np.tile([-np.inf, np.inf], (len(parts), 1))
        own = Surfaces(corners, counts, heights, np.zeros((0, 5)))
        inverse = self._scan(own, self.mounting.pose, math.inf)
        if inverse is None:
            raise InputError("the scanner sits inside a part of the chair", value=self.name)
        return np.asarray(inverse > 0.0)

    def exact_ranges(self, world: SensedWorld, pose: ArrayLike, time: float = 0.0) -> Array:
        """Return the exact range along each beam, shape (B,), [m].

        Infinite where there is nothing within reach; 0 everywhere inside a solid.

        Args:
            world: As in `Sensor.measure`, like pose and time; seen is what the beams' height meets.
            pose: Of the chair.
            time: When.

        Raises:
            ShapeError: If the pose or the time is not finite.
        """
        sensor = compose(checked_pose(pose), self.mounting.pose)
        inverse = self._scan(world.at(time), sensor, self.manners.furthest)
        if inverse is None:
            return np.zeros(self.manners.beams)
        with np.errstate(divide="ignore"):
            ranges: Array = 1.0 / inverse
        ranges[ranges > self.manners.furthest] = np.inf
        return ranges

    def measure(
        self,
        world: SensedWorld,
        pose: ArrayLike,
        time: float = 0.0,
        *,
        rng: np.random.Generator | None = None,
    ) -> LaserScan:
        """Return a scan as the scanner delivers it: `Sensor.measure`, all beams at once."""
        manners = self.manners
        ranges = self.exact_ranges(world, pose, time)
        near = ranges < manners.nearest
        if rng is not None and manners.noise > 0.0:
            ranges += manners.noise * rng.standard_normal(len(ranges))
            ranges[ranges > manners.furthest] = np.inf
            near |= ranges < manners.nearest
        ranges[near] = 0.0
        if rng is not None and manners.dropouts > 0.0:
            ranges[rng.random(len(ranges)) < manners.dropouts] = np.nan
        ranges[self.is_hidden] = np.nan
        return LaserScan(
            ranges,
            self.first_angle,
            self.step,
            self.mounting,
            manners.nearest,
            manners.furthest,
            time,
            self.name,
        )

    def _scan(self, there: Surfaces, sensor: Array, reach: float) -> Array | None:
        """Return inverse ranges, shape (B,), or None from inside a solid."""
        inverse = np.empty(self.manners.beams)
        outside = scan_level(
            inverse,
            self.directions,
            self.first_angle,
            self.step,
            sensor,
            self.mounting.height,
            reach,
            there.corners,
            there.counts,
            there.heights,
            there.rounds,
        )
        return inverse if outside else None


def front_and_rear(
    vehicle: Vehicle, *, height: float = 0.12, manners: LaserManners | None = None
) -> tuple[LaserScanner, LaserScanner]:
    """Return the paper's two scanners: one in front behind the foot rests, one at the back.

    [DrivingAssistant, II]: 270 deg, 0.12 m above the floor. They look along under the chair; its
    drive wheels hide what is beside them. Where the wheels stand is the vehicle's; that they are
    5 cm wide, and that nothing else of the chair is that low, is ours.

    Args:
        vehicle: The chair; they sit in the middle of its front and of its back.
        height: Of the beams above the floor [m].
        manners: Default `LaserManners()`.
    """
    half, wheel = 0.5 * _WHEEL_WIDTH, vehicle.wheel_radius
    wheels: list[Array] = []
    if height < 2.0 * wheel:
        reach = math.sqrt(wheel**2 - (wheel - height) ** 2)  # of the wheel at that height
        box = np.array([[-reach, -half], [reach, -half], [reach, half], [-reach, half]])
        wheels = [box + np.array([0.0, 0.5 * side * vehicle.track]) for side in (-1.0, 1.0)]
    manners = LaserManners() if manners is None else manners
    places = (("front", vehicle.front_overhang, 0.0), ("rear", -vehicle.rear_overhang, math.pi))
    front, rear = (
        LaserScanner(ScannerMounting(height, x, 0.0, heading), manners, name, tuple(wheels))
        for name, x, heading in places
    )
    return front, rear


def on_corners(
    vehicle: Vehicle, *, height: float = 0.12, manners: LaserManners | None = None
) -> tuple[LaserScanner, LaserScanner]:
    """Return two scanners on the front left and the rear right corner that see all around.

    Args:
        vehicle: The chair; its bounding rectangle carries them, nothing hides their 270 deg.
        height: Of the beams above the floor [m].
        manners: Default `LaserManners()`.
    """
    low, high = vehicle.outline.min(axis=0), vehicle.outline.max(axis=0)
    manners = LaserManners() if manners is None else manners
    left = ScannerMounting(height, float(high[0]), float(high[1]), 0.25 * math.pi)
    right = ScannerMounting(height, float(low[0]), float(low[1]), -0.75 * math.pi)
    return LaserScanner(left, manners, "front left"), LaserScanner(right, manners, "rear right")
