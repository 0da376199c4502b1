"""Rows, curvature and control points: the program in symbols says the same, differences agree."""

from dataclasses import replace

import casadi as ca
import numpy as np
import pytest

from narrows.planners.bend_terms import BendTerms
from narrows.planners.body_distance import BodyDistance
from narrows.planners.body_program import Layout, ManoeuvreProgram, Weights
from narrows.planners.clearance_rows import Rows, rows_along
from narrows.planners.manoeuvre_shape import Manoeuvre, ManoeuvreShape
from narrows.planners.row_terms import RowTerms
from narrows.planners.section_motion import SectionMotion
from narrows.planners.spline import Spline
from narrows.planners.thin_body import ThinBodies
from narrows.se2 import transform
from narrows.vehicle import Vehicle
from narrows.world import Solid, World

LAYOUT = Layout(sections=2, segments=4, rows=8)
DIRECTIONS = np.array([1, -1])
START = np.array([0.1, 0.2, 0.3])
SHAPE = ManoeuvreShape(LAYOUT, DIRECTIONS, START)
PROGRAM = ManoeuvreProgram(LAYOUT)
BENDS = np.linspace(0.0, 1.0, LAYOUT.bends)
BEND_WEIGHTS = (SHAPE.spline.basis(BENDS, 1), SHAPE.spline.basis(BENDS, 2))


class Case:
    """Random unknowns and rows of both kinds, for both sections."""

    def __init__(self, seed: int) -> None:
        """Draw them."""
        rng = np.random.default_rng(seed)
        self.x = rng.uniform(0.2, 2.0, LAYOUT.size)
        self.x[-2:] = 0.0
        t, fields = rng.uniform(0, 1, (2, 8)), rng.normal(size=(2, 8, 8))
        fields[:, :4, 5], fields[:, 4:, 5], fields[..., 7] = 1.0, 0.0, 1.0
        far, no = np.full(8, np.inf), np.zeros(8, dtype=bool)
        self.rows = [Rows(t[k], fields[k], np.zeros(8), far, no) for k in (0, 1)]
        self.multipliers, self.bends = rng.normal(size=(2, 8)), rng.normal(size=(2, LAYOUT.bends))
        basis = [(SHAPE.spline.basis(t[k]), SHAPE.spline.basis(t[k], 1)) for k in (0, 1)]
        self.weights = basis
        blocks = [np.hstack([*basis[k], fields[k]]).ravel() for k in (0, 1)]
        goal = [1.0, 2.0, 0.3, 0.05]
        given = [START, goal, DIRECTIONS, Weights().values, *blocks]
        self.parameters = np.concatenate(given)

    def terms(self, k: int) -> RowTerms:
        """The rows of a section."""
        control = SHAPE.controls(self.x)[k]
        return RowTerms.of(self.rows[k], control, int(DIRECTIONS[k]), self.weights[k])


@pytest.mark.parametrize("seed", range(3))
def test_rows_and_curvatures_are_those_of_the_program_in_symbols(seed: int) -> None:
    case = Case(seed)
    _, _, _, g, jacobian = PROGRAM.evaluate(case.x, case.parameters)
    begin = 2 + 2 * LAYOUT.bends * LAYOUT.sections
    for k in (0, 1):
        own = slice(begin + 8 * k, begin + 8 * k + 8)
        derivative, terms = SHAPE.derivative(case.x, k), case.terms(k)
        np.testing.assert_allclose(terms.value, g[own], atol=1e-12)
        ours = terms.jacobian @ derivative
        np.testing.assert_allclose(ours[:, :-2], jacobian[own, :-2], atol=1e-11)
        carried = SHAPE.carried(terms.jacobian, case.x, k)
        np.testing.assert_allclose(carried, ours, atol=1e-12)
        bent = slice(2 + 2 * LAYOUT.bends * k, 2 + 2 * LAYOUT.bends * k + LAYOUT.bends)
        bends = BendTerms.of(SHAPE.controls(case.x)[k], BEND_WEIGHTS)
        scale = 1.0 + np.abs(jacobian[bent]).max()
        np.testing.assert_allclose(bends.value, g[bent], atol=1e-12 * scale)
        ours = bends.jacobian @ derivative
        np.testing.assert_allclose(ours[:, :-2], jacobian[bent, :-2], atol=1e-11 * scale)


