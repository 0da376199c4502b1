"""The legs of a path: what is driven from rest to rest, and how fast each place allows."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise
from typing import NamedTuple

import numpy as np

from narrows.curvature_table import CurvatureTable
from narrows.limit_check import PERIOD
from narrows.path import Path
from narrows.se2 import Array
from narrows.vehicle import Vehicle

STOP_SPEED = 0.1
"""Where the curvature's jump allows less than this speed [m/s], the chair stops instead."""

MARGIN = 0.998
"""Share of a limit that is planned with; the rest is for rounding and for what is sampled."""

_SPACING = 0.02  # m, most between nodes
_LEAST_NODES, _MOST_NODES = 240, 1500
_SHARPEST = 0.25  # of the radius of the sharpest bend, most between nodes
_JUMP_SHARE = 0.8  # of the yaw acceleration for jumps: the rest is for bending meanwhile


class Excess(NamedTuple):
    """Shares of limits that a motion takes at N places; above 1 is too much.

    Attributes:
        speed: Speed in the cap at the place, shape (N,).
        yaw: Yaw acceleration |kappa' v^2 + kappa a| in its limit, shape (N,).
        bending: |kappa' v^2| alone in that limit, shape (N,).
    """

    speed: Array
    yaw: Array
    bending: Array


@dataclass(frozen=True, eq=False)
class Leg:
    """A stretch of path driven from rest to rest in one direction, with what limits it.

    Attributes:
        begin: Progress at its start.
        progress: Progress from its start at evenly spaced nodes, shape (N + 1,), [m] or [rad].
        top: Greatest speed anywhere on it, [m/s] or [rad/s].
        acceleration: Limit of the second derivative of progress.
        jerk: Limit of the third.
        cap: Greatest speed at the nodes that bend, wheels and jumps allow, shape (N + 1,).
        table: The path's curvature; None on the spot, where nothing depends on the place.
        vehicle: The chair.
    """

    begin: float
    progress: Array
    top: float
    acceleration: float
    jerk: float
    cap: Array
    table: CurvatureTable | None
    vehicle: Vehicle

    @property
    def span(self) -> float:
        """Progress at its end, from its start."""
        return float(self.progress[-1])

    def excess(self, progress: Array, speed: Array, acceleration: Array) -> Excess:
        """Return what a motion takes of the limits that depend on the place.

        Args:
            progress: Progress from the leg's start, shape (N,).
            speed: Its rate, shape (N,).
            acceleration: The rate of that, shape (N,).
        """
        over = speed / np.interp(progress, self.progress, self.cap)
        if self.table is None:
            return Excess(over, np.zeros_like(over), np.zeros_like(over))
        limits = self.vehicle.limits
        kappa, rate, kappa_off, rate_off = self.table.with_errors(self.begin + progress)
        over = np.maximum(over, speed / bend_cap(np.abs(kappa), self.vehicle, self.top))
        allowed = MARGIN * limits.yaw_acceleration
        off = kappa_off * np.abs(acceleration) + rate_off * speed**2
        bending = rate * speed**2
        yaw = np.abs(bending + kappa * acceleration) + off
        return Excess(over, yaw / allowed, np.abs(bending) / allowed)


def legs_of(path: Path, vehicle: Vehicle) -> list[Leg]:
    """Return the legs of a path in their order.

    A leg ends where the direction of travel changes, where the chair starts or ends turning on
    the spot or turns the other way, and where the curvature jumps by more than can be driven
    through at `STOP_SPEED`.
    """
    table, bounds, directions = path.curvature_table, path.section_bounds, path.directions
    where, step = table.jumps()
    allowed = _JUMP_SHARE * vehicle.limits.yaw_acceleration * PERIOD
    on_spot = directions[path.section_index(where)] == 0
    stops = on_spot | (np.abs(step) * STOP_SPEED > allowed)
    turning = bounds[1:-1][directions[1:] != directions[:-1]]
    ends = np.unique(np.concatenate([bounds[[0, -1]], turning, where[stops]]))
    ends = ends[np.concatenate([[True], np.diff(ends) > 1e-9])]
    ends[-1] = bounds[-1]
    legs = []
    for start, end in pairwise(ends.tolist()):
        direction = int(directions[path.section_index(0.5 * (start + end))])
        if direction == 0:
            legs.append(_spot_leg(start, end - start, vehicle))
        else:
            inside = (where > start + 1e-9) & (where < end - 1e-9)
            jumps = (where[inside] - start, step[inside])
            legs.append(_driven_leg(table, start, end - start, direction, jumps, vehicle))
    return legs


