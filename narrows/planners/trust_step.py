"""One step of a refinement: the quadratic program of a point within a trust radius."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from narrows.quadratic import minimum_of
from narrows.se2 import Array

from .body_program import Weights
from .manoeuvre_shape import SHORTEST_LEG
from .refinement_point import Constraints, Multipliers, Point, RefinementModel

_EDGE = 0.98  # share of the goal's tolerance that is used
_SLACK_CURVATURE = 10.0  # cost / m^2: 2e-3 at a slack of 20 mm
_ONE_THREAD = 25  # rows up to which NumPy looks for eigenvalues in one thread
_LEAST_CURVATURE = 1e-2  # least eigenvalue of the cost's model


@dataclass(frozen=True, eq=False)
class Step:
    """A step and what it promises.

    Attributes:
        move: Change of the unknowns, shape (size,).
        promised: Fall of the cost by the model.
        longest: Largest change of an unknown but the slacks [m, rad].
        multipliers: Of the constraints.
    """

    move: Array
    promised: float
    longest: float
    multipliers: Multipliers


def trust_step(
    model: RefinementModel,
    point: Point,
    seen: Constraints,
    hessian: Array,
    radius: float,
    weights: Weights,
) -> Step | None:
    """Return the step that lowers the model of the cost most, or None if there is none.

    Args:
        model: The scene's program.
        point: Where the step starts.
        seen: The constraints as the step is to see them: the point's own, or corrected ones.
        hessian: Curvature of the cost's model, positive definite, shape (size, size).
        radius: Bound on the change of every unknown but the slacks [m, rad].
        weights: The prices.
    """
    bent, clear = len(seen.bends), seen.clearances
    reach = _EDGE * model.scene.goal.position_tolerance / np.sqrt(2.0)
    # A start beyond the goal's tolerance must be able to step at all.
    goal_low = np.minimum(-reach - seen.goal, radius)
    goal_high = np.maximum(reach - seen.goal, -radius)
    rows = np.concatenate([seen.goal_jacobian, seen.bend_jacobian, seen.clearance_jacobian])
    rows[2 : 2 + bent, -1] = -1.0
    rows[2 + bent :, -2] = 1.0
    # The slacks are unknowns from zero on; a step changes them from what they are.
    slack, excess = point.x[-2:]
    none = np.full(bent, -np.inf)
    lower = np.concatenate([goal_low, none, -clear - slack])
    upper = np.concatenate(
        [goal_high, model.limit - seen.bends + excess, np.full(len(clear), np.inf)]
    )
    low, high = _box(model, point, radius)
    gradient = point.gradient.copy()
    gradient[-2:] = weights.price, weights.bend_price
    found = minimum_of(hessian, gradient, rows, lower, upper, low, high)
    if found is None:
        return None
    move = found.step
    return Step(
        move,
        -float(gradient @ move + 0.5 * move @ hessian @ move),
        float(np.abs(move[:-2]).max()),
        Multipliers(found.multipliers[2 : 2 + bent], found.multipliers[2 + bent :]),
    )


def _box(model: RefinementModel, point: Point, radius: float) -> tuple[Array, Array]:
    """Return the least and the greatest change of every unknown."""
    layout, scene, x = model.layout, model.scene, point.x
    low, high = np.full(layout.size, -radius), np.full(layout.size, radius)
    for k in range(layout.sections):
        begin = layout.section(k).start
        legs = slice(begin, begin + 2)
        low[legs] = np.minimum(0.0, np.maximum(-radius, SHORTEST_LEG - x[legs]))
    goal = 3 * layout.sections - 1
    turn = _EDGE * scene.goal.heading_tolerance
    off = x[goal] - model.goal[2]
    low[goal] = max(-radius, min(0.0, -turn - off))
    high[goal] = min(radius, max(0.0, turn - off))
    low[-2:], high[-2:] = -x[-2:], 1e3
    return low, high


def convex(hessian: Array) -> Array:
    """Return a Hessian without its negative curvature, a little of it everywhere.

    The slacks enter linearly; a little curvature keeps the quadratic program well scaled.
    """
    curves = hessian[:-2, :-2]
    values, vectors = _eigen(0.5 * (curves + curves.T))
    result = np.diag(np.full(len(hessian), _SLACK_CURVATURE))
    result[:-2, :-2] = (vectors * np.maximum(values, _LEAST_CURVATURE)) @ vectors.T
    return result


def _eigen(matrix: Array) -> tuple[Array, Array]:
    """Return eigenvalues (n,) and eigenvectors (n, n) of a symmetric matrix, in this thread.

    NumPy's own wakes all threads from 26 rows on, whose waiting costs ten times the work; SciPy's
    does not, but takes a while to import.
    """
    if len(matrix) <= _ONE_THREAD:
        values, vectors = np.linalg.eigh(matrix)
    else:
        from scipy.linalg import eigh

        values, vectors = eigh(matrix, driver="evd", check_finite=False)
    return np.asarray(values), np.asarray(vectors)
