"""The paper's closed forms, its printed numbers, and the corrections' tables."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from narrows.errors import ShapeError
from narrows.planners.arc_geometry import (
    ArcBody,
    best_paper_turn,
    contact_radii,
    door_outer_radius,
    door_radius,
    least_paper_corridor,
    paper_turn,
    pivot_width,
    rigid_bound,
    spin_corridor,
    swept_width,
    turning_diameter,
)
from narrows.scene import load_vehicle
from narrows.vehicle import Vehicle

LENGTH, WIDTH, CORRIDOR = 1.00, 0.67, 1.30
ROOT2 = math.sqrt(2.0)

CHAIRS = {
    # front, rear, width: turning diameter, pivot width, one arc, spin, bound
    "paper": ((1.0, 0.0, 0.67), (2.109, 1.390, 1.181, 1.390, 0.827)),
    "rear": ((0.90, 0.20, 0.65), (1.914, 1.338, 1.096, 1.282, 0.849)),
    "mid": ((0.60, 0.60, 0.62), (1.351, 1.351, 0.863, 0.985, 0.863)),
    "front": ((0.40, 0.75, 0.65), (1.635, 1.333, 0.990, 1.142, 0.866)),
    "adaag": ((0.845, 0.22, 0.66), (1.814, 1.304, 1.064, 1.237, 0.843)),
    "clear floor": ((0.61, 0.61, 0.76), (1.437, 1.437, 0.975, 1.099, 0.969)),
    "dft": ((1.0, 0.2, 0.70), (2.119, 1.463, 1.202, 1.409, 0.919)),
}


def test_the_corridor_of_the_paper():
    radii = contact_radii(LENGTH, WIDTH, CORRIDOR)
    turn = paper_turn(LENGTH, WIDTH, CORRIDOR, radii[1])
    found = (turn.inner_radius, turn.outer_radius, turn.side_gap, turn.axle_gap)
    assert [round(value, 2) for value in found] == [1.35, 2.02, 0.40, 0.96]
    assert found == pytest.approx((1.3533, 2.0233, 0.3964, 0.9569), abs=5e-5)
    assert turn.clearance == pytest.approx(0.0, abs=1e-12)
    # As printed, without the outer parentheses, C_r would be 1.0008.
    inside = math.sqrt((ROOT2 * CORRIDOR - WIDTH) ** 2 - LENGTH**2)
    printed = (1 - 1 / ROOT2) * (ROOT2 * CORRIDOR - 2 * WIDTH) + ROOT2 * inside
    assert printed == pytest.approx(1.0008, abs=1e-4)


def test_the_door_of_the_paper():
    assert round(door_radius(LENGTH, WIDTH, 0.90), 2) == 1.39
    assert round(door_outer_radius(LENGTH, WIDTH, 0.90), 2) == 2.06
    assert swept_width(LENGTH, WIDTH, door_radius(LENGTH, WIDTH, 0.90)) == pytest.approx(0.90)


def test_a_door_wider_than_the_diagonal_is_turned_in_about_the_inner_wheel():
    assert door_radius(0.6, 0.62, 0.9) == 0.0
    assert door_outer_radius(0.6, 0.62, 0.9) == 0.62
    for formula in (door_radius, door_outer_radius):
        with pytest.raises(ShapeError, match=r"wider than the chair's 0.67 m, got 0.67 m"):
            formula(1.0, 0.67, 0.67)


@given(d=st.floats(0.1, 1.5), w=st.floats(0.4, 0.9), corridor=st.floats(0.5, 2.5))
@settings(deadline=None, max_examples=300)
def test_the_roots_are_where_the_front_corner_touches_and_their_product_is_known(d, w, corridor):
    radii = contact_radii(d, w, corridor)
    if radii is None:
        # Not turned in by any r >= 0: neither by the best one.
        best = max(d - w, 0.0)
        assert ROOT2 * (math.hypot(d, best + w) - corridor) > best - 1e-9
        return
    for r in radii:
        # r = sqrt2 (R_c - L) [NarrowArcs, Eq. (3.1.1)], squared roots included
        assert math.hypot(d, r + w) == pytest.approx(abs(r / ROOT2 + corridor), rel=1e-9)
    assert radii[0] * radii[1] == pytest.approx(2.0 * (d * d + w * w - corridor**2), abs=1e-8)
    if radii[1] > 0.0:
        middle = 0.5 * (max(radii[0], 0.0) + radii[1])
        assert paper_turn(d, w, corridor, middle).clearance >= -1e-12
        # C_r + w <= L always holds for r+.
        assert paper_turn(d, w, corridor, radii[1]).side_gap + w <= corridor + 1e-9


def test_the_papers_condition_is_not_sufficient():
    """(*) d + w <= sqrt2 L holds, and still no radius passes, since d < w."""
    d, w, corridor = 0.3, 0.9, 0.9
    assert d + w <= ROOT2 * corridor
    assert contact_radii(d, w, corridor) is None or contact_radii(d, w, corridor)[1] < 1e-9
    assert least_paper_corridor(d, w) > corridor


def test_the_best_radius_of_the_papers_chair_leaves_70_mm_instead_of_none():
    turn = best_paper_turn(LENGTH, WIDTH, CORRIDOR)
    assert turn.inner_radius == pytest.approx(0.33)
    assert turn.clearance == pytest.approx(0.0698, abs=5e-5)
    assert turn.centre == pytest.approx(turn.clearance + ROOT2 * LENGTH)


@given(d=st.floats(0.1, 1.5), w=st.floats(0.4, 0.9), spare=st.floats(0.0, 1.5))
@settings(deadline=None, max_examples=60)
def test_no_radius_beats_the_best_one(d, w, spare):
    corridor = least_paper_corridor(d, w) + spare
    best = best_paper_turn(d, w, corridor)
    others = [paper_turn(d, w, corridor, r).clearance for r in np.linspace(0.0, 4.0, 801)]
    assert max(others) <= best.clearance + 1e-9


def test_the_corrections_zero_radius_for_d_below_w_is_not_the_best():
    """With d = 0.5, w = 0.6, L = 0.9: 66.7 mm at r = 66.7 mm, not 59.5 mm at r = 0."""
    best = best_paper_turn(0.5, 0.6, 0.9)
    assert best.clearance == pytest.approx(0.0667, abs=1e-4)
    assert best.inner_radius == pytest.approx(best.clearance)
    assert paper_turn(0.5, 0.6, 0.9, 0.0).clearance == pytest.approx(0.0595, abs=1e-4)


@pytest.mark.parametrize("name", CHAIRS)
def test_the_table_of_chairs(name):
    (front, rear, width), expected = CHAIRS[name]
    body = ArcBody(front, rear, width)
    found = (
        turning_diameter(body),
        pivot_width(body),
        least_paper_corridor(body.overhang, width),
        spin_corridor(body),
        rigid_bound(body),
    )
    assert found == pytest.approx(expected, abs=6e-4)


def test_swept_width_falls_from_the_spin_to_the_straight_drive():
    radii = np.linspace(0.0, 50.0, 200)
    widths = [swept_width(LENGTH, WIDTH, r) for r in radii]
    assert (np.diff(widths) < 0.0).all()
    assert widths[0] == pytest.approx(math.hypot(LENGTH, WIDTH))
    assert widths[-1] == pytest.approx(WIDTH, abs=0.011)


def test_the_body_of_a_chair_keeps_overhangs_apart_and_is_symmetric():
    body = ArcBody.of(load_vehicle("narrow-arcs"))
    assert (body.front, body.rear, body.width) == pytest.approx((0.75, 0.25, 0.67))
    skew = Vehicle(layers=(load_vehicle("dft").layers[0],))
    assert ArcBody.of(skew).width == pytest.approx(0.70)
    with pytest.raises(ShapeError, match="overhangs >= 0"):
        ArcBody(-0.1, 0.2, 0.6)
    with pytest.raises(ShapeError, match="must not be negative"):
        paper_turn(1.0, 0.6, 1.3, -0.1)
