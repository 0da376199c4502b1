"""Writing and reading a scene gives the same scene, whatever is in it."""

import math

import numpy as np
import pytest
import shapely
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from narrows.errors import SceneError
from narrows.scene import Goal, Scene, check_scene, load_scene, write_scene
from narrows.vehicle import Layer, Limits, Vehicle
from narrows.world import Door, MovingSolid, Solid, World

pytestmark = pytest.mark.slow

COORDINATE = st.floats(-1e6, 1e6)
SMALL = st.floats(0.1, 2.0)
HEADING = st.floats(-20.0, 20.0)
POSE = st.tuples(st.floats(-1e3, 1e3), st.floats(-1e3, 1e3), HEADING).map(np.array)
HEIGHTS = st.tuples(st.floats(2.0, 3.0), st.floats(3.5, 9.0)) | st.just((2.0, 2.5))
NAMES = st.text(st.characters(exclude_categories=["Cc", "Cs", "Zl", "Zp"]), max_size=30)


@st.composite
def polygons(draw) -> shapely.Polygon:
    """Return a star-shaped polygon, sometimes with a hole."""
    count = draw(st.integers(3, 9))
    angle = (np.arange(count) + draw(st.floats(0.0, 0.5))) * 2.0 * math.pi / count
    radius = np.array(draw(st.lists(SMALL, min_size=count, max_size=count)))
    center = np.array(draw(st.tuples(COORDINATE, COORDINATE)))
    ring = radius[:, None] * np.stack([np.cos(angle), np.sin(angle)], axis=1) * 0.9
    holes = [0.05 * ring + center] if draw(st.booleans()) else []
    polygon = shapely.Polygon(ring + center, holes)
    assume(polygon.is_valid and polygon.area > 1e-3)
    assume(np.abs(ring + center).max() <= 1e6)
    return polygon


SOLIDS = st.builds(Solid, polygons(), st.just(0.0), HEIGHTS, NAMES) | st.builds(
    Solid,
    st.builds(shapely.Point, COORDINATE, COORDINATE),
    st.floats(1e-3, 1e3),
    HEIGHTS,
    NAMES,
)
DOORS = st.builds(Door, st.tuples(COORDINATE, COORDINATE), SMALL, HEADING)


@st.composite
def people(draw) -> MovingSolid:
    """Return somebody who walks above the chair."""
    count = draw(st.integers(1, 5))
    steps = draw(st.lists(st.floats(1e-3, 1e2), min_size=count, max_size=count))
    places = draw(st.lists(st.tuples(COORDINATE, COORDINATE), min_size=count, max_size=count))
    path = np.column_stack([np.cumsum(steps), np.array(places)])
    return MovingSolid(draw(SMALL), path, draw(HEIGHTS), draw(NAMES))


LIMITS = st.builds(
    Limits,
    speed=SMALL,
    reverse_speed=st.just(0.0) | SMALL,
    acceleration=SMALL,
    jerk=SMALL,
    yaw_rate=SMALL,
    yaw_acceleration=SMALL,
    lateral_acceleration=SMALL,
    curvature=st.just(math.inf) | SMALL,
)


@st.composite
def vehicles(draw) -> Vehicle:
    """Return a rectangle, a triangle or a stack of layers, all below 2 m."""
    kind = draw(st.sampled_from(["rectangle", "triangle", "layers"]))
    length, width, height = draw(SMALL), draw(SMALL), draw(st.floats(0.5, 2.0))
    triangle = [[-0.1, -width], [length, 0.0], [-0.1, width]]
    if kind == "rectangle":
        layers = Vehicle.rectangle(length, width, 0.3 * length, height=height).layers
    elif kind == "triangle":
        layers = (Layer(triangle, (0.0, height)),)
    else:
        layers = (Layer(triangle, (0.1, height)), Layer(triangle, (0.0, 0.2)))
    return Vehicle(layers, draw(SMALL), draw(SMALL), draw(LIMITS), draw(NAMES))


WORLDS = st.builds(
    World,
    solids=st.lists(SOLIDS, max_size=4).map(tuple),
    bounds=st.none() | st.just((-1.5e3, -1.2e3, 1.1e3, 1.3e3)),
    moving=st.lists(people(), max_size=2).map(tuple),
    doors=st.lists(DOORS, max_size=2).map(tuple),
)
SCENES = st.builds(
    Scene,
    vehicle=vehicles(),
    world=WORLDS,
    start=POSE,
    goal=st.builds(Goal, POSE, SMALL, st.floats(1e-3, 3.0)),
    margin=st.floats(0.0, 1.0),
    name=NAMES,
)


def check_same(first: Scene, second: Scene) -> None:
    """Check that two scenes say the same; headings to 1e-9 rad, lengths to the last place."""
    assert (first.name, first.margin) == (second.name, second.margin)
    np.testing.assert_allclose(second.start, first.start, rtol=0.0, atol=1e-9)
    np.testing.assert_allclose(second.goal.pose, first.goal.pose, rtol=0.0, atol=1e-9)
    assert second.start[:2].tolist() == first.start[:2].tolist()
    assert second.goal.position_tolerance == first.goal.position_tolerance
    assert second.goal.heading_tolerance == pytest.approx(first.goal.heading_tolerance, abs=1e-9)
    check_same_vehicle(first.vehicle, second.vehicle)
    check_same_world(first.world, second.world)


def check_same_vehicle(first: Vehicle, second: Vehicle) -> None:
    assert (first.name, first.limits) == (second.name, second.limits)
    assert (first.track, first.wheel_radius) == (second.track, second.wheel_radius)
    assert len(first.layers) == len(second.layers)
    for one, other in zip(first.layers, second.layers, strict=True):
        assert one.z == other.z
        assert one.polygon.tolist() == other.polygon.tolist()


def check_same_world(first: World, second: World) -> None:
    assert first.bounds == second.bounds
    assert len(first.solids) == len(second.solids)
    for one, other in zip(first.solids, second.solids, strict=True):
        assert (one.name, one.z, one.radius) == (other.name, other.z, other.radius)
        assert one.shape == other.shape
    for person, again in zip(first.moving, second.moving, strict=True):
        assert (person.name, person.z, person.radius) == (again.name, again.z, again.radius)
        assert person.path.tolist() == again.path.tolist()
    for door, same in zip(first.doors, second.doors, strict=True):
        assert (door.center, door.width) == (same.center, same.width)
        assert door.heading == pytest.approx(same.heading, abs=1e-9)


@given(SCENES)
@settings(deadline=None, max_examples=60, derandomize=True)
def test_reading_what_was_written_gives_the_same_scene(tmp_path_factory, scene):
    file = tmp_path_factory.mktemp("scene") / "scene.yaml"
    try:
        check_scene(scene)
    except SceneError:
        assume(False)  # outside the bounds
    write_scene(scene, file)
    again = load_scene(file)
    check_same(scene, again)
    write_scene(again, file.with_name("again.yaml"))
    check_same(again, load_scene(file.with_name("again.yaml")))
