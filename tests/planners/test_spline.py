"""Splines: a partition of unity, smooth, clamped, and the same curve as their Bezier pieces."""

import numpy as np
import pytest
from scipy.interpolate import BSpline

from narrows import bezier
from narrows.bezier_section import BezierSection
from narrows.errors import ShapeError
from narrows.planners.spline import Spline

SEGMENTS = pytest.mark.parametrize("segments", [1, 2, 5, 6, 10])
FINE = np.linspace(0.0, 1.0, 241)


def control(spline: Spline, seed: int = 0) -> np.ndarray:
    """Control points that wander to the right."""
    rng = np.random.default_rng(seed)
    steps = np.column_stack([rng.uniform(0.2, 0.5, spline.count), rng.normal(0, 0.2, spline.count)])
    return np.cumsum(steps, axis=0)


@SEGMENTS
def test_the_weights_sum_to_one_and_none_is_negative(segments: int) -> None:
    weights = Spline(segments).basis(FINE)
    np.testing.assert_allclose(weights.sum(axis=1), 1.0, atol=1e-14)
    assert weights.min() >= -1e-15
    # each place is told by four neighbours: what moves elsewhere does not move it
    assert ((weights > 1e-15).sum(axis=1) <= 4).all()


@SEGMENTS
@pytest.mark.parametrize("order", [1, 2, 3])
def test_the_weights_of_derivatives_sum_to_nothing(segments: int, order: int) -> None:
    weights = Spline(segments).basis(FINE, order)
    np.testing.assert_allclose(weights.sum(axis=1), 0.0, atol=1e-12 * segments**order)


@SEGMENTS
@pytest.mark.parametrize("order", [0, 1, 2, 3])
def test_it_is_scipys_spline_on_the_same_knots(segments: int, order: int) -> None:
    spline = Spline(segments)
    points = control(spline)
    inside = FINE[~np.isin(np.round(FINE * segments, 9) % 1.0, [0.0])]
    expected = BSpline(spline.knots, points, 3).derivative(order)(inside)
    np.testing.assert_allclose(
        spline.basis(inside, order) @ points, expected, rtol=1e-9, atol=1e-9 * segments**order
    )


@SEGMENTS
@pytest.mark.parametrize("order", [1, 2, 3])
def test_derivatives_agree_with_central_differences(segments: int, order: int) -> None:
    spline, h = Spline(segments), 1e-5
    t = np.linspace(0.013, 0.987, 47)
    t = t[np.abs((t * segments + 0.5) % 1.0 - 0.5) > 1e-3]  # the third derivative jumps at knots
    differences = (spline.basis(t + h, order - 1) - spline.basis(t - h, order - 1)) / (2 * h)
    scale = segments**order
    np.testing.assert_allclose(spline.basis(t, order), differences, atol=2e-5 * scale)


@SEGMENTS
def test_position_slope_and_bend_are_continuous_at_the_knots(segments: int) -> None:
    spline = Spline(segments)
    knots = np.linspace(0.0, 1.0, segments + 1)[1:-1]
    for order in (0, 1, 2):
        before, after = (spline.basis(knots + e, order) for e in (-1e-12, 1e-12))
        np.testing.assert_allclose(before, after, atol=1e-9 * segments ** (order + 1))


@SEGMENTS
def test_the_ends_are_clamped_along_the_end_legs(segments: int) -> None:
    spline = Spline(segments)
    points = control(spline)
    ends, slope = spline.basis([0.0, 1.0]) @ points, spline.basis([0.0, 1.0], 1) @ points
    np.testing.assert_allclose(ends, points[[0, -1]], atol=1e-14)
    # three times the leg in each segment's own parameter
    np.testing.assert_allclose(slope[0], 3 * segments * (points[1] - points[0]), rtol=1e-12)
    np.testing.assert_allclose(slope[1], 3 * segments * (points[-1] - points[-2]), rtol=1e-12)


@SEGMENTS
def test_the_bezier_pieces_are_the_same_curve(segments: int) -> None:
    spline = Spline(segments)
    points = control(spline)
    pieces = spline.to_bezier(points)
    assert pieces.shape == (segments, 4, 2)
    u = np.linspace(0.0, 1.0, 23)
    for k, piece in enumerate(pieces):
        t = (k + u) / segments
        for order in (0, 1, 2):
            here = bezier.evaluate(piece, u, order) * segments**order
            there = spline.basis(np.clip(t, k / segments, (k + 1) / segments), order) @ points
            # the last row belongs to the next piece, whose second derivative is equal there
            np.testing.assert_allclose(here, there, atol=1e-10 * segments**order)


@SEGMENTS
def test_the_curvature_of_the_pieces_is_continuous(segments: int) -> None:
    spline = Spline(segments)
    section = BezierSection(spline.to_bezier(control(spline)))
    joints = section.progress_at(np.arange(segments - 1), np.ones(segments - 1))
    before, after = (section.evaluate(joints + e, 1)[:, 2] for e in (-1e-7, 1e-7))
    np.testing.assert_allclose(before, after, atol=1e-4)


@pytest.mark.parametrize("segments", [0, -1])
def test_a_spline_has_a_segment(segments: int) -> None:
    with pytest.raises(ShapeError, match=f"at least one segment, got {segments}"):
        Spline(segments)


@pytest.mark.parametrize("order", [-1, 4])
def test_a_cubic_has_three_derivatives(order: int) -> None:
    with pytest.raises(ShapeError, match=f"order must be 0 to 3, got {order}"):
        Spline(2).basis([0.5], order)
