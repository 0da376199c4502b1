"""Scenes: what a file means, what is filled in, and what is refused with which words."""

import json
import math
import re
from pathlib import Path

import jsonschema
import numpy as np
import pytest

import narrows.scene
from narrows.errors import InputError, SceneError, ShapeError
from narrows.scene import (
    Goal,
    Scene,
    check_scene,
    load_scene,
    load_vehicle,
    read_scene,
    scene_schema,
    write_scene,
)
from narrows.scene_text import read_source
from narrows.vehicle import Limits

EXAMPLES = sorted((Path(__file__).parent.parent / "examples" / "scenes").glob("*.yaml"))

CHAIR = "vehicle: narrow-arcs\n"
POSES = "start: {x: 0, y: 0, heading_deg: 0}\ngoal: {x: 3, y: 0, heading_deg: 0}\n"

FULL = """\
name: chair through a 0.90 m door
vehicle:
  body: {length: 1.0, width: 0.67, rear_overhang: 0.25}
  height: 1.20
  track: 0.60
  wheel_radius: 0.17
  limits: {speed: 0.7, reverse_speed: 0, acceleration: 0.5, jerk: 1.4, yaw_rate: 1.1,
           yaw_acceleration: 1.9, lateral_acceleration: 0.4, curvature: 2.5}
world:
  bounds: [-2.0, -0.1, 5.0, 4.8]
  solids:
    - {polygon: [[-2, 1.6], [1.15, 1.6], [1.15, 1.7], [-2, 1.7]]}
    - {circle: [2.4, 4.5, 0.15], z: [0.0, 0.7], name: stool}
    - {polygon: [[2, 0], [4, 0], [4, 1], [2, 1]], z: [1.2, 1.3], name: shelf}
    - {polygon: [[3, 2], [5, 2], [5, 4], [3, 4]], holes: [[[3.5, 2.5], [4.5, 2.5], [4, 3.5]]]}
    - {circle: [4.5, 0.5, 0.15]}
  moving:
    - {circle: [1, 0, 0.25], path: [[0, 3, 0.5], [2, 3, 1.5]]}
  doors:
    - {center: [1.6, 1.65], width: 0.90, heading_deg: 90}
start: {x: -0.6, y: 0.8, heading_deg: -10}
goal: {x: 1.6, y: 3.5, heading_deg: 90, position_tolerance: 0.04, heading_tolerance_deg: 2}
margin: 0.03
"""


def test_every_entry_of_a_full_scene_arrives():
    scene = read_scene(FULL)
    assert scene.name == "chair through a 0.90 m door"
    assert scene.margin == 0.03
    assert scene.vehicle.limits == Limits(0.7, 0.0, 0.5, 1.4, 1.1, 1.9, 0.4, 2.5)
    assert (scene.vehicle.track, scene.vehicle.wheel_radius) == (0.60, 0.17)
    assert scene.vehicle.height == 1.20
    assert scene.vehicle.outline.tolist()[0] == [-0.25, -0.335]
    np.testing.assert_allclose(scene.start, [-0.6, 0.8, -math.pi / 18], atol=1e-15)
    np.testing.assert_allclose(scene.goal.pose, [1.6, 3.5, math.pi / 2], atol=1e-15)
    assert scene.goal.position_tolerance == 0.04
    assert scene.goal.heading_tolerance == pytest.approx(math.radians(2.0))
    assert scene.world.bounds == (-2.0, -0.1, 5.0, 4.8)
    (door,) = scene.world.doors
    assert (door.center, door.width, door.heading) == ((1.6, 1.65), 0.90, math.pi / 2)
    (person,) = scene.world.moving
    assert person.path.tolist() == [[0, 4, 0.5], [2, 4, 1.5]]  # the circle's centre is added


def test_solids_without_a_name_get_a_readable_one_and_heights_of_a_wall():
    scene = read_scene(FULL)
    names = [solid.name for solid in scene.world.solids]
    assert names == ["wall 1", "stool", "shelf", "wall 4", "circle 5"]
    assert [scene.world.solids[i].z for i in (0, 1)] == [(0.0, 2.5), (0.0, 0.7)]
    assert scene.world.moving[0].name == "person 1"
    assert scene.world.solids[3].shape.area == pytest.approx(4.0 - 0.5)


