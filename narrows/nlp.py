"""Nonlinear programs: the one door to CasADi and IPOPT.

    minimise f(x, p)  subject to  lower <= g(x, p) <= upper,  x_lower <= x <= x_upper

A `Problem` is stated with CasADi symbols, a `Solver` is built from it once and solves it for many
parameters, bounds and starts, and a `Solution` is NumPy arrays with a status. A solver's word is
never taken: objective, constraints and their residuals are evaluated again at the point returned,
and only a point that satisfies its constraints is `SOLVED`.

CasADi symbols want `casadi.SX` (small, dense, exact Hessians) and `ca.*` functions, never NumPy's.
A solver object belongs to one thread of one process; build it again in every process.
"""

from __future__ import annotations

import os
import time
from dataclasses import dataclass, field
from functools import cached_property

os.environ.setdefault("OMP_NUM_THREADS", "1")  # read by MUMPS' BLAS when CasADi loads; 45 % slower

import casadi as ca
import numpy as np
from numpy.typing import ArrayLike

from .errors import ShapeError
from .se2 import Array
from .solution import Solution, SolveStatistics, SolveStatus


@dataclass(frozen=True, eq=False)
class Problem:
    """A nonlinear program in CasADi symbols.

    Attributes:
        unknowns: What is sought, a column of symbols (n,).
        objective: Scalar expression to be minimised.
        constraints: Column of expressions (m,); their bounds are given when solving.
        parameters: Column of symbols (k,) whose values are given when solving.
        name: Name for messages.
    """

    unknowns: ca.SX
    objective: ca.SX
    constraints: ca.SX = field(default_factory=lambda: ca.SX(0, 1))
    parameters: ca.SX = field(default_factory=lambda: ca.SX(0, 1))
    name: str = "problem"

    @cached_property
    def functions(self) -> ca.Function:
        """(x, p) -> (f, g), for evaluating a point again."""
        return ca.Function(
            "again", [self.unknowns, self.parameters], [self.objective, self.constraints]
        )

    @cached_property
    def derivatives(self) -> ca.Function:
        """(x, p) -> (gradient of f, Jacobian of g)."""
        return ca.Function(
            "derivatives",
            [self.unknowns, self.parameters],
            [
                ca.gradient(self.objective, self.unknowns),
                ca.jacobian(self.constraints, self.unknowns),
            ],
        )


@dataclass(frozen=True)
class SolverOptions:
    """How to solve; every default is visible here.

    Attributes:
        tolerance: IPOPT's `tol` on the scaled optimality conditions.
        constraint_tolerance: Largest violation of a constraint or bound that counts as satisfied
            when evaluated again, in the constraint's own unit.
        iteration_limit: Largest number of iterations.
        time_limit: Largest CPU time [s].
        barrier: IPOPT's `mu_strategy`, "adaptive" or "monotone".
        warm_barrier: Initial barrier parameter of a warm start; below 1e-5 a constraint that became
            active since takes many more iterations.
        warm_push: How far a warm start is pushed off its bounds, relative.
        fast_steps: Skip MUMPS' scaling and numerical pivoting and IPOPT's residual check of each
            linear solve: 4.2 -> 2.95 ms on two unknowns. Turn off where a solve stalls.
        plugin: "ipopt", or "fatrop" (faster on small problems; IPOPT solves again whatever fatrop
            does not).
        further: More IPOPT options by IPOPT's own names, as pairs.
    """

    tolerance: float = 1e-8
    constraint_tolerance: float = 1e-6
    iteration_limit: int = 200
    time_limit: float = 10.0
    barrier: str = "adaptive"
    warm_barrier: float = 1e-5
    warm_push: float = 1e-3
    fast_steps: bool = True
    plugin: str = "ipopt"
    further: tuple[tuple[str, str | float | int], ...] = ()

    def __post_init__(self) -> None:
        """Check the choices."""
        if self.plugin not in ("ipopt", "fatrop"):
            raise ShapeError(f"plugin must be 'ipopt' or 'fatrop', got {self.plugin!r}")
        if self.barrier not in ("adaptive", "monotone"):
            raise ShapeError(f"barrier must be 'adaptive' or 'monotone', got {self.barrier!r}")

    def ipopt(self, *, warm: bool) -> dict[str, str | float | int]:
        """Return everything IPOPT is told, by its own names."""
        told: dict[str, str | float | int] = {
            "print_level": 0,
            "sb": "yes",
            "tol": self.tolerance,
            "max_iter": self.iteration_limit,
            "max_cpu_time": self.time_limit,
            "mu_strategy": self.barrier,
            "linear_solver": "mumps",
            "honor_original_bounds": "yes",
        }
        if self.fast_steps:
            told |= {
                "fast_step_computation": "yes",
                "mumps_pivtol": 0.0,
                "mumps_scaling": 0,
                "mumps_permuting_scaling": 0,
            }
        if warm:
            names = ("bound_push", "bound_frac", "slack_bound_push", "slack_bound_frac")
            told |= {f"warm_start_{name}": self.warm_push for name in names}
            told |= {
                "warm_start_init_point": "yes",
                "warm_start_mult_bound_push": self.warm_push,
                "mu_strategy": "monotone",
                "mu_init": self.warm_barrier,
            }
        return told | dict(self.further)


