"""Rows of clearance: at the pose they are picked for they say what the distance says."""

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from narrows.clearance import clearance_at
from narrows.tracking.separating_rows import ROWS_PER_POSE, SeparatingRows
from narrows.vehicle import Vehicle
from narrows.world import Solid, World

CHAIR = Vehicle.rectangle(1.0, 0.7, 0.25)
WORLD = World(
    (
        Solid.polygon([[0.9, 0.5], [1.6, 0.4], [1.4, 1.2]], name="wedge"),
        Solid.circle(-0.6, -0.7, 0.15, name="post"),
        Solid.polygon([[-1, 1.0], [3, 1.0], [3, 1.1], [-1, 1.1]], name="wall"),
    )
)


def reach(rows, pose):
    """Return n.(p + R v) - h of each row, shape (R,)."""
    c, s = np.cos(pose[2]), np.sin(pose[2])
    x = pose[0] + c * rows[:, 3] - s * rows[:, 4]
    y = pose[1] + s * rows[:, 3] + c * rows[:, 4]
    return rows[:, 0] * x + rows[:, 1] * y - rows[:, 2]


@settings(deadline=None, max_examples=100)
@given(x=st.floats(-0.5, 1.0), y=st.floats(-0.4, 0.4), heading=st.floats(-3, 3))
def test_the_tightest_row_is_the_distance_to_the_nearest_solid(x, y, heading):
    pose = np.array([x, y, heading])
    rows = SeparatingRows(WORLD, CHAIR).pick(pose[None], 1.0)[0]
    assert rows.shape == (ROWS_PER_POSE, 5)
    distance = clearance_at(WORLD, CHAIR, pose[None])[0][0]
    if distance < 0.9:
        np.testing.assert_allclose(-reach(rows, pose).max(), distance, atol=1e-9)


@settings(deadline=None, max_examples=100)
@given(
    x=st.floats(-0.5, 1.0),
    y=st.floats(-0.4, 0.4),
    heading=st.floats(-3, 3),
    move=st.tuples(*[st.floats(-0.05, 0.05)] * 3),
)
def test_rows_picked_nearby_hold_only_where_those_solids_are_clear(x, y, heading, move):
    """Rows are sufficient: a pose all corners of which stay behind every line is clear."""
    world = World(WORLD.solids[:1])
    pose = np.array([x, y, heading])
    moved = pose + move
    rows = SeparatingRows(world, CHAIR).pick(pose[None], 1.0)[0]
    lines = np.unique(rows[:, :3], axis=0)
    corners = CHAIR.outline
    c, s = np.cos(moved[2]), np.sin(moved[2])
    placed = moved[:2] + corners @ np.array([[c, s], [-s, c]])
    lines = [line for line in lines if line[:2].any()]
    if lines and all((placed @ line[:2]).max() <= line[2] for line in lines):
        assert clearance_at(world, CHAIR, moved[None])[0][0] >= -1e-9


def test_where_nothing_is_near_the_rows_say_nothing():
    rows = SeparatingRows(WORLD, CHAIR).pick(np.array([[50.0, 50.0, 0.0]]), 0.3)[0]
    assert (reach(rows, np.array([50.0, 50.0, 0.0])) == -1.0).all()
    empty = SeparatingRows(World(), CHAIR).pick(np.zeros((2, 3)), 0.3)
    assert (empty[..., 2] == 1.0).all()
    assert not empty[..., :2].any()
