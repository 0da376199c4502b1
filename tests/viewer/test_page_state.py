"""What is typed on the page goes through the reader of scene files."""

from pathlib import Path

import numpy as np
import pytest

from narrows.errors import SceneError
from narrows.scene import load_scene, read_scene
from narrows.viewer.page_places import pose_changes
from narrows.viewer.page_state import load_state
from narrows.viewer.thing_entries import moved_entry

SCENES = sorted(Path("examples/scenes").glob("*.yaml"))
DOOR = Path("examples/scenes/door.yaml")


@pytest.mark.parametrize("file", SCENES, ids=lambda file: file.stem)
def test_a_saved_scene_is_the_scene_that_was_read(file, tmp_path):
    state = load_state(file)
    again = read_scene(state.yaml(tmp_path), tmp_path / "again.yaml")
    first = load_scene(file)
    assert again.vehicle.limits == first.vehicle.limits
    np.testing.assert_array_equal(again.vehicle.outline, first.vehicle.outline)
    np.testing.assert_array_equal(again.start, first.start)
    np.testing.assert_array_equal(again.goal.pose, first.goal.pose)
    assert [s.z for s in again.world.solids] == [s.z for s in first.world.solids]
    assert all(
        a.shape.equals_exact(b.shape, 0.0)
        for a, b in zip(again.world.solids, first.world.solids, strict=True)
    )


def test_a_width_that_is_typed_is_the_width_of_the_scene():
    state = load_state(DOOR)
    vehicle = state.vehicle
    vehicle["body"]["width"] = 0.7
    changed = state.edited({("vehicle",): vehicle})
    assert not changed.problem
    assert changed.scene.vehicle.width == pytest.approx(0.7)
    assert state.scene.vehicle.width == pytest.approx(0.67)  # states are never changed


def test_the_short_form_stays_one():
    changed = load_state(DOOR).edited({("doorway", "door_width"): 0.8})
    assert changed.scene.world.doors[0].width == 0.8
    assert "door_width: 0.8" in changed.yaml(Path("."))


def test_a_start_in_a_wall_is_answered_with_its_field_and_the_last_scene_kept():
    state = load_state(DOOR)
    pose = {"x": -0.6, "y": 0.2, "heading_deg": 0.0}
    wrong = state.edited(pose_changes("start", pose))
    assert wrong.field == "start"
    assert "the chair at the start overlaps 'corridor wall' by 135 mm" in wrong.problem
    assert "door.yaml" not in wrong.problem  # one sees the field, not a file
    assert wrong.scene is state.scene
    assert wrong.pose("start")["y"] == 0.2  # what was typed stays
    with pytest.raises(SceneError):
        wrong.yaml(Path("."))


@pytest.mark.parametrize("value", [float("nan"), float("inf"), -1.0, 1e9, "x" * 10_000, None, []])
def test_senseless_values_are_complaints(value):
    changed = load_state(DOOR).edited({("vehicle",): {"body": {"length": value, "width": 1.0}}})
    assert changed.problem
    assert changed.field.startswith("vehicle")


def test_a_map_is_named_relative_to_where_the_scene_is_saved(tmp_path):
    state = load_state("examples/scenes/flat.yaml")
    assert "flat.yaml" in state.yaml(tmp_path)
    assert read_scene(state.yaml(tmp_path), tmp_path / "x.yaml").world.solids


def test_things_are_put_in_moved_and_taken_away():
    state = load_state(DOOR)
    stool = {"circle": [0.0, 0.0, 0.2], "z": [0.0, 0.5], "name": "stool"}
    there = state.edited({("world",): {"solids": [moved_entry(stool, (2.5, 3.0))]}})
    assert there.first_thing == len(state.scene.world.solids)
    assert there.scene.world.solids[-1].shape.coords[0] == (2.5, 3.0)
    moved = there.edited({("world", "solids", 0): moved_entry(there.listed_solids[0], (0.5, 0))})
    assert moved.scene.world.solids[-1].shape.coords[0] == (3.0, 3.0)
    gone = moved.edited({("world", "solids", 0): None})
    assert len(gone.scene.world.solids) == len(state.scene.world.solids)


def test_without_a_file_there_is_a_door():
    assert load_state(None).scene.world.doors[0].width == pytest.approx(0.9)


def test_a_file_that_is_not_there_is_said_to_be():
    with pytest.raises(SceneError, match="the file cannot be read"):
        load_state("nowhere.yaml")
