"""Decide about start and goal in the smallest part of the world that suffices.

A way found inside a window is a way. A proof that no way exists may leave out obstacles: what
keeps start and goal apart inside the window, with everything beyond it taken as free, keeps them
apart. Only where the answer hangs on what is beyond is a larger window taken.
"""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from ..se2 import Array
from .heading_graph import HeadingGraph
from .passage_network import PassageNetwork
from .passage_problem import PassageProblem
from .passage_refinement import Answer, Decision, decide, glance
from .planning_clock import clock

_FEW = 60  # obstacle pieces that are all taken at once
_PATIENCE = 1.0  # s that a look once begun may take beyond the deadline
_MOST_HEADINGS = 400  # cuts handed on from one decision to the next


@dataclass(eq=False)
class PassageDecider:
    """Decides for one growth of the body after another; what one needed the next begins with.

    Attributes:
        problem: The question.
        finest: Heading intervals narrower than this are not halved [rad].
        deadline: Process time to stop at [s].
        decisions: Number of heading graphs decided.
    """

    problem: PassageProblem
    finest: float
    deadline: float
    decisions: int = field(default=0, init=False)

    def __post_init__(self) -> None:
        """Begin with the first cuts."""
        self._headings = list(self.problem.headings)

    @property
    def out_of_time(self) -> bool:
        """Whether the deadline has passed."""
        return clock.now() > self.deadline

    def is_too_long(self, graph: HeadingGraph, patience: float = _PATIENCE) -> bool:
        """Return whether even the first look at a graph would end well after the deadline.

        Args:
            graph: A graph of which nothing is computed yet.
            patience: How long after the deadline it may end [s].
        """
        return clock.now() + graph.first_look_s > self.deadline + patience

    def decide(self, growth: float) -> Decision:
        """Return what is known of start and goal for a body grown by `growth` [m].

        Each decision begins in the smallest window: one needed to prove a body shut in is
        of no use to a smaller one that passes, and costs several times as much.

        Args:
            growth: How far every edge of the body is moved outward [m].
        """
        level = 0
        while True:
            window, whole = self._window(growth, level)
            decision = self._by_disc(growth, window, whole)
            if decision is None:
                cuts = list(self._headings)
                graph = HeadingGraph(self.problem, growth, window, not whole, cuts)
                if self.is_too_long(graph):
                    return Decision(Answer.TOO_LONG, PassageNetwork(graph, self.finest))
                decision = decide(graph, self.finest, self.deadline)
                if len(graph.headings) <= _MOST_HEADINGS:
                    self._headings = list(graph.headings)
            self.decisions += 1
            if decision.answer in (Answer.JOINED, Answer.APART, Answer.TOO_LONG) or whole:
                return decision
            if self.out_of_time:
                return Decision(Answer.TOO_LONG, decision.network)
            level += 1

    def _by_disc(self, growth: float, window: Array, whole: bool) -> Decision | None:
        """Return what the disc inside the body says: apart, or joined outside; else None."""
        start = float(self.problem.start[2])
        graph = HeadingGraph(self.problem, growth, window, not whole, [start])
        decision = glance(graph)
        decided = decision is not None and decision.answer in (Answer.APART, Answer.OUTSIDE)
        return decision if decided else None

    def _window(self, growth: float, level: int) -> tuple[Array, bool]:
        problem = self.problem
        everything = problem.whole_window(growth)
        if sum(len(pieces.around) for pieces in problem.pieces) <= _FEW:
            return everything, True
        ends = np.array([problem.start[:2], problem.goal_pivot(float(problem.goal[2]))])
        reach = max(2.0 * problem.reach(growth), 1.5) + problem.position_tolerance
        margin = reach * 2.0**level
        window = np.concatenate([ends.min(axis=0) - margin, ends.max(axis=0) + margin])
        inside = (everything[:2] >= window[:2]).all() and (everything[2:] <= window[2:]).all()
        return (everything, True) if inside else (window, False)
