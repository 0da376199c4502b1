"""Solids, the slice a body meets, and things that move."""

import math

import numpy as np
import pytest
import shapely

from narrows.errors import ShapeError
from narrows.world import MovingSolid, Solid, World

TRIANGLE = [[0, 0], [2, 0], [0, 1]]
L_SHAPE = [[0, 0], [3, 0], [3, 1], [1, 1], [1, 2], [0, 2]]


def test_a_body_meets_the_solids_whose_heights_it_shares():
    world = World(
        (
            Solid.polygon(TRIANGLE, name="wall"),
            Solid.polygon(TRIANGLE, z=(0.75, 1.0), name="table top"),
            Solid.circle(0, 0, 0.3, z=(0.0, 0.4), name="stool"),
        )
    )

    def met(low, high):
        return {world.solids[i].name for i in world.pieces_between(low, high).owner}

    assert met(0.0, 1.3) == {"wall", "table top", "stool"}
    assert met(0.0, 0.75) == {"wall", "stool"}  # touching heights do not meet
    assert met(0.4, 0.75) == {"wall"}
    assert met(1.0, 2.5) == {"wall"}
    assert met(2.5, 3.0) == set()


def test_the_pieces_cover_each_solid_and_no_more():
    hole = shapely.Polygon(
        [[-9, -9], [9, -9], [9, 9], [-9, 9]], [[[-1, -1], [1, -1], [1, 1], [-1, 1]]]
    )
    world = World((Solid.polygon(L_SHAPE), Solid(hole), Solid.polygon(TRIANGLE)))
    pieces = world.pieces_between(0.0, 1.0)
    for index, solid in enumerate(world.solids):
        mine = shapely.polygons(pieces.corners[pieces.owner == index])
        assert shapely.union_all(mine).symmetric_difference(solid.shape).area < 1e-12
    assert len(pieces) == len(pieces.owner) == len(pieces.radius)


def test_every_grown_piece_fills_its_box():
    solids = (Solid.polygon(L_SHAPE), Solid.circle(4.0, 5.0, 0.7), Solid.polygon(TRIANGLE))
    pieces = World(solids).pieces_between(0.0, 1.0)
    for index, solid in enumerate(solids):
        mine = pieces.owner == index
        box = [*pieces.low[mine].min(axis=0), *pieces.high[mine].max(axis=0)]
        np.testing.assert_allclose(box, solid.shape.buffer(solid.radius).bounds, atol=1e-12)


def test_what_is_left_out_as_far_from_a_box_is_further_than_the_reach():
    rng = np.random.default_rng(7)
    solids = tuple(
        Solid.circle(*rng.uniform(-5, 5, 2), rng.uniform(0.1, 0.5))
        if k % 2
        else Solid.polygon(np.array(TRIANGLE) + rng.uniform(-5, 5, 2))
        for k in range(200)
    )
    pieces = World(solids).pieces_between(0.0, 1.0)
    for reach in (0.0, 0.5, 2.0):
        low = rng.uniform(-4, 4, 2)
        high = low + rng.uniform(0, 1, 2)
        close = pieces.near(low, high, reach)
        distance = shapely.distance(
            shapely.box(*low, *high), shapely.box(*np.hstack([pieces.low, pieces.high]).T)
        )
        assert set(np.flatnonzero(distance <= reach)) <= set(close)
        assert distance[close].max() <= np.sqrt(2.0) * reach
    assert len(pieces.near([9.0, 9.0], [9.0, 9.0], math.inf)) == len(pieces)


def test_an_empty_slice_has_no_pieces():
    pieces = World((Solid.polygon(TRIANGLE, z=(1.0, 2.0)),)).pieces_between(0.0, 0.5)
    assert len(pieces) == 0
    assert pieces.low.shape == pieces.high.shape == (0, 2)
    assert len(World().pieces_between(0.0, 1.0)) == 0


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda: Solid.polygon([[0, 0], [1, 1], [1, 0], [0, 1]]), "Self-intersection"),
        (lambda: Solid.polygon([[0, 0], [1, 1], [2, 2]]), "simple with an area"),
        (lambda: Solid.polygon([[0, 0], [1, math.inf], [2, 2]]), "finite"),
        (lambda: Solid.polygon(TRIANGLE, z=(1.0, 1.0)), "low < high"),
        (lambda: Solid.polygon(TRIANGLE, z=(0.0, math.nan)), "low < high"),
        (lambda: Solid.circle(0, 0, 0.0), "radius"),
        (lambda: Solid.circle(0, 0, math.inf), "radius"),
        (lambda: Solid.circle(math.nan, 0, 1.0), "finite"),
        (lambda: World(bounds=(0, 0, 0, 1)), "bounds"),
        (lambda: World(bounds=(0, 0, math.inf, 1)), "bounds"),
        (lambda: MovingSolid(0.2, [[0, 1, 1], [0, 2, 2]]), "times"),
        (lambda: MovingSolid(0.2, np.zeros((0, 3))), "rows"),
        (lambda: MovingSolid(-0.2, [[0, 1, 1]]), "radius"),
    ],
)
def test_impossible_things_are_refused_with_the_reason(make, message):
    with pytest.raises(ShapeError, match=message):
        make()


def test_a_person_walks_straight_between_times_and_stands_still_outside():
    person = MovingSolid(0.25, [[1.0, 0.0, 0.0], [3.0, 2.0, 0.0], [4.0, 2.0, 3.0]])
    times = [0.0, 1.0, 2.0, 3.5, 9.0]
    expected = [[0, 0], [0, 0], [1, 0], [2, 1.5], [2, 3]]
    np.testing.assert_allclose(person.position(times), expected, atol=1e-15)
    assert person.speed == pytest.approx(3.0)
    assert MovingSolid(0.25, [[0.0, 1.0, 2.0]]).speed == 0.0
