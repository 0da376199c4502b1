"""Where start and goal come apart when the body grows by a hair: the narrowest place."""

from __future__ import annotations

import numpy as np
import shapely

from ..se2 import Array
from .heading_graph import HeadingGraph
from .passage_refinement import Answer, Decision, decide
from .passage_windows import PassageDecider
from .passage_witness import Point, nearest_in, route_inside

_SPACING = 0.01  # m between the places looked at along the way
_HAIR = 5e-3  # m: a way that grazes what a slightly larger body cannot reach is not cut there
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
    not, in the window that holds the way. The narrowest place is where it leaves those in reach
    of the start, until it comes to those in reach of the goal; its middle is taken.

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
    if again.answer is Answer.APART:
        sides = [again.network.sides(step.heading) for step in chain]
        goal = problem.goal_pivot(chain[-1].heading)
        exits = [*(step.exit for step in chain[:-1]), nearest_in(chain[-1].cell, goal)]
        return _middle_of_gap([step.cell for step in chain], exits, sides, problem.start[:2])
    # Ways of other bodies may leave no trace of both sides: the middle of this way then.
    return np.array(chain[len(chain) // 2].exit)


def _middle_of_gap(
    cells: list[shapely.Polygon], exits: list[Point], sides: list[Sides], start: Array
) -> Array:
    """Return the middle of the part of a way that is in reach of neither end, shape (2,), [m].

    Args:
        cells: Polygons the way runs through.
        exits: Where it leaves each of them [m].
        sides: For each, the places in reach of the start, and of the goal.
        start: Where the way begins, shape (2,), [m].
    """
    points, from_start, from_goal = [], [], []
    here = (float(start[0]), float(start[1]))
    for cell, leave, (reached, reaching) in zip(cells, exits, sides, strict=True):
        line = shapely.LineString(route_inside(cell, here, leave))
        along = shapely.segmentize(line, _SPACING) if line.length else line
        rows = shapely.points(shapely.get_coordinates(along))
        points.append(shapely.get_coordinates(rows))
        from_start.append(shapely.dwithin(shapely.MultiPolygon(reached), rows, _HAIR))
        from_goal.append(shapely.dwithin(shapely.MultiPolygon(reaching), rows, _HAIR))
        here = leave
    way = np.concatenate(points)
    left = np.flatnonzero(np.concatenate(from_start)).max(initial=0)
    after = np.flatnonzero(np.concatenate(from_goal)[left:])
    entered = left + int(after[0]) if len(after) else len(way) - 1
    gap = way[left : entered + 1]
    length = np.concatenate([[0.0], np.cumsum(np.hypot(*np.diff(gap, axis=0).T))])
    return np.array([np.interp(0.5 * length[-1], length, part) for part in gap.T])
