"""Vector maps: polygons become solids, doors become doors."""

from __future__ import annotations

import json
import math

import pytest
import shapely

from narrows.maps import load_map

SQUARE = [[0.0, 0.0], [4.0, 0.0], [4.0, 4.0], [0.0, 4.0]]
HOLE = [[1.0, 1.0], [2.0, 1.0], [2.0, 2.0], [1.0, 2.0]]
DOOR = {"centre": [1.0, 2.0], "width": 0.9, "normal_rad": 3.5 * math.pi, "kind": "door"}


def write_map(folder, **fields):
    file = folder / "map.json"
    file.write_text(json.dumps({"format": "wall-map/1", "walls": [[SQUARE, HOLE]]} | fields))
    return file


def test_polygons_keep_their_holes(tmp_path):
    (wall,) = load_map(write_map(tmp_path)).solids
    assert wall.name == "wall 0"
    assert wall.shape.area == 15.0
    assert not wall.shape.contains(shapely.Point(1.5, 1.5))
    assert sum(shapely.area(shapely.polygons([piece])).sum() for piece in wall.pieces) == (
        pytest.approx(15.0)
    )


def test_every_class_is_an_obstacle_and_keeps_its_name(tmp_path):
    file = write_map(tmp_path, unknown=[[SQUARE]], furniture=[[HOLE], [SQUARE]], stairs=[[HOLE]])
    names = [solid.name for solid in load_map(file).solids]
    assert names == ["wall 0", "unknown 0", "furniture 0", "furniture 1", "stairs 0"]
    assert [s.name for s in load_map(file, unknown="free").solids if "unknown" in s.name] == []


def test_doors_keep_their_order_and_head_along_their_normal(tmp_path):
    world = load_map(write_map(tmp_path, doors=[DOOR, DOOR | {"width": 1.0}]))
    assert [door.width for door in world.doors] == [0.9, 1.0]
    assert world.doors[0].center == (1.0, 2.0)
    assert world.doors[0].heading == pytest.approx(-math.pi / 2)


def test_bounds_are_those_of_the_file_or_none(tmp_path):
    assert load_map(write_map(tmp_path)).bounds is None
    assert load_map(write_map(tmp_path, bounds=[-1, -2, 5, 6])).bounds == (-1.0, -2.0, 5.0, 6.0)
