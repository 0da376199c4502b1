"""Signed distances and convex decomposition against Shapely, second methods and invariants."""

import math

import numpy as np
import pytest
import shapely
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from narrows.errors import ShapeError
from narrows.geometry import convex_pieces, convex_polygon, edge_normals, separation
from narrows.se2 import transform

ROUNDING = 1e-12  # polygons of metres: a few units in the last place
SEEDS = st.integers(0, 2**32 - 1)


def hull(rng: np.random.Generator, count: int, center: tuple[float, float] = (0.0, 0.0)):
    """Return a random convex polygon, counter-clockwise."""
    cloud = rng.normal(size=(count, 2)) * rng.uniform(0.2, 1.5, 2) + center
    ring = shapely.MultiPoint(cloud).convex_hull.exterior.coords
    return convex_polygon(np.asarray(ring)[:-1])


def pad(polygon, corners: int):
    """Return the polygon with its last corner repeated, as a block of one."""
    extra = np.repeat(polygon[-1:], corners - len(polygon), axis=0)
    return np.concatenate([polygon, extra])[None]


def pairs(seed: int, spread: float, count: int = 40):
    """Return `count` pairs of random convex polygons, padded to 8 corners."""
    rng = np.random.default_rng(seed)
    first = [pad(hull(rng, rng.integers(3, 8)), 8) for _ in range(count)]
    second = [
        pad(hull(rng, rng.integers(3, 8), tuple(rng.normal(size=2) * spread)), 8)
        for _ in range(count)
    ]
    return np.concatenate(first), np.concatenate(second)


def difference_depth(first, second) -> float:
    """Return the depth of an overlap: the origin's distance to the Minkowski difference's edge."""
    points = (first[:, None] - second[None]).reshape(-1, 2)
    difference = shapely.MultiPoint(points).convex_hull
    origin = shapely.Point(0.0, 0.0)
    return difference.exterior.distance(origin) if difference.contains(origin) else 0.0


@given(SEEDS, st.floats(0.0, 4.0))
@settings(deadline=None, max_examples=40, derandomize=True)
def test_separation_is_shapelys_distance_apart_and_the_least_translation_in_overlap(seed, spread):
    first, second = pairs(seed, spread)
    distance = separation(first, second).distance
    expected = shapely.distance(shapely.polygons(first), shapely.polygons(second))
    depth = np.array([difference_depth(a, b) for a, b in zip(first, second, strict=True)])
    np.testing.assert_allclose(distance, expected - depth, atol=1e-9)


@given(SEEDS, st.floats(0.0, 4.0))
@settings(deadline=None, max_examples=40, derandomize=True)
def test_the_gap_along_the_axis_proves_the_distance(seed, spread):
    first, second = pairs(seed, spread)
    result = separation(first, second)
    np.testing.assert_allclose(np.linalg.norm(result.axis, axis=1), 1.0, atol=1e-9)
    reach = np.einsum("nk,nak->na", result.axis, first).max(axis=1)
    begin = np.einsum("nk,nbk->nb", result.axis, second).min(axis=1)
    np.testing.assert_allclose(begin - reach, result.distance, atol=1e-9)


@given(SEEDS, st.floats(0.0, 4.0), st.floats(-math.pi, math.pi))
@settings(deadline=None, max_examples=40, derandomize=True)
def test_separation_is_symmetric_and_unmoved_by_rigid_motions(seed, spread, turn):
    first, second = pairs(seed, spread)
    distance = separation(first, second).distance
    np.testing.assert_allclose(separation(second, first).distance, distance, atol=ROUNDING)
    pose = [3.0, -7.0, turn]
    moved = separation(transform(pose, first), transform(pose, second)).distance
    np.testing.assert_allclose(moved, distance, atol=1e-10)  # moved by metres: more rounding
    mirror = np.array([-1.0, 1.0])
    mirrored = separation(first[:, ::-1] * mirror, second[:, ::-1] * mirror).distance
    np.testing.assert_allclose(mirrored, distance, atol=ROUNDING)


