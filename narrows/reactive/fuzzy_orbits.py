"""Whether a chair driven by a rule table can circle its target for ever: the table's self-check.

In polar coordinates about the target, d' = -v cos phi and phi' = (v / d) sin phi - omega. A chair
that never reverses has v / omega >= L / 2, so a circle about the target at phi = +-90 degrees and
d* = v / omega always exists for rules that turn at all. It holds the chair unless it repels: its
trace T = (dv/dphi) / d* -+ domega/dphi must be positive, on both sides of a membership peak.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from ..errors import InputError
from ..se2 import Array
from .fuzzy_inference import outputs
from .fuzzy_table import RuleTable

_NUDGE = 1e-6  # rad: for one-sided derivatives of a piecewise linear surface
_LEAST_TRACE = 1e-6  # 1/s at a top speed of 1 m/s: rounding of a trace that is zero
_NEAR = 0.1  # m: a driven start has arrived
_LONGEST = 60.0  # s at a top speed of 1 m/s; the derived table needs 22
_STEP = 0.05  # s


@dataclass(frozen=True)
class Orbit:
    """A circle about the target on which the chair would stay.

    Attributes:
        side: +1: the target on the left, -1: on the right.
        distance: Its radius [m].
        trace: Rate at which it repels, at a top speed of 1 m/s [1/s]; the less of both sides of
            a peak. An orbit that is a saddle does not hold the chair either: infinite.
    """

    side: int
    distance: float
    trace: float


@lru_cache(maxsize=64)
def check_orbits(table: RuleTable, track: float) -> tuple[Orbit, ...]:
    """Return the orbits of a rule table if none of them can hold the chair.

    Three looks: rules that stand still away from the target, the trace of every orbit, and 192
    starts driven until they arrive (a cycle need not be a circle).

    Args:
        table: The rules.
        track: Distance between the drive wheels [m].

    Raises:
        InputError: If the chair can be held; says where.
    """
    _check_standing(table)
    found = orbits(table, track)
    for orbit in found:
        if orbit.trace <= _LEAST_TRACE:
            raise InputError(
                f"rule table '{table.name}' can circle its target for ever, "
                f"{orbit.distance:.2f} m off with the target {90 * orbit.side:+d} degrees aside "
                f"(trace {orbit.trace:+.3f} 1/s): let the speed rise and the turn fall with the "
                "angle about there",
                field="rules or angle peaks",
            )
    _check_driven(table, track)
    return found


def orbits(table: RuleTable, track: float) -> tuple[Orbit, ...]:
    """Return every circle about the target on which the chair would stay."""
    found = []
    for side in (1, -1):
        knots = np.append(table.distances, table.distances[-1] + 1.0)
        v, turn = _twist(table, knots, side * 0.5 * math.pi, track)
        turn = side * turn
        for k in range(len(knots) - 1):
            last = k == len(knots) - 2
            span = math.inf if last else knots[k + 1]
            slope_v = (v[k + 1] - v[k]) / (knots[k + 1] - knots[k])
            slope_turn = (turn[k + 1] - turn[k]) / (knots[k + 1] - knots[k])
            # v - d omega = 0 with both linear in d
            flat_v, flat_turn = v[k] - slope_v * knots[k], turn[k] - slope_turn * knots[k]
            for root in _roots(-slope_turn, slope_v - flat_turn, flat_v):
                if knots[k] <= root < span and root > 0.0:
                    falls = slope_v - flat_turn - 2.0 * slope_turn * root < 0.0
                    trace = _trace(table, root, side, track) if falls else math.inf
                    found.append(Orbit(side, root, trace))
    return tuple(found)


def _roots(square: float, linear: float, constant: float) -> list[float]:
    if abs(square) < 1e-12:
        return [-constant / linear] if abs(linear) > 1e-12 else []
    inside = linear * linear - 4.0 * square * constant
    if inside < 0.0:
        return []
    return [(-linear + sign * math.sqrt(inside)) / (2.0 * square) for sign in (1.0, -1.0)]


def _twist(table: RuleTable, distance: Array, angle: float | Array, track: float) -> Array:
    """Return v and omega at a top speed of 1 m/s, shape (2, ...)."""
    left, right = np.moveaxis(
        outputs(table, distance, np.broadcast_to(angle, distance.shape)), -1, 0
    )
    return np.stack([0.5 * (left + right), (right - left) / track])


def _trace(table: RuleTable, distance: float, side: int, track: float) -> float:
    at = side * 0.5 * math.pi
    angles = np.array([at - _NUDGE, at, at + _NUDGE])
    v, turn = _twist(table, np.full(3, distance), angles, track)
    slopes = (side * np.diff(v) / distance - np.diff(turn)) / _NUDGE
    return float(slopes.min())


def _check_standing(table: RuleTable) -> None:
    """Refuse rules by which the chair stands before it is there."""
    stands = (table.left == 0.0) & (table.right == 0.0)
    stands[:, 0] = False  # at the target
    if stands.any():
        angle, distance = (int(index) for index in np.argwhere(stands)[0])
        raise InputError(
            f"rule table '{table.name}' stands still {table.distances[distance]:.2f} m from its "
            f"target at {math.degrees(table.angles[angle]):.0f} degrees",
            field="rules",
        )


def _check_driven(table: RuleTable, track: float) -> None:
    """Refuse a table by which some start does not arrive."""
    near, bearing = np.meshgrid(np.geomspace(0.15, 6.0, 8), np.linspace(-np.pi, np.pi, 25)[1:])
    d, phi = near.ravel().copy(), bearing.ravel().copy()
    start = np.column_stack([d, phi])
    x, y, heading = -d, np.zeros_like(d), -phi  # the target is the origin
    away = np.ones(len(d), dtype=bool)
    for _ in range(round(_LONGEST / _STEP)):
        d = np.hypot(x, y)
        away &= d > _NEAR
        if not away.any():
            return
        phi = np.remainder(np.arctan2(-y, -x) - heading + np.pi, 2.0 * np.pi) - np.pi
        v, turn = _twist(table, d, phi, track)
        x = x + np.where(away, v * np.cos(heading + 0.5 * _STEP * turn) * _STEP, 0.0)
        y = y + np.where(away, v * np.sin(heading + 0.5 * _STEP * turn) * _STEP, 0.0)
        heading = heading + turn * _STEP
    worst = int(np.argmax(away))
    raise InputError(
        f"rule table '{table.name}' does not reach its target from {start[worst, 0]:.2f} m with "
        f"the target {math.degrees(start[worst, 1]):+.0f} degrees aside; it ends {d[worst]:.2f} m "
        f"off ({int(away.sum())} of {len(away)} starts)",
        field="rules or angle peaks",
    )
