"""The rows an optimiser sees are the distances the geometry measures."""

import numpy as np
import pytest

from narrows import bezier
from narrows.clearance import clearance_at
from narrows.planners.body_contacts import SLOT_SIZE, SLOTS, curve_poses, find_contacts
from narrows.se2 import rotate
from narrows.vehicle import Vehicle
from narrows.world import Solid, World

CHAIR = Vehicle.rectangle(1.0, 0.67, 0.25)
WORLD = World(
    (
        Solid.polygon([[-2, 1.6], [1.15, 1.6], [1.15, 1.7], [-2, 1.7]], name="left wall"),
        Solid.polygon([[2.05, 1.6], [5, 1.6], [5, 1.7], [2.05, 1.7]], name="right wall"),
        Solid.circle(0.5, 0.2, 0.15, name="stool"),
        Solid.polygon([[2.3, 3.0], [2.8, 2.9], [2.4, 3.6]], name="plant"),
    )
)
CURVE = np.array(
    [
        [[-0.6, 0.8], [0.6, 0.8], [1.6, 0.9], [1.6, 1.65]],
        [[1.6, 1.65], [1.6, 2.3], [1.7, 2.9], [1.7, 3.5]],
    ]
)


def gap_of(slot: np.ndarray, control: np.ndarray) -> list[float]:
    """The rows of the program for one slot, in NumPy."""
    points = control.reshape(8, 2)
    point, tangent = slot[0:8] @ points, slot[8:16] @ points
    heading = float(np.arctan2(tangent[1], tangent[0]))
    axis = slot[16:18] + rotate(heading, slot[18:20])
    return [
        float(axis @ (slot[24 + k : 26 + k] - point - rotate(heading, slot[20 + k : 22 + k])))
        - slot[28]
        for k in (0, 2)
    ]


def test_the_least_row_is_the_clearance_of_the_finely_sampled_curve() -> None:
    contacts = find_contacts(WORLD, CHAIR, CURVE, 0.02)
    slots = contacts.slots.reshape(SLOTS, SLOT_SIZE)
    used = contacts.active[::2]
    rows = [gap_of(slot, CURVE) for slot in slots[used]]
    dense = clearance_at(WORLD, CHAIR, curve_poses(CURVE, 2001))[0]
    assert min(map(min, rows)) == pytest.approx(contacts.clearance, abs=1e-9)
    # The finest samples are 5 mm apart: at a kink of the distance half of that is missed.
    assert contacts.clearance == pytest.approx(dense.min(), abs=2.5e-3)
    assert contacts.clearance >= dense.min() - 1e-9


@pytest.mark.parametrize("solid", WORLD.solids, ids=lambda solid: solid.name)
def test_a_row_never_promises_more_than_the_distance_on_a_curve_nearby(solid: Solid) -> None:
    """The gap along any axis is at most the distance while the critical corners are the same."""
    world = World((solid,))
    contacts = find_contacts(world, CHAIR, CURVE, 0.1)
    slots = contacts.slots.reshape(SLOTS, SLOT_SIZE)[contacts.active[::2]]
    assert len(slots)
    rng = np.random.default_rng(0)
    for _ in range(10):
        moved = CURVE + rng.normal(scale=0.005, size=CURVE.shape)
        moved[1, 0] = moved[0, 3]
        for slot in slots:
            second = bool(slot[4:8].any())
            control = moved[int(second)]
            parameter = np.cbrt(slot[7] if second else slot[3])
            point = bezier.evaluate(control, parameter)
            tangent = bezier.evaluate(control, parameter, 1)
            pose = np.array([*point, np.arctan2(tangent[1], tangent[0])])
            distance = clearance_at(world, CHAIR, pose)[0][0]
            assert min(gap_of(slot, moved)) <= distance + 1e-9


def test_nothing_near_leaves_no_active_row() -> None:
    contacts = find_contacts(World(), CHAIR, CURVE, 0.02)
    assert not contacts.active.any()
    assert contacts.clearance == np.inf
    assert contacts.solid == -1


def test_solids_above_or_below_the_body_are_no_contacts() -> None:
    shelf = Solid.polygon([[1, 1], [2, 1], [2, 2], [1, 2]], z=(1.3, 2.0))
    assert not find_contacts(World((shelf,)), CHAIR, CURVE, 0.02).active.any()
    lower = Solid.polygon([[1, 1], [2, 1], [2, 2], [1, 2]], z=(1.2, 2.0))
    assert find_contacts(World((lower,)), CHAIR, CURVE, 0.02).active.any()