@pytest.mark.parametrize("seed", range(3))
def test_second_derivatives_are_those_of_the_program_in_symbols(seed: int) -> None:
    case = Case(seed)
    problem = PROGRAM.problem
    factors = ca.SX.sym("multipliers", problem.constraints.shape[0])
    lagrangian = ca.dot(factors, problem.constraints)
    hessian = ca.densify(ca.hessian(lagrangian, problem.unknowns)[0])
    function = ca.Function("h", [problem.unknowns, problem.parameters, factors], [hessian])
    given = np.zeros(problem.constraints.shape[0])
    given[-16:] = case.multipliers.ravel()
    ours = np.zeros((LAYOUT.size, LAYOUT.size))
    for k in (0, 1):
        begin = 2 + 2 * LAYOUT.bends * k
        given[begin : begin + LAYOUT.bends] = case.bends[k]
        terms = case.terms(k)
        bends = BendTerms.of(SHAPE.controls(case.x)[k], BEND_WEIGHTS)
        gradient = case.multipliers[k] @ terms.jacobian + case.bends[k] @ bends.jacobian
        own = terms.hessian(case.multipliers[k], SHAPE.spline) + bends.hessian(case.bends[k])
        derivative = SHAPE.derivative(case.x, k)
        ours += derivative.T @ own @ derivative + SHAPE.bending(case.x, k, gradient)
    theirs = function(case.x, case.parameters, given).full()
    np.testing.assert_allclose(ours, theirs, atol=1e-10 * np.abs(theirs).max())


def least_clearance(world: World, vehicle: Vehicle, control: np.ndarray, t: float) -> float:
    """The least distance near a parameter, by dense sampling about it."""
    motion = SectionMotion(Spline(6), control, 1)
    pieces = world.pieces_between(0.0, 1.0)
    body = BodyDistance.of(vehicle.layers[0], pieces)
    for width in (1e-2, 1e-4):
        around = np.linspace(t - width, t + width, 4001)
        found = body.measure(motion(around), np.zeros(4001, dtype=np.int64), 1.0).distance
        t = float(around[found.argmin()])
    return float(found.min())


CONTROL = np.column_stack([np.linspace(0, 2, 9), 0.12 * np.linspace(0, 2, 9) ** 2 - 0.1])
CHAIR = Vehicle.rectangle(1.0, 0.67, 0.25)


def beside(what: str) -> World:
    """What stands beside a chair that turns left: a corner or post it passes, a post it faces."""
    if what == "corner":
        return World((Solid.polygon([[1.3, 0.42], [1.7, 1.02], [0.9, 1.02]]),))
    if what == "post":
        return World((Solid.circle(1.3, 0.5, 0.08),))
    pose = SectionMotion(Spline(6), CONTROL, 1)(np.array([1.0]))[0]
    x, y = transform(pose, [[0.75 + 0.006, -0.335 - 0.008]])[0]
    return World((Solid.polygon([[x, y], [x + 0.2, y - 0.1], [x + 0.1, y - 0.2]]),))


def bent_on(spline: Spline) -> np.ndarray:
    """The curve of CONTROL, driven 20 cm further: what it faced at the end lies inside."""
    points = spline.basis(np.linspace(0, 1, 50)) @ CONTROL
    end = points[-1] - points[-2]
    further = points[-1] + np.linspace(0, 0.2, 6)[1:, None] * end / np.linalg.norm(end)
    every = np.vstack([points, further + 0.3 * (further - points[-1])[:, :1] ** 2 * [0, 1]])
    basis = spline.basis(np.linspace(0, 1, len(every)))
    return np.linalg.lstsq(basis, every, rcond=None)[0]


