"""The one door to IPOPT: what is called solved satisfies its constraints."""

import casadi as ca
import numpy as np
import pytest

from narrows.errors import ShapeError
from narrows.nlp import Problem, Solver, SolverOptions
from narrows.solution import SolveStatus


def rosenbrock() -> Problem:
    """Rosenbrock's valley of steepness p with the free constraint rows x0 x1 and x0 + x1."""
    x, p = ca.SX.sym("x", 2), ca.SX.sym("p")
    return Problem(
        unknowns=x,
        parameters=p,
        objective=(1 - x[0]) ** 2 + p * (x[1] - x[0] ** 2) ** 2,
        constraints=ca.vertcat(x[0] * x[1], x[0] + x[1]),
        name="rosenbrock",
    )


@pytest.fixture(scope="module")
def solver() -> Solver:
    return Solver(rosenbrock())


def test_the_free_minimum_is_found_and_is_stationary(solver: Solver) -> None:
    solution = solver.solve([-1.2, 1.0], parameters=[100.0])
    assert solution.status is SolveStatus.SOLVED
    # IPOPT's tol 1e-8 on a Hessian whose least eigenvalue is 0.4
    np.testing.assert_allclose(solution.unknowns, [1.0, 1.0], atol=1e-6)
    assert solution.objective == pytest.approx(0.0, abs=1e-12)
    assert solution.stationarity < 1e-6


def test_an_active_constraint_and_its_multiplier_have_the_right_sign() -> None:
    x = ca.SX.sym("x")
    line = Solver(Problem(unknowns=x, objective=(x - 3) ** 2, constraints=x))
    solution = line.solve([0.0], upper=1.0)
    assert solution.unknowns[0] == pytest.approx(1.0, abs=1e-6)
    # d f*/d upper = -multiplier: 2 (1 - 3) = -4
    assert solution.multipliers[0] == pytest.approx(4.0, abs=1e-5)
    bounded = line.solve([0.0], unknown_upper=2.0)
    assert bounded.unknowns[0] == pytest.approx(2.0, abs=1e-6)
    assert bounded.bound_multipliers[0] == pytest.approx(2.0, abs=1e-5)


def test_contradicting_constraints_are_infeasible_not_solved(solver: Solver) -> None:
    # x0 x1 >= 5 needs |x0 + x1| >= 2 sqrt(5) = 4.47; with 0 <= x it cannot stay below 3
    solution = solver.solve(
        [1.0, 1.0], parameters=[100.0], lower=[5.0, -9.0], upper=[9.0, 3.0], unknown_lower=0.0
    )
    assert solution.status is SolveStatus.INFEASIBLE
    assert not solution.is_solved
    assert solution.constraint_violation > 0.1
    assert "cannot be satisfied" in solution.message


def test_the_iteration_limit_is_reported_with_the_last_iterate() -> None:
    limited = Solver(rosenbrock(), SolverOptions(iteration_limit=3))
    solution = limited.solve([-1.2, 1.0], parameters=[100.0])
    assert solution.status is SolveStatus.ITERATION_LIMIT
    assert solution.statistics.iterations == 3
    assert not solution.is_solved


def test_a_function_that_is_not_a_number_is_reported_and_silent(
    capfd: pytest.CaptureFixture[str],
) -> None:
    x = ca.SX.sym("x")
    hole = Solver(Problem(unknowns=x, objective=ca.sqrt(x) + ca.log(x)))
    solution = hole.solve([-1.0])
    assert solution.status is SolveStatus.INVALID_NUMBER
    assert not solution.is_solved
    assert capfd.readouterr() == ("", "")


def test_success_claimed_at_a_point_that_breaks_its_constraint_is_untrue() -> None:
    x = ca.SX.sym("x", 2)
    problem = Problem(unknowns=x, objective=ca.sumsqr(x), constraints=x[0] + x[1])
    # With IPOPT's own tolerances at 10 it stops at once and says Solve_Succeeded.
    loose = tuple((name, 10.0) for name in ("constr_viol_tol", "dual_inf_tol", "compl_inf_tol"))
    liar = Solver(problem, SolverOptions(tolerance=10.0, further=loose))
    solution = liar.solve([0.0, 0.0], lower=1.0, upper=1.0)
    assert solution.solver_status == "Solve_Succeeded"
    assert solution.status is SolveStatus.UNTRUE
    assert solution.constraint_violation > 1e-3


def test_a_warm_start_takes_fewer_iterations_to_the_same_point(solver: Solver) -> None:
    cold = solver.solve([-1.2, 1.0], parameters=[100.0], upper=[0.5, 5.0])
    near = solver.solve([-1.2, 1.0], parameters=[101.0], upper=[0.5, 5.0])
    warm = solver.solve(cold, parameters=[101.0], upper=[0.5, 5.0])
    assert warm.status is SolveStatus.SOLVED
    assert warm.statistics.iterations < near.statistics.iterations
    np.testing.assert_allclose(warm.unknowns, near.unknowns, atol=1e-6)


def test_fatrop_agrees_with_ipopt_and_hands_over_what_it_cannot_solve(solver: Solver) -> None:
    quick = Solver(rosenbrock(), SolverOptions(plugin="fatrop", iteration_limit=50))
    for upper in ([0.5, 5.0], [9.0, 9.0]):
        same = solver.solve([-1.2, 1.0], parameters=[100.0], upper=upper)
        fast = quick.solve([-1.2, 1.0], parameters=[100.0], upper=upper)
        assert fast.is_solved
        assert fast.statistics.plugin == "fatrop"
        np.testing.assert_allclose(fast.unknowns, same.unknowns, atol=1e-5)
    broken = quick.solve(
        [1.0, 1.0], parameters=[100.0], lower=[5.0, -9.0], upper=[9.0, 3.0], unknown_lower=0.0
    )
    assert broken.statistics.plugin == "ipopt"
    assert not broken.is_solved


def test_more_equalities_than_unknowns_do_not_raise() -> None:
    x = ca.SX.sym("x")
    tied = Solver(Problem(unknowns=x, objective=x**2, constraints=ca.vertcat(x, 2 * x)))
    solution = tied.solve([0.0], lower=[1.0, 3.0], upper=[1.0, 3.0])
    assert solution.status is SolveStatus.INFEASIBLE


def test_repeats_are_identical_and_results_read_only(solver: Solver) -> None:
    first, second = (solver.solve([-1.2, 1.0], parameters=[100.0]) for _ in range(2))
    assert (first.unknowns == second.unknowns).all()
    assert not first.unknowns.flags.writeable


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"initial": [0.0]}, r"initial must have shape \(2,\), got \(1,\)"),
        ({"initial": [0.0, np.nan]}, "initial must be finite numbers"),
        ({"parameters": []}, r"parameters must have shape \(1,\), got \(0,\)"),
        ({"lower": [2.0, 0.0], "upper": 1.0}, "lower bound 0 of rosenbrock exceeds upper"),
    ],
)
def test_wrong_input_is_said_before_solving(
    solver: Solver, change: dict[str, object], message: str
) -> None:
    given = {"initial": [0.0, 0.0], "parameters": [100.0]} | change
    with pytest.raises(ShapeError, match=message):
        solver.solve(**given)  # type: ignore[arg-type]


def test_an_unknown_plugin_is_refused() -> None:
    with pytest.raises(ShapeError, match="'ipopt' or 'fatrop', got 'magic'"):
        SolverOptions(plugin="magic")
