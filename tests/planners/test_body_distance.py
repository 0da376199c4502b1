"""Distances of a body from pieces are those of the polygons, and their axes show them."""

import math

import numpy as np
import pytest

from narrows.geometry import separation
from narrows.planners.body_distance import BodyDistance
from narrows.se2 import rotate, transform
from narrows.vehicle import Layer
from narrows.world import Solid, World

BODIES = [
    Layer(np.array([[-0.25, -0.3], [0.75, -0.3], [0.75, 0.3], [-0.25, 0.3]]), (0.0, 1.0)),
    Layer(np.array([[-0.25, -0.3], [0.8, -0.3], [0.9, 0], [0.8, 0.3], [-0.25, 0.3]]), (0.0, 1.0)),
]
WORLD = World(
    (
        Solid.polygon([[0, 0], [2, 0], [2, 0.1], [0, 0.1]], name="wall"),
        Solid.polygon([[0.3, 1.0], [0.5, 1.4], [0.1, 1.3]], name="wedge"),
        Solid.circle(-0.5, 0.5, 0.2, name="post"),
        Solid.polygon([[3, 0], [3.3, -0.1], [3.5, 0.2], [3.3, 0.5], [3.0, 0.4]], name="block"),
    )
)
PIECES = WORLD.pieces_between(0.0, 1.0)


def expected(poses: np.ndarray, piece: np.ndarray, body: Layer) -> tuple[np.ndarray, np.ndarray]:
    result = separation(transform(poses, body.polygon), PIECES.corners[piece])
    return result.distance - PIECES.radius[piece], result.axis


@pytest.mark.parametrize("body", BODIES, ids=["rectangle", "pointed"])
def test_the_distance_is_that_of_the_polygons(body: Layer) -> None:
    """Near, far and overlapping poses; the axis is the other measure's, or shows the same gap."""
    rng = np.random.default_rng(3)
    poses = np.column_stack([rng.uniform(-1.5, 4, 4000), rng.uniform(-1.5, 2.5, 4000)])
    poses = np.column_stack([poses, rng.uniform(-math.pi, math.pi, 4000)])
    piece = rng.integers(0, len(PIECES), 4000)
    found = BodyDistance.of(body, PIECES).measure(poses, piece, math.inf)
    distance, axis = expected(poses, piece, body)
    np.testing.assert_allclose(found.distance, distance, atol=1e-9)
    apart = distance > 1e-6
    np.testing.assert_allclose(found.axis[apart], axis[apart], atol=1e-6)
    corners = transform(poses, body.polygon)
    solid = PIECES.corners[piece]
    near = np.einsum("nkd,nd->nk", corners, found.axis).max(axis=1)
    far = np.einsum("nkd,nd->nk", solid, found.axis).min(axis=1) - PIECES.radius[piece]
    np.testing.assert_allclose(far - near, found.distance, atol=1e-9)


@pytest.mark.parametrize("x", [-0.6, -0.2, 0.4, 1.0, 1.9, 2.2, 2.6])
@pytest.mark.parametrize("y", [-0.301, -0.35, 0.45])
@pytest.mark.parametrize("heading", [0.0, math.pi])
def test_sides_that_lie_along_a_wall_are_measured_to_it(x: float, y: float, heading: float) -> None:
    """Parallel sides leave the nearest corner undecided; past the wall's end corners face."""
    pose = np.array([[x, y, heading]])
    found = BodyDistance.of(BODIES[0], PIECES).measure(pose, np.array([0]), math.inf)
    np.testing.assert_allclose(found.distance, expected(pose, np.array([0]), BODIES[0])[0])


def test_the_axis_of_an_edge_stays_with_its_owner_and_that_of_corners_with_the_world() -> None:
    body = BodyDistance.of(BODIES[0], PIECES)
    poses = np.array([[1.0, -0.5, 0.3], [-0.6, -0.35, 0.3], [-1.35, 0.0, 0.2]])
    found = body.measure(poses, np.array([0, 0, 2]), math.inf)
    assert found.in_world.tolist() == [True, False, True]
    np.testing.assert_allclose(found.axis[0], [0.0, 1.0], atol=1e-12)  # the wall's own normal
    own = rotate(-poses[1:2, 2], found.axis[1:2])
    assert np.abs(own).max() == pytest.approx(1.0)  # a normal of the rectangle
    assert np.isinf(found.between_corners[:2]).all()
    assert found.between_corners[2] == pytest.approx(found.distance[2] + 0.2)


def test_beyond_the_horizon_a_distance_may_be_less_but_stays_beyond() -> None:
    rng = np.random.default_rng(5)
    poses = np.column_stack([rng.uniform(-3, 6, (500, 2)), rng.uniform(-4, 4, 500)])
    piece = rng.integers(0, len(PIECES), 500)
    found = BodyDistance.of(BODIES[1], PIECES).measure(poses, piece, 0.25).distance
    exact = expected(poses, piece, BODIES[1])[0]
    assert ((found > exact - 1e-9) | (found >= 0.25)).all()
    assert (found <= exact + 1e-9).all()
