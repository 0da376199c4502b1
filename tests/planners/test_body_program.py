"""The program says what geometry and curves say: cost, curvature, clearance, derivatives."""

import math

import numpy as np
import pytest
from scipy.integrate import quad

from narrows import bezier
from narrows.bezier_section import BezierSection
from narrows.geometry import separation
from narrows.planners.body_program import ROW_FIELDS, Layout, ManoeuvreProgram, Weights
from narrows.planners.spline import Spline
from narrows.se2 import rotate, transform
from narrows.vehicle import Vehicle

BODY = Vehicle.rectangle(1.0, 0.67, 0.25).outline
LAYOUT = Layout(sections=2, segments=3, rows=6)
DIRECTIONS = np.array([1.0, -1.0])
START = np.array([0.1, -0.2, 0.3])
GOAL = np.array([0.9, 1.1, -0.4, 0.05])  # with its position tolerance
TWO_WAYS = ManoeuvreProgram(LAYOUT)


def unknowns(seed: int) -> np.ndarray:
    """A shunt: forward to a node, back to near the goal, slacks of a few millimetres."""
    rng = np.random.default_rng(seed)
    node = np.array([1.2, 0.5, 0.9]) + 0.1 * rng.normal(size=3)
    last = GOAL[:3] + 0.03 * rng.normal(size=3)
    x = np.zeros(LAYOUT.size)
    x[0:3], x[3:6] = node, last
    for k, (first, end) in enumerate(((START, node), (node, last))):
        own = LAYOUT.section(k)
        between = (
            first[:2] + np.linspace(0.3, 0.7, LAYOUT.segments - 1)[:, None] * (end - first)[:2]
        )
        between = between + 0.05 * rng.normal(size=between.shape)
        x[own] = np.concatenate([rng.uniform(0.1, 0.3, 2), between.ravel()])
    x[-2:] = 0.004, 0.02
    return x


def controls(x: np.ndarray) -> list[np.ndarray]:
    """The control points of both sections, written out from the page's definition."""
    found, first = [], START
    for k, direction in enumerate(DIRECTIONS):
        last, own = x[3 * k : 3 * k + 3], x[LAYOUT.section(k)]
        ahead, back = (
            direction * np.array([math.cos(p[2]), math.sin(p[2])]) for p in (first, last)
        )
        found.append(
            np.vstack(
                [
                    first[:2],
                    first[:2] + own[0] * ahead,
                    own[2:].reshape(-1, 2),
                    last[:2] - own[1] * back,
                    last[:2],
                ]
            )
        )
        first = last
    return found


def pose(x: np.ndarray, k: int, t: float) -> np.ndarray:
    """The pose of section k at a parameter."""
    spline = TWO_WAYS.spline
    position = (spline.basis([t]) @ controls(x)[k])[0]
    slope = DIRECTIONS[k] * (spline.basis([t], 1) @ controls(x)[k])[0]
    return np.array([*position, math.atan2(slope[1], slope[0])])


def row(t: float, **fields: float) -> np.ndarray:
    """One row of clearance at a parameter, fields by their names."""
    spline = TWO_WAYS.spline
    values = [fields.get(name, 0.0) for name in ROW_FIELDS]
    return np.concatenate([spline.basis([t])[0], spline.basis([t], 1)[0], values])


def unused_row(spline: Spline) -> np.ndarray:
    return np.concatenate([spline.basis([0.0])[0], spline.basis([0.0], 1)[0], np.zeros(8)])


def parameters(rows: list[list[np.ndarray]], weights: Weights) -> np.ndarray:
    """All parameters; unfilled rows stand at t = 0 with nothing in them."""
    blocks = []
    for own in rows:
        filled = [*own, *[unused_row(TWO_WAYS.spline)] * (LAYOUT.rows - len(own))]
        blocks.append(np.concatenate(filled))
    return np.concatenate([START, GOAL, DIRECTIONS, weights.values, *blocks])


def cost_of(x: np.ndarray, p: np.ndarray) -> float:
    return TWO_WAYS.evaluate(x, p)[0]


def rows_of(x: np.ndarray, p: np.ndarray) -> np.ndarray:
    return TWO_WAYS.evaluate(x, p)[3]


def contact(x: np.ndarray, k: int, t: float, solid: np.ndarray) -> tuple[float, list[np.ndarray]]:
    """The distance of body and solid at a place, and every corner's row against its axis."""
    here = pose(x, k, t)
    corners = transform(here, BODY)
    result = separation(corners[None], solid[None])
    axis, gap = result.axis[0], float(result.distance[0])
    world = [
        row(
            t,
            axis_x=axis[0],
            axis_y=axis[1],
            corner_x=corner[0],
            corner_y=corner[1],
            support=float((solid @ axis).min()),
            in_world=1.0,
        )
        for corner in BODY
    ]
    own = rotate(-here[2], axis)
    body = [
        row(
            t,
            axis_x=own[0],
            axis_y=own[1],
            corner_x=corner[0],
            corner_y=corner[1],
            support=float((BODY @ own).max()),
        )
        for corner in solid
    ]
    return gap, [*world, *body]


