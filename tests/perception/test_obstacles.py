"""The fast route: what is found, what is refused, and that silence is never free space."""

import numpy as np
import pytest

from narrows.errors import InputError, ShapeError
from narrows.perception.camera import DepthCamera, Mounting
from narrows.perception.cloud import run_chain
from narrows.perception.depth_image import depth_frame
from narrows.perception.floor import FloorPrior, find_floor, is_floor
from narrows.perception.obstacles import ObstacleFinder, ObstacleOptions
from narrows.perception.surroundings import Cell, Grid, Sight
from narrows.studies.perception_frames import depth_of_boxes, kinect, load_frame

FLOOR = (-1.0, -3.0, -0.1, 6.0, 3.0, 0.0)
MOUNTING = Mounting(height=0.8, tilt=np.radians(30.0), x=0.2)
CAMERA = kinect(MOUNTING)


def seen_of(*boxes, true=MOUNTING, believed=MOUNTING):
    """Return what is seen of boxes by a camera that is not quite where it is believed to be."""
    return ObstacleFinder(kinect(believed)).see(depth_of_boxes(boxes, kinect(true)))


def test_a_carton_is_found_where_it_stands():
    seen = seen_of(FLOOR, (1.3, -0.3, 0.0, 1.6, 0.1, 0.30))
    assert seen.sight is Sight.SEEN
    (carton,) = seen.obstacles
    # A step of the sensor at 1.5 m is 7 mm; the face begins above the threshold of 4 cm.
    assert np.allclose(carton.low[:2], [1.3, -0.3], atol=0.015)
    assert carton.high[1] == pytest.approx(0.1, abs=0.015)
    assert carton.high[2] == pytest.approx(0.30, abs=0.015)
    assert carton.low[2] < 0.06
    assert carton.distance == pytest.approx(1.3, abs=0.015)
    assert not seen.is_free([[1.4, -0.1]]).any()


def test_seen_floor_is_free_and_the_shadow_of_a_carton_is_not():
    seen = seen_of(FLOOR, (1.3, -0.3, 0.0, 1.6, 0.1, 0.30))
    assert seen.is_free([[1.0, 0.0], [1.5, 0.4], [1.1, -0.3]]).all()
    assert not seen.is_free([[1.75, -0.1]]).any()  # behind the carton
    assert not seen.is_free([[0.3, 0.0], [1.0, 1.9], [-5.0, 0.0], [99.0, 0.0], [np.nan, 0.0]]).any()


def test_the_floor_alone_holds_no_obstacle_anywhere():
    seen = seen_of(FLOOR)
    assert seen.obstacles == ()
    assert seen.drop_offs == ()
    assert np.count_nonzero(seen.cells == Cell.FREE) > 1500


@pytest.mark.parametrize("tilt", [-1.2, -0.6, 1.9, 3.0])
def test_a_camera_that_looks_at_the_ceiling_or_backwards_frees_nothing(tilt):
    wall = np.full((480, 640), 1500, dtype=np.uint16)
    seen = ObstacleFinder(kinect(Mounting(0.8, tilt))).see(wall)
    assert seen.sight is Sight.FLOOR_ASSUMED
    assert not np.equal(seen.cells, Cell.FREE).any()


@pytest.mark.parametrize(("height", "is_found"), [(0.06, True), (0.012, False)])
def test_the_lowest_obstacle_at_a_metre_and_a_half_is_between_1_and_6_cm(height, is_found):
    assert bool(seen_of(FLOOR, (1.4, -0.2, 0.0, 1.7, 0.2, height)).obstacles) == is_found


def test_what_hangs_above_the_person_is_no_obstacle_and_what_hangs_lower_is():
    level = Mounting(height=1.2, tilt=0.1)
    for low, count in ((1.5, 0), (1.1, 1)):
        seen = seen_of(FLOOR, (2.0, -0.5, low, 2.2, 0.5, 1.9), true=level, believed=level)
        assert len(seen.obstacles) == count


def test_an_edge_down_is_a_drop_off_where_the_floor_ends():
    seen = seen_of((-1.0, -3.0, -0.1, 1.8, 3.0, 0.0), (1.8, -3.0, -0.6, 6.0, 3.0, -0.5))
    (drop,) = seen.drop_offs
    assert drop.low[0] == pytest.approx(1.8, abs=0.03)
    assert seen.obstacles == ()
    assert seen.is_free([[1.5, 0.0]]).all()
    assert not seen.is_free([[1.9, 0.0], [2.5, 0.0]]).any()


