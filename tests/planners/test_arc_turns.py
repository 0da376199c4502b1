"""Arcs round corners and through doors: every closed form is what the certificate finds."""

import math

import numpy as np
import pytest

from narrows.clearance import certify
from narrows.errors import ShapeError
from narrows.planners.arc_geometry import (
    ArcBody,
    best_paper_turn,
    contact_radii,
    least_paper_corridor,
    rigid_bound,
)
from narrows.planners.arc_path import CornerFrame, path_of
from narrows.planners.corridor_turn import (
    Corner,
    TurnArc,
    arc_between_lines,
    arc_clearance,
    arc_of_radius,
    best_arc,
    least_corridor,
    missing_width,
    radius_interval,
)
from narrows.planners.door_arc import (
    DoorTurn,
    balanced_side,
    best_door_arc,
    door_clearance,
    missing_corridor,
    missing_door,
)
from narrows.planners.door_space import door_needed, least_corridor_for_door
from narrows.short_forms import Corridor
from narrows.vehicle import Vehicle
from narrows.world import Solid, World

PAPER = ArcBody(1.0, 0.0, 0.67)
BOTH_WAYS = ArcBody(1.0, 1.0, 0.67)  # d at both ends: what a centre on the bisector is good for
RIGHT = 0.5 * math.pi
TOLERANCE = 1e-4


def chair(body):
    return Vehicle.rectangle(body.front + body.rear, body.width, body.rear)


def corner_certificate(body, corner, arc, side=1):
    """Certify line - arc - line between the walls of a real corridor."""
    thick = 0.1 if corner.turn < 2.4 else 0.05
    form = Corridor(corner.before, side * corner.turn, corner.after, 4.0, thick)
    world = World(form.world().solids[:2])
    frame = CornerFrame(np.array([0.0, corner.before if side > 0 else 0.0]), 0.0, side)
    x, y = arc.centre
    start = frame.pose_in_world(x - 2.0, y - arc.radius, 0.0)
    pieces = [(2.0, 0.0), (arc.radius * arc.turn, 1.0 / arc.radius), (2.0, 0.0)]
    return certify(world, chair(body), path_of(start, pieces, side), tolerance=TOLERANCE)


def door_certificate(body, door, arc):
    """Certify line - arc - line through a real door; a thin wall is 0.1 mm thick."""
    wide, thick = door.door, max(door.thickness, 1e-4)

    def box(x0, y0, x1, y1):
        return [[x0, y0], [x1, y0], [x1, y1], [x0, y1]]

    world = World(
        (
            Solid.polygon(box(-9.0, 0.0, 0.0, thick), name="near jamb"),
            Solid.polygon(box(wide, 0.0, wide + 9.0, thick), name="far jamb"),
            Solid.polygon(box(-9.0, -door.corridor - 0.1, 19.0, -door.corridor), name="corridor"),
        )
    )
    x, y = arc.centre
    start = [x - 2.5, y - arc.radius, 0.0]
    beyond = 2.5 + max(-y, 0.0) + body.rear
    pieces = [(2.5, 0.0), (arc.radius * arc.turn, 1.0 / arc.radius), (beyond, 0.0)]
    return certify(world, chair(body), path_of(np.array(start), pieces), tolerance=TOLERANCE)


def agrees(certificate, clearance):
    """The true clearance lies between proven and attained; the form must, to rounding."""
    return certificate.clearance - 2e-4 <= clearance <= certificate.attained + 3e-4


@pytest.mark.parametrize("seed", range(8))
def test_clearance_round_a_corner_is_what_the_certificate_finds(seed):
    rng = np.random.default_rng(seed)
    checked = 0
    while checked < 12:
        body = ArcBody(rng.uniform(0.2, 1.1), rng.uniform(0.0, 0.8), rng.uniform(0.4, 0.8))
        widths = body.width + rng.uniform(0.05, 1.0, 2)
        corner = Corner(*widths.tolist(), rng.uniform(0.1, 2.6))
        arc = arc_of_radius(body, corner, rng.uniform(0.05, 3.0))
        if checked % 2:
            arc = best_arc(body, corner, least_radius=0.05)
        if arc.clearance > 0.0:
            certificate = corner_certificate(body, corner, arc, 1 if checked % 3 else -1)
            assert agrees(certificate, arc.clearance), (body, corner, arc)
            checked += 1


