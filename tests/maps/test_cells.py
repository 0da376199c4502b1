"""Outlines and tilings of sets of grid cells are exact."""

from __future__ import annotations

import numpy as np
import pytest
import shapely
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra import numpy as arrays

from narrows.maps.cells import raggedness, regions

# Dense, even and sparse sets: holes, regions in holes, and corners that touch all turn up.
masks = st.integers(0, 3).flatmap(
    lambda parts: arrays.arrays(
        bool,
        arrays.array_shapes(min_dims=2, max_dims=2, max_side=9),
        elements=st.integers(0, 3).map(lambda value: value <= parts),
    )
)


def covered_by_rectangles(rectangles, shape):
    """Return how many rectangles cover each cell."""
    count = np.zeros(shape, dtype=int)
    for x_low, y_low, x_high, y_high in rectangles:
        count[y_low:y_high, x_low:x_high] += 1
    return count


@settings(deadline=None, max_examples=200, derandomize=True)
@given(masks)
def test_rectangles_cover_each_cell_of_the_set_once_and_no_other(cells):
    found = regions(cells)
    assert (covered_by_rectangles(found.rectangles, cells.shape) == cells).all()
    assert (found.rectangles[:, 0] < found.rectangles[:, 2]).all()
    assert (found.rectangles[:, 1] < found.rectangles[:, 3]).all()


@settings(deadline=None, max_examples=200, derandomize=True)
@given(masks)
def test_outlines_hold_exactly_the_cells_of_the_set(cells):
    found = regions(cells)
    assert sum(outline.area for outline in found.outlines) == cells.sum()  # whole numbers: exact
    rows, columns = np.indices(cells.shape)
    centers = shapely.points(columns + 0.5, rows + 0.5)
    inside = np.zeros(cells.shape, dtype=bool)
    for outline in found.outlines:
        assert outline.is_valid
        inside |= shapely.contains(outline, centers)
    assert (inside == cells).all()


@settings(deadline=None, max_examples=200, derandomize=True)
@given(masks)
def test_each_outline_is_the_union_of_its_own_rectangles(cells):
    found = regions(cells)
    assert (np.diff(found.owner) >= 0).all()
    for index, outline in enumerate(found.outlines):
        own = found.rectangles[found.owner == index]
        union = shapely.union_all(shapely.box(*own.T.astype(float)))
        assert outline.symmetric_difference(union).area == 0.0


@settings(deadline=None, max_examples=200, derandomize=True)
@given(masks)
def test_outlines_turn_at_every_corner(cells):
    for outline in regions(cells).outlines:
        for ring in (outline.exterior, *outline.interiors):
            steps = np.diff(np.asarray(ring.coords), axis=0)
            turns = steps[:, 0] * np.roll(steps[:, 1], -1) - steps[:, 1] * np.roll(steps[:, 0], -1)
            assert (turns != 0.0).all()


def test_cells_that_touch_at_a_corner_are_apart():
    assert len(regions(np.eye(3, dtype=bool)).outlines) == 3


def test_a_ring_closed_by_a_corner_keeps_its_hole():
    ring = np.array([[1, 1, 1], [1, 0, 1], [1, 1, 0]], dtype=bool)  # the hole touches the outside
    (outline,) = regions(ring).outlines
    assert outline.area == 7.0
    assert len(outline.interiors) == 1


def test_a_region_within_the_hole_of_another_is_a_region_of_its_own():
    cells = np.ones((5, 5), dtype=bool)
    cells[1:4, 1:4] = False
    cells[2, 2] = True
    assert sorted(outline.area for outline in regions(cells).outlines) == [1.0, 16.0]


@pytest.mark.parametrize("value", [False, True])
def test_a_blank_set_is_no_region_or_one_rectangle(value):
    found = regions(np.full((3, 4), value))
    assert len(found.outlines) == len(found.rectangles) == int(value)


def test_long_walls_take_one_rectangle_whichever_way_they_run():
    cells = np.zeros((50, 50), dtype=bool)
    cells[:, 3] = True
    cells[10, 10:40] = True
    assert len(regions(cells).rectangles) == 2


def test_raggedness_counts_the_changes_along_the_rows():
    assert raggedness(np.array([[True, False, True, True], [False, False, False, False]])) == 2
