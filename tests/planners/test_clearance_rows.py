"""The rows an optimiser sees are the distances the geometry measures, the least one among them."""

import math

import numpy as np
import pytest

from narrows.clearance import clearance_at
from narrows.planners.body_program import ROW_FIELDS
from narrows.planners.clearance_rows import HORIZON, Rows, rows_along
from narrows.planners.spline import Spline
from narrows.se2 import rotate, transform
from narrows.vehicle import Layer, Vehicle
from narrows.world import Solid, World

CHAIR = Vehicle.rectangle(1.0, 0.67, 0.25)
LAYERED = Vehicle(
    (
        Layer(np.array([[-0.25, -0.3], [0.8, -0.3], [0.9, 0], [0.8, 0.3], [-0.25, 0.3]]), (0, 0.7)),
        Layer(np.array([[-0.3, -0.2], [0.3, -0.25], [0.3, 0.25], [-0.3, 0.2]]), (0.7, 1.3)),
    )
)
SAMPLES = 97  # what a refinement takes
SPLINE = Spline(6)


class Motion:
    """A section of a manoeuvre: poses at parameters."""

    def __init__(self, control: np.ndarray, direction: int = 1) -> None:
        """Keep the control points (9, 2) and the direction of travel."""
        self.control, self.direction = control, direction

    def __call__(self, parameter: np.ndarray) -> np.ndarray:
        """Return poses (N, 3)."""
        slope = self.direction * (SPLINE.basis(parameter, 1) @ self.control)
        heading = np.arctan2(slope[:, 1], slope[:, 0])
        return np.column_stack([SPLINE.basis(parameter) @ self.control, heading])


def random_motion(rng: np.random.Generator) -> Motion:
    """Two to three metres that bend within half a metre, forward or in reverse."""
    heading = rng.uniform(-math.pi, math.pi) + np.cumsum(rng.normal(scale=0.25, size=8))
    step = rng.uniform(0.25, 0.4, size=(8, 1))
    legs = step * np.column_stack([np.cos(heading), np.sin(heading)])
    control = np.vstack([[0.0, 0.0], np.cumsum(legs, axis=0)])
    return Motion(control - control[4], int(rng.choice([-1, 1])))


def random_world(rng: np.random.Generator, motion: Motion, bounds: bool = False) -> World:
    """Posts, blocks and a table top that stand beside the motion, rarely in its way."""
    solids = []
    for index, t in enumerate(rng.uniform(0.0, 1.0, rng.integers(2, 7))):
        pose = motion(np.array([t]))[0]
        aside = rng.choice([-1, 1]) * rng.uniform(0.38, 0.7)
        at = transform(pose, [[rng.uniform(-0.3, 0.3), aside]])[0]
        z = (0.72, 0.76) if rng.random() < 0.25 else (0.0, 2.5)
        if rng.random() < 0.5:
            solids.append(Solid.circle(*at, rng.uniform(0.01, 0.1), z=z, name=f"post {index}"))
        else:
            shape = np.array([[0, 0], [0.3, -0.1], [0.35, 0.15], [0.1, 0.2]]) * rng.uniform(0.3, 1)
            corners = at + rotate(rng.uniform(-math.pi, math.pi), shape - shape.mean(axis=0))
            solids.append(Solid.polygon(corners, z=z, name=f"block {index}"))
    return World(tuple(solids), (-1.6, -1.7, 1.5, 1.8) if bounds else None)


def gaps(rows: Rows, motion: Motion) -> np.ndarray:
    """The program's rows in NumPy: the clearance of a corner along an axis, at each parameter."""
    pose = motion(rows.parameter)
    axis, corner = rows.fields[:, :2], rows.fields[:, 2:4]
    support, in_world = rows.fields[:, 4], rows.fields[:, 5]
    placed = pose[:, :2] + rotate(pose[:, 2], corner)
    world = support - np.einsum("nk,nk->n", axis, placed)
    turned = rotate(pose[:, 2], axis)
    body = np.einsum("nk,nk->n", turned, corner - pose[:, :2]) - support
    return np.where(in_world == 1.0, world, body)


@pytest.mark.parametrize("seed", range(10))
@pytest.mark.parametrize("vehicle", [CHAIR, LAYERED], ids=["chair", "layered"])
def test_the_least_found_is_the_least_of_dense_sampling(seed: int, vehicle: Vehicle) -> None:
    rng = np.random.default_rng(seed)
    motion = random_motion(rng)
    world = random_world(rng, motion)
    _, least = rows_along(world, vehicle, motion, 0.02, samples=SAMPLES)
    dense = clearance_at(world, vehicle, motion(np.linspace(0, 1, 40 * SAMPLES)))[0].min()
    if dense > HORIZON:
        assert least == math.inf
        return
    # Free: a tenth of what a refinement asks for beyond the margin (3e-4 m); deep in a solid the
    # way out changes within a sample.
    allowed = 1e-4 if dense > 0.0 else 1e-3
    assert dense - allowed <= least <= dense + allowed


