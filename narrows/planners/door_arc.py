"""One arc from a corridor through a door in its wall, at a right angle.

The frame is the corner's of `corridor_turn`, with the near jamb's edge on the corridor's side as
the inner corner: x along the corridor, y through the door, the wall from y = 0 to its thickness t,
the far jamb at x = D. The arc's centre is at (-a_2, a_1): a_1 = s is how far it lies beyond the
wall's face. What the body clears on line - arc - line is

    corridor's far wall   W + s - sqrt(b^2 + R^2)                       the hidden condition
    near jamb             r - sqrt(s^2 + a_2^2), or r - max(s, a_2) where one of them is negative
    far jamb              sqrt((D + a_2)^2 + q^2) - R_c

with q the distance of the centre from the wall's slab (0 inside it): exact for a rectangle. Where
the side passes it straight (s < 0, or q < b) D + a_2 - R counts too; a rear corner that passes it
on the arc (q > b) with a longer overhang takes R_c's place.

[NarrowArcs, Section 3.2] is s = 0, t = 0, R_c - r = D (3.2.1) and leaves the first line out. A wall
of thickness t asks for D >= R_c - sqrt(r^2 - t^2/4) with the centre in its middle (s = t/2). A
centre on the corridor's side (s < 0) lets the chair turn before the door: in small doors that
needs far less corridor than s >= 0.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from ..errors import ShapeError
from ..se2 import Array
from .arc_geometry import ArcBody
from .corridor_turn import TurnArc, corner_support

_RIGHT = 0.5 * math.pi
_GRID = 48  # radii looked at together at first
_FINE = 21  # and when zooming in, 5-fold each time
_ZOOMS = 4
_SHIFTS = 17  # shifts looked at together for each radius, 8-fold closer each time
_SHIFT_ZOOMS = 4
_BISECTIONS = 40
_EASE = 1e-4  # clearance given up for a metre more radius, 2 m at most
_LARGEST_RADIUS = 12.0  # m: of the drive axle; beyond it is a straight drive through a wide door


@dataclass(frozen=True)
class DoorTurn:
    """A door in the wall of a corridor.

    Attributes:
        corridor: Width of the corridor along the wall [m].
        door: Clear width [m].
        thickness: Of the wall [m], >= 0.
    """

    corridor: float
    door: float
    thickness: float = 0.0

    def __post_init__(self) -> None:
        """Check the numbers."""
        if not (min(self.corridor, self.door) > 0.0 and self.thickness >= 0.0):
            raise ShapeError(
                f"a door needs positive widths and a thickness >= 0, got {self.corridor}, "
                f"{self.door}, {self.thickness}"
            )


def door_clearance(
    body: ArcBody, door: DoorTurn, radius: Array, beyond: Array, behind: Array
) -> Array:
    """Return the clearance of arcs, any shape, negative where they hit [m].

    Args:
        body: The chair's rectangle.
        door: The door.
        radius: Of the drive axle's middle [m].
        beyond: a_1 = s, the centre beyond the wall's face on the corridor's side [m].
        behind: a_2, the centre behind the near jamb's face [m].
    """
    outer, inner = radius + 0.5 * body.width, radius - 0.5 * body.width
    corridor = door.corridor + beyond - np.hypot(body.rear, outer)
    near = inner - corner_support(beyond, behind, _RIGHT)
    off = np.maximum(beyond - door.thickness, np.maximum(-beyond, 0.0))
    across = door.door + behind
    on_arc = np.hypot(across, off) - _far_reach(body, outer, beyond - door.thickness)
    passes = (off * outer <= body.front * across) & (across > 0.0)
    far = np.where(passes | (beyond >= 0.0), on_arc, np.inf)
    beside = (beyond < 0.0) | (off <= body.rear)  # the side passes the jamb when straight again
    far = np.where(beside, np.minimum(far, across - outer), far)
    far = np.where(across > 0.0, far, across - outer)
    return np.minimum(np.minimum(corridor, near), far)


def _far_reach(body: ArcBody, outer: Array, beyond: Array) -> Array:
    """Return the radius of what passes the far jamb: the front corner, or a longer rear's.

    The rear corner gets past the jamb's edge on the arc where the centre is more than the rear
    overhang beyond the wall.
    """
    front = np.hypot(body.front, outer)
    return np.where(beyond > body.rear, np.maximum(front, np.hypot(body.rear, outer)), front)


def balanced_side(body: ArcBody, door: DoorTurn, radius: Array, beyond: Array) -> Array:
    """Return a_2 for which an arc clears both jambs alike, [m].

    For s >= 0 sqrt(s^2 + a_2^2) + sqrt((D + a_2)^2 + q^2) = S = r + R_c: squared twice, a quadratic
    in a_2. For s < 0 the first root is a_2 itself. What passes straight is balanced likewise.
    """
    outer, inner = radius + 0.5 * body.width, radius - 0.5 * body.width
    total = inner + _far_reach(body, outer, beyond - door.thickness)
    off = np.maximum(beyond - door.thickness, np.maximum(-beyond, 0.0))
    width = door.door
    k = width**2 + off**2 - total**2 - beyond**2
    a = 4.0 * (width**2 - total**2)
    b = 4.0 * width * k
    c = k**2 - 4.0 * total**2 * beyond**2
    root = np.sqrt(np.maximum(b**2 - 4.0 * a * c, 0.0))
    quadratic = (-b - root) / (2.0 * a)  # a < 0: the greater root
    linear = (total**2 - width**2 - off**2) / (2.0 * (total + width))
    straight = 0.5 * (inner + outer - width)
    passes = off * outer <= body.front * (width + linear)
    before = np.where(passes, np.maximum(linear, straight), straight)
    spare = np.maximum(inner + outer - width, 1e-9)
    side = 0.5 * (spare - beyond**2 / spare)
    after = np.maximum(np.where(off <= body.rear, np.maximum(quadratic, side), quadratic), 0.0)
    return np.where(beyond >= 0.0, after, before)


def best_door_arc(
    body: ArcBody,
    door: DoorTurn,
    *,
    least_radius: float = 0.0,
    line: float | None = None,
    side: float | None = None,
) -> TurnArc:
    """Return the arc with the greatest clearance, negative where none passes.

    Where the door is what is tight, a range of arcs clears it alike: of those within 0.2 mm the
    gentlest is taken.

    Args:
        body: The chair's rectangle.
        door: The door.
        least_radius: Of the drive axle's middle [m].
        line: Distance of the line of travel along the corridor from the door's wall [m]; None: any.
        side: Distance of the line of travel through the door from the near jamb [m]; None: any.
    """
    low, high = least_radius, max(_LARGEST_RADIUS, 2.0 * least_radius)
    found: tuple[float, ...] = (-math.inf,)
    for zoom in range(_ZOOMS):
        # At first steps grow like a cube from the least: small radii matter more.
        share = np.linspace(0.0, 1.0, _GRID if zoom == 0 else _FINE)
        radius = low + (high - low) * (share**3 if zoom == 0 else share)
        beyond = _best_shift(body, door, radius, side) if line is None else radius - line
        behind = _behind(body, door, radius, beyond, side)
        clearance = door_clearance(body, door, radius, beyond, behind)
        score = clearance + _EASE * np.minimum(radius, 2.0)
        k = int(score.argmax())
        values = (score, clearance, radius, beyond, behind)
        found = max(found, tuple(float(value[k]) for value in values))
        low, high = float(radius[max(k - 2, 0)]), float(radius[min(k + 2, len(radius) - 1)])
    return TurnArc(found[2], found[3], found[4], _RIGHT, found[1])


def _behind(
    body: ArcBody, door: DoorTurn, radius: Array, beyond: Array, side: float | None
) -> Array:
    """Return a_2 of arcs on a given line through the door, or clearing both jambs alike."""
    if side is None:
        return balanced_side(body, door, radius, beyond)
    return np.asarray(radius - side)


def _best_shift(body: ArcBody, door: DoorTurn, radius: Array, side: float | None) -> Array:
    """Return the shift a_1 of the greatest clearance for each radius (N,), [m].

    The further beyond the wall, the more the corridor's far wall is cleared and the less the
    jambs: one maximum, closed in on for all radii at once.
    """
    first = (np.hypot(body.rear, radius + 0.5 * body.width) - door.corridor)[:, None]
    rho, rows = radius[:, None], np.arange(len(radius))
    low = np.full_like(rho, -0.5)  # clearance of the corridor's far wall
    high = np.full_like(rho, max(door.corridor - body.width, 0.1))
    spare = low
    for _ in range(_SHIFT_ZOOMS):
        spare = low + (high - low) * np.linspace(0.0, 1.0, _SHIFTS)
        behind = _behind(body, door, rho, first + spare, side)
        best = door_clearance(body, door, rho, first + spare, behind).argmax(axis=1)
        low = spare[rows, np.maximum(best - 1, 0)][:, None]
        high = spare[rows, np.minimum(best + 1, _SHIFTS - 1)][:, None]
    return np.asarray(first[:, 0] + spare[rows, best])


def missing_door(
    body: ArcBody, door: DoorTurn, *, clearance: float = 0.0, least_radius: float = 0.0
) -> float:
    """Return by how much the door must be wider for one arc of a clearance [m], or 0."""
    return _missing(
        lambda more: (
            best_door_arc(
                body,
                DoorTurn(door.corridor, door.door + more, door.thickness),
                least_radius=least_radius,
            ).clearance
            - clearance
        ),
        most=2.0 * (body.front + body.rear + body.width),
    )


def missing_corridor(
    body: ArcBody, door: DoorTurn, *, clearance: float = 0.0, least_radius: float = 0.0
) -> float:
    """Return by how much the corridor must be wider; infinite where the door is too narrow [m]."""
    return _missing(
        lambda more: (
            best_door_arc(
                body,
                DoorTurn(door.corridor + more, door.door, door.thickness),
                least_radius=least_radius,
            ).clearance
            - clearance
        ),
        most=2.0 * (body.front + body.rear + body.width) + least_radius,
    )


def _missing(spare: Callable[[float], float], most: float) -> float:
    if spare(0.0) >= 0.0:
        return 0.0
    if spare(most) < 0.0:
        return math.inf
    low, high = 0.0, most
    for _ in range(_BISECTIONS):
        middle = 0.5 * (low + high)
        if spare(middle) < 0.0:
            low = middle
        else:
            high = middle
    return high
