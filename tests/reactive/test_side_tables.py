"""The corrected tables of sides obey mechanics; the printed ones do in all rows but four."""

import numpy as np
import pytest

from narrows.errors import InputError
from narrows.reactive.avoidance import indicated_side, sides_to_try
from narrows.reactive.side_tables import (
    PARTS,
    Indicated,
    Side,
    mechanical_side,
    side_table,
    table_names,
)

SIDES = [part for part in PARTS if part.endswith("side")]


def contact(part):
    return (0.5 if "front" in part else -0.2), (0.3 if "left" in part else -0.3)


@pytest.mark.parametrize("way", [0, 1])
@pytest.mark.parametrize("part", SIDES)
@pytest.mark.parametrize("indicated", [Indicated.LEFT, Indicated.RIGHT])
def test_side_contacts_are_relieved_by_the_corrected_tables(way, part, indicated):
    x, y = contact(part)
    side = Side(side_table("corrected")[way, PARTS.index(part), indicated])
    # A way bends to the left with omega > 0 forward and omega < 0 backward.
    omega = (1.0 if indicated is Indicated.LEFT else -1.0) * (1.0 if way == 0 else -1.0)
    moves_outward = omega * x * np.sign(y) > 0.0
    if moves_outward:
        assert side is mechanical_side(x, y, forward=way == 0)
    else:
        assert side is Side.NONE  # such a point cannot be met


def test_the_printed_tables_differ_in_the_leading_sides_only():
    differs = np.argwhere(side_table("printed") != side_table("corrected"))
    leading = {0: "front", 1: "rear"}
    assert len(differs) == 4
    for way, part, _ in differs:
        assert PARTS[part].startswith(leading[way])
        assert PARTS[part].endswith("side")


@pytest.mark.parametrize("name", table_names())
def test_tables_are_mirror_images_of_themselves(name):
    table = side_table(name)
    swap = {Side.LEFT: Side.RIGHT, Side.RIGHT: Side.LEFT}
    for part, label in enumerate(PARTS):
        other = label.replace("left", "?").replace("right", "left").replace("?", "right")
        for column in range(3):
            here = Side(table[0, part, column])
            there = Side(table[0, PARTS.index(other), 2 - column])
            assert swap.get(here, here) is there


def test_sides_next_to_the_chair_are_avoided_both_ways_and_fronts_not_at_all():
    limits = np.full(8, np.inf)
    limits[PARTS.index("front_left_side")] = 0.1
    straight = (Indicated.STRAIGHT, side_table("corrected"), True)
    assert sides_to_try(limits, 0.5, *straight) == (True, True)
    limits[PARTS.index("front_right")] = 0.1
    assert sides_to_try(limits, 0.5, *straight) == (False, False)
    assert sides_to_try(limits, 0.05, *straight) == (False, False)


def test_a_front_contact_is_avoided_to_the_side_indicated():
    limits = np.full(8, np.inf)
    limits[PARTS.index("front_left")] = 0.1
    table = side_table("corrected")
    assert sides_to_try(limits, 0.5, Indicated.LEFT, table, True) == (True, False)
    assert sides_to_try(limits, 0.5, Indicated.RIGHT, table, True) == (False, True)


def test_the_side_indicated_backwards_is_where_the_rear_goes(xeno_regions):
    for v in (0.4, -0.4):
        for omega in (-2.0, -0.5, 0.0, 0.5, 2.0):
            phi, _ = xeno_regions.polar(v, omega)
            expected = np.sign(omega * v)
            side = indicated_side(phi, v > 0.0, 0.02)
            assert side == Indicated(1 - int(expected))


def test_an_unknown_table_is_refused():
    with pytest.raises(InputError, match="printed or corrected"):
        side_table("guessed")
