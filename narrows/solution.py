"""What a nonlinear program's solver came back with, in words and figures of ours."""

from __future__ import annotations

from dataclasses import dataclass
from enum import Enum

from .se2 import Array


class SolveStatus(Enum):
    """How a solve ended; the value is the message for people."""

    SOLVED = "solved: converged, and the constraints hold when evaluated again"
    ACCEPTABLE = "acceptable: the constraints hold, optimality only to the loose tolerance"
    INFEASIBLE = "the solver stopped where the constraints cannot be satisfied from this start"
    ITERATION_LIMIT = "the iteration limit was reached; start closer or allow more iterations"
    TIME_LIMIT = "the time limit was reached; start closer or allow more time"
    INVALID_NUMBER = "a function or derivative is not a finite number where the solver went"
    DIVERGED = "the iterates ran away; the objective may be unbounded"
    STALLED = "no further step could be made; the constraints may be degenerate here"
    UNTRUE = "the solver claims success but the constraints do not hold when evaluated again"
    FAILED = "the solver failed inside"

    @property
    def is_success(self) -> bool:
        """Whether a point that keeps its constraints is claimed, perhaps loosely optimal."""
        return self in (SolveStatus.SOLVED, SolveStatus.ACCEPTABLE)

    @classmethod
    def of_ipopt(cls, word: str) -> SolveStatus:
        """Return IPOPT's `return_status` in our words; what is not known is FAILED."""
        return _STATUS.get(word, cls.FAILED)


_STATUS = {
    "Solve_Succeeded": SolveStatus.SOLVED,
    "Feasible_Point_Found": SolveStatus.SOLVED,
    "Solved_To_Acceptable_Level": SolveStatus.ACCEPTABLE,
    "Infeasible_Problem_Detected": SolveStatus.INFEASIBLE,
    "Not_Enough_Degrees_Of_Freedom": SolveStatus.INFEASIBLE,
    "Maximum_Iterations_Exceeded": SolveStatus.ITERATION_LIMIT,
    "Maximum_CpuTime_Exceeded": SolveStatus.TIME_LIMIT,
    "Maximum_WallTime_Exceeded": SolveStatus.TIME_LIMIT,
    "Invalid_Number_Detected": SolveStatus.INVALID_NUMBER,
    "Diverging_Iterates": SolveStatus.DIVERGED,
    "Search_Direction_Becomes_Too_Small": SolveStatus.STALLED,
    "Restoration_Failed": SolveStatus.STALLED,
    "Error_In_Step_Computation": SolveStatus.STALLED,
}


@dataclass(frozen=True)
class SolveStatistics:
    """What a solve cost.

    Attributes:
        iterations: Iterations of the solver.
        cpu_time: CPU time of the solve with its evaluation again [s].
        evaluations: Evaluations of the objective.
        plugin: The solver that gave the result.
    """

    iterations: int
    cpu_time: float
    evaluations: int
    plugin: str


@dataclass(frozen=True, eq=False)
class Solution:
    """Where a solve ended, measured again with the problem's own functions.

    Attributes:
        status: How it ended.
        unknowns: The point, shape (n,); the last iterate where the status is not a success.
        objective: f there.
        constraints: g there, shape (m,).
        constraint_violation: Largest amount by which a row of g leaves its bounds; NaN if g is.
        bound_violation: The same for the unknowns.
        stationarity: Largest component of grad f + J^T multipliers + bound multipliers.
        multipliers: Of the constraints, shape (m,), positive at an upper bound.
        bound_multipliers: Of the unknowns' bounds, shape (n,).
        statistics: What it cost.
        solver_status: The solver's own word, for reports.
    """

    status: SolveStatus
    unknowns: Array
    objective: float
    constraints: Array
    constraint_violation: float
    bound_violation: float
    stationarity: float
    multipliers: Array
    bound_multipliers: Array
    statistics: SolveStatistics
    solver_status: str

    @property
    def is_solved(self) -> bool:
        """Whether the constraints hold and the solver converged (perhaps loosely)."""
        return self.status.is_success

    @property
    def message(self) -> str:
        """The outcome in one sentence, with the residual that decides."""
        return (
            f"{self.status.value} ({self.solver_status}; {self.statistics.iterations} iterations, "
            f"constraint violation {max(self.constraint_violation, self.bound_violation):.2g})"
        )