def bend_cap(kappa: Array, vehicle: Vehicle, top: float) -> Array:
    """Return the greatest speed that a curvature allows by itself, shape (N,), [m/s].

    Yaw rate, lateral acceleration kappa v^2, and the outer rim's speed v (1 + |kappa| track / 2).

    Args:
        kappa: Absolute curvature, shape (N,), [1/m].
        vehicle: Its limits and track.
        top: Greatest speed in this direction [m/s].
    """
    limits = vehicle.limits
    bend = np.maximum(kappa, 1e-9)
    rim = max(limits.speed, limits.reverse_speed) / (1.0 + 0.5 * vehicle.track * bend)
    cap = np.minimum(limits.yaw_rate / bend, np.sqrt(limits.lateral_acceleration / bend))
    return np.asarray(MARGIN * np.minimum(np.minimum(cap, rim), top))


def _spot_leg(begin: float, span: float, vehicle: Vehicle) -> Leg:
    """Return a turn on the spot: its rims keep the limits of speed, acceleration and jerk."""
    limits, rim = vehicle.limits, 2.0 / vehicle.track
    top = MARGIN * min(limits.yaw_rate, rim * max(limits.speed, limits.reverse_speed))
    acceleration = MARGIN * min(limits.yaw_acceleration, rim * limits.acceleration)
    nodes = np.array([0.0, span])
    jerk = rim * limits.jerk
    return Leg(begin, nodes, top, acceleration, jerk, np.full(2, top), None, vehicle)


def _driven_leg(
    table: CurvatureTable,
    begin: float,
    span: float,
    direction: int,
    jumps: tuple[Array, Array],
    vehicle: Vehicle,
) -> Leg:
    limits = vehicle.limits
    top = limits.speed if direction > 0 else limits.reverse_speed
    sharp = min(_MOST_NODES, span * table.greatest / _SHARPEST)
    count = int(np.ceil(max(_LEAST_NODES, sharp, span / _SPACING)))
    nodes = np.linspace(0.0, span, count + 1)
    kappa, rate = (np.abs(values) for values in table(begin + nodes))
    # at full bend rate the whole yaw acceleration goes into v^2 dkappa/ds
    steady = np.sqrt(MARGIN * limits.yaw_acceleration / np.maximum(rate, 1e-9))
    cap = np.minimum(bend_cap(kappa, vehicle, top), steady)
    acceleration = limits.acceleration
    if np.ptp(kappa) <= 1e-9:  # a line or an arc: the yaw acceleration is kappa a throughout
        acceleration = min(acceleration, limits.yaw_acceleration / max(float(kappa[0]), 1e-9))
    if len(jumps[0]):
        cap = np.minimum(cap, _jump_cap(nodes, *jumps, vehicle=vehicle, top=top))
    return Leg(begin, nodes, top, acceleration, limits.jerk, cap, table, vehicle)


def _jump_cap(nodes: Array, where: Array, step: Array, *, vehicle: Vehicle, top: float) -> Array:
    """Return the speed at which the curvature's jumps may be driven through, shape (N + 1,).

    At speed v the jumps met within a control period together change the yaw rate by v times
    their sum; that may be no more than the yaw acceleration allows in that period. The greatest
    of 24 speeds is taken up to which all keep this.
    """
    allowed = _JUMP_SHARE * vehicle.limits.yaw_acceleration * PERIOD
    total = np.concatenate([[0.0], np.cumsum(step)])
    first = np.arange(len(where))
    cap = np.full(len(where), np.inf)
    for speed in np.geomspace(top, min(STOP_SPEED, top), 24):
        last = np.searchsorted(where, where + PERIOD * speed, side="right")
        greatest = np.abs(total[last] - total[first])
        wrong = np.maximum(greatest, np.abs(step)) * speed > allowed
        cap[wrong] = np.inf
        cap[~wrong & np.isinf(cap)] = speed
    cap = np.where(np.isinf(cap), min(STOP_SPEED, top), cap)
    result = np.full(len(nodes), top)
    reach = PERIOD * top
    low = np.searchsorted(nodes, where - reach, side="right") - 1
    high = np.searchsorted(nodes, where + reach, side="left")
    for a, b, speed in zip(np.maximum(low, 0), high, cap, strict=True):
        result[a : b + 1] = np.minimum(result[a : b + 1], speed)
    return result
