"""The body swept along the way to a stop, and what it would meet there."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..geometry import edge_normals
from ..se2 import Array
from ..vehicle import Vehicle
from .navigator_guard_options import GuardOptions
from .navigator_motion import CommandedMotion

_STEP = 0.02  # s: of the predicted way
_APART = 0.03  # m: way of a body point between two looks

FREE, UNSEEN = -1, -2
"""What is returned in place of a point: nothing is in the way; who comes from afar may be."""

Course = Callable[[Array], Array]
"""Poses (N, 3), from the body frame of now, that a chair comes through after distances (N,) [m]."""


class Obstacles(NamedTuple):
    """What must not be met, in the body frame of now.

    Attributes:
        points: Shape (N, 3), [m].
        walking: How fast each may move, shape (N,), [m/s].
        margins: Distance to keep from each, shape (N,), [m].
        is_new: Which were seen, and were not planned for, shape (N,).
    """

    points: Array
    walking: Array
    margins: Array
    is_new: NDArray[np.bool_]


class StoppingSweep:
    """A chair's body, layer by layer, and the brakes it is swept with."""

    def __init__(self, vehicle: Vehicle, options: GuardOptions) -> None:
        """Prepare the body's edges."""
        self._options, self._radius = options, vehicle.radius
        self._normals, self._offsets, self._heights = _half_planes(vehicle)

    @property
    def lowest(self) -> float:
        """A height at which the lowest layer meets what stands on the floor [m]."""
        return float(self._heights[:, 0].min()) + 1e-6

    def first_in_way(
        self,
        obstacles: Obstacles,
        motion: CommandedMotion,
        command: Array,
        age: float,
        course: Course | None = None,
    ) -> int:
        """Return the first point in the way to a stop after a command, or `FREE`, or `UNSEEN`.

        Args:
            obstacles: What must not be met.
            motion: How the chair moves now.
            command: v, omega for the coming period, shape (2,), [m/s, rad/s].
            age: Of the obstacles [s].
            course: The way the chair stops on; None: the arc of the command. Turns on the spot
                are arcs too.
        """
        from .navigator_kernels import stopping_poses

        chosen = self._options
        along = course is not None and command[0] != 0.0
        straight = np.array([1.0, 0.0 if along else 1.0])  # speeds alone, poses by the course
        apart = _APART
        if along:  # of the body's furthest point
            apart /= 1.0 + self._radius * abs(command[1] / command[0])
        rows, between = stopping_poses(
            motion.twist * straight,
            motion.pending() * np.append(1.0, straight),
            command * straight,
            (chosen.deceleration, chosen.yaw_deceleration),
            chosen.period,
            chosen.period / math.ceil(chosen.period / _STEP),
            chosen.lag,
            self._radius,
            apart,
        )
        if course is not None and along:
            rows[:, 1:] = course(np.abs(rows[:, 1]))
            between = self._between(rows)
        rows = np.vstack([rows, rows[-1]])
        rows[-1, 0] += chosen.standing
        if chosen.trusted_after > 0.0:  # else nobody walks
            body = np.hypot(rows[:, 1], rows[:, 2]) + self._radius
            walked = chosen.walking * (rows[:, 0] + age)
            if (body + walked + chosen.margin > chosen.reach).any():
                return UNSEEN
        return self._first_met(obstacles, rows, np.append(between, 0.0), age)

    def first_on_course(self, obstacles: Obstacles, course: Course) -> int:
        """Return the first point not planned for on a course within the berth, or `FREE`."""
        new = np.flatnonzero(obstacles.is_new)
        if not len(new) or self._options.berth <= 0.0:
            return FREE
        ahead = course(np.append(np.arange(0.0, self._options.berth, _APART), self._options.berth))
        rows = np.column_stack([np.zeros(len(ahead)), ahead])
        standing = Obstacles(
            obstacles.points[new], np.zeros(len(new)), obstacles.margins[new], obstacles.is_new[new]
        )
        found = self._first_met(standing, rows, self._between(rows), 0.0)
        return int(new[found]) if found >= 0 else FREE

    def _between(self, rows: Array) -> Array:
        """Return how far a body point is from its place at the nearer of the rows beside it."""
        steps = np.abs(np.diff(rows[:, 1:], axis=0))
        half = 0.5 * (np.hypot(steps[:, 0], steps[:, 1]) + self._radius * steps[:, 2])
        return np.asarray(np.maximum(np.append(half, 0.0), np.append(0.0, half)))

    def _first_met(self, obstacles: Obstacles, rows: Array, between: Array, age: float) -> int:
        """Return the first point a body comes too near at rows [t, x, y, heading], or `FREE`."""
        from .navigator_kernels import is_way_free

        planes = (self._normals, self._offsets, self._heights)
        points, walking, margins, _ = obstacles
        return int(is_way_free(points, walking, rows, between, *planes, margins, age))


def _half_planes(vehicle: Vehicle) -> tuple[Array, Array, Array]:
    """Return the layers' edges: normals (L, E, 2), offsets (L, E), heights (L, 2)."""
    most = max(len(layer.polygon) for layer in vehicle.layers)
    normals = np.zeros((len(vehicle.layers), most, 2))
    offsets = np.zeros((len(vehicle.layers), most))
    for row, layer in enumerate(vehicle.layers):
        edges = edge_normals(layer.polygon)
        filled = np.vstack([edges, np.repeat(edges[-1:], most - len(edges), axis=0)])
        normals[row] = filled
        offsets[row, : len(edges)] = np.einsum("ed,ed->e", edges, layer.polygon)
        offsets[row, len(edges) :] = offsets[row, len(edges) - 1]
    return normals, offsets, np.array([layer.z for layer in vehicle.layers])