@pytest.mark.parametrize("seed", range(8))
def test_clearance_through_a_door_is_what_the_certificate_finds(seed):
    rng = np.random.default_rng(seed)
    checked = 0
    while checked < 12:
        body = ArcBody(rng.uniform(0.2, 1.1), rng.uniform(0.0, 0.8), rng.uniform(0.4, 0.8))
        thick = float(rng.choice([0.0, rng.uniform(0.0, 0.4)]))
        door = DoorTurn(rng.uniform(0.7, 2.5), body.width + rng.uniform(0.02, 0.5), thick)
        radius, beyond = rng.uniform(0.05, 2.5), rng.uniform(-1.5, 2.0)
        behind = float(balanced_side(body, door, np.array(radius), np.array(beyond)))
        behind += float(rng.choice([0.0, rng.normal(0.0, 0.03)]))
        values = (np.array(value) for value in (radius, beyond, behind))
        clearance = float(door_clearance(body, door, *values))
        arc = TurnArc(radius, beyond, behind, RIGHT, clearance)
        if checked % 2:
            arc = best_door_arc(body, door, least_radius=0.05)
        if arc.clearance > 0.0:
            assert agrees(door_certificate(body, door, arc), arc.clearance), (body, door, arc)
            checked += 1


def test_a_long_rear_beside_the_far_jamb_is_seen():
    """Once straight again the side passes the jamb, though the front corner cleared it."""
    body, door = ArcBody(0.2534, 0.5904, 0.6052), DoorTurn(0.8181, 0.9721)
    values = (np.array(value) for value in (0.7684, 0.4325, 0.0699))
    arc = TurnArc(0.7684, 0.4325, 0.0699, RIGHT, float(door_clearance(body, door, *values)))
    assert arc.clearance == pytest.approx(0.9721 + 0.0699 - 0.7684 - 0.3026)
    assert door_certificate(body, door, arc).attained == pytest.approx(arc.clearance, abs=3e-4)


def test_the_papers_turn_is_the_case_of_equal_widths_and_overhangs():
    corner = Corner(1.3, 1.3)
    low, high = radius_interval(BOTH_WAYS, corner, least_radius=0.335)
    assert low == pytest.approx(0.335)
    assert high - 0.335 == pytest.approx(contact_radii(1.0, 0.67, 1.3)[1], abs=1e-9)
    best, paper = best_arc(BOTH_WAYS, corner), best_paper_turn(1.0, 0.67, 1.3)
    assert best.clearance == pytest.approx(paper.clearance, abs=1e-7)
    assert best.side_gap(0.67) == pytest.approx(paper.side_gap, abs=1e-4)  # flat at the top
    assert best.axle_gap == pytest.approx(paper.axle_gap, abs=1e-4)
    narrow = Corner(1.19, 1.19)  # d^2 + w^2 > L^2: both roots positive, all between pass
    radii = np.array(contact_radii(1.0, 0.67, 1.19)) + 0.335
    assert radius_interval(BOTH_WAYS, narrow) == pytest.approx(tuple(radii), abs=1e-9)


def test_the_papers_own_arc_touches_and_the_best_one_does_not():
    corner, high = Corner(1.3, 1.3), contact_radii(1.0, 0.67, 1.3)[1] + 0.335
    touching = arc_between_lines(PAPER, corner, high, (0.3964 + 0.335, 0.3964 + 0.335))
    assert corner_certificate(PAPER, corner, touching).attained == pytest.approx(0.0, abs=2e-4)
    best = best_arc(BOTH_WAYS, corner)
    certificate = corner_certificate(PAPER, corner, best)
    assert certificate.clearance == pytest.approx(0.0698, abs=2e-4)
    # Letting the centre leave the bisector nearly doubles it: no overhang behind, none to keep.
    free = best_arc(PAPER, corner)
    assert free.clearance == pytest.approx(0.136, abs=1e-3)
    assert agrees(corner_certificate(PAPER, corner, free), free.clearance)


