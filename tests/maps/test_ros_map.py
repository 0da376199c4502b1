"""map_server maps: which cells are solid, and where they are."""

from __future__ import annotations

import math

import numpy as np
import pytest
import shapely
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra import numpy as arrays
from PIL import Image

from narrows.clearance import clearance_at
from narrows.errors import SceneError
from narrows.maps import load_map
from narrows.vehicle import Vehicle

BLACK, GREY, WHITE = 0, 205, 254  # occupied, unknown and free, as map_saver writes them


def write_map(folder, pixels, picture="map.pgm", **changes):
    """Write a map of pixels, topmost row first, and return its YAML file."""
    fields = {
        "image": picture,
        "resolution": 0.5,
        "origin": [0.0, 0.0, 0.0],
        "negate": 0,
        "occupied_thresh": 0.65,
        "free_thresh": 0.196,
    } | changes
    Image.fromarray(np.asarray(pixels)).save(folder / picture)
    file = folder / "map.yaml"
    file.write_text("\n".join(f"{name}: {value}" for name, value in fields.items()))
    return file


def grey(*rows):
    return np.array(rows, dtype=np.uint8)


def solid_at(world, x, y):
    """Return the names of the solids that hold a point."""
    return [s.name for s in world.solids if s.shape.contains(shapely.Point(x, y))]


def test_the_lowest_row_of_the_picture_is_at_the_origin(tmp_path):
    pixels = grey([WHITE, WHITE, WHITE], [WHITE, WHITE, WHITE], [WHITE, BLACK, WHITE])
    world = load_map(write_map(tmp_path, pixels, origin=[10.0, -2.0, 0.0]))
    (solid,) = world.solids
    assert solid.name == "wall"
    assert solid.shape.bounds == (10.5, -2.0, 11.0, -1.5)
    assert world.bounds == (10.0, -2.0, 11.5, -0.5)


def test_a_turned_map_turns_about_its_origin(tmp_path):
    pixels = grey([WHITE, WHITE, BLACK], [WHITE, WHITE, WHITE])
    file = write_map(tmp_path, pixels, origin=[1.0, 2.0, math.pi / 2])
    (solid,) = load_map(file).solids
    # The cell's centre, 1.25 along and 0.75 up in the picture, goes 0.75 left and 1.25 up.
    assert solid.shape.centroid.coords[0] == pytest.approx((1.0 - 0.75, 2.0 + 1.25))
    assert solid.shape.area == pytest.approx(0.25)


@pytest.mark.parametrize("degrees", [0, 90, 180, -90, 360])
def test_a_map_turned_by_right_angles_fills_its_box(tmp_path, degrees):
    pixels = np.full((40, 80), WHITE, np.uint8)
    world = load_map(write_map(tmp_path, pixels, origin=[3.0, 4.0, math.radians(degrees)]))
    assert world.solids == ()


@pytest.mark.parametrize("degrees", [30, 120, -100, 0.1])
def test_corners_of_the_box_around_a_turned_map_are_solid(tmp_path, degrees):
    yaw = math.radians(degrees)
    file = write_map(tmp_path, np.full((40, 80), WHITE, np.uint8), origin=[3.0, 4.0, yaw])
    world = load_map(file)
    assert [solid.name for solid in world.solids] == ["outside the map"] * 4
    x_low, y_low, x_high, y_high = world.bounds
    solid_area = sum(solid.shape.area for solid in world.solids)
    box_area = (x_high - x_low) * (y_high - y_low)
    assert solid_area == pytest.approx(box_area - 40.0 * 20.0)
    along, up = np.array([math.cos(yaw), math.sin(yaw)]), np.array([-math.sin(yaw), math.cos(yaw)])
    inside = np.array([3.0, 4.0]) + 39.99 * along + 0.01 * up
    outside = np.array([3.0, 4.0]) + 20.0 * along - 0.01 * up
    assert solid_at(world, *inside) == []
    assert solid_at(world, *outside) == ["outside the map"]


def test_unknown_cells_are_solid_unless_free_is_asked_for(tmp_path):
    file = write_map(tmp_path, grey([BLACK, GREY, WHITE]))
    assert solid_at(load_map(file), 0.75, 0.25) == ["unknown"]
    assert solid_at(load_map(file, unknown="free"), 0.75, 0.25) == []
    assert solid_at(load_map(file, unknown="free"), 0.25, 0.25) == ["wall"]


