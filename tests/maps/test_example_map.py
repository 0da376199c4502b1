"""The flat shipped as an example is what its script draws, and a chair gets through its door."""

from __future__ import annotations

import importlib.util
import math
from pathlib import Path

import numpy as np
import pytest
import shapely

from narrows.clearance import certify
from narrows.maps import load_map
from narrows.path import Path as Motion
from narrows.scene import load_scene
from narrows.twist_section import TwistSection

EXAMPLES = Path(__file__).resolve().parents[2] / "examples"


@pytest.fixture(scope="module")
def script():
    spec = importlib.util.spec_from_file_location("draw_flat", EXAMPLES / "maps" / "draw_flat.py")
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


@pytest.mark.parametrize("name", ["flat.pgm", "flat.yaml"])
def test_the_shipped_map_is_what_its_script_draws(script, tmp_path, name):
    script.write(tmp_path)
    assert (tmp_path / name).read_bytes() == (EXAMPLES / "maps" / name).read_bytes()


def test_rooms_and_doors_are_free_to_the_millimetre(script):
    solids = shapely.union_all([s.shape for s in load_map(EXAMPLES / "maps" / "flat.yaml").solids])
    furniture = shapely.union_all([shapely.box(*box) for box in script.FURNITURE.values()])
    rooms = shapely.union_all([shapely.box(*box) for box in script.ROOMS.values()])
    free = shapely.box(-0.5, -0.5, 8.5, 5.5).difference(solids)
    assert free.symmetric_difference(rooms.difference(furniture)).area < 1e-9


def test_an_arc_of_0_4_m_takes_the_chair_through_the_bathroom_door():
    scene = load_scene(EXAMPLES / "scenes" / "flat.yaml")
    goal_x, goal_y, _ = scene.goal.pose
    radius, y, x = 0.4, 0.45, goal_x + 0.04  # found by trial: where the turn has most room
    rows = [
        [scene.start[0], y, math.pi],
        [x + radius, y, math.pi],
        [x, y + radius, math.pi / 2],
        [x, goal_y, math.pi / 2],
    ]
    certificate = certify(scene.world, scene.vehicle, Motion((TwistSection(np.array(rows)),)))
    assert certificate.clearance > scene.margin
    assert x - goal_x < scene.goal.position_tolerance