def test_what_is_left_out_has_its_default():
    scene = read_scene(
        "vehicle: {body: {length: 1, width: 0.6, rear_overhang: 0.2}}\nworld: {}\n" + POSES
    )
    assert scene.margin == 0.02
    assert scene.goal.position_tolerance == 0.05
    assert scene.goal.heading_tolerance == pytest.approx(math.radians(3.0))
    assert scene.world.bounds is None
    assert scene.vehicle.height == 1.3
    assert scene.vehicle.track == pytest.approx(0.85 * 0.6)
    assert scene.vehicle.limits == Limits()
    assert scene.vehicle.may_turn_on_the_spot


def test_json_is_yaml_too():
    document = {
        "vehicle": "narrow-arcs",
        "world": {"solids": [{"circle": [1.5, 2, 0.1], "name": "Säule"}]},
        "start": {"x": 0, "y": 0, "heading_deg": 0},
        "goal": {"x": 3.0, "y": 0.0, "heading_deg": 1e-3},
    }
    for text in (json.dumps(document), json.dumps(document, indent=2, ensure_ascii=False)):
        assert read_scene(text).world.solids[0].name == "Säule"


def test_a_preset_keeps_what_is_not_changed():
    chair = load_vehicle("narrow-arcs")
    text = "vehicle: {preset: narrow-arcs, body: {rear_overhang: 0}, limits: {speed: 0.3}}\n"
    changed = read_scene(text + "world: {}\n" + POSES).vehicle
    assert changed.rear_overhang == 0.0
    assert changed.front_overhang == 1.0
    assert changed.limits == chair.with_limits(speed=0.3).limits
    assert (changed.track, changed.wheel_radius) == (chair.track, chair.wheel_radius)
    assert changed.name == "narrow-arcs"


def test_a_preset_may_get_another_body_or_layers():
    triangle = "[[0, -0.3], [0.9, 0], [0, 0.3]]"
    for change in (
        f"body: {{polygon: {triangle}}}",
        f"layers: [{{polygon: {triangle}, z: [0, 1]}}]",
    ):
        text = f"vehicle: {{preset: dft, {change}}}\nworld: {{}}\n{POSES}"
        vehicle = read_scene(text).vehicle
        assert vehicle.outline.shape == (3, 2)
        assert vehicle.track == load_vehicle("dft").track


@pytest.mark.parametrize("file", EXAMPLES, ids=lambda file: file.stem)
def test_every_example_loads_and_follows_the_schema(file):
    scene = load_scene(file)
    assert scene.name
    document = read_source(file.read_text(encoding="utf-8"), str(file)).root.value
    jsonschema.Draft202012Validator(scene_schema()).validate(document)


def test_the_shipped_schema_is_the_models():
    shipped = Path(narrows.scene.__file__).with_name("scene.schema.json")
    assert json.loads(shipped.read_text(encoding="utf-8")) == scene_schema()
    jsonschema.Draft202012Validator.check_schema(scene_schema())
    validator = jsonschema.Draft202012Validator(scene_schema())
    document = read_source(FULL, None).root.value
    assert validator.is_valid(document)
    assert not validator.is_valid(document | {"vehicel": "x"})
    assert not validator.is_valid(document | {"margin": -1})
    assert not validator.is_valid(document | {"world": {"solids": [{"name": "nothing"}]}})
    assert not validator.is_valid({key: document[key] for key in document if key != "world"})


