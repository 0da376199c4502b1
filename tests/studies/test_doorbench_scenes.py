"""DoorBench scenes arrive as the same geometry."""

import json
import math
from pathlib import Path

import numpy as np
import pytest

from narrows.clearance import clearance_at
from narrows.errors import StudyError
from narrows.studies.doorbench_scenes import doorbench_scene, read_doorbench

FILE = Path(__file__).parents[3] / "shared" / "doorbench" / "scenes.json"

ROW = {
    "id": "c10_00",
    "level": "c10",
    "vehicle": {"length": 1.0, "width": 0.75, "rear_overhang": 0.25, "max_curvature": 2.5},
    "walls": [[[-1.0, 1.0], [3.0, 1.0], [3.0, 1.1], [-1.0, 1.1]]],
    "obstacles": [[2.0, 0.0, 0.2]],
    "bounds": [-1.0, -2.0, 3.0, 1.1],
    "door": {"width": 0.85, "x": 1.6, "y": [1.0, 1.1]},
    "start": [0.0, 0.0, 0.0],
    "goal": [0.5, 0.1, 0.2],
}


def test_a_scene_keeps_its_numbers():
    scene = doorbench_scene(ROW)
    distance, against = clearance_at(scene.world, scene.vehicle, [scene.start, [0, 0.5, 0]])
    # The front is at 0.75, the post begins at 1.8; the left side is at 0.375, or 0.875.
    assert distance == pytest.approx([0.625, 0.125])
    assert against == ("wall 1", "wall 1")
    assert clearance_at(scene.world, scene.vehicle, [[0.9, 0, 0]])[0] == pytest.approx([0.15])
    assert scene.vehicle.limits.curvature == 2.5
    assert scene.world.bounds == (-1.0, -2.0, 3.0, 1.1)
    assert scene.goal.position_tolerance == 0.05
    assert math.degrees(scene.goal.heading_tolerance) == pytest.approx(3.0)
    assert scene.world.doors[0].center == pytest.approx((1.6, 1.05))
    assert scene.name == "c10_00"


def test_reversing_is_a_choice():
    assert doorbench_scene(ROW).vehicle.limits.reverse_speed == 0.0
    assert doorbench_scene(ROW, reversing=True).vehicle.limits.reverse_speed > 0.0


def test_a_scene_without_a_goal_is_refused_with_its_file(tmp_path):
    file = tmp_path / "scenes.json"
    row = {key: value for key, value in ROW.items() if key != "goal"}
    file.write_text(json.dumps({"scenes": [row]}))
    with pytest.raises(StudyError, match=r"scenes\.json: a DoorBench scene is incomplete.*goal"):
        read_doorbench(file)


def test_another_file_is_refused(tmp_path):
    file = tmp_path / "other.json"
    file.write_text("[1, 2]")
    with pytest.raises(StudyError, match="not a DoorBench file"):
        read_doorbench(file)


@pytest.mark.skipif(not FILE.exists(), reason="the DoorBench scenes are not on this machine")
def test_no_scene_begins_or_ends_in_contact():
    scenes = read_doorbench(FILE)
    assert len(scenes) == 60
    for entry in scenes:
        ends = np.stack([entry.scene.start, entry.scene.goal.pose])
        assert clearance_at(entry.scene.world, entry.scene.vehicle, ends)[0].min() > 0.0
        assert entry.name.startswith(entry.level)
