"""Vertices joined at a cost, and the cheapest ways between them."""

from __future__ import annotations

import math
from dataclasses import dataclass, field

import numpy as np
from scipy.sparse import csr_array
from scipy.sparse.csgraph import dijkstra

from ..se2 import Array


@dataclass(eq=False)
class CostGraph:
    """An undirected graph that grows.

    Attributes:
        vertices: Number of vertices.
        edges: Two vertices and what passing between them costs, > 0.
    """

    vertices: int
    edges: list[tuple[int, int, float]] = field(default_factory=list)

    def costs_from(self, vertex: int, count: int | None = None) -> Array:
        """Return the cheapest cost from a vertex to each, infinite: no way, shape (vertices,).

        Args:
            vertex: Where to begin.
            count: How many of the edges count, the first ones; None: all.
        """
        return np.asarray(dijkstra(self._matrix(count), directed=False, indices=[vertex])[0])

    def between(self, start: int, goal: int, count: int | None = None) -> list[int]:
        """Return the vertices passed on the cheapest way, without its ends; empty if there is none.

        Args:
            start: Where the way begins.
            goal: Where it ends; no edge joins it with the start.
            count: As in `costs_from`.
        """
        matrix = self._matrix(count)
        cost, before = dijkstra(matrix, directed=False, indices=[start], return_predecessors=True)
        if not np.isfinite(cost[0][goal]):
            return []
        order = [int(before[0][goal])]
        while order[-1] != start:
            order.append(int(before[0][order[-1]]))
        return order[-2::-1]

    def _matrix(self, count: int | None) -> csr_array:
        """Return the cheapest cost of each pair that edges join."""
        best: dict[tuple[int, int], float] = {}
        for a, b, cost in self.edges[:count]:
            key = (a, b) if a < b else (b, a)
            if cost < best.get(key, math.inf):
                best[key] = cost
        rows, columns = [a for a, _ in best], [b for _, b in best]
        data = list(best.values())
        return csr_array((data, (rows, columns)), shape=(self.vertices, self.vertices))