# One line each: the text, the line, the field, and words of the message.
MISTAKES = [
    (CHAIR + "world: {}\nstrat: 1\n" + POSES, 3, "strat", "nearest known one is 'start'"),
    (CHAIR + "world: {solids: [{polygn: 1}]}\n" + POSES, 2, "world.solids[0].polygn", "'polygon'"),
    (CHAIR + "world: {}\nstart: {x: 0, y: 0, heading: 0}\n", 3, "start.heading", "'heading_deg'"),
    ("world: {}\n" + POSES, 1, "vehicle", "is missing"),
    (CHAIR + POSES, 1, None, "allowed: world, doorway, corridor or map"),
    (CHAIR + "world: {}\n", 1, "start", "is missing"),
    ("vehicle: narow-arcs\nworld: {}\n" + POSES, 1, "vehicle", "nearest is 'narrow-arcs'"),
    ("vehicle: 3\nworld: {}\n" + POSES, 1, "vehicle", "must be a mapping; found 3"),
    ("vehicle: {}\nworld: {}\n" + POSES, 1, "vehicle", "a chair needs a body"),
    (
        "vehicle: {body: {length: 1, width: 1}}\nworld: {}\n" + POSES,
        1,
        "vehicle.body.rear_overhang",
        "missing",
    ),
    (
        "vehicle: {body: {length: 1, width: 1, rear_overhang: 1.5}}\nworld: {}\n" + POSES,
        1,
        "vehicle.body.rear_overhang",
        "found 1.5; allowed: 0 to the length, 1 m",
    ),
    (
        "vehicle: {body: {polygon: [[0, 0], [2, 0], [0.2, 0.2], [0, 2]]}}\nworld: {}\n" + POSES,
        1,
        "vehicle.body.polygon",
        "not convex",
    ),
    (
        "vehicle: {preset: dft, height: 1, layers: [{polygon: [[0,0],[1,0],[0,1]], z: [0, 1]}]}\n",
        1,
        "vehicle",
        "layers stand in place of body and height",
    ),
    (
        "vehicle: {preset: dft, layers: [{polygon: [[0,0],[1,0],[0,1]], z: [-1, 1]}]}\nworld: {}\n"
        + POSES,
        1,
        "vehicle.layers[0].z",
        "below the floor",
    ),
    ("vehicle: {preset: dft, limits: {speed: 0}}\n", 1, "vehicle.limits.speed", "more than 0"),
    (CHAIR + "margin: yes\n", 2, "margin", "must be a number; found 'yes'"),
    (CHAIR + "margin: true\n", 2, "margin", "must be a number; found True"),
    (CHAIR + "margin: '0.02'\n", 2, "margin", "must be a number; found '0.02'"),
    (CHAIR + "margin: .nan\n", 2, "margin", "must be a finite number; found nan"),
    (CHAIR + "margin: .inf\n", 2, "margin", "finite number; found inf"),
    (CHAIR + "margin: -0.1\n", 2, "margin", "is too small; found -0.1"),
    (CHAIR + "margin: 1" + "0" * 5000 + "\n", 2, "margin", "finite"),
    (CHAIR + "start: {x: 1000001, y: 0, heading_deg: 0}\n", 2, "start.x", "at most 1e+06"),
    (CHAIR + "start: {x: 2 m, y: 0, heading_deg: 0}\n", 2, "start.x", "found '2 m'"),
    (CHAIR + "start: [0, 0, 0]\n", 2, "start", "must be a mapping; found [0, 0, 0]"),
    (CHAIR + "goal: {x: 1}\n", 2, "goal.y", "is missing"),
    (CHAIR + "name: 5\n", 2, "name", "must be text; found 5"),
    (CHAIR + 'name: "a\\nb"\n', 2, "name", "one line of printable text"),
    (CHAIR + "world: {bounds: [0, 0, 1]}\n", 2, "world.bounds[3]", "is missing"),
    (CHAIR + "world: {bounds: [1, 0, 0, 1]}\n", 2, "world.bounds", "x_min < x_max"),
    (CHAIR + "world: {solids: {}}\n", 2, "world.solids", "must be a list"),
    (CHAIR + "world: {solids: [{}]}\n", 2, "world.solids[0]", "either polygon or circle"),
    (CHAIR + "world: {solids: [{circle: [1, 2]}]}\n", 2, "world.solids[0].circle[2]", "missing"),
    (
        CHAIR + "world: {solids: [{circle: [1, 2, 0]}]}\n",
        2,
        "world.solids[0].circle[2]",
        "at least 0.001",
    ),
    (
        CHAIR + "world: {solids: [{circle: [1, 2, 3, 4]}]}\n",
        2,
        "world.solids[0].circle",
        "too many entries: 4",
    ),
    (
        CHAIR + "world: {solids: [{polygon: [[0, 0], [1, 1]]}]}\n",
        2,
        "world.solids[0].polygon",
        "at least 3",
    ),
    (
        CHAIR + "world: {solids: [{circle: [1, 2, 3], z: [1, 1]}]}\n",
        2,
        "world.solids[0].z",
        "less than",
    ),
    (
        CHAIR
        + "world:\n  solids:\n  - circle: [9, 9, 1]\n"
        + "  - polygon: [[0, 0], [1, 1], [1, 0], [0, 1]]\n"
        + POSES,
        5,
        "world.solids[1].polygon",
        r"crosses or touches itself at (0.5, 0.5)",
    ),
    (
        CHAIR + "world: {solids: [{polygon: [[0, 0], [1e-4, 0], [0, 1e-4]]}]}\n" + POSES,
        2,
        "world.solids[0].polygon",
        "area of 5e-09 m^2",
    ),
    (
        CHAIR + "world: {moving: [{circle: [0, 0, 1], path: [[1, 9, 9], [1, 8, 8]]}]}\n" + POSES,
        2,
        "world.moving[0].path",
        "times",
    ),
    (CHAIR + "doorway: {corridor_width: 1.6}\n", 2, "doorway.door_width", "is missing"),
    (
        CHAIR + "doorway: {corridor_width: 1.6, door_width: 5}\n",
        2,
        "doorway",
        "wider than the room",
    ),
    (CHAIR + "corridor: {width: 1.3, turn_deg: 2}\n", 2, "corridor", "turns by 5 to 150 degrees"),
    (
        CHAIR + "doorway: {corridor_width: 2, door_width: 1}\ncorridor: {width: 1}\n",
        3,
        "corridor",
        "exclude",
    ),
    (CHAIR + "map: {file: x.yaml, unknown: maybe}\n" + POSES, 2, "map.unknown", "occupied or free"),
    ("- 1\n- 2\n", 1, None, "must be a mapping"),
    ("just words", 1, None, "must be a mapping"),
]