SOLIDS = [
    np.array([[2.6, 0.2], [3.0, 0.2], [3.0, 2.0], [2.6, 2.0]]),
    np.array([[0.2, 1.9], [0.8, 1.7], [0.5, 2.4]]),
    np.array([[-0.5, -1.4], [1.5, -1.5], [1.5, -1.3]]),
]


@pytest.mark.parametrize("section", [0, 1])
@pytest.mark.parametrize("t", [0.0, 0.41, 1.0])
@pytest.mark.parametrize("solid", SOLIDS, ids=["wall", "wedge", "kerb"])
def test_the_least_row_of_a_contact_is_the_distance_of_body_and_solid(
    section: int, t: float, solid: np.ndarray
) -> None:
    """All corners against the axis: the least is the gap, whichever side holds the axis."""
    x = unknowns(1)
    x[-2] = 0.0
    gap, rows = contact(x, section, t, solid)
    bends = 2 * LAYOUT.sections * LAYOUT.bends
    for group in (rows[:4], rows[4:]):
        filled = [[], []]
        filled[section] = group
        g = rows_of(x, parameters(filled, Weights()))
        begin = 2 + bends + section * LAYOUT.rows
        assert g[begin : begin + len(group)].min() == pytest.approx(gap, abs=1e-12)


def test_what_is_required_and_the_slacks_share_enter_a_row_as_said() -> None:
    x = unknowns(2)
    _, rows = contact(x, 0, 0.5, SOLIDS[0])
    plain = rows[0].copy()
    asked = rows[0].copy()
    fields = slice(len(asked) - len(ROW_FIELDS), None)
    given = dict(zip(ROW_FIELDS, asked[fields], strict=True)) | {"required": 0.03, "share": 0.5}
    asked[fields] = [given[name] for name in ROW_FIELDS]
    begin = 2 + 2 * LAYOUT.sections * LAYOUT.bends
    g = rows_of(x, parameters([[plain, asked], []], Weights()))
    assert g[begin + 1] == pytest.approx(g[begin] - 0.03 + 0.5 * x[-2], abs=1e-14)


TURN = np.linspace(0.0, math.pi / 2, 400)
CURVES = {
    "arc": 1.25 * np.column_stack([np.sin(TURN), 1 - np.cos(TURN)]),
    "swerve": np.column_stack([1.5 * TURN, 0.25 * (1 - np.cos(2 * TURN))]),
}


def one_section(curve: np.ndarray, direction: float, weights: Weights) -> tuple[float, np.ndarray]:
    """Return the cost and the Bezier pieces of the spline nearest to a curve's points."""
    program = ManoeuvreProgram(Layout(1, 10, 1))
    spline = program.spline
    control = np.linalg.lstsq(spline.basis(np.linspace(0, 1, len(curve))), curve, rcond=None)[0]
    legs = direction * np.array([control[1] - control[0], control[-1] - control[-2]])
    headings = np.arctan2(legs[:, 1], legs[:, 0])
    own = [*np.linalg.norm(legs, axis=1), *control[2:-2].ravel()]
    last = [*control[-1], headings[1]]
    p = np.concatenate(
        [control[0], headings[:1], last, [0.05, direction], weights.values, unused_row(spline)]
    )
    return program.evaluate(np.array([*last, *own, 0.0, 0.0]), p)[0], spline.to_bezier(control)


@pytest.mark.parametrize("curve", CURVES)
@pytest.mark.parametrize("direction", [1.0, -1.0])
def test_the_cost_is_the_integral_along_the_same_curve(curve: str, direction: float) -> None:
    """INT kappa^2 + l^2 kappa_s^2 + a ds by adaptive quadrature on the Bezier pieces."""
    weights = Weights(rate_length=0.4, length=0.7, evenness=0.0)
    cost, pieces = one_section(CURVES[curve], direction, weights)

    def density(u: float, piece: np.ndarray) -> float:
        speed = float(np.linalg.norm(bezier.evaluate(piece, u, 1)))
        kappa = float(bezier.curvature(piece, u))
        rate = float(bezier.curvature_rate(piece, u)) / speed
        return speed * (kappa**2 + 0.4**2 * rate**2 + 0.7)

    expected = sum(quad(density, 0.0, 1.0, args=(piece,), epsabs=1e-10)[0] for piece in pieces)
    assert cost == pytest.approx(expected, rel=1e-6)  # four nodes on each of ten gentle pieces


def test_an_arc_costs_its_curvature_squared_and_its_length() -> None:
    """A quarter circle of radius 1.25 m: L / r^2 + a L, its bend even to a thousandth."""
    cost, _ = one_section(CURVES["arc"], 1.0, Weights(length=0.05, evenness=0.0))
    length = 1.25 * math.pi / 2
    assert cost == pytest.approx(length / 1.25**2 + 0.05 * length, rel=1e-3)


