"""What a segment and a door cost: built and solved, cold and warm, against the plain formulation.

`make bench` prints the times; the assertions count iterations, rows and agreement only.
"""

import math
from pathlib import Path as File

import casadi as ca
import numpy as np
import pytest
from pytest_benchmark.fixture import BenchmarkFixture

from narrows.clearance import certify
from narrows.nlp import Problem, Solver, SolverOptions
from narrows.planners.bezier_legs import leg_bounds
from narrows.planners.bezier_segment import (
    Obstacle,
    SegmentOptions,
    run_segment,
    segment_solver,
    solve_segment,
)
from narrows.planners.doorway import DoorwayOptions, DoorwayPlanner
from narrows.planners.doorway_curve import doorway_solver
from narrows.planners.smoothness import bernstein, curvature_symbols
from narrows.scene import load_scene
from narrows.solution import Solution

START = np.array([0.1, 1.3, math.radians(-20)])  # A1 of [DoorBezier, Table I]
DOOR = np.array([1.6, 1.8, math.pi / 2])
CORRIDOR = np.array([[0.0, -1.0, -0.2], [0.0, 1.0, 1.8]])
OBSTACLES = (Obstacle((0.9, 1.0), 0.2),)
EXAMPLE = File(__file__).parents[2] / "examples" / "scenes" / "door.yaml"
PLUGINS = pytest.mark.parametrize("plugin", ["ipopt", "fatrop"])


def plain_problem(samples: int = 1000) -> Problem:
    """The paper's formulation as it stands: both control points free, 1000 sampled rows.

    The arc cosines of (6) have no derivative where they are zero; their sines are taken.
    """
    x, disk = ca.SX.sym("x", 4), ca.SX.sym("disk", 3)
    start, end = ca.DM(START[:2]).T, ca.DM(DOOR[:2]).T
    control = ca.vertcat(start, x[0:2].T, x[2:4].T, end)
    parameter = np.linspace(0.0, 1.0, samples)
    kappa, rate, _ = curvature_symbols(control, parameter)
    points = ca.mtimes(ca.DM(bernstein(parameter)), control)
    weight = np.full(samples, 1.0 / (samples - 1))
    weight[[0, -1]] *= 0.5
    legs = [control[k + 1, :] - control[k, :] for k in range(3)]

    def cross(a: ca.SX, b: ca.SX) -> ca.SX:
        return a[0] * b[1] - a[1] * b[0]

    def unit(heading: float) -> ca.DM:
        return ca.DM([[math.cos(heading), math.sin(heading)]])

    rows = ca.vertcat(
        cross(unit(START[2]), legs[0]),
        cross(unit(DOOR[2]), legs[2]),
        ca.dot(unit(START[2]), legs[0]),
        ca.dot(unit(DOOR[2]), legs[2]),
        cross(legs[0], legs[1]) * cross(legs[1], legs[2]),
        (points[:, 0] - disk[0]) ** 2 + (points[:, 1] - disk[1]) ** 2 - disk[2] ** 2,
    )
    return Problem(x, ca.dot(ca.DM(weight), kappa**2 + rate**2), rows, disk, "plain")


def solve_plain(solver: Solver, start: np.ndarray) -> Solution:
    disk = OBSTACLES[0]
    rows = solver.problem.constraints.numel()
    upper = np.full(rows, np.inf)
    upper[:2] = 0.0
    return solver.solve(
        start,
        parameters=[*disk.center, disk.distance],
        lower=0.0,
        upper=upper,
        unknown_lower=[-np.inf, 0.2, -np.inf, 0.2],
        unknown_upper=[np.inf, 1.8, np.inf, 1.8],
    )


DEFAULTS = SolverOptions(barrier="monotone", fast_steps=False, iteration_limit=3000)


def test_build_one_segment(benchmark: BenchmarkFixture) -> None:
    solver = benchmark(segment_solver.__wrapped__, SegmentOptions(), 1)
    assert solver.problem.constraints.numel() == 101


@PLUGINS
def test_solve_one_segment_cold(benchmark: BenchmarkFixture, plugin: str) -> None:
    options = SegmentOptions(solver=SolverOptions(plugin=plugin))
    bounds = leg_bounds(START, DOOR, CORRIDOR, convex=True)
    guess = np.array([0.5, 0.5])
    solution = benchmark(run_segment, START, DOOR, bounds, guess, (), options)
    assert solution.statistics.iterations <= 15
    np.testing.assert_allclose(solution.unknowns, [1.058, 0.432], atol=6e-4)


@PLUGINS
def test_solve_one_segment_with_an_obstacle_warm(benchmark: BenchmarkFixture, plugin: str) -> None:
    options = SegmentOptions(solver=SolverOptions(plugin=plugin))
    bounds = leg_bounds(START, DOOR, CORRIDOR, convex=True)
    cold = run_segment(START, DOOR, bounds, np.array([0.5, 0.5]), OBSTACLES, options)
    moved = (Obstacle((0.9, 1.005), 0.2),)
    solution = benchmark(run_segment, START, DOOR, bounds, cold, moved, options)
    assert solution.is_solved
    assert solution.statistics.iterations <= 12


def test_one_segment_from_all_starts(benchmark: BenchmarkFixture) -> None:
    segment = benchmark(solve_segment, START, DOOR, CORRIDOR, OBSTACLES)
    assert segment.iterations <= 120


def test_build_the_plain_formulation(benchmark: BenchmarkFixture) -> None:
    solver = benchmark(lambda: Solver(plain_problem(), DEFAULTS))
    assert solver.problem.constraints.numel() == 1005


def test_solve_the_plain_formulation(benchmark: BenchmarkFixture) -> None:
    solver = Solver(plain_problem(), DEFAULTS)
    ours = solve_segment(START, DOOR, CORRIDOR, OBSTACLES)
    start = np.array([0.5, 1.15, 1.6, 1.3])
    solution = benchmark(solve_plain, solver, start)
    assert solution.is_solved
    # 101 samples see the disk 0.3 mm later than 1000 do
    assert ours.cost == pytest.approx(solution.objective, rel=5e-3)


def test_build_both_segments_with_the_body(benchmark: BenchmarkFixture) -> None:
    options = DoorwayOptions()
    solver = benchmark(doorway_solver.__wrapped__, options.smoothness, options.solver)
    assert solver.problem.unknowns.numel() == 9


@pytest.mark.parametrize(
    "options", [DoorwayOptions.paper(), DoorwayOptions()], ids=["paper", "body"]
)
def test_plan_the_example_door(benchmark: BenchmarkFixture, options: DoorwayOptions) -> None:
    scene = load_scene(EXAMPLE)
    plan = benchmark(DoorwayPlanner(options).plan, scene)
    assert plan.statistics["iterations"] <= 400
    assert (plan.path is not None) == options.body


def test_certify_the_example_door(benchmark: BenchmarkFixture) -> None:
    scene = load_scene(EXAMPLE)
    plan = DoorwayPlanner().plan(scene)
    assert plan.path is not None
    certificate = benchmark(certify, scene.world, scene.vehicle, plan.path)
    assert certificate.is_clear
