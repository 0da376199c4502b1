"""The undeformed zone of [FuzzyDVZ]: an ellipsoid about the chair, the chair at its focus.

Its long end lies ahead. With the axes of the paper (c_y = c_z = sqrt(5)/3 c_x, centre 2/3 c_x from
the chair) the chair is a focus, and Eqs. (6)-(12) collapse to

    d_h = (5/9) c_x / (1 - (2/3) cos gamma),    cos gamma = cos theta cos phi,

gamma the angle from straight ahead: 5/3 c_x ahead, 5/9 c_x aside and up, 1/3 c_x behind. As
printed (a_x = -2/3 c_x) the long end lies behind the chair; the sign is put right here.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from ..errors import ShapeError
from ..se2 import Array
from ..vehicle import Vehicle

SIDE = 5.0 / 9.0
"""Reach straight aside, in c_x."""

OFFSET = 2.0 / 3.0
"""Distance of the ellipsoid's centre from its focus, in c_x: the eccentricity."""


@dataclass(frozen=True)
class ZoneShape:
    """An ellipsoid that grows with the speed.

    Heights are measured from `center_height` and multiplied by `squash` before anything else: the
    zone is an ellipsoid of revolution in these coordinates, and 1 / squash times as tall in space.

    Attributes:
        length: c_x at rest, half the long axis [m].
        growth: lambda in c_x = lambda V^2 + length [s^2/m].
        center_height: Height of the focus above the floor [m].
        squash: What heights are multiplied by, 0 to 1; 1: the paper's ellipsoid of revolution.
        heights: Lowest and highest point that can deform the zone [m]: the chair's body. What
            hangs higher is passed under.
    """

    length: float
    growth: float = 0.5
    center_height: float = 0.0
    squash: float = 1.0
    heights: tuple[float, float] = (0.0, math.inf)

    def __post_init__(self) -> None:
        """Check the numbers."""
        if not (0.0 < self.length < math.inf and 0.0 <= self.growth < math.inf):
            raise ShapeError(
                f"a zone needs a length > 0 and a growth >= 0, got {self.length}, {self.growth}"
            )
        if not 0.0 < self.squash <= 1.0:
            raise ShapeError(f"squash must lie between 0 and 1, got {self.squash}")
        if not self.heights[0] < self.heights[1]:
            raise ShapeError(f"heights must be low < high, got {self.heights}")

    @classmethod
    def around(
        cls, vehicle: Vehicle, *, margin: float = 0.05, growth: float = 0.5, squash: float = 0.3
    ) -> ZoneShape:
        """Return the smallest zone that holds a chair's whole body at rest, with a margin.

        A point p lies inside where |p| <= d_h, that is c_x >= (9/5) (|p| - (2/3) p_x). A ball of
        radius m about it asks for (9/5) (5/3) m = 3 m more. The focus is at half the chair's
        height; the greatest value over the corners of its layers, top and bottom, is the length.
        For a chair of 1.2 x 0.7 x 1.3 m the rear corners decide.

        Args:
            vehicle: The chair.
            margin: How far the zone reaches beyond the body, at least [m].
            growth: lambda [s^2/m].
            squash: 1 makes a zone as tall as wide, and so as long as a tall chair asks for.
        """
        center = 0.5 * vehicle.height
        needed = 0.0
        for layer in vehicle.layers:
            rise = squash * max(abs(z - center) for z in layer.z)
            corners = np.column_stack([layer.polygon, np.full(len(layer.polygon), rise)])
            reach = np.linalg.norm(corners, axis=1) - OFFSET * corners[:, 0]
            needed = max(needed, float(reach.max()) / SIDE)
        grown = (1.0 + OFFSET) * margin / SIDE
        return cls(needed + grown, growth, center, squash, (0.0, vehicle.height))

    @classmethod
    def paper(cls, *, height: float = 1.0, growth: float = 0.6) -> ZoneShape:
        """Return the paper's zone: its focus on the floor, a given height of the ellipsoid [m].

        Its "1 m high security zone" makes c_z = 1 and c_x = 3 / sqrt(5) = 1.342 m. Nothing in it
        looks at the chair's body. lambda is not printed.
        """
        return cls(3.0 / math.sqrt(5.0) * height, growth, 0.0, 1.0, (0.0, height))

    def c_x(self, speed: float) -> float:
        """Return c_x = lambda V^2 + c_x_min at a speed, [FuzzyDVZ, Eq. (7)], [m]."""
        return self.growth * speed * speed + self.length

    def reach(self, theta: ArrayLike, phi: ArrayLike, speed: float) -> Array:
        """Return d_h, the distance of the zone's surface from its focus (heights squashed) [m].

        Args:
            theta: Azimuth from the chair's heading, shape (...), [rad].
            phi: Latitude, shape (...), [rad].
            speed: The chair's [m/s].
        """
        cosine = np.cos(np.asarray(theta, dtype=float)) * np.cos(np.asarray(phi, dtype=float))
        return np.asarray(SIDE * self.c_x(speed) / (1.0 - OFFSET * cosine))

    def holds(self, points: ArrayLike, speed: float) -> Array:
        """Return which points lie inside the ellipsoid, shape (N,).

        Args:
            points: Points in the body frame, z above the floor, shape (N, 3), [m].
            speed: The chair's [m/s].
        """
        rows = np.asarray(points, dtype=float).reshape(-1, 3)
        up = self.squash * (rows[:, 2] - self.center_height)
        distance = np.sqrt(rows[:, 0] ** 2 + rows[:, 1] ** 2 + up**2)
        return np.asarray(distance - OFFSET * rows[:, 0] <= SIDE * self.c_x(speed))

    def section(self, speed: float, *, height: float | None = None, count: int = 90) -> Array:
        """Return the zone's outline at a height, body frame, shape (count, 2), [m]; for pictures.

        Args:
            speed: The chair's [m/s].
            height: Above the floor [m]; default: the focus.
            count: Number of points.

        Raises:
            ShapeError: If the zone does not reach that high or low.
        """
        up = 0.0 if height is None else self.squash * (height - self.center_height)
        c_x = self.c_x(speed)
        across = c_x * math.sqrt(1.0 - OFFSET**2)
        share = 1.0 - (up / across) ** 2
        if share <= 0.0:
            raise ShapeError(f"the zone does not reach the height {height} m")
        angle = np.linspace(0.0, 2.0 * math.pi, count, endpoint=False)
        scale = math.sqrt(share)
        return np.column_stack(
            [OFFSET * c_x + c_x * scale * np.cos(angle), across * scale * np.sin(angle)]
        )