@pytest.mark.parametrize("seed", range(10))
def test_a_row_says_what_the_programs_formula_says_there(seed: int) -> None:
    rng = np.random.default_rng(seed)
    motion = random_motion(rng)
    rows, _ = rows_along(random_world(rng, motion, True), LAYERED, motion, 0.02, samples=SAMPLES)
    np.testing.assert_allclose(gaps(rows, motion), rows.gap, atol=1e-9)


@pytest.mark.parametrize("seed", range(10))
def test_at_each_place_the_least_row_is_the_distance_there(seed: int) -> None:
    """The separating axis attains the distance: no row promises more, one promises just it."""
    rng = np.random.default_rng(seed)
    motion = random_motion(rng)
    for solid in random_world(rng, motion).solids:
        world = World((solid,))
        rows, _ = rows_along(world, CHAIR, motion, 0.02, samples=SAMPLES)
        if not len(rows.gap):
            continue
        places, index = np.unique(rows.parameter, return_inverse=True)
        least = np.full(len(places), np.inf)
        np.minimum.at(least, index, rows.gap)
        distance = clearance_at(world, CHAIR, motion(places))[0]
        np.testing.assert_allclose(least, distance, atol=1e-9)


@pytest.mark.parametrize("seed", range(10))
def test_on_a_curve_nearby_the_frozen_axes_promise_less_than_the_distance(seed: int) -> None:
    """Any axis bounds the distance from below, and all nearest corners are watched."""
    rng = np.random.default_rng(seed)
    motion = random_motion(rng)
    for solid in random_world(rng, motion).solids:
        world = World((solid,))
        rows, _ = rows_along(world, CHAIR, motion, 0.02, samples=SAMPLES)
        if not len(rows.gap):
            continue
        for _ in range(5):
            moved = Motion(motion.control + rng.normal(scale=0.004, size=(9, 2)), motion.direction)
            distance = clearance_at(world, CHAIR, moved(rows.parameter))[0]
            promised = gaps(rows, moved)
            for parameter in np.unique(rows.parameter):
                here = rows.parameter == parameter
                # rows of a place may come from two pieces of a solid; this one's are convex
                assert promised[here].min() <= distance[here][0] + 1e-9


@pytest.mark.parametrize("seed", range(10))
def test_the_rows_are_the_distances_to_first_order(seed: int) -> None:
    """An axis that is an edge's normal turns with its edge; what is left is of second order."""
    rng = np.random.default_rng(seed)
    motion = random_motion(rng)
    compared = 0
    for solid in random_world(rng, motion).solids:
        world = World((solid,))
        rows, _ = rows_along(world, CHAIR, motion, 0.02, samples=SAMPLES)
        step = rng.normal(size=(9, 2))
        left = []
        for size in (1e-4, 1e-5):
            moved = Motion(motion.control + size * step, motion.direction)
            distance = clearance_at(world, CHAIR, moved(rows.parameter))[0]
            promised = gaps(rows, moved)
            places, index = np.unique(rows.parameter, return_inverse=True)
            least = np.full(len(places), np.inf)
            np.minimum.at(least, index, promised)
            off = distance[np.unique(rows.parameter, return_index=True)[1]] - least
            # corner beside corner the axis turns by the step over the distance: a few mm away no
            # step is small, and in a solid the way out may change sides
            left.append(off[least > 0.03])
        compared += len(left[0])
        assert (left[0] <= 3e-6).all()
        assert (left[1] <= 3e-8).all()
    assert compared >= 5


def test_rows_ask_for_the_margin_of_solids_and_for_none_of_the_bounds() -> None:
    motion = Motion(np.column_stack([np.linspace(0, 2, 9), np.zeros(9)]))
    wall = Solid.polygon([[-1, 0.4], [4, 0.4], [4, 1], [-1, 1]])
    world = World((wall,), (-5, -0.36, 5, 5))
    rows, least = rows_along(world, CHAIR, motion, 0.02, samples=SAMPLES)
    assert least == pytest.approx(0.4 - 0.335, abs=1e-12)  # the bounds are no solid
    required, share = (ROW_FIELDS.index(name) for name in ("required", "share"))
    bound = rows.fields[:, required] == 0.0
    np.testing.assert_allclose(rows.gap[bound].min(), 0.36 - 0.335, atol=1e-12)
    np.testing.assert_array_equal(rows.fields[~bound][:, required], 0.02)
    np.testing.assert_array_equal(rows.fields[:, share], 1.0)


