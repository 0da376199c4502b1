"""What a manoeuvre search may do, what it costs, and how far it goes."""

from __future__ import annotations

import math
from dataclasses import dataclass

from ..errors import ShapeError


@dataclass(frozen=True)
class SearchOptions:
    """Resolution, costs and budget of a search; costs are in metres driven.

    Attributes:
        cell: Size of the cells of position [m]; each is entered once, the cheapest way.
        heading_cell: Size of the cells of heading [rad].
        step: Length of a move [m].
        refinements: How often the three above are halved when coarse cells hold no way.
        curvatures: Curvatures of the moves as parts of the chair's limit.
        tightest_arc: Curvature the parts refer to for a chair that may turn on the spot [1/m].
        change_cost: Cost of a change between forward and reverse [m].
        spot_cost: Cost of turning on the spot by a radian [m].
        care: Clearance from which on more is no better [m].
        crowding: Driving a metre at no clearance costs 1 + crowding, falling linearly to 1 at
            `care`.
        least_clearance: Moves that come closer are refused [m]; half of it is proven.
        weight: Factor on the estimate of what is left in the quick searches. 1 makes them
            admissible; the thorough ones use its square root.
        quick_budget: Expansions of each quick search.
        budget: Expansions in all; about 5 microseconds each.
    """

    cell: float = 0.05
    heading_cell: float = math.radians(3.0)
    step: float = 0.1
    refinements: int = 2
    curvatures: tuple[float, ...] = (-1.0, -0.5, 0.0, 0.5, 1.0)
    tightest_arc: float = 2.5
    change_cost: float = 1.0
    spot_cost: float = 0.4
    care: float = 0.1
    crowding: float = 1.0
    least_clearance: float = 1e-3
    weight: float = 3.0
    quick_budget: int = 2500
    budget: int = 200_000

    def __post_init__(self) -> None:
        """Check the numbers."""
        positive = ("cell", "heading_cell", "step", "tightest_arc", "spot_cost")
        for name in (*positive, "care", "least_clearance", "quick_budget", "budget"):
            value = getattr(self, name)
            if not 0.0 < value < math.inf:
                raise ShapeError(f"{name} must be a positive number, got {value}")
        for name in ("change_cost", "crowding", "refinements"):
            if not 0.0 <= getattr(self, name) < math.inf:
                raise ShapeError(f"{name} must be at least 0, got {getattr(self, name)}")
        if not 1.0 <= self.weight < math.inf:
            raise ShapeError(f"weight must be at least 1, got {self.weight}")
        if not self.curvatures or any(not -1.0 <= part <= 1.0 for part in self.curvatures):
            raise ShapeError(f"curvatures must be parts in [-1, 1], got {self.curvatures}")


@dataclass(frozen=True)
class Rung:
    """One search of the several that are tried in turn.

    Attributes:
        from_goal: Whether it grows backwards from the goal; else from the start.
        reversing: Whether it may drive in reverse.
        floor: Least clearance [m].
        scale: Factor on cells and step.
        is_thorough: Whether it takes the smaller weight and curvatures between those given.
        budget: Most expansions.
    """

    from_goal: bool
    reversing: bool
    floor: float
    scale: float
    is_thorough: bool
    budget: int

    @property
    def space(self) -> tuple[bool, bool, float, bool]:
        """What it searches: end, directions, cells, moves."""
        return self.from_goal, self.reversing, self.scale, self.is_thorough


def ladder(options: SearchOptions, margin: float, *, reversing: bool) -> tuple[Rung, ...]:
    """Return the searches in the order they are tried.

    Quick and greedy with the margin asked for, then closer to the solids, then from both ends and
    thorough, then in finer cells. From the goal first: a chair that backs out of the room through
    a door comes from the narrow to the wide, and the goal may be missed by its tolerances. Where
    reversing is allowed the long searches stay greedy and start at the start: shunting is a long
    way, which a careful search does not reach.
    """
    near, quick = options.least_clearance, options.quick_budget
    rungs = [
        Rung(True, False, max(margin, near), 1.0, False, quick),
        Rung(True, False, near, 1.0, False, quick),
        Rung(False, False, near, 1.0, False, quick),
    ]
    if reversing:
        rungs += [
            Rung(True, True, max(margin, near), 1.0, False, quick),
            Rung(True, True, near, 1.0, False, 2 * quick),
            Rung(False, True, near, 1.0, False, 2 * quick),
        ]
    for level in range(options.refinements + 1):
        budget = options.budget if level else options.budget // (3 if reversing else 5)
        rungs += [
            Rung(from_goal, reversing, near, 0.5**level, not reversing, budget)
            for from_goal in (not reversing, reversing)
        ]
    return tuple(rungs)
