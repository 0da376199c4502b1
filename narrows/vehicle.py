"""The chair: the body that must fit, the drive that moves it, the limits it keeps."""

from __future__ import annotations

import math
from dataclasses import dataclass, field, replace

import numpy as np
import shapely
from numpy.typing import ArrayLike

from .errors import ShapeError
from .geometry import convex_polygon
from .se2 import Array


@dataclass(frozen=True)
class Limits:
    """What the drive may ask of the chair and its occupant; all positive unless stated.

    Attributes:
        speed: Forward speed of the body origin, and of each wheel's rim [m/s].
        reverse_speed: Backward speed [m/s]; 0 = the chair only drives forward.
        acceleration: Along the path, speeding up and braking alike [m/s^2].
        jerk: Along the path [m/s^3].
        yaw_rate: Heading rate [rad/s].
        yaw_acceleration: Rate of the heading rate [rad/s^2].
        lateral_acceleration: v omega, what throws the occupant sideways [m/s^2].
        curvature: omega / v while driving [1/m]; infinite = may turn on the spot.
    """

    speed: float = 0.8
    reverse_speed: float = 0.4
    acceleration: float = 0.6
    jerk: float = 1.5
    yaw_rate: float = 1.2
    yaw_acceleration: float = 2.0
    lateral_acceleration: float = 0.5
    curvature: float = math.inf

    def __post_init__(self) -> None:
        """Check that every limit is a positive number (reverse speed may be 0)."""
        for name, value in self.__dict__.items():
            least_ok = value >= 0.0 if name == "reverse_speed" else value > 0.0
            finite = math.isfinite(value) or (name == "curvature" and value > 0.0)
            if not (least_ok and finite):
                raise ShapeError(f"limit {name} must be a finite positive number, got {value}")


@dataclass(frozen=True, eq=False)
class Layer:
    """A convex slab of the body between two heights.

    Attributes:
        polygon: Corners counter-clockwise in the body frame, shape (K, 2), [m].
        z: Lowest and highest point above the floor [m].
    """

    polygon: Array
    z: tuple[float, float]

    def __post_init__(self) -> None:
        """Check convexity and heights; keep a read-only copy."""
        polygon = convex_polygon(self.polygon)
        polygon.setflags(write=False)
        low, high = (float(h) for h in self.z)
        if not (0.0 <= low < high < math.inf):
            raise ShapeError(f"a layer's heights must be 0 <= low < high, got [{low}, {high}]")
        object.__setattr__(self, "polygon", polygon)
        object.__setattr__(self, "z", (low, high))


@dataclass(frozen=True, eq=False)
class Vehicle:
    """A differential-drive chair with a real body.

    Body frame: origin midway between the drive wheels, x forward, y left.

    Attributes:
        layers: The body as convex slabs; one for a plain chair.
        track: Distance between the drive wheels [m].
        wheel_radius: Radius of the drive wheels [m].
        limits: Speeds, accelerations, jerk, curvature.
        name: Name for people.
    """

    layers: tuple[Layer, ...]
    track: float = 0.6
    wheel_radius: float = 0.16
    limits: Limits = field(default_factory=Limits)
    name: str = "chair"

    def __post_init__(self) -> None:
        """Check the numbers."""
        if not self.layers:
            raise ShapeError("a vehicle needs at least one layer")
        for name, value in (("track", self.track), ("wheel_radius", self.wheel_radius)):
            if not (0.0 < value < math.inf):
                raise ShapeError(f"{name} must be a positive number [m], got {value}")

    @classmethod
    def rectangle(
        cls,
        length: float,
        width: float,
        rear_overhang: float,
        *,
        height: float = 1.3,
        track: float | None = None,
        wheel_radius: float = 0.16,
        limits: Limits | None = None,
        name: str = "chair",
    ) -> Vehicle:
        """Return a chair with a rectangular body.

        >>> Vehicle.rectangle(1.2, 0.7, 0.25).outline[:, 0].min()
        np.float64(-0.25)

        Args:
            length: Overall length [m].
            width: Overall width [m].
            rear_overhang: How far the body reaches behind the drive axle [m], 0..length; the
                body spans x from -rear_overhang to length - rear_overhang.
            height: Top of the chair with its occupant [m].
            track: Distance between the drive wheels [m]; default 0.85 of the width.
            wheel_radius: Radius of the drive wheels [m].
            limits: Limits of the drive; default `Limits()`.
            name: Name for people.

        Raises:
            ShapeError: If length or width are not positive numbers.
        """
        for field_name, value in (("length", length), ("width", width)):
            if not (0.0 < value < math.inf):
                raise ShapeError(f"{field_name} must be a positive number [m], got {value}")
        rear, front, half = -rear_overhang, length - rear_overhang, width / 2.0
        corners = np.array([[rear, -half], [front, -half], [front, half], [rear, half]])
        return cls(
            layers=(Layer(corners, (0.0, height)),),
            track=0.85 * width if track is None else track,
            wheel_radius=wheel_radius,
            limits=Limits() if limits is None else limits,
            name=name,
        )

    @property
    def outline(self) -> Array:
        """Convex hull of all layers seen from above, counter-clockwise, shape (K, 2), [m]."""
        if len(self.layers) == 1:
            return self.layers[0].polygon
        points = np.concatenate([layer.polygon for layer in self.layers])
        hull = shapely.MultiPoint(points).convex_hull
        return convex_polygon(shapely.get_coordinates(hull)[:-1])

    @property
    def height(self) -> float:
        """Top of the chair with its occupant [m]."""
        return max(layer.z[1] for layer in self.layers)

    @property
    def radius(self) -> float:
        """Distance of the body's furthest point from the origin of the body frame [m]."""
        return float(np.linalg.norm(self.outline, axis=1).max())

    @property
    def length(self) -> float:
        """Extent along the body's x axis [m]."""
        return float(np.ptp(self.outline[:, 0]))

    @property
    def width(self) -> float:
        """Extent along the body's y axis [m]."""
        return float(np.ptp(self.outline[:, 1]))

    @property
    def front_overhang(self) -> float:
        """How far the body reaches ahead of the drive axle [m]."""
        return float(self.outline[:, 0].max())

    @property
    def rear_overhang(self) -> float:
        """How far the body reaches behind the drive axle [m]."""
        return float(-self.outline[:, 0].min())

    @property
    def may_turn_on_the_spot(self) -> bool:
        """Whether the curvature is unlimited."""
        return math.isinf(self.limits.curvature)

    def wheel_speeds(self, commands: ArrayLike) -> Array:
        """Return the speeds of the wheels' rims: v_left,right = v -+ omega track / 2.

        [NarrowArcs, Eq. (4.5)] times the wheel radius, the second term's track restored.

        Args:
            commands: [v, omega], shape (..., 2), [m/s, rad/s].

        Returns:
            [v_left, v_right], shape (..., 2), [m/s].
        """
        commands = np.asarray(commands, dtype=float)
        v, turn = commands[..., 0], commands[..., 1] * self.track / 2.0
        return np.stack([v - turn, v + turn], axis=-1)

    def with_limits(self, **changes: float) -> Vehicle:
        """Return the same chair with some limits changed, by their names in `Limits`."""
        return replace(self, limits=replace(self.limits, **changes))
