"""To which side to steer past what is in the way, seen from the direction the user indicates."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ..errors import ShapeError
from .assistant_braking import ComfortBraking
from .assistant_look import Look
from .side_tables import Indicated, Side

LEFTMOST = {True: math.pi / 2.0, False: -math.pi / 2.0}
RIGHTMOST = {True: 0.0, False: -math.pi}
STRAIGHTS = {True: math.pi / 4.0, False: -3.0 * math.pi / 4.0}


@dataclass(frozen=True)
class AvoidanceOptions:
    """How a way past obstacles is looked for.

    Attributes:
        straight_band: Directions this near to straight count as indicating no side [rad].
        widest: Furthest deviation from the indicated direction phi [rad].
        step: Distance of the directions tried [rad].
        slow: Rim speed that is worth any deviation when the indicated direction is blocked [m/s].
        cost: Share of the speed a deviation by `widest` must be worth.
        change_cost: The same for changing the deviation of the last step by `widest`.
        gain: Least gain over braking alone, as a share of the speed asked for.
    """

    straight_band: float = math.radians(2.0)
    widest: float = math.radians(40.0)
    step: float = math.radians(2.0)
    slow: float = 0.2
    cost: float = 0.12
    change_cost: float = 0.06
    gain: float = 0.03

    def __post_init__(self) -> None:
        """Check the numbers."""
        for name, value in self.__dict__.items():
            if not (0.0 <= value < math.inf):
                raise ShapeError(f"{name} must be a finite number >= 0, got {value}")
        if not 0.0 < self.step <= self.widest <= 0.5 * math.pi:
            raise ShapeError(
                f"directions need 0 < step <= widest <= pi/2, got {self.step} and {self.widest}"
            )


def unwrapped(phi: float, forward: bool) -> float:
    """Return a direction in the half turn about straight ahead, or about straight back.

    >>> round(math.degrees(unwrapped(math.radians(170.0), forward=False)))
    -190
    """
    return phi if forward or phi <= 0.0 else phi - 2.0 * math.pi


def indicated_side(phi: float, forward: bool, straight_band: float) -> Indicated:
    """Return to which side the way of a direction bends; left is a greater phi, both ways."""
    bend = unwrapped(phi, forward) - STRAIGHTS[forward]
    if abs(bend) <= straight_band:
        return Indicated.STRAIGHT
    return Indicated.LEFT if bend > 0.0 else Indicated.RIGHT


def sides_to_try(
    part_limits: NDArray[np.float64],
    wanted: float,
    indicated: Indicated,
    table: NDArray[np.uint8],
    forward: bool,
) -> tuple[bool, bool]:
    """Return whether to look for a way to the left, and to the right.

    Every part of the body that limits the speed votes by its row of the table. Whoever drives
    straight at something wants to get there: one `straight` and nothing is tried. Votes for both
    sides, as between doorposts, look to both.

    Args:
        part_limits: Speed norm each part allows, shape (8,), [m/s].
        wanted: Speed norm the user asks for [m/s].
        indicated: Side the user indicates.
        table: Table of sides, shape (2, 8, 3).
        forward: Whether the user drives forward.
    """
    rows = table[0 if forward else 1, :, indicated]
    votes = {Side(side) for side in rows[part_limits < wanted].tolist()}
    if Side.STRAIGHT in votes:
        return False, False
    left = bool(votes & {Side.LEFT, Side.BOTH})
    right = bool(votes & {Side.RIGHT, Side.BOTH})
    return left, right


def way_past(
    look: Look,
    braking: ComfortBraking,
    phi: float,
    wanted: float,
    forward: bool,
    sides: tuple[bool, bool],
    last: float,
    options: AvoidanceOptions,
) -> float:
    """Return by how much to deviate from the indicated direction [rad]; 0: not at all.

    Of the directions to the sides to be tried, the one whose comfortable speed, less the costs of
    deviating and of changing one's mind, is greatest. Speeds beyond twice what the indicated
    direction allows, or beyond twice `slow`, are worth no more.

    Args:
        look: Obstacles.
        braking: Turns hard limits into comfortable ones.
        phi: Direction the user indicates [rad].
        wanted: Speed norm the user asks for [m/s].
        forward: Whether the user drives forward.
        sides: Whether the left and the right may be tried.
        last: Deviation of the step before [rad].
        options: Costs and limits.
    """
    best, chosen = -math.inf, 0.0
    blocked = braking.comfortable(look.limit(phi))
    wanted = min(wanted, 2.0 * max(blocked, options.slow))
    for deviation in _deviations(phi, forward, sides, options):
        if 1.0 - options.cost * abs(deviation) / options.widest < best:
            break  # not even a free way would be worth more
        limit = braking.comfortable(look.limit(phi + deviation))
        worth = min(limit, wanted) / wanted
        worth -= options.cost * abs(deviation) / options.widest
        worth -= options.change_cost * abs(deviation - last) / options.widest
        if deviation == 0.0:
            worth += options.gain
        if worth > best + 1e-9:
            best, chosen = worth, deviation
    return chosen


def _deviations(
    phi: float, forward: bool, sides: tuple[bool, bool], options: AvoidanceOptions
) -> list[float]:
    """Return the deviations to try, none first; the way may not bend beyond one wheel standing."""
    phi = unwrapped(phi, forward)
    count = int(options.widest / options.step + 1e-9)
    found = [0.0]
    for k in range(1, count + 1):
        deviation = k * options.step
        if sides[0] and phi + deviation <= LEFTMOST[forward]:
            found.append(deviation)
        if sides[1] and phi - deviation >= RIGHTMOST[forward]:
            found.append(-deviation)
    return found
