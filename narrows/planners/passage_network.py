"""The network of a heading graph: what joins what, and at what cost one may hope it does.

Vertices are the free cells of a `HeadingGraph`, start, goal, and the outside of the window. Sure
edges cost next to nothing. An edge through a possible join costs 1, one that leaves the window
`OUTSIDE`, one through what further cuts cannot decide `UNDECIDABLE`. The cheapest way from start
to goal then says what to do next: believe it, refine it, look further, or give up.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field

import numpy as np
import shapely

from ..se2 import Array
from .cost_graph import CostGraph
from .heading_graph import (
    EPSILON,
    CellSet,
    HeadingGraph,
    Indices,
    holding,
    locate,
    touching,
    within,
)

SURE = 1e-6
OUTSIDE = 1e3
UNDECIDABLE = 1e6
_START, _GOAL, _BEYOND = 0, 1, 2


@dataclass(frozen=True, eq=False)
class Step:
    """A free cell at one heading, on a sure way from start to goal.

    Attributes:
        heading: The heading [rad].
        cell: Where the pivot may be, a polygon [m].
        exit: Where the pivot is when the body turns to the next step's heading [m]; on the last
            step a point of the cell.
    """

    heading: float
    cell: shapely.Polygon
    exit: tuple[float, float]


@dataclass(eq=False)
class PassageNetwork:
    """Edges between the cells of a heading graph, rebuilt as the graph is refined.

    Attributes:
        graph: The cells.
        finest: Intervals narrower than this are not refined [rad].
    """

    graph: HeadingGraph
    finest: float
    anomalies: int = field(default=0, init=False)
    start_is_free: bool = field(default=False, init=False)
    start_is_possible: bool = field(default=False, init=False)
    _down: dict[float, Indices] = field(default_factory=dict, init=False)
    _sure_links: dict[tuple[float, float], tuple[Indices, Indices]] = field(
        default_factory=dict, init=False
    )
    _possible_links: dict[tuple[float, float], tuple[Indices, Indices]] = field(
        default_factory=dict, init=False
    )

    def build(self, *, possible: bool) -> None:
        """Find vertices and edges of the graph as it is cut now."""
        self.anomalies = 0
        self._hopes: dict[int, Array] = {}
        self._first: dict[tuple[str, float], int] = {}
        self._ways = CostGraph(3)
        headings = self.graph.headings
        self._spans = list(zip(headings, [*headings[1:], headings[0]], strict=True))
        self._number("sure", self.graph.sure_nodes, headings)
        self._number("turn", self.graph.sure_joins, headings)
        self._join_surely()
        self._attach_ends_surely()
        self._sure_edge_count = len(self._ways.edges)
        if possible:
            self._number("hair", self.graph.possible_nodes, headings)
            self._number("join", self.graph.possible_joins, headings)
            self._join_possibly()
            self._attach_ends_possibly()

    def _number(self, kind: str, sets: dict[float, CellSet], headings: list[float]) -> None:
        for heading in headings:
            self._first[kind, heading] = self._ways.vertices
            self._ways.vertices += len(sets[heading].cells)

    def _link(
        self,
        store: dict[tuple[float, float], tuple[Indices, Indices]],
        points_of: dict[float, CellSet] | None,
        joins: dict[float, CellSet],
        nodes: dict[float, CellSet],
    ) -> None:
        """Find for every new span which cells hold which points at its two ends.

        With `points_of` None the joins' points are sought in the nodes, else the nodes' in the
        joins.
        """
        new = [span for span in self._spans if span not in store]
        down = points_of is None
        points, cells = [], []
        for begin, end in new:
            for side in (begin, end):
                points.append(joins[begin].points if down else nodes[side].points)
                cells.append(nodes[side].cells if down else joins[begin].cells)
        found = locate(points, cells)
        for i, span in enumerate(new):
            store[span] = (found[2 * i], found[2 * i + 1])

    def _join_surely(self) -> None:
        graph = self.graph
        self._link(self._sure_links, None, graph.sure_joins, graph.sure_nodes)
        for begin, end in self._spans:
            first = self._first["turn", begin]
            for side, found in zip((begin, end), self._sure_links[begin, end], strict=True):
                base = self._first["sure", side]
                self._ways.edges += [
                    (first + i, base + int(k), SURE) for i, k in enumerate(found) if k >= 0
                ]

    def _attach_ends_surely(self) -> None:
        problem, graph = self.graph.problem, self.graph
        start = self._start_heading()
        index = holding(graph.sure_nodes[start].cells, problem.start[:2])
        self.start_is_free = index >= 0
        if index >= 0:
            self._ways.edges.append((_START, self._first["sure", start] + index, SURE))
        for heading in graph.headings:
            offset = problem.goal_heading_offset(heading)
            if offset <= problem.heading_tolerance + 1e-9:
                near = within(
                    graph.sure_nodes[heading].cells,
                    problem.goal_pivot(heading),
                    problem.position_tolerance,
                )
                base = self._first["sure", heading]
                # A way that ends at the goal's own heading is worth a few more turns.
                cost = SURE if offset < 1e-6 else 10.0 * SURE
                self._ways.edges += [(_GOAL, base + int(k), cost) for k in near]

    def _start_heading(self) -> float:
        """Return the cut that is the start's heading."""
        start = float(self.graph.problem.start[2])
        offsets = [abs(math.remainder(h - start, 2.0 * math.pi)) for h in self.graph.headings]
        return self.graph.headings[int(np.argmin(offsets))]

    def _join_possibly(self) -> None:
        graph = self.graph
        self._place_sure_in_possible()
        self._link(
            self._possible_links, graph.possible_nodes, graph.possible_joins, graph.possible_nodes
        )
        for index, (begin, end) in enumerate(self._spans):
            fine = 2.0 * graph.half_angle(index) <= self.finest
            cost = 0.5 * (UNDECIDABLE if fine else 1.0)
            base = self._first["join", begin]
            for side, found in zip((begin, end), self._possible_links[begin, end], strict=True):
                for node, join in enumerate(found.tolist()):
                    if join < 0:
                        self.anomalies += 1
                        continue
                    for vertex in self._stand_ins(side, node):
                        self._ways.edges.append((base + join, vertex, cost))
            if graph.open_window:
                outer = touching(graph.possible_joins[begin].cells, graph.window)
                self._ways.edges += [(base + int(k), _BEYOND, OUTSIDE / 2) for k in outer]

    def _place_sure_in_possible(self) -> None:
        graph = self.graph
        new = [h for h in graph.headings if h not in self._down]
        found = locate(
            [graph.sure_nodes[h].points for h in new], [graph.possible_nodes[h].cells for h in new]
        )
        self._down.update(zip(new, found, strict=True))
        self._members: dict[tuple[float, int], list[int]] = {}
        for heading in graph.headings:
            base = self._first["sure", heading]
            for k, node in enumerate(self._down[heading].tolist()):
                self.anomalies += node < 0
                self._members.setdefault((heading, node), []).append(base + k)
            hair = self._first["hair", heading]
            for node in range(len(graph.possible_nodes[heading].cells)):
                inside = self._members.get((heading, node), [])
                if len(inside) > 1:  # parted or joined by less than a hair's breadth
                    self._ways.edges += [(hair + node, k, UNDECIDABLE / 2) for k in inside]

    def _stand_ins(self, heading: float, node: int) -> list[int]:
        """Return the vertices that stand for a possible node: the sure ones in it, or itself."""
        inside = self._members.get((heading, node), [])
        return inside or [self._first["hair", heading] + node]

    def _attach_ends_possibly(self) -> None:
        graph, problem = self.graph, self.graph.problem
        start = self._start_heading()
        index = holding(graph.possible_nodes[start].cells, problem.start[:2])
        self.start_is_possible = index >= 0
        if index >= 0:
            for vertex in self._stand_ins(start, index):
                self._ways.edges.append((_START, vertex, UNDECIDABLE))
        swing = float(np.linalg.norm(problem.pivot))
        for k, heading in enumerate(graph.headings):
            half = graph.half_angle(k)
            offset = problem.goal_heading_offset(heading)
            reach = problem.position_tolerance + EPSILON
            if offset <= problem.heading_tolerance + 1e-6:
                cells = graph.possible_nodes[heading].cells
                for node in within(cells, problem.goal_pivot(heading), reach):
                    for vertex in self._stand_ins(heading, int(node)):
                        self._ways.edges.append((_GOAL, vertex, UNDECIDABLE))
            middle = heading + half
            if problem.goal_heading_offset(middle) <= problem.heading_tolerance + half + 1e-6:
                reach += 2.0 * swing * math.sin(0.5 * half)
                cells = graph.possible_joins[heading].cells
                cost = 0.5 * (UNDECIDABLE if 2.0 * half <= self.finest else 1.0)
                base = self._first["join", heading]
                for join in within(cells, problem.goal_pivot(middle), reach):
                    self._ways.edges.append((base + int(join), _GOAL, cost))

    def costs(self, *, only_sure: bool = False) -> Array:
        """Return each vertex's cheapest cost from the start; infinite: not even possible."""
        return self._ways.costs_from(_START, self._sure_edge_count if only_sure else None)

    def costs_to_goal(self) -> Array:
        """Return each vertex's cheapest cost to the goal."""
        return self._ways.costs_from(_GOAL)

    @property
    def goal_is_possible(self) -> bool:
        """Whether any cell reaches into the goal region."""
        return any(_GOAL in edge[:2] for edge in self._ways.edges)

    def sides(self, heading: float) -> tuple[list[shapely.Polygon], list[shapely.Polygon]]:
        """Return the possible nodes at a cut that hang together with start and with goal."""
        hopes = (self._hope_from(_START), self._hope_from(_GOAL))
        cells = self.graph.possible_nodes[heading].cells
        start, goal = (
            [
                cell
                for node, cell in enumerate(cells)
                if any(np.isfinite(cost[vertex]) for vertex in self._stand_ins(heading, node))
            ]
            for cost in hopes
        )
        return start, goal

    def start_side(self, heading: float) -> list[shapely.Polygon]:
        """Return the joins over the interval from a cut that are possibly reached from start."""
        cost = self._hope_from(_START)[self.joins_at(heading)]
        cells = self.graph.possible_joins[heading].cells
        return [cell for cell, c in zip(cells, cost, strict=True) if np.isfinite(c)]

    def _hope_from(self, end: int) -> Array:
        if end not in self._hopes:
            self._hopes[end] = self.costs() if end == _START else self.costs_to_goal()
        return self._hopes[end]

    def joins_at(self, heading: float) -> slice:
        """Return the vertices of the possible joins over the interval that begins there."""
        first = self._first["join", heading]
        return slice(first, first + len(self.graph.possible_joins[heading].cells))

    def way(self) -> list[Step]:
        """Return the free cells of a sure way from start to goal; empty if none is known."""
        order = self._ways.between(_START, _GOAL, self._sure_edge_count)
        if not order:
            return []
        cells = self._cells_by_vertex()
        chain = [cells[vertex] for vertex in order]
        # Nodes and turns alternate, beginning and ending with a node.
        nodes, turns = chain[0::2], [*chain[1::2], chain[-1]]
        return [
            Step(heading, cell, turn_point)
            for (heading, cell, _), (_, _, turn_point) in zip(nodes, turns, strict=True)
        ]

    def _cells_by_vertex(self) -> dict[int, tuple[float, shapely.Polygon, tuple[float, float]]]:
        found = {}
        for kind, sets in (("sure", self.graph.sure_nodes), ("turn", self.graph.sure_joins)):
            for heading in self.graph.headings:
                first = self._first[kind, heading]
                group = sets[heading]
                for k, (cell, point) in enumerate(zip(group.cells, group.points, strict=True)):
                    found[first + k] = (heading, cell, (float(point[0]), float(point[1])))
        return found
