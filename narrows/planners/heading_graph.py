"""How free places hang together over all headings: surely, and at most.

The circle of headings is cut into intervals. At each cut the free cells of the body standing at
exactly that heading are the nodes. Inside an interval

- a cell free for the body's *sweep* surely joins the two nodes that hold it: the body can turn
  there from one heading to the other;
- a cell free for the body's *core* is the most that could be joined: nodes outside it cannot be
  reached through this interval.

If the goal is reached by sure joins, a way exists; if not even by possible ones, none does.
Otherwise the intervals whose possible joins decide are halved.

Rounding. Everything sure is computed for a body 10 um larger (20 um for sweeps), everything
possible for one 10 um smaller (20 um for cores). The overlay of polygons rounds by less than
1e-10 m at the size of a building, and by at most 1e-6 m where it must snap; so no rounding can
open or close a way, and nested cells stay nested with room to spare. A cell whose place in the
nesting is nevertheless not found is counted as an anomaly, and forbids the verdict it could
falsify.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field

import numpy as np
import shapely
from numpy.typing import NDArray

from ..se2 import Array
from .heading_slices import free_cells, turned_layers
from .passage_problem import PassageProblem

EPSILON = 1e-5  # m, see the module's docstring
FULL_TURN = 2.0 * math.pi
_SUM_TIME = 3e-5  # s for a piece at a heading: summed with the body and united with the others

Cells = NDArray[np.object_]
Indices = NDArray[np.int64]


@dataclass(frozen=True, eq=False)
class CellSet:
    """Disjoint free cells of one heading or heading interval.

    Attributes:
        cells: Polygons, shape (C,), [m].
        points: A point inside each, shape (C, 2), [m].
    """

    cells: Cells
    points: Array


@dataclass(eq=False)
class HeadingGraph:
    """Free cells at the cut headings and over the intervals between, for one growth of the body.

    Attributes:
        problem: The question.
        growth: How far every edge of the body is moved outward [m].
        window: x0, y0, x1, y1 the pivot is followed in; beyond it everything counts as
            possible and nothing as sure, shape (4,), [m].
        open_window: Whether possible ways may leave the window.
        headings: The cuts, increasing [rad]; the last interval ends at the first plus 2 pi.
    """

    problem: PassageProblem
    growth: float
    window: Array
    open_window: bool
    headings: list[float]
    sure_nodes: dict[float, CellSet] = field(default_factory=dict, init=False)
    possible_nodes: dict[float, CellSet] = field(default_factory=dict, init=False)
    sure_joins: dict[float, CellSet] = field(default_factory=dict, init=False)
    possible_joins: dict[float, CellSet] = field(default_factory=dict, init=False)

    def __post_init__(self) -> None:
        """Keep the obstacles near the window and the four sizes of the body."""
        reach = self.problem.reach(self.growth + 3.0 * EPSILON)
        # A sweep over +-15 deg reaches 1 / cos(15 deg) further than the body.
        near = [pieces.near(self.window, 1.1 * reach) for pieces in self.problem.pieces]
        self._inside = [pieces.inside for pieces in near]
        self._around = [pieces.around for pieces in near]
        self._bodies = {
            step: [b.grown(self.growth + step * EPSILON) for b in self.problem.layers]
            for step in (-2, -1, 1, 2)
        }

    @property
    def first_look_s(self) -> float:
        """About the process time that the cells of the first look at all headings take [s]."""
        return _SUM_TIME * 2 * len(self.headings) * sum(len(pieces) for pieces in self._inside)

    def half_angle(self, index: int) -> float:
        """Return half the width of interval `index` [rad]."""
        return 0.5 * (self._end(index) - self.headings[index])

    def _end(self, index: int) -> float:
        last = index == len(self.headings) - 1
        return self.headings[0] + FULL_TURN if last else self.headings[index + 1]

    def split(self, indices: Iterable[int]) -> None:
        """Halve the intervals with these indices; what was found for them is dropped."""
        for index in sorted(set(indices), reverse=True):
            begin = self.headings[index]
            self.sure_joins.pop(begin, None)
            self.possible_joins.pop(begin, None)
            middle = 0.5 * (begin + self._end(index))
            self.headings.insert(index + 1, middle)

    def update(self, *, possible: bool) -> None:
        """Compute the cells not yet known; the possible ones only if asked for."""
        cuts = [h for h in self.headings if h not in self.sure_nodes]
        self._fill(self.sure_nodes, cuts, [0.0] * len(cuts), cuts, step=1)
        self._fill_joins(self.sure_joins, step=2)
        if possible:
            cuts = [h for h in self.headings if h not in self.possible_nodes]
            self._fill(self.possible_nodes, cuts, [0.0] * len(cuts), cuts, step=-1)
            self._fill_joins(self.possible_joins, step=-2)

    def _fill_joins(self, store: dict[float, CellSet], step: int) -> None:
        todo = [i for i, h in enumerate(self.headings) if h not in store]
        # Halves of one interval get the same width to the last bit: their shapes are shared.
        halves = [math.ceil(self.half_angle(i) * 1e9) * 1e-9 for i in todo]
        middles = [0.5 * (self.headings[i] + self._end(i)) for i in todo]
        self._fill(store, [self.headings[i] for i in todo], halves, middles, step)

    def _fill(
        self,
        store: dict[float, CellSet],
        keys: Sequence[float],
        halves: Sequence[float],
        middles: Sequence[float],
        step: int,
    ) -> None:
        if not keys:
            return
        bodies = [
            turned_layers(self._bodies[step], middle, half, cover=step > 0)
            for middle, half in zip(middles, halves, strict=True)
        ]
        pieces = self._around if step > 0 else self._inside
        cells, owner = free_cells(bodies, pieces, self.window, self.problem.bounds)
        shapely.prepare(cells)
        points = shapely.get_coordinates(shapely.point_on_surface(cells))
        ends = np.searchsorted(owner, np.arange(len(keys) + 1))
        for i, key in enumerate(keys):
            part = slice(ends[i], ends[i + 1])
            store[key] = CellSet(cells[part], points[part])


def locate(points: Sequence[Array], cell_sets: Sequence[Cells]) -> list[Indices]:
    """Return for each group of points which cell of its group of disjoint cells holds each one.

    Args:
        points: Groups of points, shapes (N_g, 2), [m].
        cell_sets: For each group the cells, shapes (C_g,).

    Returns:
        For each group the index of the cell, shape (N_g,), -1 where none holds the point.
    """
    sizes = [(len(p), len(c)) for p, c in zip(points, cell_sets, strict=True)]
    if not sum(n * m for n, m in sizes):
        return [np.full(n, -1, dtype=np.int64) for n, _ in sizes]
    cells = np.concatenate([np.tile(c, len(p)) for p, c in zip(points, cell_sets, strict=True)])
    where = np.concatenate(
        [np.repeat(p, len(c), axis=0) for p, c in zip(points, cell_sets, strict=True)]
    )
    held = shapely.contains_xy(cells, where[:, 0], where[:, 1])
    found, begin = [], 0
    for n, m in sizes:
        table = held[begin : begin + n * m].reshape(n, m)
        begin += n * m
        found.append(np.where(table.any(axis=1), table.argmax(axis=1), -1) if m else np.full(n, -1))
    return [f.astype(np.int64) for f in found]


def holding(cells: NDArray[np.object_], point: Array) -> int:
    """Return the first cell that holds a point, or -1."""
    held = np.flatnonzero(shapely.intersects_xy(cells, point[0], point[1]))
    return int(held[0]) if len(held) else -1


def within(cells: NDArray[np.object_], point: Array, reach: float) -> Indices:
    """Return the cells that come within reach [m] of a point."""
    if not len(cells):
        return np.zeros(0, dtype=np.int64)
    return np.flatnonzero(shapely.dwithin(cells, shapely.Point(point), reach)).astype(np.int64)


def touching(cells: NDArray[np.object_], window: Array) -> Indices:
    """Return the cells that touch a side of the window [x_min, y_min, x_max, y_max]."""
    box = shapely.bounds(cells).reshape(-1, 4)
    return np.flatnonzero((np.abs(box - window) < 1e-7).any(axis=1)).astype(np.int64)
