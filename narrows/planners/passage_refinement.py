"""Refine a heading graph until start and goal are surely joined or surely apart."""

from __future__ import annotations

from dataclasses import dataclass
from enum import Enum

import numpy as np

from .heading_graph import HeadingGraph
from .passage_network import OUTSIDE, UNDECIDABLE, PassageNetwork
from .planning_clock import clock

_SLACK = 0.25  # costs of different ways differ by a half at least


class Answer(Enum):
    """What a heading graph says about start and goal."""

    JOINED = "joined"
    APART = "apart"
    OUTSIDE = "joined, if at all, only outside the window"
    TOO_FINE = "not decided by the narrowest intervals"
    TOO_LONG = "not decided in the time given"


@dataclass(frozen=True, eq=False)
class Decision:
    """An answer and the network that gave it.

    Attributes:
        answer: What was found.
        network: Cells and edges behind it.
    """

    answer: Answer
    network: PassageNetwork

    @property
    def graph(self) -> HeadingGraph:
        """The cells."""
        return self.network.graph


def decide(graph: HeadingGraph, finest: float, deadline: float) -> Decision:
    """Return whether start and goal are joined, refining where the answer hangs on it.

    Of all ways that are possible, the ones through the fewest undecided cells are looked at:
    every interval they run through is halved, until a way is sure or none is possible.

    Args:
        graph: The cells; refined in place.
        finest: Intervals narrower than this are not halved [rad].
        deadline: Process time to stop at [s].
    """
    network = PassageNetwork(graph, finest)
    graph.update(possible=False)
    network.build(possible=False)
    while True:
        if np.isfinite(network.costs(only_sure=True)[1]):
            return Decision(Answer.JOINED, network)
        graph.update(possible=True)
        network.build(possible=True)
        answer, doubtful = _look(network)
        if answer is not None:
            return Decision(answer, network)
        if clock.now() > deadline:
            return Decision(Answer.TOO_LONG, network)
        graph.split(doubtful)
        graph.update(possible=True)
        network.build(possible=True)


def glance(graph: HeadingGraph) -> Decision | None:
    """Return what a graph says about start and goal as it is cut, or None where it leaves it open.

    Args:
        graph: The cells, perhaps over the full turn at once: then the body's inscribed disc
            decides.
    """
    network = PassageNetwork(graph, 0.0)
    graph.update(possible=True)
    network.build(possible=True)
    answer = _look(network)[0]
    return None if answer is None else Decision(answer, network)


def _look(network: PassageNetwork) -> tuple[Answer | None, list[int]]:
    """Return the answer, or None and the intervals to halve."""
    cost, to_goal = network.costs(), network.costs_to_goal()
    total = cost[1]
    if not np.isfinite(total):
        return (Answer.TOO_FINE if network.anomalies else Answer.APART), []
    if total >= UNDECIDABLE:
        return Answer.TOO_FINE, []
    if total >= OUTSIDE:
        return Answer.OUTSIDE, []
    on_the_way = cost + to_goal <= total + _SLACK
    doubtful = [
        index
        for index, heading in enumerate(network.graph.headings)
        if on_the_way[network.joins_at(heading)].any()
    ]
    return None, doubtful
