"""A map that cannot be used ends in one SceneError that says where and why."""

from __future__ import annotations

import contextlib
import json

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from PIL import Image

from narrows.errors import SceneError
from narrows.maps import load_map

FIELDS = {
    "image": "map.png",
    "resolution": "0.05",
    "origin": "[0, 0, 0]",
    "negate": "0",
    "occupied_thresh": "0.65",
    "free_thresh": "0.196",
}
SQUARE = [[0, 0], [1, 0], [1, 1], [0, 1]]
DOOR = {"centre": [0, 0], "width": 0.9, "normal_rad": 0}


def write_grid(folder, **changes):
    """Write a small map whose fields are given as text; None leaves a field out."""
    Image.fromarray(np.full((2, 3), 254, np.uint8)).save(folder / "map.png")
    fields = FIELDS | changes
    file = folder / "map.yaml"
    file.write_text("\n".join(f"{k}: {v}" for k, v in fields.items() if v is not None))
    return file


def write_walls(folder, **changes):
    file = folder / "map.json"
    file.write_text(json.dumps({"format": "wall-map/1", "walls": [[SQUARE]]} | changes))
    return file


def refusal(file, **options):
    with pytest.raises(SceneError) as caught:
        load_map(file, **options)
    return caught.value


def test_the_maps_the_mistakes_are_made_in_can_be_read(tmp_path):
    assert load_map(write_grid(tmp_path)).solids == ()
    assert len(load_map(write_walls(tmp_path, doors=[DOOR])).solids) == 1


@pytest.mark.parametrize("name", FIELDS)
def test_a_missing_field_is_named(tmp_path, name):
    error = refusal(write_grid(tmp_path, **{name: None}))
    assert (error.field, error.problem) == (name, "this field is missing")


@pytest.mark.parametrize(
    ("name", "text", "field", "allowed"),
    [
        ("resolution", "-0.05", "resolution", "0.001 to 10"),
        ("resolution", "0", "resolution", "0.001 to 10"),
        ("resolution", "1e300", "resolution", "0.001 to 10"),
        ("resolution", "five", "resolution", "0.001 to 10"),
        ("resolution", "true", "resolution", "0.001 to 10"),
        ("resolution", "[0.05]", "resolution", "0.001 to 10"),
        ("origin", "[0, .nan, 0]", "origin[1]", "-1e+07 to 1e+07"),
        ("origin", "[0, 0, nan]", "origin[2]", "-6.28319 to 6.28319"),
        ("origin", "[-.inf, 0, 0]", "origin[0]", "-1e+07 to 1e+07"),
        ("origin", "[0, 0]", "origin", "[x, y, yaw]"),
        ("origin", "0", "origin", "[x, y, yaw]"),
        ("occupied_thresh", "1.01", "occupied_thresh", "0 to 1"),
        ("occupied_thresh", ".nan", "occupied_thresh", "0 to 1"),
        ("free_thresh", "-0.1", "free_thresh", "0 to 1"),
        ("free_thresh", "0.7", "free_thresh", "at most occupied_thresh, 0.65"),
        ("negate", "2", "negate", "0 (black is occupied) or 1"),
        ("negate", "[0]", "negate", "0 (black is occupied) or 1"),
        ("mode", "raw", "mode", "trinary or scale"),
        ("mode", "{}", "mode", "trinary or scale"),
    ],
)
def test_a_wrong_value_is_located_and_the_allowed_ones_are_named(
    tmp_path, name, text, field, allowed
):
    error = refusal(write_grid(tmp_path, **{name: text}))
    line = list(FIELDS | {name: text}).index(name) + 1
    assert (error.field, error.allowed, error.line) == (field, allowed, line)
    assert error.file == str(tmp_path / "map.yaml")


@pytest.mark.parametrize("name", ["none.png", ".", "''", "7", "x" * 300, '"a\\0b"', "/dev/zero"])
def test_a_missing_picture_is_named_where_it_is_asked_for(tmp_path, name):
    error = refusal(write_grid(tmp_path, image=name))
    assert (error.field, error.line) == ("image", 1)


@pytest.mark.parametrize(
    ("content", "problem"),
    [
        (b"", "not a picture"),
        (b"hello", "not a picture"),
        (b"GIF89a" + bytes(40), "not a picture"),
        (b"P5 0 4 255\n", "not a picture"),
        (b"P5 40 40 255\n" + bytes(30), "damaged or cut short"),
        (b"P2 2 2 255\n1 2 x 4\n", "damaged or cut short"),
        (b"Pf 1 1 -1.0\n" + bytes(4), "of a kind"),
        (b"P5 9000 9000 255\n", "too large"),
        (b"P5 60000 60000 255\n", "too large"),
    ],
)
def test_a_picture_that_is_none_is_refused(tmp_path, content, problem):
    file = write_grid(tmp_path)
    (tmp_path / "map.png").write_bytes(content)
    error = refusal(file)
    assert problem in error.problem
    assert (error.file, error.field) == (str(tmp_path / "map.png"), "image")


