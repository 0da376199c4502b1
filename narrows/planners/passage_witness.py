"""A way through the free cells, as poses anybody can check."""

from __future__ import annotations

import math
from collections.abc import Sequence
from heapq import heappop, heappush

import numpy as np
import shapely

from ..se2 import Array, rotate
from .heading_graph import FULL_TURN
from .passage_network import Step
from .passage_problem import PassageProblem

_TURN_STEP = math.radians(2.0)

Point = tuple[float, float]


def witness_poses(problem: PassageProblem, steps: Sequence[Step]) -> Array:
    """Return poses along a chain of free cells from the start to a pose in the goal region.

    Between two rows the body either moves straight without turning, or turns about the pivot
    without moving it.

    Args:
        problem: The question, for pivot and origin.
        steps: Free cells in the order they are met, as `PassageNetwork.way` gives them.

    Returns:
        Poses of the body frame in the world, shape (N, 3), headings unwrapped, [m, m, rad].
    """
    here: Point = (float(problem.start[0]), float(problem.start[1]))
    heading = float(problem.start[2])
    rows: list[tuple[float, float, float]] = [(*here, heading)]
    for k, step in enumerate(steps):
        # A step is a node: slide inside its cell to where the next turn is made.
        last = k == len(steps) - 1
        target = nearest_in(step.cell, problem.goal_pivot(heading)) if last else step.exit
        rows += [(*point, heading) for point in route_inside(step.cell, here, target)[1:]]
        here = target
        if not last:
            turn = math.remainder(steps[k + 1].heading - step.heading, FULL_TURN)
            count = max(1, math.ceil(abs(turn) / _TURN_STEP))
            rows += [(*here, heading + turn * i / count) for i in range(1, count + 1)]
            heading += turn
    poses = np.array(rows)
    poses[:, :2] += problem.origin - rotate(poses[:, 2], problem.pivot)
    return poses


def nearest_in(cell: shapely.Polygon, point: Array) -> Point:
    """Return the point of a polygon that is nearest to a point (2,), [m]."""
    line = shapely.shortest_line(cell, shapely.Point(point))
    x, y = line.coords[0]
    return float(x), float(y)


def route_inside(cell: shapely.Polygon, start: Point, end: Point) -> list[Point]:
    """Return a polyline from start to end inside a polygon that holds both.

    Through the middles of the edges of a triangulation, then shortened where a chord stays
    inside.

    Args:
        cell: A polygon, holes allowed, [m].
        start: First point [m].
        end: Last point [m].
    """
    if _inside(cell, start, end):
        return [start, end]
    route = _through_triangles(cell, start, end)
    short = [route[0]]
    i = 0
    while i < len(route) - 1:
        ahead = next(
            (j for j in range(len(route) - 1, i + 1, -1) if _inside(cell, route[i], route[j])),
            i + 1,
        )
        short.append(route[ahead])
        i = ahead
    return short


def _inside(cell: shapely.Polygon, first: Point, second: Point) -> bool:
    return bool(shapely.covers(cell, shapely.LineString([first, second])))


def _through_triangles(cell: shapely.Polygon, start: Point, end: Point) -> list[Point]:
    triangles = shapely.get_parts(shapely.constrained_delaunay_triangles(cell))
    corners = [[(float(x), float(y)) for x, y in t.exterior.coords[:3]] for t in triangles]
    sides: dict[tuple[Point, Point], list[int]] = {}
    for index, triangle in enumerate(corners):
        for a, b in zip(triangle, triangle[1:] + triangle[:1], strict=True):
            sides.setdefault((min(a, b), max(a, b)), []).append(index)
    neighbours: dict[int, list[tuple[int, Point]]] = {}
    for (a, b), owners in sides.items():
        middle = ((a[0] + b[0]) / 2.0, (a[1] + b[1]) / 2.0)
        for i in owners:
            neighbours.setdefault(i, []).extend((j, middle) for j in owners if j != i)
    first = int(shapely.distance(triangles, shapely.Point(start)).argmin())
    last = int(shapely.distance(triangles, shapely.Point(end)).argmin())
    best: dict[int, tuple[float, int, Point]] = {first: (0.0, -1, start)}
    queue: list[tuple[float, int, Point]] = [(0.0, first, start)]
    while queue:
        cost, index, here = heappop(queue)
        if index == last:
            break
        for other, middle in neighbours.get(index, []):
            total = cost + math.dist(here, middle)
            if other not in best or total < best[other][0]:
                best[other] = (total, index, middle)
                heappush(queue, (total, other, middle))
    route = [end]
    index = last
    while index != first:
        route.append(best[index][2])
        index = best[index][1]
    return [*route, start][::-1]
