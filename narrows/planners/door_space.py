"""How wide door and corridor must be for one arc through the door, in a thin wall.

Frame, arc and symbols are those of `door_arc`.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from ..errors import ShapeError
from ..se2 import Array
from .arc_geometry import ArcBody

_ZOOMS = 8  # times the grid of radii is refined around its best
_LARGEST_RADIUS = 36.0  # m


@dataclass(frozen=True)
class DoorSpace:
    """What an arc that touches on all sides takes.

    Attributes:
        inner_radius: r [m].
        shift: s, its centre beyond the plane of a thin wall [m].
        corridor: W, width of the corridor [m].
        door: D, width of the door [m].
    """

    inner_radius: float
    shift: float
    corridor: float
    door: float


def door_needed(body: ArcBody, inner_radius: float, shift: float) -> DoorSpace:
    """Return door and corridor that an arc fills, in a thin wall.

    D(r, s) = sqrt(d^2 + R^2 - s^2) - sqrt(r^2 - s^2), W = sqrt(b^2 + R^2) - s for a centre s >= 0
    beyond the wall's plane; s = 0 is [NarrowArcs, Section 3.2] with its hidden condition. On the
    corridor's side (s < 0, to -d) the near jamb touches the side: D = sqrt(d^2 + R^2 - s^2) - r.

    >>> space = door_needed(ArcBody(1.0, 0.0, 0.67), 1.38891, 0.0)
    >>> round(space.door, 3), round(space.corridor, 3)
    (0.9, 2.059)

    Args:
        body: The chair's rectangle.
        inner_radius: r [m].
        shift: s [m], -d to r.

    Raises:
        ShapeError: If the centre is further from the wall than the arc reaches.
    """
    outer = inner_radius + body.width
    if not -body.front <= shift <= max(inner_radius, 0.0):
        raise ShapeError(f"shift must be from -{body.front} to {inner_radius} m, got {shift}")
    near = math.sqrt(inner_radius**2 - shift**2) if shift >= 0.0 else inner_radius
    far = math.sqrt(body.front**2 + outer**2 - shift**2)
    return DoorSpace(inner_radius, shift, math.hypot(body.rear, outer) - shift, far - near)


def least_corridor_for_door(
    body: ArcBody, door: float, *, before_wall: bool = True, least_radius: float | None = None
) -> DoorSpace:
    """Return the arc through a thin wall's door that needs the narrowest corridor: W(D).

    For each r the shift follows from D: beyond the wall, with X = sqrt(r^2 - s^2),
    X = (d^2 + R^2 - r^2 - D^2) / (2 D) and s = sqrt(r^2 - X^2); before it s = -sqrt(d^2 + R^2
    - (D + r)^2). The least over r is found on a grid refined.

    Args:
        body: The chair's rectangle.
        door: D [m], wider than the body.
        before_wall: Whether the centre may lie on the corridor's side of the wall too.
        least_radius: Of the drive axle's middle [m]; None: the paper's r >= 0.

    Raises:
        ShapeError: If the door is not wider than the body.
    """
    if door <= body.width:
        raise ShapeError(f"the door must be wider than the chair's {body.width} m, got {door} m")
    half = 0.5 * body.width
    low, high = 0.0 if least_radius is None else least_radius - half, _LARGEST_RADIUS
    best = (math.inf, 0.0, 0.0)
    for beyond in (True, False) if before_wall else (True,):
        first, last = low, high
        for _ in range(_ZOOMS):
            radius = np.linspace(first, last, 400)
            shift = _shift_for_door(body, door, radius, beyond=beyond)
            corridor = np.where(
                np.isnan(shift), np.inf, np.hypot(body.rear, radius + body.width) - shift
            )
            k = int(corridor.argmin())
            if corridor[k] < best[0]:
                best = (float(corridor[k]), float(radius[k]), float(shift[k]))
            first, last = float(radius[max(k - 1, 0)]), float(radius[min(k + 1, 399)])
    return DoorSpace(best[1], best[2], best[0], door)


def _shift_for_door(body: ArcBody, door: float, radius: Array, *, beyond: bool) -> Array:
    """Return the shift with which an arc of inner radii fills a door; nan where it cannot."""
    reach_squared = body.front**2 + (radius + body.width) ** 2
    if beyond:
        side = (reach_squared - radius**2 - door**2) / (2.0 * door)
        fits = (np.abs(side) <= radius) & (side >= 0.0)
        return np.where(fits, np.sqrt(np.maximum(radius**2 - side**2, 0.0)), np.nan)
    # A door wider than the arc's reach leaves the centre at the wall.
    shift = -np.sqrt(np.maximum(reach_squared - (door + radius) ** 2, 0.0))
    # The side's line must pass the wall's face before the turn: r - s >= 0.
    return np.where((shift >= -body.front) & (radius >= shift), shift, np.nan)