@pytest.mark.parametrize(
    ("front", "rear", "width"),
    [(1.0, 0.0, 0.67), (0.9, 0.2, 0.65), (0.6, 0.6, 0.62), (0.4, 0.75, 0.65), (0.3, 0.2, 0.7)],
)
def test_the_least_corridor_is_tight_and_below_the_bisectors(front, rear, width):
    body, longest = ArcBody(front, rear, width), max(front, rear)
    least = least_corridor(body)
    both = ArcBody(longest, longest, width)
    assert least_corridor(both) == pytest.approx(least_paper_corridor(longest, width), abs=1e-6)
    assert rigid_bound(body) - 1e-9 <= least <= least_corridor(both) + 1e-9
    for spare in (0.002, -0.002):
        corner = Corner(least + spare, least + spare)
        arc = best_arc(body, corner, least_radius=0.5 * width)
        assert corner_certificate(body, corner, arc).is_clear == (spare > 0.0)


def test_clearance_is_concave_in_the_radius_so_radii_are_one_interval():
    rng = np.random.default_rng(3)
    for _ in range(50):
        body = ArcBody(rng.uniform(0.2, 1.1), rng.uniform(0.0, 0.8), rng.uniform(0.4, 0.8))
        corner = Corner(*(body.width + rng.uniform(0.1, 1.0, 2)).tolist(), rng.uniform(0.2, 2.6))
        best = best_arc(body, corner)
        radii = np.linspace(0.0, 3.0 * best.radius + 1.0, 2000)
        values = np.array([arc_of_radius(body, corner, r).clearance for r in radii[::20]])
        assert (np.diff(values, 2) < 1e-9).all()
        assert values.max() <= best.clearance + 1e-6
        asked = best.clearance - 0.02
        low, high = radius_interval(body, corner, clearance=asked)
        for radius, inside in ((low + 1e-6, True), (high - 1e-6, True), (high + 0.01, False)):
            assert (arc_of_radius(body, corner, radius).clearance >= asked) == inside


def test_driving_the_other_way_round_swaps_the_overhangs_and_the_legs():
    rng = np.random.default_rng(4)
    for _ in range(50):
        f, b, w, turn = *rng.uniform(0.1, 1.0, 2), rng.uniform(0.4, 0.8), rng.uniform(0.2, 2.6)
        before, after = w + rng.uniform(0.1, 1.0, 2)
        values = (np.array(v) for v in (rng.uniform(0.1, 2.0), *rng.uniform(-0.5, 1.0, 2)))
        rho, a1, a2 = values
        there = arc_clearance(ArcBody(f, b, w), Corner(before, after, turn), rho, a1, a2)
        back = arc_clearance(ArcBody(b, f, w), Corner(after, before, turn), rho, a2, a1)
        assert there == pytest.approx(float(back))


def test_missing_corridor_is_just_enough():
    corner = Corner(0.95, 1.05)
    more = missing_width(PAPER, corner, clearance=0.02, least_radius=0.3)
    assert more > 0.0
    wider = Corner(0.95 + more, 1.05 + more)
    assert best_arc(PAPER, wider, least_radius=0.3).clearance == pytest.approx(0.02, abs=1e-6)
    assert missing_width(PAPER, Corner(1.5, 1.5)) == 0.0
    assert radius_interval(PAPER, Corner(0.9, 0.9)) is None


def test_the_hidden_condition_of_the_paper_door():
    """Its arc fits a corridor of 2.06 m and not one of 1.8 m."""
    space = door_needed(PAPER, 1.3889, 0.0)
    assert (space.door, space.corridor) == pytest.approx((0.90, 2.0589), abs=1e-4)
    arc = TurnArc(1.3889 + 0.335, 0.0, 1.3889, RIGHT, 0.0)
    assert door_certificate(PAPER, DoorTurn(2.07, 0.903), arc).attained > -1e-9
    assert door_certificate(PAPER, DoorTurn(1.8, 0.903), arc).attained < -0.2


