"""A cubic Bezier between two poses has two unknowns, its legs, and regions bound them.

The control points next to the ends lie on the end tangents [DoorBezier, Eqs. (6), (11c), (11d)], at
a = |P0 P1| and b = |P2 P3|. The regions (5), (11b) and the complete convexity (7), (8), (11e) are
bounds on a and on b alone.

Convexity is a disjunction: Z_w1 Z_w2 > 0 holds turning left and turning right. The turn is known
from the end headings, so the right one of the two is taken: w1 and w2 both have the turn's sign.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from .. import bezier
from ..se2 import Array

SHORTEST_LEG = 0.02
"""Least leg of a curve [m]; a leg of length zero has no tangent."""


@dataclass(frozen=True, eq=False)
class LegBounds:
    """Where the legs may lie.

    Attributes:
        lower: Least a and b, shape (2,), [m].
        upper: Greatest a and b, shape (2,), [m].
        reason: Why there is no room, or empty.
    """

    lower: Array
    upper: Array
    reason: str = ""


def direction(heading: float) -> Array:
    """Return the unit vector of a heading, shape (2,)."""
    return np.array([math.cos(heading), math.sin(heading)])


def control_points(start: Array, end: Array, legs: Array) -> Array:
    """Return control points with legs on the end tangents [DoorBezier, Eqs. (6), (11c), (11d)].

    Args:
        start: Pose [x, y, heading], shape (3,).
        end: Pose, shape (3,).
        legs: a and b, shape (..., 2), [m].

    Returns:
        Control points, shape (..., 4, 2), [m].
    """
    legs = np.asarray(legs, dtype=float)
    first = start[:2] + legs[..., :1] * direction(start[2])
    second = end[:2] - legs[..., 1:] * direction(end[2])
    shape = first.shape
    ends = (np.broadcast_to(start[:2], shape), np.broadcast_to(end[:2], shape))
    return np.stack([ends[0], first, second, ends[1]], axis=-2)


def leg_bounds(start: Array, end: Array, region: Array, *, convex: bool) -> LegBounds:
    """Return the bounds that regions and convexity put on the two legs.

    With the turn c = u0 x u3 and the chord D: w1 = a (u0 x D - b c), w2 = b (D x u3 - a c), so
    (8) reads b < (u0 x D) / c and a < (D x u3) / c: P1 and P2 lie before the tangents' meeting.

    Args:
        start: Pose, shape (3,).
        end: Pose, shape (3,).
        region: Half-planes [n_x, n_y, c], n . p <= c, shape (H, 3); (5), (11b).
        convex: Whether the curve has to be completely convex.
    """
    u0, u3, chord = direction(start[2]), direction(end[2]), end[:2] - start[:2]
    size = float(np.linalg.norm(chord))
    lower = np.full(2, min(SHORTEST_LEG, 0.1 * size))
    upper = np.full(2, 3.0 * size)
    for k, (origin, along) in enumerate(((start[:2], u0), (end[:2], -u3))):
        for *normal, offset in region:
            room, speed = offset - float(np.dot(normal, origin)), float(np.dot(normal, along))
            if room < -1e-6:
                end_name = ("start", "end")[k]
                return LegBounds(lower, upper, f"its {end_name} lies {-room:.2f} m outside")
            if speed > 1e-12:
                upper[k] = min(upper[k], max(room, 0.0) / speed)
        if upper[k] < lower[k]:
            end_name = ("start", "end")[k]
            reason = f"the region leaves no room for a control point next to its {end_name}"
            return LegBounds(lower, upper, reason)
    if not convex:
        return LegBounds(lower, upper)
    return _convexity_bounds(lower, upper, u0, u3, chord)


def _convexity_bounds(lower: Array, upper: Array, u0: Array, u3: Array, chord: Array) -> LegBounds:
    turn = float(bezier.cross(u0, u3))
    from_start, to_end = float(bezier.cross(u0, chord)), float(bezier.cross(chord, u3))
    size = float(np.linalg.norm(chord))
    if abs(turn) < 1e-9:
        straight = abs(from_start) + abs(to_end) < 1e-9 * size and np.dot(u0, u3) > 0.0
        if straight or from_start * to_end > 0.0:
            return LegBounds(lower, upper)
        reason = (
            f"its end headings are parallel and {abs(from_start):.2f} m apart, so it would have "
            "to bend both ways; a completely convex curve cannot"
        )
        return LegBounds(lower, upper, reason)
    meeting = np.array([to_end / turn, from_start / turn])  # along u0, and back along u3
    side = "left" if turn > 0.0 else "right"
    degrees = math.degrees(abs(math.asin(max(-1.0, min(1.0, turn)))))
    if np.dot(u0, u3) < 0.0:
        degrees = 180.0 - degrees
    for k, where in enumerate(("behind its start", "beyond its end")):
        upper[k] = min(upper[k], meeting[k] * (1.0 - 1e-6))
        if upper[k] < lower[k]:
            reason = (
                f"it has to turn {side} by {degrees:.0f} deg, but its end tangents meet "
                f"{max(-meeting[k], 0.0):.2f} m {where}, so no completely convex curve exists"
            )
            return LegBounds(lower, upper, reason)
    return LegBounds(lower, upper)
