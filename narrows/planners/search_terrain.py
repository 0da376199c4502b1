"""The part of a search's input that only a scene's bodies and places decide. Imports numba."""

from __future__ import annotations

import math
from functools import cached_property, lru_cache

import numpy as np
from numpy.typing import NDArray

from ..scene import Scene
from ..se2 import Array
from .search_collision import Solids
from .search_field import blocked_cells, pack_solids, way_field
from .search_tables import Field

_FIELD_CELL, _MOST_CELLS = 0.05, 250_000
_CANDIDATE_CELL = 0.2  # m


@lru_cache(maxsize=1)
def terrain_of(scene: Scene, span: float, care: float) -> Terrain:
    """Return a scene packed; the last one is kept, as a plan searches one scene many times.

    Args:
        scene: The scene.
        span: Longest arc checked at once [m].
        care: Gaps above are not told apart [m].
    """
    return Terrain(scene, span, care)


class Terrain:
    """Where the body may be, what it may touch there, and bounds on the way left.

    Attributes:
        region: Box the body origin may be in, shape (4,), [m].
        solids: Body and solids for the compiled loops.
    """

    def __init__(self, scene: Scene, span: float, care: float) -> None:
        """Pack the scene."""
        self.scene = scene
        self.region = _region(scene)
        cell = self._cell_from(_CANDIDATE_CELL)
        self.solids: Solids = pack_solids(scene, self.region, span, care, cell)

    @cached_property
    def to_goal(self) -> Field:
        """Bound on the way to the goal."""
        return self._field(self.scene.goal.pose)

    @cached_property
    def to_start(self) -> Field:
        """Bound on the way to the start."""
        return self._field(self.scene.start)

    @cached_property
    def _cell(self) -> float:
        return self._cell_from(_FIELD_CELL)

    def _cell_from(self, least: float) -> float:
        """Return the side of a cell [m]: the least, but more where the cells would be too many."""
        area = float(np.prod(self.region[2:] - self.region[:2]))
        return max(least, math.sqrt(area / _MOST_CELLS))

    @cached_property
    def _blocked(self) -> NDArray[np.bool_]:
        return blocked_cells(self.scene, self.solids, self.region, self._cell)

    def _field(self, target: Array) -> Field:
        return way_field(self._blocked, self.region, target, self._cell)


def _region(scene: Scene) -> Array:
    """Return the box the body origin may be in, shape (4,): the bounds, or all there is and more.

    The body's length and two of its tightest turns are left around everything.
    """
    if scene.world.bounds is not None:
        return np.array(scene.world.bounds, dtype=float)
    vehicle = scene.vehicle
    points = [scene.start[:2], scene.goal.pose[:2]]
    for layer in vehicle.layers:
        pieces = scene.world.pieces_between(*layer.z)
        points += [*pieces.low, *pieces.high]
    radius = 0.0 if vehicle.may_turn_on_the_spot else 1.0 / vehicle.limits.curvature
    around = 2.0 * vehicle.radius + 4.0 * radius
    return np.concatenate([np.min(points, axis=0) - around, np.max(points, axis=0) + around])