@pytest.mark.parametrize(("text", "line", "field", "words"), MISTAKES)
def test_a_mistake_is_named_with_file_line_field_and_remedy(text, line, field, words):
    with pytest.raises(SceneError) as caught:
        read_scene(text, "my.yaml")
    error = caught.value
    assert (error.file, error.line, error.field) == ("my.yaml", line, field)
    assert words in str(error).splitlines()[0]
    assert str(error).startswith(f"my.yaml:{line}: ")


def test_several_mistakes_come_in_one_message_in_the_order_of_the_lines():
    text = CHAIR + "margin: a\nname: 3\nworld:\n  solids: [1, 2, 3, 4]\n"
    with pytest.raises(SceneError) as caught:
        read_scene(text, "my.yaml")
    lines = str(caught.value).splitlines()
    assert lines[0].startswith("my.yaml:2: margin: ")
    assert lines[1].startswith("also my.yaml:3: name: ")
    assert lines[-1] == "and 2 more"
    assert len(caught.value.others) == 5


def place(pose: str, world: str = "{}") -> str:
    goal = "{x: 50, y: 50, heading_deg: 0}"
    return f"{CHAIR}world: {world}\nstart: {pose}\ngoal: {goal}\n"


def test_a_start_inside_a_wall_says_how_deep_and_in_what():
    wall = "{solids: [{polygon: [[-5, 0.3], [5, 0.3], [5, 1], [-5, 1]], name: long wall}]}"
    with pytest.raises(SceneError, match="at the start overlaps 'long wall' by 35 mm") as caught:
        read_scene(place("{x: 0, y: 0, heading_deg: 0}", wall))
    assert (caught.value.line, caught.value.field) == (3, "start")
    read_scene(place("{x: 0, y: -0.035, heading_deg: 0}", wall))  # contact is no overlap


def test_a_goal_in_a_circle_and_outside_the_bounds_says_both():
    text = place(
        "{x: 0, y: 0, heading_deg: 90}",
        "{solids: [{circle: [50.75, 50, 0.2]}], bounds: [-1, -1, 50.5, 51]}",
    )
    with pytest.raises(SceneError) as caught:
        read_scene(text)
    assert "at the goal overlaps 'circle 1' by 200 mm" in str(caught.value)
    assert "at the goal leaves the bounds by 250 mm" in str(caught.value)


def test_only_what_the_body_meets_in_height_counts():
    table = "{solids: [{circle: [0.5, 0, 1], z: [1.3, 1.4], name: high table}]}"
    read_scene(place("{x: 0, y: 0, heading_deg: 0}", table))
    with pytest.raises(SceneError, match="overlaps 'high table'"):
        read_scene(place("{x: 0, y: 0, heading_deg: 0}", table.replace("1.3,", "1.29,")))


def test_somebody_on_the_start_at_time_zero_is_an_overlap_and_later_is_none():
    person = "{moving: [{circle: [0, 0, 0.25], path: [[T, 0.9, 0], [9, 5, 5]]}]}"
    with pytest.raises(SceneError, match="overlaps 'person 1' by 100 mm at the start"):
        read_scene(place("{x: 0, y: 0, heading_deg: 0}", person.replace("T", "0")))
    passing = person.replace("[T, 0.9, 0]", "[0, 5, 0], [1, 0.9, 0]")
    read_scene(place("{x: 0, y: 0, heading_deg: 0}", passing))


