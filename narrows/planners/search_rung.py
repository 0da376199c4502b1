"""One compiled search: arrays in, the poses and moves of a way out. Imports numba."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise

import numpy as np

from ..clearance import clearance_at
from ..scene import Scene
from ..se2 import Array
from .search_collision import Solids, advance
from .search_kernel import EXHAUSTED, FOUND, grow
from .search_options import Rung, SearchOptions
from .search_tables import Room, Rules, Tree
from .search_terrain import terrain_of

_SPAN = 0.2  # m: longest piece of a connection checked at once
_ATTEMPTS = 0.5  # m
_OFF_GOAL = 0.3  # m: cost of ending beside the goal, within its tolerances
_WITHIN = 0.95  # part of the tolerances used


@dataclass(frozen=True, eq=False)
class Way:
    """What one search found.

    Attributes:
        poses: Poses in driving order, shape (N, 3).
        drives: v, heading rate and length of the move to each pose but the first, (N - 1, 3).
        cost: Its cost [m].
    """

    poses: Array
    drives: Array
    cost: float


@dataclass(frozen=True, eq=False)
class Outcome:
    """How one search ended.

    Attributes:
        way: The way, or None.
        is_exhausted: Whether there was nothing left to expand.
        expansions: Poses expanded.
        nodes: Poses reached.
    """

    way: Way | None
    is_exhausted: bool
    expansions: int
    nodes: int


class Ground:
    """A scene as the compiled searches want it, shared by all of them."""

    def __init__(self, scene: Scene, options: SearchOptions) -> None:
        """Pack the scene, or take it as packed for the search before."""
        self.scene = scene
        self.options = options
        self.terrain = terrain_of(scene, max(_SPAN, options.step), options.care)
        self.solids: Solids = self.terrain.solids

    @cached_property
    def goals(self) -> Array:
        """Poses to end at and what each costs, the goal itself first, shape (G, 4)."""
        goal = self.scene.goal
        around = np.arange(6) * np.pi / 3.0
        places = _WITHIN * goal.position_tolerance * np.stack([np.cos(around), np.sin(around)], 1)
        turns = _WITHIN * goal.heading_tolerance * np.array([0.0, -1.0, 1.0])
        rows = [[*goal.pose, 0.0]]
        rows += [
            [goal.pose[0] + x, goal.pose[1] + y, goal.pose[2] + turn, _OFF_GOAL]
            for x, y in places
            for turn in turns
        ]
        return np.array(rows)

    def search(self, rung: Rung, budget: int, bound: float = math.inf) -> Outcome:
        """Run one search for a way that costs less than a bound.

        Args:
            rung: Which.
            budget: Most expansions.
            bound: Cost to beat [m].
        """
        rules = self._rules(rung, budget)
        goal = self.scene.goal
        if rung.from_goal:
            free = self._is_free(self.goals[:, :3], rung.floor)
            roots, field = self.goals[free], self.terrain.to_start
            target = np.array([*self.scene.start, 0.0, 0.0])
        else:
            free = self._is_free(self.scene.start[None], rung.floor)
            roots, field = np.array([[*self.scene.start, 0.0]])[free], self.terrain.to_goal
            target = np.array(
                [*goal.pose, _WITHIN * goal.position_tolerance, _WITHIN * goal.heading_tolerance]
            )
        if not len(roots):
            return Outcome(None, True, 0, 0)
        room = _room(budget, len(roots), len(rules.drives), self.solids.body.shape[1])
        state = np.zeros(4, dtype=np.int64)
        cost = np.array([bound])
        ended = grow(self.solids, field, rules, roots, target, room, state, cost)
        way = None
        if ended == FOUND:
            way = _way(room, int(state[3]), float(cost[0]))
            way = _reversed(way) if rung.from_goal else way
        return Outcome(way, ended == EXHAUSTED, int(state[2]), int(state[0]))

    def _is_free(self, poses: Array, floor: float) -> Array:
        distance, _ = clearance_at(self.scene.world, self.scene.vehicle, poses)
        return np.asarray(distance >= floor)

    def _rules(self, rung: Rung, budget: int) -> Rules:
        options, vehicle = self.options, self.scene.vehicle
        spot = vehicle.may_turn_on_the_spot
        tightest = options.tightest_arc if spot else vehicle.limits.curvature
        ways = [-1.0 if rung.from_goal else 1.0]
        if rung.reversing:
            ways.append(-ways[0])
        step, turn = options.step * rung.scale, options.heading_cell * rung.scale
        parts = _with_middles(options.curvatures) if rung.is_thorough else options.curvatures
        drives = [[v, part * tightest, step] for v in ways for part in parts]
        if spot:
            drives += [[0.0, side, 2.0 * turn] for side in (-1.0, 1.0)]
        return Rules(
            drives=np.array(drives),
            radius=0.0 if spot else 1.0 / tightest,
            cell=options.cell * rung.scale,
            sectors=max(math.ceil(2.0 * math.pi / turn - 1e-9), 4),
            floor=rung.floor,
            care=max(options.care, rung.floor),
            crowding=options.crowding,
            spot=options.spot_cost,
            change=options.change_cost,
            weight=math.sqrt(options.weight) if rung.is_thorough else options.weight,
            budget=budget,
            attempts=_ATTEMPTS,
        )


def _with_middles(parts: tuple[float, ...]) -> tuple[float, ...]:
    """Return the numbers in order and the middles between them."""
    ordered = sorted(set(parts))
    return tuple(sorted({*ordered, *(0.5 * (a + b) for a, b in pairwise(ordered))}))


def _room(budget: int, roots: int, moves: int, corners: int) -> Room:
    """Return working arrays for a search; pages that are not used cost nothing."""
    count = 2 * budget + roots + moves
    size = 1 << (2 * count - 1).bit_length()
    whole = np.int64
    return Room(
        Tree(
            np.empty((count, 3)),
            np.empty((count, 4)),
            np.empty(count, dtype=whole),
            np.empty(count),
        ),
        np.empty(count),
        np.empty(count, dtype=np.bool_),
        np.empty(count),
        np.empty(count, dtype=whole),
        np.full((size, 2), -1, dtype=whole),
        np.empty((corners, 4)),
        np.empty((3, 3)),
        np.empty((3, 3)),
    )


def _way(room: Room, node: int, cost: float) -> Way:
    """Return the way from a root to a node and over the connection found there."""
    nodes = list(_upwards(room.tree, node))[::-1]
    poses = [room.tree.pose[k].copy() for k in nodes]
    drives = [room.tree.drive[k, :3].copy() for k in nodes[1:]]
    for v, omega, length in room.last:
        if length <= 1e-9:
            continue
        parts = math.ceil(abs(omega * length) / (0.5 * math.pi) + 1e-9) if omega else 1
        for _ in range(parts):
            x, y, heading = poses[-1]
            poses.append(np.array(advance(x, y, heading, v, omega, length / parts)))
            drives.append(np.array([v, omega, length / parts]))
    return Way(np.array(poses), np.array(drives).reshape(-1, 3), cost)


def _upwards(tree: Tree, node: int) -> Iterator[int]:
    while node >= 0:
        yield node
        node = int(tree.parent[node])


def _reversed(way: Way) -> Way:
    """Return the way driven from its end to its beginning: every move undone.

    Undoing a move of rate omega at direction v: direction -v; the heading turns back, -omega.
    """
    return Way(way.poses[::-1], way.drives[::-1] * np.array([-1.0, -1.0, 1.0]), way.cost)
