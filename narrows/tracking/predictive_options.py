"""How the predictive tracker works, and how its steps end."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from enum import Enum

from ..errors import ShapeError
from .predictive_program import PredictiveWeights


class StepStatus(Enum):
    """How a command came about; the value is the message for people."""

    SOLVED = "the program was solved, its rows hold"
    JERKY = "solved without the jerk limit, which cannot be kept with the others"
    CLOSE = "solved, but the margin to the solids cannot be kept: as little as possible is missing"
    SHIFTED = "no solution within the budget: the plan of the step before goes on"
    BRAKING = "no solution for too long: the chair brakes on its curve"


@dataclass(frozen=True)
class PredictiveOptions:
    """How the predictive tracker works.

    Attributes:
        speed: Cruising speed on a path without times [m/s].
        delay: Time from a command to its effect, latency plus motor lag [s]; compensated.
        period: Control period the horizon starts with [s].
        steps: Number of steps of the horizon.
        longest_step: Longest of them [s].
        weights: Costs.
        method: "sqp": one quadratic program a period at the plan shifted on (real-time
            iteration); "ipopt": the nonlinear program solved to its end.
        iterations: Quadratic programs a period, with "sqp".
        keep_jerk: Whether the jerk limit is kept too.
        margin: Clearance kept where it can be, if a world is given [m].
        budget: CPU time a step may take [s]; a result that comes later is not used. Infinite for
            drives that must come out the same on every machine.
        coast: How long the last plan goes on without a new one before the chair brakes [s].
        arrival: How near to a leg's end counts as arrived [m].
        arrival_turn: The same on the spot [rad].
        patience: How long after its time a leg is left, arrived or not [s].
    """

    speed: float = 0.4
    delay: float = 0.05
    period: float = 0.02
    steps: int = 16
    longest_step: float = 0.1
    weights: PredictiveWeights = field(default_factory=PredictiveWeights)
    method: str = "sqp"
    iterations: int = 1
    keep_jerk: bool = False
    margin: float = 0.02
    budget: float = 0.02
    coast: float = 0.2
    arrival: float = 0.001
    arrival_turn: float = 0.002
    patience: float = 1.0

    def __post_init__(self) -> None:
        """Check the numbers and choices."""
        if self.method not in ("sqp", "ipopt"):
            raise ShapeError(f"method must be 'sqp' or 'ipopt', got {self.method!r}")
        for name in ("speed", "period", "longest_step", "budget", "arrival", "arrival_turn"):
            if not getattr(self, name) > 0.0:
                raise ShapeError(f"{name} must be positive, got {getattr(self, name)}")
        for name in ("delay", "margin", "coast", "patience"):
            if not (0.0 <= getattr(self, name) < math.inf):
                raise ShapeError(f"{name} must be finite and >= 0, got {getattr(self, name)}")
        if self.steps < 2 or self.iterations < 1:
            raise ShapeError("a horizon needs at least 2 steps and 1 iteration")
