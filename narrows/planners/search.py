"""A coarse manoeuvre: search over position and heading with the exact body, reversing included.

A chair's moves are arcs, lines and, where it may, turns on the spot; each is proven clear by
conservative advancement (`search_collision`). Best-first search over cells of position and heading
grows a tree of moves from the start or, backwards, from the goal; from its nodes arc-line-arc
connections to the other end are tried, and the cheapest found ends the search once nothing cheaper
can be left. The estimate of what is left is the larger of two bounds, the way of the body's
inscribed disc over a grid and the length of the turn still to make; with weight 1 the search is
admissible up to its cells, else the cost is at most `weight` times the best one's in its cells.

Several such searches form a ladder (`search_options.ladder`), from quick and greedy to thorough
and fine. The result is the same every time: nothing is random, budgets are counts.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING

import numpy as np

from ..clearance import clearance_at
from ..interfaces import Plan, PlanStatus
from ..path import Path
from ..scene import Scene
from .finish import finished_plan
from .planning_clock import clock
from .search_options import Rung, SearchOptions, ladder
from .search_path import path_of

if TYPE_CHECKING:
    from .search_rung import Ground, Outcome

_DISTINCT = (0.25, math.radians(20.0))  # m, rad: manoeuvres nearer to each other are one
_GLANCE = 5  # part of a quick search spent on looking for a cheaper way with reversing
_SHUT_IN = 1000  # expansions: an end from which a search has no more may be shut in
_COMPARED = 33  # places along two manoeuvres that are compared


@dataclass(frozen=True, eq=False)
class Manoeuvre:
    """A way through a scene, found by a search and not certified.

    Attributes:
        path: Constant twists; sections end where the direction of travel changes.
        cost: Its cost: length, changes of direction, turns on the spot, crowding [m].
        clearance: Least clearance the search asked for [m].
    """

    path: Path
    cost: float
    clearance: float


@dataclass(frozen=True, eq=False)
class SearchResult:
    """What a search has to say.

    Attributes:
        manoeuvre: What was found, or None.
        reason: How the search ended, for people.
        is_exhausted: Whether nothing was left to try at the finest resolution. This is no proof
            that there is no way.
        statistics: `expansions`, `nodes`, `searches`.
    """

    manoeuvre: Manoeuvre | None
    reason: str
    is_exhausted: bool = False
    statistics: dict[str, float] = field(default_factory=dict)


class SearchPlanner:
    """Plans by search.

    Attributes:
        options: Resolution, costs, budget.
    """

    def __init__(self, options: SearchOptions | None = None) -> None:
        """Keep the options."""
        self.options = SearchOptions() if options is None else options

    def plan(self, scene: Scene) -> Plan:
        """Return a certified plan, or `not_found` with how the search ended.

        The chair stops wherever the curvature changes, as no chair can change it in no time.
        """
        result = self._search(scene, at_rest=True)
        if result.manoeuvre is None:
            return Plan(PlanStatus.NOT_FOUND, "search", result.reason, statistics=result.statistics)
        return finished_plan(
            scene, result.manoeuvre.path, planner="search", statistics=result.statistics
        )

    def search(self, scene: Scene) -> SearchResult:
        """Return the first manoeuvre the ladder of searches finds, or why there is none.

        Where reversing is allowed a way with changes of direction replaces one without if it is
        cheaper.
        """
        return self._search(scene, at_rest=False)

    def search_many(self, scene: Scene, count: int) -> Iterator[Manoeuvre]:
        """Yield up to `count` distinct manoeuvres, the one of `search` first, each when asked for.

        Distinct: another sequence of directions, or somewhere more than 0.25 m or 20 degrees
        apart. They come from growing from either end, with and without reversing, for more or
        less clearance.

        Args:
            scene: The scene.
            count: Most manoeuvres wanted.
        """
        first = self.search(scene).manoeuvre
        if first is None or count < 1:
            return
        yield first
        found = [first]
        for options, rung in self._variants(scene, first.clearance):
            if len(found) >= count:
                return
            outcome = _ground(scene, options).search(rung, rung.budget)
            manoeuvre = _manoeuvre(scene, outcome, rung, at_rest=False)
            if manoeuvre and all(are_distinct(manoeuvre.path, other.path) for other in found):
                found.append(manoeuvre)
                yield manoeuvre

    def _search(self, scene: Scene, *, at_rest: bool) -> SearchResult:
        options = self.options
        problem = _blocked_end(scene, options.least_clearance)
        if problem:
            return SearchResult(None, problem, is_exhausted=True)
        reversing = scene.vehicle.limits.reverse_speed > 0.0
        ground = _ground(scene, options)
        used = {"expansions": 0.0, "nodes": 0.0, "searches": 0.0}
        finest = math.inf  # scale of the finest cells that were exhausted
        waiting = list(ladder(options, scene.margin, reversing=reversing))
        while waiting and used["expansions"] < options.budget:
            rung = waiting.pop(0)
            left = options.budget - int(used["expansions"])
            outcome = ground.search(rung, min(rung.budget, left))
            _count(used, outcome)
            if outcome.way is not None:
                if reversing and not rung.reversing:
                    rung, outcome = _cheaper(ground, rung, outcome, used)
                manoeuvre = _manoeuvre(scene, outcome, rung, at_rest=at_rest)
                return SearchResult(manoeuvre, "found", statistics=used)
            if outcome.is_exhausted and rung.floor <= options.least_clearance:
                if rung.reversing == reversing and rung.is_thorough != reversing:
                    finest = min(finest, rung.scale)
                    if rung.scale <= 0.5**options.refinements:
                        break
                is_shut_in = outcome.expansions < _SHUT_IN
                waiting = _after_exhaustion(waiting, rung, options.quick_budget, is_shut_in)
        return SearchResult(None, self._ending(used, finest), finest < math.inf, used)

    def _ending(self, used: dict[str, float], scale: float) -> str:
        if scale == math.inf:
            return f"budget of {used['expansions']:.0f} expansions spent without finding a way"
        cell = 1e3 * self.options.cell * scale
        turn = math.degrees(self.options.heading_cell) * scale
        return (
            f"search space exhausted at resolution {cell:.1f} mm, {turn:.2f} deg after "
            f"{used['expansions']:.0f} expansions; a finer one may still find a way"
        )

    def _variants(self, scene: Scene, clearance: float) -> Iterator[tuple[SearchOptions, Rung]]:
        """Yield searches that differ in where they grow from, in reversing, and in taste.

        They ask for the clearance the first one kept, then for the least.
        """
        options = self.options
        floors = sorted({clearance, options.least_clearance}, reverse=True)
        tastes = (
            (options, False),
            (replace(options, crowding=4.0 * options.crowding), True),
            (replace(options, crowding=0.0), False),
        )
        reversing = (False, True) if scene.vehicle.limits.reverse_speed > 0.0 else (False,)
        for taste, is_thorough in tastes:
            for backs in reversing:
                for from_goal in (False, True):
                    for floor in floors:
                        budget = 2 * options.quick_budget
                        yield taste, Rung(from_goal, backs, floor, 1.0, is_thorough, budget)


def _ground(scene: Scene, options: SearchOptions) -> Ground:
    """Return the scene packed for the compiled searches; imports numba, so only when asked."""
    with clock.loading():
        from .search_rung import Ground

    return Ground(scene, options)


def _cheaper(
    ground: Ground, rung: Rung, outcome: Outcome, used: dict[str, float]
) -> tuple[Rung, Outcome]:
    """Return a way with reversing if a quick search finds a cheaper one, else the one given."""
    if outcome.way is None:
        return rung, outcome
    other = replace(rung, reversing=True)
    challenger = ground.search(other, other.budget // _GLANCE, bound=outcome.way.cost)
    _count(used, challenger)
    return (rung, outcome) if challenger.way is None else (other, challenger)


def _after_exhaustion(waiting: list[Rung], rung: Rung, quick: int, is_shut_in: bool) -> list[Rung]:
    """Return the searches still worth trying after one found nothing more to expand.

    The same with more budget is not. In cells of the first size both ends are tried, as a cell is
    entered once and a narrow way may be lost from one end and not from the other; in finer ones
    the same end comes first: it says soonest whether it is shut in. So it does at once where it
    looks shut in, with next to nothing to expand.
    """
    ends = (rung.from_goal, rung.reversing)

    def order(other: Rung) -> tuple[bool, bool, bool]:
        is_long = other.budget > 2 * quick
        is_other_end = is_long and (other.from_goal, other.reversing) != ends
        is_finer = other.scale < 1.0
        return (
            (is_long, is_other_end, is_finer) if is_shut_in else (is_long, is_finer, is_other_end)
        )

    return sorted((r for r in waiting if r.space != rung.space), key=order)


def _count(used: dict[str, float], outcome: Outcome) -> None:
    used["expansions"] += outcome.expansions
    used["nodes"] += outcome.nodes
    used["searches"] += 1


def _manoeuvre(scene: Scene, outcome: Outcome, rung: Rung, *, at_rest: bool) -> Manoeuvre | None:
    way = outcome.way
    if way is None or not len(way.drives):
        return None
    path = path_of(way.poses, way.drives, scene.start, at_rest=at_rest)
    return Manoeuvre(path, way.cost, rung.floor)


def _blocked_end(scene: Scene, least: float) -> str:
    """Return which end of the way is blocked and by what, or an empty string."""
    poses = np.stack([scene.start, scene.goal.pose])
    distance, against = clearance_at(scene.world, scene.vehicle, poses)
    if distance[0] < least:
        return (
            f"at the start the body is {1e3 * distance[0]:.1f} mm from {against[0]}, "
            f"less than the {1e3 * least:.1f} mm a move must keep"
        )
    return ""


def are_distinct(first: Path, second: Path) -> bool:
    """Return whether two paths change direction differently or are somewhere far apart."""
    if first.directions.tolist() != second.directions.tolist():
        return True
    part = np.linspace(0.0, 1.0, _COMPARED)
    gap = np.abs(first(part * first.span) - second(part * second.span))
    apart = np.hypot(gap[:, 0], gap[:, 1]).max()
    return bool(apart > _DISTINCT[0] or gap[:, 2].max() > _DISTINCT[1])
