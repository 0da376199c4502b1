"""What a smooth manoeuvre costs: compiled once, a step, a refinement, a plan, and IPOPT besides."""

from pathlib import Path as File

import numpy as np
import pytest
from pytest_benchmark.fixture import BenchmarkFixture

from narrows.nlp import Solver
from narrows.planners.body_program import Layout, ManoeuvreProgram, Weights
from narrows.planners.clearance_rows import Finder, rows_along
from narrows.planners.contact_compiled import compiled_contacts
from narrows.planners.contact_finding import contacts_along
from narrows.planners.fitting import fitted
from narrows.planners.guess import forward_guesses
from narrows.planners.manoeuvre import ManoeuvrePlanner
from narrows.planners.refinement import Refinement, RefinementOptions
from narrows.planners.section_motion import SectionMotion
from narrows.planners.spline import Spline
from narrows.scene import load_scene

SCENES = File(__file__).parents[2] / "examples" / "scenes"
NAMES = pytest.mark.parametrize("name", ["door", "narrow-door", "l-corridor", "flat"])
LAYOUT = Layout(1, 10, 128)


def test_compile_the_program_of_one_section(benchmark: BenchmarkFixture) -> None:
    program = benchmark.pedantic(ManoeuvreProgram, (LAYOUT,), rounds=3)
    assert program.problem.unknowns.numel() == 25


def test_evaluate_cost_and_constraints_with_their_derivatives(benchmark: BenchmarkFixture) -> None:
    program = ManoeuvreProgram(LAYOUT)
    rng = np.random.default_rng(0)
    x = rng.uniform(0.1, 1.0, LAYOUT.size)
    parameters = rng.uniform(0.1, 1.0, program.problem.parameters.numel())
    cost, gradient, hessian, _, jacobian = benchmark(program.evaluate, x, parameters)
    assert np.isfinite(cost)
    assert gradient.shape == (25,)
    assert hessian.shape == (25, 25)
    assert jacobian.shape[1] == 25


@NAMES
@pytest.mark.parametrize("finder", [contacts_along, compiled_contacts], ids=["plain", "compiled"])
def test_pick_the_contacts_of_a_curve(
    benchmark: BenchmarkFixture, name: str, finder: Finder
) -> None:
    scene = load_scene(SCENES / f"{name}.yaml")
    guess = fitted(forward_guesses(scene)[0][1], scene, 10)
    motion = SectionMotion(Spline(10), guess.controls[0], 1)
    chair = scene.vehicle
    rows_along(scene.world, chair, motion, 0.02, samples=97, finder=finder)  # compiled by now
    rows, _ = benchmark(rows_along, scene.world, chair, motion, 0.02, samples=97, finder=finder)
    assert len(rows.gap)


@NAMES
def test_refine_the_first_guess(benchmark: BenchmarkFixture, name: str) -> None:
    scene = load_scene(SCENES / f"{name}.yaml")
    guess = fitted(forward_guesses(scene)[0][1], scene, 10)
    refinement = RefinementOptions(segments=10)
    refined = benchmark(lambda: Refinement(scene, guess.directions, refinement).run(guess))
    assert refined.slack <= 1e-4
    assert refined.evaluations <= 60


@NAMES
def test_plan_warm(benchmark: BenchmarkFixture, name: str) -> None:
    scene = load_scene(SCENES / f"{name}.yaml")
    plan = benchmark(ManoeuvrePlanner().plan, scene)
    assert plan.path is not None


def test_compile_the_same_program_for_ipopt(benchmark: BenchmarkFixture) -> None:
    """What the trust-region method is measured against; the solve itself is in its tests."""
    problem = ManoeuvreProgram(LAYOUT).problem
    solver = benchmark.pedantic(Solver, (problem,), rounds=3)
    assert len(Weights().values) == 6
    assert solver.problem is problem
