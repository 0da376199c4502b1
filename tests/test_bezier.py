"""Bezier algebra: closed forms, derivatives by differences, hulls that hold the curve."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from narrows import bezier
from narrows.errors import ShapeError

COORDINATES = st.floats(-5, 5, allow_subnormal=False)
CONTROLS = st.lists(st.tuples(COORDINATES, COORDINATES), min_size=4, max_size=4).map(np.array)
UNITS = st.floats(0, 1)

# a quarter of the unit circle, to 2.7e-4
K = 4.0 / 3.0 * (math.sqrt(2.0) - 1.0)
QUARTER = np.array([[1.0, 0.0], [1.0, K], [K, 1.0], [0.0, 1.0]])


def test_a_cubic_polynomial_is_evaluated_exactly() -> None:
    # x = u^3, y = (1 - u)^3: control points by the blossom
    control = np.array([[0, 1], [0, 0], [0, 0], [1, 0]], dtype=float)
    u = np.linspace(0, 1, 11)
    np.testing.assert_allclose(bezier.evaluate(control, u), np.c_[u**3, (1 - u) ** 3], atol=1e-15)
    np.testing.assert_allclose(
        bezier.evaluate(control, u, 1), np.c_[3 * u**2, -3 * (1 - u) ** 2], atol=1e-15
    )
    np.testing.assert_allclose(bezier.evaluate(control, u, 2), np.c_[6 * u, 6 * (1 - u)])
    np.testing.assert_allclose(bezier.evaluate(control, u, 3), np.tile([6.0, -6.0], (11, 1)))
    np.testing.assert_array_equal(bezier.evaluate(control, u, 4), 0.0)


@given(control=CONTROLS)
@settings(deadline=None, max_examples=50)
@pytest.mark.parametrize("order", [1, 2])
def test_derivatives_agree_with_central_differences(order: int, control: np.ndarray) -> None:
    u, h = np.linspace(0.1, 0.9, 9), 1e-4
    above, below = (bezier.evaluate(control, u + e, order - 1) for e in (h, -h))
    # error h^2 / 6 times the third derivative, at most 6 * 80 here
    np.testing.assert_allclose(
        bezier.evaluate(control, u, order), (above - below) / (2 * h), atol=1e-6
    )


@given(control=CONTROLS, start=UNITS, end=UNITS, inner=UNITS)
@settings(deadline=None)
def test_a_segment_is_the_curve_between_its_parameters(
    control: np.ndarray, start: float, end: float, inner: float
) -> None:
    part = bezier.segment(control[None], [start], [end])[0]
    at = bezier.evaluate(control, start + inner * (end - start))
    np.testing.assert_allclose(bezier.evaluate(part, inner), at, atol=1e-12)


@given(control=CONTROLS, cut=UNITS, inner=UNITS)
@settings(deadline=None)
def test_split_agrees_with_segment(control: np.ndarray, cut: float, inner: float) -> None:
    left, right = bezier.split(control, cut)
    np.testing.assert_allclose(left, bezier.segment(control[None], [0.0], [cut])[0], atol=1e-12)
    np.testing.assert_allclose(right, bezier.segment(control[None], [cut], [1.0])[0], atol=1e-12)


@given(control=CONTROLS)
@settings(deadline=None)
def test_the_hull_holds_the_curve(control: np.ndarray) -> None:
    low, high = bezier.hull_bounds(control)
    points = bezier.evaluate(control, np.linspace(0, 1, 101))
    assert (points >= low - 1e-12).all()
    assert (points <= high + 1e-12).all()


def test_a_quarter_circle_has_curvature_one_to_the_left() -> None:
    u = np.linspace(0, 1, 51)
    np.testing.assert_allclose(bezier.curvature(QUARTER, u), 1.0, atol=0.025)
    np.testing.assert_allclose(bezier.curvature(QUARTER[::-1], u), -1.0, atol=0.025)
    np.testing.assert_allclose(bezier.curvature(2.0 * QUARTER, u), 0.5, atol=0.0125)
    # at the ends of a cubic: (2/3) cross(leg1, leg2) / |leg1|^3
    assert bezier.curvature(QUARTER, 0.0) == pytest.approx(2 / 3 * K * (1 - K) / K**3)


def test_curvature_rate_agrees_with_differences() -> None:
    control = np.array([[0, 0], [1, 0.2], [1.5, 1], [1.2, 2]])
    u, h = np.linspace(0.05, 0.95, 19), 1e-5
    difference = bezier.curvature(control, u + h) - bezier.curvature(control, u - h)
    np.testing.assert_allclose(bezier.curvature_rate(control, u), difference / (2 * h), atol=1e-6)


@pytest.mark.parametrize(
    ("control", "convex"),
    [
        (QUARTER, True),
        (QUARTER[::-1], True),
        ([[0, 0], [1, 0], [2, 1], [3, 1]], False),  # an S
        ([[0, 0], [1, 0], [2, 0], [3, 0]], True),  # a line
        ([[0, 0], [1, 0], [2, 0], [3, 1]], False),  # one turn only: Z_w1 Z_w2 = 0
    ],
)
def test_complete_convexity_is_turning_one_way(control: np.ndarray, convex: bool) -> None:
    assert bezier.is_completely_convex(control) is convex


def test_a_batch_is_its_curves() -> None:
    batch = np.stack([QUARTER, QUARTER[::-1] + 1.0])
    u = np.array([0.2, 0.7])
    for k in range(2):
        np.testing.assert_allclose(bezier.evaluate(batch, u)[k], bezier.evaluate(batch[k], u[k]))
        np.testing.assert_allclose(bezier.curvature(batch, u)[k], bezier.curvature(batch[k], u[k]))


def test_a_negative_order_is_refused() -> None:
    with pytest.raises(ShapeError, match="0 or more, got -1"):
        bezier.evaluate(QUARTER, 0.5, -1)