def test_a_scene_made_in_python_is_checked_when_asked():
    good = read_scene(FULL)
    assert check_scene(good) is good
    inside = Scene(good.vehicle, good.world, [0.5, 1.3, 0.0], good.goal)
    with pytest.raises(SceneError, match="start: the chair at the start overlaps 'wall 1'"):
        check_scene(inside)


@pytest.mark.parametrize(
    "make",
    [
        lambda: Goal([0.0, 0.0]),
        lambda: Goal([0.0, 0.0, math.nan]),
        lambda: Goal([0.0, 0.0, 0.0], position_tolerance=0.0),
        lambda: Goal([0.0, 0.0, 0.0], heading_tolerance=math.inf),
    ],
)
def test_a_goal_needs_a_pose_and_tolerances(make):
    with pytest.raises(ShapeError):
        make()


def test_poses_are_read_only_copies():
    pose = np.zeros(3)
    goal = Goal(pose)
    pose[0] = 1.0
    assert goal.pose[0] == 0.0
    with pytest.raises(ValueError, match="read-only"):
        goal.pose[0] = 1.0


def test_files_that_are_no_scene_files_say_so(tmp_path):
    cases = {
        "missing.yaml": "no such file",
        ".": "a folder, not a file",
        "zero\x00byte.yaml": "cannot be read",
        "x" * 5000: "cannot be read",
        "binary.yaml": "not a text file",
        "empty.yaml": "the file is empty",
    }
    (tmp_path / "binary.yaml").write_bytes(bytes(range(256)))
    (tmp_path / "empty.yaml").write_bytes(b"")
    for name, words in cases.items():
        with pytest.raises(SceneError, match=words) as caught:
            load_scene(tmp_path / name)
        assert caught.value.file is not None


def test_an_endless_file_is_refused():
    with pytest.raises(SceneError, match="larger than"):
        load_scene("/dev/zero")


def test_a_map_is_found_beside_its_scene_and_may_be_added_to(tmp_path, monkeypatch):
    walls = {
        "format": "wall-map/1",
        "walls": [[[[0, 1], [4, 1], [4, 1.2], [0, 1.2]]]],
        "unknown": [],
        "furniture": [],
        "stairs": [],
    }
    (tmp_path / "walls.json").write_text(json.dumps(walls))
    scene = tmp_path / "scene.yaml"
    scene.write_text(
        CHAIR + "map: {file: walls.json}\nworld: {solids: [{circle: [2, 2, 0.1]}]}\n" + POSES
    )
    monkeypatch.chdir("/")
    world = load_scene(scene).world
    assert len(world.solids) == 2
    assert world.solids[0].shape.area == pytest.approx(0.8)
    assert world.solids[1].name == "circle 1"
    scene.write_text(CHAIR + "map: {file: other.json}\n" + POSES)
    with pytest.raises(SceneError, match=r"other\.json"):
        load_scene(scene)


def test_what_cannot_be_written_is_refused_and_leaves_the_old_file(tmp_path):
    scene = read_scene(FULL)
    file = tmp_path / "scene.yaml"
    write_scene(scene, file)
    before = file.read_text()
    far = Scene(scene.vehicle, scene.world, [1e7, 0.0, 0.0], scene.goal)
    with pytest.raises(SceneError, match=r"start\.x: is too large"):
        write_scene(far, file)
    assert file.read_text() == before
    with pytest.raises(InputError):
        write_scene(scene, tmp_path)
    assert [entry.name for entry in tmp_path.iterdir()] == ["scene.yaml"]


def shown_in_the_docs() -> list[str]:
    """Return the YAML examples of docs/scene-format.md."""
    page = Path(__file__).parent.parent / "docs" / "scene-format.md"
    return re.findall(r"```yaml\n(.*?)```", page.read_text(encoding="utf-8"), re.DOTALL)


@pytest.mark.parametrize("text", shown_in_the_docs(), ids=lambda text: text.split(":")[0])
def test_what_the_docs_show_can_be_read(text):
    if "vehicle:" not in text:
        text += CHAIR
    if "world:" not in text and "doorway:" not in text:
        text += "world: {}\n"
    if "doorway:" not in text:
        text += "start: {x: -1, y: 0.4, heading_deg: 0}\ngoal: {x: 2, y: 2, heading_deg: 0}\n"
    assert read_scene(text).vehicle.width > 0.6
