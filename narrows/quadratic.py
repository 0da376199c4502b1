"""Small dense quadratic programs: the one door to CasADi's active-set solver.

minimise 1/2 d'H d + c'd  subject to  lower <= A d <= upper,  d_lower <= d <= d_upper
"""

from __future__ import annotations

import os
from collections.abc import Mapping
from functools import lru_cache
from typing import Any, NamedTuple

os.environ.setdefault("OMP_NUM_THREADS", "1")

import casadi as ca
import numpy as np

from .se2 import Array

_SOLVER = "daqp"  # of those CasADi brings the fastest on 25 unknowns and 200 rows: 0.05 ms
_TOLERANCE = 1e-4  # in the rows' own unit; callers measure what a step does
_BLOCK = 32  # rows are filled up to a multiple of this: few sizes, few solvers


class Minimum(NamedTuple):
    """Where a quadratic program is least.

    Attributes:
        step: The minimiser d, shape (n,).
        multipliers: Of the rows, shape (m,), positive at the upper bound, negative at the lower:
            H d + c + A' multipliers + those of the box = 0.
    """

    step: Array
    multipliers: Array


class InPlace:
    """A CasADi function that reads and writes arrays where they are.

    A call with arrays converts and copies each of them, which for small programs costs more than
    the function itself.
    """

    def __init__(
        self, function: ca.Function, given: Mapping[int, Array], into: Mapping[int, Array]
    ):
        """Tie the arguments and results of these numbers to arrays, columns first."""
        self._function, self._arrays = function, (dict(given), dict(into))  # kept alive
        buffer: Any
        buffer, self._run = function.buffer()
        for index, array in given.items():
            buffer.set_arg(index, memoryview(array.ravel(order="K")))  # type: ignore[arg-type]
        for index, array in into.items():
            buffer.set_res(index, memoryview(array.ravel(order="K")))  # type: ignore[arg-type]
        self._buffer = buffer

    def run(self) -> None:
        """Evaluate the function."""
        self._run()


class _Prepared:
    """The solver of one size with its arrays, which it reads and writes in place."""

    def __init__(self, unknowns: int, rows: int) -> None:
        shape = {"h": ca.Sparsity.dense(unknowns, unknowns), "a": ca.Sparsity.dense(rows, unknowns)}
        solver = ca.conic("quadratic", _SOLVER, shape, {"error_on_fail": False})
        self.hessian = np.zeros((unknowns, unknowns), order="F")
        self.linear = np.zeros(unknowns)
        self.matrix = np.zeros((rows, unknowns), order="F")
        self.lower, self.upper = np.full(rows, -np.inf), np.full(rows, np.inf)
        self.step_lower, self.step_upper = np.zeros(unknowns), np.zeros(unknowns)
        self.step, self.multipliers = np.zeros(unknowns), np.zeros(rows)
        bounds = (self.lower, self.upper, self.step_lower, self.step_upper)
        given = (self.hessian, self.linear, self.matrix, *bounds)
        into = {0: self.step, 2: self.multipliers}
        self._solver = InPlace(solver, dict(enumerate(given)), into)

    def run(self) -> None:
        """Solve; on failure the results are whatever the solver left."""
        self.step[:] = self.multipliers[:] = np.nan
        self._solver.run()


@lru_cache(maxsize=32)
def _prepared(unknowns: int, rows: int) -> _Prepared:
    return _Prepared(unknowns, rows)


def times(matrix: Array, vector: Array) -> Array:
    """Return a matrix (m, n) times a vector (n,), in this thread.

    From some 9000 entries on `@` wakes all threads of the linear algebra library, whose waiting
    costs more processor time than the product.
    """
    return np.asarray(np.einsum("ij,j->i", matrix, vector))


def solve_quadratic(
    hessian: Array,
    linear: Array,
    matrix: Array,
    lower: Array,
    upper: Array,
    step_lower: Array,
    step_upper: Array,
) -> Array | None:
    """Return the minimiser alone, as `minimum_of` does."""
    found = minimum_of(hessian, linear, matrix, lower, upper, step_lower, step_upper)
    return None if found is None else found.step


def minimum_of(
    hessian: Array,
    linear: Array,
    matrix: Array,
    lower: Array,
    upper: Array,
    step_lower: Array,
    step_upper: Array,
) -> Minimum | None:
    """Return the minimum of a strictly convex quadratic program, or None if there is none.

    The rows are evaluated again: a point that violates one is not returned.

    Args:
        hessian: H, positive definite, shape (n, n).
        linear: c, shape (n,).
        matrix: A, shape (m, n).
        lower: Least values of A d, shape (m,), -inf allowed.
        upper: Greatest values of A d, shape (m,), inf allowed.
        step_lower: Least d, shape (n,).
        step_upper: Greatest d, shape (n,).
    """
    count = len(lower)
    solver = _prepared(len(linear), -(-count // _BLOCK) * _BLOCK)
    solver.hessian[:], solver.linear[:] = hessian, linear
    solver.matrix[:count], solver.matrix[count:] = matrix, 0.0
    solver.lower[:count], solver.lower[count:] = lower, -np.inf
    solver.upper[:count], solver.upper[count:] = upper, np.inf
    solver.step_lower[:], solver.step_upper[:] = step_lower, step_upper
    solver.run()
    step = solver.step
    rows = times(matrix, step)
    worst = max(
        float(np.max(np.maximum(lower - rows, rows - upper), initial=0.0)),
        float(np.max(np.maximum(step_lower - step, step - step_upper), initial=0.0)),
    )
    if not (np.isfinite(step).all() and worst <= _TOLERANCE):
        return None
    step = np.asarray(np.minimum(np.maximum(step, step_lower), step_upper))
    return Minimum(step, solver.multipliers[:count].copy())
