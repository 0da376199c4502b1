"""Things of a document: moved, sized and turned, nothing else of them changed."""

import math

import numpy as np
import pytest

from narrows.viewer.thing_entries import (
    NEW,
    extent,
    middle,
    moved_entry,
    sized_entry,
    turned_entry,
)

SHELF = {
    "polygon": [[1.0, 2.0], [1.8, 2.0], [1.8, 2.4], [1.0, 2.4]],
    "z": [1.1, 1.4],
    "name": "shelf",
}


def test_moving_a_polygon_moves_its_holes():
    entry = {"polygon": [[0, 0], [2, 0], [2, 2]], "holes": [[[1, 0.2], [1.2, 0.2], [1.2, 0.4]]]}
    moved = moved_entry(entry, (1.0, -1.0))
    assert moved["polygon"][0] == [1.0, -1.0]
    assert moved["holes"][0][0] == [2.0, -0.8]
    assert entry["polygon"][0] == [0, 0]


def test_moving_somebody_moves_their_way_and_keeps_its_times():
    somebody = {"circle": [0, 0, 0.25], "path": [[0, 1.6, 1.65], [1.5, 2.7, 0.6]]}
    moved = moved_entry(somebody, (0.1, -0.2))
    assert moved["path"] == [[0, 1.7, 1.45], [1.5, 2.8, 0.4]]
    assert moved["circle"] == somebody["circle"]


def test_a_thing_that_is_sized_keeps_its_middle_and_its_heights():
    sized = sized_entry(SHELF, (0.4, 1.0))
    assert extent(sized) == pytest.approx((0.4, 1.0))
    assert middle(sized) == pytest.approx(middle(SHELF))
    assert sized["z"] == SHELF["z"]
    assert sized_entry(NEW["stool"], (0.4, 0.7))["circle"] == [0.0, 0.0, 0.35]
    assert sized_entry(NEW["stool"], (0.3, 0.4))["circle"] == [0.0, 0.0, 0.15]


def test_a_turn_to_the_left_is_counter_clockwise_about_the_middle():
    turned = turned_entry(SHELF, math.pi / 2)
    np.testing.assert_allclose(turned["polygon"][0], [1.6, 1.8], atol=1e-4)  # rounded to 0.1 mm
    assert middle(turned) == pytest.approx(middle(SHELF), abs=1e-4)
    assert turned_entry({**NEW["stool"]}, 1.0) == NEW["stool"]
