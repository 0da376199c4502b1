"""Quadratic programs: known answers, conditions of optimality, no answer, and IPOPT's."""

import casadi as ca
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.optimize import nnls

from narrows.nlp import Problem, Solver
from narrows.quadratic import solve_quadratic

FREE = np.inf


def solve(hessian, linear, matrix, lower, upper, low=-FREE, high=FREE):
    n = len(linear)
    return solve_quadratic(
        np.array(hessian, dtype=float),
        np.array(linear, dtype=float),
        np.array(matrix, dtype=float).reshape(-1, n),
        np.array(lower, dtype=float),
        np.array(upper, dtype=float),
        np.full(n, low),
        np.full(n, high),
    )


class TestKnownAnswers:
    """min 1/2 |d|^2 - c'd and the like, by hand."""

    def test_without_an_active_row_it_is_newtons_step(self) -> None:
        step = solve([[2, 0], [0, 4]], [-2, -8], [[1, 1]], [-FREE], [100])
        np.testing.assert_allclose(step, [1, 2], atol=1e-8)

    def test_a_row_projects_onto_its_line(self) -> None:
        step = solve(np.eye(2), [-2, -2], [[1, 1]], [-FREE], [2])
        np.testing.assert_allclose(step, [1, 1], atol=1e-8)

    def test_a_lower_row_pushes(self) -> None:
        step = solve(np.eye(2), [0, 0], [[3, 4]], [5], [FREE])
        np.testing.assert_allclose(step, [0.6, 0.8], atol=1e-8)

    def test_an_equality_holds(self) -> None:
        step = solve([[1, 0], [0, 3]], [0, 0], [[1, 1]], [4], [4])
        np.testing.assert_allclose(step, [3, 1], atol=1e-7)

    def test_the_box_holds_exactly(self) -> None:
        step = solve(np.eye(3), [-5, 5, -0.25], [[0, 0, 1]], [-1], [1], -0.5, 0.5)
        np.testing.assert_array_equal(step[:2], [0.5, -0.5])
        assert step[2] == pytest.approx(0.25, abs=1e-9)


class TestNoAnswer:
    """Nothing is returned that breaks a row."""

    def test_rows_that_exclude_each_other(self) -> None:
        assert solve(np.eye(2), [0, 0], [[1, 0], [1, 0]], [1, -FREE], [FREE, 0]) is None

    def test_a_row_out_of_the_boxs_reach(self) -> None:
        assert solve(np.eye(2), [0, 0], [[1, 1]], [3], [FREE], -1, 1) is None

    def test_numbers_that_are_none(self) -> None:
        assert solve(np.eye(2), [np.nan, 0], [[1, 1]], [0], [1]) is None


def random_program(seed: int):
    """A strictly convex program with a feasible point inside."""
    rng = np.random.default_rng(seed)
    n, m = int(rng.integers(2, 12)), int(rng.integers(1, 25))
    root = rng.normal(size=(n, n))
    hessian = root @ root.T + rng.uniform(0.05, 1.0) * np.eye(n)
    matrix, inside = rng.normal(size=(m, n)), rng.uniform(-0.5, 0.5, n)
    lower = matrix @ inside - rng.uniform(0.0, 1.0, m)
    upper = matrix @ inside + rng.uniform(0.0, 1.0, m)
    lower[rng.random(m) < 0.4] = -np.inf
    upper[rng.random(m) < 0.4] = np.inf
    return hessian, 5 * rng.normal(size=n), matrix, lower, upper, np.full(n, -1.0), np.full(n, 1.0)


@given(st.integers(0, 2**32 - 1))
@settings(deadline=None, max_examples=40, derandomize=True)
def test_the_conditions_of_optimality_hold(seed: int) -> None:
    """H d + c = A'y + z with y, z >= 0 at lower, <= 0 at upper bounds, zero elsewhere."""
    hessian, linear, matrix, lower, upper, low, high = random_program(seed)
    step = solve_quadratic(hessian, linear, matrix, lower, upper, low, high)
    assert step is not None
    rows = matrix @ step
    assert (rows >= lower - 1e-6).all()
    assert (rows <= upper + 1e-6).all()
    assert (np.abs(step) <= 1.0).all()
    faces = []  # outward normals of the active bounds
    faces += [-row for row, at, bound in zip(matrix, rows, lower, strict=True) if at < bound + 1e-6]
    faces += [row for row, at, bound in zip(matrix, rows, upper, strict=True) if at > bound - 1e-6]
    faces += [-unit for unit, at in zip(np.eye(len(step)), step, strict=True) if at < -1 + 1e-6]
    faces += [unit for unit, at in zip(np.eye(len(step)), step, strict=True) if at > 1 - 1e-6]
    downhill = -(hessian @ step + linear)
    left = np.linalg.norm(downhill) if not faces else nnls(np.array(faces).T, downhill)[1]
    assert left <= 1e-5 * (1.0 + np.linalg.norm(linear))


def test_it_agrees_with_ipopt() -> None:
    for seed in range(12):
        hessian, linear, matrix, lower, upper, low, high = random_program(seed)
        d = ca.SX.sym("d", len(linear))
        objective = 0.5 * ca.bilin(ca.DM(hessian), d, d) + ca.dot(ca.DM(linear), d)
        solver = Solver(Problem(d, objective, ca.mtimes(ca.DM(matrix), d)))
        solution = solver.solve(
            np.zeros(len(linear)), lower=lower, upper=upper, unknown_lower=low, unknown_upper=high
        )
        assert solution.is_solved
        step = solve_quadratic(hessian, linear, matrix, lower, upper, low, high)
        assert step is not None
        value = 0.5 * step @ hessian @ step + linear @ step
        assert value == pytest.approx(solution.objective, rel=1e-6, abs=1e-6)
        np.testing.assert_allclose(step, solution.unknowns, atol=2e-4)


def test_the_same_program_gives_the_same_step_to_the_last_bit() -> None:
    """Whatever was solved between: no hidden warm start."""
    first = solve_quadratic(*random_program(3))
    for seed in range(20, 30):
        solve_quadratic(*random_program(seed))
    np.testing.assert_array_equal(solve_quadratic(*random_program(3)), first)