def test_parting_by_the_depth_along_the_axis_ends_in_contact():
    first, second = pairs(5, 0.3)
    result = separation(first, second)
    overlapping = result.distance < 0.0
    assert overlapping.sum() > 20
    apart = second - (result.distance[:, None] * result.axis)[:, None]
    again = separation(first, apart).distance
    np.testing.assert_allclose(again[overlapping], 0.0, atol=ROUNDING)


@pytest.mark.parametrize(
    ("shift", "expected"),
    [
        ((3.0, 0.0), 2.0),
        ((3.0, 4.0), math.hypot(2.0, 3.0)),
        ((1.0, 0.0), 0.0),
        ((1.0, 1.0), 0.0),
        ((0.75, 0.0), -0.25),
        ((0.0, 0.0), -1.0),
    ],
)
def test_two_unit_squares_have_their_known_distance(shift, expected):
    square = np.array([[[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]]])
    distance = separation(square, square + np.array(shift)).distance
    np.testing.assert_allclose(distance, expected, atol=1e-15)


def test_a_point_inside_is_as_deep_as_its_nearest_edge():
    square = np.array([[[0.0, 0.0], [4.0, 0.0], [4.0, 2.0], [0.0, 2.0]]])
    point = np.array([[[1.0, 0.3]]])
    assert separation(square, point).distance == pytest.approx(-0.3, abs=1e-15)
    assert separation(point, square).distance == pytest.approx(-0.3, abs=1e-15)
    assert separation(square, point + np.array([6.0, 0.0])).distance == pytest.approx(
        3.0, abs=1e-15
    )


def test_no_pairs_give_no_distances():
    empty = separation(np.zeros((0, 4, 2)), np.zeros((0, 3, 2)))
    assert empty.distance.shape == (0,)
    assert empty.axis.shape == (0, 2)


def test_normals_point_outward_and_have_unit_length():
    polygon = hull(np.random.default_rng(1), 9)
    normals = edge_normals(polygon)
    middles = 0.5 * (polygon + np.roll(polygon, -1, axis=0))
    np.testing.assert_allclose(np.linalg.norm(normals, axis=1), 1.0, atol=ROUNDING)
    assert not shapely.contains_xy(shapely.Polygon(polygon), *(middles + 1e-6 * normals).T).any()
    assert shapely.contains_xy(shapely.Polygon(polygon), *(middles - 1e-6 * normals).T).all()


def test_convex_polygon_comes_back_counter_clockwise_without_repeats():
    corners = [[0, 0], [0, 1], [0, 1], [1, 1], [1, 0]]
    result = convex_polygon(corners)
    assert result.shape == (4, 2)
    assert shapely.Polygon(result).exterior.is_ccw
    assert shapely.Polygon(result).equals(shapely.Polygon(corners))


@pytest.mark.parametrize(
    ("corners", "message"),
    [
        ([[0, 0], [1, 0]], "at least 3 corners"),
        ([[0, 0], [1, 0], [1, 0]], "at least 3 different"),
        ([[0, 0], [0, 0], [0, 0]], "at least 3 different"),
        ([[0, 0], [1, 1], [2, 2]], "no area"),
        ([[0, 0], [2, 0], [0.2, 0.2], [0, 2]], "not convex"),
        ([[0, 0], [1, 0], [0, 1], [1, 1]], "no area"),
        ([[0, 0], [1, 0], [1, math.nan]], "finite"),
        ([[0, 0, 0], [1, 0, 0], [1, 1, 0]], "shape"),
    ],
)
def test_what_is_no_convex_polygon_is_refused_with_the_reason(corners, message):
    with pytest.raises(ShapeError, match=message):
        convex_polygon(corners)


def test_a_star_that_turns_one_way_only_is_not_convex():
    angle = np.arange(5) * 4.0 * np.pi / 5.0  # a pentagram: all turns left, twice around
    with pytest.raises(ShapeError, match="not convex"):
        convex_polygon(np.stack([np.cos(angle), np.sin(angle)], axis=1))


def star(rng: np.random.Generator, corners: int) -> np.ndarray:
    """Return a simple star-shaped polygon about the origin, radii 1 to 3."""
    angle = np.sort(rng.uniform(0.0, 2.0 * np.pi, corners)) + np.arange(corners) * 1e-3
    radius = rng.uniform(1.0, 3.0, corners)
    return np.stack([radius * np.cos(angle), radius * np.sin(angle)], axis=1)