def test_slack_and_excess_cost_their_price_and_the_goal_its_share() -> None:
    x, weights = unknowns(4), Weights()
    p = parameters([[], []], weights)
    base = cost_of(x, p)
    for index, price in ((-2, weights.price), (-1, weights.bend_price)):
        more = x.copy()
        more[index] += 0.01
        assert cost_of(more, p) - base == pytest.approx(0.01 * price)
    at_goal, off = x.copy(), x.copy()
    free = Weights(goal=0.0)
    at_goal[3:6] = GOAL[:3]
    off[3:6] = GOAL[:3] + np.array([0.05 * 0.6, 0.05 * 0.8, 0.0])  # the whole position tolerance
    for point, expected in ((at_goal, 0.0), (off, weights.goal)):
        with_goal = cost_of(point, p)
        without = cost_of(point, parameters([[], []], free))
        assert with_goal - without == pytest.approx(expected, abs=1e-9)


def test_the_first_rows_are_the_goals_offset_ahead_and_aside() -> None:
    x = unknowns(5)
    g = rows_of(x, parameters([[], []], Weights()))
    np.testing.assert_allclose(g[:2], rotate(-GOAL[2], x[3:5] - GOAL[:2]), atol=1e-14)


def test_the_curvature_rows_are_the_curves_curvature_less_the_excess() -> None:
    x = unknowns(6)
    g = rows_of(x, parameters([[], []], Weights()))
    samples = np.linspace(0.0, 1.0, LAYOUT.bends)
    for k, control in enumerate(controls(x)):
        section = BezierSection(TWO_WAYS.spline.to_bezier(control), int(DIRECTIONS[k]))
        piece = np.minimum((samples * LAYOUT.segments).astype(int), LAYOUT.segments - 1)
        progress = section.progress_at(piece, samples * LAYOUT.segments - piece)
        kappa = section.evaluate(progress, 1)[:, 2]
        begin = 2 + 2 * LAYOUT.bends * k
        both = g[begin : begin + 2 * LAYOUT.bends].reshape(2, -1)
        scale = 1.0 + np.abs(kappa).max()
        np.testing.assert_allclose(both[0], kappa - x[-1], atol=1e-5 * scale)
        np.testing.assert_allclose(both[1], -kappa - x[-1], atol=1e-5 * scale)


def filled(x: np.ndarray) -> np.ndarray:
    """Parameters with rows of both kinds in both sections."""
    first = contact(x, 0, 0.3, SOLIDS[0])[1]
    last = contact(x, 1, 0.8, SOLIDS[1])[1]
    return parameters([[*first[:3], *first[4:7]], [*last[1:4], *last[4:7]]], Weights())


@pytest.mark.parametrize("seed", range(3))
def test_gradient_hessian_and_jacobian_agree_with_central_differences(seed: int) -> None:
    x = unknowns(seed)
    p = filled(x)
    _, gradient, hessian, _, jacobian = TWO_WAYS.evaluate(x, p)
    h = 1e-6
    for k in range(len(x)):
        step = np.zeros(len(x))
        step[k] = h
        above, below = TWO_WAYS.evaluate(x + step, p), TWO_WAYS.evaluate(x - step, p)
        slope = (above[0] - below[0]) / (2 * h)
        assert gradient[k] == pytest.approx(slope, rel=1e-5, abs=1e-4)
        change = (above[1] - below[1]) / (2 * h)
        scale = max(1.0, np.abs(hessian[k]).max())
        np.testing.assert_allclose(hessian[k], change, atol=1e-5 * scale)
        rows = (above[3] - below[3]) / (2 * h)
        scale = max(1.0, np.abs(jacobian[:, k]).max())
        np.testing.assert_allclose(jacobian[:, k], rows, atol=1e-5 * scale)


def test_a_section_in_reverse_is_the_mirror_image_of_its_way_back() -> None:
    """Driven the other way, the same curves with nodes swapped cost the same."""
    weights = Weights(goal=0.0, price=0.0, bend_price=0.0)
    x = unknowns(7)
    last = controls(x)[1]
    layout = Layout(1, LAYOUT.segments, 1)
    program = ManoeuvreProgram(layout)
    costs = []
    for control, direction in ((last, -1.0), (last[::-1], 1.0)):
        ends = [control[1] - control[0], control[-1] - control[-2]]
        headings = [math.atan2(*(direction * leg)[::-1]) for leg in ends]
        own = [*np.linalg.norm(ends, axis=1), *control[2:-2].ravel()]
        point = np.concatenate([control[-1], [headings[1]], own, [0.0, 0.0]])
        p = np.concatenate(
            [
                control[0],
                [headings[0]],
                control[-1],
                [headings[1], 0.05, direction],
                weights.values,
                unused_row(program.spline),
            ]
        )
        costs.append(program.evaluate(point, p)[0])
    assert costs[0] == pytest.approx(costs[1], rel=1e-9)