@pytest.mark.parametrize("seed", range(6))
def test_the_bounds_rows_hold_the_least_room_there_is(seed: int) -> None:
    rng = np.random.default_rng(seed)
    motion = random_motion(rng)
    reach = transform(motion(np.linspace(0, 1, SAMPLES)), CHAIR.outline).reshape(-1, 2)
    (low_x, low_y), (high_x, high_y) = reach.min(axis=0), reach.max(axis=0)
    bounds = (low_x - 0.05, low_y + 0.02, high_x + 0.5, high_y + 0.03)
    rows, _ = rows_along(World(bounds=bounds), CHAIR, motion, 0.02, samples=SAMPLES)
    by_side = {
        tuple(normal): rows.gap[(rows.fields[:, :2] == normal).all(axis=1)].min(initial=np.inf)
        for normal in ([-1, 0], [0, -1], [1, 0], [0, 1])
    }
    expected = {(-1, 0): 0.05, (0, -1): -0.02, (1, 0): np.inf, (0, 1): 0.03}
    assert by_side == pytest.approx(expected, abs=1e-9)


def test_along_a_wall_there_is_a_row_every_few_centimetres() -> None:
    """Not only where it is least: a step must not bend the rest of the way into the wall."""
    motion = Motion(np.column_stack([np.linspace(0, 2, 9), np.zeros(9)]))
    wall = Solid.polygon([[-1, 0.4], [4, 0.4], [4, 1], [-1, 1]])
    rows, _ = rows_along(World((wall,)), CHAIR, motion, 0.02, samples=SAMPLES)
    places = np.unique(motion(rows.parameter)[:, 0])
    assert np.diff(places).max() <= 0.07
    assert places[0] <= 0.07
    assert places[-1] >= 1.93
    close, _ = rows_along(World((wall,)), CHAIR, motion, 0.06, samples=SAMPLES)
    places = np.unique(motion(close.parameter)[:, 0])
    assert np.diff(places).max() <= 0.03


def test_a_wall_is_watched_with_both_corners_that_face_it() -> None:
    motion = Motion(np.column_stack([np.linspace(0, 2, 9), np.zeros(9)]))
    wall = Solid.polygon([[-1, 0.4], [4, 0.4], [4, 1], [-1, 1]])
    rows, _ = rows_along(World((wall,)), CHAIR, motion, 0.02, samples=SAMPLES)
    for parameter in np.unique(rows.parameter):
        corners = rows.fields[rows.parameter == parameter][:, 2:4]
        assert {tuple(c) for c in corners.tolist()} == {(0.75, 0.335), (-0.25, 0.335)}


def test_heights_that_do_not_meet_give_no_rows() -> None:
    motion = Motion(np.column_stack([np.linspace(0, 2, 9), np.zeros(9)]))
    top = Solid.polygon([[-1, 0.35], [4, 0.35], [4, 1], [-1, 1]], z=(0.72, 0.76))
    low = Vehicle.rectangle(1.0, 0.67, 0.25, height=0.7)
    rows, least = rows_along(World((top,)), low, motion, 0.02, samples=SAMPLES)
    assert len(rows.gap) == 0
    assert least == math.inf
    # of the layered chair the trunk is near it, its legs pass below
    rows, least = rows_along(World((top,)), LAYERED, motion, 0.02, samples=SAMPLES)
    assert least == pytest.approx(0.35 - 0.25, abs=1e-12)


def test_the_nearest_rows_are_kept_in_the_motions_order() -> None:
    rng = np.random.default_rng(4)
    motion = random_motion(rng)
    rows, _ = rows_along(random_world(rng, motion, True), LAYERED, motion, 0.02, samples=SAMPLES)
    kept = rows.nearest(7)
    spare = rows.gap - rows.fields[:, ROW_FIELDS.index("required")]
    left_out = np.setdiff1d(spare, kept.gap - kept.fields[:, 6])
    assert len(kept.gap) == 7
    assert (kept.gap - kept.fields[:, 6]).max() <= left_out.min()
    everything = rows.nearest(10_000)
    np.testing.assert_array_equal(everything.gap, rows.gap)


def test_inside_a_solid_the_rows_say_how_deep() -> None:
    motion = Motion(np.column_stack([np.linspace(0, 2, 9), np.zeros(9)]))
    block = Solid.polygon([[1.0, -1], [1.2, -1], [1.2, 0.3], [1.0, 0.3]], name="block")
    rows, least = rows_along(World((block,)), CHAIR, motion, 0.02, samples=SAMPLES)
    dense = clearance_at(World((block,)), CHAIR, motion(np.linspace(0, 1, 4001)))[0].min()
    assert dense == pytest.approx(-0.6, abs=0.05)
    assert least == pytest.approx(dense, abs=1e-3)
    assert rows.gap.min() == pytest.approx(least, abs=1e-12)