def check_decomposition(polygon: shapely.Polygon, tolerance: float) -> None:
    """Check that the pieces are convex, do not overlap, and make up the polygon."""
    pieces = [shapely.Polygon(piece) for piece in convex_pieces(polygon)]
    assert all(piece.exterior.is_ccw for piece in pieces)
    assert all(piece.convex_hull.area - piece.area <= tolerance for piece in pieces)
    union = shapely.union_all(pieces)
    assert union.symmetric_difference(polygon).area <= tolerance
    assert abs(sum(piece.area for piece in pieces) - union.area) <= tolerance  # no overlaps


@given(SEEDS, st.integers(4, 30))
@settings(deadline=None, max_examples=80, derandomize=True)
def test_pieces_are_convex_disjoint_and_make_up_the_polygon(seed, corners):
    polygon = shapely.Polygon(star(np.random.default_rng(seed), corners))
    assume(polygon.is_valid)
    check_decomposition(polygon, 1e-9)


@given(SEEDS, st.integers(3, 8))
@settings(deadline=None, max_examples=40, derandomize=True)
def test_holes_stay_free(seed, corners):
    rng = np.random.default_rng(seed)
    hole = 0.2 * star(rng, corners) + rng.uniform(-1.0, 1.0, 2)
    box = shapely.box(-4.0, -3.0, 5.0, 3.0)
    polygon = box.difference(shapely.Polygon(hole).buffer(0))
    check_decomposition(polygon, 1e-9)


def test_a_convex_polygon_is_its_own_piece():
    corners = hull(np.random.default_rng(3), 9)
    (piece,) = convex_pieces(shapely.Polygon(corners))
    assert shapely.Polygon(piece).equals(shapely.Polygon(corners))


@pytest.mark.parametrize("bulge", [1e-15, 1e-12, 1e-9, 1e-6])
@pytest.mark.parametrize("offset", [0.0, 1e5])
def test_nearly_straight_edges_do_not_break_the_decomposition(bulge, offset):
    # Corners a hair off the line of a long edge, as grid maps have after simplification.
    corners = [[0, 0], [0.3, -bulge], [0.5, bulge], [1, 0], [1, 0.2], [0.2, 0.2], [0.2, 1], [0, 1]]
    check_decomposition(shapely.Polygon(np.array(corners) + offset), 1e-9)


@pytest.mark.parametrize("thickness", [1.0, 1e-3, 1e-6])
def test_long_thin_walls_keep_their_area(thickness):
    # An L with legs of a kilometre: its pieces are far thinner than rounding of its squared size.
    corners = [[0, 0], [1e3, 0], [1e3, 1], [thickness, 1], [thickness, 1e3], [0, 1e3]]
    corners[2][1] = corners[3][1] = thickness
    polygon = shapely.Polygon(corners)
    total = sum(shapely.Polygon(piece).area for piece in convex_pieces(polygon))
    assert total == pytest.approx(polygon.area, rel=1e-9)


@pytest.mark.parametrize("notch", [1e-9, 1e-7, 1e-5, 3e-4, 1e-2])
def test_a_small_notch_never_hides_an_overlap(notch):
    # A wall with a V-shaped scratch: taken for convex, its tilted edges would "separate" a body
    # that stands in the wall a few metres away.
    wall = shapely.Polygon(
        [[0, 0], [10, 0], [10, 0.1], [5 + notch, 0.1], [5, 0.1 - notch], [5 - notch, 0.1], [0, 0.1]]
    )
    body = np.array([[[1.0, 0.05], [2.0, 0.05], [2.0, 1.0], [1.0, 1.0]]])
    deepest = min(separation(body, piece[None]).distance[0] for piece in convex_pieces(wall))
    assert deepest == pytest.approx(-0.05, abs=1e-8)


def test_a_corner_a_hair_inside_is_dropped_and_one_further_inside_refused():
    square = [[0, 0], [1, 0], [1, 1], [0.5, 1 - 1e-12], [0, 1]]
    assert len(convex_polygon(square)) == 4
    square[3][1] = 1 - 1e-6
    with pytest.raises(ShapeError, match="not convex"):
        convex_polygon(square)
