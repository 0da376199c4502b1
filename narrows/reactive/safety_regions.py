"""Safety regions: where a braking chair may still get to, and from which speed on."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path as FilePath

import numpy as np
from numpy.typing import NDArray

from ..errors import ShapeError
from ..geometry import offset_polygon
from ..se2 import Array
from ..vehicle import Vehicle

_SAME = 1e-6  # m, m/s: figures of one chair that differ less are the same

STRAIGHT = math.pi / 4.0
"""Direction phi of driving straight ahead [rad]: both wheels alike."""


@dataclass(frozen=True)
class RegionOptions:
    """What a safety region allows for, and how finely it is drawn.

    Attributes:
        latency: Time from a decision to brake until the rims slow down [s]: control period, motor
            lag and whatever else is not predicted.
        deceleration: Rate at which half the speed norm falls in a full braking: that of |v|, or of
            the rims in a turn on the spot; a bend's outer wheel slows down faster [m/s^2].
        speed_error: Error of each wheel's speed, as a share of the faster one's.
        margin: Free space kept around the body [m].
        spread: How far an obstacle may reach beyond the point that stands for it [m].
        directions: Number of directions phi, a multiple of 8.
        levels: Number of speeds told apart; finer the slower.
        headroom: Fastest speed in the tables, as a multiple of the fastest rim the limits allow: a
            chair that brakes comfortably stops like one that brakes fully from a higher speed.
        cell: Edge of a cell [m].
        castor_samples: Samples of the time in which castors turn straight, over 0 to infinity.
        pose_samples: Poses on the longest braking manoeuvre.
    """

    latency: float = 0.1
    deceleration: float = 1.0
    speed_error: float = 0.025
    margin: float = 0.01
    spread: float = 0.02
    directions: int = 480
    levels: int = 40
    headroom: float = 1.6
    cell: float = 0.02
    castor_samples: int = 5
    pose_samples: int = 12

    def __post_init__(self) -> None:
        """Check the ranges."""
        for name in ("latency", "deceleration", "cell"):
            value = getattr(self, name)
            if not (0.0 < value < math.inf):
                raise ShapeError(f"{name} must be a finite positive number, got {value}")
        for name, most in (("speed_error", 0.5), ("margin", 1.0), ("spread", 1.0)):
            value = getattr(self, name)
            if not (0.0 <= value <= most):
                raise ShapeError(f"{name} must lie between 0 and {most}, got {value}")
        for name, least, most in (
            ("directions", 8, 3600),
            ("levels", 4, 250),
            ("castor_samples", 2, 50),
            ("pose_samples", 5, 200),
        ):
            value = getattr(self, name)
            if not least <= value <= most:
                raise ShapeError(f"{name} must lie between {least} and {most}, got {value}")
        if not 1.0 <= self.headroom <= 4.0:
            raise ShapeError(f"headroom must lie between 1 and 4, got {self.headroom}")
        if self.directions % 8:
            raise ShapeError(f"directions must be a multiple of 8, got {self.directions}")


@dataclass(frozen=True, eq=False)
class SafetyRegions:
    """The cells a braking chair reaches, for every direction of motion.

    [DrivingAssistant, Sec. III-B]: a direction phi = atan2(v_right, v_left) (1) and a speed norm
    v_norm = |v_right| + |v_left| (2) say how the chair moves; each cell holds the least speed norm
    from which a full braking still reaches it. Speed norms come in levels; `levels` holds n where
    the cell is reached from a speed in (norms[n - 1], norms[n]] and from none below, so a chair
    whose norm is at most norms[n - 1] stays out of it. Nothing is interpolated.

    Attributes:
        options: What the regions allow for.
        outline: The chair's outline they were computed for, shape (K, 2), [m].
        track: Its track [m].
        norms: Speed norm of each level, from 0, shape (L,), [m/s].
        lower: Corner of the grid with the least x and y, body frame, shape (2,), [m].
        levels: Level of each cell, shape (directions, rows along x, columns along y); 255: never.
        parts: Part of the body that meets each cell first, as in `side_tables.PARTS`.
    """

    options: RegionOptions
    outline: Array
    track: float
    norms: Array
    lower: Array
    levels: NDArray[np.uint8] = field(repr=False)
    parts: NDArray[np.uint8] = field(repr=False)

    def __post_init__(self) -> None:
        """Check the shapes; make the tables read-only."""
        grid = self.levels.shape
        if len(grid) != 3 or grid[0] != self.options.directions or self.parts.shape != grid:
            raise ShapeError(f"levels and parts must be (directions, rows, columns), got {grid}")
        if len(self.norms) != self.options.levels + 1:
            raise ShapeError(f"norms must be {self.options.levels + 1}, got {len(self.norms)}")
        for table in (self.outline, self.norms, self.lower, self.levels, self.parts):
            table.setflags(write=False)

    @classmethod
    def compute(
        cls,
        vehicle: Vehicle,
        options: RegionOptions | None = None,
        report: Callable[[float], None] | None = None,
    ) -> SafetyRegions:
        """Return the regions of a chair, up to the fastest its limits let a rim turn.

        Takes seconds.

        Args:
            vehicle: Its outline (all layers seen from above), track and limits.
            options: Default `RegionOptions()`.
            report: Called with the share done, 0 to 1.
        """
        from .safety_regions_painting import painted

        options = RegionOptions() if options is None else options
        share = np.linspace(0.0, 1.0, options.levels + 1)
        norms = options.headroom * top_norm(vehicle) * 0.5 * (share + share**2)
        outline = np.array(vehicle.outline)
        lower, levels, parts = painted(outline, vehicle.track, norms, options, report)
        return cls(options, outline, vehicle.track, norms, lower, levels, parts)

    def save(self, file: FilePath | str) -> None:
        """Write the regions to a file (NumPy's .npz), whole or not at all.

        Raises:
            InputError: If the file cannot be written.
        """
        from .safety_regions_file import write_regions

        write_regions(self, file)

    @classmethod
    def load(cls, file: FilePath | str, vehicle: Vehicle) -> SafetyRegions:
        """Return regions from a file, checked against the chair they are to protect.

        Raises:
            InputError: If the file cannot be read, is no file of regions, is damaged, or belongs
                to another chair; says what differs.
        """
        from .safety_regions_file import read_regions

        return read_regions(file, vehicle)

    def difference(self, vehicle: Vehicle) -> str:
        """Return in words how a chair differs from the one these are for; empty: not at all."""
        outline = vehicle.outline
        same = outline.shape == self.outline.shape
        if not (same and np.abs(outline - self.outline).max() <= _SAME):
            return f"their body is {_size(self.outline)}, the chair's {_size(outline)}"
        if not abs(vehicle.track - self.track) <= _SAME:
            return f"their track is {self.track:.4g} m, the chair's {vehicle.track:.4g} m"
        top = top_norm(vehicle)
        if not self.norms[-1] >= top - _SAME:
            ends, asked = 0.5 * self.norms[-1], 0.5 * top
            return f"they end at a rim speed of {ends:.4g} m/s, the chair may reach {asked:.4g} m/s"
        return ""

    @property
    def keep(self) -> float:
        """Distance the regions keep the body from a point [m]."""
        return self.options.margin + self.options.spread

    def polar(self, v: float, omega: float) -> tuple[float, float]:
        """Return direction phi in (-pi, pi] and speed norm [m/s] of a motion, Eqs. (1), (2).

        Args:
            v: Speed [m/s].
            omega: Heading rate [rad/s].
        """
        turn = 0.5 * omega * self.track
        left, right = v - turn, v + turn
        return math.atan2(right, left), abs(left) + abs(right)

    def motion(self, phi: float, norm: float) -> tuple[float, float]:
        """Return the motion [v, omega] of a direction and a speed norm."""
        left, right = math.cos(phi), math.sin(phi)
        scale = norm / (abs(left) + abs(right))
        return 0.5 * scale * (left + right), scale * (right - left) / self.track

    def index(self, phi: float) -> int:
        """Return the number of the region a direction belongs to: the nearest."""
        count = self.options.directions
        return round(phi * count / (2.0 * math.pi)) % count

    def direction(self, index: int) -> float:
        """Return the direction phi in (-pi, pi] a region is computed for."""
        phi = 2.0 * math.pi * (index % self.options.directions) / self.options.directions
        return phi - 2.0 * math.pi if phi > math.pi else phi

    def level(self, norm: float) -> int:
        """Return the least level whose speed norm is not below a norm; at most the highest."""
        return min(int(np.searchsorted(self.norms, norm - 1e-12)), len(self.norms) - 1)

    def region(self, v: float, omega: float) -> NDArray[np.bool_]:
        """Return which cells a chair braking from a motion may reach, shape (rows, columns)."""
        phi, norm = self.polar(v, omega)
        reached: NDArray[np.bool_] = self.levels[self.index(phi)] <= self.level(norm)
        return reached


def top_norm(vehicle: Vehicle) -> float:
    """Return the greatest speed norm the chair's limits allow [m/s]: 2 max(|v|, |omega| b / 2)."""
    limits = vehicle.limits
    return 2.0 * max(limits.speed, limits.reverse_speed, 0.5 * limits.yaw_rate * vehicle.track)


def protected(outline: Array, options: RegionOptions) -> Array:
    """Return the outline grown by all that is to be kept around it, shape (K, 2), [m]."""
    return offset_polygon(outline, options.margin + options.spread)


def _size(outline: Array) -> str:
    low, high = outline.min(axis=0), outline.max(axis=0)
    return (
        f"{high[0] - low[0]:.4g} x {high[1] - low[1]:.4g} m from x = {low[0]:.4g} m "
        f"with {len(outline)} corners"
    )
