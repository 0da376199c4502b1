"""Where start and goal come apart when the body grows by a hair: the narrowest place."""

from __future__ import annotations

import math
from itertools import product

import numpy as np
import shapely

from ..se2 import Array
from .heading_graph import FULL_TURN, HeadingGraph
from .passage_refinement import Answer, Decision, decide
from .passage_windows import PassageDecider

_PATIENCE = 4.0  # s beyond the deadline: what people ask for first is the place

Sides = tuple[list[shapely.Polygon], list[shapely.Polygon]]


def blocked_end(apart: Decision) -> Array | None:
    """Return where the pivot would be at start or goal if the body does not fit there, (2,), [m].

    Args:
        apart: A decision that start and goal are apart.
    """
    problem = apart.graph.problem
    if not apart.network.start_is_possible:
        return problem.start[:2]
    if not apart.network.goal_is_possible:
        return problem.goal_pivot(float(problem.goal[2]))
    return None


def narrowest_place(decider: PassageDecider, joined: Decision, apart: Decision) -> Array | None:
    """Return where the pivot is in the narrowest place, shape (2,), in the problem's frame [m].

    None where finding out would take much longer than the time given.

    A way of the largest body that passes is laid over the free places of the smallest that does
    not, in the window that holds the way. Along it, the places still reached from the start and
    those that still reach the goal come nearest to each other in the narrowest place.

    Args:
        decider: Decides about grown bodies.
        joined: The largest body known to pass.
        apart: The smallest body known not to.
    """
    problem = decider.problem
    end = blocked_end(apart)
    if end is not None:
        return end
    chain = joined.network.way()
    cuts = {*problem.headings, *apart.graph.headings, *(step.heading for step in chain)}
    window = joined.graph.window
    graph = HeadingGraph(problem, apart.graph.growth, window, False, sorted(cuts))
    if decider.is_too_long(graph, _PATIENCE):
        return None
    again = decide(graph, decider.finest, decider.deadline)
    place = None
    if again.answer is Answer.APART:
        network = again.network
        sides = [_near(network.sides(step.heading), step.cell) for step in chain]
        place = _closest([step.heading for step in chain], sides, problem.reach(0.0))
    # Ways of other bodies may leave no trace of both sides: the middle of this way then.
    return np.array(chain[len(chain) // 2].exit) if place is None else place


def _near(sides: Sides, cell: shapely.Polygon) -> Sides:
    start, goal = ([c for c in side if c.intersects(cell)] for side in sides)
    return start, goal


def _closest(headings: list[float], sides: list[Sides], radius: float) -> Array | None:
    """Return the middle between the start's and the goal's side where they are nearest.

    Headings apart count as far as they move the body's furthest point.

    Args:
        headings: Headings, length H [rad].
        sides: Cells of the start's and of the goal's side at each heading.
        radius: Distance of the body's furthest point from the pivot [m].
    """
    starts = [(h, shapely.MultiPolygon(s)) for h, (s, _) in zip(headings, sides, strict=True) if s]
    goals = [(h, shapely.MultiPolygon(g)) for h, (_, g) in zip(headings, sides, strict=True) if g]
    pairs = [
        (radius * abs(math.remainder(h - other, FULL_TURN)), a, b)
        for (h, a), (other, b) in product(starts, goals)
    ]
    best, place = math.inf, None
    for turn, a, b in sorted(pairs, key=lambda pair: pair[0]):
        if turn >= best:
            break
        line = shapely.shortest_line(a, b)
        if turn + line.length < best:
            best = turn + line.length
            # At two headings the sides may overlap: then the middle of the overlap.
            middle = shapely.intersection(a, b) if line.length == 0.0 else line
            place = shapely.get_coordinates(shapely.centroid(middle))[0]
    return place