@pytest.mark.parametrize(
    ("content", "problem"),
    [
        (b"", ""),
        (b"- 1\n- 2\n", "this is no map"),
        (b"\xff\xfe\x00", "not a text file"),
        (b"a: [1, 2", ""),
        (b"a: " + b"[" * 5000, ""),
        (b"a: 1\n" * 20000, "this is no map"),
    ],
)
def test_a_description_that_is_none_is_refused(tmp_path, content, problem):
    file = tmp_path / "map.yaml"
    file.write_bytes(content)
    error = refusal(file)
    assert problem in error.problem
    assert error.file == str(file)


@pytest.mark.parametrize("name", ["none.yaml", "none.json"])
def test_a_missing_map_is_named(tmp_path, name):
    error = refusal(tmp_path / name)
    assert str(error) == f"{tmp_path / name}: the map cannot be read: No such file or directory"


@pytest.mark.parametrize("name", ["folder.yaml", "folder.json"])
def test_a_folder_is_no_map(tmp_path, name):
    (tmp_path / name).mkdir()
    assert refusal(tmp_path / name).problem == "this is no map"


def test_a_map_of_another_kind_is_refused(tmp_path):
    error = refusal(tmp_path / "map.bag")
    assert error.allowed == ".yaml (map_server) or .json (wall-map/1)"
    assert refusal(write_grid(tmp_path), unknown="maybe").field == "unknown"


@pytest.mark.parametrize(
    ("changes", "field"),
    [
        ({"format": "barn-worlds/1"}, "format"),
        ({"walls": {}}, "walls"),
        ({"walls": [[]]}, "walls[0]"),
        ({"walls": [7]}, "walls[0]"),
        ({"walls": [[SQUARE], [SQUARE[:2]]]}, "walls[1][0]"),
        ({"walls": [[SQUARE, [[0, 0], [1], [2, 2]]]]}, "walls[0][1]"),
        ({"walls": [[[["0", "0"], ["1", "0"], ["1", "1"]]]]}, "walls[0][0]"),
        ({"walls": [[[[0, 0], [10**400, 0], [1, 1]]]]}, "walls[0][0]"),
        ({"walls": [[[[0, 0], [1e300, 0], [1, 1]]]]}, "walls[0][0]"),
        ({"walls": [[[[0, 0], [float("nan"), 0], [1, 1]]]]}, "walls[0][0]"),
        ({"walls": [[[[False, False], [True, False], [True, True]]]]}, "walls[0][0]"),
        ({"furniture": [[[[0, 0], [1, 1], [1, 0], [0, 1]]]]}, "furniture[0]"),  # crosses itself
        ({"stairs": [[[[0, 0], [1, 1], [2, 2]]]]}, "stairs[0]"),
        ({"doors": 3}, "doors"),
        ({"doors": [3]}, "doors[0]"),
        ({"doors": [DOOR, {}]}, "doors[1].centre"),
        ({"doors": [DOOR | {"width": 0}]}, "doors[0].width"),
        ({"doors": [DOOR | {"width": None}]}, "doors[0].width"),
        ({"doors": [DOOR | {"normal_rad": "up"}]}, "doors[0].normal_rad"),
        ({"bounds": [0, 0, 1]}, "bounds"),
        ({"bounds": [0, 0, 0, 1]}, "bounds"),
    ],
)
def test_a_wrong_field_of_a_wall_map_is_named(tmp_path, changes, field):
    error = refusal(write_walls(tmp_path, **changes))
    assert (error.file, error.field) == (str(tmp_path / "map.json"), field)
    assert error.allowed


@pytest.mark.parametrize("content", [b"", b"{", b"[1]", b"\xff\xff", b"[" * 100_000, b"7", b"null"])
def test_json_that_is_no_wall_map_is_refused(tmp_path, content):
    file = tmp_path / "map.json"
    file.write_bytes(content)
    assert refusal(file).file == str(file)


def damaged(content):
    """Return a strategy of one file's bytes with a stretch of them replaced, or cut short."""
    return st.builds(
        lambda start, stretch, length: content[:start] + stretch + content[start + length :],
        st.integers(0, len(content)),
        st.binary(max_size=12),
        st.integers(0, 40),
    ) | st.integers(0, len(content)).map(lambda end: content[:end])


@pytest.mark.parametrize("kind", ["png", "pgm", "bmp", "yaml", "json"])
def test_damaged_files_are_read_or_refused_but_never_a_crash(tmp_path, kind):
    picture = "map.png" if kind in ("yaml", "json") else f"map.{kind}"
    grid, walls = write_grid(tmp_path, image=picture), write_walls(tmp_path, doors=[DOOR])
    pixels = (np.arange(60).reshape(6, 10) * 4).astype(np.uint8)
    Image.fromarray(pixels).save(tmp_path / picture)
    file = {"yaml": grid, "json": walls}.get(kind, tmp_path / picture)

    @settings(
        deadline=None,
        max_examples=150,
        derandomize=True,
        suppress_health_check=[HealthCheck.function_scoped_fixture],
    )
    @given(damaged(file.read_bytes()))
    def read(content):
        file.write_bytes(content)
        with contextlib.suppress(SceneError):
            load_map(walls if kind == "json" else grid)

    read()