def test_an_edge_with_nothing_below_is_unknown_and_never_free():
    seen = seen_of((-1.0, -3.0, -0.1, 1.8, 3.0, 0.0))
    assert not seen.is_free([[1.9, 0.0], [2.2, 0.0]]).any()


@pytest.mark.parametrize(("turn", "kind"), [(5.0, "tilt"), (-5.0, "tilt"), (5.0, "roll")])
def test_a_camera_knocked_by_5_degrees_is_noticed_and_allowed_for(turn, kind):
    change = {kind: getattr(MOUNTING, kind) + np.radians(turn)}
    true = Mounting(**{"height": 0.8, "tilt": MOUNTING.tilt, "x": 0.2} | change)
    seen = seen_of(FLOOR, (1.3, -0.3, 0.0, 1.6, 0.1, 0.30), true=true)
    assert seen.sight is Sight.SEEN
    off = getattr(seen.floor.mounting, kind) - getattr(MOUNTING, kind)
    assert np.degrees(off) == pytest.approx(turn, abs=0.1)
    (carton,) = seen.obstacles
    assert np.allclose(carton.low[:2], [1.3, -0.3], atol=0.02)


@pytest.mark.parametrize("turn", [15.0, -15.0])
def test_a_camera_knocked_by_15_degrees_frees_nothing(turn):
    true = Mounting(height=0.8, tilt=MOUNTING.tilt + np.radians(turn), x=0.2)
    seen = seen_of(FLOOR, (1.3, -0.3, 0.0, 1.6, 0.1, 0.30), true=true)
    assert seen.sight is Sight.FLOOR_ASSUMED
    assert not (seen.cells == Cell.FREE).any()


@pytest.mark.parametrize("name", ["table top", "wall", "somebody's back"])
def test_the_chain_takes_an_obstacle_away_and_the_fast_route_keeps_it(name):
    frame = load_frame(name, None)
    plane = run_chain(frame.depth, frame.camera.intrinsics).plane.plane
    assert not is_floor(plane.normal, plane.offset, frame.camera.mounting, FloorPrior())
    seen = ObstacleFinder(frame.camera).see(frame.depth)
    assert seen.obstacles[0].pixels > 50_000
    assert seen.obstacles[0].distance < 1.2


def test_a_wall_and_nothing_else_is_no_floor():
    wall = depth_of_boxes(((1.0, -3.0, 0.0, 1.1, 3.0, 3.0),), CAMERA)
    floor = find_floor(depth_frame(wall, CAMERA.intrinsics), CAMERA, FloorPrior())
    assert not floor.is_seen
    seen = ObstacleFinder(CAMERA).see(wall)
    assert seen.obstacles[0].distance == pytest.approx(1.0, abs=0.02)
    assert not (seen.cells == Cell.FREE).any()


@pytest.mark.parametrize(
    ("degrees", "height", "can_be"),
    [
        (0.0, 0.8, True),
        (6.9, 0.8, True),
        (7.1, 0.8, False),
        (180.0, 0.8, False),
        (0.0, 0.855, True),
        (0.0, 0.865, False),
        (0.0, 0.735, False),
    ],
)
def test_a_plane_too_steep_too_high_or_too_low_is_no_floor(degrees, height, can_be):
    turned = Mounting(height=0.8, tilt=MOUNTING.tilt + np.radians(degrees)).up
    assert is_floor(turned, height, MOUNTING, FloorPrior()) is can_be


def test_a_steep_ramp_filling_the_view_is_no_floor():
    # Seen by a camera 15 deg off, a floor at the right distance is a ramp at the wrong angle.
    true = Mounting(height=0.8, tilt=MOUNTING.tilt + np.radians(15.0))
    frame = depth_frame(depth_of_boxes((FLOOR,), kinect(true)), CAMERA.intrinsics)
    found = find_floor(frame, CAMERA, FloorPrior())
    assert not found.is_seen
    assert found.mounting == MOUNTING


@pytest.mark.parametrize("raised", [0.2, 0.7])
def test_a_platform_is_no_floor_under_a_camera_believed_higher(raised):
    seen = seen_of((-1.0, -3.0, raised - 0.1, 6.0, 3.0, raised), true=MOUNTING)
    assert seen.sight is Sight.FLOOR_ASSUMED
    assert seen.obstacles
    assert not (seen.cells == Cell.FREE).any()


