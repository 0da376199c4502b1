"""Geometry of the camera, and depth images to points and back."""

import numpy as np
import pytest

from narrows.errors import InputError, ShapeError
from narrows.perception.camera import DepthCamera, Intrinsics, Mounting
from narrows.perception.depth_image import depth_frame, depth_from_points, points_from_depth

LENS = Intrinsics.from_field_of_view(np.radians(57.0), np.radians(43.0))
MOUNTING = Mounting(height=0.9, tilt=0.5, x=0.3, y=-0.1, heading=0.2, roll=0.07)


def test_every_pixel_comes_back_to_itself():
    depth = np.random.default_rng(1).integers(0, 5000, (480, 640)).astype(np.uint16)
    again = depth_from_points(points_from_depth(depth, LENS), LENS)
    assert np.array_equal(np.rint(1e3 * again).astype(np.uint16), depth)


def test_of_two_points_on_one_pixel_the_nearer_is_seen():
    image = depth_from_points([[0.0, 0.0, 3.0], [0.0, 0.0, 1.5], [0.0, 0.0, -1.0]], LENS)
    assert image.max() == 1.5
    assert np.count_nonzero(image) == 1


def test_the_rotation_is_a_rotation_and_the_inverse_undoes_it():
    rotation = MOUNTING.camera_to_body
    assert np.allclose(rotation @ rotation.T, np.eye(3), atol=1e-14)
    assert np.linalg.det(rotation) == pytest.approx(1.0)
    points = np.random.default_rng(2).normal(size=(50, 3))
    assert np.allclose(MOUNTING.to_camera(MOUNTING.to_body(points)), points, atol=1e-13)


def test_a_camera_tilted_down_meets_the_floor_where_trigonometry_says():
    mounting = Mounting(height=1.0, tilt=np.radians(30.0), x=0.2)
    hit = mounting.to_body([0.0, 0.0, 2.0])  # sin 30 = 1/2: 2 m along the axis
    assert np.allclose(hit, [0.2 + np.sqrt(3.0), 0.0, 0.0], atol=1e-12)


def test_right_in_the_image_is_right_of_the_chair_and_a_heading_turns_left():
    assert Mounting(1.0).to_body([0.5, 0.0, 2.0])[1] == -0.5
    assert Mounting(1.0, heading=np.pi / 2).to_body([0.0, 0.0, 2.0])[1] == pytest.approx(2.0)


def test_up_measures_the_height_of_a_point():
    points = np.random.default_rng(3).normal(size=(20, 3))
    heights = points @ MOUNTING.up + MOUNTING.height
    assert np.allclose(heights, MOUNTING.to_body(points)[:, 2], atol=1e-13)


def test_millimetres_and_metres_are_the_same_frame():
    depth = np.random.default_rng(4).integers(0, 4000, (480, 640)).astype(np.uint16)
    assert np.array_equal(points_from_depth(depth, LENS), points_from_depth(depth / 1e3, LENS))


def test_what_is_no_number_is_no_return():
    depth = np.zeros((480, 640))
    depth[0, :5] = [np.nan, np.inf, -np.inf, -1.0, 1e300]
    depth[1, 0] = 2.0
    assert np.count_nonzero(depth_frame(depth, LENS).metres) == 1
    assert points_from_depth(depth, LENS).shape == (1, 3)


def test_the_frame_given_is_not_changed():
    depth = np.full((480, 640), np.nan)
    depth_frame(depth, LENS)
    assert np.isnan(depth).all()


@pytest.mark.parametrize("shape", [(0, 0), (0,), (480, 641), (480, 640, 1), ()])
def test_a_frame_of_another_size_is_refused(shape):
    with pytest.raises(ShapeError, match=r"is \(480, 640\), got"):
        points_from_depth(np.zeros(shape, dtype=np.uint16), LENS)


@pytest.mark.parametrize("dtype", [np.uint8, np.int32, np.int64, bool, complex, object])
def test_a_frame_of_another_type_is_refused(dtype):
    with pytest.raises(InputError, match="uint16 in millimetres"):
        points_from_depth(np.zeros((480, 640), dtype=dtype), LENS)


@pytest.mark.parametrize(
    "make",
    [
        lambda: Mounting(0.0),
        lambda: Mounting(np.nan),
        lambda: Mounting(1.0, tilt=np.inf),
        lambda: Intrinsics(0.0, 500.0, 320.0, 240.0),
        lambda: Intrinsics(500.0, 500.0, np.nan, 240.0),
        lambda: DepthCamera(LENS, MOUNTING, furthest=-1.0),
    ],
)
def test_what_no_camera_can_be_is_refused(make):
    with pytest.raises(InputError):
        make()


@pytest.mark.parametrize("angles", [(0.0, 1.0), (1.0, np.pi), (1.0, -0.5), (np.nan, 1.0)])
def test_a_view_that_no_pinhole_has_is_refused(angles):
    with pytest.raises(InputError, match="no view"):
        Intrinsics.from_field_of_view(*angles)


def test_a_picture_of_half_a_pixel_is_refused():
    with pytest.raises(InputError, match="not a number of pixels"):
        Intrinsics(500.0, 500.0, 0.0, 0.0, width=0.5)
