"""Paths as zeros of a function of the plane, with the derivatives a linearising law needs."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import NamedTuple, Protocol


class Jet(NamedTuple):
    """A level function with its derivatives at a point.

    Attributes:
        value: f.
        fx: df/dx.
        fy: df/dy.
        fxx: d2f/dx2.
        fxy: d2f/dxdy.
        fyy: d2f/dy2.
    """

    value: float
    fx: float
    fy: float
    fxx: float
    fxy: float
    fyy: float


class LevelFunction(Protocol):
    """A smooth function of the plane whose zeros are the path.

    Best the signed distance to it [m]: the law does not depend on the scale of f near the path,
    but the saturation of large errors does.
    """

    def __call__(self, x: float, y: float) -> Jet:
        """Return f and its derivatives at a point of the world frame [m]."""
        ...


@dataclass(frozen=True)
class LineLevel:
    """Signed distance to a straight line, positive on its left.

    Attributes:
        x: A point of the line [m].
        y: Likewise.
        heading: Direction of the line [rad].
    """

    x: float
    y: float
    heading: float

    def __call__(self, x: float, y: float) -> Jet:
        """Return the distance; see `LevelFunction`."""
        nx, ny = -math.sin(self.heading), math.cos(self.heading)
        return Jet(nx * (x - self.x) + ny * (y - self.y), nx, ny, 0.0, 0.0, 0.0)


@dataclass(frozen=True)
class CircleLevel:
    """Signed distance to a circle, positive inside: on the left of a chair that goes round it left.

    Attributes:
        x: Centre [m].
        y: Likewise.
        radius: Radius [m].
    """

    x: float
    y: float
    radius: float

    def __call__(self, x: float, y: float) -> Jet:
        """Return the distance; see `LevelFunction`. At the centre the gradient is arbitrary."""
        dx, dy = x - self.x, y - self.y
        r = max(math.hypot(dx, dy), 1e-9)
        ux, uy = dx / r, dy / r
        return Jet(self.radius - r, -ux, -uy, -uy * uy / r, ux * uy / r, -ux * ux / r)