def test_negate_makes_white_occupied(tmp_path):
    file = write_map(tmp_path, grey([0, 128, 255]), negate=1)
    assert [solid_at(load_map(file), x, 0.25) for x in (0.25, 0.75, 1.25)] == [
        [],
        ["unknown"],
        ["wall"],
    ]


def test_thresholds_are_compared_strictly(tmp_path):
    """Occupancy 0.4, 0.6, 0.8 and 1.0 of pixels 153, 102, 51 and 0 (255 = 5 x 51)."""
    file = write_map(tmp_path, grey([153, 102, 51, 0]), occupied_thresh=0.8, free_thresh=0.4)
    world = load_map(file)
    found = [solid_at(world, 0.25 + 0.5 * k, 0.25) for k in range(4)]
    assert found == [["unknown"], ["unknown"], ["unknown"], ["wall"]]


@pytest.mark.parametrize(
    ("picture", "pixels"),
    [
        ("map.png", grey([BLACK, GREY, WHITE])),
        ("map.bmp", grey([BLACK, GREY, WHITE])),
        ("colour.png", np.repeat(grey([BLACK, GREY, WHITE])[..., None], 3, axis=2)),
        ("deep.png", np.array([[0, 205 * 257, 254 * 257]], dtype=np.uint16)),
        ("deep.pgm", np.array([[0, 205 * 257, 254 * 257]], dtype=np.uint16)),
    ],
)
def test_kinds_of_picture_say_the_same(tmp_path, picture, pixels):
    world = load_map(write_map(tmp_path, pixels, picture))
    assert [solid_at(world, x, 0.25) for x in (0.25, 0.75, 1.25)] == [["wall"], ["unknown"], []]


def test_plain_pgm_and_small_greatest_values_are_read(tmp_path):
    file = write_map(tmp_path, grey([WHITE]))
    (tmp_path / "map.pgm").write_text("P2 # plain\n3 1 10\n0 8 10\n")  # occupancy 1, 0.2, 0
    world = load_map(file)
    assert [solid_at(world, x, 0.25) for x in (0.25, 0.75, 1.25)] == [["wall"], ["unknown"], []]


def test_palette_and_bilevel_pictures_are_read(tmp_path):
    file = write_map(tmp_path, grey([WHITE]), "map.png")
    for mode in ("P", "1"):
        Image.fromarray(grey([BLACK, 255])).convert(mode).save(tmp_path / "map.png")
        assert [s.shape.bounds for s in load_map(file).solids] == [(0.0, 0.0, 0.5, 0.5)]


def test_transparent_cells_are_unknown_in_mode_scale(tmp_path):
    white, black = [255, 255, 255], [0, 0, 0]
    pixels = np.array([[[*white, 254], [*white, 255], [*black, 255], [*black, 254]]], np.uint8)
    world = load_map(write_map(tmp_path, pixels, "map.png", mode="scale"))
    found = [solid_at(world, x, 0.25) for x in (0.25, 0.75, 1.25, 1.75)]
    assert found == [["unknown"], [], ["wall"], ["unknown"]]


def test_opacity_is_averaged_with_the_colours_in_mode_trinary(tmp_path):
    """As map_server does: occupancy 1 - 255/4/255 = 0.75 for opaque black, 0.25 clear white."""
    pixels = np.array([[[0, 0, 0, 255], [255, 255, 255, 0], [255, 255, 255, 255]]], np.uint8)
    world = load_map(write_map(tmp_path, pixels, "map.png"))
    assert [solid_at(world, x, 0.25) for x in (0.25, 0.75, 1.25)] == [["wall"], ["unknown"], []]


pictures = arrays.arrays(
    np.uint8,
    arrays.array_shapes(min_dims=2, max_dims=2, max_side=7),
    elements=st.sampled_from([BLACK, GREY, WHITE]),
)