@pytest.mark.parametrize("what", ["corner", "post", "two corners"])
def test_the_least_clearance_bends_as_its_row_says(what: str) -> None:
    """A chair turns past something: the place of the least moves with the curve."""
    spline, world, rng = Spline(6), beside(what), np.random.default_rng(2)
    control = bent_on(spline) if what == "two corners" else CONTROL
    rows, least = rows_along(world, CHAIR, SectionMotion(spline, control, 1), 0.02, samples=97)
    nearest = int(rows.gap.argmin())
    assert rows.is_least[nearest]
    assert np.isfinite(rows.between_corners[nearest]) == (what == "two corners")
    rows = rows.take(np.array([nearest]))
    weights = (spline.basis(rows.parameter), spline.basis(rows.parameter, 1))
    terms = RowTerms.of(rows, control, 1, weights)
    hessian = terms.hessian(np.ones(1), spline)
    t, h = float(rows.parameter[0]), 2e-4 if what == "two corners" else 2e-3
    for _ in range(5):
        step = rng.normal(size=control.shape)
        step /= np.abs(step).max()
        here, ahead, behind = (
            least_clearance(world, CHAIR, control + s * h * step, t) for s in (0, 1, -1)
        )
        assert here == pytest.approx(least, abs=1e-6)
        slope = float(terms.jacobian[0] @ step.ravel())
        assert (ahead - behind) / (2 * h) == pytest.approx(slope, abs=2e-3)
        bending = float(step.ravel() @ hessian @ step.ravel())
        assert (ahead - 2 * here + behind) / h**2 == pytest.approx(bending, rel=0.1, abs=0.1)


def test_at_a_place_that_stays_the_distance_of_two_corners_bends_as_its_row_says() -> None:
    """The axis between them turns: the distance grows by the move across it squared over twice."""
    spline, world, rng = Spline(6), beside("two corners"), np.random.default_rng(2)
    control = bent_on(spline)
    motion = SectionMotion(spline, control, 1)
    rows, _ = rows_along(world, CHAIR, motion, 0.02, samples=97)
    rows = rows.take(np.array([int(rows.gap.argmin())]))
    rows = replace(rows, is_least=np.zeros(1, dtype=bool))
    weights = (spline.basis(rows.parameter), spline.basis(rows.parameter, 1))
    hessian = RowTerms.of(rows, control, 1, weights).hessian(np.ones(1), spline)
    body = BodyDistance.of(CHAIR.layers[0], world.pieces_between(0.0, 1.0))
    for _ in range(5):
        step = rng.normal(size=control.shape)
        step *= 1e-4 / np.abs(step).max()
        poses = np.vstack(
            [SectionMotion(spline, control + s * step, 1)(rows.parameter) for s in (-1, 0, 1)]
        )
        behind, here, ahead = body.measure(poses, np.zeros(3, dtype=np.int64), 1.0).distance
        bending = float(step.ravel() @ hessian @ step.ravel())
        assert ahead - 2 * here + behind == pytest.approx(bending, rel=0.02, abs=1e-11)


def test_unknowns_and_control_points_go_both_ways() -> None:
    x = Case(4).x
    controls = np.array(SHAPE.controls(x))
    nodes = np.vstack([START, x[0:3], x[3:6]])
    back = SHAPE.unknowns(Manoeuvre(DIRECTIONS, nodes, controls))
    np.testing.assert_allclose(back, x, atol=1e-12)


def test_thin_bodies_lose_the_same_on_all_sides_and_never_all_of_it() -> None:
    vehicle = Vehicle.rectangle(1.0, 0.67, 0.25)
    bodies = ThinBodies(vehicle)
    assert bodies.thinner_by(0.0) is vehicle
    assert bodies.thinnest == pytest.approx(0.8 * 0.335, rel=1e-3)
    np.testing.assert_allclose(
        np.ptp(bodies.thinner_by(0.1).outline, axis=0), [0.8, 0.47], atol=1e-12
    )
    assert bodies.thinner_by(0.1) is bodies.thinner_by(0.1)
