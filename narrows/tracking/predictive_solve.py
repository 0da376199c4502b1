"""Solves the program of predictive tracking: one quadratic step, or IPOPT to the end."""

from __future__ import annotations

import math

import numpy as np

from ..nlp import Solver, SolverOptions
from ..quadratic import solve_quadratic
from ..se2 import Array
from ..vehicle import Limits
from .predictive_options import PredictiveOptions
from .predictive_program import PredictiveProgram

_MANY = 1e3  # bound of rows that do not matter; QP solvers dislike larger numbers


class HorizonSolver:
    """Solves a program within a chair's limits, period after period."""

    def __init__(
        self, program: PredictiveProgram, limits: Limits, options: PredictiveOptions
    ) -> None:
        """Take the program; IPOPT is built where it is asked for."""
        self._program = program
        self._limits = limits
        self._options = options
        self._solver: Solver | None = None
        if options.method == "ipopt":
            stop = SolverOptions(time_limit=min(options.budget, 10.0), iteration_limit=60)
            self._solver = Solver(program.problem, stop)

    def solve(
        self, guess: Array, parameters: Array, *, direction: int, last: Array, keep_jerk: bool
    ) -> Array | None:
        """Return the unknowns, or None where none were found that keep the rows.

        Args:
            guess: Unknowns to start from.
            parameters: Of the program.
            direction: Of the leg: +1, -1 or 0; the speed keeps this sign.
            last: Last command sent [v, omega].
            keep_jerk: Whether the jerk rows count, if the program has them.
        """
        lower, upper = self._row_bounds(direction, last, keep_jerk)
        low, high = self._unknown_bounds(direction, last)
        x = np.clip(guess, low, high)
        if self._solver is not None:
            solution = self._solver.solve(
                x,
                parameters=parameters,
                lower=lower,
                upper=upper,
                unknown_lower=low,
                unknown_upper=high,
            )
            return solution.unknowns.copy() if solution.is_solved else None
        for _ in range(self._options.iterations):
            r, slope, g, rows = self._program.linearised(x, parameters)
            hessian, linear = 2.0 * slope.T @ slope, 2.0 * slope.T @ r
            result = solve_quadratic(hessian, linear, rows, lower - g, upper - g, low - x, high - x)
            if result is None:
                return None
            x = x + result
        return x

    def _row_bounds(self, direction: int, last: Array, keep_jerk: bool) -> tuple[Array, Array]:
        """Return the bounds of the rows, in the order of `PredictiveProgram`."""
        limits, count = self._limits, self._program.count
        most = [
            np.full(count, limits.acceleration),
            np.full(count, limits.yaw_acceleration),
            # What the last command cannot leave at once is not asked of the first steps.
            np.full(count, max(limits.lateral_acceleration, abs(float(np.prod(last))))),
        ]
        least = [-part for part in most]
        if self._program.shape.limits_curvature:
            free = direction == 0
            most.append(np.full(2 * count, _MANY if free else 0.0))
            least.append(np.full(2 * count, -_MANY))
        if self._program.shape.limits_jerk:
            speed = limits.speed if direction > 0 else limits.reverse_speed
            for most_of in (limits.jerk, speed):
                most.append(np.full(count, most_of if keep_jerk else _MANY))
                least.append(-most[-1])
        rows = int(self._program.problem.constraints.numel()) - sum(map(len, most))
        most.append(np.full(rows, -self._options.margin))
        least.append(np.full(rows, -_MANY))
        return np.concatenate(least), np.concatenate(most)

    def _unknown_bounds(self, direction: int, last: Array) -> tuple[Array, Array]:
        """Return the bounds of commands and slack; what braking takes time to leave is allowed."""
        limits = self._limits
        most = np.array([limits.speed if direction > 0 else 0.0, limits.yaw_rate])
        least = np.array([-limits.reverse_speed if direction < 0 else 0.0, -limits.yaw_rate])
        if direction == 0:
            most[0] = least[0] = 0.0
        rates = np.array([limits.acceleration, limits.yaw_acceleration])
        change = np.cumsum(self._program.row_gaps)[:, None] * rates  # (N, 2)
        high = np.maximum(most, last - change).ravel()
        low = np.minimum(least, last + change).ravel()
        clear = len(self._program.shape.clear_steps)
        return np.append(low, np.zeros(clear)), np.append(high, np.full(clear, math.inf))
