"""How much larger the body may be, or how much smaller it must be, by bisection.

The body grows *uniformly*: every edge of every layer moves outward by the same growth, corners
mitred; a rectangle becomes longer and wider by twice the growth. The figure for people is twice
the growth, so that it reads as widths do: a body 0.67 m wide that drives straight through a
0.90 m door has 0.23 m to spare. The larger the body, the fewer its ways: the largest growth
that still passes is found between one that is proven to pass and one that is proven not to.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from enum import Enum

from ..se2 import Array
from .narrowest import narrowest_place
from .passage_refinement import Answer, Decision
from .passage_windows import PassageDecider

BRACKET = 4e-4  # growth [m]; the spare room is twice that, below a millimetre
LARGEST = 1.0  # growth beyond this is not looked for [m]
_STEP_ASIDE = 1.5e-4  # where a growth touches exactly, its neighbours are tried [m]
_FIRST_STEP = 0.0413  # not a round figure: sizes are, and an exact fit takes longest [m]


class Limit(Enum):
    """What ends the growth."""

    BETWEEN = "between start and goal"
    START = "at the start"
    GOAL = "at the goal"
    NOTHING = "nothing within the largest growth looked for"
    NO_WAY = "not even a body shrunk to nothing passes"
    UNKNOWN = "the search ended before a body that passes was found"


@dataclass(frozen=True, eq=False)
class Spare:
    """How much larger the body may be.

    Attributes:
        proven: Twice the largest growth proven to pass; negative: that much is missing [m]. If
            no body was found to pass: what leaves but a millimetre of the body.
        refuted: Twice the smallest growth proven not to pass [m]; `proven` where none was found.
        limit: What ends the growth.
        narrowest: The narrowest place in the world, shape (2,), [m]; the middle of the body
            there, or of the body at start or goal where those end the growth. None where
            nothing ends it, where no body passes, and where the time was up.
    """

    proven: float
    refuted: float
    limit: Limit
    narrowest: Array | None


@dataclass(eq=False)
class _Bracket:
    """Largest growth known to pass, smallest known not to, and those undecided between."""

    decider: PassageDecider
    joined: Decision | None = None
    apart: Decision | None = None
    undecided: list[float] = field(default_factory=list)

    def try_growth(self, growth: float) -> None:
        self.take(self.decider.decide(growth))

    def take(self, decision: Decision) -> None:
        growth = decision.graph.growth
        if decision.answer is Answer.JOINED:
            if self.joined is None or growth > self.joined.graph.growth:
                self.joined = decision
        elif decision.answer is Answer.APART:
            if self.apart is None or growth < self.apart.graph.growth:
                self.apart = decision
        else:
            self.undecided.append(growth)

    def next_growth(self) -> float | None:
        """Return the growth to try next, or None where the bracket is as tight as it gets."""
        if self.joined is None or self.apart is None:
            return None
        low, high = self.joined.graph.growth, self.apart.graph.growth
        between = [growth for growth in self.undecided if low < growth < high]
        if not between:
            return 0.5 * (low + high) if high - low > BRACKET else None
        for known, doubt in ((low, min(between)), (high, max(between))):
            if abs(doubt - known) > 0.5 * BRACKET:
                aside = math.copysign(_STEP_ASIDE, known - doubt)
                return doubt + aside if len(between) == 1 else 0.5 * (known + doubt)
        return None


def find_spare(decider: PassageDecider, at_zero: Decision) -> Spare:
    """Return the spare room of the body, or what is missing.

    Args:
        decider: Decides about grown bodies; its deadline ends the search early, then `proven`
            and `refuted` are further apart than a millimetre.
        at_zero: The decision about the body as it is.
    """
    bracket = _Bracket(decider)
    bracket.take(at_zero)
    _enclose(bracket)
    _narrow(bracket)
    joined, apart = bracket.joined, bracket.apart
    smallest = decider.problem.smallest_growth
    proven = 2.0 * (smallest if joined is None else joined.graph.growth)
    refuted = proven if apart is None else 2.0 * apart.graph.growth
    place: Array | None = None
    if apart is None:
        limit = Limit.NOTHING
    elif joined is None:
        limit = Limit.NO_WAY if apart.graph.growth <= smallest else Limit.UNKNOWN
    else:
        found = narrowest_place(decider, joined, apart)
        place = None if found is None else found + decider.problem.origin
        if not apart.network.start_is_possible:
            limit = Limit.START
        elif not apart.network.goal_is_possible:
            limit = Limit.GOAL
        else:
            limit = Limit.BETWEEN
    return Spare(proven, refuted, limit, place)


def _enclose(bracket: _Bracket) -> None:
    """Find one growth that passes and one that does not, going out in widening steps."""
    decider = bracket.decider
    smallest = decider.problem.smallest_growth
    step = _FIRST_STEP
    while bracket.apart is None and not decider.out_of_time and step < 2.0 * LARGEST:
        bracket.try_growth(min(step, LARGEST))
        step *= 2.0
    step = 0.5 * _FIRST_STEP
    while bracket.joined is None and not decider.out_of_time:
        bracket.try_growth(max(-step, smallest))
        if -step <= smallest:
            break
        step *= 2.0


def _narrow(bracket: _Bracket) -> None:
    """Halve the bracket; where a growth fits exactly, close in from both sides."""
    growth = bracket.next_growth()
    while growth is not None and not bracket.decider.out_of_time:
        bracket.try_growth(growth)
        growth = bracket.next_growth()
