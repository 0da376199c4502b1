"""Meshes hold the volume they stand for, with their outside outside."""

import numpy as np
import pytest
import shapely

from narrows.viewer.solids_mesh import (
    area_mesh,
    ball_mesh,
    box_mesh,
    edges_of,
    flat_mesh,
    joined,
    solid_mesh,
    wheel_mesh,
)
from narrows.world import Solid


def volume(mesh):
    """Return the volume by the divergence theorem; negative where faces look inward."""
    a, b, c = (mesh.vertices[mesh.faces[:, k]] for k in range(3))
    return float(np.einsum("ij,ij->", a, np.cross(b, c)) / 6.0)


def test_a_box_holds_its_volume():
    assert volume(box_mesh([0, 0, 0], [1, 2, 3])) == pytest.approx(6.0)


def test_a_wall_with_a_hole_holds_its_area_times_its_height():
    outside, hole = shapely.box(0, 0, 3, 2), shapely.box(1, 0.5, 2, 1.5)
    shape = outside.difference(hole).union(shapely.box(3, 0, 4, 0.5))  # and not convex
    assert volume(area_mesh(shape, 0.2, 0.7)) == pytest.approx(0.5 * shape.area)
    assert volume(solid_mesh(Solid(shape), 0.0, 1.0)) == pytest.approx(shape.area)


def test_a_circle_is_drawn_within_its_radius():
    mesh = solid_mesh(Solid.circle(1.0, 2.0, 0.5), 0.0, 1.0)
    radius = np.hypot(*(mesh.vertices[:, :2] - [1.0, 2.0]).T)
    assert radius.max() == pytest.approx(0.5)
    assert volume(mesh) == pytest.approx(np.pi * 0.25, rel=0.01)  # 32 corners


def test_a_flat_area_looks_up_and_keeps_its_holes():
    shape = shapely.box(0, 0, 3, 2).difference(shapely.box(1, 0.5, 2, 1.5))
    mesh = flat_mesh(shape, 0.1)
    a, b, c = (mesh.vertices[mesh.faces[:, k]] for k in range(3))
    areas = 0.5 * np.cross(b - a, c - a)[:, 2]
    assert (areas > 0.0).all()
    assert areas.sum() == pytest.approx(shape.area)


def test_a_wheel_stands_on_the_floor_and_rolls_ahead():
    mesh = wheel_mesh([0.0, 0.3, 0.16], 0.16, 0.06)
    low, high = mesh.vertices.min(axis=0), mesh.vertices.max(axis=0)
    np.testing.assert_allclose([low, high], [[-0.16, 0.27, 0.0], [0.16, 0.33, 0.32]], atol=1e-9)
    assert volume(mesh) == pytest.approx(np.pi * 0.16**2 * 0.06, rel=0.02)


def test_a_ball_is_round():
    mesh = ball_mesh([1.0, 2.0, 3.0], 0.1)
    np.testing.assert_allclose(np.linalg.norm(mesh.vertices - [1, 2, 3], axis=1), 0.1)
    assert volume(mesh) == pytest.approx(4 / 3 * np.pi * 1e-3, rel=0.1)  # 8 rings


def test_joined_meshes_keep_their_volumes():
    parts = [box_mesh([0, 0, 0], [1, 1, 1]), box_mesh([2, 0, 0], [3, 1, 2])]
    assert volume(joined(parts)) == pytest.approx(3.0)
    assert len(joined([]).faces) == 0


def test_a_prism_has_three_edges_for_each_corner():
    corners = np.array([[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]])
    edges = edges_of(corners, 0.0, 2.0)
    assert edges.shape == (9, 2, 3)
    assert np.linalg.norm(edges[-1, 1] - edges[-1, 0]) == pytest.approx(2.0)