class Solver:
    """A problem compiled for one solver: build once, solve often.

    Attributes:
        problem: The problem.
        options: How it is solved.
    """

    def __init__(self, problem: Problem, options: SolverOptions | None = None) -> None:
        """Build the solver; 10-100 ms, mostly derivatives."""
        self.problem = problem
        self.options = SolverOptions() if options is None else options
        self._size = int(problem.unknowns.numel())
        self._rows = int(problem.constraints.numel())
        self._parameters = int(problem.parameters.numel())
        self._built: dict[tuple[str, bool], ca.Function] = {}
        self._compiled(self.options.plugin, warm=False)

    def _compiled(self, plugin: str, *, warm: bool) -> ca.Function:
        """Return the compiled solver, built at its first use."""
        warm = warm and plugin == "ipopt"
        if (plugin, warm) not in self._built:
            problem, chosen = self.problem, self.options
            own: dict[str, str | float | int]
            if plugin == "ipopt":
                own = chosen.ipopt(warm=warm)
            elif plugin == "fatrop":
                own = {
                    "print_level": 0,
                    "tolerance": chosen.tolerance,
                    "max_iter": chosen.iteration_limit,
                }
            else:
                raise ShapeError(f"plugin must be 'ipopt' or 'fatrop', got {plugin!r}")
            program = {
                "x": problem.unknowns,
                "p": problem.parameters,
                "f": problem.objective,
                "g": problem.constraints,
            }
            quiet = {"print_time": False, "show_eval_warnings": False, "error_on_fail": False}
            self._built[plugin, warm] = ca.nlpsol("solver", plugin, program, {**quiet, plugin: own})
        return self._built[plugin, warm]

    def solve(
        self,
        initial: ArrayLike | Solution,
        *,
        parameters: ArrayLike = (),
        lower: ArrayLike = -np.inf,
        upper: ArrayLike = np.inf,
        unknown_lower: ArrayLike = -np.inf,
        unknown_upper: ArrayLike = np.inf,
    ) -> Solution:
        """Solve from a start.

        Args:
            initial: Start, shape (n,), or an earlier solution of this solver for a warm start
                with its multipliers.
            parameters: Values of the parameters, shape (k,).
            lower: Least values of the constraints, scalar or shape (m,).
            upper: Greatest values of the constraints, scalar or shape (m,).
            unknown_lower: Least values of the unknowns, scalar or shape (n,).
            unknown_upper: Greatest values of the unknowns, scalar or shape (n,).

        Returns:
            The solution; look at its status.

        Raises:
            ShapeError: If an array has the wrong size, a start or parameter is not finite, or a
                lower bound exceeds its upper bound.
        """
        begun = time.process_time()
        warm = isinstance(initial, Solution)
        start = initial.unknowns if isinstance(initial, Solution) else initial
        given = {
            "x0": _vector("initial", start, self._size, finite=True),
            "p": _vector("parameters", parameters, self._parameters, finite=True),
            "lbg": _vector("lower", lower, self._rows),
            "ubg": _vector("upper", upper, self._rows),
            "lbx": _vector("unknown_lower", unknown_lower, self._size),
            "ubx": _vector("unknown_upper", unknown_upper, self._size),
        }
        for low, high in (("lbg", "ubg"), ("lbx", "ubx")):
            crossed = np.flatnonzero(given[low] > given[high])
            if len(crossed):
                raise ShapeError(f"lower bound {crossed[0]} of {self.problem.name} exceeds upper")
        if isinstance(initial, Solution):
            given |= {"lam_g0": initial.multipliers, "lam_x0": initial.bound_multipliers}
        solution = self._run(self.options.plugin, given, warm=warm, begun=begun)
        if not solution.is_solved and self.options.plugin != "ipopt":
            return self._run("ipopt", given, warm=warm, begun=begun)
        return solution

    def _run(self, plugin: str, given: dict[str, Array], *, warm: bool, begun: float) -> Solution:
        """Solve with one plug-in and measure what comes back."""
        compiled = self._compiled(plugin, warm=warm)
        result = compiled(**given)
        told = compiled.stats()
        x, lam_g, lam_x = (np.asarray(result[key]).ravel() for key in ("x", "lam_g", "lam_x"))
        value, rows = self.problem.functions(x, given["p"])
        g = np.asarray(rows).ravel()
        gradient, jacobian = self.problem.derivatives(x, given["p"])
        # CasADi gives NaN multipliers after some failures; they must not poison a later warm start.
        lam_g, lam_x = np.nan_to_num(lam_g), np.nan_to_num(lam_x)
        pull = ca.mtimes(jacobian.T, ca.DM(lam_g))  # sparse: large programs have large Jacobians
        slope = np.asarray(gradient).ravel() + np.asarray(pull).ravel() + lam_x
        off_constraints = _violation(g, given["lbg"], given["ubg"])
        off_bounds = _violation(x, given["lbx"], given["ubx"])
        objective = float(value)
        word = str(told["return_status"])
        claimed = SolveStatus.of_ipopt(word)
        if plugin == "fatrop" and told["success"]:
            claimed = SolveStatus.SOLVED
        tolerance = self.options.constraint_tolerance
        holds = off_constraints <= tolerance and off_bounds <= tolerance  # False for NaN
        if claimed.is_success and not (holds and np.isfinite(objective)):
            claimed = SolveStatus.UNTRUE
        for array in (x, g, lam_g, lam_x):
            array.setflags(write=False)
        return Solution(
            status=claimed,
            unknowns=x,
            objective=objective,
            constraints=g,
            constraint_violation=off_constraints,
            bound_violation=off_bounds,
            stationarity=float(np.max(np.abs(slope), initial=0.0)),
            multipliers=lam_g,
            bound_multipliers=lam_x,
            statistics=SolveStatistics(
                iterations=int(told["iter_count"]),
                cpu_time=time.process_time() - begun,
                evaluations=int(told["n_call_nlp_f"]),
                plugin=plugin,
            ),
            solver_status=word,
        )


def _vector(name: str, value: ArrayLike, size: int, *, finite: bool = False) -> Array:
    """Return the value as a vector of the size, a scalar repeated."""
    array = np.asarray(value, dtype=float)
    if array.ndim == 0:
        array = np.full(size, float(array))
    if array.shape != (size,):
        raise ShapeError(f"{name} must have shape ({size},), got {array.shape}")
    if np.isnan(array).any() or (finite and not np.isfinite(array).all()):
        raise ShapeError(f"{name} must be {'finite ' if finite else ''}numbers, got {array}")
    return array


def _violation(values: Array, lower: Array, upper: Array) -> float:
    """Return the largest amount by which values leave their bounds, 0 if none; NaN if any is."""
    return float(np.max(np.maximum(lower - values, values - upper), initial=0.0))
