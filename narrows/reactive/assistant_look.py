"""What the safety regions say of the obstacles around the chair at one step."""

from __future__ import annotations

import numpy as np

from ..geometry import edge_normals
from ..se2 import Array
from ..vehicle import Vehicle
from .assistant_kernels import FRAMES, braking_frames, place, speed_limit
from .safety_regions import SafetyRegions
from .safety_regions_painting import motions_of
from .side_tables import PARTS

_NEAR_RIMS = (0.05, 0.1, 0.15, 0.2, 0.3, 0.4, 0.5)
"""Rim speeds at which near points are tried against the body itself, not its cells [m/s]."""

_CREEP = 0.2 + 1e-9
"""Speed norm up to which a quarter of the margin is enough: slow chairs get out of tight places."""

_ROOM = 40_000  # cells of points that can be looked at; more and nothing is taken for free
_NO_PARTS = np.zeros(0)


class Look:
    """Looks obstacles up in a chair's safety regions; made once, shown the points at each step."""

    def __init__(
        self, vehicle: Vehicle, regions: SafetyRegions, *, unknown_norm: float = 0.0
    ) -> None:
        """Prepare the brakings looked at exactly.

        Args:
            vehicle: The chair.
            regions: Its regions.
            unknown_norm: Speed norm allowed into unknown places [m/s].
        """
        self._unknown_norm = unknown_norm
        self._regions = regions
        self._height = vehicle.height
        self._edges = edge_rows(regions.outline)
        self._cells = np.empty(_ROOM, dtype=np.int32)
        self._where = np.empty((_ROOM, 4))
        self._latest = np.zeros(regions.levels[0].size, dtype=np.int32)
        self._count = 0
        near = 2.0 * np.array(_NEAR_RIMS)
        self._near = near[near <= regions.norms[-1] + 1e-9]
        self._keeps = np.full(len(self._near), regions.keep)
        options = regions.options
        self._brakings = np.empty((options.directions, len(self._near), 3 * FRAMES, 4))
        for k in range(options.directions):
            motions, timing = motions_of(k, regions.track, options)
            braking_frames(motions, self._near, timing, self._brakings[k])

    def show(self, points: Array, unknown: Array, spread: float, pose: Array) -> None:
        """Take in the obstacles of a step.

        Args:
            points: Obstacles in the body frame, z above the floor, shape (N, 3), [m].
            unknown: Unknown places, body frame, shape (M, 2), [m].
            spread: How far an obstacle may reach beyond its point [m].
            pose: Where the chair will be when a command takes effect, body frame, shape (3,).
        """
        regions = self._regions
        options = regions.options
        self._keeps = spread + options.margin * np.where(self._near > _CREEP, 1.0, 0.25)
        grown = max(0.0, spread - options.spread)
        _, rows, columns = regions.levels.shape
        count = 0
        for which, is_unknown, anyway in (
            (points, False, 0.0),
            (unknown, True, self._unknown_norm),
        ):
            count = place(
                np.ascontiguousarray(which), self._height, grown, is_unknown, anyway, pose,
                regions.lower, options.cell, rows, columns, self._edges, self._cells, self._where,
                self._latest, count,
            )  # fmt: skip
        self._count = count

    def limit(self, phi: float) -> float:
        """Return the greatest speed norm at which a full braking in a direction stays clear [m/s].

        Infinite if no point lies in the direction's region at any speed it knows of.

        Args:
            phi: Direction [rad].
        """
        return self._limit(phi, _NO_PARTS)

    def part_limits(self, phi: float) -> Array:
        """Return the limit each part of the body sets to a direction, shape (8,), [m/s]."""
        limits = np.empty(len(PARTS))
        self._limit(phi, limits)
        return limits

    def _limit(self, phi: float, part_limits: Array) -> float:
        if self._count == _ROOM:
            part_limits[:] = 0.0
            return 0.0
        regions = self._regions
        k = regions.index(phi)
        count = self._count
        return speed_limit(
            regions.levels[k], regions.parts[k], self._cells[:count], self._where[:count],
            regions.norms, self._near, self._keeps, self._brakings[k], self._edges, part_limits,
        )  # fmt: skip


def edge_rows(outline: Array) -> Array:
    """Return a body's edges as rows [n_x, n_y, c], n . p <= c inside, shape (K, 3)."""
    normals = edge_normals(outline)
    return np.column_stack([normals, np.einsum("kd,kd->k", normals, outline)])
