"""Cores lie inside the turning body, sweeps around it, and both tighten with the interval."""

import math

import numpy as np
import pytest
import shapely
from hypothesis import given, settings
from hypothesis import strategies as st

from narrows.planners.heading_slices import ObstaclePieces, minkowski_sums
from narrows.planners.swept_body import TurningBody, convex_hull, cut_by_half_planes

RECTANGLE = np.array([[-0.25, -0.335], [0.75, -0.335], [0.75, 0.335], [-0.25, 0.335]])
KITE = np.array([[-0.3, 0.0], [0.1, -0.4], [0.9, 0.1], [0.2, 0.35]])
ROUNDING = 1e-12  # m


def _turned(points: np.ndarray, angle: float) -> np.ndarray:
    c, s = math.cos(angle), math.sin(angle)
    return points @ np.array([[c, s], [-s, c]])


@given(
    polygon=st.sampled_from([RECTANGLE, KITE]),
    half=st.floats(1e-4, math.pi / 4),
    pivot=st.tuples(st.floats(-0.5, 1.2), st.floats(-0.5, 0.5)),
)
@settings(deadline=None, max_examples=60, derandomize=True)
def test_the_core_is_inside_and_the_sweep_around_the_body_at_every_heading(
    polygon: np.ndarray, half: float, pivot: tuple[float, float]
) -> None:
    body = TurningBody.about(np.array(pivot), polygon)
    core, sweep = body.core(half), body.sweep(half)
    for angle in np.linspace(-half, half, 21):
        shape = shapely.Polygon(_turned(polygon - pivot, angle))
        if core is not None:
            assert shape.buffer(1e-9).covers(shapely.Polygon(core))
        assert shapely.Polygon(sweep).buffer(1e-9).covers(shape)


def test_core_and_sweep_of_no_turn_are_the_body() -> None:
    body = TurningBody.about(np.zeros(2), RECTANGLE)
    for shape in (body.core(0.0), body.sweep(0.0)):
        gap = shapely.Polygon(shape).symmetric_difference(shapely.Polygon(RECTANGLE)).area
        assert gap < ROUNDING


def test_the_core_misses_no_more_than_the_arcs_sagitta_of_the_exact_intersection() -> None:
    half = math.radians(5.0)
    body = TurningBody.about(np.array([0.25, 0.0]), RECTANGLE)
    exact = shapely.intersection_all(
        [shapely.Polygon(_turned(body.corners, a)) for a in np.linspace(-half, half, 401)]
    )
    core = shapely.Polygon(body.core(half))
    sagitta = 0.5 * (1.0 - math.cos(half))  # the furthest edge is 0.5 m from the pivot
    assert core.hausdorff_distance(exact) < 1.5 * sagitta


def test_a_core_of_half_the_interval_contains_the_core_of_the_whole() -> None:
    half = math.radians(6.0)
    body = TurningBody.about(np.array([0.1, 0.0]), KITE)
    whole = shapely.Polygon(body.core(half))
    part = shapely.Polygon(_turned(body.core(half / 2), half / 2))
    assert part.buffer(1e-9).covers(whole)


def test_growth_moves_each_edge_of_a_rectangle_outward_by_itself() -> None:
    grown = TurningBody.about(np.zeros(2), RECTANGLE).grown(0.05).corners
    assert np.ptp(grown, axis=0) == pytest.approx([1.1, 0.77], abs=ROUNDING)
    shrunk = TurningBody.about(np.zeros(2), RECTANGLE).grown(-0.3).corners
    assert np.ptp(shrunk, axis=0) == pytest.approx([0.4, 0.07], abs=ROUNDING)


def test_shrinking_by_more_than_half_the_width_leaves_nothing() -> None:
    body = TurningBody.about(np.zeros(2), RECTANGLE).grown(-0.34)
    assert body.corners is None
    assert body.sweep(0.1) is None


def test_contradicting_half_planes_leave_nothing() -> None:
    assert cut_by_half_planes(np.array([[1.0, 0.0], [-1.0, 0.0]]), np.array([-1.0, -1.0])) is None


def test_the_hull_agrees_with_shapely() -> None:
    points = np.random.default_rng(3).normal(size=(40, 2))
    ours = shapely.Polygon(convex_hull(points))
    assert ours.symmetric_difference(shapely.MultiPoint(points).convex_hull).area < ROUNDING


@given(seed=st.integers(0, 10_000))
@settings(deadline=None, max_examples=40, derandomize=True)
def test_minkowski_sums_are_the_hulls_of_all_sums_of_corners(seed: int) -> None:
    rng = np.random.default_rng(seed)
    first = np.stack([_ring(rng, 4) for _ in range(2)])
    second = np.stack([_ring(rng, 6), _ring(rng, 6), np.repeat(rng.normal(size=(1, 2)), 6, axis=0)])
    sums = minkowski_sums(first, second)
    for i, j in np.ndindex(2, 3):
        corners = (first[i][:, None] + second[j][None]).reshape(-1, 2)
        expected = shapely.MultiPoint(corners).convex_hull
        assert shapely.Polygon(sums[i, j]).symmetric_difference(expected).area < 1e-9


def _ring(rng: np.random.Generator, corners: int) -> np.ndarray:
    hull = convex_hull(rng.normal(size=(corners, 2)))
    return np.concatenate([hull, np.repeat(hull[-1:], corners - len(hull), axis=0)])


def test_minkowski_sums_of_axis_parallel_boxes_are_boxes() -> None:
    box = np.array([[[0.0, 0], [2, 0], [2, 1], [0, 1]]])
    total = shapely.Polygon(minkowski_sums(box, box)[0, 0])
    assert total.equals(shapely.box(0, 0, 4, 2))


def test_circles_are_bracketed_within_their_tolerance() -> None:
    centre = np.tile([[[1.0, 2.0]]], (1, 1, 1))
    pieces = ObstaclePieces.bracket(centre, np.array([0.15]))
    circle = shapely.Point(1.0, 2.0).buffer(0.15, quad_segs=500)
    inside, around = (shapely.Polygon(p[0]) for p in (pieces.inside, pieces.around))
    reach = np.linalg.norm(pieces.inside[0] - [1.0, 2.0], axis=1)
    assert reach == pytest.approx(0.15, abs=ROUNDING)
    assert around.covers(circle)
    assert inside.hausdorff_distance(circle) < 2.5e-4
    assert around.hausdorff_distance(circle) < 2.5e-4
