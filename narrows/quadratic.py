"""Small dense quadratic programs: the one door to CasADi's active-set solver.

minimise 1/2 d'H d + c'd  subject to  lower <= A d <= upper,  d_lower <= d <= d_upper
"""

from __future__ import annotations

import os
from functools import lru_cache

os.environ.setdefault("OMP_NUM_THREADS", "1")

import casadi as ca
import numpy as np

from .se2 import Array

_SOLVER = "daqp"  # 0.25 ms on 18 unknowns and 114 rows; qpoases 0.9, piqp 0.6, proxqp 1.6
_TOLERANCE = 1e-4  # in the rows' own unit; callers measure what a step does


@lru_cache(maxsize=32)
def _built(unknowns: int, rows: int) -> ca.Function:
    shape = {"h": ca.Sparsity.dense(unknowns, unknowns), "a": ca.Sparsity.dense(rows, unknowns)}
    return ca.conic("quadratic", _SOLVER, shape, {"error_on_fail": False})


def solve_quadratic(
    hessian: Array,
    linear: Array,
    matrix: Array,
    lower: Array,
    upper: Array,
    step_lower: Array,
    step_upper: Array,
) -> Array | None:
    """Return the minimiser of a strictly convex quadratic program, or None if there is none.

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
    solver = _built(len(linear), len(lower))
    result = solver(
        h=hessian, g=linear, a=matrix, lba=lower, uba=upper, lbx=step_lower, ubx=step_upper
    )
    step = np.asarray(result["x"]).ravel()
    rows = matrix @ step
    worst = max(
        float(np.max(np.maximum(lower - rows, rows - upper), initial=0.0)),
        float(np.max(np.maximum(step_lower - step, step - step_upper), initial=0.0)),
    )
    if not (np.isfinite(step).all() and worst <= _TOLERANCE):
        return None
    return np.asarray(np.clip(step, step_lower, step_upper))