@pytest.mark.parametrize(
    ("body", "corridors"),
    [
        (PAPER, (3.51, 2.45, 1.86, 1.22)),
        (ArcBody(0.9, 0.2, 0.65), (2.43, 1.76, 1.37, 0.93)),
        (ArcBody(0.6, 0.6, 0.62), (1.04, 0.89, 0.84, 0.80)),
    ],
)
def test_the_corridor_a_door_asks_for(body, corridors):
    """The corrections' table has centres beyond the wall; before it far less corridor will do."""
    for door, corridor in zip((0.80, 0.85, 0.90, 1.00), corridors, strict=True):
        beyond = least_corridor_for_door(body, door, before_wall=False)
        assert beyond.corridor == pytest.approx(corridor, abs=0.006)
        free = least_corridor_for_door(body, door)
        assert free.corridor <= beyond.corridor + 1e-9
        needed = door_needed(body, free.inner_radius, free.shift)
        assert (needed.door, needed.corridor) == pytest.approx((door, free.corridor), abs=1e-9)
        arc = best_door_arc(
            body, DoorTurn(free.corridor + 0.01, door + 0.01), least_radius=0.5 * body.width
        )
        assert door_certificate(body, DoorTurn(free.corridor + 0.01, door + 0.01), arc).is_clear


def test_before_the_wall_a_door_of_80_cm_asks_for_157_cm_instead_of_351():
    space = least_corridor_for_door(PAPER, 0.80)
    assert (space.corridor, space.inner_radius) == pytest.approx((1.569, 0.0), abs=1e-3)
    assert space.shift == pytest.approx(-math.sqrt(1.0 + 0.67**2 - 0.8**2))


def test_a_thick_wall_asks_for_the_corrections_door_with_the_centre_in_its_middle():
    radius, thick = 1.5, 0.3
    inner, reach = radius - 0.335, math.hypot(1.0, radius + 0.335)
    door = reach - math.sqrt(inner**2 - 0.25 * thick**2)
    shift = np.array(0.5 * thick)
    turn = DoorTurn(9.0, door, thick)
    behind = balanced_side(PAPER, turn, np.array(radius), shift)
    clearance = door_clearance(PAPER, turn, np.array(radius), shift, behind)
    assert float(clearance) == pytest.approx(0.0, abs=1e-9)


def test_the_best_arc_through_a_door_is_not_beaten_by_random_ones():
    rng = np.random.default_rng(3)
    for _ in range(12):
        body = ArcBody(rng.uniform(0.2, 1.1), rng.uniform(0.0, 0.8), rng.uniform(0.4, 0.8))
        door = DoorTurn(rng.uniform(0.7, 2.5), body.width + rng.uniform(0.02, 0.5), 0.1)
        best = best_door_arc(body, door)
        radius = rng.uniform(0.0, 2.5, 100_000) * rng.uniform(0.0, 1.0, 100_000)
        beyond = np.hypot(body.rear, radius + 0.5 * body.width) - door.corridor
        beyond = beyond + rng.uniform(-0.3, 0.5, 100_000)
        behind = balanced_side(body, door, radius, beyond)
        # 0.2 mm are given up for gentleness
        assert door_clearance(body, door, radius, beyond, behind).max() < best.clearance + 3e-4


def test_missing_door_and_corridor_are_just_enough():
    door = DoorTurn(1.1, 0.75, 0.1)
    wider = missing_door(PAPER, door, least_radius=0.335)
    deeper = missing_corridor(PAPER, door, least_radius=0.335)
    assert wider > 0.0
    assert deeper > 0.0
    for enough in (DoorTurn(1.1, 0.75 + wider, 0.1), DoorTurn(1.1 + deeper, 0.75, 0.1)):
        arc = best_door_arc(PAPER, enough, least_radius=0.335)
        assert arc.clearance == pytest.approx(0.0, abs=1e-3)
    assert missing_corridor(PAPER, DoorTurn(1.1, 0.66)) == math.inf
    assert missing_door(PAPER, DoorTurn(2.0, 1.0)) == 0.0


def test_wrong_shapes_are_said():
    with pytest.raises(ShapeError, match="angle between 0 and pi"):
        Corner(1.0, 1.0, 0.0)
    with pytest.raises(ShapeError, match="thickness >= 0"):
        DoorTurn(1.0, 1.0, -0.1)
    with pytest.raises(ShapeError, match=r"shift must be from -1.0 to 0.5"):
        door_needed(PAPER, 0.5, 0.6)
    with pytest.raises(ShapeError, match=r"wider than the chair's 0.67 m"):
        least_corridor_for_door(PAPER, 0.6)