@settings(deadline=None, max_examples=60, derandomize=True)
@given(
    pictures,
    st.sampled_from([0.025, 0.05, 0.1]),
    st.tuples(st.floats(-50, 50), st.floats(-50, 50), st.floats(-3.2, 3.2)),
)
def test_a_point_is_in_a_solid_exactly_where_its_cell_is_occupied(
    tmp_path_factory, pixels, resolution, origin
):
    folder = tmp_path_factory.mktemp("grid")
    file = write_map(folder, pixels, resolution=resolution, origin=list(origin))
    world = load_map(file)
    names = np.array(["wall", "unknown", ""])[np.searchsorted([BLACK, GREY, WHITE], pixels[::-1])]
    rows, columns = np.indices(pixels.shape)
    grid = np.stack([columns + 0.3, rows + 0.6], axis=-1) * resolution
    cosine, sine = math.cos(origin[2]), math.sin(origin[2])
    x = origin[0] + cosine * grid[..., 0] - sine * grid[..., 1]
    y = origin[1] + sine * grid[..., 0] + cosine * grid[..., 1]
    found = np.full(pixels.shape, "", dtype="U20")
    for solid in world.solids:
        inside = shapely.contains_xy(solid.shape, x, y)
        assert (found[inside] == "").all()  # solids do not overlap
        found[inside] = solid.name
    assert (found == names).all()
    for name in ("wall", "unknown"):
        area = sum(solid.shape.area for solid in world.solids if solid.name == name)
        expected = np.count_nonzero(names == name) * resolution**2
        assert area == pytest.approx(expected, abs=1e-10)  # rounding of coordinates up to 50 m


@settings(deadline=None, max_examples=60, derandomize=True)
@given(pictures, st.floats(-3.2, 3.2))
def test_pieces_tile_each_solid_without_a_gap(tmp_path_factory, pixels, yaw):
    file = write_map(tmp_path_factory.mktemp("grid"), pixels, origin=[7.0, -3.0, yaw])
    for solid in load_map(file).solids:
        parts = shapely.polygons(solid.pieces)
        assert all(shapely.is_ccw(shapely.get_exterior_ring(parts)))
        assert shapely.area(parts).sum() == pytest.approx(solid.shape.area, abs=1e-12)
        # A micrometre shuts seams that rounding might leave; nothing wider may be there.
        union = shapely.union_all(shapely.buffer(parts, 1e-6, join_style="mitre"))
        assert union.covers(solid.shape)


def test_neighbouring_cells_share_their_corners_to_the_last_bit(tmp_path):
    pixels = np.full((30, 30), BLACK, np.uint8)
    pixels[::2, 1::2] = GREY
    pixels[1::2, ::2] = WHITE
    file = write_map(tmp_path, pixels, resolution=0.05, origin=[3.3, 4.7, 0.7])
    world = load_map(file)
    corners = {tuple(c) for s in world.solids if s.name != "outside the map" for c in s.pieces[0]}
    exact = np.array(sorted(corners))
    distance = np.linalg.norm(exact[:, None] - exact[None], axis=2)
    assert distance[distance > 0.0].min() > 0.049


def test_modes_without_a_meaning_for_driving_are_refused(tmp_path):
    file = write_map(tmp_path, grey([WHITE]), mode="raw")
    with pytest.raises(SceneError, match=r"mode.*found 'raw'; allowed: trinary or scale"):
        load_map(file)


def test_noise_is_refused(tmp_path):
    pixels = np.where(np.indices((600, 600)).sum(axis=0) % 2, BLACK, WHITE).astype(np.uint8)
    with pytest.raises(SceneError, match="noise"):
        load_map(write_map(tmp_path, pixels))


def test_a_body_deep_inside_a_large_unknown_area_overlaps_it(tmp_path):
    pixels = np.full((100, 100), GREY, np.uint8)
    pixels[:, :3] = WHITE
    pixels[40:60, 50] = WHITE  # a slit of 0.5 m: narrower than the chair
    world = load_map(write_map(tmp_path, pixels))
    chair = Vehicle.rectangle(1.0, 0.6, 0.5)
    poses = [[x, y, 0.3] for x in np.arange(3.0, 48.0, 1.7) for y in np.arange(1.0, 49.0, 1.7)]
    distance, against = clearance_at(world, chair, poses)
    assert (distance < 0.0).all()
    assert set(against) == {"unknown"}
