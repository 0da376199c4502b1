"""Whatever is fed to the reader ends in a scene or in one SceneError, and soon."""

import copy
import json
import time

import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st

from narrows.errors import SceneError
from narrows.scene import Scene, load_scene, read_scene

pytestmark = pytest.mark.slow

PATIENCE = 60.0  # s of CPU on any machine; small inputs take hundredths

VALID = {
    "name": "fuzzed",
    "vehicle": {
        "body": {"length": 1.0, "width": 0.6, "rear_overhang": 0.2},
        "height": 1.2,
        "track": 0.5,
        "wheel_radius": 0.16,
        "limits": {"speed": 0.8, "curvature": 2.5},
    },
    "world": {
        "bounds": [-5, -5, 5, 5],
        "solids": [
            {"polygon": [[-4, 2], [4, 2], [4, 3], [0, 2.5], [-4, 3]], "z": [0, 2], "name": "wall"},
            {
                "polygon": [[-4, -4], [4, -4], [4, -2], [-4, -2]],
                "holes": [[[0, -3], [1, -3], [0, -2.5]]],
            },
            {"circle": [0, 4, 0.3]},
        ],
        "moving": [{"circle": [0, 0, 0.25], "path": [[0, 3, 3], [1, -4, 4]]}],
        "doors": [{"center": [0, 2.5], "width": 0.9, "heading_deg": 90}],
    },
    "start": {"x": -3, "y": 0, "heading_deg": 0},
    "goal": {"x": 3, "y": 0, "heading_deg": 0, "position_tolerance": 0.1},
    "margin": 0.02,
}
SHORT = {
    "vehicle": {"preset": "dft", "body": {"width": 0.6}},
    "doorway": {"corridor_width": 1.6, "door_width": 0.9, "room": [4, 3], "wall_thickness": 0.1},
    "corridor": {"width": 1.5, "turn_deg": 90, "length": 3, "width_after": 1.4},
    "map": {"file": "nowhere.yaml", "unknown": "free"},
    "margin": 0.0,
}
WORDS = [word for entry in (VALID, SHORT) for word in entry] + ["polygon", "circle", "x", "<<", "é"]
NUMBERS = (
    st.floats() | st.integers() | st.sampled_from([0, 1e6, -1e6, 1e-300, 1e308, 10**400, 1e-7])
)
SCALARS = st.none() | st.booleans() | NUMBERS | st.text(max_size=20) | st.sampled_from(WORDS)
TREES = st.recursive(
    SCALARS,
    lambda inner: (
        st.lists(inner, max_size=5)
        | st.dictionaries(st.text(max_size=8) | st.sampled_from(WORDS), inner, max_size=5)
    ),
    max_leaves=25,
)


def check(text: str) -> None:
    """Check that a text is read or refused as it should be."""
    began = time.process_time()
    try:
        outcome: Scene | str = read_scene(text, "fuzz.yaml")
    except SceneError as error:
        outcome = str(error)
    assert time.process_time() - began < PATIENCE
    assert isinstance(outcome, Scene) or 0 < len(outcome) < 4000


@given(st.binary(max_size=400))
@settings(deadline=None, max_examples=200, derandomize=True)
@example(b"\xef\xbb\xbf")
@example(b"\x00")
@example(b"vehicle: \xff")
def test_any_bytes_end_in_a_scene_or_an_error(tmp_path_factory, content):
    file = tmp_path_factory.getbasetemp() / "fuzz.yaml"
    file.write_bytes(content)
    with pytest.raises(SceneError) as caught:  # 400 bytes by chance are never a scene
        load_scene(file)
    assert caught.value.file == str(file)


@given(st.text(alphabet=st.sampled_from("[]{}:,-?&*!|>'\"%@`# \n\tax1.~\\\x85\u2028"), max_size=80))
@settings(deadline=None, max_examples=150, derandomize=True)
def test_any_yaml_punctuation_ends_in_a_scene_or_an_error(text):
    check(text)


@given(TREES)
@settings(deadline=None, max_examples=150, derandomize=True)
def test_any_structure_ends_in_a_scene_or_an_error(tree):
    check(json.dumps(tree))


@st.composite
def mutated(draw) -> object:
    """Return a valid scene with a few of its entries replaced, removed or added."""
    document = copy.deepcopy(draw(st.sampled_from([VALID, SHORT])))
    for _ in range(draw(st.integers(1, 4))):
        node, step = document, draw(st.sampled_from(sorted(document)))
        while isinstance(node[step], (dict, list)) and node[step] and draw(st.integers(0, 4)):
            node = node[step]
            keys = sorted(node) if isinstance(node, dict) else range(len(node))
            step = draw(st.sampled_from(keys))
        action = draw(st.sampled_from(["replace", "number", "remove", "add"]))
        if action == "replace":
            node[step] = draw(TREES)
        elif action == "number":
            node[step] = draw(NUMBERS)
        elif action == "remove" and len(document) > 1:
            del node[step]
        elif isinstance(node, dict):
            node[draw(st.sampled_from(WORDS))] = draw(TREES)
        else:
            node.append(draw(NUMBERS))
        if not isinstance(document, dict) or not document:
            break
    return document


@given(mutated())
@settings(deadline=None, max_examples=200, derandomize=True)
def test_any_mutation_of_a_scene_ends_in_a_scene_or_an_error(document):
    check(json.dumps(document))


COORDINATES = st.floats(-1e6, 1e6) | st.integers(-3, 3) | st.floats(-1e-9, 1e-9)


@given(st.lists(st.tuples(COORDINATES, COORDINATES), min_size=3, max_size=9))
@settings(deadline=None, max_examples=150, derandomize=True)
@example([(0, 0), (1e6, 0), (1e6, 1e-9), (1e-9, 1e-9), (1e-9, 1e6), (0, 1e6)])
@example([(2e-188, 2e-261), (0, 1), (2e-261, -1), (0, 2e-188)])
@example([(0, 0), (1e6, 0), (1e6, 1e-4), (1e-4, 1e-4), (1e-4, 1e6), (0, 1e6)])
def test_any_polygon_ends_in_a_scene_or_an_error(corners):
    solid = {"polygon": corners}
    check(json.dumps(VALID | {"world": {"solids": [solid]}}))
    check(json.dumps(VALID | {"vehicle": {"body": solid}}))


def test_a_chair_as_thin_as_a_hair_is_refused():
    check(json.dumps(SHORT | {"vehicle": {"preset": "dft", "body": {"width": 7e-17}}}))
    check(json.dumps(VALID | {"vehicle": {"preset": "dft", "body": {"width": 7e-17}}}))


def test_the_two_scenes_that_are_mutated_are_near_to_valid_ones():
    assert isinstance(read_scene(json.dumps(VALID)), Scene)
    alone = {key: value for key, value in SHORT.items() if key not in ("corridor", "map")}
    assert isinstance(read_scene(json.dumps(alone)), Scene)
