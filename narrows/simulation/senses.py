"""What a chair perceives with: the protocol, and senses that know the truth about what is near."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Protocol

import numpy as np
import shapely

from ..errors import InputError
from ..interfaces import Percept
from ..se2 import Array
from ..world import MovingSolid, Solid, World
from .surfaces import checked_pose


class Senses(Protocol):
    """Sensors and what becomes of their answers, at work on one drive."""

    def perceive(self, time: float, true_pose: Array, believed_pose: Array) -> Percept:
        """Return what the chair knows of its surroundings now.

        Args:
            time: Time since the start [s]; increases from call to call.
            true_pose: Where the chair is, shape (3,), [m, m, rad]: where its sensors look from.
            believed_pose: Where it believes to be, shape (3,): how it relates what it remembers.
        """
        ...


@dataclass(frozen=True)
class IdealOptions:
    """How much of the truth is told.

    Attributes:
        reach: Distance of points from the body's origin, seen from above [m].
        heights: Band of heights of which points are told [m].
        spacing: Greatest distance between neighbouring points of an outline [m].
        level_spacing: Greatest distance between the heights at which a solid is sampled [m].
    """

    reach: float = 3.0
    heights: tuple[float, float] = (0.02, 1.5)
    spacing: float = 0.05
    level_spacing: float = 0.3

    def __post_init__(self) -> None:
        """Refuse a band without height and distances that are not positive."""
        for name in ("reach", "spacing", "level_spacing"):
            value = getattr(self, name)
            if not (math.isfinite(value) and value > 0.0):
                raise InputError("must be positive", field=name, value=value, allowed="> 0 m")
        if not -math.inf < self.heights[0] < self.heights[1] < math.inf:
            raise InputError("no band of heights", field="heights", value=self.heights)


class IdealSenses:
    """Senses that know all outlines near the chair, without noise, delay or hidden places.

    For tests, and for studies that leave sensors out. Outlines are sampled so that every point of
    one is within half the spacing of a sample, seen from above: the percept's `spread`. Nothing is
    unknown.
    """

    def __init__(self, world: World, options: IdealOptions | None = None) -> None:
        """Sample what stands still.

        Args:
            world: What there is.
            options: Default `IdealOptions()`.
        """
        self.options = IdealOptions() if options is None else options
        rows = [
            self._raised(_outline(solid, self.options.spacing), solid) for solid in world.solids
        ]
        self._still = np.concatenate([np.zeros((0, 3)), *rows])
        self._moving = [
            (solid, self._raised(_circle(solid.radius, self.options.spacing), solid))
            for solid in world.moving
        ]

    def perceive(self, time: float, true_pose: Array, believed_pose: Array) -> Percept:
        """Return the points near the chair's true pose; what it believes plays no part."""
        x, y, heading = checked_pose(true_pose)
        c, s = math.cos(heading), math.sin(heading)
        parts = [self._still]
        for solid, ring in self._moving:
            parts.append(ring + np.append(solid.position(time), 0.0))
        rows = np.concatenate(parts) - np.array([x, y, 0.0])
        near = rows[rows[:, 0] ** 2 + rows[:, 1] ** 2 <= self.options.reach**2]
        to_body = np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])
        return Percept(time, near @ to_body, 0.5 * self.options.spacing)

    def _raised(self, outline: Array, solid: Solid | MovingSolid) -> Array:
        """Return an outline (M, 2) at all heights of a solid that are in the band, (K M, 3)."""
        low = max(solid.z[0], self.options.heights[0])
        high = min(solid.z[1], self.options.heights[1])
        if low > high:
            return np.zeros((0, 3))
        count = 1 + math.ceil((high - low) / self.options.level_spacing)
        levels = np.linspace(low, high, count)
        flat = np.tile(outline, (count, 1))
        return np.column_stack([flat, np.repeat(levels, len(outline))])


def _outline(solid: Solid, spacing: float) -> Array:
    """Return points along all rings of a solid, corners among them, shape (M, 2), [m]."""
    if isinstance(solid.shape, shapely.Point):
        centre = np.array([solid.shape.x, solid.shape.y])
        return np.asarray(centre + _circle(solid.radius, spacing))
    rings = [solid.shape.exterior, *solid.shape.interiors]
    dense = [shapely.get_coordinates(shapely.segmentize(ring, spacing))[:-1] for ring in rings]
    return np.concatenate(dense)


def _circle(radius: float, spacing: float) -> Array:
    count = max(3, math.ceil(2.0 * math.pi * radius / spacing))
    angle = 2.0 * math.pi / count * np.arange(count)
    return np.asarray(radius * np.column_stack([np.cos(angle), np.sin(angle)]))