@pytest.mark.parametrize(
    ("depth", "sight"),
    [
        (None, Sight.SILENT),
        (np.zeros((480, 640), np.uint16), Sight.BLIND),
        (np.full((480, 640), np.nan), Sight.BLIND),
        (np.full((480, 640), np.inf, np.float32), Sight.BLIND),
        (np.full((480, 640), -1.0), Sight.BLIND),
    ],
)
def test_silence_is_never_free_space(depth, sight):
    seen = ObstacleFinder(CAMERA).see(depth)
    assert seen.sight is sight
    assert (seen.cells == Cell.UNKNOWN).all()
    assert sight.value in seen.reason


def test_holes_in_a_frame_are_unknown_and_the_rest_is_as_before():
    depth = depth_of_boxes((FLOOR,), CAMERA)
    whole = ObstacleFinder(CAMERA).see(depth)
    holed = depth / 1e3
    holed[200:320, 250:390] = np.nan
    seen = ObstacleFinder(CAMERA).see(holed)
    assert not ((seen.cells == Cell.FREE) & (whole.cells != Cell.FREE)).any()
    lost = np.count_nonzero((seen.cells != Cell.FREE) & (whole.cells == Cell.FREE))
    assert 20 < lost < 400


def test_a_frame_that_is_too_old_says_nothing():
    seen = ObstacleFinder(CAMERA).see(depth_of_boxes((FLOOR,), CAMERA), time=10.0)
    assert seen.at(10.15) is seen
    for now in (10.3, 9.0, np.nan):
        late = seen.at(now)
        assert late.sight is Sight.SILENT
        assert (late.cells == Cell.UNKNOWN).all()
        assert late.obstacles == ()


@pytest.mark.parametrize("shape", [(0, 0), (240, 320), (480, 640, 3)])
def test_a_frame_of_another_size_is_refused(shape):
    with pytest.raises(ShapeError, match="a depth image of this camera"):
        ObstacleFinder(CAMERA).see(np.zeros(shape, np.uint16))


def test_a_frame_of_another_type_is_refused():
    with pytest.raises(InputError, match="uint16"):
        ObstacleFinder(CAMERA).see(np.zeros((480, 640), np.int32))


def test_settings_that_make_no_sense_are_refused():
    for make in (
        lambda: ObstacleOptions(least_height=0.0),
        lambda: ObstacleOptions(top=0.01),
        lambda: FloorPrior(angle_tolerance=-1.0),
        lambda: Grid(x_from=1.0, x_to=1.0),
        lambda: Grid(cell=1e-6),
        lambda: Grid(y_to=np.inf),
    ):
        with pytest.raises(InputError):
            make()


def test_a_few_stray_pixels_are_neither_an_obstacle_nor_free():
    depth = depth_of_boxes((FLOOR,), CAMERA) / 1e3
    place = Mounting(0.8, MOUNTING.tilt, x=0.2).to_camera([1.02, 0.02, 0.25])
    lens = CAMERA.intrinsics
    u, v = (place[:2] / place[2] * [lens.fx, lens.fy] + [lens.cx, lens.cy]).astype(int)
    depth[v, u : u + 3] = place[2]
    seen = ObstacleFinder(CAMERA).see(depth)
    assert seen.obstacles == ()
    assert not seen.is_free([[1.02, 0.01]]).any()


def test_the_floor_is_found_in_real_frames_also_where_the_chain_removes_people(real):
    name, depth, lens, reference = real
    height, tilt = {
        "rgrgb": (0.80, 30.0),
        "clorox": (0.47, 35.0),
        "capture4": (0.83, 5.0),
        "five_people": (1.29, 5.0),
        "grabber": (0.72, 45.0),
    }[name]
    camera = DepthCamera(lens, Mounting(height, np.radians(tilt)))
    floor = find_floor(depth_frame(depth, lens), camera, FloorPrior())
    assert floor.is_seen
    assert floor.mounting.height == pytest.approx(height, abs=0.02)
    normal = np.array(reference["plane"][:3])
    angle = np.arccos(min(1.0, abs(normal @ floor.up) / np.linalg.norm(normal)))
    if name == "five_people":
        assert angle > np.radians(60.0)  # the reference's plane stands upright
    else:
        assert angle < np.radians(0.6)  # two sensors' worth of quantisation apart
